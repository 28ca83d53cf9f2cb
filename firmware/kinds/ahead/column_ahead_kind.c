/* Kind `ahead`: its steps. */
#include <string.h>

#include "base/assertion.h"
#include "kinds/ahead/column_ahead_block.h"
#include "kinds/ahead/column_ahead_law.h"
#include "kinds/ahead/column_ahead_model.h"
#include "kinds/ahead/column_ahead_parameters.h"
#include "kinds/ahead/column_ahead_place.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* Part of an MV's span by which it is moved to see what it does. */
#define TRIED REAL_C(0.02)
/* A second turn takes out what B* misses of a large move. */
#define TURNS 2

/* Steps over which it is counted whether predictions are of any use, and by how much a prediction has to be the worse one to count as that,
 * fraction of span: below it there is noise. */
#define WATCHED 40u
#define STILL   REAL_C(1e-3)

enum { EVENT_FAR, AHEAD_EVENTS };

static uint32_t ahead_bytes(const struct block_setup *setup)
{
    const struct column_record *record = setup->named;
    struct column_table table;
    struct column_fault fault;
    size_t bytes = sizeof(struct ahead);
    if (!record || column_record_read(record, &table, &fault))
        return 0; /* refused by check() */
    bytes += ahead_model_numbers(table.config.stages, table.config.components) * sizeof(real_t);
    return (uint32_t)((bytes + 7u) & ~(size_t)7u);
}

static real_t *numbers_of(struct ahead *b)
{
    return (real_t *)(void *)(b + 1);
}

/* ---- settings ---- */

/* The numbers behind the state begin anew where the column or the meaning of a signal is another. */
static enum err ahead_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct ahead *b = state;
    const struct ahead_settings *s = setup->settings;
    const struct column_record *record = setup->named;
    bool same = retune && b->record == record && b->checksum == column_record_checksum(record);
    if (!(same && ahead_places_set(&b->places, setup))) {
        memset(b, 0, sizeof *b);
        (void)ahead_places_set(&b->places, setup);
        enum err err = ahead_model_begin(&b->m, record, numbers_of(b));
        if (err)
            return err;
    }
    b->record = record;
    b->checksum = column_record_checksum(record);
    b->trust = s->trust;
    b->doubt = s->doubt;
    ahead_law_set(&b->law, setup->members);
    ahead_model_set(&b->m, s->parts, setup->interval_s);
    b->keep = s->miss_s > 0 ? ONE - real_exp(-(real_t)setup->interval_s / s->miss_s) : ONE;
    for (unsigned i = 0; i < setup->members; i++) {
        b->pole[i] = real_exp(-(real_t)setup->interval_s / s->tau_s[i]);
        b->alarm[i] = s->alarm[i] / (setup->pv[i].hi - setup->pv[i].lo);
        ahead_law_free(&b->law, i);
    }
    b->holds_next = true;
    return ERR_OK;
}

/* ---- the law ---- */

/* y[] an interval later under u[], without what predictions miss. */
static enum err predict_pvs(struct ahead *b, const real_t *u, real_t *y)
{
    struct column_inputs inputs;
    ahead_places_drive(&b->places, &b->m, u, &inputs);
    enum err err = ahead_model_predict(&b->m, &inputs);
    for (unsigned i = 0; !err && i < ahead_places_loops(&b->places); i++)
        y[i] = ahead_places_target(&b->places, &b->m, i, ahead_model_later(&b->m));
    return err;
}

/* B*, around law.u, where y[] is what was predicted. */
static enum err find_b(struct ahead *b, const real_t *y)
{
    real_t u[AHEAD_LOOPS], moved[AHEAD_LOOPS];
    enum err err = ERR_OK;
    for (unsigned j = 0; !err && j < ahead_places_loops(&b->places); j++) {
        memcpy(u, ahead_law_u(&b->law), sizeof u);
        real_t move = u[j] > REAL_C(0.5) ? -TRIED : TRIED;
        u[j] += move;
        err = predict_pvs(b, u, moved);
        for (unsigned i = 0; !err && i < ahead_places_loops(&b->places); i++)
            ahead_law_put_b(&b->law, i, j,
                            (moved[i] - y[i]) / (ahead_places_span(&b->places, i) * move));
    }
    return err;
}

