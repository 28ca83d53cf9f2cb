/* The kind `experiment` on the whole firmware with plants of the library: n measurements and n MVs by name, a loop of each pair in manual,
 * all of it configured from what the plant says of its channels. */
#ifndef REFLUX_TESTS_EXPERIMENT_PLANT_H
#define REFLUX_TESTS_EXPERIMENT_PLANT_H

#include <math.h>

#include "plant_board.h"

enum { IDLE, ASKED, SETTLES, EXCITES, COMPUTES, DONE, ABORTED };
enum { USABLE = 1, UNSURE, SLOW, POOR, UNSTABLE, UNTOLD, LOOPS = 10 };

struct experiment_case {
    const char *plant;
    uint32_t tick_ms;
    unsigned n;
    const char *y[4], *u[4];
    const char *lines[16]; /* settings of block 1 but for kind and inputs */
};

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

/* Kotyk and Machacek's column; both inputs by 1 V, a tenth of the span to either side. */
#define KOTYK_COLUMN(band_1, band_2)                                                               \
    {                                                                                              \
        "kotyk-column", 120000, 2, {"y1", "y2"}, {"u1", "u2"},                                     \
        {                                                                                          \
            "bits 7", "clock 4", "amplitude.1 1", "amplitude.2 1", band_1, band_2                  \
        }                                                                                          \
    }

static const double kotyk_gain[2][2] = {{0.03465 / 0.22278, -0.01254 / 0.22278},
                                        {0.01578 / 0.07983, -0.01833 / 0.07983}};

static inline void configure_signal(const char *what, unsigned k, const char *name, bool mv)
{
    const struct plant_channel *c = &kind->channels[plant_channel_of(name)];
    char line[120];
    snprintf(line, sizeof line, "set %s%u.name %s", what, k, name);
    ask_ok(line);
    snprintf(line, sizeof line, "set %s%u.unit %s", what, k, c->unit);
    ask_ok(line);
    snprintf(line, sizeof line, "set %s%u.lo %.7g", what, k, c->lo);
    ask_ok(line);
    snprintf(line, sizeof line, "set %s%u.hi %.7g", what, k, c->hi);
    ask_ok(line);
    if (!mv)
        return;
    snprintf(line, sizeof line, "set mv%u.min %.7g", k, c->lo);
    ask_ok(line);
    snprintf(line, sizeof line, "set mv%u.max %.7g", k, c->hi);
    ask_ok(line);
    snprintf(line, sizeof line, "set mv%u.safe %.7g", k, c->safe);
    ask_ok(line);
}

static inline void configure_case(const struct experiment_case *c)
{
    char line[200];
    ask_ok("begin");
    snprintf(line, sizeof line, "set tick.base %g", c->tick_ms / 1000.0);
    ask_ok(line);
    for (unsigned k = 0; k < c->n; k++) {
        configure_signal("meas", k + 1, c->y[k], false);
        configure_signal("mv", k + 1, c->u[k], true);
        snprintf(line, sizeof line, "set loop%u.name l%u", k + 1, k + 1);
        ask_ok(line);
        snprintf(line, sizeof line, "set loop%u.pv %s", k + 1, c->y[k]);
        ask_ok(line);
        snprintf(line, sizeof line, "set loop%u.out %s", k + 1, c->u[k]);
        ask_ok(line);
    }
    ask_ok("set block1.kind experiment");
    int at = snprintf(line, sizeof line, "set block1.inputs ");
    for (unsigned k = 0; k < 2 * c->n; k++)
        at += snprintf(line + at, sizeof line - (size_t)at, "%s%s", k ? "," : "",
                       k < c->n ? c->y[k] : c->u[k - c->n]);
    ask_ok(line);
    for (unsigned k = 0; k < 16 && c->lines[k]; k++) {
        snprintf(line, sizeof line, "set block1.%s", c->lines[k]);
        ask_ok(line);
    }
    ask_ok("apply");
}

/* Starts at rest at the plant's own nominal values. */
static inline void rest_case(const struct experiment_case *c, unsigned steps)
{
    char line[60];
    plant_connect();
    plant_steps(2);
    for (unsigned k = 0; k < c->n; k++) {
        snprintf(line, sizeof line, "out l%u %.7g", k + 1,
                 kind->channels[plant_channel_of(c->u[k])].nominal);
        ask_ok(line);
    }
    plant_steps(steps);
}

static inline void begin_case(const struct experiment_case *c, uint64_t seed, unsigned steps)
{
    plant_power_on(c->plant, c->tick_ms, seed, 1);
    configure_case(c);
    rest_case(c, steps);
}

static inline int stage_of(unsigned block)
{
    return (int)value_of(block, "stage");
}

/* Until the experiment is over, or so many steps. Returns the steps. */
static inline unsigned until_over(unsigned block, unsigned most)
{
    unsigned k = 0;
    for (; k < most && stage_of(block) != DONE && stage_of(block) != ABORTED; k += 4)
        plant_steps(4);
    return k;
}

#endif
