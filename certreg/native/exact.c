/* The sums of w, w a and w a b over points, exactly; a, b are coordinates of x and y.
 *
 * A double is m 2^(4e - 1074) with integers |m| < 2^56 and 0 <= e < 512. A product of doubles is that
 * of the m, and the sum of the e tells which of many accumulators takes it, one for each power of 16:
 * nothing is shifted, rounded or carried while the points go by. An accumulator is a pair of 128
 * bits, high 2^56 + low. What is added to either is at most 2^112, so that 2^15 points fit; then they
 * are gathered into one long number. */
#include "exact.h"
#include "exponents.h"

#include <stdlib.h>

#ifdef __SIZEOF_INT128__

#define PORTION 32768 /* 2^15 */
#define STEP 2        /* 4 = 2^STEP */
#define HALF 56       /* bits */
#define POWERS 1534   /* 3 * 511 + 1: a sum of three e is below, whatever the bits */
#define PITCH 1539    /* so that the accumulators of one power do not share a place in the cache */
#define FEW_POWERS 37 /* 4 * 36 + HALF + 2^112 and 2^15 of them: within 6 words */

enum {
    MASS = CERTREG_EXACT_SUMS_MASS,
    FIRST = CERTREG_EXACT_SUMS_SOURCE,
    CROSS = CERTREG_EXACT_SUMS_CROSS,
    SOURCE = CERTREG_EXACT_SUMS_SOURCE_SCATTER,
    TARGET = CERTREG_EXACT_SUMS_TARGET_SCATTER
};

typedef struct {
    __int128 high, low;
} pair;

/* Add (high 2^HALF + low) 16^e times another number to the accumulator of their power. */
static inline void add(pair *sum, int64_t high, int64_t low, number b, int64_t e)
{
    sum[e + b.e].high += (__int128)high * b.m;
    sum[e + b.e].low += (__int128)low * b.m;
}

static inline __attribute__((always_inline)) void add_point(
    pair *sums, const int pitch, number w, const number x[3], const number y[3])
{
    static const number one = {1, 0};
    const int64_t low_bits = (INT64_C(1) << HALF) - 1;
    int k = SOURCE, l = TARGET;
    sums[MASS * pitch + w.e].low += w.m;
    for (int i = 0; i < 3; i++) {
        const __int128 wx = (__int128)w.m * x[i].m, wy = (__int128)w.m * y[i].m;
        const int64_t xh = (int64_t)(wx >> HALF), xl = (int64_t)wx & low_bits, xe = w.e + x[i].e;
        const int64_t yh = (int64_t)(wy >> HALF), yl = (int64_t)wy & low_bits, ye = w.e + y[i].e;
        add(sums + (FIRST + i) * pitch, xh, xl, one, xe);
        add(sums + (FIRST + 3 + i) * pitch, yh, yl, one, ye);
        for (int j = 0; j < 3; j++)
            add(sums + (CROSS + 3 * i + j) * pitch, yh, yl, x[j], ye);
        for (int j = i; j < 3; j++) {
            add(sums + k++ * pitch, xh, xl, x[j], xe);
            add(sums + l++ * pitch, yh, yl, y[j], ye);
        }
    }
}

/* The same without the weight. */
static inline void add_unweighted(pair (*sum)[PITCH], const number x[3], const number y[3])
{
    int k = SOURCE, l = TARGET;
    sum[MASS][0].low += 1;
    for (int i = 0; i < 3; i++) {
        sum[FIRST + i][x[i].e].low += x[i].m;
        sum[FIRST + 3 + i][y[i].e].low += y[i].m;
        for (int j = 0; j < 3; j++)
            sum[CROSS + 3 * i + j][y[i].e + x[j].e].low += (__int128)y[i].m * x[j].m;
        for (int j = i; j < 3; j++) {
            sum[k++][x[i].e + x[j].e].low += (__int128)x[i].m * x[j].m;
            sum[l++][y[i].e + y[j].e].low += (__int128)y[i].m * y[j].m;
        }
    }
}

