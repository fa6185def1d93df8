/* The splitting on general springs, eight bodies side by side. */
#define LANES 8
#include "loops.h"

#include "lanes.h"
#include "spring_dynamics.c"

#define LOOP certreg_spring_splitting_lanes
#include "spring_loop.h"
