/* Kind `pid`: a loop's own controller. The law is signal/pid.h. */
#ifndef REFLUX_PID_PID_H
#define REFLUX_PID_PID_H

#include "block/block.h"
#include "signal/pid.h"

/* Settings are a struct loop_settings, one member. */
extern const struct block_kind pid_kind;

#endif
