/* A pin that switches, with a least time on and a least time off. Its least time off begins when it is opened, because nobody knows
 * what was before a reset.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_OUTPUTS_OUTPUT_SWITCH_H
#define REFLUX_OUTPUTS_OUTPUT_SWITCH_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "hal/pin.h"

struct output_switch; /* output_switch_state.h */

/* Opens the pin, off. `low`: it is on when the pin is low. Errors of hal_output_open(). */
MUST_CHECK enum err output_switch_open(struct output_switch *w, hal_pin pin, bool low,
                                       uint32_t least_on_ms, uint32_t least_off_ms);
/* Clock. So many milliseconds have passed; returns their amount (outputs/output_kind.h). */
uint32_t output_switch_pass(struct output_switch *w, uint32_t elapsed_ms);
bool output_switch_is_on(const struct output_switch *w);
/* Whether the least time of the present state is over. */
bool output_switch_may_change(const struct output_switch *w);
/* Clock. Switches at once; the caller has asked output_switch_may_change(), or safety does not wait. */
void output_switch_set(struct output_switch *w, bool on);

#endif
