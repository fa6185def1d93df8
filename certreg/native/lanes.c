/* The loops, eight instances side by side. */
#define LANES 8
#include "loops.h"

#include "lanes.h"

#define LOOP certreg_euler_lanes
#define STATE 18
#define STEPS 1
#define ADVANCE certreg_euler_step
#define SETTLE certreg_settle_matrix
#define RECORD certreg_record_matrix
#include "loop.h"

#define LOOP certreg_splitting_lanes
#define STATE 13
#define STEPS 3
#define ADVANCE certreg_splitting_step
#define SETTLE certreg_settle_quaternion
#define RECORD certreg_record_quaternion
#include "loop.h"
