/* The kind `derived` as the tick uses it: settings, steps, the verb.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include <string.h>

#include "base/assertion.h"
#include "base/channel.h"
#include "kinds/derived/derived_parameters.h"
#include "kinds/derived/derived_point_state.h"

/* Longest stretch without a flow that a total bridges: the longer of these. */
#define BRIDGE_MS    10000.0f
#define BRIDGE_STEPS 1500.0f /* ms per s of the interval */

enum { EVENT_GAP, DERIVED_EVENTS };

struct derived_block {
    struct derived_settings settings;
    struct block_signal input[DERIVED_INPUTS], span[DERIVED_POINTS];
    uint8_t inputs, points;
    bool stepped; /* time_ms holds */
    uint32_t bridge_ms;
    uint64_t time_ms;             /* plant time of the last step */
    struct derived_point point[]; /* [points] */
};

static uint32_t derived_bytes(const struct block_setup *setup)
{
    size_t bytes = sizeof(struct derived_block) + setup->points * sizeof(struct derived_point);
    return (uint32_t)((bytes + 7u) & ~(size_t)7u);
}

static bool same_weights(const float *a, const float *b)
{
    for (unsigned i = 0; i < DERIVED_INPUTS; i++)
        if (a[i] != b[i])
            return false;
    return true;
}

/* A channel keeps its past where its form stays, and a counter where its input and factor do. */
static bool derived_goes_on(const struct derived_settings *before, const struct derived_settings *s,
                            unsigned k)
{
    return before->form[k] == s->form[k] && before->wrap[k] == s->wrap[k] &&
           (!(s->wrap[k] > 0) || same_weights(before->weight[k], s->weight[k]));
}

static enum err derived_configure(void *state, const struct block_setup *setup, bool retune)
{
    REFLUX_ASSERT(setup->inputs <= DERIVED_INPUTS && setup->points <= DERIVED_POINTS);
    struct derived_block *b = state;
    const struct derived_settings *s = setup->settings;
    float bridge_ms = BRIDGE_STEPS * setup->interval_s;
    if (!retune)
        memset(b, 0, derived_bytes(setup));
    for (unsigned k = 0; retune && k < setup->points; k++)
        if (!derived_goes_on(&b->settings, s, k))
            memset(&b->point[k], 0, sizeof b->point[k]);
    b->settings = *s;
    b->inputs = setup->inputs;
    b->points = setup->points;
    b->bridge_ms = (uint32_t)(bridge_ms > BRIDGE_MS ? bridge_ms : BRIDGE_MS);
    memcpy(b->input, setup->input, sizeof b->input);
    memcpy(b->span, setup->point, sizeof b->span);
    return ERR_OK;
}

static void derived_take_inputs(struct derived_block *b, const struct block_io *io,
                                struct derived_turn *t)
{
    uint64_t passed = io->inputs.time_ms - b->time_ms;
    t->settings = &b->settings;
    t->inputs = b->inputs;
    /* Plant time that goes back is that of another plant, or of one that has begun anew. */
    t->passed_known = b->stepped && io->inputs.time_ms >= b->time_ms;
    t->passed_ms = !t->passed_known ? 0 : passed > UINT32_MAX ? UINT32_MAX : (uint32_t)passed;
    t->bridge_ms = b->bridge_ms;
    b->stepped = true;
    b->time_ms = io->inputs.time_ms;
    for (unsigned i = 0; i < b->inputs; i++) {
        const struct block_signal *span = &b->input[i];
        t->value[i] = span->lo + num_to_float(io->inputs.value[i]) * (span->hi - span->lo);
        t->quality[i] = io->inputs.quality[i];
    }
}

static void derived_step(void *state, struct block_io *io)
{
    struct derived_block *b = state;
    struct derived_turn turn;
    derived_take_inputs(b, io, &turn);
    for (unsigned k = 0; k < b->points; k++) {
        const struct block_signal *span = &b->span[k];
        real_t value;
        io->points.quality[k] = (uint8_t)derived_point_step(&b->point[k], &turn, k, &value);
        io->points.value[k] = num_from_float((value - span->lo) / (span->hi - span->lo));
        if (b->settings.form[k] == DERIVED_TOTAL && derived_point_has_gap(&b->point[k])) {
            io->requests.raised = 1u << EVENT_GAP;
            io->requests.event_value[EVENT_GAP] = (float)(k + 1u);
        }
    }
}

/* The plant was away: nobody knows what flowed meanwhile. */
static void derived_follow(void *state, struct block_io *io)
{
    (void)io;
    ((struct derived_block *)state)->stepped = false;
}

/* Inner values: two of each total. */
static const char *derived_describe(const void *state, size_t i, float *value)
{
    static const char *const names[2 * DERIVED_POINTS] = {
        "total_1", "missed_1", "total_2", "missed_2", "total_3", "missed_3",
        "total_4", "missed_4", "total_5", "missed_5", "total_6", "missed_6"};
    const struct derived_block *b = state;
    size_t nth = i / 2;
    for (unsigned k = 0; k < b->points; k++) {
        if (b->settings.form[k] != DERIVED_TOTAL || nth--)
            continue;
        const struct derived_point *p = &b->point[k];
        *value = i % 2 ? derived_point_missed_s(p) : derived_point_total(p);
        return names[(size_t)2 * k + i % 2];
    }
    return NULL;
}

static const char *derived_reset(void *state, const float *number)
{
    struct derived_block *b = state;
    const char *refusal = "no_total";
    for (unsigned k = 0; k < b->points; k++)
        if (b->settings.form[k] == DERIVED_TOTAL && (!number || (unsigned)*number == k + 1u)) {
            derived_point_reset(&b->point[k]);
            refusal = NULL;
        }
    return refusal;
}

static const struct block_verb derived_verbs[] = {
    {.name = "reset",
     .number = "point",
     .help = "a total begins at 0; without a number all",
     .lo = 1,
     .hi = DERIVED_POINTS,
     .may_lack_number = true,
     .access = ACCESS_OPERATOR,
     .run = derived_reset},
};

static const struct block_event derived_events[DERIVED_EVENTS] = {
    [EVENT_GAP] = {"gap", BLOCK_INFO, "a total has missed some flow since its reset; point"},
};

const struct block_kind derived_kind = {
    .name = "derived",
    .stage = STAGE_ESTIMATE,
    .parameter = derived_parameter_rows,
    .parameters = DERIVED_PARAMETER_ROWS,
    .settings_bytes = sizeof(struct derived_settings),
    .inputs_most = DERIVED_INPUTS,
    .points_most = DERIVED_POINTS,
    .bad_input = BAD_INPUT_IS_TOLD,
    .verb = derived_verbs,
    .verbs = sizeof derived_verbs / sizeof derived_verbs[0],
    .event = derived_events,
    .events = DERIVED_EVENTS,
    .bytes = derived_bytes,
    .check = derived_check,
    .configure = derived_configure,
    .step = derived_step,
    .follow = derived_follow,
    .describe = derived_describe,
};
