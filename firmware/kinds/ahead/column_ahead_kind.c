#include "kinds/ahead/column_ahead_block.h"

#include <string.h>

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

static struct ahead_place place_of(const struct block_signal *signal, const float unit[AHEAD_UNIT],
                                   uint8_t is, const uint16_t place[AHEAD_PLACE])
{
    real_t factor = column_drive_factor(unit[AHEAD_FACTOR]);
    return (struct ahead_place){
        .zero = factor * signal->lo + unit[AHEAD_ZERO],
        .span = factor * (signal->hi - signal->lo),
        .is = is,
        .stage = (uint8_t)(place[AHEAD_STAGE] ? place[AHEAD_STAGE] - 1u : 0),
        .component = (uint8_t)(place[AHEAD_COMPONENT] ? place[AHEAD_COMPONENT] - 1u : 0)};
}

static void take_places(const struct block_setup *setup, struct ahead_place *input,
                        struct ahead_place *pv)
{
    const struct ahead_settings *s = setup->settings;
    for (unsigned k = 0; k < setup->inputs; k++)
        input[k] = place_of(&setup->input[k], s->si[k], s->is[k], s->place[k]);
    for (unsigned i = 0; i < setup->members; i++)
        pv[i] = place_of(&setup->pv[i], s->pv_si[i],
                         s->target[i][AHEAD_COMPONENT] ? AHEAD_FRACTION : AHEAD_TEMPERATURE,
                         s->target[i]);
}

static bool is_same_place(const struct ahead_place *a, const struct ahead_place *b)
{
    return a->is == b->is && a->stage == b->stage && a->component == b->component;
}

/* Signals mean what they meant, and the column is the one that it was. */
static bool is_same_column(const struct ahead *b, const struct block_setup *setup,
                           const struct ahead_place *input, const struct ahead_place *pv)
{
    const struct column_record *record = setup->named;
    bool same = b->record == record && b->checksum == column_record_checksum(record);
    for (unsigned k = 0; same && k < setup->inputs; k++)
        same = is_same_place(&b->input[k], &input[k]);
    for (unsigned i = 0; same && i < setup->members; i++)
        same = is_same_place(&b->pv[i], &pv[i]);
    return same;
}

static enum err ahead_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct ahead *b = state;
    const struct ahead_settings *s = setup->settings;
    const struct column_record *record = setup->named;
    struct ahead_place input[BLOCK_INPUTS_MAX] = {{ZERO, ZERO, 0, 0, 0}};
    struct ahead_place pv[AHEAD_LOOPS] = {{ZERO, ZERO, 0, 0, 0}};
    take_places(setup, input, pv);
    if (!retune || !is_same_column(b, setup, input, pv)) {
        memset(b, 0, sizeof *b);
        enum err err = ahead_model_begin(&b->m, record, numbers_of(b));
        if (err)
            return err;
    }
    b->record = record;
    b->checksum = column_record_checksum(record);
    b->loops = b->law.n = setup->members;
    b->inputs = setup->inputs;
    b->basis = s->basis;
    b->trust = s->trust;
    b->doubt = s->doubt;
    memcpy(b->input, input, sizeof b->input);
    memcpy(b->pv, pv, sizeof b->pv);
    b->m.parts = s->parts;
    b->m.h = (real_t)setup->interval_s / (real_t)s->parts;
    b->keep = s->miss_s > 0 ? ONE - real_exp(-(real_t)setup->interval_s / s->miss_s) : ONE;
    for (unsigned i = 0; i < b->loops; i++) {
        b->mv[i] = (uint8_t)(s->moves[i] - 1u);
        b->pole[i] = real_exp(-(real_t)setup->interval_s / s->tau_s[i]);
        b->far[i] = s->far[i] / (setup->pv[i].hi - setup->pv[i].lo);
        b->law.lo[i] = ZERO;
        b->law.hi[i] = ONE;
    }
    b->holds_next = true;
    return ERR_OK;
}

/* ---- the law ---- */

/* y[] an interval later under u[], without what predictions miss. */
static enum err predict_pvs(struct ahead *b, const real_t *u, real_t *y)
{
    struct column_inputs inputs;
    ahead_drive_by(b, u, &inputs);
    enum err err = ahead_model_predict(&b->m, &inputs);
    for (unsigned i = 0; !err && i < b->loops; i++)
        y[i] = ahead_target_of(b, i, b->m.later);
    return err;
}

