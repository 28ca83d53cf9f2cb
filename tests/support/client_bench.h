/* A client of the door (operate/) beside the console, with the wood-berry column on the plant link. */
#ifndef REFLUX_TESTS_CLIENT_BENCH_H
#define REFLUX_TESTS_CLIENT_BENCH_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "operate/operate.h"
#include "plant_side.h"
#include "unity.h"

#define TICK_MS  60000u
#define ENGINEER EVENT_ENGINEER

static struct session client, other;
static struct answer answer;

/* ---- a client's turn ---- */

/* Board, plant and client go on by one sample. */
static inline void client_steps(unsigned n)
{
    while (n--) {
        plant_side_step();
        session_poll(&client);
    }
}

static inline void is_done(enum err err, const char *what)
{
    char message[160];
    snprintf(message, sizeof message, "%s: %s %s", what, err_name(err),
             err && answer.more == ANSWER_PLAIN && answer.words ? answer.words : "");
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, err, message);
}

#define DO(what) is_done(what, #what)

static inline void is_refused(enum err wanted, enum err err, const char *what)
{
    TEST_ASSERT_EQUAL_STRING_MESSAGE(err_name(wanted), err_name(err), what);
}

#define REFUSED(code, what) is_refused(code, what, #what)

static inline struct parameter parameter(const char *name)
{
    struct parameter p = {0};
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, parameter_find(name, &p), name);
    return p;
}

static inline enum err number(struct session *session, const char *name, double value)
{
    struct parameter p = parameter(name);
    return operate_set_number(session, &p, (float)value, &answer);
}

static inline void sets(const char *group, unsigned index, const char *field, double value)
{
    char name[40];
    snprintf(name, sizeof name, "%s%u.%s", group, index, field);
    is_done(number(&client, name, value), name);
}

static inline void names(const char *group, unsigned index, const char *field, const char *value)
{
    char name[40];
    snprintf(name, sizeof name, "%s%u.%s", group, index, field);
    is_done(operate_set(&client, name, value, &answer), name);
}

/* The number a parameter has, in the settings that everything asked now will meet. */
static inline double has(const char *name)
{
    struct parameter p = parameter(name);
    float value;
    is_done(parameter_get_number(&p, operate_settings(&client), &value), name);
    return (double)value;
}

/* The same of loop i. */
static inline double loop_has(unsigned i, const char *field)
{
    char name[40];
    snprintf(name, sizeof name, "loop%u.%s", i + 1u, field);
    return has(name);
}

/* ---- what it is about ---- */

static inline void power_on_wood_berry(void)
{
    plant_side_power_on("wood-berry", TICK_MS);
    session_init(&client, app_door(app_instance()));
    session_init(&other, app_door(app_instance()));
}

/* Every channel as the plant has it, and nothing else. */
static inline void configures(void)
{
    struct plant_side_channel c;
    unsigned n[2] = {0, 0};
    DO(operate_begin(&client, &answer));
    for (unsigned i = 0; plant_side_channel(i, &c); i++) {
        const char *group = c.manipulated ? "mv" : "meas";
        unsigned k = ++n[c.manipulated];
        names(group, k, "name", c.name);
        names(group, k, "unit", c.unit);
        sets(group, k, "lo", c.lo);
        sets(group, k, "hi", c.hi);
        if (!c.manipulated)
            continue;
        sets(group, k, "min", c.lo);
        sets(group, k, "max", c.hi);
        sets(group, k, "safe", c.safe);
    }
    DO(operate_apply(&client, &answer));
}

static inline uint8_t output_named(const char *name)
{
    return config_find_mv(operate_settings(&client), name);
}

/* By hand to where the plant is designed for, and waits there. */
static inline void brings_to_nominal(void)
{
    client_steps(2);
    DO(operate_output(&client, PLAN_NONE, output_named("R"), 1.95f, &answer));
    DO(operate_output(&client, PLAN_NONE, output_named("S"), 1.71f, &answer));
    client_steps(400);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.95, is_commanded("R"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.71, is_commanded("S"));
}

static inline void waits_until(enum commission_phase phase, unsigned ticks)
{
    while (ticks-- && operate_startup_reading(&client).phase != phase)
        client_steps(1);
    struct startup_reading r = operate_startup_reading(&client);
    TEST_ASSERT_EQUAL_INT_MESSAGE(phase, r.phase, commission_reason_text(r.reason));
}

/* The loop that holds a measurement, in force now. */
static inline uint8_t loop_of(const char *measurement, struct loop_reading *reading)
{
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        if (operate_loop(&client, i, reading) && strcmp(reading->pv->name, measurement) == 0)
            return i;
    TEST_FAIL_MESSAGE(measurement);
    return PLAN_NONE;
}

/* The latest action of that kind stands in the history, with this subject, value and level. */
static inline void was_recorded(enum event_code code, const char *subject, double value,
                                uint8_t detail)
{
    const struct event_log *log = &client.door->service->history;
    struct event e;
    for (uint32_t k = log->count; k-- > event_log_oldest(log);) {
        if (!event_log_get(log, k, &e) || e.code != code)
            continue;
        TEST_ASSERT_EQUAL_STRING(subject, e.subject);
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, (float)value, e.value);
        TEST_ASSERT_EQUAL_UINT8(detail, e.detail);
        return;
    }
    TEST_FAIL_MESSAGE(event_name((uint8_t)code));
}

/* A loop in automatic, made by hand. */
static inline void one_loop(void)
{
    power_on_wood_berry();
    configures();
    DO(operate_begin(&client, &answer));
    names("loop", 1, "name", "top");
    names("loop", 1, "pv", "xD");
    names("loop", 1, "out", "R");
    sets("loop", 1, "ti", 1500);
    DO(operate_apply(&client, &answer));
    plant_side_connect();
    brings_to_nominal();
}

#endif
