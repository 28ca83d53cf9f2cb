/* Storage and what it needs of the firmware, on the flash of the board in memory: no console, no plant, no tick.
 * A start is a function call, so that very many can be tried. */
#ifndef REFLUX_TESTS_STORAGE_BENCH_H
#define REFLUX_TESTS_STORAGE_BENCH_H

#include <stdio.h>
#include <string.h>

#include "flash_model.h"
#include "hal/nvm.h"
#include "memory_port.h"
#include "settings/parameters.h"
#include "storage/storage.h"
#include "unity.h"

static struct firmware {
    struct supervisor supervisor;
    struct plant_link link;
    struct service service;
    struct storage storage;
} fw, fresh; /* the firmware's memory, now and just after a start */

static unsigned seen[EVENT_COUNT]; /* events since the last start */
static char last_subject[EVENT_COUNT][CHANNEL_NAME_SIZE];
static float last_value[EVENT_COUNT];
static enum err save_result;
static const char *save_why;

/* The tick, as far as storage sees it: nothing but plans is asked for. */
static inline void bench_tick(void)
{
    while (spsc_can_read(&fw.service.requests.index)) {
        spsc_read_done(&fw.service.requests.index);
        service_take_pending(&fw.service);
    }
}

static inline void bench_activate(void *context)
{
    (void)context;
    bench_tick();
}

static inline void bench_events(void)
{
    struct event e;
    while (service_next_event(&fw.service, &e)) {
        seen[e.code]++;
        memcpy(last_subject[e.code], e.subject, sizeof e.subject);
        last_value[e.code] = e.value;
    }
}

static inline void bench_work(void)
{
    for (unsigned turns = 0; storage_poll(&fw.storage); turns++)
        TEST_ASSERT_TRUE_MESSAGE(turns < 100000, "storage never came to rest");
}

static inline void bench_init(void)
{
    memset(&fw, 0, sizeof fw);
    service_init(&fw.service, &fw.supervisor, &fw.link);
    supervisor_init(&fw.supervisor, &fw.service.tick_events);
    plant_link_init(&fw.link, &fw.service.tick_events, &fw.supervisor.time_ms);
    fw.service.io = plant_link_port(&fw.link);
    fw.service.activate = bench_activate;
    supervisor_take_plan(&fw.supervisor, &fw.service.plan[fw.service.in_force]);
    storage_init(&fw.storage, &fw.service);
    memcpy(&fresh, &fw, sizeof fw);
}

/* Power on, up to the moment the stored settings are in force. Before storage is read every start leaves the same
 * memory: it is made once. */
static inline void bench_boot(void)
{
    if (fresh.storage.service)
        memcpy(&fw, &fresh, sizeof fw);
    else
        bench_init();
    memset(seen, 0, sizeof seen);
    (void)storage_ready(&fw.storage);
    bench_work();
    bench_tick();
    bench_events();
}

static inline const struct config *in_force(void)
{
    return &fw.service.plan[fw.service.in_force].config;
}

static inline bool bench_is(const struct config *config)
{
    return memcmp(in_force(), config, sizeof *config) == 0;
}

static inline void bench_set(struct config *config, const char *name, const char *value)
{
    struct parameter p;
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_find_in(config, name, &p), name);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_set(&p, config, value), name);
}

static inline float bench_get(const char *name)
{
    struct parameter p;
    char text[40];
    float f = 0.0f;
    struct text t = text_on(text, sizeof text);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_find_in(in_force(), name, &p), name);
    parameter_value(&p, in_force(), &t);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, text_parse_float(text, &f), text);
    return f;
}

static inline void bench_put(const struct config *config)
{
    struct config_fault fault;
    TEST_ASSERT_EQUAL(ERR_OK, service_apply(&fw.service, config, &fault));
    bench_tick();
}

/* Asks for a save and lets it end; save_why tells. */
static inline enum err bench_save(void)
{
    save_why = NULL;
    save_result = storage_save(&fw.storage, false, &save_why);
    if (save_result != ERR_OK)
        return save_result;
    bench_work();
    TEST_ASSERT_FALSE(storage_saving(&fw.storage));
    save_result = storage_result(&fw.storage, &save_why);
    return save_result;
}

/* One loop on one measurement and one output. */
static inline void bench_small(struct config *c, const char *gain)
{
    parameters_defaults(c);
    bench_set(c, "meas1.name", "T1");
    bench_set(c, "mv1.name", "heat");
    bench_set(c, "loop1.name", "bottom");
    bench_set(c, "loop1.pv", "T1");
    bench_set(c, "loop1.out", "heat");
    bench_set(c, "loop1.gain", gain);
}

/* Next to nothing: a short set. */
static inline void bench_tiny(struct config *c, const char *limit)
{
    parameters_defaults(c);
    bench_set(c, "tick.miss_limit", limit);
}

#endif
