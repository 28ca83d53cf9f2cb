/* What an analogue output makes of a command: output = offset + gain * command, fractions of its span, so that 2-10 V of 0-10 V is offset 0.2
 * and gain 0.8, and a gain below 0 turns it round.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_OUTPUTS_OUTPUT_SPAN_H
#define REFLUX_OUTPUTS_OUTPUT_SPAN_H

#include <stdbool.h>
#include <stdint.h>

#include "outputs/output_settings.h"

/* Owner: output_span.c. */
struct output_span {
    uint32_t gain, offset; /* 1/65536 of the output's span; gain without its sign */
    bool falls;            /* the gain is below 0 */
};

/* Says in words what is wrong with gain and offset; NULL: nothing. */
const char *output_span_check(const struct output_settings *s);

struct output_span output_span_of(const struct output_settings *s);

/* Part of the output's span at a command, 0 to OUTPUT_FULL. */
uint32_t output_span_part(const struct output_span *span, uint32_t command);

#endif
