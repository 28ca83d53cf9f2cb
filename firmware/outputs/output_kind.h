/* What a kind of output is: how a command becomes levels of pins, millisecond by millisecond. To add one, write its file, its row in
 * output_kinds[] and its type in output_settings.h. A chip on a bus (4-20 mA, 0-10 V) is such a kind: its step() keeps the newest command, and
 * its clock() has the transfers. It must have a clear pin or a watchdog of its own, because hal_output_safe() reaches pins only.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_OUTPUTS_OUTPUT_KIND_H
#define REFLUX_OUTPUTS_OUTPUT_KIND_H

#include "base/error.h"
#include "hal/output.h"
#include "outputs/output_settings.h"

/* A command is a whole number: 0 to OUTPUT_FULL. So is an amount: 1/65536 ms of the output fully on, or of a step of a motor. */
#define OUTPUT_FULL 65536u

/* A turn of the clock counts at most so many milliseconds, so that an amount fits in 32 bits. */
#define OUTPUT_ELAPSED_MAX 60000u

struct output_kind {
    /* Says in words what is wrong with settings whose numbers are each in their range; NULL: nothing. May be missing. */
    const char *(*check)(const struct output_settings *s);
    /* Not in the clock. Opens the pins, all off, and begins. *full: the amount, without its 1/65536, that a millisecond with command 1
     * gives. Errors of hal/output.h. */
    enum err (*open)(void *state, const struct output_settings *s, float *full);
    /* Not in the clock, which does not step any more. Before its pins are closed; ends its transfers. May be missing. */
    void (*close)(void *state);
    /* Clock. Before a step() that follows an off(): periods end at whole multiples of their length of this clock, so that what an output does
     * depends on when, and not on since when. May be missing. */
    void (*align)(void *state, uint32_t now_ms);
    /* Clock. elapsed_ms have passed since the turn before, 1 to OUTPUT_ELAPSED_MAX; the command holds from now on. Returns the amount
     * of the time that has passed. */
    uint32_t (*step)(void *state, uint32_t command, uint32_t elapsed_ms);
    /* Clock. As step(), but everything is off from now on, least times or not, and what was carried over is forgotten. */
    uint32_t (*off)(void *state, uint32_t elapsed_ms);
    /* Clock. Once a turn behind step() or off(), for the transfers of a chip. May be missing. */
    void (*clock)(void *state, uint32_t now_ms);
    /* Tick. Frequency of the mains that it has measured, Hz; 0: unknown. May be missing. */
    float (*mains)(const void *state);
    /* Clock or tick. What the output itself has noticed: enum output_fault. May be missing. */
    uint8_t (*faults)(const void *state);
    /* The safe position is a command, settings.safe; false: off. */
    bool keeps_position;
};

/* The kind of a type, NULL for OUTPUT_NONE and for one that the board lacks. type < OUTPUT_TYPES. */
const struct output_kind *output_kind(uint8_t type);

extern const struct output_kind window_output, burst_output, relay_output, pwm_output,
    analog_output, stepper_output, motor_valve_output, enable_output, ad5422_output;

/* Bits of faults(). */
enum output_fault {
    OUTPUT_END_MISSED = 1u << 0, /* motor valve: an end switch did not close in time */
    OUTPUT_BOTH_ENDS = 1u << 1,  /* motor valve: both end switches are closed */
    OUTPUT_NO_POSITION =
        1u << 2, /* motor valve: it looks for an end, its position is not known yet */
    OUTPUT_NO_CHIP =
        1u << 3, /* chip: does not answer, or does not have what it was given; it is off */
    OUTPUT_LOOP_OPEN = 1u << 4, /* chip: its current does not flow */
    OUTPUT_HOT = 1u << 5,       /* chip */
    OUTPUT_NO_CROSSING =
        1u << 6 /* burst: no zero crossings of the mains come in, so its groups begin anywhere */
};

/* Faults of these that are told as they come and go; those of a motor valve and its ends are not among them. */
#define OUTPUT_TOLD (OUTPUT_NO_CHIP | OUTPUT_LOOP_OPEN | OUTPUT_HOT | OUTPUT_NO_CROSSING)

/* Words for the fault with this number, from 1, for people: "no chip answers"; "?" for others than these. */
const char *output_fault_text(uint8_t number);

/* Whole milliseconds of a setting in seconds that is in its range. Not in the clock. */
static inline uint32_t output_ms(float seconds)
{
    return (uint32_t)(seconds * 1000.0f + 0.5f);
}

/* Frequency of a pulse width; 0 on boards without. Not in the clock. */
#if OUTPUT_ALL_KINDS
static inline uint32_t output_hz(const struct output_settings *s)
{
    return (uint32_t)(s->frequency + 0.5f);
}
#else
static inline uint32_t output_hz(const struct output_settings *s)
{
    (void)s;
    return 0;
}
#endif

/* Whole command of a fraction, which is cut at 0 and 1. Not in the clock. */
static inline uint32_t output_whole_command(float fraction)
{
    if (!(fraction > 0.0f))
        return 0;
    return fraction < 1.0f ? (uint32_t)(fraction * (float)OUTPUT_FULL + 0.5f) : OUTPUT_FULL;
}

#endif