/* Returns the PV that loop i is to have an interval later. */
static real_t ahead_asked(const struct ahead *b, const struct block_io *io, unsigned i)
{
    real_t present = ahead_places_target(&b->places, &b->m, i, ahead_model_x(&b->m)) + b->bias[i];
    real_t w = io->members.acting & (1u << i)
                   ? ahead_places_pv_si(&b->places, &b->m, i, io->members.setpoint[i])
                   : present;
    return present + (ONE - b->pole[i]) * (w - present);
}

/* Everything but the outputs of this step: where the column is is known, m.x looked at last. asked[] is given. */
static void take_misses(struct ahead *b, struct block_io *io, real_t *asked)
{
    for (unsigned i = 0; i < ahead_places_loops(&b->places); i++) {
        real_t y = ahead_places_pv_si(&b->places, &b->m, i, io->members.in[i]);
        real_t off = y - ahead_places_target(&b->places, &b->m, i, ahead_model_x(&b->m));
        if (b->has_prediction) {
            real_t missed = y - b->predicted[i];
            b->bias[i] += b->keep * (off - b->bias[i]);
            b->missed[i] += b->keep * missed;
            if (b->alarm[i] > ZERO &&
                real_abs(missed) > b->alarm[i] * real_abs(ahead_places_span(&b->places, i))) {
                io->requests.raised |= 1u << EVENT_FAR;
                io->requests.event_value[EVENT_FAR] = (float)(i + 1u);
            }
        } else {
            b->bias[i] = off;
        }
        asked[i] = ahead_asked(b, io, i);
    }
}

static void begin_to_watch(struct ahead *b)
{
    b->watched = 0;
    for (unsigned i = 0; i < AHEAD_LOOPS; i++)
        b->worse[i] = ZERO;
}

/* True: it would have been better too often to expect no change, because the model is wrong in sign, unit or place, or MVs are slow. */
static bool is_in_doubt(struct ahead *b, const struct block_io *io)
{
    bool doubts = false;
    for (unsigned i = 0; i < ahead_places_loops(&b->places) && b->has_prediction; i++) {
        real_t y = ahead_places_pv_si(&b->places, &b->m, i, io->members.in[i]),
               still = STILL * real_abs(ahead_places_span(&b->places, i));
        bool is_worse = real_abs(y - b->predicted[i]) > real_abs(y - b->before[i]) + still;
        b->worse[i] += ((is_worse ? ONE : ZERO) - b->worse[i]) / (real_t)WATCHED;
        doubts = doubts || b->worse[i] > b->doubt;
    }
    for (unsigned i = 0; i < ahead_places_loops(&b->places); i++)
        b->before[i] = ahead_places_pv_si(&b->places, &b->m, i, io->members.in[i]);
    if (b->has_prediction && b->watched < WATCHED)
        b->watched++;
    return doubts && b->doubt > ZERO && b->watched == WATCHED;
}

/* The MVs in effect, within their spans. */
static void take_applied(struct ahead *b, const struct block_io *io)
{
    for (unsigned j = 0; j < ahead_places_loops(&b->places); j++) {
        real_t u = num_to_float(io->inputs.value[ahead_places_mv(&b->places, j)]);
        ahead_law_put_u(&b->law, j, u < ZERO ? ZERO : u > ONE ? ONE : u);
    }
}

/* Predictions are such that what is in effect is what is asked for. */
static enum err hold_outputs(struct ahead *b, const real_t *asked)
{
    real_t y[AHEAD_LOOPS] = {ZERO};
    enum err err = predict_pvs(b, ahead_law_u(&b->law), y);
    for (unsigned i = 0; !err && i < ahead_places_loops(&b->places); i++)
        b->missed[i] = asked[i] - y[i];
    return err;
}

