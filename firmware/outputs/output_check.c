/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "outputs/output_check.h"

#include "base/assertion.h"
#include "base/channel.h"
#include "outputs/output_kind.h"

static bool number_wrong(const struct output_settings *s, struct output_problem *problem)
{
    for (size_t k = 0; k < output_number_count; k++) {
        const struct output_number *number = &output_numbers[k];
        float value = output_number(s, number);
        if (!(number->types & OUTPUT_BIT(s->type)))
            continue;
        if (float_is_finite(value) && value >= number->lo && value <= number->hi)
            continue;
        problem->number = number;
        problem->words = "a number is outside its range";
        return true;
    }
    return false;
}

static bool uses_pin(const struct output_settings *s, hal_pin pin)
{
    for (unsigned k = 0; k < OUTPUT_PINS; k++)
        if (output_uses(s->type, k) && s->pin[k] == pin)
            return true;
    return false;
}

static const char *pin_wrong(const struct output_settings *outputs, uint8_t index, unsigned k,
                             uint8_t *other)
{
    const struct output_settings *s = &outputs[index];
    hal_pin pin = s->pin[k];
    if (pin == HAL_PIN_NONE && s->type == OUTPUT_AD5422 && k == OUTPUT_PIN)
        return "the chip has no watchdog of its own, so its clear pin is needed to let it fall";
    if (pin == HAL_PIN_NONE)
        return output_needs(s->type, k) ? "a pin is missing" : NULL;
    if (!hal_pin_is_free(pin))
        return "the pin is not free: this board lacks it, or something else needs it";
    for (unsigned m = 0; m < k; m++)
        if (s->pin[m] == pin)
            return "the output has the same pin twice";
    for (uint8_t m = 0; m < index; m++)
        if (outputs[m].type < OUTPUT_TYPES && uses_pin(&outputs[m], pin) &&
            !(k == OUTPUT_CROSSING && outputs[m].pin[k] == pin)) {
            *other = m;
            return "another output has the same pin";
        }
    return NULL;
}

static bool has_pulses(const struct output_settings *s)
{
    return s->type == OUTPUT_PWM || s->type == OUTPUT_ANALOG;
}

/* What is wrong with the timer of a pulse width. */
static const char *timer_wrong(const struct output_settings *outputs, uint8_t index, uint8_t *other)
{
    const struct output_settings *s = &outputs[index];
    struct hal_pwm_place own, place;
    if (!hal_pwm_find(s->pin[OUTPUT_PIN], output_hz(s), &own))
        return "the pin has no timer for a pulse width, or not with this frequency";
    for (uint8_t m = 0; m < index; m++) {
        const struct output_settings *o = &outputs[m];
        if (!has_pulses(o) || !hal_pwm_find(o->pin[OUTPUT_PIN], output_hz(o), &place) ||
            place.timer != own.timer)
            continue;
        *other = m;
        if (place.channel == own.channel)
            return "another output has the same channel of the pin's timer";
        if (output_hz(o) != output_hz(s))
            return "another output of the pin's timer has another frequency";
    }
    *other = OUTPUT_NO_OTHER;
    return NULL;
}

static bool pins_wrong(const struct output_settings *outputs, uint8_t index,
                       struct output_problem *problem)
{
    for (unsigned k = 0; k < OUTPUT_PINS; k++) {
        if (!output_uses(outputs[index].type, k))
            continue;
        problem->words = pin_wrong(outputs, index, k, &problem->other);
        problem->pin = (uint8_t)k;
        if (problem->words)
            return true;
    }
    problem->pin = OUTPUT_PIN;
    problem->words =
        has_pulses(&outputs[index]) ? timer_wrong(outputs, index, &problem->other) : NULL;
    if (problem->words)
        return true;
    problem->pin = OUTPUT_PINS;
    return false;
}

bool output_check(const struct output_settings *outputs, uint8_t n, uint8_t index,
                  struct output_problem *problem)
{
    REFLUX_ASSERT(index < n && n <= OUTPUTS_MAX);
    (void)n;
    const struct output_settings *s = &outputs[index];
    *problem = (struct output_problem){.pin = OUTPUT_PINS, .other = OUTPUT_NO_OTHER};
    if (s->type >= OUTPUT_TYPES) {
        problem->words = "there is no such type of output";
        return false;
    }
    if (s->type == OUTPUT_NONE)
        return true;
    const struct output_kind *kind = output_kind(s->type);
    if (!OUTPUT_ALL_KINDS && !kind) {
        problem->words = OUTPUT_KINDS_HERE;
        return false;
    }
    if (number_wrong(s, problem) || pins_wrong(outputs, index, problem))
        return false;
    problem->words = kind->check ? kind->check(s) : NULL;
    for (uint8_t m = 0; !problem->words && s->type == OUTPUT_ENABLE && m < index; m++)
        if (outputs[m].type == OUTPUT_ENABLE) {
            problem->other = m;
            problem->words = "another output is the enable output already";
        }
    return !problem->words;
}
