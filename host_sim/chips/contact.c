/* A contact between a pin and ground that a quantity closes or opens: a level switch, a pressure or a temperature switch.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <string.h>

#include "chips/at_pin.h"

#define AHEAD_MS 1000u /* a next edge is looked for so far ahead */

static bool parse_normally(const char *text, double *value)
{
    *value = strcmp(text, "closed") == 0 ? 1.0 : 0.0;
    return *value == 1.0 || strcmp(text, "open") == 0;
}

enum { LIMIT, HYSTERESIS, NORMALLY, BOUNCE };
static const struct chip_property properties[] = {
    [LIMIT] = {.name = "limit", .unit = "", .lo = -1e9, .hi = 1e9, .at_first = 0.5},
    [HYSTERESIS] = {.name = "hysteresis", .unit = "", .lo = 0, .hi = 1e9, .at_first = 0},
    [NORMALLY] = {.name = "normally",
                  .unit = "",
                  .lo = 0,
                  .hi = 1,
                  .at_first = 0,
                  .parse = parse_normally,
                  .form = "open or closed"},
    [BOUNCE] = {.name = "bounce", .unit = "ms", .lo = 0, .hi = 100, .at_first = 5},
};

enum { VALUE, OPEN, SHORT, JAMMED, CHATTER };
static const struct chip_input inputs[] = {
    [VALUE] = {"value", "-", -1e9, 1e9, 0, "what moves the contact, from the limit on"},
    [OPEN] = {"open", "", 0, 1, 0, "a wire is broken: open"},
    [SHORT] = {"short", "", 0, 1, 0, "the wires touch: closed"},
    [JAMMED] = {"jammed", "", 0, 1, 0, "the contact stays as it is"},
    [CHATTER] = {"chatter", "ms", 0, 1000, 0, "it is open or closed at random for so long each"},
};

struct contact {
    struct at_pin at;
    uint64_t since_ms; /* from here on inputs are what they are now */
    bool beyond;       /* the limit, until then */
    bool before;       /* the contact was closed then */
};

/* Beyond the limit; back when the hysteresis has been passed, too. */
static bool is_beyond(const struct contact *k)
{
    const struct chip *c = &k->at.chip;
    if (c->input[JAMMED] != 0.0) {
        return k->beyond;
    }
    return k->beyond ? c->input[VALUE] > c->property[LIMIT] - c->property[HYSTERESIS]
                     : c->input[VALUE] >= c->property[LIMIT];
}

static bool is_closed(const struct contact *k)
{
    const struct chip *c = &k->at.chip;
    if (c->input[OPEN] != 0.0 || c->input[SHORT] != 0.0) {
        return c->input[OPEN] == 0.0;
    }
    return is_beyond(k) != (c->property[NORMALLY] != 0.0);
}

static bool is_low_in(const struct contact *k, uint64_t ms)
{
    const struct chip *c = &k->at.chip;
    if (ms <= k->since_ms) {
        return k->before;
    }
    if (c->input[CHATTER] != 0.0) {
        return at_pin_chance(&k->at, (uint64_t)((double)ms / c->input[CHATTER])) < 0.5;
    }
    bool closed = is_closed(k);
    bool bounces = closed != k->before && (double)(ms - k->since_ms) <= c->property[BOUNCE];
    return bounces ? at_pin_chance(&k->at, ms) < 0.5 : closed;
}

static bool low(const struct chip *c, uint64_t now_ns)
{
    const struct contact *k = (const struct contact *)c;
    return is_low_in(k, at_pin_ms(&k->at, now_ns));
}

static uint64_t next_edge(const struct chip *c, uint64_t now_ns)
{
    const struct contact *k = (const struct contact *)c;
    uint64_t ms = at_pin_ms(&k->at, now_ns), quiet_ms = k->since_ms + 1u;
    quiet_ms += (uint64_t)c->property[BOUNCE];
    bool chatters = c->input[CHATTER] != 0.0, at_first = is_low_in(k, ms);
    uint64_t end_ms = chatters ? ms + AHEAD_MS : quiet_ms;
    while (++ms <= end_ms) {
        if (is_low_in(k, ms) != at_first) {
            return k->at.begin_ns + ms * AT_PIN_MS_NS - AT_PIN_MS_NS / 2u;
        }
    }
    return chatters ? k->at.begin_ns + ms * AT_PIN_MS_NS : UINT64_MAX;
}

static void begin(struct chip *c, uint64_t now_ns, bool flows)
{
    struct contact *k = (struct contact *)c;
    k->before = is_closed(k);
    k->beyond = is_beyond(k);
    at_pin_begin(&k->at, now_ns, flows);
    k->since_ms = 0;
}

/* Several inputs may change in one moment; what was before is what was before the first of them. */
static void catch_up(struct chip *c, uint64_t now_ns)
{
    struct contact *k = (struct contact *)c;
    uint64_t ms = at_pin_ms(&k->at, now_ns);
    if (ms == k->since_ms) {
        return;
    }
    k->before = low(c, now_ns);
    k->beyond = is_beyond(k);
    k->since_ms = ms;
}

const struct chip_kind chip_level = {.name = "level",
                                     .bus = CHIP_PIN,
                                     .properties = properties,
                                     .n_properties = CHIP_COUNT(properties),
                                     .inputs = inputs,
                                     .n_inputs = CHIP_COUNT(inputs),
                                     .size = sizeof(struct contact),
                                     .power_on = at_pin_power_on,
                                     .catch_up = catch_up,
                                     .begin = begin,
                                     .low = low,
                                     .next_edge = next_edge};
