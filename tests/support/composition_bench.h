/* A block of the kind `composition` on a bench: two temperatures that move the model, one that is compared, three flows,
 * two fractions and a temperature as points, and a column of the same table as the plant. */
#ifndef REFLUX_TESTS_COMPOSITION_BENCH_H
#define REFLUX_TESTS_COMPOSITION_BENCH_H

#include <math.h>

#include "base/channel.h"
#include "block_defaults.h"
#include "composition_tables.h"
#include "composition_whole.h"
#include "kinds/composition/composition_parameters.h"
#include "unity.h"

/* Inputs and points. */
enum { T_LOW, T_HIGH, T_COMPARED, FEED, HEAT, REFLUX, FURTHER };
enum { TOP_FRACTION, BOTTOM_FRACTION, INNER_TEMPERATURE };

static const struct block_kind *const kind = &composition_kind;

static struct column_record record;
static struct composition_record all_settings;
static struct block_setup setup;
static struct block_fault fault;
static struct composition_block block, plant;
static num_t input[BLOCK_INPUTS_MAX], point[BLOCK_POINTS_MAX];
static uint8_t quality[BLOCK_INPUTS_MAX], point_quality[BLOCK_POINTS_MAX];
static float event_value[BLOCK_EVENTS_MAX];
static struct block_io io;

static inline void temperature_at(unsigned k, unsigned stage, unsigned component)
{
    all_settings.s.role[k] = IS_TEMPERATURE;
    all_settings.s.place[k][AT_STAGE] = (uint16_t)stage;
    all_settings.s.place[k][OF_COMPONENT] = (uint16_t)component;
    setup.input[k] = (struct block_signal){300, 400, false};
}

static inline void point_of(unsigned k, unsigned stage, unsigned component)
{
    all_settings.s.point[k][AT_STAGE] = (uint16_t)stage;
    all_settings.s.point[k][OF_COMPONENT] = (uint16_t)component;
    setup.point[k] =
        component ? (struct block_signal){0, 1, false} : (struct block_signal){300, 400, false};
}

/* Litres in an hour. */
static inline void flow_at(unsigned k, enum composition_input is)
{
    all_settings.s.role[k] = (uint8_t)is;
    all_settings.s.si[k][UNIT_FACTOR] = 1.0f / 3.6e6f;
    setup.input[k] = (struct block_signal){0, 20, false};
}

static inline void put(unsigned k, float eu)
{
    const struct block_signal *s = &setup.input[k];
    input[k] = num_from_float((eu - s->lo) / (s->hi - s->lo));
}

static inline float given(unsigned k)
{
    return setup.point[k].lo + (setup.point[k].hi - setup.point[k].lo) * num_to_float(point[k]);
}

static inline void bench_pilot(void)
{
    memset(&setup, 0, sizeof setup);
    block_put_defaults(&all_settings, &composition_kind);
    PUT_RECORD(&record, pilot_values);
    setup.settings = &all_settings;
    setup.named = &record;
    setup.interval_s = 10;
    setup.inputs = FURTHER;
    setup.points = 3;
    all_settings.s.column = 2;
    temperature_at(T_LOW, 3, 1);
    temperature_at(T_HIGH, 10, 1);
    temperature_at(T_COMPARED, 7, 0);
    flow_at(FEED, IS_FEED);
    all_settings.s.role[HEAT] = IS_HEAT;
    setup.input[HEAT] = (struct block_signal){0, 2000, true};
    flow_at(REFLUX, IS_REFLUX);
    point_of(TOP_FRACTION, 12, 1);
    point_of(BOTTOM_FRACTION, 1, 1);
    point_of(INNER_TEMPERATURE, 7, 0);
    io = (struct block_io){.inputs.value = input,
                           .inputs.quality = quality,
                           .points.value = point,
                           .points.quality = point_quality,
                           .requests.event_value = event_value};
    memset(quality, QUALITY_GOOD, sizeof quality);
    put(FEED, 5);
    put(HEAT, 800); /* 150 W of it are lost */
    put(REFLUX, 4.5f);
}

static inline void accepted(void)
{
    enum err err = kind->check(&setup, &fault);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, err, fault.wanted);
}

/* Mole fractions on the plant's stages. */
static inline float truth(unsigned stage)
{
    return (float)plant.model.column.temperature[stage - 1];
}

static inline void plant_temperatures(void)
{
    struct column_fault why;
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&plant.model.column, &plant.model.inputs, &why));
    TEST_ASSERT_EQUAL(ERR_OK, column_truncated_rates(&plant.model.column, plant.model.truncated,
                                                     COLUMN_BETWEEN_LINE, plant.model.x,
                                                     plant.model.rates));
}

static inline void measure(void)
{
    plant_temperatures();
    for (unsigned k = 0; k < setup.inputs; k++)
        if (all_settings.s.role[k] == IS_TEMPERATURE)
            put(k, truth(all_settings.s.place[k][AT_STAGE]));
}

static inline void step(void)
{
    io.requests.raised = 0xFFFF;
    io.requests.ask_work = 0;
    kind->step(&block, &io);
}

static inline void steps(unsigned n)
{
    while (n-- > 0)
        step();
}

/* Configured, the plant at the profile of the table, its temperatures measured; the first tick is over. */
static inline void begin(void)
{
    accepted();
    TEST_ASSERT_TRUE(kind->bytes(&setup) >= sizeof block);
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(&block, &setup, false));
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(&plant, &setup, false));
    measure();
    kind->follow(&block, &io);
    step();
}

/* The plant goes on for so long. */
static inline void plant_runs(unsigned n)
{
    while (n-- > 0)
        TEST_ASSERT_EQUAL(ERR_OK, composition_model_predict(&plant.model));
    measure();
}

static inline float shown(const char *name)
{
    float value = NAN;
    const char *found;
    for (size_t i = 0; (found = kind->describe(&block, i, &value)) != NULL; i++)
        if (strcmp(found, name) == 0)
            return value;
    TEST_FAIL_MESSAGE(name);
    return NAN;
}

static inline bool raised(unsigned event)
{
    return ((unsigned)io.requests.raised >> event & 1u) != 0;
}

/* Steps until it has locked on, until its gate has begun, and until its monitor has. */
#define LOCKED  108u
#define GATED   (LOCKED + 36u)
#define WATCHES (LOCKED + 179u)

#endif
