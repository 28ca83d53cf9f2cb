/* The kind `ff_tune` on a loop of tests/loop/feedforward/unlike.json: processes and disturbance paths of other kinds than Siddha's. */
#ifndef REFLUX_TESTS_UNLIKE_BENCH_H
#define REFLUX_TESTS_UNLIKE_BENCH_H

#include "tune_bench.h"

/* PROMISES_TOO_MUCH: but does no harm. */
enum expected { ACTS, PROMISES_TOO_MUCH, DOES_NO_HARM };

struct situation {
    const char *name;
    int process, path; /* of unlike.json */
    const char *gain, *ti;
    unsigned d_period, scale; /* scale: s of a tick */
    enum expected expected;
    const char *more[5];
};

static const struct situation usual = {"as Siddha's", 1, 1, "0.65", "13.2", 300, 1, ACTS, {0}};

static inline void set_to(const char *what, const char *value)
{
    char line[80];
    snprintf(line, sizeof line, "set %s %s", what, value);
    ask_ok(line);
}

static inline void begin_unlike(const struct situation *c, unsigned method)
{
    bool direct = c->gain[0] == '-';
    char tick[12];
    course.size = 1;
    course.period = c->d_period;
    course.quiet = false;
    snprintf(tick, sizeof tick, "%u", c->scale);
    plant_power_on(FEEDFORWARD "/unlike.json", 1000 * c->scale, 7, 1);
    ask_file(FEEDFORWARD "/unlike.conf");
    set_parameter("process", c->process);
    set_parameter("path", c->path);
    ask_ok("begin");
    set_to("tick.base", tick);
    set_to("loop1.action", direct ? "direct" : "reverse");
    set_to("loop1.gain", c->gain + direct);
    set_to("loop1.ti", c->ti);
    set_to("block1.gain", c->gain);
    set_to("block1.ti", c->ti);
    set_to("block1.method", methods[method]);
    for (unsigned k = 0; k < 5 && c->more[k]; k++)
        ask_ok(c->more[k]);
    ask_ok("apply");
    plant_connect();
    plant_steps(2);
    ask_ok("mode one auto");
    tune_seconds(1200);
}

static inline void settle(const char *const *lines)
{
    ask_ok("begin");
    for (; *lines; lines++)
        ask_ok(*lines);
    ask_ok("apply");
}

/* Until `tune` has come to its end, or waits; the disturbance rests while a loop is identified by its setpoint. */
static inline void tune_whole(unsigned method)
{
    tune_stages(method != 0, 1u << RUNS | 1u << PROPOSES, 20);
    course.quiet = false;
}

static inline bool gain_is_off(const char *element)
{
    char line[40];
    snprintf(line, sizeof line, "get %s.gain", element);
    ask_ok(line);
    snprintf(line, sizeof line, "%s.gain = 0 ", element);
    return said(line);
}

#endif
