/* Burst: a solid-state relay that switches at zero, on or off for groups of whole cycles of the mains.
 *
 * With an input for the zero crossing (outputs/mains.h) a group is counted in crossings, whatever the frequency. The pin switches a quarter of a
 * cycle behind one, in the middle of a half wave: so the relay itself switches at the next crossing, and neither the milliseconds of this clock
 * nor the detector's own delay can make it the one before. Without one, and while no crossings come, a group has the length of its cycles and
 * begins anywhere in one.
 *
 * First-order delta-sigma: at the beginning of a group the output goes on if that leaves less owed (see window.c) at its end than being off.
 *
 * Bounds of owed, with G the length of a group: half of G at the end of a group in which the command has not changed, and 1.5 G at every
 * moment, whatever the command does. A change acts with the next group, also one to 0. Where crossings are lost or found, one group is longer
 * or shorter, by less than G and MAINS_LOST_MS.
 *
 * A gate of whole cycles holds an even number of zero crossings, so half waves of both polarities are equal in number. At 60 Hz a cycle is
 * 16 2/3 ms; a group is then a multiple of 3 cycles, 50 ms, because one that is rounded to milliseconds would lose or gain a half wave, of
 * the same polarity as long as clock and mains keep step. Where the mains are off their frequency by a part d, a gate of n cycles that begins
 * within 2 n d half waves of a crossing holds one crossing more or fewer. By the next gate it has moved on by at least that, so no two gates in a
 * row lean to the same side, and the direct current is at most d/2 of the current at full power.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "outputs/burst_state.h"

#include "outputs/output_kind.h"
#include "outputs/output_switch.h"

#define CYCLE_50_MS  20u
#define CYCLES_60_MS 50u /* three of them */
#define CYCLES_60    3u
#define QUARTER      4u

static const char *burst_check(const struct output_settings *s)
{
    uint32_t cycles = (uint32_t)s->cycles;
    if ((float)cycles != s->cycles)
        return "the number of cycles is not whole";
    if (s->mains_60 && cycles % CYCLES_60 != 0)
        return "at 60 Hz the cycles must be a multiple of 3, because only these are whole "
               "milliseconds";
    return NULL;
}

static enum err burst_open(void *state, const struct output_settings *s, float *full)
{
    struct output_burst *b = state;
    uint32_t cycles = (uint32_t)s->cycles;
    *full = 1.0f;
    *b = (struct output_burst){.group_ms = s->mains_60 ? cycles / CYCLES_60 * CYCLES_60_MS
                                                       : cycles * CYCLE_50_MS,
                               .cycles = (uint8_t)cycles,
                               .crossings = 1};
    b->left_ms = b->group_ms;
    mains_open(&b->mains, s->pin[OUTPUT_CROSSING]);
    return output_switch_open(&b->contact, s->pin[OUTPUT_PIN], s->low, 0, 0);
}

static void burst_align(void *state, uint32_t now_ms)
{
    struct output_burst *b = state;
    b->left_ms = b->group_ms - now_ms % b->group_ms;
}

/* A group of this length begins. */
static void begin_group(struct output_burst *b, uint32_t group_ms)
{
    uint64_t half = (uint64_t)group_ms * (OUTPUT_FULL / 2u);
    bool on = b->owed + (int64_t)((uint64_t)b->command * group_ms) >= (int64_t)half;
    if (on != output_switch_is_on(&b->contact))
        output_switch_set(&b->contact, on);
}

/* Part of the group may have passed already, where the clock stood. */
static void burst_run_free(struct output_burst *b, uint32_t elapsed_ms)
{
    if (elapsed_ms < b->left_ms) {
        b->left_ms -= elapsed_ms;
        return;
    }
    b->left_ms = b->group_ms - (elapsed_ms - b->left_ms) % b->group_ms;
    begin_group(b, b->group_ms);
}

static void burst_follow_mains(struct output_burst *b, uint32_t crossings, uint32_t elapsed_ms)
{
    bool was_waiting = b->wait_ms != 0;
    b->wait_ms = b->wait_ms > elapsed_ms ? (uint8_t)(b->wait_ms - elapsed_ms) : 0;
    if (was_waiting && b->wait_ms == 0)
        begin_group(b, mains_cycles_ms(&b->mains, b->cycles));
    if (crossings < b->crossings) {
        b->crossings = (uint16_t)(b->crossings - crossings);
        return; /* mostly because there was none */
    }
    uint32_t group = mains_cycles_crossings(&b->mains, b->cycles);
    b->crossings = (uint16_t)(group - (crossings - b->crossings) % group);
    uint32_t quarter_ms = mains_cycles_ms(&b->mains, 1) / QUARTER,
             late_ms = mains_late_ms(&b->mains);
    b->left_ms = b->group_ms; /* if crossings are lost from now on */
    b->wait_ms = quarter_ms > late_ms ? (uint8_t)(quarter_ms - late_ms) : 0;
    if (b->wait_ms == 0)
        begin_group(b, mains_cycles_ms(&b->mains, b->cycles));
}

/* Switches where a group begins. */
static void burst_time(struct output_burst *b, uint32_t crossings, uint32_t elapsed_ms)
{
    if (mains_found(&b->mains)) {
        burst_follow_mains(b, crossings, elapsed_ms);
        return;
    }
    b->crossings = 1;
    b->wait_ms = 0;
    burst_run_free(b, elapsed_ms);
}

static uint32_t burst_step(void *state, uint32_t command, uint32_t elapsed_ms)
{
    struct output_burst *b = state;
    uint32_t amount = output_switch_pass(&b->contact, elapsed_ms);
    b->owed += (int64_t)((uint64_t)b->command * elapsed_ms) - amount;
    b->command = command;
    burst_time(b, mains_pass(&b->mains, elapsed_ms), elapsed_ms);
    return amount;
}

static uint32_t burst_off(void *state, uint32_t elapsed_ms)
{
    struct output_burst *b = state;
    uint32_t amount = output_switch_pass(&b->contact, elapsed_ms);
    output_switch_set(&b->contact, false);
    b->owed = 0;
    b->command = 0;
    b->left_ms = b->group_ms;
    b->crossings = 1;
    b->wait_ms = 0;
    (void)mains_pass(&b->mains, elapsed_ms);
    return amount;
}

static uint8_t burst_faults(const void *state)
{
    const struct output_burst *b = state;
    return mains_missed(&b->mains) ? OUTPUT_NO_CROSSING : 0;
}

static float burst_mains(const void *state)
{
    const struct output_burst *b = state;
    return mains_hz(&b->mains);
}

const struct output_kind burst_output = {.check = burst_check,
                                         .open = burst_open,
                                         .align = burst_align,
                                         .step = burst_step,
                                         .off = burst_off,
                                         .faults = burst_faults,
                                         .mains = burst_mains};
