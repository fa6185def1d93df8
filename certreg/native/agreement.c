/* Pairs of rows whose lengths agree, 64 by 64.
 *
 * With A, B the squared lengths and s = A + B: |a - b| <= d iff s <= d^2 or (A - B)^2 <= d^2 (2 s - d^2), for
 * the difference of the two sides of the last is D^2 - 4 A B, D = s - d^2. No root is drawn.
 *
 * Errors, e = 2^-53: A, B and s are right to 6 e of themselves, A - B to 7 e s, d^2 to 4 e. Where s is not
 * below (1 - ERROR) d^2, 2 s - d^2 is at least about s, so it is right to 20 e of itself, and the right side to
 * 26 e; the square of A - B to 15 e |A - B| s + (7 e s)^2. ERROR is 128 e, TINY more than what underflows. */
#include "agreement.h"

#include <math.h>

#define ROWS 64 /* of a block: the bits of a word */
#define ERROR 0x1p-46
#define SQUARED_ERROR 0x1p-92
#define TINY 1e-300

/* One row against 64 others: bits of those that agree, and of those that doubles leave open. */
static inline void against(const double row[7], const double *others, int64_t step, uint64_t *agree, uint64_t *open)
{
    int64_t yes[ROWS], unsure[ROWS];
    uint64_t agreeing = 0, undecided = 0;
    for (int k = 0; k < ROWS; k++) {
        double squares[2];
        for (int cloud = 0; cloud < 2; cloud++) {
            const double *p = others + 3 * cloud * step + k;
            const double x = p[0] - row[3 * cloud], y = p[step] - row[3 * cloud + 1],
                         z = p[2 * step] - row[3 * cloud + 2];
            squares[cloud] = x * x + y * y + z * z;
        }
        const double d = row[6] + others[6 * step + k], dd = d * d;
        const double s = squares[0] + squares[1], off = fabs(squares[0] - squares[1]);
        const double right = dd * (2 * s - dd), gap = right - off * off;
        const double error = ERROR * (s * off + fabs(right)) + SQUARED_ERROR * s * s + TINY;
        const int64_t close = s + TINY <= (1 - ERROR) * dd, apart = s > (1 + ERROR) * dd + TINY;
        yes[k] = close | (gap > error);
        unsure[k] = !(yes[k] | (apart & (gap < -error)));
    }
    for (int k = 0; k < ROWS; k++) {
        agreeing |= (uint64_t)yes[k] << k;
        undecided |= (uint64_t)unsure[k] << k;
    }
    *agree = agreeing, *open = undecided;
}

/* 64 rows of 64 bits, mirrored at the diagonal. */
static inline void transpose(uint64_t block[ROWS])
{
    uint64_t mask = 0xffffffff;
    for (int width = ROWS / 2; width; width /= 2, mask ^= mask << width)
        for (int k = 0; k < ROWS; k = (k + width + 1) & ~width) {
            const uint64_t changed = (block[k] >> width ^ block[k + width]) & mask;
            block[k] ^= changed << width, block[k + width] ^= changed;
        }
}

int64_t certreg_agreeing(int64_t count, int64_t words, const double *columns, uint64_t *near, uint64_t *doubtful)
{
    const int64_t step = ROWS * words;
    int64_t open = 0;
    for (int64_t i = 0; i < words; i++)
        for (int64_t j = i; j < words; j++) {
            const int64_t height = count - ROWS * i < ROWS ? count - ROWS * i : ROWS, width = count - ROWS * j;
            const uint64_t valid = width < ROWS ? ((uint64_t)1 << width) - 1 : UINT64_MAX;
            uint64_t parts[2][ROWS] = {{0}};
            for (int64_t k = 0; k < height; k++) {
                double row[7];
                for (int c = 0; c < 7; c++)
                    row[c] = columns[c * step + ROWS * i + k];
                against(row, columns + ROWS * j, step, &parts[0][k], &parts[1][k]);
                for (int part = 0; part < 2; part++)
                    parts[part][k] &= i == j ? valid & ~((uint64_t)1 << k) : valid;
                open += __builtin_popcountll(parts[1][k]) * (i == j ? 1 : 2);
            }
            for (int part = 0; part < 2; part++) {
                uint64_t *const to = part ? doubtful : near;
                for (int64_t k = 0; k < height; k++)
                    to[(ROWS * i + k) * words + j] = parts[part][k];
                transpose(parts[part]);
                for (int64_t k = 0; i != j && k < ROWS && k < width; k++)
                    to[(ROWS * j + k) * words + i] = parts[part][k];
            }
        }
    return open;
}
