/* Rigid motions of least largest ratio of distance to bound, by lawson.c. */
#ifndef CERTREG_LAWSON_H
#define CERTREG_LAWSON_H

#include <stdint.h>

#define CERTREG_LAWSON_SCRATCH 13 /* doubles for each row, and for CERTREG_LAWSON_SPARE more */
#define CERTREG_LAWSON_SPARE 8

/* columns: x1, x2, x3, y1, y2, y3 and the bound of each of `height` rows. */

/* Few of the rows, the first and others, with weights that refute them: no motion meets all. They and their
 * weights come first then; how many, or 0 where none were found. */
int64_t certreg_refutation(int64_t height, const double *columns, int64_t *rows, int64_t count, int64_t *weights,
                           double *scratch);

/* Of `sets` sets, bytes of `height` each, none empty: the pose (R by rows, t) of least largest ratio that was met,
 * and the weights of the last step, `height` each. */
void certreg_lawson_fits(int64_t height, const double *columns, int64_t sets, const uint8_t *inside, double *poses,
                         double *weights, double *scratch);

#endif
