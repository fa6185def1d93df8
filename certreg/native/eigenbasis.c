/* An eigenbasis to nearly 192 bits: that of doubles, corrected in fixed point.
 *
 * To the vector v_i comes the sum of e_ij v_j over the others, e_ij = v_j . (K v_i - l_i v_i) / (l_i - l_j),
 * l_i its Rayleigh quotient, and its length is made 1. What is left of the errors is of the order of
 * their squares: 2^-50, 2^-100, 2^-190. A proposal: whoever relies on it proves it by itself. */
#include "eigenbasis.h"
#include "jacobi.h"

#include <math.h>
#include <string.h>

#ifdef __SIZEOF_INT128__

#define WORDS CERTREG_FIXED_WORDS
#define APART 0x1p-12  /* of neighbouring values, beside entries below 1 */
#define NEAR 0x1p-16   /* of all corrections: doubles of such values leave 2^-40 */
#define ENOUGH 0x1p-94 /* of the last ones: their squares are a few units of the last places */
#define STEPS 6        /* two are usual */
#define SWEEPS 12      /* of Jacobi's method in doubles; five are usual */

typedef struct {
    uint64_t word[WORDS];
} fixed;

static inline uint64_t sign_of(fixed a) { return -(a.word[WORDS - 1] >> 63); }

/* The number, or minus the number where all bits of sign are set. */
static inline fixed signed_by(fixed a, uint64_t sign)
{
    unsigned __int128 carry = sign & 1;
    for (int k = 0; k < WORDS; k++) {
        carry += a.word[k] ^ sign;
        a.word[k] = (uint64_t)carry;
        carry >>= 64;
    }
    return a;
}

static inline fixed sum(fixed a, fixed b)
{
    unsigned __int128 carry = 0;
    for (int k = 0; k < WORDS; k++) {
        carry += (unsigned __int128)a.word[k] + b.word[k];
        a.word[k] = (uint64_t)carry;
        carry >>= 64;
    }
    return a;
}

static inline fixed difference(fixed a, fixed b) { return sum(a, signed_by(b, UINT64_MAX)); }

/* The sum of `count` products, rounded down: by columns of words from the third on, as what the lower ones carry is
 * less than 2^-60 of the last place. A number is that of its bits less 2^256 where it is negative: so the other
 * factor is taken off above. With `low` 1 the lowest words are taken for 0: to some 2^-126, sooner. */
static inline __attribute__((always_inline)) fixed summed(const fixed *a, const fixed *b, int count, int low)
{
    unsigned __int128 column = 0, off = 0;
    fixed total;
#pragma GCC unroll 8 /* all three, in half the time */
    for (int c = 2; c < 2 * WORDS - 1; c++) {
        const int k = c - WORDS + 1; /* of the result */
        uint64_t carried = 0;
#pragma GCC unroll 8
        for (int n = 0; n < count; n++) {
#pragma GCC unroll 8
            for (int i = c - low < WORDS ? low : k; i < WORDS && i <= c - low; i++) {
                const unsigned __int128 part = (unsigned __int128)a[n].word[i] * b[n].word[c - i];
                column += part;
                carried += column < part;
            }
            if (k > low) {
                off += b[n].word[k - 1] & sign_of(a[n]);
                off += a[n].word[k - 1] & sign_of(b[n]);
            }
        }
        if (k >= 0) {
            const uint64_t more = (uint64_t)column, less = (uint64_t)off;
            total.word[k] = more - less;
            off = (off >> 64) + (more < less);
        }
        column = (column >> 64) + ((unsigned __int128)carried << 64);
    }
    return total;
}

static __attribute__((noinline)) fixed product(fixed a, fixed b, int low)
{
    return low ? summed(&a, &b, 1, 1) : summed(&a, &b, 1, 0);
}

static __attribute__((noinline)) fixed dot(const fixed *a, const fixed *b, int low)
{
    return low ? summed(a, b, 4, 1) : summed(a, b, 4, 0);
}

static inline double to_double(fixed a)
{
    const uint64_t sign = sign_of(a);
    double size = 0;
    a = signed_by(a, sign);
    for (int k = WORDS - 1; k >= 0; k--)
        size = 0x1p64 * size + (double)a.word[k];
    return (sign ? -0x1p-192 : 0x1p-192) * size;
}

