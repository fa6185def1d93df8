/* Optima of many small problems, proved in integers: sums, eigenvector, bounds, one problem after another.
 *
 * With source = X 2^a, target = Y 2^b, weights = W 2^c in integers, mass = sum W, the matrix
 * cross = mass sum W Y X^T - sum W Y (sum W X)^T is C over the unit 2^(a+b+c) / mass, and so is K over the
 * same, Davenport's matrix of cross. Doubles propose an eigenvector; that R(q) is optimal is proved thus.
 *
 * Let K = 2^s (T + E) with T in integers, 0 <= E_ij < 1, so |E|_2 < 4; all below is over 2^s. Let q be the
 * integers of the eigenvector, n = |q|^2, L the 4x3 matrix with columns orthogonal to q and L^T L = n I. In the
 * basis of q and the columns of L, all over sqrt(n), the checker's matrix (v + delta - mu) I - K + mu q q^T / n is
 *     [delta, -r^T; -r, (v + delta - mu) I - L^T K L / n],    v = q^T K q / n,  r = L^T K q / n.
 * If its lower block is at least p I, p > 0, and delta p > |r|^2, then it is positive definite (Schur).
 *   - |r_i| <= |L^T T q|_i / n + 4, since that of E is less than 4.
 *   - v >= q^T T q / n - 4 and L^T K L / n <= L^T T L / n + 4 I: the block less p I is positive definite if
 *     S = (q^T T q - (mu + p + 8) n) I - L^T T L is, all integers.
 *   - S = 2^h (U + F), 0 <= F_ij < 1, |F|_2 < 3: it is if U - 3 I is, by its leading minors (Sylvester).
 * A larger delta and a smaller mu are proved, too: so claims are rounded outwards.
 *
 * K has four distinct eigenvalues iff the discriminant of the characteristic polynomial of cross^T cross is not
 * 0; it is not if it is not modulo a prime. Then cross has rank two at least, and three points of positive weight
 * are not collinear: J is definite, and 0, 1, 2, 3 are the unstable directions.
 *
 * What does not come out so is left alone: nothing is claimed. */
#include "certifying.h"

#include <string.h>

#ifdef __SIZEOF_INT128__

#define LANES 4 /* as in pose.c */
#include "lanes.h"
#include "eigen.h"

/* Coordinates and weights are integers below 2^(2 LIMB), in two limbs. A product of three has six limbs less one;
 * what is added to an accumulator of 128 bits is twice 2^(2 LIMB) at most for each of 2^16 points: 2^127.
 * Sums of products are below 2^(6 LIMB + 16) = 2^346, the mass below 2^126, cross below 2^473, K below 2^475:
 * they have 64 WORDS = 512 bits. */
#define LIMB 55
#define PLACES 5
#define WORDS 8
#define MATRIX_BITS 108 /* of T: r has about 108 - 52 bits, its square is below 2^128 */
#define UNIT_BITS 52    /* q is a unit vector times 2^52, n about 2^104 */
#define BLOCK_BITS 60   /* of U: minors of two are below 2^128 */
#define CLAIM_BITS 32   /* of mantissas that are claimed: at most 2^-31 is wasted */
#define PRIME ((UINT64_C(1) << 61) - 1)

typedef __int128 int128;
typedef unsigned __int128 uint128;

typedef struct {
    uint64_t word[WORDS]; /* low first, two's complement */
} wide;

static inline wide widened(int128 x)
{
    wide y;
    const uint64_t sign = x < 0 ? UINT64_MAX : 0;
    y.word[0] = (uint64_t)x, y.word[1] = (uint64_t)((uint128)x >> 64);
    for (int k = 2; k < WORDS; k++)
        y.word[k] = sign;
    return y;
}

static inline int negative(const wide *x) { return x->word[WORDS - 1] >> 63; }

static inline wide sum(wide x, wide y)
{
    uint64_t carry = 0;
    for (int k = 0; k < WORDS; k++) {
        const uint128 total = (uint128)x.word[k] + y.word[k] + carry;
        x.word[k] = (uint64_t)total, carry = (uint64_t)(total >> 64);
    }
    return x;
}

