/* The implicit midpoint rule, one weight per pair: the middle angular velocity is sought. */
#include "loops.h"

#include <math.h>

#include "dynamics.h"

/* The solution of a 3 x 3 system by Cramer's rule with cross products; 0 where it is singular. */
static int solve3(const double a[9], const double b[3], double x[3])
{
    const double c[9] = {a[4] * a[8] - a[5] * a[7], a[5] * a[6] - a[3] * a[8], a[3] * a[7] - a[4] * a[6],
                         a[2] * a[7] - a[1] * a[8], a[0] * a[8] - a[2] * a[6], a[1] * a[6] - a[0] * a[7],
                         a[1] * a[5] - a[2] * a[4], a[2] * a[3] - a[0] * a[5], a[0] * a[4] - a[1] * a[3]};
    const double determinant = a[0] * c[0] + a[1] * c[1] + a[2] * c[2];
    for (int i = 0; i < 3; i++)
        x[i] = (c[i] * b[0] + c[3 + i] * b[1] + c[6 + i] * b[2]) / determinant;
    return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}

#define RULE certreg_midpoint_single
#define UNKNOWNS 3
#define BODY CERTREG_BODY
#define BASIN CERTREG_BASIN
#define RESIDUAL certreg_midpoint_residual
#define SOLVE solve3
#define STEP certreg_midpoint_step
#define SPEED certreg_quaternion_squared_speed
#define ESCAPE certreg_escape_quaternion
#define RECORD certreg_record_quaternion
#include "midpoint.h"
