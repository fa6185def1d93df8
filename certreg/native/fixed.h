/* Exact sums over points in fixed point, by fixed.c. */
#ifndef CERTREG_FIXED_H
#define CERTREG_FIXED_H

#include <stdint.h>

#include "layout.h"

#define CERTREG_FIXED_WORDS 7 /* of 64 bits, of a sum, low first: all are below 2^332, as n is at most 2^20 */

/* The sums of the record `exact_sums` of layout.h, of integers that are not negative: X + 2^bias[0] for
 * the source, Y + 2^bias[1] for the target, W for the weights, where X, Y, W are the numbers over
 * 2^unit[0], 2^unit[1], 2^unit[2]. Without weights W = 1, and so it is for points that were added: the
 * mass says how many there are, all others being 0. */
typedef uint64_t certreg_fixed_numbers[CERTREG_EXACT_SUMS][CERTREG_FIXED_WORDS];

struct certreg_fixed {
    int64_t unit[3], bias[2];
    int64_t lowest[3]; /* the lowest bit that is set in X, in Y, in W; -1: all are zero */
};

enum { CERTREG_FIXED_SUMMED, CERTREG_FIXED_WIDE, CERTREG_FIXED_NOT_FINITE, CERTREG_FIXED_ABSENT };

/* At most so many points at once, so that no total of 128 bits overflows. */
#define CERTREG_FIXED_POINTS (INT64_C(1) << 20)

int certreg_fixed_sums(int64_t n, const double *source, const double *target, const double *weights,
                       certreg_fixed_numbers sums, struct certreg_fixed *about);

/* Whether fixed.c would take them: CERTREG_FIXED_SUMMED, or what it would answer instead. */
int certreg_fixed_fits(int64_t n, const double *source, const double *target, const double *weights);

/* Whether this processor multiplies digits in vectors, and fixed.c does. */
int certreg_fixed_vectors(void);

#endif
