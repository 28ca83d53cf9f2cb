/* Analogue output, 0-10 V: a pulse width behind a filter and an amplifier. Output = offset + gain * command, fractions of its span, so that
 * 2-10 V is offset 0.2 and gain 0.8, and a gain below 0 turns it round.
 *
 * Its safe position is a command. hal_output_safe() and a reset give 0 V.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs/analog_state.h"

#include "outputs/output_kind.h"

#define PIN_OFF UINT32_MAX

static const char *analog_check(const struct output_settings *s)
{
    float end = s->offset + s->gain;
    /* Half a code of the pulse width is rounding of the settings. */
    if (end < -0.5f / (float)HAL_PWM_FULL || end > 1.0f + 0.5f / (float)HAL_PWM_FULL)
        return "offset and gain take the output out of 0 to 1 at command 1";
    return NULL;
}

static enum err analog_open(void *state, const struct output_settings *s, float *full)
{
    struct output_analog *a = state;
    bool falls = s->gain < 0.0f;
    *full = 1.0f;
    *a = (struct output_analog){.pin = s->pin[OUTPUT_PIN],
                                .command = PIN_OFF,
                                .gain = output_whole_command(falls ? -s->gain : s->gain),
                                .offset = output_whole_command(s->offset),
                                .falls = falls};
    return hal_pwm_open(a->pin, output_hz(s), s->low);
}

/* Part of the output's span at a command. */
static uint32_t analog_part(const struct output_analog *a, uint32_t command)
{
    uint32_t change = (uint32_t)(((uint64_t)a->gain * command + OUTPUT_FULL / 2u) >> 16);
    if (a->falls)
        return a->offset > change ? a->offset - change : 0;
    return a->offset + change < OUTPUT_FULL ? a->offset + change : OUTPUT_FULL;
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
        uint32_t whole = analog_part(a, command);
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

const struct output_kind analog_output = {.check = analog_check,
                                          .open = analog_open,
                                          .step = analog_step,
                                          .off = analog_off,
                                          .keeps_position = true};
