/* The critical lines of a quartic F on complex quaternions, grad F(q) = l q, tracked from those of
 * G = sum a_i q_i^4 along t G + (1 - t) F, t from 1 to 0. The same steps as in equilibrium/tracking.py, one path
 * after another. Of each line the point with chart . q = 1 is followed; where it goes far, the chart is changed. */
#include "paths.h"

#include <math.h>
#include <string.h>

#define ENTRIES 4
#define PAIRS 10 /* q_i q_j, i <= j */
#define UNKNOWNS 5
#define SIDES 2 /* of the linear systems: Newton's change and the tangent */

typedef struct {
    double re, im;
} number;

static inline number plus(number a, number b) { return (number){a.re + b.re, a.im + b.im}; }
static inline number minus(number a, number b) { return (number){a.re - b.re, a.im - b.im}; }
static inline number times(number a, number b)
{
    return (number){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
static inline number scaled(double s, number a) { return (number){s * a.re, s * a.im}; }
static inline double squared(number a) { return a.re * a.re + a.im * a.im; }
static inline number inverse(number a)
{
    const double size = squared(a);
    return (number){a.re / size, -a.im / size};
}

#define NEWTON_ROUNDS 8 /* three are usual */
#define LONGEST_TURN 0.1 /* radians: beyond, the start is not near */
#define SHORTEST_TURN 1e-9 /* squared, nothing is left */
#define LARGEST_CONDITION 1e8 /* of a Hessian: what more is singular is for slower means */
#define FAR 4 /* |chart| |q|: at least 1, and 1 in a chart of its own */

#define NEARLY 1e-6 /* t where a path that is stuck is at a singular end: the residual tells */
#define LEAST_GAIN 4 /* of Newton's changes, one over the next: at a double root it is 2 */

struct system {
    double table[PAIRS][PAIRS]; /* of the products q_k q_m the entries of F'', in the same order */
    number a[ENTRIES], chart[ENTRIES];
};

typedef struct {
    number x[UNKNOWNS]; /* q, l */
} point;

struct place { /* of a path at t, with its tangent */
    point at, slope;
    double t;
};

struct matrix {
    number row[UNKNOWNS][UNKNOWNS + SIDES];
};

static const int pair[ENTRIES][ENTRIES] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};

/* Each coefficient, of a monomial q_i q_j q_k q_m, in all orders of its factors: once into each entry of F'' by
 * two of them, half into the product of the others, as both of their orders come up. */
static void make_table(const double *quartic, double table[PAIRS][PAIRS])
{
    memset(table, 0, sizeof(double) * PAIRS * PAIRS);
    for (int i = 0, place = 0; i < ENTRIES; i++)
        for (int j = i; j < ENTRIES; j++)
            for (int k = j; k < ENTRIES; k++)
                for (int m = k; m < ENTRIES; m++, place++) {
                    const int factor[4] = {i, j, k, m};
                    for (int one = 0; one < 4; one++)
                        for (int other = 0; other < 4; other++) {
                            if (one == other || factor[one] > factor[other])
                                continue; /* entries on and above the diagonal */
                            int rest[2], found = 0;
                            for (int p = 0; p < 4; p++)
                                if (p != one && p != other)
                                    rest[found++] = factor[p];
                            table[pair[rest[0]][rest[1]]][pair[factor[one]][factor[other]]] += quartic[place];
                        }
                }
}

/* F''(q), on and above the diagonal. */
static inline void second_derivatives(const struct system *system, const number q[ENTRIES], number hessian[PAIRS])
{
    double re[PAIRS] = {0}, im[PAIRS] = {0};
    for (int k = 0; k < ENTRIES; k++)
        for (int m = k; m < ENTRIES; m++) {
            const number product = times(q[k], q[m]);
            const double *row = system->table[pair[k][m]];
            for (int e = 0; e < PAIRS; e++) {
                re[e] += row[e] * product.re;
                im[e] += row[e] * product.im;
            }
        }
    for (int e = 0; e < PAIRS; e++)
        hessian[e] = (number){re[e], im[e]};
}

/* The Jacobian of the system at t and, beside it, its values and their derivatives in t. */
static void linearised(const struct system *system, const point *at, double t, struct matrix *to)
{
    const number *q = at->x, l = at->x[ENTRIES];
    number hessian[PAIRS];
    second_derivatives(system, q, hessian);
    number on_chart = {-1, 0};
    for (int i = 0; i < ENTRIES; i++) {
        number slope = {0, 0};
        for (int j = 0; j < ENTRIES; j++) {
            const number entry = hessian[pair[i][j]];
            slope = plus(slope, times(entry, q[j]));
            to->row[i][j] = scaled(1 - t, entry);
        }
        slope = scaled(1.0 / 3, slope);
        const number cube = times(system->a[i], times(q[i], q[i]));
        const number start = scaled(4, times(cube, q[i]));
        to->row[i][i] = minus(plus(to->row[i][i], scaled(12 * t, cube)), l);
        to->row[i][ENTRIES] = scaled(-1, q[i]);
        to->row[i][UNKNOWNS] = minus(plus(scaled(1 - t, slope), scaled(t, start)), times(l, q[i]));
        to->row[i][UNKNOWNS + 1] = minus(start, slope);
        to->row[ENTRIES][i] = system->chart[i];
        on_chart = plus(on_chart, times(system->chart[i], q[i]));
    }
    to->row[ENTRIES][ENTRIES] = (number){0, 0};
    to->row[ENTRIES][UNKNOWNS] = on_chart;
    to->row[ENTRIES][UNKNOWNS + 1] = (number){0, 0};
}

/* Gauss elimination with row pivots, in place; the columns from UNKNOWNS on become solutions. */
static void solve(struct matrix *of, int columns)
{
    for (int k = 0; k < UNKNOWNS; k++) {
        int best = k;
        for (int i = k + 1; i < UNKNOWNS; i++)
            if (squared(of->row[i][k]) > squared(of->row[best][k]))
                best = i;
        if (best != k) {
            number kept[UNKNOWNS + SIDES];
            memcpy(kept, of->row[k], sizeof kept);
            memcpy(of->row[k], of->row[best], sizeof kept);
            memcpy(of->row[best], kept, sizeof kept);
        }
        const number over = inverse(of->row[k][k]);
        for (int j = k + 1; j < columns; j++)
            of->row[k][j] = times(of->row[k][j], over);
        for (int i = k + 1; i < UNKNOWNS; i++)
            for (int j = k + 1; j < columns; j++)
                of->row[i][j] = minus(of->row[i][j], times(of->row[i][k], of->row[k][j]));
    }
    for (int k = UNKNOWNS - 1; k > 0; k--)
        for (int i = 0; i < k; i++)
            for (int j = UNKNOWNS; j < columns; j++)
                of->row[i][j] = minus(of->row[i][j], times(of->row[i][k], of->row[k][j]));
}

static double largest(const point *of)
{
    double size = 0;
    for (int i = 0; i < UNKNOWNS; i++)
        size = fmax(size, squared(of->x[i]));
    return sqrt(size);
}

/* One Newton step: the tangent dx/dt, and the change relative to the point; not a number where there is none. */
static double step(const struct system *system, point *at, double t, point *slope)
{
    struct matrix matrix;
    linearised(system, at, t, &matrix);
    solve(&matrix, UNKNOWNS + SIDES);
    point change;
    const double size = largest(at);
    int bad = 0;
    for (int i = 0; i < UNKNOWNS; i++) {
        change.x[i] = matrix.row[i][UNKNOWNS];
        slope->x[i] = scaled(-1, matrix.row[i][UNKNOWNS + 1]);
        at->x[i] = minus(at->x[i], change.x[i]);
        bad |= !(squared(change.x[i]) < INFINITY);
    }
    return bad ? NAN : largest(&change) / size;
}

/* The same line, and its tangent, in the chart of the system: q / (chart . q), l / (chart . q)^2. */
static void put_in_chart(const struct system *system, struct place *place)
{
    number along = {0, 0}, drift = {0, 0};
    for (int i = 0; i < ENTRIES; i++) {
        along = plus(along, times(system->chart[i], place->at.x[i]));
        drift = plus(drift, times(system->chart[i], place->slope.x[i]));
    }
    const number over = inverse(along), rate = times(drift, over);
    for (int i = 0; i < UNKNOWNS; i++) {
        const number factor = i < ENTRIES ? over : times(over, over);
        const number lost = times(i < ENTRIES ? rate : scaled(2, rate), place->at.x[i]);
        place->slope.x[i] = times(factor, minus(place->slope.x[i], lost));
        place->at.x[i] = times(factor, place->at.x[i]);
    }
}

/* The chart in which the line of a point is nearest to the origin, |q| = 1. */
static void take_chart(struct system *system, const point *at)
{
    double norm = 0;
    for (int i = 0; i < ENTRIES; i++)
        norm += squared(at->x[i]);
    const double over = 1 / sqrt(norm);
    for (int i = 0; i < ENTRIES; i++)
        system->chart[i] = (number){over * at->x[i].re, -over * at->x[i].im};
}

static int is_far(const struct system *system, const point *at)
{
    double chart = 0, norm = 0;
    for (int i = 0; i < ENTRIES; i++)
        chart += squared(system->chart[i]), norm += squared(at->x[i]);
    return !(chart * norm <= FAR * FAR);
}

/* The cubic through two places and their tangents, in Newton's form. */
static point predicted(const struct place *now, const struct place *before, double to)
{
    const double span = now->t - before->t, ahead = to - now->t;
    point x;
    for (int i = 0; i < UNKNOWNS; i++) {
        const number here = now->at.x[i], slope = now->slope.x[i];
        const number secant = scaled(1 / span, minus(here, before->at.x[i]));
        const number bend = scaled(1 / span, minus(slope, secant));
        const number sum = plus(minus(slope, scaled(2, secant)), before->slope.x[i]);
        const number curve = plus(bend, scaled((ahead + span) / (span * span), sum));
        x.x[i] = plus(here, scaled(ahead, plus(slope, scaled(ahead, curve))));
    }
    return x;
}

/* Where a line is at t = 1, with its tangent; and before, as if the path were its tangent. */
static void begin(struct system *system, const point *at, struct place *now, struct place *before)
{
    take_chart(system, at);
    *now = (struct place){.at = *at, .slope = {{{0, 0}}}, .t = 1};
    put_in_chart(system, now);
    point moved = now->at;
    step(system, &moved, 1, &now->slope);
    *before = *now;
    before->t = 2;
    for (int i = 0; i < UNKNOWNS; i++)
        before->at.x[i] = plus(now->at.x[i], now->slope.x[i]);
}

static int followed(struct system *system, const struct certreg_path_rules *rules, point *at, int64_t *rounds)
{
    struct place now, before, next;
    double length = rules->first_step;
    begin(system, at, &now, &before);
    for (*rounds = 0; *rounds < rules->max_rounds && !(now.t < rules->endgame);) {
        next.t = fmax(now.t - length, 0);
        next.at = predicted(&now, &before, next.t);
        const double first = step(system, &next.at, next.t, &next.slope);
        double last = first;
        if (first > rules->corrector_bound && first <= rules->predictor_bound)
            last = step(system, &next.at, next.t, &next.slope);
        ++*rounds;
        if (first <= rules->predictor_bound && last <= rules->corrector_bound) {
            const double growth = sqrt(sqrt(rules->predictor_aim / first));
            length *= fmin(fmax(growth, rules->least_growth), rules->most_growth);
            before = now, now = next;
            if (is_far(system, &now.at)) {
                take_chart(system, &now.at);
                put_in_chart(system, &now);
                put_in_chart(system, &before);
            }
        } else {
            length = fmin(length, now.t) * rules->shrink;
            if (length < rules->least_step * now.t)
                break;
        }
    }
    take_chart(system, &now.at);
    put_in_chart(system, &now);
    *at = now.at;
    return now.t < NEARLY ? CERTREG_REACHED : CERTREG_STUCK;
}

/* The condition of the Jacobian of F at a point: the norms of it and of its inverse. */
static double condition(const struct system *system, const point *at)
{
    struct matrix matrix, inverted;
    double size = 0, back = 0;
    linearised(system, at, 0, &matrix);
    for (int j = 0; j < UNKNOWNS; j++) {
        double column = 0, own = 0;
        inverted = matrix;
        for (int i = 0; i < UNKNOWNS; i++) {
            column += sqrt(squared(matrix.row[i][j]));
            inverted.row[i][UNKNOWNS] = (number){i == j, 0};
        }
        solve(&inverted, UNKNOWNS + 1);
        for (int i = 0; i < UNKNOWNS; i++)
            own += sqrt(squared(inverted.row[i][UNKNOWNS]));
        size = fmax(size, column);
        back = own > back || own != own ? own : back;
    }
    return size * back;
}

/* Newton's method on F from the end of a path: the last change. Where it does not converge as at a regular end,
 * the point stays what it was, as it would wander along a continuum. */
static double polished(const struct system *system, const struct certreg_path_rules *rules, point *at)
{
    point next = *at, slope;
    double before = rules->corrector_bound, change = INFINITY;
    for (int64_t n = 0; n < rules->polishings; n++) {
        change = step(system, &next, 0, &slope);
        if (change <= rules->polished) {
            *at = next;
            return change;
        }
        if (!(change <= before))
            break;
        before = change / LEAST_GAIN;
    }
    return change;
}

void certreg_quartic_paths(const double *quartic, const double *a, int64_t count,
                           const struct certreg_path_rules *rules, double *points, int8_t *codes,
                           double *changes, double *conditions, int64_t *rounds)
{
    struct system system;
    make_table(quartic, system.table);
    memcpy(system.a, a, sizeof system.a);
    for (int64_t k = 0; k < count; k++) {
        point at;
        memcpy(&at, points + CERTREG_POINT * k, sizeof at);
        codes[k] = (int8_t)followed(&system, rules, &at, rounds + k);
        changes[k] = conditions[k] = INFINITY;
        if (codes[k] == CERTREG_REACHED) {
            changes[k] = polished(&system, rules, &at);
            conditions[k] = condition(&system, &at);
        }
        memcpy(points + CERTREG_POINT * k, &at, sizeof at);
    }
}

void certreg_many_quartic_paths(int64_t problems, const double *quartics, const double *a, int64_t count,
                                const double *roots, const struct certreg_path_rules *rules, double *points,
                                int8_t *codes, double *changes, double *conditions, int64_t *rounds)
{
    for (int64_t k = 0; k < problems; k++) {
        const int64_t first = k * count;
        memcpy(points + CERTREG_POINT * first, roots, (size_t)(CERTREG_POINT * count) * sizeof *roots);
        certreg_quartic_paths(quartics + CERTREG_QUARTIC * k, a, count, rules, points + CERTREG_POINT * first,
                              codes + first, changes + first, conditions + first, rounds + first);
    }
}

/* Gradient and Hessian in rotation angle at a unit q: 1/2 E^T F' and 1/4 (E^T F'' E - 4 F I), E = (q i, q j, q k). */
static void curvature(const double table[PAIRS][PAIRS], const double q[ENTRIES], double frame[3][ENTRIES],
                      double gradient[3], double hessian[3][3])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double turned[3][ENTRIES] = {{-x, w, z, -y}, {-y, -z, w, x}, {-z, y, -x, w}};
    double second[PAIRS] = {0}, slope[ENTRIES] = {0}, value = 0;
    memcpy(frame, turned, sizeof turned);
    for (int k = 0; k < ENTRIES; k++)
        for (int m = k; m < ENTRIES; m++)
            for (int e = 0; e < PAIRS; e++)
                second[e] += table[pair[k][m]][e] * (q[k] * q[m]);
    for (int i = 0; i < ENTRIES; i++) {
        for (int j = 0; j < ENTRIES; j++)
            slope[i] += second[pair[i][j]] * q[j] / 3;
        value += slope[i] * q[i] / 4;
    }
    for (int a = 0; a < 3; a++) {
        gradient[a] = 0;
        for (int i = 0; i < ENTRIES; i++)
            gradient[a] += 0.5 * frame[a][i] * slope[i];
        for (int b = 0; b < 3; b++) {
            hessian[a][b] = a == b ? -value : 0;
            for (int i = 0; i < ENTRIES; i++)
                for (int j = 0; j < ENTRIES; j++)
                    hessian[a][b] += 0.25 * frame[a][i] * second[pair[i][j]] * frame[b][j];
        }
    }
}

