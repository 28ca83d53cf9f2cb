/* A block of the kind `derived` alone, with its wires: inputs in EU, plant time in ms.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_TESTS_DERIVED_BENCH_H
#define REFLUX_TESTS_DERIVED_BENCH_H

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/channel.h"
#include "block_defaults.h"
#include "formats.h"
#include "kinds/derived/derived.h"
#include "unity.h"

struct derived_bench {
    struct derived_settings settings;
    struct block_setup setup;
    struct block_io io;
    num_t input[BLOCK_INPUTS_MAX], point[BLOCK_POINTS_MAX];
    uint8_t quality[BLOCK_INPUTS_MAX], point_quality[BLOCK_POINTS_MAX];
    float event_value[BLOCK_EVENTS_MAX];
    uint64_t time_ms;
    uint32_t step_ms;
    _Alignas(8) uint8_t state[2048];
};

/* Points of span 0 to 100 and inputs of the same; a step every second. */
static inline void derived_wire(struct derived_bench *b, unsigned inputs, unsigned points)
{
    memset(b, 0, sizeof *b);
    block_put_defaults(&b->settings, &derived_kind);
    b->step_ms = 1000;
    b->setup = (struct block_setup){.settings = &b->settings,
                                    .interval_s = 1,
                                    .inputs = (uint8_t)inputs,
                                    .points = (uint8_t)points};
    for (unsigned i = 0; i < BLOCK_INPUTS_MAX; i++)
        b->setup.input[i] = (struct block_signal){0, 100, false};
    for (unsigned k = 0; k < BLOCK_POINTS_MAX; k++)
        b->setup.point[k] = (struct block_signal){0, 100, false};
    b->io.inputs.value = b->input;
    b->io.inputs.quality = b->quality;
    b->io.points.value = b->point;
    b->io.points.quality = b->point_quality;
    b->io.requests.event_value = b->event_value;
}

static inline void derived_take(struct derived_bench *b, bool retune)
{
    struct block_fault fault = {0};
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, derived_kind.check(&b->setup, &fault), fault.field);
    TEST_ASSERT_LESS_OR_EQUAL(sizeof b->state, derived_kind.bytes(&b->setup));
    TEST_ASSERT_EQUAL(ERR_OK, derived_kind.configure(b->state, &b->setup, retune));
    if (!retune)
        derived_kind.follow(b->state, &b->io);
}

static inline void derived_put(struct derived_bench *b, unsigned i, double eu)
{
    const struct block_signal *s = &b->setup.input[i];
    b->input[i] = N((eu - (double)s->lo) / ((double)s->hi - (double)s->lo));
}

static inline void derived_run(struct derived_bench *b, unsigned steps)
{
    for (; steps; steps--) {
        b->time_ms += b->step_ms;
        b->io.inputs.time_ms = b->time_ms;
        b->io.requests.raised = 0;
        memset(b->point_quality, QUALITY_MISSING, sizeof b->point_quality);
        derived_kind.step(b->state, &b->io);
    }
}

/* A point in EU. */
static inline double derived_reads(const struct derived_bench *b, unsigned k)
{
    const struct block_signal *s = &b->setup.point[k];
    return (double)s->lo + D(b->point[k]) * ((double)s->hi - (double)s->lo);
}

/* Steps of num_t in the point, EU: what is lost on the way in and out. */
static inline double derived_steps(const struct derived_bench *b, unsigned k, double n)
{
    const struct block_signal *s = &b->setup.point[k];
    return n * BY_FORMAT(0x1p-24, 0x1p-24) * ((double)s->hi - (double)s->lo);
}

/* Inner value of the block. */
static inline double derived_inside(const struct derived_bench *b, const char *name)
{
    float value;
    const char *found;
    for (size_t i = 0; (found = derived_kind.describe(b->state, i, &value)) != NULL; i++)
        if (strcmp(found, name) == 0)
            return (double)value;
    TEST_FAIL_MESSAGE(name);
    return 0;
}

static inline bool derived_says(const struct derived_bench *b, const char *code)
{
    for (unsigned i = 0; i < derived_kind.events; i++)
        if (strcmp(derived_kind.event[i].code, code) == 0)
            return b->io.requests.raised & 1u << i;
    TEST_FAIL_MESSAGE(code);
    return false;
}

/* The verb `reset`, of all totals, or of a point from 1. Returns why it is refused, or NULL. */
static inline const char *derived_reset(struct derived_bench *b, float point)
{
    return derived_kind.verb[0].run(b->state, point > 0 ? &point : NULL);
}

#endif
