/* Relay: on above one half of the command's span, off below, with hysteresis and least times.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs/relay_state.h"

#include "outputs/output_kind.h"
#include "outputs/output_switch.h"

static enum err relay_open(void *state, const struct output_settings *s, float *full)
{
    struct output_relay *r = state;
    *full = 1.0f;
    *r = (struct output_relay){.upper = output_whole_command(0.5f + 0.5f * s->hysteresis),
                               .lower = output_whole_command(0.5f - 0.5f * s->hysteresis)};
    return output_switch_open(&r->contact, s->pin[OUTPUT_PIN], s->low, output_ms(s->least_on),
                              output_ms(s->least_off));
}

static uint32_t relay_step(void *state, uint32_t command, uint32_t elapsed_ms)
{
    struct output_relay *r = state;
    uint32_t amount = output_switch_pass(&r->contact, elapsed_ms);
    bool on = output_switch_is_on(&r->contact);
    bool wanted = on ? command >= r->lower : command >= r->upper;
    if (on != wanted && output_switch_may_change(&r->contact))
        output_switch_set(&r->contact, wanted);
    return amount;
}

static uint32_t relay_off(void *state, uint32_t elapsed_ms)
{
    struct output_relay *r = state;
    uint32_t amount = output_switch_pass(&r->contact, elapsed_ms);
    output_switch_set(&r->contact, false);
    return amount;
}

const struct output_kind relay_output = {.open = relay_open, .step = relay_step, .off = relay_off};