static inline wide opposite(wide x)
{
    for (int k = 0; k < WORDS; k++)
        x.word[k] = ~x.word[k];
    return sum(x, widened(1));
}

static inline wide difference(wide x, wide y) { return sum(x, opposite(y)); }

static inline wide product(wide x, wide y)
{
    wide z = {{0}};
    for (int i = 0; i < WORDS; i++) {
        uint64_t carry = 0;
        for (int j = 0; i + j < WORDS; j++) {
            const uint128 total = (uint128)x.word[i] * y.word[j] + z.word[i + j] + carry;
            z.word[i + j] = (uint64_t)total, carry = (uint64_t)(total >> 64);
        }
    }
    return z;
}

/* x 2^LIMB + y */
static inline wide appended(wide x, int128 y)
{
    for (int k = WORDS - 1; k > 0; k--)
        x.word[k] = x.word[k] << LIMB | x.word[k - 1] >> (64 - LIMB);
    x.word[0] <<= LIMB;
    return sum(x, widened(y));
}

/* Of the magnitude; of a negative number that of -x - 1. */
static inline int bits_of(const wide *x)
{
    const uint64_t sign = negative(x) ? UINT64_MAX : 0;
    for (int k = WORDS - 1; k >= 0; k--)
        if (x->word[k] != sign)
            return 64 * k + 64 - __builtin_clzll(x->word[k] ^ sign);
    return 0;
}

/* The lowest 128 bits of floor(x / 2^shift): all of it if x has no more than shift + 127 bits. */
static inline int128 floored(const wide *x, int shift)
{
    const uint64_t sign = negative(x) ? UINT64_MAX : 0;
    uint64_t part[3];
    for (int k = 0; k < 3; k++)
        part[k] = (shift >> 6) + k < WORDS ? x->word[(shift >> 6) + k] : sign;
    const int bits = shift & 63;
    if (bits)
        for (int k = 0; k < 2; k++)
            part[k] = part[k] >> bits | part[k + 1] << (64 - bits);
    return (int128)((uint128)part[1] << 64 | part[0]);
}

static inline double near(const wide *x)
{
    const int bits = bits_of(x), shift = bits > 64 ? bits - 64 : 0;
    return ldexp((double)floored(x, shift), shift);
}

/* Where the lowest bit is set and how many bits there are above it, of all numbers; over 2^-1074. */
typedef struct {
    int64_t lowest, bits;
} range;

static inline int64_t exponent_of(uint64_t bits) { const int64_t e = bits >> 52 & 2047; return e - (e != 0); }

static inline uint64_t mantissa_of(uint64_t bits)
{
    return (bits & ((UINT64_C(1) << 52) - 1)) | (uint64_t)((bits >> 52 & 2047) != 0) << 52;
}

static range range_of(const double *values, int64_t count)
{
    int64_t lowest = INT64_MAX, most = INT64_MIN;
    for (int64_t k = 0; k < count; k++) {
        uint64_t bits;
        memcpy(&bits, values + k, sizeof bits);
        const uint64_t m = mantissa_of(bits);
        if (m == 0)
            continue;
        const int64_t e = exponent_of(bits), low = e + __builtin_ctzll(m), high = e + 64 - __builtin_clzll(m);
        lowest = low < lowest ? low : lowest, most = high > most ? high : most;
    }
    return (range){lowest, lowest == INT64_MAX ? 0 : most - lowest};
}

/* A double over 2^(lowest - 1074): high 2^LIMB + low, 0 <= low < 2^LIMB. */
static inline void split(double value, int64_t lowest, int64_t *high, int64_t *low)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    const uint64_t m = mantissa_of(bits);
    const int64_t shift = m ? exponent_of(bits) - lowest : 0;
    const int128 size = shift >= 0 ? (int128)m << shift : (int128)(m >> -shift);
    const int128 x = bits >> 63 ? -size : size;
    *high = (int64_t)(x >> LIMB), *low = (int64_t)x & ((INT64_C(1) << LIMB) - 1);
}

