/* The number type of the loops: one double, or LANES doubles side by side (GCC's and clang's vectors). */
#include <stdint.h>
#include <math.h>
#include <string.h>

#define PASTED(a, b) a##b
#define NAMED(a, b) PASTED(a, b)

#if LANES == 1
typedef double lanes;
#define AT(x, lane) (x)
#else
typedef double lanes __attribute__((vector_size(8 * LANES)));
#define AT(x, lane) ((x)[lane])
#define CERTREG_CONSTANT(x) ((lanes){0} + (x))
#define CERTREG_SQRT(x) lanes_sqrt(x)
static inline lanes lanes_sqrt(lanes x)
{
    lanes root;
    for (int lane = 0; lane < LANES; lane++)
        root[lane] = sqrt(x[lane]);
    return root;
}
#endif
#define CERTREG_REAL lanes
#define CERTREG_LINKAGE static inline __attribute__((unused))
#include "dynamics.c"

/* Whether every lane is at least a bound; a NaN is not. */
static inline int all_above(lanes x, double bound)
{
#if LANES == 1
    return x >= bound;
#else
    /* by fours: what compilers make of wider comparisons is one lane after another */
    typedef double four __attribute__((vector_size(32)));
    four part[LANES / 4];
    __typeof__(part[0] >= part[0]) all; /* -1 where it holds, else 0 */
    memcpy(part, &x, sizeof part);
    all = part[0] >= bound;
    for (int k = 1; k < LANES / 4; k++)
        all &= part[k] >= bound;
    return (all[0] & all[1] & all[2] & all[3]) != 0;
#endif
}
