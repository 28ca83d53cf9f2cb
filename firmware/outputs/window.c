/* Window: a solid-state relay or a contactor that is on for a part of each period.
 *
 * Every millisecond `owed` grows by the command and shrinks by 1 ms if the output is on. With r ms left of the period,
 *
 *     need = owed + command * r
 *
 * is the time on that is missing at the end of the period if the output is off from now on. The output goes on when need is at least the
 * least time on, and off when nothing is needed and the rest of the period is long enough to be off. So pulses begin with the period, a
 * command that changes within a period acts at once, and what a pulse or a pause would be too short for is carried over. Nothing is ever
 * rounded away: on-time and integral of the command differ by `owed`, whatever happened. Only off() forgets it.
 *
 * Bounds of owed, with L the longer one of the least times and P the period:
 *     at each end of a period, as long as the command has never changed: from -least_off to least_on (or 1 ms, where that is longer)
 *     at every moment, whatever the command does: from -(P/4 + L + 1 ms) to L + 1 ms
 * P/4 is the pulse itself, which comes at the beginning of the period: command (1 - command) P. A surplus of P/4 and the least time off
 * ends the pulse (guard), and no pulse begins with a surplus of P/4.
 *
 * A command of 0 begins no pulse, whatever is owed.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs/window_state.h"

#include "outputs/output_kind.h"
#include "outputs/output_switch.h"

static int64_t whole_ms(uint32_t ms)
{
    return (int64_t)((uint64_t)ms * OUTPUT_FULL);
}

static const char *window_check(const struct output_settings *s)
{
    if (output_ms(s->least_on) + output_ms(s->least_off) > output_ms(s->period))
        return "least time on and least time off together are longer than the period";
    return NULL;
}

static enum err window_open(void *state, const struct output_settings *s, float *full)
{
    struct output_window *w = state;
    uint32_t least_on = output_ms(s->least_on), least_off = output_ms(s->least_off);
    uint32_t period = output_ms(s->period);
    *full = 1.0f;
    *w = (struct output_window){.period_ms = period,
                                .left_ms = period,
                                .least_on = whole_ms(least_on ? least_on : 1u),
                                .least_off = whole_ms(least_off),
                                .quarter = whole_ms(period) / 4};
    return output_switch_open(&w->contact, s->pin[OUTPUT_PIN], s->low, least_on, least_off);
}

static void window_align(void *state, uint32_t now_ms)
{
    struct output_window *w = state;
    w->left_ms = w->period_ms - now_ms % w->period_ms;
}

static void window_pass(struct output_window *w, uint32_t elapsed_ms)
{
    if (elapsed_ms < w->left_ms)
        w->left_ms -= elapsed_ms;
    else
        w->left_ms = w->period_ms - (elapsed_ms - w->left_ms) % w->period_ms;
}

/* Whether the output is to be on from now on. */
static bool window_decide(const struct output_window *w)
{
    int64_t need = w->owed + (int64_t)((uint64_t)w->command * w->left_ms);
    if (output_switch_is_on(&w->contact)) {
        bool fits = whole_ms(w->left_ms) - need >= w->least_off;
        bool guard = w->owed <= -(w->quarter + w->least_off);
        return !guard && !(need <= 0 && fits);
    }
    return w->command > 0 && need >= w->least_on && w->owed > -w->quarter;
}

static uint32_t window_step(void *state, uint32_t command, uint32_t elapsed_ms)
{
    struct output_window *w = state;
    uint32_t amount = output_switch_pass(&w->contact, elapsed_ms);
    w->owed += (int64_t)((uint64_t)w->command * elapsed_ms) - amount;
    w->command = command;
    window_pass(w, elapsed_ms);
    if (output_switch_may_change(&w->contact)) {
        bool on = window_decide(w);
        if (on != output_switch_is_on(&w->contact))
            output_switch_set(&w->contact, on);
    }
    return amount;
}

static uint32_t window_off(void *state, uint32_t elapsed_ms)
{
    struct output_window *w = state;
    uint32_t amount = output_switch_pass(&w->contact, elapsed_ms);
    output_switch_set(&w->contact, false);
    w->owed = 0;
    w->command = 0;
    w->left_ms = w->period_ms;
    return amount;
}

const struct output_kind window_output = {.check = window_check,
                                          .open = window_open,
                                          .align = window_align,
                                          .step = window_step,
                                          .off = window_off};