/* Sums over the points, place k times 2^(LIMB k). */
typedef struct {
    int128 mass, source[3][4], target[3][4], cross[9][PLACES];
} sums;

/* The product of two numbers of two limbs, in four limbs, of which the first three are not negative. */
static inline void weighted(const int64_t w[2], const int64_t x[2], int64_t to[4])
{
    const int64_t mask = (INT64_C(1) << LIMB) - 1;
    int128 part = (int128)w[0] * x[0];
    to[0] = (int64_t)part & mask;
    part = (part >> LIMB) + (int128)w[1] * x[0] + (int128)w[0] * x[1];
    to[1] = (int64_t)part & mask;
    part = (part >> LIMB) + (int128)w[1] * x[1];
    to[2] = (int64_t)part & mask, to[3] = (int64_t)(part >> LIMB);
}

/* limbs: of a weighted coordinate, 2 where all weights are 1, else 4. */
static inline __attribute__((always_inline)) void add_points(
    sums *to, int limbs, int64_t count, const double *source, const double *target, const double *weights,
    const range seen[3])
{
    for (int64_t i = 0; i < count; i++) {
        int64_t x[3][2], wx[3][4], wy[3][4], w[2] = {1, 0};
        if (limbs == 4)
            split(weights[i], seen[2].lowest, w + 1, w);
        to->mass += (int128)w[1] * ((int128)1 << LIMB) + w[0];
        for (int k = 0; k < 3; k++) {
            int64_t y[2];
            split(source[3 * i + k], seen[0].lowest, x[k] + 1, x[k]);
            split(target[3 * i + k], seen[1].lowest, y + 1, y);
            if (limbs == 4)
                weighted(w, x[k], wx[k]), weighted(w, y, wy[k]);
            else
                memcpy(wx[k], x[k], sizeof x[k]), memcpy(wy[k], y, sizeof y);
            for (int l = 0; l < limbs; l++)
                to->source[k][l] += wx[k][l], to->target[k][l] += wy[k][l];
        }
        for (int k = 0; k < 9; k++)
            for (int l = 0; l < limbs; l++) {
                to->cross[k][l] += (int128)wy[k / 3][l] * x[k % 3][0];
                to->cross[k][l + 1] += (int128)wy[k / 3][l] * x[k % 3][1];
            }
    }
}

static inline wide gathered(const int128 *places, int count)
{
    wide total = {{0}};
    for (int k = count - 1; k >= 0; k--)
        total = appended(total, places[k]);
    return total;
}

typedef struct {
    wide mass, source[3], target[3], cross[9];
    int64_t a, b, c; /* exponents of the units of source, target, weights */
} moments;

/* Whether the numbers are of so few bits, and there are any. */
static int moments_of(
    int64_t count, const double *source, const double *target, const double *weights, moments *to)
{
    const range seen[3] = {range_of(source, 3 * count), range_of(target, 3 * count), range_of(weights, count)};
    sums added;
    if (count > CERTREG_MOST_POINTS)
        return 0;
    for (int k = 0; k < 3; k++)
        if (seen[k].lowest == INT64_MAX || seen[k].bits > 2 * LIMB)
            return 0;
    memset(&added, 0, sizeof added);
    int ones = seen[2].bits == 1;
    for (int64_t i = 0; i < count && ones; i++)
        ones = weights[i] == weights[0];
    if (ones)
        add_points(&added, 2, count, source, target, weights, seen);
    else
        add_points(&added, 4, count, source, target, weights, seen);
    to->mass = widened(added.mass);
    for (int k = 0; k < 3; k++) {
        to->source[k] = gathered(added.source[k], 4);
        to->target[k] = gathered(added.target[k], 4);
    }
    for (int k = 0; k < 9; k++)
        to->cross[k] = difference(
            product(to->mass, gathered(added.cross[k], PLACES)), product(to->target[k / 3], to->source[k % 3]));
    to->a = seen[0].lowest - 1074, to->b = seen[1].lowest - 1074, to->c = seen[2].lowest - 1074;
    return 1;
}

