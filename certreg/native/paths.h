/* Paths of the critical lines of a quartic; see paths.c. */
#ifndef CERTREG_PATHS_H
#define CERTREG_PATHS_H
#include <stdint.h>

#define CERTREG_QUARTIC 35 /* coefficients */
#define CERTREG_POINT 10   /* q and l, complex */

struct certreg_path_rules { /* as TrackerSettings of equilibrium/tracking.py */
    double first_step, predictor_bound, predictor_aim, corrector_bound, least_growth, most_growth, shrink,
        least_step, endgame, polished;
    int64_t max_rounds, polishings;
};

enum { CERTREG_REACHED, CERTREG_STUCK };

/* From sum a_i q_i^4, complex a (8), to the quartic: `count` points (q, l), replaced by where they end, |q| = 1.
 * codes: what became of each. changes: of the last Newton step on the quartic, relative. conditions: of the
 * Jacobian there, in the norm of the largest column sum. rounds: of predicting and correcting. */
void certreg_quartic_paths(const double *quartic, const double *a, int64_t count,
                           const struct certreg_path_rules *rules, double *points, int8_t *codes,
                           double *changes, double *conditions, int64_t *rounds);

/* The same for `problems` quartics one after another, all from the `count` points `roots`; what is found stands
 * one problem after another, too. */
void certreg_many_quartic_paths(int64_t problems, const double *quartics, const double *a, int64_t count,
                                const double *roots, const struct certreg_path_rules *rules, double *points,
                                int8_t *codes, double *changes, double *conditions, int64_t *rounds);

/* Newton's method in rotation angle from a unit q near a critical point of a real quartic: q where it converged,
 * the inverse of the Hessian there, by rows. 0 where it did not. */
int32_t certreg_quartic_newton(const double *quartic, double *q, double *inverse);
#endif
