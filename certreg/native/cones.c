/* A form of degree four is shown to be positive outside of caps, cone by cone.
 *
 * On the cone of v_0 ... v_3 the form is a sum of terms b_m M(m) s^m over q = s_0 v_0 + ... + s_3 v_3, s >= 0, M
 * the multinomials, so it is positive there where all 35 b_m are. Where they are not, and the cone does not lie
 * in a cap, an edge is cut in the middle: by de Casteljau's rule the new coefficients are means of two, again and
 * again. A mean is rounded down, so that what is shown of these integers holds for the form itself. They are those
 * of the checker, which cuts the same cones by itself; caps and vertices are doubles here, and caps a bit smaller,
 * so that it looks at no cone that is not looked at here. */
#include "cones.h"

#include <stdlib.h>
#include <string.h>

#ifdef __SIZEOF_INT128__

typedef __int128 wide;

#define COEFFICIENTS CERTREG_CONE_COEFFICIENTS
#define EDGES 6
#define ROWS 15        /* of coefficients along an edge: one for each pair of powers of the other two vertices */
#define ROUND 8        /* every so many cuts an edge is cut that is due, not the one that bends most: cones shrink */
#define INSIDE 0x1p-20 /* of a cap's sine: so much less is inside, whatever doubles lose */

static const int edges[EDGES][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

struct row {
    int degree, places[5]; /* the second vertex of the edge with the powers 0 ... degree */
};

struct tables {
    struct row rows[EDGES][ROWS]; /* the last one is of no other vertex */
    int vertices[4];              /* the coefficients that are values there */
};

struct cone {
    wide bernstein[COEFFICIENTS];
    double vertices[4][4];
    int cuts;
};

static void fill(struct tables *tables)
{
    int place[5][5][5] = {{{0}}}, next = 0; /* by the powers of the first three */
    for (int a = 0; a < 4; a++)
        for (int b = a; b < 4; b++)
            for (int c = b; c < 4; c++)
                for (int d = c; d < 4; d++) {
                    int powers[4] = {0};
                    powers[a]++, powers[b]++, powers[c]++, powers[d]++;
                    if (a == d)
                        tables->vertices[a] = next;
                    place[powers[0]][powers[1]][powers[2]] = next++;
                }
    for (int k = 0; k < EDGES; k++) {
        const int i = edges[k][0], j = edges[k][1];
        const int other = i ? 0 : j == 1 ? 2 : 1, last = 6 - i - j - other;
        struct row *row = tables->rows[k];
        for (int degree = 0; degree <= 4; degree++)
            for (int a = 0; a <= 4 - degree; a++, row++) {
                row->degree = degree;
                for (int b = 0; b <= degree; b++) {
                    int powers[4] = {0};
                    powers[other] = a, powers[last] = 4 - degree - a, powers[i] = degree - b, powers[j] = b;
                    row->places[b] = place[powers[0]][powers[1]][powers[2]];
                }
            }
    }
}

static inline int holds(const struct certreg_cap *cap, const double *vertex, double *along)
{
    double across = 0, square = 0, *const dot = along;
    *dot = 0;
    for (int a = 0; a < 4; a++) {
        *dot += vertex[a] * cap->centre[a], square += vertex[a] * vertex[a];
        for (int b = 0; b < a; b++) {
            const double part = vertex[a] * cap->centre[b] - vertex[b] * cap->centre[a];
            across += part * part;
        }
    }
    return across <= (1 - INSIDE) * cap->sine * square;
}

/* A cap is convex: a cone lies in it or its mirror image if all vertices do. */
static int in_a_cap(const struct certreg_cones *search, const struct cone *cone)
{
    for (int64_t k = 0; k < search->cap_count; k++) {
        double along[4];
        int inside = 1;
        for (int i = 0; i < 4 && inside; i++)
            inside = holds(&search->caps[k], cone->vertices[i], &along[i]) && along[i] * along[0] > 0;
        if (inside)
            return 1;
    }
    return 0;
}

/* Whether the form is not positive at a vertex that no cap holds. */
static int refutes(struct certreg_cones *search, const struct tables *tables, const struct cone *cone)
{
    for (int i = 0; i < 4; i++) {
        int64_t k = cone->bernstein[tables->vertices[i]] > 0 ? search->cap_count + 1 : 0;
        double along;
        while (k < search->cap_count && !holds(&search->caps[k], cone->vertices[i], &along))
            k++;
        if (k == search->cap_count) {
            memcpy(search->vertex, cone->vertices[i], sizeof search->vertex);
            return 1;
        }
    }
    return 0;
}

static inline wide bend(const wide *b, const int *places)
{
    const wide second = b[places[0]] - 2 * b[places[1]] + b[places[2]];
    return second < 0 ? -second : second;
}

/* The edge along which the coefficients bend most; or the one that is due. */
static int edge_to_cut(const struct tables *tables, const struct cone *cone)
{
    if (cone->cuts % ROUND == ROUND - 1)
        return cone->cuts / ROUND % EDGES;
    int best = 0;
    wide most = -1;
    for (int k = 0; k < EDGES; k++)
        for (int a = 0; a <= 2; a++) {
            const wide here = bend(cone->bernstein, tables->rows[k][ROWS - 1].places + a);
            if (here > most)
                most = here, best = k;
        }
    return best;
}

static inline wide mean_below(wide a, wide b) { return (a + b) >> 1; }

/* The two halves: without the second vertex of the edge, and without the first. */
static void cut(const struct tables *tables, const struct cone *whole, int edge, struct cone *left,
                struct cone *right)
{
    const int i = edges[edge][0], j = edges[edge][1];
    *left = *right = *whole;
    left->cuts = right->cuts = whole->cuts + 1;
    for (int a = 0; a < 4; a++)
        left->vertices[j][a] = right->vertices[i][a] = 0.5 * (whole->vertices[i][a] + whole->vertices[j][a]);
    for (const struct row *row = tables->rows[edge]; row < tables->rows[edge] + ROWS; row++) {
        wide b[5];
        for (int k = 0; k <= row->degree; k++)
            b[k] = whole->bernstein[row->places[k]];
        for (int level = 0; level <= row->degree; level++) {
            left->bernstein[row->places[level]] = b[0];
            right->bernstein[row->places[row->degree - level]] = b[row->degree - level];
            for (int k = 0; k < row->degree - level; k++)
                b[k] = mean_below(b[k], b[k + 1]);
        }
    }
}

static inline wide least(const wide *b)
{
    wide found = b[0];
    for (int k = 1; k < COEFFICIENTS; k++)
        found = b[k] < found ? b[k] : found;
    return found;
}

static wide integer(const uint64_t *words)
{
    return (wide)((unsigned __int128)words[1] << 64 | words[0]);
}

static int run(struct certreg_cones *search, struct cone *stack)
{
    struct tables tables;
    int waiting = CERTREG_ORTHANTS;
    fill(&tables);
    memset(stack, 0, CERTREG_ORTHANTS * sizeof *stack);
    for (int orthant = 0; orthant < CERTREG_ORTHANTS; orthant++) {
        struct cone *cone = &stack[CERTREG_ORTHANTS - 1 - orthant];
        for (int k = 0; k < COEFFICIENTS; k++)
            cone->bernstein[k] = integer(search->orthants + 2 * (COEFFICIENTS * orthant + k));
        for (int i = 0; i < 4; i++)
            cone->vertices[i][i] = i && orthant >> (i - 1) & 1 ? -1 : 1;
    }
    search->seen = search->deepest = 0;
    while (waiting) {
        const struct cone cone = stack[--waiting];
        if (search->seen++ == search->budget)
            return CERTREG_CONES_BUDGET;
        search->deepest = cone.cuts > search->deepest ? cone.cuts : search->deepest;
        if (least(cone.bernstein) > 0 || in_a_cap(search, &cone))
            continue;
        if (refutes(search, &tables, &cone))
            return CERTREG_CONES_NOT_POSITIVE;
        if (cone.cuts == CERTREG_CONE_CUTS)
            return CERTREG_CONES_DEEP;
        cut(&tables, &cone, edge_to_cut(&tables, &cone), &stack[waiting], &stack[waiting + 1]);
        waiting += 2;
    }
    return CERTREG_CONES_POSITIVE;
}

int certreg_cones(struct certreg_cones *search)
{
    struct cone *stack = malloc((CERTREG_ORTHANTS + CERTREG_CONE_CUTS + 1) * sizeof *stack);
    const int ending = stack ? run(search, stack) : CERTREG_CONES_ABSENT;
    free(stack);
    return ending;
}

#else

int certreg_cones(struct certreg_cones *search)
{
    (void)search;
    return CERTREG_CONES_ABSENT;
}

#endif
