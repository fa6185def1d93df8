/* Points that stand in memory row by row, taken side by side in lanes; and sums of them that keep what rounding
 * takes from each addition: for sums.c and springs.c. */
#ifndef CERTREG_UNPACKED_H
#define CERTREG_UNPACKED_H

#include <stdint.h>
#include <string.h>

#define INLINE static inline __attribute__((always_inline))
#ifdef __AVX512F__
#define LANES 8
#define EACH(which, k) \
    which(0, k), which(1, k), which(2, k), which(3, k), which(4, k), which(5, k), which(6, k), which(7, k)
#else
#define LANES 4
#define EACH(which, k) which(0, k), which(1, k), which(2, k), which(3, k)
#endif

typedef double lanes __attribute__((vector_size(8 * LANES)));
typedef int64_t places __attribute__((vector_size(8 * LANES)));

/* Coordinate k of point l stands at 3 l + k: in the first two vectors of three, or in the last. */
#define EARLY(l, k) (3 * l + k < 2 * LANES ? 3 * l + k : 0)
#define LATE(l, k) (3 * l + k < 2 * LANES ? l : 3 * l + k - LANES)
#ifdef __clang__
#define PICKED(a, b, which, k) __builtin_shufflevector(a, b, EACH(which, k))
#else
#define PICKED(a, b, which, k) __builtin_shuffle(a, b, (places){EACH(which, k)})
#endif

INLINE lanes doubles(const char *data)
{
    lanes values;
    memcpy(&values, data, sizeof values);
    return values;
}

INLINE void unpack(lanes a, lanes b, lanes c, lanes out[3])
{
    out[0] = PICKED(PICKED(a, b, EARLY, 0), c, LATE, 0);
    out[1] = PICKED(PICKED(a, b, EARLY, 1), c, LATE, 1);
    out[2] = PICKED(PICKED(a, b, EARLY, 2), c, LATE, 2);
}

/* A sum in lanes, and what rounding took from it [Knuth1997, 4.2.2]. */
struct kept {
    lanes value, rest;
};

/* The sum of a block, added with its rounding error. */
INLINE void keep(struct kept *total, lanes block)
{
    lanes before = total->value, sum = before + block, part = sum - before;
    total->value = sum;
    total->rest += (before - (sum - part)) + (block - part);
}

/* The lanes of a sum, added in the same way: the sum, and what is left of it. */
static inline void fold(const struct kept *total, double sum[2])
{
    sum[0] = sum[1] = 0.0;
    for (int lane = 0; lane < LANES; lane++) {
        double before = sum[0], term = total->value[lane];
        sum[0] = before + term;
        double part = sum[0] - before;
        sum[1] += (before - (sum[0] - part)) + (term - part) + total->rest[lane];
    }
}

#endif
