/* Kinds of blocks that are told something and say something, beside the firmware's PID: for tests of verbs, events, alarms
 * and proposals. Included in one file of a test, it stands in for app/kinds.c. */
#ifndef REFLUX_TESTS_VERB_KINDS_H
#define REFLUX_TESTS_VERB_KINDS_H

#include <string.h>

#include "block/block.h"
#include "kinds/pid/pid.h"
#include "kinds/two_position/two_position.h"
#ifdef VERBS_BESIDE_ELEMENTS
#include "kinds/feedforward/feedforward.h"
#include "kinds/leadlag/leadlag.h"
#endif

static uint32_t verb_bytes(const struct block_setup *setup);
static enum err verb_check(const struct block_setup *setup, struct block_fault *fault);

/* ---- an estimator of one point, which is its input; it can be frozen ---- */

struct watch_settings {
    float limit; /* of its input, fraction of span */
};

struct verb_state {
    num_t limit, held;
    bool frozen, begun;
    float tuned;      /* by the verb; 0: it was given no number */
    unsigned tunings; /* times it was told */
    unsigned steps;
    bool above;
    num_t u[2];
};

static struct verb_state *watch_state, *pair_state;
static bool pair_is_spent, pair_gives_up; /* in its next step */
enum { WATCH_HIGH, WATCH_CROSSED };
/* Proposal of the next step of a watch or of a pair, and how often it found no room. */
static struct block_proposal watch_proposes, pair_proposes;
static unsigned no_room;
static bool watch_withdraws, pair_withdraws; /* in the next step */
/* Element that the next step of a watch or of a pair switches off. */
static struct block_switch_off watch_switches_off, pair_switches_off;
static void (*watch_described)(void); /* where an inner value is read; NULL: nobody looks */

static void verb_propose(struct block_io *io, struct block_proposal *proposes)
{
    if (!proposes->n)
        return;
    if (!io->requests.proposal) {
        no_room++;
        return;
    }
    *io->requests.proposal = *proposes;
    proposes->n = 0;
}

static void verb_switch_off(struct block_io *io, struct block_switch_off *switches_off)
{
    if (!switches_off->n || !io->requests.switch_off)
        return;
    *io->requests.switch_off = *switches_off;
    switches_off->n = 0;
}

static const struct block_parameter watch_parameters[] = {
    {.id = 1,
     .type = BLOCK_FLOAT,
     .name = "limit",
     .unit = "fraction",
     .help = "of its input",
     .lo = 0,
     .hi = 1,
     .initial = 0.5f},
};

static uint32_t verb_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct verb_state);
}

static enum err verb_check(const struct block_setup *setup, struct block_fault *fault)
{
    (void)setup;
    (void)fault;
    return ERR_OK;
}

static enum err watch_configure(void *state, const struct block_setup *setup, bool retune)
{
    const struct watch_settings *c = setup->settings;
    watch_state = state;
    if (!retune)
        memset(state, 0, sizeof(struct verb_state));
    watch_state->limit = num_from_float(c->limit);
    return ERR_OK;
}

static void watch_step(void *state, struct block_io *io)
{
    struct verb_state *w = watch_state = state;
    if (!w->frozen || !w->begun)
        w->held = io->inputs.value[0];
    w->begun = true;
    w->steps++;
    io->points.value[0] = w->held;
    io->points.quality[0] = io->inputs.quality[0];
    verb_propose(io, &watch_proposes);
    verb_switch_off(io, &watch_switches_off);
    io->requests.withdraws = watch_withdraws;
    watch_withdraws = false;
    bool above = num_lt(w->limit, io->inputs.value[0]);
    io->requests.event_value[WATCH_HIGH] = io->requests.event_value[WATCH_CROSSED] =
        num_to_float(io->inputs.value[0]);
    io->requests.raised = (uint16_t)((above ? 1u << WATCH_HIGH : 0u) |
                                     (above != w->above ? 1u << WATCH_CROSSED : 0u));
    w->above = above;
}

static const struct block_event watch_events[] = {
    [WATCH_HIGH] = {"high", BLOCK_ALARM, "its input is above the limit, fraction of span"},
    [WATCH_CROSSED] = {"crossed", BLOCK_INFO, "its input has passed the limit, fraction of span"},
};

static const char *watch_freeze(void *state, const float *number)
{
    struct verb_state *w = watch_state = state;
    (void)number;
    if (w->frozen)
        return "frozen";
    w->frozen = true;
    return NULL;
}

