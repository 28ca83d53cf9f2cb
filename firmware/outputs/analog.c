/* Analogue output, 0-10 V: a pulse width behind a filter and an amplifier. Offset and gain: outputs/output_span.h.
 *
 * Its safe position is a command. hal_output_safe() and a reset give 0 V.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs/analog_state.h"

#include "outputs/output_kind.h"

#define PIN_OFF UINT32_MAX

static enum err analog_open(void *state, const struct output_settings *s, float *full)
{
    struct output_analog *a = state;
    *full = 1.0f;
    *a = (struct output_analog){
        .pin = s->pin[OUTPUT_PIN], .command = PIN_OFF, .span = output_span_of(s)};
    return hal_pwm_open(a->pin, output_hz(s), s->low);
}

static uint32_t analog_pass(const struct output_analog *a, uint32_t elapsed_ms)
{
    return a->command == PIN_OFF ? 0 : a->command * elapsed_ms;
}

static uint32_t analog_step(void *state, uint32_t command, uint32_t elapsed_ms)
{
    struct output_analog *a = state;
    uint32_t amount = analog_pass(a, elapsed_ms);
    if (command != a->command) {
        uint32_t whole = output_span_part(&a->span, command);
        hal_pwm_set(a->pin, (uint16_t)((whole * HAL_PWM_FULL + OUTPUT_FULL / 2u) >> 16));
    }
    a->command = command;
    return amount;
}

static uint32_t analog_off(void *state, uint32_t elapsed_ms)
{
    struct output_analog *a = state;
    uint32_t amount = analog_pass(a, elapsed_ms);
    hal_pwm_set(a->pin, 0);
    a->command = PIN_OFF;
    return amount;
}

const struct output_kind analog_output = {.check = output_span_check,
                                          .open = analog_open,
                                          .step = analog_step,
                                          .off = analog_off,
                                          .keeps_position = true};
