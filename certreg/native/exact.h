/* Exact sums over points, by exact.c. */
#include <stdint.h>

#define CERTREG_EXACT_SUMS 28       /* w; wx, wy; w y x^T by rows; w x x^T, w y y^T from the diagonal on */
#define CERTREG_EXACT_WORDS 101 /* 64 bits each, low first, of one sum in two's complement */

enum { CERTREG_SUMMED, CERTREG_NO_MEMORY, CERTREG_NOT_FINITE, CERTREG_NO_WIDE_INTEGERS };

int certreg_exact_sums(
    long n, const double *source, const double *target, const double *weights, uint64_t *sums, int64_t lowest[3]);
