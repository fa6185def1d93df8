/* Stationary poses of many small problems, side by side in the lanes: moments, eigenvectors of Davenport's
 * matrix, eigenvalues of the pencil (G, J). Linear algebra; the Hessian G is generated.
 *
 * What becomes of a lane does not depend on its neighbours: where one is done, it is left alone. */
#include "stationary.h"

#if defined(__AVX2__) && !defined(__AVX512F__)
#define LANES 4 /* GCC compares eight doubles of AVX2 one after another: twice the time */
#else
#define LANES CERTREG_SIDE_BY_SIDE
#endif
#include "lanes.h"
#include "eigen.h"

typedef lanes loose __attribute__((aligned(8), may_alias));

/* Points of one cloud, over a power of two, less nearly their mean; what is left of the mean. */
struct deviations {
    loose *points; /* of all points the x, y, z of every lane */
    lanes shift[3], rest[3], unit[2];
    int exponents[LANES];
};

/* Powers of two that a product takes one after the other, so that neither leaves the doubles. */
static inline void powers_of_two(const int exponents[LANES], int sign, lanes unit[2])
{
    for (int lane = 0; lane < LANES; lane++) {
        const int exponent = sign * exponents[lane], half = exponent / 2;
        unit[0][lane] = ldexp(1, half), unit[1][lane] = ldexp(1, exponent - half);
    }
}

/* Numbers of all lanes side by side, over powers of two: the largest is in [1/2, 1). */
static void scaled(const double *const from[LANES], int64_t count, loose *to, int exponents[LANES],
                   lanes unit[2])
{
    lanes largest = {0};
    for (int64_t k = 0; k < count; k++) {
        lanes x;
        for (int lane = 0; lane < LANES; lane++)
            x[lane] = from[lane][k];
        const lanes size = magnitude(x);
        largest = chosen(size > largest, size, largest);
        to[k] = x;
    }
    for (int lane = 0; lane < LANES; lane++)
        frexp(largest[lane], exponents + lane);
    powers_of_two(exponents, -1, unit);
    for (int64_t k = 0; k < count; k++)
        to[k] = to[k] * unit[0] * unit[1];
}

static void shifted(struct deviations *cloud, const loose *w, lanes mass, int64_t points)
{
    lanes sum[3] = {{0}}, rest[3] = {{0}};
    for (int64_t i = 0; i < points; i++)
        for (int k = 0; k < 3; k++)
            sum[k] += w[i] * cloud->points[3 * i + k];
    for (int k = 0; k < 3; k++)
        cloud->shift[k] = sum[k] / mass;
    for (int64_t i = 0; i < points; i++)
        for (int k = 0; k < 3; k++) {
            const lanes x = cloud->points[3 * i + k] - cloud->shift[k];
            cloud->points[3 * i + k] = x;
            rest[k] += w[i] * x;
        }
    for (int k = 0; k < 3; k++)
        cloud->rest[k] = rest[k] / mass;
}

struct moments {
    lanes cross[9], scatter[6], spreads[CERTREG_SPREADS];
};

