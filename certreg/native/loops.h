/* What the trajectory loops and their caller agree on. */
#ifndef CERTREG_LOOPS_H
#define CERTREG_LOOPS_H

#include "layout.h"
#include "spring_layout.h"

#include <stdint.h>

/* A basin is orthonormal quaternions by descending eigenvalue, and their gaps to the largest. */

/* What to do with a state that hardly moves; the first three say how a run ended. */
enum { CERTREG_GO_ON /* out of steps */, CERTREG_CONVERGED, CERTREG_AT_REST, CERTREG_PERTURBED };

struct certreg_settings {
    double squared_tolerance; /* of the 18 rates of change */
    double basin_share;       /* of the barrier */
    double rest_share;        /* of the barrier: sin^2 of half the angle that rest allows */
    double stalled_torque;    /* of the curvature: above, a body is not at a saddle */
    double first_perturbation;        /* radians */
    double perturbation_growth;
    double largest_perturbation;
    double newton_tolerance;  /* of h omega_m, midpoint only: radians */
    double largest_turn;      /* of h |omega_m| in a step, midpoint only: radians */
    int64_t newton_steps;        /* before the step is halved */
    int64_t halvings;            /* before a step is given up */
    int64_t max_steps;
};

/* Samples of one trajectory at evenly spaced steps, matrix_sample, quaternion_sample or spring_sample; when
 * full, every second goes. */
struct certreg_log {
    double *rows;
    int64_t capacity;
    int64_t count;
    int64_t stride;
};

/* Bodies one after another in every array; `log` may be null, and is for one body only. */
struct certreg_batch {
    int64_t count;
    const double *bodies; /* records of layout.h: body; on general springs spring_body */
    const double *basins; /* basin; on general springs not read */
    const double *steps;  /* step (euler, midpoint), splitting_step */
    double *states;       /* matrix_state (euler), quaternion_state; start in, end out */
    int64_t *taken;          /* count: steps */
    int *status;          /* count */
    int64_t *escapes;        /* count */
    double *times;        /* count: of the springs */
    struct certreg_log *log;
};

int certreg_escape_matrix(double state[CERTREG_MATRIX_STATE], const double body[CERTREG_BODY],
                          const double basin[CERTREG_BASIN],
                          const struct certreg_settings *settings, double *perturbation);
int certreg_escape_quaternion(double state[CERTREG_QUATERNION_STATE], const double body[CERTREG_BODY],
                              const double basin[CERTREG_BASIN],
                              const struct certreg_settings *settings, double *perturbation);
void certreg_record_matrix(struct certreg_log *log, int64_t step, double time, const double *state,
                           const double *body);
void certreg_record_quaternion(struct certreg_log *log, int64_t step, double time, const double *state,
                               const double *body);

/* On general springs nothing is known of optima: a slow body in a valley is at rest, wherever that is. */
int certreg_escape_spring(double state[CERTREG_QUATERNION_STATE], const double body[CERTREG_SPRING_BODY],
                          const double *basin, const struct certreg_settings *settings, double *perturbation);
void certreg_record_spring(struct certreg_log *log, int64_t step, double time, const double *state,
                           const double *body);

/* sin and cos of an angle, the same on every processor, which the system's need not be. */
double certreg_sine(double angle, double *cosine);
/* q (0, a) + c q: the quaternion q turned by a half angle whose cosine is c, sine times axis a. */
void certreg_turn(double q[4], double c, const double a[3]);
/* A row for the next sample, or null if this step is not one. */
double *certreg_log_row(struct certreg_log *log, int64_t step, int64_t width);

#endif
