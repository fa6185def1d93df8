/* Davenport's matrix of every lane and its eigenvectors, by Jacobi's method; after lanes.h.
 *
 * What becomes of a lane does not depend on its neighbours: where one is done, it is left alone. */

#define SWEEPS 16          /* of Jacobi's method; five are usual */
#define NEGLIGIBLE 0x1p-60 /* of the norm: such an entry moves no eigenvalue by an ulp */

typedef int64_t flags __attribute__((vector_size(8 * LANES))); /* -1 where it holds, else 0 */

static inline lanes all(double x) { return (lanes){0} + x; }

static inline lanes chosen(flags which, lanes yes, lanes no)
{
    return (lanes)((which & (flags)yes) | (~which & (flags)no));
}

static inline lanes magnitude(lanes x) { return (lanes)((flags)x & INT64_MAX); }

static inline int none(flags which)
{
    int64_t any = 0;
    for (int lane = 0; lane < LANES; lane++)
        any |= which[lane];
    return !any;
}

/* The eigenvalues of a symmetric n x n matrix on its diagonal, by Jacobi's rotations; if there are
 * vectors, the rows of the identity become the eigenvectors. */
static inline __attribute__((always_inline)) void diagonalise(lanes *a, lanes *vectors, int n)
{
    lanes norm = {0};
    flags turned;
    for (int i = 0; i < n * n; i++)
        norm += a[i] * a[i];
    const lanes negligible = NEGLIGIBLE * lanes_sqrt(norm);
    int sweep = 0;
    do {
        turned = (flags){0};
        for (int p = 0; p < n - 1; p++)
            for (int q = p + 1; q < n; q++) {
                const lanes coupling = a[n * p + q], difference = a[n * q + q] - a[n * p + p];
                const flags turn = magnitude(coupling) > negligible;
                const lanes root = lanes_sqrt(difference * difference + 4 * coupling * coupling);
                const lanes sum = difference + chosen(difference < 0, -root, root);
                const lanes tangent = chosen(turn, 2 * coupling / sum, (lanes){0});
                const lanes cosine = 1 / lanes_sqrt(1 + tangent * tangent), sine = tangent * cosine;
                turned |= turn;
                a[n * p + p] -= tangent * coupling;
                a[n * q + q] += tangent * coupling;
                a[n * p + q] = a[n * q + p] = chosen(turn, (lanes){0}, coupling);
                for (int r = 0; r < n; r++) {
                    if (r != p && r != q) {
                        const lanes x = a[n * r + p], y = a[n * r + q];
                        a[n * r + p] = a[n * p + r] = cosine * x - sine * y;
                        a[n * r + q] = a[n * q + r] = sine * x + cosine * y;
                    }
                    if (vectors) {
                        const lanes x = vectors[n * p + r], y = vectors[n * q + r];
                        vectors[n * p + r] = cosine * x - sine * y;
                        vectors[n * q + r] = sine * x + cosine * y;
                    }
                }
            }
    } while (!none(turned) && ++sweep < SWEEPS);
}

static inline void exchange(flags which, lanes *a, lanes *b)
{
    const lanes x = *a, y = *b;
    *a = chosen(which, y, x), *b = chosen(which, x, y);
}

static inline void davenport(const lanes c[9], lanes k[16])
{
    const lanes w[3] = {c[7] - c[5], c[2] - c[6], c[3] - c[1]};
    const lanes s[3] = {c[5] + c[7], c[2] + c[6], c[1] + c[3]};
    k[0] = c[0] + c[4] + c[8], k[5] = c[0] - c[4] - c[8];
    k[10] = c[4] - c[0] - c[8], k[15] = c[8] - c[0] - c[4];
    k[1] = k[4] = w[0], k[2] = k[8] = w[1], k[3] = k[12] = w[2];
    k[11] = k[14] = s[0], k[7] = k[13] = s[1], k[6] = k[9] = s[2];
}

/* Descending, with unit vectors whose first nonzero entry is positive; NaN for a matrix that is not finite. */
static inline void eigenbasis(const lanes matrix[16], lanes values[4], lanes vectors[16])
{
    static const int pairs[5][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}};
    lanes a[16], nothing = {0};
    for (int i = 0; i < 16; i++)
        nothing += 0 * matrix[i]; /* NaN where an entry is not finite */
    for (int i = 0; i < 16; i++)
        a[i] = matrix[i], vectors[i] = nothing + all(i % 5 == 0);
    diagonalise(a, vectors, 4);
    for (int i = 0; i < 4; i++)
        values[i] = a[5 * i];
    for (int i = 0; i < 5; i++) {
        const int p = pairs[i][0], q = pairs[i][1];
        const flags wrong = values[p] < values[q];
        exchange(wrong, values + p, values + q);
        for (int r = 0; r < 4; r++)
            exchange(wrong, vectors + 4 * p + r, vectors + 4 * q + r);
    }
    for (int i = 0; i < 4; i++) {
        lanes *v = vectors + 4 * i, first = v[3], squares = {0};
        for (int r = 2; r >= 0; r--)
            first = chosen(v[r] != 0, v[r], first);
        for (int r = 0; r < 4; r++)
            squares += v[r] * v[r];
        const lanes factor = (3 - squares) / 2; /* 1 / sqrt(squares), so near to 1 */
        for (int r = 0; r < 4; r++)
            v[r] *= chosen(first < 0, -factor, factor);
    }
}

/* |K V - V L| + |V^T V - I| (|K| + |L|), Frobenius norms. */
static inline lanes residual_of(const lanes matrix[16], const lanes values[4], const lanes vectors[16])
{
    lanes moved = {0}, skew = {0}, size = {0}, range = {0};
    for (int i = 0; i < 4; i++) {
        const lanes *v = vectors + 4 * i;
        range += values[i] * values[i];
        for (int j = 0; j < 4; j++) {
            const lanes *row = matrix + 4 * j, *u = vectors + 4 * j;
            const lanes off = row[0] * v[0] + row[1] * v[1] + row[2] * v[2] + row[3] * v[3] - values[i] * v[j];
            const lanes along = u[0] * v[0] + u[1] * v[1] + u[2] * v[2] + u[3] * v[3] - (i == j);
            moved += off * off, skew += along * along, size += row[i] * row[i];
        }
    }
    return lanes_sqrt(moved) + lanes_sqrt(skew) * (lanes_sqrt(size) + lanes_sqrt(range));
}

static inline void rotation(const lanes q[4], lanes turn[9])
{
    const lanes w = q[0], x = q[1], y = q[2], z = q[3];
    turn[0] = w * w + x * x - y * y - z * z, turn[1] = 2 * (x * y - w * z), turn[2] = 2 * (x * z + w * y);
    turn[3] = 2 * (x * y + w * z), turn[4] = w * w - x * x + y * y - z * z, turn[5] = 2 * (y * z - w * x);
    turn[6] = 2 * (x * z - w * y), turn[7] = 2 * (y * z + w * x), turn[8] = w * w - x * x - y * y + z * z;
}
