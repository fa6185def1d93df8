/* What the trajectory loops and their caller agree on. */
#ifndef CERTREG_LOOPS_H
#define CERTREG_LOOPS_H

#define CERTREG_BODY 23   /* doubles of a body, see dynamics.h */
#define CERTREG_BASIN 20  /* orthonormal quaternions by descending eigenvalue (4 x 4), deficits (4) */

/* What to do with a state that hardly moves; the first three say how an instance ended. */
enum { CERTREG_GO_ON /* out of steps */, CERTREG_CONVERGED, CERTREG_AT_REST, CERTREG_KICKED };

struct certreg_settings {
    double squared_tolerance; /* of the 18 rates of change */
    double basin_share;       /* of the barrier */
    double rest_share;        /* of the barrier: sin^2 of half the angle that rest allows */
    double stalled_torque;    /* of the curvature: above, a body is not at a saddle */
    double first_kick;        /* radians */
    double kick_growth;
    double largest_kick;
    double newton_tolerance;  /* of h omega_m, midpoint only: radians */
    double largest_turn;      /* of h |omega_m| in a step, midpoint only: radians */
    long newton_steps;        /* before the step is halved */
    long halvings;            /* before a step is given up */
    long max_steps;
};

/* Samples of one trajectory at evenly spaced steps; when full, every second goes. A row is the
 * time, the state, the four energies. */
struct certreg_log {
    double *rows;
    long capacity;
    long count;
    long stride;
};

/* Instances one after another in every array; `log` may be null, and is for one instance only. */
struct certreg_batch {
    long count;
    const double *bodies; /* count x 23 */
    const double *basins; /* count x 20 */
    const double *steps;  /* count x 1 (euler, midpoint): h; x 3 (splitting): and exp(-mu h),
                           * (1 - exp(-mu h)) / mu */
    double *states;       /* count x 18 (euler) or 13, start in, end out */
    long *taken;          /* count: steps */
    int *status;          /* count */
    int *escapes;         /* count */
    double *times;        /* count: of the springs */
    struct certreg_log *log;
};

int certreg_settle_matrix(double state[18], const double body[23], const double basin[20],
                          const struct certreg_settings *settings, double *kick);
int certreg_settle_quaternion(double state[13], const double body[23], const double basin[20],
                              const struct certreg_settings *settings, double *kick);
void certreg_record_matrix(struct certreg_log *log, long step, double time, const double *state,
                           const double *body);
void certreg_record_quaternion(struct certreg_log *log, long step, double time, const double *state,
                               const double *body);

#endif
