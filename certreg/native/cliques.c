/* Large cliques, where searches for poses begin, and all cliques of a size. */
#include "cliques.h"

#include <string.h>

#define BITS 64

static inline int64_t common(const uint64_t *a, const uint64_t *b, int64_t words)
{
    int64_t count = 0;
    for (int64_t k = 0; k < words; k++)
        count += __builtin_popcountll(a[k] & b[k]);
    return count;
}

void certreg_triangles(int64_t words, const uint64_t *near, const uint64_t *alive, int64_t *counts)
{
    for (int64_t word = 0; word < words; word++)
        for (uint64_t rows = alive[word]; rows; rows &= rows - 1) {
            const int64_t row = BITS * word + __builtin_ctzll(rows);
            const uint64_t *const own = near + row * words;
            counts[row] = 0;
            for (int64_t k = 0; k < words; k++)
                for (uint64_t others = own[k] & alive[k]; others; others &= others - 1) {
                    const uint64_t *const theirs = near + (BITS * k + __builtin_ctzll(others)) * words;
                    for (int64_t m = 0; m < words; m++)
                        counts[row] += __builtin_popcountll(own[m] & theirs[m] & alive[m]);
                }
        }
}

int64_t certreg_greedy_clique(int64_t words, const uint64_t *near, const uint64_t *alive, int64_t row, int64_t *clique,
                              int64_t *counts, uint64_t *left)
{
    int64_t taken = 0;
    for (int64_t k = 0; k < words; k++)
        left[k] = near[row * words + k] & alive[k];
    for (int64_t k = 0; k < words; k++)
        for (uint64_t rows = left[k]; rows; rows &= rows - 1) {
            const int64_t one = BITS * k + __builtin_ctzll(rows);
            counts[one] = common(near + one * words, left, words);
        }
    for (;;) {
        int64_t best = -1;
        for (int64_t k = 0; k < words; k++)
            for (uint64_t rows = left[k]; rows; rows &= rows - 1) {
                const int64_t one = BITS * k + __builtin_ctzll(rows);
                best = best < 0 || counts[one] > counts[best] ? one : best;
            }
        if (best < 0)
            return taken;
        clique[taken++] = best;
        for (int64_t k = 0; k < words; k++)
            for (uint64_t gone = left[k] & ~near[best * words + k]; gone; gone &= gone - 1) {
                const uint64_t *const theirs = near + (BITS * k + __builtin_ctzll(gone)) * words;
                for (int64_t m = 0; m < words; m++)
                    for (uint64_t rows = theirs[m] & left[m]; rows; rows &= rows - 1)
                        counts[BITS * m + __builtin_ctzll(rows)]--;
            }
        for (int64_t k = 0; k < words; k++)
            left[k] &= near[best * words + k];
    }
}

/* The lowest row left, taken away; -1 if there is none. */
static inline int64_t first_of(uint64_t *left, int64_t words)
{
    for (int64_t k = 0; k < words; k++)
        if (left[k]) {
            const int64_t row = BITS * k + __builtin_ctzll(left[k]);
            left[k] &= left[k] - 1;
            return row;
        }
    return -1;
}

int64_t certreg_cliques(struct certreg_enumeration *s, int64_t most, int64_t *cliques)
{
    int64_t found = 0;
    while (s->depth >= 0 && found < most) {
        uint64_t *const left = s->left + s->depth * s->words;
        const int64_t missing = s->size - s->depth;
        if (--s->steps < 0)
            break;
        if (common(left, left, s->words) < missing) {
            s->depth--;
            continue;
        }
        const int64_t row = first_of(left, s->words);
        s->path[s->depth] = row;
        if (missing == 1) {
            s->steps -= s->dear;
            memcpy(cliques + s->size * found++, s->path, sizeof *cliques * (size_t)s->size);
            continue;
        }
        for (int64_t k = 0; k < s->words; k++)
            left[s->words + k] = left[k] & s->near[row * s->words + k];
        s->depth++;
    }
    return found;
}
