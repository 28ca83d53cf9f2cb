/* A voltage at an analogue input of the board: what a shunt, a divider or an amplifier makes of a sensor.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "chips/at_pin.h"

#define SUPPLY_V 3.3

enum { VOLTAGE, OPEN, SHORT_LOW, SHORT_HIGH, STUCK, PICKUP };
static const struct chip_input inputs[] = {
    [VOLTAGE] = {"voltage", "V", -0.3, 3.6, 0, "at the pin"},
    [OPEN] = {"open", "", 0, 1, 0, "the wire is broken: 0 V over the shunt or the divider"},
    [SHORT_LOW] = {"short_low", "", 0, 1, 0, "the wire touches ground"},
    [SHORT_HIGH] = {"short_high", "", 0, 1, 0, "the wire touches the supply of 3.3 V"},
    [STUCK] = {"stuck", "", 0, 1, 0, "the voltage stays as it is"},
    [PICKUP] = {"pickup", "V", 0, 1, 0, "noise that the wire picks up, standard deviation"},
};

struct analog {
    struct at_pin at;
    double held; /* voltage before it was stuck */
};

static void begin(struct chip *c, uint64_t now_ns, bool flows)
{
    at_pin_begin(&((struct analog *)c)->at, now_ns, flows);
}

static void catch_up(struct chip *c, uint64_t now_ns)
{
    struct analog *a = (struct analog *)c;
    (void)now_ns;
    if (c->input[STUCK] == 0.0) {
        a->held = c->input[VOLTAGE];
    }
}

static double pin_volts(const struct chip *c, uint64_t now_ns)
{
    const struct analog *a = (const struct analog *)c;
    if (c->input[OPEN] != 0.0 || c->input[SHORT_LOW] != 0.0) {
        return 0.0;
    }
    if (c->input[SHORT_HIGH] != 0.0) {
        return SUPPLY_V;
    }
    double volts = c->input[STUCK] != 0.0 ? a->held : c->input[VOLTAGE];
    if (c->input[PICKUP] == 0.0) {
        return volts;
    }
    uint64_t state = c->seed + 12u * at_pin_ms(&a->at, now_ns);
    return volts + c->input[PICKUP] * chip_normal(&state);
}

const struct chip_kind chip_analog = {.name = "analog",
                                      .bus = CHIP_PIN,
                                      .inputs = inputs,
                                      .n_inputs = CHIP_COUNT(inputs),
                                      .size = sizeof(struct analog),
                                      .power_on = at_pin_power_on,
                                      .catch_up = catch_up,
                                      .begin = begin,
                                      .pin_volts = pin_volts};
