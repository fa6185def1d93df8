/* The sums of w, w a and w a b over points, exactly, in fixed point; a, b are coordinates of x and y.
 *
 * All numbers of a cloud are integers over one power of two. Where these are below 2^103 in size, 2^103 is
 * added, so that none is negative, and what is left are two digits of 52 bits. Digits are multiplied,
 * each product is cut into two digits again, and each of these is added to the total of its place. What
 * the added 2^103 makes of the sums is a polynomial in the sums themselves, and the caller takes it off.
 * Nothing here depends on the sign or on the exponent of a number, once it is in digits.
 *
 * Two kernels give the same totals: one of vectors, for processors that multiply eight pairs of 52 bits at
 * once (AVX-512 IFMA); and plain C with products of 128 bits. */
#include "fixed.h"

#include <string.h>

#ifdef __SIZEOF_INT128__

typedef unsigned __int128 wide;

#define DIGIT 52
#define MASK ((UINT64_C(1) << DIGIT) - 1)
#define BIAS 103
#define BLOCK 128      /* points in digits at once: they fit into the nearest cache */
#define WITH_WEIGHTS 4 /* digits of w (x + 2^103): both have two */

#define PLACES 6 /* of a sum in digits: each counts for 2^52 times the one before */

typedef uint64_t totals[CERTREG_EXACT_SUMS][PLACES][2]; /* of 128 bits, low first */

enum { X = 0, Y = 1, W = 2 };

/* Of the numbers other than 0 in an array, the least and the largest exponent as they stand in the bits. */
typedef struct {
    int64_t least, most;
    int64_t bits; /* over the bit of the last place of the smallest, all are below 2^bits in size */
    int negative;
} range;

static range range_of(int64_t n, const double *values)
{
    uint64_t most = 0, least = UINT64_MAX, signs = 0;
    for (int64_t k = 0; k < n; k++) {
        uint64_t bits;
        memcpy(&bits, values + k, sizeof bits);
        const uint64_t size = bits << 1; /* without the sign */
        signs = bits > signs ? bits : signs;
        most = size > most ? size : most;
        least = size - 1 < least ? size - 1 : least; /* 0 becomes the largest */
    }
    if (most == 0)
        return (range){1, 1, 1 + DIGIT, 0};
    const int64_t first = (int64_t)((least + 1) >> 53), last = (int64_t)(most >> 53);
    return (range){first, last, last - first + 1 + DIGIT, signs > UINT64_C(1) << 63};
}

/* Whether the numbers fit, over the bit of the last place of the smallest. The processor may be told to
 * take numbers below the normal range as 0: these are refused, and so are scales that would be. */
static int fits(const range *of, int bits)
{
    if (of->most == 2047)
        return CERTREG_FIXED_NOT_FINITE;
    return of->least >= 1 && of->least <= 2045 && of->bits <= bits && !(bits > BIAS && of->negative)
               ? CERTREG_FIXED_SUMMED
               : CERTREG_FIXED_WIDE;
}

