/* Checks the settings of a test. */
#ifndef REFLUX_COMMISSION_EXPERIMENT_CHECK_H
#define REFLUX_COMMISSION_EXPERIMENT_CHECK_H

#include "base/error.h"
#include "commission/experiment_config.h"

/* ERR_RANGE: a field is outside of its range. */
MUST_CHECK enum err double_step_check(const struct experiment_config *c);

#endif