/* Moves the MVs from where y[] is predicted, and predicts anew. False: no MV does anything. */
static bool take_turn(struct ahead *b, const real_t *asked, const real_t *y)
{
    real_t e[AHEAD_LOOPS] = {ZERO}, before[AHEAD_LOOPS] = {ZERO};
    for (unsigned i = 0; i < ahead_places_loops(&b->places); i++) {
        e[i] = (asked[i] - b->missed[i] - y[i]) / ahead_places_span(&b->places, i);
        before[i] = ahead_law_u(&b->law)[i];
    }
    if (!ahead_law_solve(&b->law, e))
        return false;
    for (unsigned i = 0; i < ahead_places_loops(&b->places); i++) {
        b->predicted[i] = y[i] + b->missed[i];
        for (unsigned j = 0; j < ahead_places_loops(&b->places); j++)
            b->predicted[i] += ahead_places_span(&b->places, i) * ahead_law_b(&b->law, i, j) *
                               (ahead_law_u(&b->law)[j] - before[j]);
    }
    return true;
}

/* found: some MV does something. */
static enum err find_outputs(struct ahead *b, const real_t *asked, bool *found)
{
    real_t y[AHEAD_LOOPS] = {ZERO};
    *found = true;
    for (unsigned turn = 0; *found && turn < TURNS; turn++) {
        enum err err = predict_pvs(b, ahead_law_u(&b->law), y);
        if (!err && turn == 0)
            err = find_b(b, y);
        if (err)
            return err;
        *found = take_turn(b, asked, y);
    }
    return ERR_OK;
}

/* ---- steps ---- */

static void ahead_gives_up(struct ahead *b, struct block_io *io, enum err err)
{
    b->has_prediction = b->observed = false;
    ahead_model_rest(&b->m);
    io->requests.gives_up = !err                    ? "no_effect"
                            : err == ERR_NOT_FINITE ? "no_number"
                                                    : "no_solution";
}

/* True: an input that should be the loop's MV is another one. */
static bool has_other_mv(const struct ahead *b, const struct block_io *io)
{
    for (unsigned j = 0; j < ahead_places_loops(&b->places); j++)
        if (io->members.applied && io->inputs.applied &&
            io->members.applied[j] != io->inputs.applied[ahead_places_mv(&b->places, j)])
            return true;
    return false;
}

static uint16_t ahead_history(const struct block_setup *setup)
{
    (void)setup;
    return 1; /* only to see whether two of them are of one MV */
}

static void ahead_step(void *state, struct block_io *io)
{
    struct ahead *b = state;
    real_t asked[AHEAD_LOOPS] = {ZERO};
    bool found = true;
    ahead_model_relocate(&b->m, numbers_of(b));
    if (has_other_mv(b, io)) {
        io->requests.gives_up = "other_mv";
        return;
    }
    enum err err = b->observed ? ERR_OK : ahead_places_observe(&b->places, &b->m, io, b->trust);
    b->observed = false;
    if (is_in_doubt(b, io)) {
        begin_to_watch(b);
        io->requests.gives_up = "model";
        return;
    }
    if (!err) {
        take_applied(b, io);
        take_misses(b, io, asked);
    }
    ahead_law_act(&b->law, io->members.acting);
    if (!err && b->holds_next)
        err = hold_outputs(b, asked);
    b->holds_next = false;
    if (!err)
        err = find_outputs(b, asked, &found);
    if (err || !found) {
        ahead_gives_up(b, io, err);
        return;
    }
    b->has_prediction = true;
    for (unsigned j = 0; j < ahead_places_loops(&b->places); j++) {
        if (!(io->members.acting & (1u << j)))
            continue;
        real_t u = ahead_law_asked(&b->law, j);
        u = u < ZERO ? ZERO : u > ONE ? ONE : u;
        b->given[j] = io->members.out[j] = num_from_float(u - b->offset[j]);
    }
}

/* Takes the MVs that took effect, as far as the step gave others. */
static void ahead_back_calculate(void *state, struct block_io *io)
{
    struct ahead *b = state;
    for (unsigned j = 0; j < ahead_places_loops(&b->places); j++) {
        real_t applied = num_to_float(io->inputs.value[ahead_places_mv(&b->places, j)]);
        for (unsigned i = 0; i < ahead_places_loops(&b->places); i++)
            b->predicted[i] += ahead_places_span(&b->places, i) * ahead_law_b(&b->law, i, j) *
                               (applied - ahead_law_u(&b->law)[j]);
        ahead_law_put_u(&b->law, j, applied);
        if (!(io->members.acting & (1u << j)))
            continue;
        b->offset[j] = applied - num_to_float(io->members.out[j]);
        ahead_law_limit(&b->law, j, applied, num_lt(io->members.out[j], b->given[j]),
                        num_lt(b->given[j], io->members.out[j]));
    }
}

