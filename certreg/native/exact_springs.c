/* The sums over points whose springs are matrices, exactly, by exponents: as in exact.c, with products of four.
 *
 * A double is m 2^(2e - 1074) with integers |m| < 2^54. Each column n of L is a plane: W is the sum of the n n^T, and
 * every sum is one of products n_a n_b c d, c and d coordinates or 1. Of two numbers the product is h 2^54 + l, so
 * of four it is h h' 2^108 + (h l' + l h') 2^54 + l l', and each of these three goes to its accumulator for the sum of
 * the e. One point adds at most 14 times to one accumulator, each time less than 2^109: 2^13 points fit into 128
 * bits. */
#include "exact_springs.h"
#include "exact.h"
#include "exponents.h"

#include <stdlib.h>

#ifdef __SIZEOF_INT128__

#define PORTION 8192 /* 2^13 */
#define STEP 1
#define HALF 54 /* bits */
#define INLINE static inline __attribute__((always_inline))

enum { X = 0, Y = 1, L = 2 };

typedef struct {
    __int128 part[3]; /* times 1, 2^HALF, 2^(2 HALF) */
} accumulator;

/* (high 2^HALF + low) 4^e */
typedef struct {
    int64_t high, low, e;
} product;

typedef struct {
    number x[3], y[3];
    product xx[6], yy[6], yx[3][3];
} point;

