/* Zero crossings of the mains at a pin: counted, debounced, and believed only while they come 45 to 65 times a second, or twice that often where
 * the detector sees both half waves.
 *
 * Board clock, once a turn. A crossing counts from 0.75 of the time between two of them on; an earlier one is a bounce or a disturbance. One
 * that has not come at 1.25 of it is made up, so that what counts crossings keeps step. None for MAINS_LOST_MS, or a second at another frequency:
 * the mains are lost, until a second is right again.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_OUTPUTS_MAINS_H
#define REFLUX_OUTPUTS_MAINS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/error.h"
#include "hal/pin.h"

#define MAINS_LOST_MS 60u
#define MAINS_HZ_LO   45u
#define MAINS_HZ_HI   65u

/* Owner: mains.c. */
struct mains {
    hal_pin pin; /* HAL_PIN_NONE: there is none, and everything below is 0 */
    bool found, missed;
    bool counts;       /* a crossing has begun the second */
    uint8_t per_cycle; /* crossings in a cycle: 1 or 2 */
    uint16_t
        since_ms; /* the crossing before, also one that was made up; stops at its largest value */
    uint16_t silent_ms;  /* since the last one that came; stops at its largest value */
    uint16_t second_ms;  /* since the second that is measured began */
    uint16_t crossings;  /* in it */
    uint16_t unfound_ms; /* stops at its largest value */
    uint32_t edges;      /* of the pin, at the last turn */
    uint32_t period_us;  /* between two crossings */
};

/* HAL_PIN_NONE: does nothing. A pin that cannot count, because another one has its interrupt, never has mains, and so is told. */
void mains_open(struct mains *m, hal_pin pin);

/* Clock. Crossings in this time, made up ones too; 0 while the mains are not found. */
uint32_t mains_pass(struct mains *m, uint32_t elapsed_ms);

/* How long ago the crossing was that mains_pass() has just returned: the last one, if it has returned several. */
uint32_t mains_late_ms(const struct mains *m);

/* Whether they are there. period_us and per_cycle hold. */
bool mains_found(const struct mains *m);

/* Whether they are lost, or have not been found in the first seconds. */
bool mains_missed(const struct mains *m);

/* Length of so many whole cycles, ms, and crossings in them. Only while they are found. */
uint32_t mains_cycles_ms(const struct mains *m, uint32_t cycles);
uint32_t mains_cycles_crossings(const struct mains *m, uint32_t cycles);

/* Tick. Hz; 0 while they are not found. */
float mains_hz(const struct mains *m);

#endif
