/* One plant of the library under test, its channels by name. Failures of the plant fail the test. */
#ifndef REFLUX_TESTS_PLANT_BENCH_H
#define REFLUX_TESTS_PLANT_BENCH_H

#include <string.h>

#include "plants/plant_library.h"
#include "unity.h"

static const struct plant_class *kind;
static struct plant *plant;
static char err[256];

static inline void bench_open(const char *name)
{
    kind = plant_open(name, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(kind, err);
    plant = plant_create(kind, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(plant, err);
}

static inline void bench_close(void)
{
    kind->destroy(plant);
    plant_library_free();
}

static inline size_t channel(const char *name)
{
    for (size_t i = 0; i < kind->n_channels; i++)
        if (strcmp(kind->channels[i].name, name) == 0)
            return i;
    TEST_FAIL_MESSAGE(name);
    return 0;
}

static inline double get(const char *name)
{
    return kind->value(plant, channel(name));
}

static inline void set(const char *name, double value)
{
    TEST_ASSERT_TRUE_MESSAGE(kind->set_input(plant, channel(name), value, err, sizeof err), err);
}

static inline void run_to(double t)
{
    TEST_ASSERT_TRUE_MESSAGE(kind->advance(plant, t, err, sizeof err), err);
}

static inline void settle(void)
{
    TEST_ASSERT_TRUE_MESSAGE(kind->settle(plant, err, sizeof err), err);
}

#endif
