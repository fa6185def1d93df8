/* Whether a form of degree four is positive on all lines through the origin of R^4 but some, by cones.c. */
#ifndef CERTREG_CONES_H
#define CERTREG_CONES_H

#include <stdint.h>

#define CERTREG_CONE_COEFFICIENTS 35
#define CERTREG_ORTHANTS 8  /* that hold one of q and -q: those of +-x, +-y, +-z with w */
#define CERTREG_CONE_CUTS 192 /* of an orthant down to a cone: what is thinner is left to the checker */

/* A cap holds the lines that make an angle to (w, x, y, z), of length 1, whose squared sine is at most sine. */
struct certreg_cap {
    double centre[4], sine;
};

/* orthants: Bernstein coefficients, at most 2^124 in size, of the form on each, in the order of the monomials of
 * combinations_with_replacement(range(4), 4), each in two words, low first, in two's complement; bit k of an
 * orthant's number is set where e_(k+1) stands with a minus. seen: cones looked at. deepest: cuts of the smallest
 * one. vertex: where the form is not positive. */
struct certreg_cones {
    const uint64_t *orthants;
    const struct certreg_cap *caps;
    int64_t cap_count, budget, seen, deepest;
    double vertex[4];
};

/* The last one: no memory, or no integers of 128 bits. */
enum {
    CERTREG_CONES_POSITIVE,
    CERTREG_CONES_NOT_POSITIVE,
    CERTREG_CONES_BUDGET,
    CERTREG_CONES_DEEP,
    CERTREG_CONES_ABSENT
};

int certreg_cones(struct certreg_cones *search);

#endif
