/* Which pairs of points agree in the lengths between them, by agreement.c. */
#ifndef CERTREG_AGREEMENT_H
#define CERTREG_AGREEMENT_H

#include <stdint.h>

/* columns: x1, x2, x3, y1, y2, y3 and the bound of each row, each of 64 times `words` numbers of
 * about one in size, of which `count` are rows. near: `words` words for each row, whose bits are the
 * rows that agree with it: lengths a, b of x and y between them with |a - b| <= d, the sum of both
 * bounds. doubtful: the same of pairs that doubles leave open, which are not in near. Returns how
 * many of those there are, each counted twice; a row is not paired with itself. */
int64_t certreg_agreeing(int64_t count, int64_t words, const double *columns, uint64_t *near, uint64_t *doubtful);

#endif
