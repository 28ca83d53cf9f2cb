/* Enable: a contactor in series with all heaters. Its command is whether it may be on, which outputs.c decides; it drops at once, and stays off
 * for its least time off, so that it does not chatter.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs/enable_state.h"

#include "outputs/output_kind.h"
#include "outputs/output_switch.h"

#define LEAST_OFF_S 1.0f

static const char *enable_check(const struct output_settings *s)
{
    return s->least_off < LEAST_OFF_S ? "the enable output must stay off for at least 1 s" : NULL;
}

static enum err enable_open(void *state, const struct output_settings *s, float *full)
{
    struct output_enable *e = state;
    *full = 1.0f;
    return output_switch_open(&e->contact, s->pin[OUTPUT_PIN], s->low, 0, output_ms(s->least_off));
}

static uint32_t enable_step(void *state, uint32_t command, uint32_t elapsed_ms)
{
    struct output_enable *e = state;
    uint32_t amount = output_switch_pass(&e->contact, elapsed_ms);
    bool on = output_switch_is_on(&e->contact);
    if (on && command == 0)
        output_switch_set(&e->contact, false);
    else if (!on && command != 0 && output_switch_may_change(&e->contact))
        output_switch_set(&e->contact, true);
    return amount;
}

static uint32_t enable_off(void *state, uint32_t elapsed_ms)
{
    struct output_enable *e = state;
    uint32_t amount = output_switch_pass(&e->contact, elapsed_ms);
    output_switch_set(&e->contact, false);
    return amount;
}

const struct output_kind enable_output = {
    .check = enable_check, .open = enable_open, .step = enable_step, .off = enable_off};
