/* What the pass over points whose springs are matrices and its caller agree on. */
#ifndef CERTREG_NATIVE_SPRINGS_H
#define CERTREG_NATIVE_SPRINGS_H

#include <stdint.h>

/* Of W = L L^T and deviations x, y of source and target from an origin, where the sums stand, symmetric matrices by
 * 11 12 13 22 23 33: sum W; sum W_ab x; sum W_ab x x^T; sum W y; sum W y x^T by rows; sum y^T W y. */
enum {
    CERTREG_SPRINGS_STIFFNESS = 0,
    CERTREG_SPRINGS_SOURCE = 6,
    CERTREG_SPRINGS_SCATTER = 24,
    CERTREG_SPRINGS_TARGET = 60,
    CERTREG_SPRINGS_CROSS = 63,
    CERTREG_SPRINGS_SPREAD = 72,
    CERTREG_SPRINGS = 73
};

/* The sums over n points, source and target n x 3, the factors L n x 6 by 11 21 22 31 32 33, origins of both clouds;
 * each as a value and what rounding left of it. */
void certreg_springs(int64_t n, const double *source, const double *target, const double *factors,
                     const double origin[6], double sums[CERTREG_SPRINGS][2]);

/* The sums of `count` problems of n points each, one after another: 73 x 2 each. Every problem's numbers stand
 * `strides` doubles behind those of the one before: of source, target and factors, 0 where all share them. */
void certreg_many_springs(int64_t count, int64_t n, const double *source, const double *target, const double *factors,
                          const int64_t strides[3], const double *origins, double *sums);

#endif
