/* What pulls a pin down for a moment again and again: a flow meter with a Hall sensor or a reed contact, and a detector of the mains' zero crossings.
 *
 * Pulses are counted as a real number that grows with the rate, so that none is lost or added when the rate changes. One comes in each millisecond
 * in which the number gets beyond a whole one.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <math.h>

#include "chips/at_pin.h"

#define MS_PER_S 1000.0
#define SPAN     0.4  /* of a millisecond: pulses stand in this part of it */
#define JITTER   0.1  /* of those that a wire picks up, which no dead time may just meet */
#define MOST     6u   /* pulses in a millisecond */
#define BOUNCES  3u   /* pulses in place of one */
#define AHEAD_MS 1000 /* a next edge is looked for so far ahead */

/* Both kinds have their inputs in this order, and the mains these properties. */
enum { RATE, STOPPED, PICKUP, OTHER };
enum { FREQUENCY, PER_CYCLE };

static const struct chip_input flow_inputs[] = {
    [RATE] = {"rate", "1/s", 0, 2000, 0, "pulses a second"},
    [STOPPED] = {"stopped", "", 0, 1, 0, "the rotor is stuck or has no supply: no pulses"},
    [PICKUP] = {"pickup", "1/s", 0, 6000, 0, "pulses that the wire picks up, with or without flow"},
    [OTHER] = {"bounce", "", 0, 1, 0, "each pulse comes as three"},
};

static const struct chip_property mains_properties[] = {
    [FREQUENCY] = {.name = "frequency", .unit = "Hz", .lo = 40, .hi = 70, .at_first = 50},
    [PER_CYCLE] = {.name = "per_cycle", .unit = "", .lo = 1, .hi = 2, .at_first = 2},
};

static const struct chip_input mains_inputs[] = {
    [RATE] = {"deviation", "Hz", -5, 5, 0, "of the frequency, where the plant has one"},
    [STOPPED] = {"lost", "", 0, 1, 0, "no crossings"},
    [PICKUP] = {"pickup", "1/s", 0, 6000, 0, "pulses that the wire picks up"},
    [OTHER] = {"shift", "Hz", -30, 10, 0, "added to the frequency"},
};

struct pulses {
    struct at_pin at;
    uint64_t since_ms;
    double count; /* of the pulses until then */
};

static double rate(const struct chip *c)
{
    if (c->kind == &chip_flow) {
        return ((const struct at_pin *)c)->stands ? 0.0 : c->input[RATE];
    }
    return (c->property[FREQUENCY] + c->input[RATE] + c->input[OTHER]) * c->property[PER_CYCLE];
}

static double count_at(const struct pulses *p, uint64_t ms)
{
    double since_ms = (double)((int64_t)ms - (int64_t)p->since_ms);
    return p->count + rate(&p->at.chip) * since_ms / MS_PER_S;
}

/* Those of the meter itself, as they come to the pin. */
static unsigned own_pulses(const struct pulses *p, uint64_t ms)
{
    const struct chip *c = &p->at.chip;
    if (c->input[STOPPED] != 0.0) {
        return 0;
    }
    double n = floor(count_at(p, ms + 1u)) - floor(count_at(p, ms));
    bool bounces = c->kind == &chip_flow && c->input[OTHER] != 0.0;
    return n <= 0.0 ? 0 : (unsigned)n * (bounces ? BOUNCES : 1u);
}

static unsigned picked_up(const struct pulses *p, uint64_t ms)
{
    double expected = p->at.chip.input[PICKUP] / MS_PER_S;
    double whole = floor(expected);
    return (unsigned)whole + (at_pin_chance(&p->at, ms) < expected - whole ? 1u : 0u);
}

/* The pulses of a millisecond: where they begin, and how far they are apart. */
struct burst {
    unsigned n;
    uint64_t first_ns, apart_ns;
};

static struct burst burst_in(const struct pulses *p, uint64_t ms)
{
    unsigned picked = picked_up(p, ms), n = own_pulses(p, ms) + picked;
    n = n < MOST ? n : MOST;
    double late = picked > 0 ? JITTER * at_pin_chance(&p->at, ~ms) : 0.0;
    return (struct burst){
        .n = n,
        .first_ns = p->at.begin_ns + ms * AT_PIN_MS_NS +
                    (uint64_t)((AT_PIN_FIRST + late) * (double)AT_PIN_MS_NS),
        .apart_ns = n == 0 ? 0 : (uint64_t)(SPAN * (double)AT_PIN_MS_NS) / n,
    };
}

static uint64_t ms_of(const struct pulses *p, uint64_t now_ns)
{
    return (now_ns - p->at.begin_ns) / AT_PIN_MS_NS;
}

static bool low(const struct chip *c, uint64_t now_ns)
{
    const struct pulses *p = (const struct pulses *)c;
    struct burst b = burst_in(p, ms_of(p, now_ns));
    if (now_ns < b.first_ns || b.n == 0) {
        return false;
    }
    uint64_t since_ns = now_ns - b.first_ns;
    return since_ns / b.apart_ns < b.n && since_ns % b.apart_ns < b.apart_ns / 2u;
}

static uint64_t next_edge(const struct chip *c, uint64_t now_ns)
{
    const struct pulses *p = (const struct pulses *)c;
    if ((rate(c) == 0.0 || c->input[STOPPED] != 0.0) && c->input[PICKUP] == 0.0) {
        return UINT64_MAX;
    }
    uint64_t ms = ms_of(p, now_ns), end_ms = ms + AHEAD_MS;
    for (; ms < end_ms; ms++) {
        struct burst b = burst_in(p, ms);
        for (unsigned half = 0; half < 2u * b.n; half++) {
            uint64_t edge_ns =
                b.first_ns + half / 2u * b.apart_ns + (half % 2u != 0 ? b.apart_ns / 2u : 0);
            if (edge_ns > now_ns) {
                return edge_ns;
            }
        }
    }
    return p->at.begin_ns + end_ms * AT_PIN_MS_NS; /* none so far: look again there */
}

static void begin(struct chip *c, uint64_t now_ns, bool flows)
{
    struct pulses *p = (struct pulses *)c;
    at_pin_begin(&p->at, now_ns, flows);
    p->since_ms = 0;
    p->count = 0.0;
}

static void catch_up(struct chip *c, uint64_t now_ns)
{
    struct pulses *p = (struct pulses *)c;
    uint64_t ms = at_pin_ms(&p->at, now_ns);
    p->count = count_at(p, ms);
    p->since_ms = ms;
}

const struct chip_kind chip_flow = {.name = "flow",
                                    .bus = CHIP_PIN,
                                    .inputs = flow_inputs,
                                    .n_inputs = CHIP_COUNT(flow_inputs),
                                    .size = sizeof(struct pulses),
                                    .power_on = at_pin_power_on,
                                    .catch_up = catch_up,
                                    .begin = begin,
                                    .low = low,
                                    .next_edge = next_edge};
const struct chip_kind chip_mains = {.name = "mains",
                                     .bus = CHIP_PIN,
                                     .properties = mains_properties,
                                     .n_properties = CHIP_COUNT(mains_properties),
                                     .inputs = mains_inputs,
                                     .n_inputs = CHIP_COUNT(mains_inputs),
                                     .size = sizeof(struct pulses),
                                     .power_on = at_pin_power_on,
                                     .catch_up = catch_up,
                                     .begin = begin,
                                     .low = low,
                                     .next_edge = next_edge};
