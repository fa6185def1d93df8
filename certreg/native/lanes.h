/* The number type of the loops: one double, or LANES doubles side by side (GCC's and clang's vectors). */
#include <math.h>

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
