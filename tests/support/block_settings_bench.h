/* Settings of blocks by name, with kinds that only the tests have; each test begins with defaults and erased flash. */
#ifndef REFLUX_TESTS_BLOCK_SETTINGS_BENCH_H
#define REFLUX_TESTS_BLOCK_SETTINGS_BENCH_H

#include "made_up_kinds.h"
#include "storage_images.h"

static struct config config;

void setUp(void)
{
    flash_model_keep = NULL;
    memory_port_erase_all();
    parameters_defaults(&config);
}

void tearDown(void) {}

static inline void set(const char *name, const char *value)
{
    bench_set(&config, name, value);
}

static inline enum err try_set(const char *name, const char *value)
{
    struct parameter p;
    enum err err = parameter_find_in(&config, name, &p);
    return err ? err : parameter_set(&p, &config, value);
}

static inline const char *value_of(const struct config *c, const char *name)
{
    static char text[200];
    struct parameter p;
    struct text t = text_on(text, sizeof text);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_find_in(c, name, &p), name);
    parameter_value(&p, c, &t);
    return text;
}

#define IS(c, name, value) TEST_ASSERT_EQUAL_STRING_MESSAGE(value, value_of(c, name), name)

#endif
