/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "outputs/output_switch.h"

#include "hal/output.h"
#include "outputs/output_kind.h"
#include "outputs/output_switch_state.h"

enum err output_switch_open(struct output_switch *w, hal_pin pin, bool low, uint32_t least_on_ms,
                            uint32_t least_off_ms)
{
    *w = (struct output_switch){
        .pin = pin, .least_on_ms = least_on_ms, .least_off_ms = least_off_ms};
    return hal_output_open(pin, low);
}

uint32_t output_switch_pass(struct output_switch *w, uint32_t elapsed_ms)
{
    w->held_ms = w->held_ms < UINT32_MAX - elapsed_ms ? w->held_ms + elapsed_ms : UINT32_MAX;
    return w->on ? elapsed_ms * OUTPUT_FULL : 0;
}

bool output_switch_is_on(const struct output_switch *w)
{
    return w->on;
}

bool output_switch_may_change(const struct output_switch *w)
{
    return w->held_ms >= (w->on ? w->least_on_ms : w->least_off_ms);
}

void output_switch_set(struct output_switch *w, bool on)
{
    /* Writes an off that is an off already: hal_output_safe() may have been there, or noise. */
    hal_output_set(w->pin, on);
    if (w->on == on)
        return;
    w->on = on;
    w->held_ms = 0;
}