static const int upper[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

INLINE product times(number a, number b)
{
    const __int128 value = (__int128)a.m * b.m;
    return (product){(int64_t)(value >> HALF), (int64_t)value & ((INT64_C(1) << HALF) - 1), a.e + b.e};
}

INLINE void add_two(accumulator *sum, product a)
{
    sum[a.e].part[1] += a.high;
    sum[a.e].part[0] += a.low;
}

INLINE void add_three(accumulator *sum, product a, number b)
{
    accumulator *const to = sum + a.e + b.e;
    to->part[1] += (__int128)a.high * b.m;
    to->part[0] += (__int128)a.low * b.m;
}

INLINE void add_four(accumulator *sum, product a, product b)
{
    accumulator *const to = sum + a.e + b.e;
    to->part[2] += (__int128)a.high * b.high;
    to->part[1] += (__int128)a.high * b.low + (__int128)a.low * b.high;
    to->part[0] += (__int128)a.low * b.low;
}

/* Add n_a n_b = spring times all that it is multiplied by; of W_ab and W_ba together. */
INLINE void add_spring(accumulator *sums, int64_t pitch, int a, int b, product spring, const point *at)
{
    const int entry = upper[a][b];
    add_two(sums + (CERTREG_SPRINGS_STIFFNESS + entry) * pitch, spring);
    for (int j = 0; j < 3; j++)
        add_three(sums + (CERTREG_SPRINGS_SOURCE + 3 * entry + j) * pitch, spring, at->x[j]);
    for (int jk = 0; jk < 6; jk++)
        add_four(sums + (CERTREG_SPRINGS_SCATTER + 6 * entry + jk) * pitch, spring, at->xx[jk]);
    for (int turn = 0; turn < (a == b ? 1 : 2); turn++) {
        const int to = turn ? b : a, of = turn ? a : b;
        add_three(sums + (CERTREG_SPRINGS_TARGET + to) * pitch, spring, at->y[of]);
        for (int k = 0; k < 3; k++)
            add_four(sums + (CERTREG_SPRINGS_CROSS + 3 * to + k) * pitch, spring, at->yx[of][k]);
        add_four(sums + CERTREG_SPRINGS_SPREAD * pitch, spring, at->yy[entry]);
    }
}

static void add_point(accumulator *sums, int64_t pitch, const number factors[6], point *at)
{
    static const int place[3][3] = {{0, 1, 3}, {0, 2, 4}, {0, 0, 5}}; /* of L by columns */
    for (int j = 0; j < 3; j++)
        for (int k = 0; k < 3; k++) {
            at->yx[j][k] = times(at->y[j], at->x[k]);
            if (k >= j) {
                at->xx[upper[j][k]] = times(at->x[j], at->x[k]);
                at->yy[upper[j][k]] = times(at->y[j], at->y[k]);
            }
        }
    for (int column = 0; column < 3; column++)
        for (int a = column; a < 3; a++)
            for (int b = a; b < 3; b++) {
                const number one = factors[place[column][a]], other = factors[place[column][b]];
                if (one.m != 0 && other.m != 0)
                    add_spring(sums, pitch, a, b, times(one, other), at);
            }
}

/* A number with its power counted from the least; 0 has the least. */
INLINE number counted(double value, const range *of)
{
    range seen = *of;
    number found = split(value, &seen, STEP);
    found.e = found.m == 0 ? 0 : found.e - (of->least >> STEP);
    return found;
}

/* How many factors of sum k are coordinates of the source, and of the target. */
static void coordinates_of(int k, int *x, int *y)
{
    *x = k >= CERTREG_SPRINGS_TARGET ? k >= CERTREG_SPRINGS_CROSS && k < CERTREG_SPRINGS_SPREAD
                                     : (k >= CERTREG_SPRINGS_SOURCE) + (k >= CERTREG_SPRINGS_SCATTER);
    *y = k >= CERTREG_SPRINGS_TARGET ? 1 + (k == CERTREG_SPRINGS_SPREAD) : 0;
}

/* Move the accumulators to the long numbers. */
static void gather(uint64_t *sums, int64_t count, accumulator *sum, int64_t pitch, const int64_t width[3])
{
    for (int k = 0; k < CERTREG_SPRINGS; k++) {
        int x, y;
        coordinates_of(k, &x, &y);
        const int64_t most = 2 * width[L] + x * width[X] + y * width[Y];
        for (int64_t e = 0; e <= most; e++)
            for (int part = 0; part < 3; part++) {
                __int128 *const value = &sum[k * pitch + e].part[part];
                if (*value != 0)
                    add_shifted(sums + k * count, count, *value, (e << STEP) + part * HALF);
                *value = 0;
            }
    }
}

static void sum_all(int64_t n, const double *const from[3], const range seen[3], accumulator *sum, int64_t pitch,
                    const int64_t width[3], uint64_t *sums, int64_t count)
{
    for (int64_t i = 0; i < n;) {
        const int64_t end = n - i > PORTION ? i + PORTION : n;
        for (; i < end; i++) {
            point at;
            number factors[6];
            for (int k = 0; k < 3; k++) {
                at.x[k] = counted(from[X][3 * i + k], &seen[X]);
                at.y[k] = counted(from[Y][3 * i + k], &seen[Y]);
            }
            for (int k = 0; k < 6; k++)
                factors[k] = counted(from[L][6 * i + k], &seen[L]);
            add_point(sum, pitch, factors, &at);
        }
        gather(sums, count, sum, pitch, width);
    }
}

int certreg_exact_springs(
    int64_t n, const double *source, const double *target, const double *factors, uint64_t *sums, int64_t about[7])
{
    const double *const from[3] = {source, target, factors};
    range seen[3];
    int64_t width[3];
    for (int k = 0; k < 3; k++) {
        seen[k] = (range){INT64_MAX, 2046, 0};
        for (int64_t i = 0; i < (k == L ? 6 : 3) * n; i++)
            split(from[k][i], &seen[k], STEP);
        if (seen[k].most == 2046)
            return CERTREG_NOT_FINITE;
        if (seen[k].most < seen[k].least)
            seen[k].most = seen[k].least = 0;
        width[k] = (seen[k].most >> STEP) - (seen[k].least >> STEP);
        about[k] = seen[k].least >> STEP << STEP;
        about[3 + k] = seen[k].lowest;
    }
    const int64_t most = 2 * (width[L] + (width[X] > width[Y] ? width[X] : width[Y]));
    const int64_t pitch = (most + 1) | 1; /* so that the sums do not share a place in the cache */
    const int64_t count = ((most << STEP) + 2 * HALF + 128) / 64 + 1;
    accumulator *const sum = calloc((size_t)(CERTREG_SPRINGS * pitch), sizeof *sum);
    if (sum == NULL)
        return CERTREG_NO_MEMORY;
    about[6] = count;
    memset(sums, 0, (size_t)(CERTREG_SPRINGS * count) * sizeof *sums);
    sum_all(n, from, seen, sum, pitch, width, sums, count);
    free(sum);
    return CERTREG_SUMMED;
}

#else

int certreg_exact_springs(
    int64_t n, const double *source, const double *target, const double *factors, uint64_t *sums, int64_t about[7])
{
    (void)n, (void)source, (void)target, (void)factors, (void)sums, (void)about;
    return CERTREG_NO_WIDE_INTEGERS;
}

#endif
