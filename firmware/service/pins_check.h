/* Checks the settings of devices and outputs at the board's pins against each other and against the pins that the board has. Main loop.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_SERVICE_PINS_CHECK_H
#define REFLUX_SERVICE_PINS_CHECK_H

#include "exchange/plan.h"

#if CONFIG_DEVICES
/* Fills *fault where it refuses. ERR_CONFLICT: something twice. ERR_RANGE, ERR_PARSE, ERR_UNKNOWN. */
MUST_CHECK enum err pins_check(const struct config *config, struct config_fault *fault);
#else
static inline enum err pins_check(const struct config *config, struct config_fault *fault)
{
    (void)config;
    (void)fault;
    return ERR_OK;
}
#endif

#endif