static int ranges(int64_t n, const double *source, const double *target, const double *weights, range seen[3])
{
    static const int bits[3] = {BIAS, BIAS, 2 * DIGIT};
    int refused = CERTREG_FIXED_SUMMED;
    if (n > CERTREG_FIXED_POINTS)
        return CERTREG_FIXED_WIDE;
    seen[X] = range_of(3 * n, source);
    seen[Y] = range_of(3 * n, target);
    seen[W] = weights == NULL ? (range){1075, 1075, 1, 0} : range_of(n, weights);
    for (int k = 0; k < 3; k++) {
        const int answer = fits(&seen[k], bits[k]);
        refused = answer > refused ? answer : refused;
    }
    return refused;
}
/* Where the sum of the products of two of the columns x0 x1 x2 y0 y1 y2 stands, the first not after the other. */
static int place_of(int p, int q)
{
    static const int upper[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    if (q < 3)
        return CERTREG_EXACT_SUMS_SOURCE_SCATTER + upper[p][q];
    return p < 3 ? CERTREG_EXACT_SUMS_CROSS + 3 * (q - 3) + p : CERTREG_EXACT_SUMS_TARGET_SCATTER + upper[p - 3][q - 3];
}

static void add_total(totals sums, int sum, int place, wide value)
{
    uint64_t *total = sums[sum][place];
    value += (wide)total[1] << 64 | total[0];
    total[0] = (uint64_t)value, total[1] = (uint64_t)(value >> 64);
}

/* Each sum as one number: words of 64 bits. */
static void join(totals of, certreg_fixed_numbers sums)
{
    memset(sums, 0, sizeof(certreg_fixed_numbers));
    for (int k = 0; k < CERTREG_EXACT_SUMS; k++)
        for (int place = 0; place < PLACES; place++) {
            const int shift = place * DIGIT % 64;
            const uint64_t low = of[k][place][0], high = of[k][place][1];
            const uint64_t parts[3] = {low << shift, shift ? high << shift | low >> (64 - shift) : high,
                                       shift ? high >> (64 - shift) : 0};
            wide carry = 0;
            for (int word = place * DIGIT / 64, i = 0; word < CERTREG_FIXED_WORDS; word++, i++, carry >>= 64) {
                carry += (wide)sums[k][word] + (i < 3 ? parts[i] : 0);
                sums[k][word] = (uint64_t)carry;
            }
        }
}

static int64_t lowest_bit(uint64_t low, uint64_t high, int64_t bits)
{
    if (low & MASK)
        return __builtin_ctzll(low);
    high &= (UINT64_C(1) << (bits - DIGIT)) - 1; /* without what was added: the lowest bit of a number is below that */
    return high ? DIGIT + __builtin_ctzll(high) : -1;
}

/* Plain C. */

typedef struct {
    uint64_t digit[2];
} fixed;

static inline fixed fixed_of(double value, int64_t least, wide added, wide *set)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    const int64_t e = bits >> DIGIT & 2047;
    const wide size = e ? (wide)((bits & MASK) | UINT64_C(1) << DIGIT) << (e - least) : 0;
    const wide number = bits >> 63 ? added - size : added + size;
    *set |= size;
    return (fixed){{(uint64_t)number & MASK, (uint64_t)(number >> DIGIT)}};
}

/* Digits of a block of points, column by column: x0 x1 x2 y0 y1 y2. */
typedef struct {
    uint64_t a[6][2][BLOCK], wa[6][WITH_WEIGHTS][BLOCK];
} digits_of_block;

/* Add the products of two columns to their totals; of `left`, two digits at once. */
static inline void add_column(int64_t n, const uint64_t (*left)[BLOCK], const uint64_t (*right)[BLOCK], wide *total)
{
    wide low = 0, middle = 0, high = 0;
    for (int64_t k = 0; k < n; k++) {
        const uint64_t a = left[0][k], b = left[1][k], c = right[0][k], d = right[1][k];
        low += (wide)a * c;
        middle += (wide)a * d;
        high += (wide)b * d;
        middle += (wide)b * c;
    }
    total[0] += low, total[1] += middle, total[2] += high;
}

/* The digits of w a, and their sum. */
static inline void weigh_plain(const fixed *w, const fixed *a, uint64_t (*product)[BLOCK], wide *total)
{
    wide part[3] = {0}, carry = 0;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            part[i + j] += (wide)w->digit[i] * a->digit[j];
    for (int i = 0; i < WITH_WEIGHTS; i++, carry >>= DIGIT) {
        carry += i < 3 ? part[i] : 0;
        product[i][0] = (uint64_t)carry & MASK;
        total[i] += product[i][0];
    }
}