static void products(const struct deviations *x, const struct deviations *y, const loose *w, lanes mass,
                     int64_t points, struct moments *moments)
{
    static const int row[6] = {0, 0, 0, 1, 1, 2}, column[6] = {0, 1, 2, 1, 2, 2};
    lanes cross[9] = {{0}}, scatter[6] = {{0}}, spread = {0};
    for (int64_t i = 0; i < points; i++) {
        const loose *a = x->points + 3 * i, *b = y->points + 3 * i;
        const lanes wa[3] = {w[i] * a[0], w[i] * a[1], w[i] * a[2]};
        for (int k = 0; k < 9; k++)
            cross[k] += wa[k % 3] * b[k / 3];
        for (int k = 0; k < 6; k++)
            scatter[k] += wa[row[k]] * a[column[k]];
        spread += w[i] * (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    }
    for (int k = 0; k < 9; k++)
        moments->cross[k] = cross[k] / mass - y->rest[k / 3] * x->rest[k % 3];
    for (int k = 0; k < 6; k++)
        moments->scatter[k] = scatter[k] / mass - x->rest[row[k]] * x->rest[column[k]];
    moments->spreads[CERTREG_SPREADS_SOURCE] = (scatter[0] + scatter[3] + scatter[5]) / mass;
    moments->spreads[CERTREG_SPREADS_TARGET] = spread / mass;
    moments->spreads[CERTREG_SPREADS_CENTRED_TARGET] = spread / mass - y->rest[0] * y->rest[0] -
                                                       y->rest[1] * y->rest[1] - y->rest[2] * y->rest[2];
}

/* The lower factor 11 21 22 31 32 33 of J = tr(S) I - S; where it is positive definite. */
static flags factor_of_inertia(const lanes s[6], lanes t[6])
{
    const lanes a = s[3] + s[5], d = s[0] + s[5], f = s[0] + s[3];
    t[0] = lanes_sqrt(a), t[1] = -s[1] / t[0], t[3] = -s[2] / t[0];
    t[2] = lanes_sqrt(d - t[1] * t[1]);
    t[4] = (-s[4] - t[1] * t[3]) / t[2];
    t[5] = lanes_sqrt(f - t[3] * t[3] - t[4] * t[4]);
    return (t[0] > 0) & (t[2] > 0) & (t[5] > 0);
}

/* Each row of a matrix times T^-T. */
static inline void reduced(const lanes t[6], lanes a[9])
{
    for (lanes *row = a; row < a + 9; row += 3) {
        row[0] = row[0] / t[0];
        row[1] = (row[1] - t[1] * row[0]) / t[2];
        row[2] = (row[2] - t[3] * row[0] - t[4] * row[1]) / t[5];
    }
}

/* The eigenvalues of T^-1 G T^-T, ascending, at each of four unit quaternions. */
static void ratios_of(const struct moments *moments, const lanes vectors[16], lanes ratios[12])
{
    lanes factor[6], torque[3], state[CERTREG_QUATERNION_STATE] = {{0}}, body[CERTREG_BODY] = {{0}};
    const flags definite = factor_of_inertia(moments->scatter, factor);
    for (int i = 0; i < 9; i++)
        body[CERTREG_BODY_CROSS + i] = moments->cross[i];
    for (int k = 0; k < 4; k++) {
        lanes hessian[9], pencil[9], *g = ratios + 3 * k;
        for (int i = 0; i < 4; i++)
            state[CERTREG_QUATERNION_STATE_Q + i] = vectors[4 * k + i];
        certreg_quaternion_curvature(state, body, hessian, torque);
        reduced(factor, hessian);
        for (int i = 0; i < 9; i++)
            pencil[i] = hessian[3 * (i % 3) + i / 3];
        reduced(factor, pencil);
        diagonalise(pencil, 0, 3);
        for (int i = 0; i < 3; i++)
            g[i] = chosen(definite, pencil[4 * i], all(NAN));
        exchange(g[1] < g[0], g, g + 1);
        exchange(g[2] < g[1], g + 1, g + 2);
        exchange(g[1] < g[0], g, g + 1);
    }
}

static inline lanes along(const lanes row[3], const loose *x)
{
    return row[0] * x[0] + row[1] * x[1] + row[2] * x[2];
}

/* The mean of w |y - R x|^2 about the means, of clouds in these units. */
static lanes square_of(const struct deviations *x, const struct deviations *y, const lanes units[2],
                       const loose *w, lanes mass, int64_t points, const lanes q[4])
{
    lanes sum = {0}, turn[9], offset[3];
    rotation(q, turn);
    for (int r = 0; r < 9; r++)
        turn[r] *= units[0];
    for (int r = 0; r < 3; r++)
        offset[r] = y->rest[r] * units[1] - along(turn + 3 * r, x->rest);
    for (int64_t n = 0; n < points; n++) {
        const loose *a = x->points + 3 * n, *b = y->points + 3 * n;
        lanes squares = {0};
        for (int r = 0; r < 3; r++) {
            const lanes off = b[r] * units[1] - along(turn + 3 * r, a) - offset[r];
            squares += off * off;
        }
        sum += w[n] * squares;
    }
    return sum / mass;
}

/* Root mean squares at four eigenvectors: by the residuals at the first, the others by the energy. */
static void errors_of(const struct deviations *x, const struct deviations *y, const loose *w, lanes mass,
                      int64_t points, const lanes values[4], const lanes vectors[16], lanes errors[4])
{
    int largest[LANES];
    lanes units[2], unit[2];
    for (int lane = 0; lane < LANES; lane++) {
        const int i = x->exponents[lane], j = y->exponents[lane];
        largest[lane] = i > j ? i : j;
        units[0][lane] = ldexp(1, i - largest[lane]), units[1][lane] = ldexp(1, j - largest[lane]);
    }
    powers_of_two(largest, 1, unit);
    const lanes square = square_of(x, y, units, w, mass, points, vectors);
    for (int k = 0; k < 4; k++) {
        const lanes loss = 2 * (values[0] - values[k]) * units[0] * units[1];
        errors[k] = lanes_sqrt(square + loss) * unit[0] * unit[1];
    }
}

/* The means of a cloud in the units given. */
static void means_of(const struct deviations *cloud, lanes means[3])
{
    lanes unit[2];
    powers_of_two(cloud->exponents, 1, unit);
    for (int k = 0; k < 3; k++)
        means[k] = (cloud->shift[k] + cloud->rest[k]) * unit[0] * unit[1];
}

static void translations_of(const lanes means[CERTREG_MEANS], const lanes vectors[16], lanes translations[12])
{
    for (int k = 0; k < 4; k++) {
        lanes turn[9];
        rotation(vectors + 4 * k, turn);
        for (int r = 0; r < 3; r++)
            translations[3 * k + r] =
                means[CERTREG_MEANS_TARGET + r] - along(turn + 3 * r, means + CERTREG_MEANS_SOURCE);
    }
}

/* Numbers of all lanes to where they belong; lanes beyond the last problem go nowhere. */
static inline void put(const lanes *from, int64_t size, double *to, int64_t live)
{
    for (int64_t lane = 0; lane < live; lane++)
        for (int64_t k = 0; k < size; k++)
            to[lane * size + k] = from[k][lane];
}

static void stationary_poses(const struct certreg_clouds *clouds, int64_t first)
{
    const int64_t left = clouds->count - first, live = left < LANES ? left : LANES, n = clouds->points;
    loose *const w = (loose *)clouds->scratch;
    struct deviations x = {.points = w + n}, y = {.points = w + 4 * n};
    const double *sources[LANES], *targets[LANES], *weights[LANES];
    int exponents[LANES];
    for (int lane = 0; lane < LANES; lane++) {
        const int64_t i = first + (lane < live ? lane : live - 1);
        sources[lane] = clouds->sources + i * clouds->source_step;
        targets[lane] = clouds->targets + i * clouds->target_step;
        weights[lane] = clouds->weights + i * clouds->weight_step;
    }
    scaled(weights, n, w, exponents, x.unit);
    scaled(sources, 3 * n, x.points, x.exponents, x.unit);
    scaled(targets, 3 * n, y.points, y.exponents, y.unit);
    lanes mass = {0};
    for (int64_t i = 0; i < n; i++)
        mass += w[i];
    shifted(&x, w, mass, n);
    shifted(&y, w, mass, n);
    struct moments moments;
    products(&x, &y, w, mass, n, &moments);
    lanes matrix[16], values[4], vectors[16], ratios[12], means[CERTREG_MEANS], translations[12], errors[4];
    davenport(moments.cross, matrix);
    eigenbasis(matrix, values, vectors);
    ratios_of(&moments, vectors, ratios);
    const lanes residual = residual_of(matrix, values, vectors);
    means_of(&x, means + CERTREG_MEANS_SOURCE);
    means_of(&y, means + CERTREG_MEANS_TARGET);
    translations_of(means, vectors, translations);
    errors_of(&x, &y, w, mass, n, values, vectors, errors);
    for (int64_t lane = 0; lane < live; lane++) {
        clouds->exponents[2 * (first + lane)] = x.exponents[lane];
        clouds->exponents[2 * (first + lane) + 1] = y.exponents[lane];
    }
    put(means, CERTREG_MEANS, clouds->means + CERTREG_MEANS * first, live);
    put(moments.cross, 9, clouds->cross + 9 * first, live);
    put(moments.scatter, 6, clouds->scatter + 6 * first, live);
    put(moments.spreads, CERTREG_SPREADS, clouds->spreads + CERTREG_SPREADS * first, live);
    put(values, 4, clouds->values + 4 * first, live);
    put(vectors, 16, clouds->vectors + 16 * first, live);
    put(&residual, 1, clouds->residual + first, live);
    put(ratios, 12, clouds->ratios + 12 * first, live);
    put(translations, 12, clouds->translations + 12 * first, live);
    put(errors, 4, clouds->rmse + 4 * first, live);
}

void certreg_stationary_poses(const struct certreg_clouds *clouds)
{
    for (int64_t first = 0; first < clouds->count; first += LANES)
        stationary_poses(clouds, first);
}
