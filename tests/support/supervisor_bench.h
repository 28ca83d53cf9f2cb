/* A supervisor with a small configuration and hand-made samples: two temperatures by reflux and heat, a feed
 * flow, a third measurement and a cascade where a test asks for it. Readings keep their value until changed. */
#ifndef REFLUX_TESTS_SUPERVISOR_BENCH_H
#define REFLUX_TESTS_SUPERVISOR_BENCH_H

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats.h"
#include "plan/plan_build.h"
#include "settings/parameters.h"
#include "supervise/supervisor.h"
#include "unity.h"

/* Indices of the channels and loops below. */
enum { T1, T10, FEED, T5 };
enum { REFLUX, HEAT, SPARE };
enum { TOP, BOTTOM, OUTER, OUTEST };

struct bench {
    struct config config;
    struct plan plan[2];
    unsigned current;
    struct supervisor s;
    struct event_queue events;
    struct event seen[200]; /* all events since bench_start or bench_forget_events */
    unsigned n_seen;
    struct tick_input input;
    uint32_t tick_ms;
};

static struct bench bench;

static inline void put(const char *name, const char *value)
{
    struct parameter p;
    char message[120];
    snprintf(message, sizeof message, "set %s %s", name, value);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_find(name, &p), message);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_set(&p, &bench.config, value), message);
}

/* "name value" pairs, NULL at the end. */
static inline void put_all(const char *const *pairs)
{
    for (; *pairs; pairs += 2)
        put(pairs[0], pairs[1]);
}

/* The configuration every test starts from. */
static inline void bench_config(void)
{
    static const char *const pairs[] = {"meas1.name", "T1",         "meas1.unit",
                                        "degC",       "meas1.lo",   "60",
                                        "meas1.hi",   "160",        "meas2.name",
                                        "T10",        "meas2.unit", "degC",
                                        "meas2.lo",   "60",         "meas2.hi",
                                        "160",        "meas3.name", "feed",
                                        "meas3.unit", "l/h",        "meas3.hi",
                                        "10",         "meas4.name", "T5",
                                        "meas4.unit", "degC",       "meas4.lo",
                                        "60",         "meas4.hi",   "160",
                                        "meas1.hold", "10",         "meas2.hold",
                                        "10",         "mv1.name",   "reflux",
                                        "mv1.unit",   "l/h",        "mv1.hi",
                                        "10",         "mv1.max",    "10",
                                        "mv2.name",   "heat",       "mv2.unit",
                                        "kW",         "mv2.hi",     "2",
                                        "mv2.max",    "2",          "mv3.name",
                                        "spare",      "loop1.name", "top",
                                        "loop1.pv",   "T1",         "loop1.out",
                                        "reflux",     "loop1.gain", "2",
                                        "loop1.ti",   "200",        "loop1.action",
                                        "direct",     "loop2.name", "bottom",
                                        "loop2.pv",   "T10",        "loop2.out",
                                        "heat",       "loop2.gain", "1.5",
                                        "loop2.ti",   "300",        NULL};
    parameters_defaults(&bench.config);
    put_all(pairs);
}

/* Two more loops above bottom: outer (T5) drives bottom, outest (feed) drives outer. */
static inline void bench_cascade(void)
{
    static const char *const pairs[] = {
        "loop3.name", "outer",    "loop3.pv",   "T5",         "loop3.out", "bottom",   "loop3.gain",
        "0.8",        "loop3.ti", "400",        "loop4.name", "outest",    "loop4.pv", "feed",
        "loop4.out",  "outer",    "loop4.gain", "0.5",        "loop4.ti",  "900",      NULL};
    put_all(pairs);
}

static inline void bench_events(void)
{
    struct event_queue *q = &bench.events;
    while (spsc_can_read(&q->index)) {
        TEST_ASSERT_TRUE(bench.n_seen < sizeof bench.seen / sizeof bench.seen[0]);
        bench.seen[bench.n_seen++] = q->slot[spsc_read_index(&q->index)];
        spsc_read_done(&q->index);
    }
}

static inline void bench_forget_events(void)
{
    bench_events();
    bench.n_seen = 0;
}

