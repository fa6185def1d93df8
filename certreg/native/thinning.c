/* Striking rows of a graph that are in no large clique: by their degrees, by the colours of their neighbours. */
#include "thinning.h"

#include <stdlib.h>
#include <string.h>

#define BITS 64

static inline int64_t size_of(const uint64_t *mask, int64_t words)
{
    int64_t count = 0;
    for (int64_t k = 0; k < words; k++)
        count += __builtin_popcountll(mask[k]);
    return count;
}

/* Takes the lowest row and every later one that is no neighbour of those taken; how many. */
static inline int64_t one_colour(int64_t words, const uint64_t *near, uint64_t *rows, uint64_t *free)
{
    int64_t first = 0, taken = 0;
    while (first < words && !rows[first])
        first++;
    memcpy(free + first, rows + first, sizeof *free * (size_t)(words - first));
    for (int64_t word = first; word < words; word++)
        while (free[word]) {
            const uint64_t low = free[word] & -free[word];
            const uint64_t *beside = near + (BITS * word + __builtin_ctzll(low)) * words;
            rows[word] ^= low, free[word] ^= low, taken++;
            for (int64_t k = word; k < words; k++)
                free[k] &= ~beside[k];
        }
    return taken;
}

/* Strikes the rows in the queue up to `end`, and those that have too few neighbours by then. */
static void follow(struct certreg_thinning *t, int64_t end)
{
    for (int64_t next = 0; next < end; next++) {
        const int64_t row = t->queue[next];
        t->alive[row / BITS] &= ~((uint64_t)1 << row % BITS);
        t->count--;
        for (int64_t word = 0; word < t->words; word++)
            for (uint64_t left = t->near[row * t->words + word] & t->alive[word]; left; left &= left - 1) {
                const int64_t other = BITS * word + __builtin_ctzll(left);
                if (t->degrees[other]-- == t->least - 1)
                    t->queue[end++] = other;
            }
    }
}

void certreg_thin(struct certreg_thinning *t)
{
    int64_t end = 0;
    t->count = size_of(t->alive, t->words);
    for (int64_t row = 0; row < t->rows; row++) {
        t->failed[row] = -1;
        if (!(t->alive[row / BITS] >> row % BITS & 1))
            continue;
        int64_t degree = 0;
        for (int64_t k = 0; k < t->words; k++)
            degree += __builtin_popcountll(t->near[row * t->words + k] & t->alive[k]);
        t->degrees[row] = degree;
        if (degree < t->least - 1)
            t->queue[end++] = row;
    }
    follow(t, end);
}

void certreg_strike(struct certreg_thinning *t, int64_t row)
{
    t->queue[0] = row;
    follow(t, 1);
}

void certreg_cut(struct certreg_thinning *t, int64_t row, int64_t other)
{
    const int64_t ends[2] = {row, other};
    int64_t end = 0;
    for (int k = 0; k < 2; k++) {
        t->near[ends[k] * t->words + ends[1 - k] / BITS] &= ~((uint64_t)1 << ends[1 - k] % BITS);
        if (t->degrees[ends[k]]-- == t->least - 1)
            t->queue[end++] = ends[k];
    }
    for (int64_t k = 0; k < t->rows; k++)
        t->failed[k] = -1; /* of common neighbours, colours may be fewer now */
    follow(t, end);
}

static int ascending(const void *one, const void *other)
{
    const int64_t a = *(const int64_t *)one, b = *(const int64_t *)other;
    return (a > b) - (a < b);
}

void certreg_begin(struct certreg_thinning *t)
{
    int64_t count = 0;
    for (int64_t row = 0; row < t->rows; row++)
        if ((t->alive[row / BITS] & ~t->clique[row / BITS]) >> row % BITS & 1)
            t->order[count++] = t->degrees[row] * t->rows + row;
    qsort(t->order, (size_t)count, sizeof *t->order, ascending);
    for (int64_t k = 0; k < count; k++)
        t->order[k] %= t->rows;
    t->tried = count, t->next = 0;
}

/* The next row of a pass that is alive; -1 at the end, or where too few are left. */
static int64_t next_alive(struct certreg_thinning *t)
{
    while (t->count >= t->least && t->next < t->tried) {
        const int64_t row = t->order[t->next++];
        if (t->alive[row / BITS] >> row % BITS & 1)
            return row;
    }
    return -1;
}

/* Whether the neighbours of a row take fewer than `least` - 1 colours. */
static int few_colours(struct certreg_thinning *t, int64_t row)
{
    const int64_t most = t->least - 2;
    int64_t inside = 0, left = t->degrees[row], count = 0;
    if (t->failed[row] == left) /* the same neighbours: none comes back */
        return 0;
    for (int64_t k = 0; k < t->words; k++) {
        t->masks[k] = t->near[row * t->words + k] & t->alive[k];
        inside += __builtin_popcountll(t->masks[k] & t->clique[k]);
    }
    if (inside > most)
        return 0;
    for (; left + count > most && count <= most && left; count++)
        left -= one_colour(t->words, t->near, t->masks, t->masks + t->words);
    if (left + count > most)
        t->failed[row] = t->degrees[row];
    return left + count <= most;
}

int64_t certreg_strike_by_colours(struct certreg_thinning *t, int64_t *struck)
{
    int64_t fallen = 0, before;
    do {
        before = fallen;
        certreg_begin(t);
        for (int64_t row = next_alive(t); row >= 0; row = next_alive(t))
            if (few_colours(t, row)) {
                struck[fallen++] = row;
                certreg_strike(t, row);
            }
    } while (fallen > before);
    return fallen;
}

int64_t certreg_next(struct certreg_thinning *t)
{
    for (int64_t row = next_alive(t); row >= 0; row = next_alive(t)) {
        int64_t inside = 0, left = 0, count = 0;
        for (int64_t k = 0; k < t->words; k++) {
            const uint64_t beside = t->near[row * t->words + k] & t->alive[k];
            inside += __builtin_popcountll(beside & t->clique[k]);
            t->masks[k] = beside & ~t->clique[k];
            left += __builtin_popcountll(t->masks[k]);
        }
        for (; left && inside && count < t->least - 1; count++)
            left -= one_colour(t->words, t->near, t->masks, t->masks + t->words);
        t->spare = inside + count - (t->least - 1);
        if (!left && 0 <= t->spare && t->spare < inside)
            return row;
    }
    return -1;
}

int64_t certreg_colours(struct certreg_thinning *t, int64_t most)
{
    int64_t left = size_of(t->masks, t->words), count = 0;
    for (; left && count <= most; count++)
        left -= one_colour(t->words, t->near, t->masks, t->masks + t->words);
    return count;
}