/* The sums of n points; `digits` of w a: two without weights, and they are those of a. */
static inline __attribute__((always_inline)) void sum_plain(int64_t n, const double *const from[3], const range seen[3],
                                                            int digits, totals sums, struct certreg_fixed *about)
{
    wide total[CERTREG_EXACT_SUMS][PLACES] = {{0}}, set[3] = {0};
    digits_of_block in;
    for (int64_t k = 0, count; k < n; k += count) {
        count = n - k < BLOCK ? n - k : BLOCK;
        for (int64_t point = 0; point < count; point++) {
            fixed w = {{1, 0}};
            if (digits > 2)
                w = fixed_of(from[W][k + point], seen[W].least, 0, &set[W]);
            for (int j = 0; j < 2; j++)
                total[CERTREG_EXACT_SUMS_MASS][j] += w.digit[j];
            for (int i = 0; i < 6; i++) {
                const int cloud = i / 3;
                const double value = from[cloud][3 * (k + point) + i % 3];
                const fixed a = fixed_of(value, seen[cloud].least, (wide)1 << seen[cloud].bits, &set[cloud]);
                wide *const sum = total[CERTREG_EXACT_SUMS_SOURCE + i];
                for (int j = 0; j < 2; j++) {
                    in.a[i][j][point] = a.digit[j];
                    sum[j] += digits > 2 ? 0 : a.digit[j];
                }
                if (digits > 2)
                    weigh_plain(&w, &a, (uint64_t(*)[BLOCK]) & in.wa[i][0][point], sum);
            }
        }
        for (int i = 0; i < 6; i++)
            for (int j = i; j < 6; j++)
                for (int digit = 0; digit < digits; digit += 2)
                    add_column(count, digits > 2 ? in.wa[i] + digit : in.a[i], in.a[j], total[place_of(i, j)] + digit);
    }
    for (int k = 0; k < CERTREG_EXACT_SUMS; k++)
        for (int place = 0; place < PLACES; place++)
            add_total(sums, k, place, total[k][place]);
    for (int k = 0; k < 3; k++)
        about->lowest[k] = lowest_bit((uint64_t)set[k] & MASK, (uint64_t)(set[k] >> DIGIT),
                                      k == W ? 2 * DIGIT : seen[k].bits);
}

static void sum_in_plain_c(int64_t n, const double *const from[3], const range seen[3], totals sums, struct certreg_fixed *about)
{
    if (from[W] == NULL)
        sum_plain(n, from, seen, 2, sums, about);
    else
        sum_plain(n, from, seen, WITH_WEIGHTS, sums, about);
}

#if defined(__AVX512F__) && defined(__AVX512DQ__)
#include <cpuid.h>
#include <immintrin.h>

/* Vectors of eight points. Of a double in [2^52, 2^53) or in [1, 2) the last 52 bits are a digit, and the
 * multiplication takes no others. */

#define IFMA __attribute__((target("avx512ifma")))
#define INLINE static inline __attribute__((always_inline)) IFMA
#define LANES 8
#define STEPS 1024 /* vectors until totals of 64 bits are gathered: */
_Static_assert(STEPS * 4 <= 1 << (64 - DIGIT), "a total takes at most four digits from a vector");
_Static_assert(STEPS % (BLOCK / LANES) == 0, "they are gathered between two blocks");

typedef __m512i vector;
typedef struct {
    vector of[6][2];
} columns;

/* The digits of value 2^scale + a multiple of 2^52 that is held by `floor`; all steps are exact, whatever
 * rounding the processor is told to use. */
