/* Stepper: a pump behind a driver with a step and a direction input. A step is a pulse of 1 ms, at most one in 2 ms, so that the fastest motor
 * makes 500 steps a second. Pulses stand at whole milliseconds: at 400 steps a second 2 and 3 ms follow each other.
 *
 * The motor follows the integral of the command without losing a step, at a speed between 0 and that of command 1, which changes by no more than
 * the ramp. With e the steps owed and w the speed above the one that is wanted, the motor turns faster where
 *
 *     2 ramp e > w |w|
 *
 * and slower otherwise: the fastest way to owe nothing without running past it (a bang-bang law with its switching curve). What a ramp up has
 * owed is therefore made up as soon as the command leaves room below the full speed, and what a ramp down has pumped too much is left out later.
 *
 * Bounds of e, with v the full speed: v^2 / ramp at every moment, whatever the command does; a quarter of a step once the motor has caught up
 * with a steady command below 1.
 *
 * off() stops the motor without a ramp.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs/stepper_state.h"

#include "outputs/output_kind.h"

#define STEP        ((int64_t)1 << 48)
#define NEAR        (STEP / 4)
#define STEPS_MAX   500.0f /* a second */
#define STEPS_MIN   0.1f
#define STALL_MS    10u /* the motor has stopped where the clock stood for so long */
#define ML_S_TO_L_H 3.6f

/* Steps a second at command 1. */
static float full_speed(const struct output_settings *s)
{
    return s->flow * s->steps / ML_S_TO_L_H;
}

static const char *stepper_check(const struct output_settings *s)
{
    float speed = full_speed(s);
    if (speed > STEPS_MAX)
        return "flow and steps make more than 500 steps a second";
    if (speed < STEPS_MIN)
        return "flow and steps make less than 0.1 steps a second";
    return NULL;
}

static enum err stepper_open(void *state, const struct output_settings *s, float *full)
{
    struct output_stepper *m = state;
    float speed = full_speed(s);
    *full = speed / 1000.0f;
    *m = (struct output_stepper){.pin = s->pin[OUTPUT_PIN],
                                 .full = (uint32_t)(speed * 4294967.296f),
                                 .ramp = (uint32_t)(s->ramp * 4294.967296f)};
    hal_pin direction = s->pin[OUTPUT_SECOND_PIN];
    if (direction != HAL_PIN_NONE) {
        enum err err = hal_output_open(direction, s->low);
        if (err)
            return err;
        hal_output_set(direction, s->reverse);
    }
    return hal_output_open(m->pin, s->low);
}

/* Speed for the next millisecond. Products stay below 2^47 and 2^56: `fall` below 2^23, `owed` below 2^30, the ramp below 2^26. */
static int64_t next_speed(const struct output_stepper *m)
{
    int64_t wanted = (int64_t)((uint64_t)m->full * m->command);
    int64_t change = (int64_t)m->ramp * (int64_t)OUTPUT_FULL;
    int64_t excess = m->speed - wanted;
    if (excess <= change && excess >= -change && m->owed <= NEAR && m->owed >= -NEAR)
        return wanted;
    int64_t fall = excess / (1 << 24), owed = m->owed / ((int64_t)1 << 32);
    if (2 * owed * m->ramp > (fall < 0 ? -fall * fall : fall * fall)) {
        int64_t top = (int64_t)m->full * (int64_t)OUTPUT_FULL;
        return m->speed + change < top ? m->speed + change : top;
    }
    return m->speed > change ? m->speed - change : 0;
}

static uint32_t stepper_step(void *state, uint32_t command, uint32_t elapsed_ms)
{
    struct output_stepper *m = state;
    if (elapsed_ms > STALL_MS)
        m->speed = 0;
    /* One pulse at most, however much time has passed: lost time is not made up. */
    m->owed += (int64_t)((uint64_t)m->full * m->command) - m->speed;
    m->phase += m->speed;
    m->command = command;
    m->speed = next_speed(m);
    bool step = m->phase >= STEP;
    if (step)
        m->phase -= STEP;
    if (step != m->high)
        hal_output_set(m->pin, step);
    m->high = step;
    return step ? OUTPUT_FULL : 0;
}

static uint32_t stepper_off(void *state, uint32_t elapsed_ms)
{
    struct output_stepper *m = state;
    (void)elapsed_ms;
    hal_output_set(m->pin, false);
    m->high = false;
    m->speed = 0;
    m->owed = 0;
    m->command = 0;
    return 0;
}

const struct output_kind stepper_output = {
    .check = stepper_check, .open = stepper_open, .step = stepper_step, .off = stepper_off};
