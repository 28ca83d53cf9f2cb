/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "outputs/output_span.h"

#include <stddef.h>

#include "outputs/output_kind.h"

const char *output_span_check(const struct output_settings *s)
{
    float end = s->offset + s->gain;
    /* Half a code of 16 bits is rounding of the settings. */
    if (end < -0.5f / (float)HAL_PWM_FULL || end > 1.0f + 0.5f / (float)HAL_PWM_FULL)
        return "offset and gain take the output out of 0 to 1 at command 1";
    return NULL;
}

struct output_span output_span_of(const struct output_settings *s)
{
    bool falls = s->gain < 0.0f;
    return (struct output_span){.gain = output_whole_command(falls ? -s->gain : s->gain),
                                .offset = output_whole_command(s->offset),
                                .falls = falls};
}

uint32_t output_span_part(const struct output_span *span, uint32_t command)
{
    uint32_t change = (uint32_t)(((uint64_t)span->gain * command + OUTPUT_FULL / 2u) >> 16);
    if (span->falls)
        return span->offset > change ? span->offset - change : 0;
    return span->offset + change < OUTPUT_FULL ? span->offset + change : OUTPUT_FULL;
}