/* The inverse of a symmetric matrix by cofactors; 0 where its condition is beyond all doubt. */
static int inverted(const double m[3][3], double inverse[3][3])
{
    double size = 0, back = 0, determinant = 0;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            const int i = (a + 1) % 3, j = (a + 2) % 3, k = (b + 1) % 3, l = (b + 2) % 3;
            inverse[a][b] = m[i][k] * m[j][l] - m[i][l] * m[j][k];
            size = fmax(size, fabs(m[a][b]));
        }
    for (int b = 0; b < 3; b++)
        determinant += m[0][b] * inverse[0][b];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            inverse[a][b] /= determinant;
            back = fmax(back, fabs(inverse[a][b]));
        }
    return size * back < LARGEST_CONDITION && determinant != 0;
}

int32_t certreg_quartic_newton(const double *quartic, double *q, double *inverse)
{
    double table[PAIRS][PAIRS], frame[3][ENTRIES], gradient[3], hessian[3][3], back[3][3], last = LONGEST_TURN;
    make_table(quartic, table);
    for (int round = 0; round < NEWTON_ROUNDS; round++) {
        double length = 0, norm = 0;
        curvature(table, q, frame, gradient, hessian);
        if (!inverted(hessian, back))
            return 0;
        for (int a = 0; a < 3; a++) {
            const double turn = -(back[a][0] * gradient[0] + back[a][1] * gradient[1] + back[a][2] * gradient[2]);
            length = fmax(length, fabs(turn));
            for (int i = 0; i < ENTRIES; i++)
                q[i] += 0.5 * turn * frame[a][i];
        }
        if (!(length <= last))
            return 0;
        for (int i = 0; i < ENTRIES; i++)
            norm += q[i] * q[i];
        for (int i = 0; i < ENTRIES; i++)
            q[i] /= sqrt(norm);
        if (length < SHORTEST_TURN) {
            memcpy(inverse, back, sizeof back);
            return 1;
        }
        last = length;
    }
    return 0;
}