/* B*, around law.u, where y[] is what was predicted. */
static enum err find_b(struct ahead *b, const real_t *y)
{
    real_t u[AHEAD_LOOPS], there[AHEAD_LOOPS];
    enum err err = ERR_OK;
    for (unsigned j = 0; !err && j < b->loops; j++) {
        memcpy(u, b->law.u, sizeof u);
        real_t move = u[j] > REAL_C(0.5) ? -TRIED : TRIED;
        u[j] += move;
        err = predict_pvs(b, u, there);
        for (unsigned i = 0; !err && i < b->loops; i++)
            b->law.b[i][j] = (there[i] - y[i]) / (b->pv[i].span * move);
    }
    return err;
}

/* What loop i is to be an interval later. */
static real_t ahead_asked(const struct ahead *b, const struct block_io *io, unsigned i)
{
    real_t now = ahead_target_of(b, i, b->m.x) + b->bias[i];
    real_t w = io->acting & (1u << i) ? ahead_place_si(b, &b->pv[i], io->setpoint[i]) : now;
    return now + (ONE - b->pole[i]) * (w - now);
}

/* Everything but the outputs of this step: where the column is is known, m.x looked at last. asked[] is given. */
static void take_misses(struct ahead *b, struct block_io *io, real_t *asked)
{
    for (unsigned i = 0; i < b->loops; i++) {
        real_t y = ahead_place_si(b, &b->pv[i], io->in[i]);
        real_t off = y - ahead_target_of(b, i, b->m.x);
        if (b->has_said) {
            real_t missed = y - b->said[i];
            b->bias[i] += b->keep * (off - b->bias[i]);
            b->missed[i] += b->keep * missed;
            if (b->far[i] > ZERO && real_abs(missed) > b->far[i] * real_abs(b->pv[i].span)) {
                io->raised |= 1u << EVENT_FAR;
                io->event_value[EVENT_FAR] = (float)(i + 1u);
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

/* Whether a model that is wrong in sign, unit or place, or MVs that are slow, make predictions useless: so often it would have been
 * better to expect no change. */
static bool is_in_doubt(struct ahead *b, const struct block_io *io)
{
    bool doubts = false;
    for (unsigned i = 0; i < b->loops && b->has_said; i++) {
        real_t y = ahead_place_si(b, &b->pv[i], io->in[i]), still = STILL * real_abs(b->pv[i].span);
        bool is_worse = real_abs(y - b->said[i]) > real_abs(y - b->before[i]) + still;
        b->worse[i] += ((is_worse ? ONE : ZERO) - b->worse[i]) / (real_t)WATCHED;
        doubts = doubts || b->worse[i] > b->doubt;
    }
    for (unsigned i = 0; i < b->loops; i++)
        b->before[i] = ahead_place_si(b, &b->pv[i], io->in[i]);
    if (b->has_said && b->watched < WATCHED)
        b->watched++;
    return doubts && b->doubt > ZERO && b->watched == WATCHED;
}

/* The MVs in effect, within their spans. */
static void take_applied(struct ahead *b, const struct block_io *io)
{
    for (unsigned j = 0; j < b->loops; j++) {
        real_t u = num_to_float(io->input[b->mv[j]]);
        b->law.u[j] = u < ZERO ? ZERO : u > ONE ? ONE : u;
    }
}

/* Predictions are such that what is in effect is what is asked for. */
static enum err hold_outputs(struct ahead *b, const real_t *asked)
{
    real_t y[AHEAD_LOOPS];
    enum err err = predict_pvs(b, b->law.u, y);
    for (unsigned i = 0; !err && i < b->loops; i++)
        b->missed[i] = asked[i] - y[i];
    return err;
}

/* Moves law.u from where y[] is predicted; said[] is what is then predicted. False: no MV does anything. */
static bool take_turn(struct ahead *b, const real_t *asked, const real_t *y)
{
    real_t e[AHEAD_LOOPS] = {ZERO}, before[AHEAD_LOOPS] = {ZERO};
    for (unsigned i = 0; i < b->loops; i++) {
        e[i] = (asked[i] - b->missed[i] - y[i]) / b->pv[i].span;
        before[i] = b->law.u[i];
    }
    if (!ahead_law_solve(&b->law, e))
        return false;
    for (unsigned i = 0; i < b->loops; i++) {
        b->said[i] = y[i] + b->missed[i];
        for (unsigned j = 0; j < b->loops; j++)
            b->said[i] += b->pv[i].span * b->law.b[i][j] * (b->law.u[j] - before[j]);
    }
    return true;
}

/* found: some MV does something. */
static enum err find_outputs(struct ahead *b, const real_t *asked, bool *found)
{
    real_t y[AHEAD_LOOPS] = {ZERO};
    *found = true;
    for (unsigned turn = 0; *found && turn < TURNS; turn++) {
        enum err err = predict_pvs(b, b->law.u, y);
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
    b->has_said = b->observed = false;
    ahead_model_rest(&b->m);
    io->gives_up = !err ? "no_effect" : err == ERR_NOT_FINITE ? "no_number" : "no_solution";
}

/* An input that is said to be the loop's MV is another one. */
static bool has_other_mv(const struct ahead *b, const struct block_io *io)
{
    for (unsigned j = 0; j < b->loops; j++)
        if (io->member_applied && io->input_applied &&
            io->member_applied[j] != io->input_applied[b->mv[j]])
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
    ahead_model_stands_here(&b->m, numbers_of(b));
    if (has_other_mv(b, io)) {
        io->gives_up = "other_mv";
        return;
    }
    enum err err = b->observed ? ERR_OK : ahead_observe(b, io);
    b->observed = false;
    if (is_in_doubt(b, io)) {
        begin_to_watch(b);
        io->gives_up = "model";
        return;
    }
    if (!err) {
        take_applied(b, io);
        take_misses(b, io, asked);
    }
    b->law.acting = io->acting;
    if (!err && b->holds_next)
        err = hold_outputs(b, asked);
    b->holds_next = false;
    if (!err)
        err = find_outputs(b, asked, &found);
    if (err || !found) {
        ahead_gives_up(b, io, err);
        return;
    }
    b->has_said = true;
    for (unsigned j = 0; j < b->loops; j++) {
        if (!(io->acting & (1u << j)))
            continue;
        real_t u = b->law.asked[j];
        u = u < ZERO ? ZERO : u > ONE ? ONE : u;
        b->given[j] = io->out[j] = num_from_float(u - b->apart[j]);
    }
}

/* Where an MV was held back is a limit, until it is seen beyond. */
static void take_limits(struct ahead *b, unsigned j, num_t told, real_t applied)
{
    if (applied > b->law.hi[j])
        b->law.hi[j] = ONE;
    if (applied < b->law.lo[j])
        b->law.lo[j] = ZERO;
    if (num_lt(told, b->given[j]))
        b->law.hi[j] = applied;
    if (num_lt(b->given[j], told))
        b->law.lo[j] = applied;
}

/* What took effect, as far as it was not what the step gave. */
static void ahead_back_calculate(void *state, struct block_io *io)
{
    struct ahead *b = state;
    for (unsigned j = 0; j < b->loops; j++) {
        real_t applied = num_to_float(io->input[b->mv[j]]);
        for (unsigned i = 0; i < b->loops; i++)
            b->said[i] += b->pv[i].span * b->law.b[i][j] * (applied - b->law.u[j]);
        b->law.u[j] = applied;
        if (!(io->acting & (1u << j)))
            continue;
        b->apart[j] = applied - num_to_float(io->out[j]);
        take_limits(b, j, io->out[j], applied);
    }
}

static void ahead_follow(void *state, struct block_io *io)
{
    struct ahead *b = state;
    real_t asked[AHEAD_LOOPS] = {ZERO};
    ahead_model_stands_here(&b->m, numbers_of(b));
    b->has_said = b->holds_next = false;
    begin_to_watch(b);
    enum err err = ahead_find_column(b, io);
    b->observed = !err;
    take_applied(b, io);
    for (unsigned j = 0; j < b->loops; j++) {
        b->law.lo[j] = ZERO;
        b->law.hi[j] = ONE;
        b->apart[j] = b->law.u[j] - num_to_float(io->out[j]);
        b->given[j] = io->out[j];
    }
    if (!err) {
        take_misses(b, io, asked);
        err = hold_outputs(b, asked);
    }
    if (err)
        ahead_gives_up(b, io, err);
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