static inline uint64_t times(uint64_t x, uint64_t y) /* modulo PRIME = 2^61 - 1 */
{
    const uint128 z = (uint128)x * y;
    const uint64_t folded = ((uint64_t)z & PRIME) + (uint64_t)(z >> 61);
    return folded >= PRIME ? folded - PRIME : folded;
}

static inline uint64_t plus(uint64_t x, uint64_t y) { return (x + y) % PRIME; }
static inline uint64_t minus(uint64_t x, uint64_t y) { return (x + PRIME - y) % PRIME; }

static uint64_t residue(wide x)
{
    const int below = negative(&x);
    uint64_t rest = 0;
    if (below)
        x = opposite(x);
    for (int k = WORDS - 1; k >= 0; k--)
        rest = plus(times(rest, 8), x.word[k] % PRIME); /* 2^64 = 8 */
    return below ? minus(0, rest) : rest;
}

/* Whether the eigenvalues of C^T C are distinct, by their discriminant modulo a prime. 0: not proved. */
static int distinct(const wide cross[9])
{
    uint64_t c[9], p[9], e1, e2, e3, square = 0;
    for (int k = 0; k < 9; k++)
        c[k] = residue(cross[k]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            p[3 * i + j] = plus(plus(times(c[i], c[j]), times(c[3 + i], c[3 + j])), times(c[6 + i], c[6 + j]));
    e1 = plus(plus(p[0], p[4]), p[8]);
    e2 = minus(times(p[0], p[4]), times(p[1], p[1]));
    e2 = plus(e2, minus(times(p[0], p[8]), times(p[2], p[2])));
    e2 = plus(e2, minus(times(p[4], p[8]), times(p[5], p[5])));
    e3 = times(p[0], minus(times(p[4], p[8]), times(p[5], p[5])));
    e3 = minus(e3, times(p[1], minus(times(p[1], p[8]), times(p[5], p[2]))));
    e3 = plus(e3, times(p[2], minus(times(p[1], p[5]), times(p[4], p[2]))));
    const uint64_t e11 = times(e1, e1), e22 = times(e2, e2), e13 = times(e1, e3);
    square = plus(times(e11, e22), times(18, times(e13, e2)));
    square = minus(square, times(4, plus(times(e22, e2), times(e11, e13))));
    square = minus(square, times(27, times(e3, e3)));
    return square != 0;
}

/* T, row by row, and s. */
static int davenport_of(const wide c[9], int128 matrix[16])
{
    static const int upper[10] = {0, 1, 2, 3, 5, 6, 7, 10, 11, 15};
    const wide trace = sum(sum(c[0], c[4]), c[8]);
    const wide entries[10] = {
        trace, difference(c[7], c[5]), difference(c[2], c[6]), difference(c[3], c[1]),
        difference(sum(c[0], c[0]), trace), sum(c[1], c[3]), sum(c[2], c[6]),
        difference(sum(c[4], c[4]), trace), sum(c[5], c[7]), difference(sum(c[8], c[8]), trace)};
    int most = 0;
    for (int k = 0; k < 10; k++)
        most = bits_of(entries + k) > most ? bits_of(entries + k) : most;
    const int down = most > MATRIX_BITS ? most - MATRIX_BITS : 0, up = most < MATRIX_BITS ? MATRIX_BITS - most : 0;
    for (int k = 0; k < 10; k++) {
        const int i = upper[k] / 4, j = upper[k] % 4;
        matrix[4 * i + j] = matrix[4 * j + i] = floored(entries + k, down) * ((int128)1 << up);
    }
    return down - up; /* where that is negative, E is 0 */
}

/* A unit vector in doubles times 2^UNIT_BITS, and about half of the gap above the second eigenvalue. */
static int proposed(const int128 matrix[16], int64_t q[4], int128 *half)
{
    lanes k[16], values[4], vectors[16];
    for (int i = 0; i < 16; i++)
        k[i] = all((double)matrix[i]);
    eigenbasis(k, values, vectors);
    for (int i = 0; i < 4; i++) {
        if (!(fabs(vectors[i][0]) < 2))
            return 0;
        q[i] = (int64_t)rint(ldexp(vectors[i][0], UNIT_BITS));
    }
    const double gap = values[0][0] - values[1][0];
    if (!(gap > 0x1p20 && gap < 0x1p120))
        return 0;
    *half = (int128)(gap * (31.0 / 64));
    return 1;
}

/* Whether U - 3 I is positive definite, of the upper triangle in the order 11 12 13 22 23 33 of S. */
static int definite(const wide entries[6])
{
    int most = BLOCK_BITS;
    int128 u[6];
    for (int k = 0; k < 6; k++)
        most = bits_of(entries + k) > most ? bits_of(entries + k) : most;
    for (int k = 0; k < 6; k++)
        u[k] = floored(entries + k, most - BLOCK_BITS) - (k == 0 || k == 3 || k == 5 ? 3 : 0);
    const int128 minor = u[0] * u[3] - u[1] * u[1];
    const wide a = product(widened(minor), widened(u[5]));
    const wide b = product(widened(u[0] * u[4] - u[1] * u[2]), widened(u[4]));
    const wide c = product(widened(u[1] * u[4] - u[3] * u[2]), widened(u[2]));
    const wide last = sum(difference(a, b), c);
    return u[0] > 0 && minor > 0 && !negative(&last) && bits_of(&last) > 0;
}

/* The columns of L. */
static inline void across(const int64_t q[4], int64_t l[3][4])
{
    const int64_t w = q[0], x = q[1], y = q[2], z = q[3];
    const int64_t columns[3][4] = {{-x, w, z, -y}, {-y, -z, w, x}, {-z, y, -x, w}};
    memcpy(l, columns, sizeof columns);
}

static inline void applied(const int128 matrix[16], const int64_t v[4], wide to[4])
{
    for (int i = 0; i < 4; i++) {
        to[i] = widened(0);
        for (int j = 0; j < 4; j++)
            to[i] = sum(to[i], product(widened(matrix[4 * i + j]), widened(v[j])));
    }
}

static inline wide along(const int64_t v[4], const wide x[4])
{
    wide total = widened(0);
    for (int i = 0; i < 4; i++)
        total = sum(total, product(widened(v[i]), x[i]));
    return total;
}

/* delta that is proved with mu = half, of R(q); all over 2^s. 0: not proved. */
static int proved(const int128 matrix[16], const int64_t q[4], int128 half, int128 *delta)
{
    int64_t l[3][4];
    wide image[4], moved[3][4], block[6];
    int128 norm = 0;
    uint128 square = 0;
    for (int i = 0; i < 4; i++)
        norm += (int128)q[i] * q[i];
    if (norm < ((int128)1 << 2 * UNIT_BITS) - ((int128)1 << (2 * UNIT_BITS - 49)))
        return 0;
    across(q, l);
    applied(matrix, q, image);
    for (int k = 0; k < 3; k++) {
        wide c = along(l[k], image);
        if (negative(&c))
            c = opposite(c);
        if (bits_of(&c) > 2 * UNIT_BITS + 60)
            return 0;
        /* |c| / norm <= x 2^104 / norm <= x / (1 - 2^-49) <= x (1 + 2^-48) */
        const uint128 x = (uint128)floored(&c, 2 * UNIT_BITS) + 1, r = x + (x >> 48) + 1 + 4;
        square += r * r; /* below 3 2^122 */
    }
    *delta = (int128)(square / (uint128)half) + 1;
    const wide level = difference(along(q, image), product(widened(2 * half + 8), widened(norm)));
    for (int k = 0; k < 3; k++)
        applied(matrix, l[k], moved[k]);
    for (int i = 0, k = 0; i < 3; i++)
        for (int j = i; j < 3; j++, k++)
            block[k] = difference(i == j ? level : widened(0), along(l[i], moved[j]));
    return definite(block);
}

/* m 2^e */
typedef struct {
    uint128 m;
    int64_t e;
} dyadic;

static dyadic shortened(uint128 m, int64_t e, int bits, int up)
{
    while (m >> bits) { /* a few times: by as much as can be seen of it */
        const uint64_t top = (uint64_t)(m >> 64);
        const int long_by = (top ? 128 - __builtin_clzll(top) : 64 - __builtin_clzll((uint64_t)m)) - bits;
        const uint128 rest = m & (((uint128)1 << long_by) - 1);
        m = (m >> long_by) + (up && rest != 0);
        e += long_by;
    }
    return (dyadic){m, e};
}

/* x / y to CLAIM_BITS, rounded up or down; y > 0. */
static dyadic quotient(dyadic x, dyadic y, int up)
{
    x = shortened(x.m, x.e, 62, up), y = shortened(y.m, y.e, 62, !up);
    while (x.m && !(x.m >> 61))
        x.m <<= 1, x.e--;
    const uint128 above = x.m << 62;
    return shortened(above / y.m + (up && above % y.m != 0), x.e - y.e - 62, CLAIM_BITS, up);
}

static inline void put(dyadic from, int64_t to[2]) { to[0] = (int64_t)from.m, to[1] = from.e; }

static int pose_of(const moments *given, const int64_t q[4], double pose[16])
{
    lanes unit[4], turn[9];
    double mean[2][3], squares = 0;
    const double mass = near(&given->mass);
    for (int i = 0; i < 4; i++)
        unit[i] = all(ldexp((double)q[i], -UNIT_BITS)), squares += unit[i][0] * unit[i][0];
    rotation(unit, turn);
    for (int k = 0; k < 3; k++) {
        mean[0][k] = ldexp(near(given->source + k) / mass, (int)given->a);
        mean[1][k] = ldexp(near(given->target + k) / mass, (int)given->b);
    }
    for (int i = 0; i < 3; i++) {
        double moved = 0;
        for (int k = 0; k < 3; k++) {
            pose[4 * i + k] = turn[3 * i + k][0] / squares;
            moved += pose[4 * i + k] * mean[0][k];
        }
        pose[4 * i + 3] = mean[1][i] - moved;
        if (!isfinite(pose[4 * i + 3]))
            return 0;
    }
    pose[12] = pose[13] = pose[14] = 0, pose[15] = 1;
    return 1;
}

static int certified(const struct certreg_pairs *pairs, int64_t number)
{
    const int64_t *start = pairs->starts + 3 * number;
    int64_t *q = pairs->quaternions + 4 * number;
    int128 matrix[16], half, delta;
    moments given;
    if (!moments_of(pairs->sizes[number], pairs->source + 3 * start[0], pairs->target + 3 * start[1],
            pairs->weights + start[2], &given))
        return 0;
    const int64_t unit = davenport_of(given.cross, matrix) + given.a + given.b + given.c;
    if (!distinct(given.cross) || !proposed(matrix, q, &half) || !proved(matrix, q, half, &delta))
        return 0;
    const dyadic mass = {(uint128)floored(&given.mass, 0), 0};
    const dyadic gap = quotient((dyadic){(uint128)delta, unit}, mass, 1);
    const dyadic mu = quotient((dyadic){(uint128)half, unit}, mass, 0);
    put(gap, pairs->delta + 2 * number);
    put(mu, pairs->mu + 2 * number);
    put(quotient(gap, mu, 1), pairs->sine + 2 * number);
    return mu.m != 0 && pose_of(&given, q, pairs->poses + 16 * number);
}

void certreg_prove_optima(const struct certreg_pairs *pairs)
{
    for (int64_t number = 0; number < pairs->count; number++)
        pairs->proved[number] = (uint8_t)certified(pairs, number);
}

#else

void certreg_prove_optima(const struct certreg_pairs *pairs)
{
    memset(pairs->proved, 0, (size_t)pairs->count);
}

#endif
