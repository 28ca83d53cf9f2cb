/* Argument checks shared by the init functions of signal/ and of kinds. */
#ifndef REFLUX_SIGNAL_CHECK_H
#define REFLUX_SIGNAL_CHECK_H

#include "base/error.h"

/* Step intervals any block accepts, in seconds. */
#define STEP_INTERVAL_MIN_S 1e-3f
#define STEP_INTERVAL_MAX_S 1e5f

/* ERR_OK when lo <= x <= hi; NaN and infinity are ERR_NOT_FINITE. */
MUST_CHECK enum err check_range(float x, float lo, float hi);
MUST_CHECK enum err check_interval(float h_s);

#endif