/* Of a number below 2^63 in size, cut off. */
static inline fixed of_double(double x)
{
    fixed a;
    double size = fabs(x);
    for (int k = WORDS - 1; k >= 0; k--) {
        a.word[k] = (uint64_t)size;
        size = 0x1p64 * (size - (double)a.word[k]);
    }
    return signed_by(a, x < 0 ? UINT64_MAX : 0);
}

/* To the digits of a double, or, unless `low`, to twice as many; the divisor is not 0. */
static inline fixed quotient(fixed a, fixed b, int low)
{
    const double over = to_double(b);
    const fixed first = of_double(to_double(a) / over);
    if (low)
        return first;
    const fixed rest = difference(a, product(first, b, low));
    return sum(first, of_double(to_double(rest) / over));
}

/* One correction of all vectors: the largest e, or error of a squared length; infinite where the values
 * are not well apart. low: as above. */
static double corrected(fixed matrix[4][4], fixed basis[4][4], fixed values[4], int low)
{
    static const fixed one = {{0, 0, 0, 1}};
    fixed images[4][4], turned[4][4], change[4][4];
    double largest = 0;
    for (int i = 0; i < 4; i++) {
        const fixed over = difference(dot(basis[i], basis[i], low), one); /* |v|^2 - 1 */
        for (int j = 0; j < 4; j++)
            images[i][j] = dot(matrix[j], basis[i], low);
        const fixed form = dot(basis[i], images[i], low);
        values[i] = difference(form, product(over, difference(form, product(over, form, low)), low));
        const fixed square = product(product(over, over, low), of_double(0.375), low);
        change[i][i] = difference(square, product(over, of_double(0.5), low)); /* 1 / |v| - 1 */
        largest = fmax(largest, fabs(to_double(over)));
    }
    for (int i = 1; i < 4; i++)
        if (!(to_double(difference(values[i - 1], values[i])) > APART))
            return INFINITY;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i; j++) {
            const fixed along = dot(basis[i], basis[j], low), gap = difference(values[i], values[j]);
            const fixed form = dot(basis[j], images[i], low);
            change[i][j] = quotient(difference(form, product(values[i], along, low)), gap, low);
            change[j][i] = quotient(difference(product(values[j], along, low), form), gap, low);
            largest = fmax(largest, fmax(fabs(to_double(change[i][j])), fabs(to_double(change[j][i]))));
        }
    for (int k = 0; k < 4; k++) {
        const fixed column[4] = {basis[0][k], basis[1][k], basis[2][k], basis[3][k]};
        for (int i = 0; i < 4; i++)
            turned[i][k] = sum(basis[i][k], dot(change[i], column, low));
    }
    memcpy(basis, turned, sizeof turned);
    return largest;
}

/* Unit eigenvectors, row by row, by descending value, of a matrix in doubles. */
static void proposed(double matrix[16], fixed basis[4][4])
{
    double columns[16];
    int order[4] = {0, 1, 2, 3};
    certreg_jacobi(matrix, columns, 4, SWEEPS);
    for (int i = 1; i < 4; i++)
        for (int k = i; k > 0 && matrix[5 * order[k]] > matrix[5 * order[k - 1]]; k--) {
            const int lower = order[k];
            order[k] = order[k - 1], order[k - 1] = lower;
        }
    for (int i = 0; i < 4; i++) {
        double *const v = columns + order[i], flip = v[0] < 0 ? -1 : 1; /* of v and -v always the same */
        for (int k = 0; k < 4; k++)
            basis[i][k] = of_double(flip * v[4 * k]);
    }
}

int certreg_eigenbasis(const uint64_t *upper, uint64_t *found)
{
    fixed given[4][4], basis[4][4], values[4];
    double largest = NEAR, doubles[16];
    for (int i = 0; i < 4; i++)
        for (int j = i; j < 4; j++, upper += WORDS) {
            memcpy(given[i] + j, upper, sizeof(fixed));
            given[j][i] = given[i][j];
            doubles[4 * i + j] = doubles[4 * j + i] = to_double(given[i][j]);
        }
    proposed(doubles, basis);
    for (int step = 0; step < STEPS && (step < 2 || largest > ENOUGH); step++) {
        largest = corrected(given, basis, values, step == 0); /* whose corrections have the digits of doubles */
        if (!(largest < NEAR))
            return 0;
    }
    memcpy(found, values, sizeof values);
    memcpy(found + 4 * WORDS, basis, sizeof basis);
    return largest <= ENOUGH;
}

#else

int certreg_eigenbasis(const uint64_t *upper, uint64_t *found)
{
    (void)upper, (void)found;
    return 0;
}

#endif
