/* A block of the kind `ahead` on a bench: the end trays of the pilot column by reflux and heat, temperatures of six other stages, the drum's
 * fraction and the feed flow as inputs, and as the plant a column of the same table, carried on in half seconds. */
#ifndef REFLUX_TESTS_AHEAD_BENCH_H
#define REFLUX_TESTS_AHEAD_BENCH_H

#include <math.h>
#include <stdalign.h>
#include <string.h>

#include "base/channel.h"
#include "block_defaults.h"
#include "composition_tables.h"
#include "formats.h"
#include "kinds/ahead/column_ahead_block.h"
#include "kinds/ahead/column_ahead_model.h"
#include "kinds/ahead/column_ahead_parameters.h"
#include "unity.h"

enum { IN_FRACTION = 6, IN_FEED, IN_REFLUX, IN_HEAT, IN_ALL };
enum { TOP, BOTTOM, LOOPS };
#define INTERVAL_S    30.0f
#define LITRE_AN_HOUR (1.0f / 3.6e6f)

static const struct block_kind *const kind = &ahead_kind;
static const unsigned stage_seen[IN_FRACTION] = {1, 3, 4, 6, 8, 10};

static struct column_record record;
static struct ahead_settings settings;
static struct block_setup setup;
static struct block_fault fault;
static alignas(8) char state[8192];
static struct ahead_model plant;
static real_t plant_numbers[400];
static num_t in[LOOPS], out[LOOPS], setpoint[LOOPS], input[BLOCK_INPUTS_MAX];
static uint8_t quality[BLOCK_INPUTS_MAX], clamp[LOOPS], limited[LOOPS];
static float event_value[BLOCK_EVENTS_MAX];
static struct block_io io;
static double mv[LOOPS], mv_lo[LOOPS], mv_hi[LOOPS]; /* EU, in effect, and its limits */
static double added[LOOPS];                          /* EU, by a feedforward */

static inline struct ahead *block(void)
{
    return (struct ahead *)(void *)state;
}

static inline void input_is(unsigned k, enum ahead_input is, unsigned stage, float factor,
                            struct block_signal signal)
{
    settings.role[k] = (uint8_t)is;
    settings.place[k][AHEAD_STAGE] = (uint16_t)stage;
    settings.place[k][AHEAD_COMPONENT] = stage ? 1 : 0;
    settings.si[k][AHEAD_FACTOR] = factor;
    setup.input[k] = signal;
}

static inline void loop_is(unsigned i, unsigned stage, unsigned by)
{
    settings.target[i][AHEAD_STAGE] = (uint16_t)stage;
    settings.moves[i] = (uint16_t)(by + 1u);
    settings.tau_s[i] = 60;
    setup.pv[i] = (struct block_signal){340, 400, false};
    setup.member[i] = (struct block_member){.loop = (uint8_t)i, .drives_mv = true, .out_reach = 1};
}

static inline void bench_pilot(void)
{
    memset(&setup, 0, sizeof setup);
    block_put_defaults(&settings, kind);
    PUT_RECORD(&record, pilot_values);
    setup.settings = &settings;
    setup.named = &record;
    setup.interval_s = INTERVAL_S;
    setup.members = LOOPS;
    setup.present = 3;
    setup.inputs = IN_ALL;
    settings.column = 2;
    for (unsigned k = 0; k < IN_FRACTION; k++)
        input_is(k, AHEAD_TEMPERATURE, stage_seen[k], 1, (struct block_signal){340, 400, false});
    input_is(IN_FRACTION, AHEAD_FRACTION, 12, 1, (struct block_signal){0, 1, false});
    input_is(IN_FEED, AHEAD_FEED, 0, LITRE_AN_HOUR, (struct block_signal){0, 10, false});
    input_is(IN_REFLUX, AHEAD_REFLUX, 0, LITRE_AN_HOUR, (struct block_signal){0, 12, true});
    input_is(IN_HEAT, AHEAD_HEAT, 0, 1000, (struct block_signal){0, 1.5f, true});
    loop_is(TOP, 11, IN_REFLUX);
    loop_is(BOTTOM, 2, IN_HEAT);
    memset(quality, QUALITY_GOOD, sizeof quality);
    memset(clamp, INTEGRAL_FREE, sizeof clamp);
    io = (struct block_io){.members.acting = 3,
                           .members.setpoint = setpoint,
                           .members.in = in,
                           .members.out = out,
                           .members.clamp = clamp,
                           .members.limited = limited,
                           .inputs.value = input,
                           .inputs.quality = quality,
                           .requests.event_value = event_value,
                           .members.divisor = 1};
    mv[TOP] = 2.6;
    mv[BOTTOM] = 0.65;
    mv_lo[TOP] = 1;
    mv_hi[TOP] = 9;
    mv_lo[BOTTOM] = 0.4;
    mv_hi[BOTTOM] = 1.25;
    memset(added, 0, sizeof added);
}