static void ahead_follow(void *state, struct block_io *io)
{
    struct ahead *b = state;
    real_t asked[AHEAD_LOOPS] = {ZERO};
    ahead_model_relocate(&b->m, numbers_of(b));
    b->has_prediction = b->holds_next = false;
    begin_to_watch(b);
    enum err err = ahead_places_find(&b->places, &b->m, io);
    b->observed = !err;
    take_applied(b, io);
    for (unsigned j = 0; j < ahead_places_loops(&b->places); j++) {
        ahead_law_free(&b->law, j);
        b->offset[j] = ahead_law_u(&b->law)[j] - num_to_float(io->members.out[j]);
        b->given[j] = io->members.out[j];
    }
    if (!err) {
        take_misses(b, io, asked);
        err = hold_outputs(b, asked);
    }
    if (err)
        ahead_gives_up(b, io, err);
}

/* ---- for the console ---- */

enum { VALUE_MISSED, VALUE_BIAS, VALUE_GIVEN, VALUE_DOUBT, VALUES };

/* B*, row by row. */
static const char *const element[AHEAD_LOOPS][AHEAD_LOOPS] = {
    {"b_11", "b_12", "b_13", "b_14"},
    {"b_21", "b_22", "b_23", "b_24"},
    {"b_31", "b_32", "b_33", "b_34"},
    {"b_41", "b_42", "b_43", "b_44"},
};

static const char *const loop_names[VALUES][AHEAD_LOOPS] = {
    {"missed_1", "missed_2", "missed_3", "missed_4"},
    {"bias_1", "bias_2", "bias_3", "bias_4"},
    {"given_1", "given_2", "given_3", "given_4"},
    {"doubt_1", "doubt_2", "doubt_3", "doubt_4"},
};

/* A value of loop k; missed and bias as fractions of the PV's span. */
static real_t value_of_loop(const struct ahead *b, unsigned which, unsigned k)
{
    REFLUX_ASSERT(k < AHEAD_LOOPS);
    switch (which) {
    case VALUE_MISSED:
        return b->missed[k] / ahead_places_span(&b->places, k);
    case VALUE_BIAS:
        return b->bias[k] / ahead_places_span(&b->places, k);
    case VALUE_GIVEN:
        return num_to_float(b->given[k]);
    default:
        return b->worse[k];
    }
}

static const char *ahead_describe(const void *state, size_t i, float *value)
{
    const struct ahead *b = state;
    unsigned n = ahead_places_loops(&b->places), k = (unsigned)(i % n), which = (unsigned)(i / n);
    if (which < VALUES) {
        *value = (float)value_of_loop(b, which, k);
        return loop_names[which][k];
    }
    which -= VALUES;
    if (which >= n)
        return NULL;
    *value = (float)ahead_law_b(&b->law, which, k);
    return element[which][k];
}

static const struct block_event ahead_events[AHEAD_EVENTS] = {
    [EVENT_FAR] = {"far", BLOCK_ALARM, "the PV is not where it was predicted, number of the loop"},
};

const struct block_kind ahead_kind = {
    .name = "ahead",
    .stage = STAGE_CONTROL,
    .uncompensated = "it works out the MVs of a column itself",
    .parameter = ahead_parameters,
    .parameters = AHEAD_PARAMETERS,
    .settings_bytes = sizeof(struct ahead_settings),
    .names = 1,
    .named_kind = "column",
    .members_most = AHEAD_LOOPS,
    .inputs_most = BLOCK_INPUTS_MAX,
    .bad_input = BAD_INPUT_GIVES_UP,
    .history = ahead_history,
    .event = ahead_events,
    .events = AHEAD_EVENTS,
    .bytes = ahead_bytes,
    .check = ahead_check,
    .configure = ahead_configure,
    .step = ahead_step,
    .back_calculate = ahead_back_calculate,
    .follow = ahead_follow,
    .describe = ahead_describe,
};