/* Whether all weights are one and the same power of two, as most are: their sums are shifted at the end. */
static int are_one_power(int64_t n, const double *weights)
{
    uint64_t first, bits;
    if (n == 0)
        return 0;
    memcpy(&first, weights, sizeof first);
    for (int64_t i = 1; i < n; i++) {
        memcpy(&bits, weights + i, sizeof bits);
        if (bits != first)
            return 0;
    }
    return first << 12 == 0 && first >> 52 > 0 && first >> 52 < 2047; /* positive, too: else 2^11 is set */
}

/* Move the accumulators of one sum, of powers in a range, to its long number, times 2^shift. */
static void gather(uint64_t *words, int count, pair *sum, int64_t least, int64_t most, int64_t shift)
{
    for (int64_t e = least; e <= most; e++) {
        if (sum[e].low != 0)
            add_shifted(words, count, sum[e].low, 4 * e + shift);
        if (sum[e].high != 0)
            add_shifted(words, count, sum[e].high, 4 * e + HALF + shift);
        sum[e].low = sum[e].high = 0;
    }
}

/* How many factors of sum k are of the source, and of the target. */
static inline void factors_of(int k, int *x, int *y)
{
    *x = *y = 0;
    if (k >= FIRST && k < CROSS)
        *x = k < FIRST + 3, *y = !*x;
    else if (k >= CROSS && k < SOURCE)
        *x = 1, *y = 1;
    else if (k >= SOURCE)
        *x = k < TARGET ? 2 : 0, *y = 2 - *x;
}

static void gather_all(uint64_t *sums, pair (*sum)[PITCH], const range seen[3], int one_power)
{
    const int64_t least = one_power ? 0 : seen[2].least / 4, most = one_power ? 0 : seen[2].most / 4;
    for (int k = 0; k < CERTREG_EXACT_SUMS; k++) {
        int x, y;
        factors_of(k, &x, &y);
        gather(sums + k * CERTREG_EXACT_WORDS, CERTREG_EXACT_WORDS, sum[k],
            least + x * (seen[0].least / 4) + y * (seen[1].least / 4),
            most + x * (seen[0].most / 4) + y * (seen[1].most / 4), one_power ? seen[2].lowest : 0);
    }
}

/* The sums of n points, source and target n x 3, over 2^-1074 to the power of the number of factors;
 * for source, target, weights where the lowest bit is set, over 2^-1074 (INT64_MAX: all are zero). */
int certreg_exact_sums(
    int64_t n, const double *source, const double *target, const double *weights, uint64_t *sums, int64_t lowest[3])
{
    static const range none = {INT64_MAX, 2046, 0};
    range seen[3] = {none, none, none};
    pair(*sum)[PITCH] = calloc(CERTREG_EXACT_SUMS, sizeof *sum);
    if (sum == NULL)
        return CERTREG_NO_MEMORY;
    const int one_power = are_one_power(n, weights);
    memset(sums, 0, CERTREG_EXACT_SUMS * CERTREG_EXACT_WORDS * sizeof *sums);
    for (int64_t i = 0; i < n;) {
        const int64_t end = n - i > PORTION ? i + PORTION : n;
        for (; i < end; i++) {
            const number w = split(weights[i], &seen[2], STEP);
            number x[3], y[3];
            for (int k = 0; k < 3; k++) {
                x[k] = split(source[3 * i + k], &seen[0], STEP);
                y[k] = split(target[3 * i + k], &seen[1], STEP);
            }
            if (one_power)
                add_unweighted(sum, x, y);
            else
                add_point(*sum, PITCH, w, x, y);
        }
        gather_all(sums, sum, seen, one_power);
    }
    free(sum);
    for (int k = 0; k < 3; k++)
        lowest[k] = seen[k].lowest;
    for (int k = 0; k < 3; k++)
        if (seen[k].most == 2046)
            return CERTREG_NOT_FINITE;
    return CERTREG_SUMMED;
}

