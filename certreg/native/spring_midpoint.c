/* The implicit midpoint rule on general springs: the middle velocity and angular velocity are sought. */
#include "loops.h"

#include <math.h>
#include <string.h>

#include "spring_dynamics.h"

/* The solution of a 6 x 6 system by elimination with pivots; 0 where it is singular. */
static int solve6(double entries[36], const double side[6], double b[6])
{
    double(*a)[6] = (double(*)[6])entries;
    memcpy(b, side, 6 * sizeof(double));
    for (int k = 0; k < 6; k++) {
        int pivot = k;
        for (int i = k + 1; i < 6; i++)
            if (fabs(a[i][k]) > fabs(a[pivot][k]))
                pivot = i;
        for (int j = k; j < 6; j++) {
            const double kept = a[k][j];
            a[k][j] = a[pivot][j], a[pivot][j] = kept;
        }
        const double kept = b[k];
        b[k] = b[pivot], b[pivot] = kept;
        for (int i = k + 1; i < 6; i++) {
            const double share = a[i][k] / a[k][k];
            for (int j = k; j < 6; j++)
                a[i][j] -= share * a[k][j];
            b[i] -= share * b[k];
        }
    }
    for (int k = 5; k >= 0; k--) {
        for (int j = k + 1; j < 6; j++)
            b[k] -= a[k][j] * b[j];
        b[k] /= a[k][k];
        if (!isfinite(b[k]))
            return 0;
    }
    return 1;
}

#define RULE certreg_spring_midpoint_single
#define UNKNOWNS 6
#define BODY CERTREG_SPRING_BODY
#define BASIN 0
#define RESIDUAL certreg_spring_midpoint_residual
#define SOLVE solve6
#define STEP certreg_spring_midpoint_step
#define SPEED certreg_spring_squared_speed
#define ESCAPE certreg_escape_spring
#define RECORD certreg_record_spring
#include "midpoint.h"