static const char *watch_thaw(void *state, const float *number)
{
    struct verb_state *w = watch_state = state;
    (void)number;
    w->frozen = false;
    return NULL;
}

static const char *verb_tune(void *state, const float *number)
{
    struct verb_state *w = watch_state = state;
    w->tuned = number ? *number : -1.0f;
    w->tunings++;
    return NULL;
}

static const struct block_verb watch_verbs[] = {
    {.name = "freeze", .help = "keeps its point where it is", .run = watch_freeze},
    {.name = "thaw", .help = "lets it go on", .run = watch_thaw},
    {.name = "tune",
     .number = "s",
     .help = "to that time, or the one it finds",
     .lo = 1,
     .hi = 100,
     .may_lack_number = true,
     .access = ACCESS_ENGINEER,
     .run = verb_tune},
};

static const char *watch_describe(const void *state, size_t i, float *value)
{
    const struct verb_state *w = state;
    if (watch_described)
        watch_described();
    *value = num_to_float(i ? w->limit : w->held);
    return i == 0 ? "held" : i == 1 ? "limit" : NULL;
}

static const struct block_kind watch_kind = {
    .name = "watch",
    .stage = STAGE_ESTIMATE,
    .parameter = watch_parameters,
    .parameters = 1,
    .settings_bytes = sizeof(struct watch_settings),
    .inputs_most = 1,
    .points_most = 1,
    .verb = watch_verbs,
    .verbs = 3,
    .event = watch_events,
    .events = 2,
    .bytes = verb_bytes,
    .check = verb_check,
    .configure = watch_configure,
    .step = watch_step,
    .describe = watch_describe,
};

/* ---- a controller of two loops whose outputs stay where they are ---- */

struct pair_settings {
    float rate; /* of nothing */
};

static const struct block_parameter pair_parameters[] = {
    {.id = 1,
     .type = BLOCK_FLOAT,
     .name = "rate",
     .unit = "-",
     .help = "of nothing",
     .lo = 0,
     .hi = 1,
     .initial = 0.5f},
};

static enum err pair_configure(void *state, const struct block_setup *setup, bool retune)
{
    (void)setup;
    pair_state = state;
    if (!retune)
        memset(state, 0, sizeof(struct verb_state));
    return ERR_OK;
}

static void pair_step(void *state, struct block_io *io)
{
    struct verb_state *p = pair_state = state;
    p->steps++;
    for (unsigned k = 0; k < 2; k++)
        io->members.out[k] = p->u[k];
    verb_propose(io, &pair_proposes);
    verb_switch_off(io, &pair_switches_off);
    io->requests.withdraws = pair_withdraws;
    pair_withdraws = false;
    io->requests.raised = pair_is_spent;
    io->requests.event_value[0] = 0.75f;
    if (pair_gives_up)
        io->requests.gives_up = "spent";
}

static const struct block_event pair_events[] = {{"spent", BLOCK_ALARM, "it has no room, share"}};

static void pair_follow(void *state, struct block_io *io)
{
    struct verb_state *p = pair_state = state;
    for (unsigned k = 0; k < 2; k++)
        p->u[k] = io->members.out[k];
}

static const struct block_verb pair_verbs[] = {
    {.name = "tune", .number = "s", .help = "to that time", .lo = 1, .hi = 100, .run = verb_tune},
};

static const struct block_kind pair_kind = {
    .name = "pair",
    .stage = STAGE_CONTROL,
    .parameter = pair_parameters,
    .parameters = 1,
    .settings_bytes = sizeof(struct pair_settings),
    .members_most = 2,
    .inputs_most = 2,
    .bad_input = BAD_INPUT_GIVES_UP,
    .verb = pair_verbs,
    .verbs = 1,
    .event = pair_events,
    .events = 1,
    .bytes = verb_bytes,
    .check = verb_check,
    .configure = pair_configure,
    .step = pair_step,
    .back_calculate = pair_follow,
    .follow = pair_follow,
};

const struct block_kind *const block_kinds[] = {&pid_kind,         &two_position_kind, &watch_kind,
                                                &pair_kind,
#ifdef VERBS_BESIDE_ELEMENTS
                                                &feedforward_kind, &leadlag_kind
#endif
};
const uint8_t block_kind_count = sizeof block_kinds / sizeof block_kinds[0];

#endif