INLINE void digits_of(__m512d value, __m512d scale, __m512d floor, vector digit[2])
{
    const __m512d over = _mm512_mul_pd(value, scale);
    const __m512d high = _mm512_add_round_pd(over, floor, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
    const __m512d rest = _mm512_sub_pd(over, _mm512_sub_pd(high, floor));
    digit[0] = _mm512_castpd_si512(_mm512_add_pd(rest, _mm512_set1_pd(1.0)));
    digit[1] = _mm512_castpd_si512(high);
}

/* Three columns of eight rows. */
INLINE void columns_of(const double *from, __m512d column[3])
{
    const __m512d a = _mm512_loadu_pd(from), b = _mm512_loadu_pd(from + 8), c = _mm512_loadu_pd(from + 16);
    for (int k = 0; k < 3; k++) {
        int64_t first[LANES], then[LANES];
        for (int i = 0; i < LANES; i++) {
            const int place = 3 * i + k;
            first[i] = place < 16 ? place : 0;
            then[i] = place < 16 ? i : place - 16 + 8;
        }
        const vector one = _mm512_loadu_si512(first), other = _mm512_loadu_si512(then);
        column[k] = _mm512_permutex2var_pd(_mm512_permutex2var_pd(a, one, b), other, c);
    }
}

INLINE vector low_of(vector total, vector a, vector b) { return _mm512_madd52lo_epu64(total, a, b); }
INLINE vector high_of(vector total, vector a, vector b) { return _mm512_madd52hi_epu64(total, a, b); }

/* The digits of the products of w with every column. */
INLINE void weigh(const vector w[2], const columns *a, int digits, vector *product)
{
    const vector none = _mm512_setzero_si512();
    for (int k = 0; k < 6; k++, product += digits) {
        vector place[WITH_WEIGHTS] = {none, none, none, none};
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < 2; j++) {
                place[i + j] = low_of(place[i + j], w[i], a->of[k][j]);
                if (i + j + 1 < digits)
                    place[i + j + 1] = high_of(place[i + j + 1], w[i], a->of[k][j]);
            }
        for (int i = 0; i + 1 < digits; i++) /* what is left above 52 bits is not looked at */
            place[i + 1] = _mm512_add_epi64(place[i + 1], _mm512_srli_epi64(place[i], DIGIT));
        for (int i = 0; i < digits; i++)
            product[i] = place[i];
    }
}

/* Add the products of two columns with two others to their totals; with themselves, and these columns, too.
 * short_top: whether the products of the highest digits are below 2^52. Of the square of a column without
 * weights the products of its two digits are taken once, and added twice at the end. Columns are added by
 * what does not wait for the multiplier. */
INLINE void add_products(int64_t steps, const vector *left, const vector *right, int p, int q, int digits,
                         int short_top, vector (*total)[PLACES])
{
    const int same = p == q, places = digits + 2 - short_top;
    const vector mask = _mm512_set1_epi64((int64_t)MASK), zero = _mm512_setzero_si512();
    vector sum[2][2][PLACES], alone[2][WITH_WEIGHTS], twice[2][2] = {{zero, zero}, {zero, zero}};
    for (int a = 0; a < 2; a++) {
        for (int b = same ? a : 0; b < 2; b++)
            for (int k = 0; k < places; k++)
                sum[a][b][k] = total[place_of(p + a, q + b)][k];
        for (int i = 0; same && i < digits; i++)
            alone[a][i] = total[CERTREG_EXACT_SUMS_SOURCE + p + a][i];
    }
    left += p * digits, right += q * 2;
    for (int64_t step = 0; step < steps; step++, left += 6 * digits, right += 12)
        for (int i = 0; i < digits; i++)
            for (int a = 0; a < 2; a++) {
                const vector digit = left[a * digits + i];
                for (int b = same ? a : 0; b < 2; b++)
                    for (int j = same && a == b && digits == 2 ? i : 0; j < 2; j++) {
                        vector *const place = same && a == b && digits == 2 && i < j ? twice[a] : &sum[a][b][i + j];
                        place[0] = low_of(place[0], digit, right[b * 2 + j]);
                        if (i + j + 1 < places)
                            place[1] = high_of(place[1], digit, right[b * 2 + j]);
                    }
                if (same)
                    alone[a][i] = _mm512_add_epi64(alone[a][i], _mm512_and_si512(digit, mask));
            }
    for (int a = 0; a < 2; a++) {
        for (int k = 0; same && k < 2; k++)
            sum[a][a][1 + k] = _mm512_add_epi64(sum[a][a][1 + k], _mm512_slli_epi64(twice[a][k], 1));
        for (int b = same ? a : 0; b < 2; b++)
            for (int k = 0; k < places; k++)
                total[place_of(p + a, q + b)][k] = sum[a][b][k];
        for (int i = 0; same && i < digits; i++)
            total[CERTREG_EXACT_SUMS_SOURCE + p + a][i] = alone[a][i];
    }
}

