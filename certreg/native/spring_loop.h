/* The loop of loop.h for the splitting on general springs: included with LOOP defined. */
#define STATE CERTREG_QUATERNION_STATE
#define BODY CERTREG_SPRING_BODY
#define BASIN 0
#define STEPS CERTREG_SPLITTING_STEP
#define ADVANCE certreg_spring_splitting_step
#define ESCAPE certreg_escape_spring
#define RECORD certreg_record_spring
#include "loop.h"
