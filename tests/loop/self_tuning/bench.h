/* The pilot column with a self-tuner: what its tests do with it. Everything is asked for at the console, and read from there. */
#ifndef REFLUX_TESTS_SELF_TUNING_BENCH_H
#define REFLUX_TESTS_SELF_TUNING_BENCH_H

#include <math.h>

#include "plant_board.h"

#define TICK_S  30.0
#define TICK_MS 30000u

/* Settings of the loops in single.conf and pair.conf. */
#define TUNE_GAIN  0.8
#define TUNE_TI_S  300.0
#define OWN_GAIN   0.6
#define OWN_TI_S   400.0
#define QRB_SPAN   1.5  /* kW */
#define T_SPAN     60.0 /* degC */
#define RESOLUTION 0.01 /* degC, of both sensors, and a little */

enum { TUNING, WAITING, SELF_TUNING_STATE };

/* A number behind " NAME = " in the last reply. */
static inline double number_of(const char *name)
{
    char wanted[40];
    snprintf(wanted, sizeof wanted, "%s = ", name);
    for (unsigned i = 0; i < n_reply; i++) {
        const char *at = strstr(reply[i], wanted);
        if (at && (at == reply[i] || at[-1] == ' '))
            return strtod(at + strlen(wanted), NULL);
    }
    TEST_FAIL_MESSAGE(name);
    return 0;
}

static inline double inside(const char *name)
{
    ask_ok("block 1");
    return number_of(name);
}

static inline double reads(const char *name)
{
    ask_ok("status");
    return number_of(name);
}

static inline bool state_is(unsigned state)
{
    return inside("state") == (double)state;
}

/* In force, as `get` has it. */
static inline double parameter(const char *name)
{
    char line[40];
    snprintf(line, sizeof line, "get %s", name);
    ask_ok(line);
    return number_of(name);
}

static inline void setpoint(const char *loop, double value)
{
    char line[80];
    snprintf(line, sizeof line, "sp %s %.9g", loop, value);
    ask_ok(line);
}

static inline bool alarm_says(const char *text)
{
    ask_ok("alarm");
    return said(text);
}

static double base; /* of T10: where the column has been at rest */

/* Configured, connected, at rest in manual. */
static inline void column_at_rest(const char *conf, double noise)
{
    plant_power_on("pilot", TICK_MS, 1, noise);
    ask_file("../host_sim/scenarios/pilot.conf");
    ask_file(conf);
    plant_connect();
    plant_steps(2);
    ask_ok("out top 4.5");
    ask_ok("out bottom 0.75");
    plant_steps(300);
    base = truly("T10");
    board_forget();
}

static inline void in_auto(void)
{
    ask_ok("mode bottom auto");
    setpoint("bottom", base);
}

/* The setpoint goes up and down by half a degree, every ten minutes. */
static inline void steps_with_a_moving_setpoint(unsigned n)
{
    static unsigned k;
    for (unsigned i = 0; i < n; i++) {
        if (i % 20 == 0)
            setpoint("bottom", base + (k++ % 2 ? 0 : 0.5));
        plant_step();
    }
}

/* Until the law computes, at rest again. */
static inline void tuned_in(const char *conf, double noise)
{
    column_at_rest(conf, noise);
    in_auto();
    for (unsigned k = 0; k < 40 && !state_is(SELF_TUNING_STATE); k++)
        steps_with_a_moving_setpoint(20);
    TEST_ASSERT_TRUE_MESSAGE(state_is(SELF_TUNING_STATE), "it never took over");
    setpoint("bottom", base);
    plant_steps(60);
    board_forget();
}

/* Integral of the absolute error of T10, degC min. */
static inline double deviation_of_steps(unsigned n)
{
    double sum = 0;
    for (unsigned i = 0; i < n; i++) {
        double wanted = i / 20 % 2 ? base : base + 0.5;
        if (i % 20 == 0)
            setpoint("bottom", wanted);
        plant_step();
        sum += fabs(wanted - truly("T10")) * TICK_S / 60;
    }
    return sum;
}

#endif