INLINE void add_all_products(int64_t steps, const vector *left, const vector *right, int digits, int short_top,
                             vector (*total)[PLACES])
{
    add_products(steps, left, right, 0, 0, digits, short_top, total);
    add_products(steps, left, right, 0, 2, digits, short_top, total);
    add_products(steps, left, right, 0, 4, digits, short_top, total);
    add_products(steps, left, right, 2, 2, digits, short_top, total);
    add_products(steps, left, right, 2, 4, digits, short_top, total);
    add_products(steps, left, right, 4, 4, digits, short_top, total);
}

IFMA static void gather(vector (*total)[PLACES], totals sums)
{
    for (int k = 0; k < CERTREG_EXACT_SUMS; k++)
        for (int place = 0; place < PLACES; place++) {
            uint64_t lane[LANES];
            wide sum = 0;
            _mm512_storeu_si512(lane, total[k][place]);
            for (int i = 0; i < LANES; i++)
                sum += lane[i];
            add_total(sums, k, place, sum);
            total[k][place] = _mm512_setzero_si512();
        }
}

/* 2^scale of `digits_of`, so that the bit of the last place of the smallest number becomes 1. */
static double scale_of(const range *seen)
{
    const uint64_t bits = (uint64_t)(2046 - seen->least) << DIGIT;
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    return scale;
}

INLINE void sum_vectors(int64_t n, const double *const from[3], const range seen[3], int digits, int short_top,
                        totals sums, struct certreg_fixed *about)
{
    const __m512d scale[3] = {_mm512_set1_pd(scale_of(&seen[X])), _mm512_set1_pd(scale_of(&seen[Y])),
                              _mm512_set1_pd(scale_of(&seen[W]))};
    const __m512d floor[3] = {_mm512_set1_pd(0x1p52 + (double)(UINT64_C(1) << (seen[X].bits - DIGIT))),
                              _mm512_set1_pd(0x1p52 + (double)(UINT64_C(1) << (seen[Y].bits - DIGIT))),
                              _mm512_set1_pd(0x1p52)};
    const vector one = _mm512_set1_epi64(1), zero = _mm512_setzero_si512();
    vector total[CERTREG_EXACT_SUMS][PLACES], set[3][2] = {{zero, zero}, {zero, zero}, {zero, zero}};
    double last[3][3 * LANES] = {{0.0}}; /* points, and others that are 0 */
    columns a[BLOCK / LANES];
    vector wa[BLOCK / LANES * 6 * WITH_WEIGHTS];
    memset(total, 0, sizeof total);
    for (int64_t k = 0, since = 0; k < n;) {
        int64_t steps = 0;
        for (; steps < BLOCK / LANES && k < n; steps++, k += LANES) {
            const double *at[3] = {from[X] + 3 * k, from[Y] + 3 * k, digits > 2 ? from[W] + k : NULL};
            if (n - k < LANES)
                for (int cloud = 0; cloud < (digits > 2 ? 3 : 2); cloud++) {
                    memcpy(last[cloud], at[cloud], (size_t)(n - k) * (cloud < 2 ? 3 : 1) * sizeof(double));
                    at[cloud] = last[cloud];
                }
            for (int cloud = 0; cloud < 2; cloud++) {
                __m512d column[3];
                columns_of(at[cloud], column);
                for (int i = 0; i < 3; i++) {
                    vector *const digit = a[steps].of[3 * cloud + i];
                    digits_of(column[i], scale[cloud], floor[cloud], digit);
                    set[cloud][0] = _mm512_or_si512(set[cloud][0], digit[0]);
                    set[cloud][1] = _mm512_or_si512(set[cloud][1], digit[1]);
                }
            }
            vector w[2] = {one, zero};
            if (digits > 2) {
                digits_of(_mm512_loadu_pd(at[W]), scale[W], floor[W], w);
                set[W][0] = _mm512_or_si512(set[W][0], w[0]);
                set[W][1] = _mm512_or_si512(set[W][1], w[1]);
                weigh(w, &a[steps], digits, wa + steps * 6 * digits);
            }
            for (int j = 0; j < 2; j++)
                total[CERTREG_EXACT_SUMS_MASS][j] = low_of(total[CERTREG_EXACT_SUMS_MASS][j], w[j], one);
        }
        add_all_products(steps, digits > 2 ? wa : a[0].of[0], a[0].of[0], digits, short_top, total);
        since += steps;
        if (since == STEPS) {
            gather(total, sums);
            since = 0;
        }
    }
    gather(total, sums);
    for (int k = 0; k < 3; k++)
        about->lowest[k] = lowest_bit(_mm512_reduce_or_epi64(set[k][0]), _mm512_reduce_or_epi64(set[k][1]),
                                      k == W ? 2 * DIGIT : seen[k].bits);
}

