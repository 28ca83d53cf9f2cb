/* For the models of what is at a pin of the board itself: a voltage, pulses, a contact.
 *
 * Boards look at their inputs once in a millisecond of their clock, some of them microseconds later than others. So that all see the same, each model
 * counts milliseconds from a moment soon after such a look (begin() of its kind), and what it does by itself comes in the midst of one of them:
 * a contact opens or closes in its middle, pulses come between AT_PIN_FIRST and 0.7 of it.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_CHIPS_AT_PIN_H
#define REFLUX_CHIPS_AT_PIN_H

#include "chips/chip_inside.h"

#define AT_PIN_MS_NS UINT64_C(1000000)
#define AT_PIN_FIRST 0.2

/* Stands at the beginning of the state of each kind. */
struct at_pin {
    struct chip chip;
    uint64_t begin_ns;
    bool stands; /* what it measures does not move */
};

/* What begin() of each kind does. */
static inline void at_pin_begin(struct at_pin *p, uint64_t now_ns, bool flows)
{
    p->begin_ns = now_ns;
    p->stands = !flows;
}

/* power_on() of each kind: its time begins. */
static inline void at_pin_power_on(struct chip *c, uint64_t now_ns)
{
    c->kind->begin(c, now_ns, true);
}

/* The nearest whole millisecond of its time. */
static inline uint64_t at_pin_ms(const struct at_pin *p, uint64_t now_ns)
{
    return (now_ns - p->begin_ns + AT_PIN_MS_NS / 2u) / AT_PIN_MS_NS;
}

/* A random number, [0, 1), that belongs to this chip and this millisecond. */
static inline double at_pin_chance(const struct at_pin *p, uint64_t ms)
{
    uint64_t state = p->chip.seed ^ (ms + 1u) * UINT64_C(0xD1342543DE82EF95);
    return chip_uniform(&state);
}

#endif