/* The largest e - least of numbers, 0 where all are 0. */
static inline int64_t width_of(range seen) { return seen.most < seen.least ? 0 : seen.most / 4 - seen.least / 4; }

/* A number with its power counted from the least; 0 has the least. */
static inline number counted(double value, int64_t least, range *seen)
{
    number found = split(value, seen, STEP);
    found.e = found.m == 0 ? 0 : found.e - least;
    return found;
}

/* A long number over 2^shift, of which that is a factor. */
static void divide(uint64_t *words, int count, int64_t shift)
{
    const int64_t whole = shift >> 6;
    const int bits = shift & 63;
    const uint64_t sign = words[count - 1] >> 63 ? UINT64_MAX : 0;
    for (int64_t k = 0; k < count; k++) {
        const uint64_t low = k + whole < count ? words[k + whole] : sign;
        const uint64_t high = k + whole + 1 < count ? words[k + whole + 1] : sign;
        words[k] = bits ? low >> bits | high << (64 - bits) : low;
    }
}

int certreg_few_sums(
    int64_t n, const double *source, const double *target, const double *weights, uint64_t *sums, int64_t lowest[3])
{
    static const range none = {INT64_MAX, 2046, 0};
    range seen[3] = {none, none, none};
    pair sum[CERTREG_EXACT_SUMS][FEW_POWERS];
    int64_t least[3], width[3], spare[3]; /* bits below the lowest one that is set */
    if (n > PORTION)
        return CERTREG_NO_MEMORY;
    for (int64_t i = 0; i < 3 * n; i++)
        split(source[i], &seen[0], STEP), split(target[i], &seen[1], STEP);
    for (int64_t i = 0; i < n; i++)
        split(weights[i], &seen[2], STEP);
    for (int k = 0; k < 3; k++) {
        if (seen[k].most == 2046)
            return CERTREG_NOT_FINITE;
        width[k] = width_of(seen[k]);
        least[k] = seen[k].most < seen[k].least ? 0 : seen[k].least / 4;
        lowest[k] = seen[k].lowest;
        spare[k] = lowest[k] == INT64_MAX ? 0 : lowest[k] - 4 * least[k];
    }
    if (width[2] + 2 * (width[0] > width[1] ? width[0] : width[1]) >= FEW_POWERS)
        return CERTREG_NO_MEMORY;
    memset(sum, 0, sizeof sum);
    memset(sums, 0, CERTREG_EXACT_SUMS * CERTREG_FEW_WORDS * sizeof *sums);
    for (int64_t i = 0; i < n; i++) {
        const number w = counted(weights[i], least[2], &seen[2]);
        number x[3], y[3];
        for (int k = 0; k < 3; k++) {
            x[k] = counted(source[3 * i + k], least[0], &seen[0]);
            y[k] = counted(target[3 * i + k], least[1], &seen[1]);
        }
        add_point(*sum, FEW_POWERS, w, x, y);
    }
    for (int k = 0; k < CERTREG_EXACT_SUMS; k++) {
        uint64_t *words = sums + k * CERTREG_FEW_WORDS;
        int x, y;
        factors_of(k, &x, &y);
        gather(words, CERTREG_FEW_WORDS, sum[k], 0, width[2] + x * width[0] + y * width[1], 0);
        divide(words, CERTREG_FEW_WORDS, spare[2] + x * spare[0] + y * spare[1]);
    }
    return CERTREG_SUMMED;
}

#else

int certreg_exact_sums(
    int64_t n, const double *source, const double *target, const double *weights, uint64_t *sums, int64_t lowest[3])
{
    (void)n, (void)source, (void)target, (void)weights, (void)sums, (void)lowest;
    return CERTREG_NO_WIDE_INTEGERS;
}

int certreg_few_sums(
    int64_t n, const double *source, const double *target, const double *weights, uint64_t *sums, int64_t lowest[3])
{
    (void)n, (void)source, (void)target, (void)weights, (void)sums, (void)lowest;
    return CERTREG_NO_WIDE_INTEGERS;
}

#endif
