/* The splitting on general springs, one body at a time. */
#define LANES 1
#include "loops.h"

#include "lanes.h"
#include "spring_dynamics.c"

#define LOOP certreg_spring_splitting_single
#include "spring_loop.h"