/* Counts this event; subject NULL: of any subject. */
static inline unsigned happened(enum event_code code, const char *subject)
{
    unsigned n = 0;
    bench_events();
    for (unsigned i = 0; i < bench.n_seen; i++)
        if (bench.seen[i].code == code && (!subject || !strcmp(bench.seen[i].subject, subject)))
            n++;
    return n;
}

/* Puts bench.config into force. */
static inline void apply(void)
{
    struct config_fault fault;
    struct plan *next = &bench.plan[1 - bench.current];
    uint32_t serial = bench.plan[bench.current].serial;
    if (plan_build(next, &bench.config, (float)bench.tick_ms / 1000.0f, &fault) != ERR_OK) {
        char text[160];
        snprintf(text, sizeof text, "refused: %s%u.%s '%s' %s", fault.group, fault.index,
                 fault.field, fault.subject, fault.wanted);
        TEST_FAIL_MESSAGE(text);
    }
    bench.current = 1 - bench.current;
    next->serial = serial + 1;
    supervisor_take_plan(&bench.s, next);
    supervisor_tell_plan(&bench.s);
    for (uint8_t i = 0; i < CHANNEL_MAX; i++) {
        if (bench.config.measurement[i].name[0])
            supervisor_bind_measurement(&bench.s, i);
        if (bench.config.mv[i].name[0])
            supervisor_bind_mv(&bench.s, i);
    }
}

static inline void set_and_apply(const char *name, const char *value)
{
    put(name, value);
    apply();
}

static inline void reading(unsigned i, double value)
{
    bench.input.measurement[i] = (struct reading){(float)value, QUALITY_GOOD};
}

static inline void bad_reading(unsigned i, enum quality quality, double value)
{
    bench.input.measurement[i] = (struct reading){(float)value, quality};
}

static inline void validate(void)
{
    bench.input.time_ms += bench.tick_ms;
    supervisor_validate(&bench.s, &bench.input);
}

static inline void tick(void)
{
    validate();
    supervisor_control(&bench.s);
    bench_events();
}

static inline void ticks(unsigned n)
{
    while (n--)
        tick();
}

static inline void request(enum request_kind kind, uint8_t loop, uint8_t output, uint8_t mode,
                           double value)
{
    struct request r = {.kind = kind,
                        .loop = loop,
                        .output = output,
                        .mode = mode,
                        .plan = bench.s.plan->serial,
                        .value = (float)value};
    supervisor_request(&bench.s, &r);
    bench_events();
}

static inline void mode(uint8_t loop, enum loop_mode m)
{
    request(REQUEST_MODE, loop, PLAN_NONE, (uint8_t)m, 0);
}

static inline void setpoint(uint8_t loop, double value)
{
    request(REQUEST_SETPOINT, loop, PLAN_NONE, 0, value);
}

/* Manual output of a loop, EU of what it drives. */
static inline void out(uint8_t loop, double value)
{
    request(REQUEST_OUTPUT, loop, PLAN_NONE, 0, value);
}

static inline double sent(unsigned output)
{
    return D(bench.s.mv[output].constrained);
}

static inline double setpoint_of(unsigned loop)
{
    return D(bench.s.loop[loop].setpoint);
}

/* Configuration in force, plausible readings, loops in manual at half output. */
static inline void bench_start_with(void (*more)(void))
{
    memset(&bench, 0, sizeof bench);
    bench.tick_ms = 1000;
    bench_config();
    if (more)
        more();
    event_queue_init(&bench.events);
    supervisor_init(&bench.s, &bench.events);
    apply();
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        bench.input.measurement[i].quality = QUALITY_MISSING;
        bench.input.readback[i].quality = QUALITY_MISSING;
    }
    reading(T1, 85);
    reading(T10, 115);
    reading(FEED, 5);
    reading(T5, 100);
    tick();
    out(TOP, 5);
    out(BOTTOM, 1);
    ticks(3);
    bench_forget_events();
}

static inline void bench_start(void)
{
    bench_start_with(NULL);
}

/* Bumpless: below a millionth of span in float, a few steps of Q7.24 in fixed. */
#define BUMP BY_FORMAT(1e-6, 8.0 / 16777216.0)

#define ASSERT_NO_BUMP(before, after) TEST_ASSERT_DOUBLE_WITHIN(BUMP, before, after)

#endif
