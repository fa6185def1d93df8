/* Exact sums over points, by exact.c. */
#include <stdint.h>

/* The record `exact_sums` of layout.h holds w; wx, wy; w y x^T; w x x^T, w y y^T. */
#include "layout.h"

#define CERTREG_EXACT_WORDS 101 /* 64 bits each, low first, of one sum in two's complement */

enum { CERTREG_SUMMED, CERTREG_NO_MEMORY, CERTREG_NOT_FINITE, CERTREG_NO_WIDE_INTEGERS };

int certreg_exact_sums(
    int64_t n, const double *source, const double *target, const double *weights, uint64_t *sums, int64_t lowest[3]);

/* The same of few points whose exponents are near to each other, in less memory and time: sums of
 * CERTREG_FEW_WORDS words, over the lowest bits of their factors. CERTREG_NO_MEMORY where they are not near. */
#define CERTREG_FEW_WORDS 6

int certreg_few_sums(
    int64_t n, const double *source, const double *target, const double *weights, uint64_t *sums, int64_t lowest[3]);
