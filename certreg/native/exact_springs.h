/* Exact sums over points with springs that are matrices W = L L^T, by exact_springs.c and limbs.c. */
#ifndef CERTREG_EXACT_SPRINGS_H
#define CERTREG_EXACT_SPRINGS_H

/* The sums, and where they stand, are those of springs.h, over no origin but 0. */
#include "springs.h"

#define CERTREG_SPRINGS_WORDS 136 /* 64 bits each, low first, of one sum in two's complement */

/* The sums of n points, source and target n x 3, factors n x 6. about: for source, target, factors the power of
 * two, over 2^-1074, that the sums are over, once for each factor of theirs; where their lowest bits are set, over
 * 2^-1074 (INT64_MAX: all are zero); of how many words each sum is, one behind the other. Answers as in exact.h. */
int certreg_exact_springs(
    int64_t n, const double *source, const double *target, const double *factors, uint64_t *sums, int64_t about[7]);

/* The same by sums of products of limbs: CERTREG_LIMB_PLACES digits for each sum, the highest first, each counting
 * 2^22 of the next. about: for source, target, factors the power of two, over 2^-1074, that the sums are over once for
 * each factor of theirs, the digit 0 counting 1; where their lowest bits are set, as above. CERTREG_NO_MEMORY where
 * numbers are of too many sizes. */
#define CERTREG_LIMBS 8        /* of a number */
#define CERTREG_LIMB_PLACES 33 /* four times as many, and the digit 0 */

int certreg_limb_springs(
    int64_t n, const double *source, const double *target, const double *factors, int64_t *sums, int64_t about[6]);

#endif
