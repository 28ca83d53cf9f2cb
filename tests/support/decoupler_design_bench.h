/* A 2 x 2 plant of tests/loop/decoupling/unlike-lags.json with an `experiment` block, a model in its settings, and the blocks that
 * `design` computes settings for. */
#ifndef REFLUX_TESTS_DECOUPLER_DESIGN_BENCH_H
#define REFLUX_TESTS_DECOUPLER_DESIGN_BENCH_H

#include "experiment_plant.h"

/* Control every 120 s, at any base tick. */
static struct experiment_case unlike_lags = {DECOUPLING "/unlike-lags.json",
                                             120000,
                                             2,
                                             {"y1", "y2"},
                                             {"u1", "u2"},
                                             {"period 120", "adopt at_once", "bits 7", "clock 4",
                                              "amplitude.1 1", "amplitude.2 1", "band.1 0.8",
                                              "band.2 1.2"}};

#define DECOUPLER 2
#define FIRST_RST 3
#define SETTLING  3600

static const char *const no_blocks[] = {NULL};

static inline void set_line(const char *format, unsigned i, unsigned j)
{
    char line[120];
    snprintf(line, sizeof line, format, i, j);
    ask_ok(line);
}

/* Blocks for what is designed, with coefficients that only hold their places, and lines that are special to the case. */
static inline void add_blocks(unsigned divisor, const char *const *more)
{
    ask_ok("begin");
    ask_ok("set block2.kind polynomial");
    ask_ok("set block2.loops l1,l2");
    ask_ok("set block2.g.1 1,0,0,0,0,0,0,0");
    ask_ok("set block2.g.4 1,0,0,0,0,0,0,0");
    for (unsigned k = 1; k <= 2; k++) {
        set_line("set loop%u.divisor %u", k, divisor);
        set_line("set block%u.kind rst", FIRST_RST - 1 + k, 0);
        set_line("set block%u.loops l%u", FIRST_RST - 1 + k, k);
        set_line("set block%u.period %u", FIRST_RST - 1 + k, divisor * unlike_lags.tick_ms / 1000);
        set_line("set block%u.q.1 1,0,0,0,0,0,0,0", FIRST_RST - 1 + k, 0);
        set_line("set block%u.r.1 1,0,0,0,0,0,0,0", FIRST_RST - 1 + k, 0);
        set_line("set block1.place.%u %u", k, FIRST_RST - 1 + k);
        set_line("set block1.settling.%u %u", k, SETTLING);
    }
    ask_ok("set block1.law 2");
    for (; *more; more++)
        ask_ok(*more);
    ask_ok("apply");
    plant_steps(2);
}

/* A model as if it had been found, and the blocks. What it lacks is 0. */
static inline void begin_with_model(const char *adopt, const char *const *more)
{
    static const char *const model[] = {"set block1.a1_1 -0.85",  "set block1.a2_1 -0.91",
                                        "set block1.b11_1 0.024", "set block1.b12_1 -0.009",
                                        "set block1.b21_1 0.018", "set block1.b22_1 -0.02"};
    unlike_lags.tick_ms = 60000;
    begin_case(&unlike_lags, 1, 20);
    for (unsigned k = 0; k < sizeof model / sizeof model[0]; k++)
        ask_ok(model[k]);
    ask_ok("set block1.known on");
    ask_ok(adopt);
    plant_steps(2);
    add_blocks(2, more);
}

static inline void design(void)
{
    ask_ok("block 1 design");
    plant_steps(20);
}

static inline double nth_of_row(const char *row, unsigned n)
{
    char line[40];
    snprintf(line, sizeof line, "get %s", row);
    ask_ok(line);
    const char *at = strchr(board.said, '=');
    TEST_ASSERT_NOT_NULL(at);
    for (at++; n > 0; n--)
        at = strchr(at, ',') + 1;
    return strtod(at, NULL);
}

#endif