IFMA static void sum_in_vectors(int64_t n, const double *const from[3], const range seen[3],
                                totals sums, struct certreg_fixed *about)
{
    /* x + 2^bits and y + 2^bits are below 2^cloud. The highest digits of two of them, and of one and another
     * times w, have 2 cloud - 104 bits, and weight + 2 cloud - 156, if those times w have three digits: as
     * cloud is at least 54, they do where that is at most 52. */
    const int64_t cloud = 1 + (seen[X].bits > seen[Y].bits ? seen[X].bits : seen[Y].bits);
    if (from[W] == NULL && 2 * cloud <= 3 * DIGIT)
        sum_vectors(n, from, seen, 2, 1, sums, about);
    else if (from[W] == NULL)
        sum_vectors(n, from, seen, 2, 0, sums, about);
    else if (seen[W].bits + 2 * cloud <= 4 * DIGIT)
        sum_vectors(n, from, seen, 3, 1, sums, about);
    else
        sum_vectors(n, from, seen, WITH_WEIGHTS, 0, sums, about);
}

/* What the rest of this library needs, the wide registers among it, the processor has: see processor.c. */
int certreg_fixed_vectors(void)
{
    uint32_t a, b, c, d;
    return __get_cpuid_count(7, 0, &a, &b, &c, &d) && b >> 21 & 1;
}

#else

int certreg_fixed_vectors(void) { return 0; }
#define sum_in_vectors sum_in_plain_c

#endif

int certreg_fixed_fits(int64_t n, const double *source, const double *target, const double *weights)
{
    range seen[3];
    return ranges(n, source, target, weights, seen);
}

int certreg_fixed_sums(int64_t n, const double *source, const double *target, const double *weights,
                       certreg_fixed_numbers sums, struct certreg_fixed *about)
{
    const double *const from[3] = {source, target, weights};
    range seen[3];
    const int refused = ranges(n, source, target, weights, seen);
    if (refused)
        return refused;
    totals total = {{{0}}};
    (certreg_fixed_vectors() ? sum_in_vectors : sum_in_plain_c)(n, from, seen, total, about);
    join(total, sums);
    for (int k = 0; k < 3; k++)
        about->unit[k] = seen[k].least - 1075;
    if (weights == NULL)
        about->unit[W] = about->lowest[W] = 0;
    about->bias[X] = seen[X].bits, about->bias[Y] = seen[Y].bits;
    return CERTREG_FIXED_SUMMED;
}

#else

int certreg_fixed_fits(int64_t n, const double *source, const double *target, const double *weights)
{
    (void)n, (void)source, (void)target, (void)weights;
    return CERTREG_FIXED_ABSENT;
}

int certreg_fixed_sums(int64_t n, const double *source, const double *target, const double *weights,
                       certreg_fixed_numbers sums, struct certreg_fixed *about)
{
    (void)n, (void)source, (void)target, (void)weights, (void)sums, (void)about;
    return CERTREG_FIXED_ABSENT;
}

int certreg_fixed_vectors(void) { return 0; }

#endif