static inline void accepted(void)
{
    enum err err = kind->check(&setup, &fault);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, err, fault.wanted);
    TEST_ASSERT_TRUE(kind->bytes(&setup) <= sizeof state);
}

static inline double fraction_of(const struct block_signal *s, double eu)
{
    return (eu - (double)s->lo) / ((double)s->hi - (double)s->lo);
}

static inline void drive_plant(void)
{
    column_drive_take(&plant.table, &plant.inputs, DRIVE_REFLUX,
                      (real_t)mv[TOP] * (real_t)LITRE_AN_HOUR);
    column_drive_take(&plant.table, &plant.inputs, DRIVE_HEAT, (real_t)mv[BOTTOM] * REAL_C(1000.0));
}

static inline double plant_temperature(unsigned stage)
{
    return (double)plant.column.temperature[stage - 1];
}

static inline void plant_runs(double seconds)
{
    plant.h = REAL_C(0.5);
    plant.parts = (uint16_t)(2 * seconds);
    drive_plant();
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_carry(&plant, &plant.inputs));
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_look(&plant, plant.x));
}

static inline void see_mvs(void)
{
    input[IN_REFLUX] = N(fraction_of(&setup.input[IN_REFLUX], mv[TOP]));
    input[IN_HEAT] = N(fraction_of(&setup.input[IN_HEAT], mv[BOTTOM]));
}

static inline void measure(void)
{
    for (unsigned k = 0; k < IN_FRACTION; k++)
        input[k] = N(fraction_of(&setup.input[k], plant_temperature(stage_seen[k])));
    input[IN_FRACTION] = N((double)plant.x[11]);
    input[IN_FEED] = N((double)plant.inputs.feed_flow / (double)LITRE_AN_HOUR / 10);
    see_mvs();
    in[TOP] = N(fraction_of(&setup.pv[TOP], plant_temperature(11)));
    in[BOTTOM] = N(fraction_of(&setup.pv[BOTTOM], plant_temperature(2)));
}

static inline void ask_for(double top, double bottom) /* K */
{
    setpoint[TOP] = N(fraction_of(&setup.pv[TOP], top));
    setpoint[BOTTOM] = N(fraction_of(&setup.pv[BOTTOM], bottom));
}

static inline void configure(bool retune)
{
    accepted();
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(state, &setup, retune));
}

/* The outputs that would leave the MVs where they are. */
static inline void outputs_in_effect(void)
{
    out[TOP] = N(fraction_of(&setup.input[IN_REFLUX], mv[TOP] - added[TOP]));
    out[BOTTOM] = N(fraction_of(&setup.input[IN_HEAT], mv[BOTTOM] - added[BOTTOM]));
}

static inline void follow(void)
{
    measure();
    outputs_in_effect();
    kind->follow(state, &io);
}

/* The plant at rest, the block told. */
static inline void begin(void)
{
    configure(false);
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_begin(&plant, &record, plant_numbers));
    plant_runs(4 * 3600.0);
    measure();
    setpoint[TOP] = in[TOP];
    setpoint[BOTTOM] = in[BOTTOM];
    follow();
}

/* Applies the outputs of loops that act, within the limits, and tells the block what took effect. */
static inline void apply(void)
{
    const struct block_signal *signal[LOOPS] = {&setup.input[IN_REFLUX], &setup.input[IN_HEAT]};
    for (unsigned i = 0; i < LOOPS; i++) {
        if (!(io.members.acting & (1u << i)))
            continue;
        double span = (double)signal[i]->hi;
        double asked = D(out[i]) * span + added[i];
        mv[i] = fmax(mv_lo[i], fmin(mv_hi[i], asked));
        if (mv[i] < asked || mv[i] > asked)
            out[i] = N((mv[i] - added[i]) / span);
    }
    see_mvs();
    kind->back_calculate(state, &io);
}

static inline void tick(void)
{
    io.requests.raised = 0;
    io.requests.gives_up = NULL;
    measure();
    kind->step(state, &io);
    TEST_ASSERT_NULL_MESSAGE(io.requests.gives_up, io.requests.gives_up);
    apply();
    plant_runs((double)INTERVAL_S);
    measure();
}

static inline void ticks(unsigned n)
{
    while (n-- > 0)
        tick();
}

static inline double at_top(void)
{
    return plant_temperature(11);
}

static inline double at_bottom(void)
{
    return plant_temperature(2);
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

#endif
