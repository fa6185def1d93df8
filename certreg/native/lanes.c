/* The loops, eight bodies side by side. */
#define LANES 8
#include "loops.h"

#include "lanes.h"

#define LOOP certreg_euler_lanes
#define STATE CERTREG_MATRIX_STATE
#define BODY CERTREG_BODY
#define BASIN CERTREG_BASIN
#define STEPS CERTREG_STEP
#define ADVANCE certreg_euler_step
#define ESCAPE certreg_escape_matrix
#define RECORD certreg_record_matrix
#include "loop.h"

#define LOOP certreg_splitting_lanes
#define STATE CERTREG_QUATERNION_STATE
#define BODY CERTREG_BODY
#define BASIN CERTREG_BASIN
#define STEPS CERTREG_SPLITTING_STEP
#define ADVANCE certreg_splitting_step
#define ESCAPE certreg_escape_quaternion
#define RECORD certreg_record_quaternion
#include "loop.h"
