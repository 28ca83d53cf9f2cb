/* A block of the kind `state_law` on a bench: the end trays of the pilot column by reflux and heat, as host_sim/scenarios/pilot-state.conf has
 * them, and what tests/reference/state_law_reference.py says of it. */
#ifndef REFLUX_TESTS_STATE_LAW_BENCH_H
#define REFLUX_TESTS_STATE_LAW_BENCH_H

#include <math.h>
#include <stdalign.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/channel.h"
#include "base/workspace.h"
#include "block_defaults.h"
#include "composition_tables.h"
#include "kinds/state_law/state_law.h"
#include "kinds/state_law/state_law_block.h"
#include "kinds/state_law/state_law_column.h"
#include "kinds/state_law/state_law_column_state.h"
#include "law/state_law_job.h"
#include "unity.h"

#define PERIOD_S      30.0f
#define LITRE_AN_HOUR (1.0f / 3.6e6f)

static const struct block_kind *const kind = &state_law_kind;

static struct column_record record;
static struct state_law_settings settings;
static struct block_setup setup;
static struct block_fault fault;
static alignas(8) char state[2048];
static alignas(8) char memory[WORKSPACE_BYTES];
static struct workspace workspace;
static struct block_proposal proposal;
static float event_value[BLOCK_EVENTS_MAX];
static struct block_io io;
static unsigned input_at;
static bool job_asked;
static unsigned pieces;

static inline struct state_law_block *block(void)
{
    return (struct state_law_block *)(void *)state;
}

static inline void input_is(enum state_law_input is, unsigned stage, float si,
                            struct block_signal signal)
{
    unsigned k = input_at++;
    settings.role[k] = (uint8_t)is;
    settings.place[k][STATE_LAW_STAGE] = (uint16_t)stage;
    settings.place[k][STATE_LAW_COMPONENT] =
        is == STATE_LAW_FRACTION || is == STATE_LAW_FEED_FRACTION ? 1 : 0;
    settings.si[k] = si;
    setup.input[k] = signal;
    setup.inputs = (uint8_t)input_at;
}

static inline void temperature_is(unsigned stage)
{
    input_is(STATE_LAW_TEMPERATURE, stage, 0, (struct block_signal){70, 130, false});
}

static inline void product_is(unsigned stage)
{
    input_is(STATE_LAW_FRACTION, stage, 0.01f, (struct block_signal){0, 100, false});
}

static inline void mvs_are(void)
{
    input_is(STATE_LAW_REFLUX, 0, LITRE_AN_HOUR, (struct block_signal){0, 12, true});
    input_is(STATE_LAW_HEAT, 0, 1000, (struct block_signal){0, 1.5f, true});
}

/* T1, T10, xD, T2, xB, T3. */
static inline void six_states(void)
{
    temperature_is(11);
    temperature_is(2);
    product_is(12);
    temperature_is(10);
    product_is(1);
    temperature_is(9);
}

static inline void no_inputs(void)
{
    memset(&settings.role, 0, sizeof settings.role);
    memset(&settings.place, 0, sizeof settings.place);
    memset(&settings.si, 0, sizeof settings.si);
    memset(setup.input, 0, sizeof setup.input);
    input_at = 0;
}

/* and T4, T8 */
static inline void by_temperatures(void)
{
    no_inputs();
    six_states();
    temperature_is(8);
    temperature_is(4);
    mvs_are();
    settings.left = 2;
}

/* and the feed's flow and composition, by mole */
static inline void by_feed(void)
{
    no_inputs();
    six_states();
    input_is(STATE_LAW_FEED, 0, LITRE_AN_HOUR, (struct block_signal){0, 10, false});
    input_is(STATE_LAW_FEED_FRACTION, 0, 0, (struct block_signal){0, 1, false});
    mvs_are();
    settings.left = 3;
}

static inline void bench_pilot(void)
{
    memset(&setup, 0, sizeof setup);
    block_put_defaults(&settings, kind);
    PUT_RECORD(&record, pilot_values);
    setup.settings = &settings;
    setup.named = &record;
    setup.interval_s = PERIOD_S;
    settings.column = 2;
    settings.period_s = PERIOD_S;
    settings.basis = STATE_LAW_MASS;
    settings.tau_s[0] = settings.tau_s[1] = 100.0f / 3;
    settings.ti_s[0] = settings.ti_s[1] = 600;
    by_temperatures();
    workspace_init(&workspace, memory, sizeof memory);
    workspace_share(&workspace);
    io = (struct block_io){.requests.event_value = event_value, .members.divisor = 1};
    job_asked = false;
    pieces = 0;
}

static inline enum err check(void)
{
    return kind->check(&setup, &fault);
}

static inline void configure(bool retune)
{
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, check(), fault.wanted);
    TEST_ASSERT_TRUE(kind->bytes(&setup) <= sizeof state);
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(state, &setup, retune));
}

static inline const char *tell(const char *verb)
{
    for (unsigned v = 0; v < kind->verbs; v++)
        if (strcmp(kind->verb[v].name, verb) == 0)
            return kind->verb[v].run(state, NULL);
    TEST_FAIL_MESSAGE(verb);
    return NULL;
}

/* A tick, and the main loop after it until the work is done. room: for a proposal. */
static inline void step(bool room)
{
    io.requests.work_done = job_asked;
    io.requests.ask_work = 0;
    io.requests.raised = 0;
    memset(&proposal, 0, sizeof proposal);
    io.requests.proposal = room ? &proposal : NULL;
    kind->step(state, &io);
    workspace_tick(&workspace);
    job_asked = io.requests.ask_work > 0;
    while (job_asked && kind->work(state))
        pieces++;
}

/* To the end of the design. */
static inline void design(void)
{
    TEST_ASSERT_NULL(tell("design"));
    for (unsigned k = 0; k < 6; k++)
        step(false);
    TEST_ASSERT_TRUE(block()->stage == STATE_LAW_DONE || block()->stage == STATE_LAW_REFUSED);
    TEST_ASSERT_NULL(block()->job);
}

/* The name of the first value that is shown. */
static inline const char *told(void)
{
    float value;
    return kind->describe(state, 0, &value);
}

static inline float shown(const char *name)
{
    float value = NAN;
    const char *found;
    for (size_t i = 0; (found = kind->describe(state, i, &value)) != NULL; i++)
        if (strcmp(found, name) == 0)
            return value;
    TEST_FAIL_MESSAGE(name);
    return NAN;
}

/* Row of the reference. */
static inline void reference(const char *what, unsigned row, double *values, unsigned n)
{
    char line[1000], wanted[40];
    FILE *f = fopen("reference/state_law.csv", "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(f, "tests run in the folder tests/");
    snprintf(wanted, sizeof wanted, "%s,%u,", what, row);
    while (fgets(line, sizeof line, f))
        if (strncmp(line, wanted, strlen(wanted)) == 0) {
            char *at = line + strlen(wanted);
            for (unsigned k = 0; k < n; k++, at++) {
                char *end;
                values[k] = strtod(at, &end);
                TEST_ASSERT_TRUE(end != at);
                at = end;
            }
            fclose(f);
            return;
        }
    TEST_FAIL_MESSAGE(wanted);
}

#endif
