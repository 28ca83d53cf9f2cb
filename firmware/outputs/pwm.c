/* Pulse width of a pin's own timer.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs/pwm_state.h"

#include "outputs/output_kind.h"

static enum err pwm_open(void *state, const struct output_settings *s, float *full)
{
    struct output_pwm *p = state;
    *full = 1.0f;
    *p = (struct output_pwm){.pin = s->pin[OUTPUT_PIN]};
    return hal_pwm_open(p->pin, output_hz(s), s->low);
}

static uint32_t pwm_step(void *state, uint32_t command, uint32_t elapsed_ms)
{
    struct output_pwm *p = state;
    uint32_t amount = p->command * elapsed_ms;
    if (command != p->command)
        hal_pwm_set(p->pin, (uint16_t)((command * HAL_PWM_FULL + OUTPUT_FULL / 2u) >> 16));
    p->command = command;
    return amount;
}

static uint32_t pwm_off(void *state, uint32_t elapsed_ms)
{
    struct output_pwm *p = state;
    uint32_t amount = p->command * elapsed_ms;
    hal_pwm_set(p->pin, 0);
    p->command = 0;
    return amount;
}

const struct output_kind pwm_output = {.open = pwm_open, .step = pwm_step, .off = pwm_off};
