#include "control/column_ahead_block.h"

#if CONFIG_BLOCKS

#include <string.h>

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* Part of an MV's span by which it is moved to see what it does. */
#define TRIED REAL_C(0.02)
/* From the point of the last step, the model is corrected once; from one that nobody knows, so often. */
#define CORRECTIONS_AT_BEGIN 4
/* A second turn takes out what B* misses of a large move. */
#define TURNS 2

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

static real_t factor_or_1(real_t factor)
{
    return factor < ZERO || factor > ZERO ? factor : ONE;
}

static enum err ahead_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct ahead *b = state;
    const struct ahead_settings *s = setup->settings;
    const struct column_record *record = setup->named;
    bool same = retune && b->record == record && b->checksum == column_record_checksum(record) &&
                !memcmp(b->s.place, s->place, sizeof s->place) &&
                !memcmp(b->s.is, s->is, sizeof s->is);
    if (!same) {
        memset(b, 0, sizeof *b);
        enum err err = ahead_model_begin(&b->m, record, numbers_of(b));
        if (err)
            return err;
    }
    b->record = record;
    b->checksum = column_record_checksum(record);
    b->s = *s;
    b->loops = b->law.n = setup->members;
    b->inputs = setup->inputs;
    memcpy(b->pv, setup->pv, sizeof b->pv);
    memcpy(b->input, setup->input, sizeof b->input);
    b->m.parts = s->parts;
    b->m.h = (real_t)setup->interval_s / (real_t)s->parts;
    b->keep = s->miss_s > 0 ? ONE - real_exp(-(real_t)setup->interval_s / s->miss_s) : ONE;
    for (unsigned i = 0; i < b->loops; i++) {
        b->pole[i] = real_exp(-(real_t)setup->interval_s / s->tau_s[i]);
        b->span[i] = factor_or_1(s->pv_si[i][AHEAD_FACTOR]) * (b->pv[i].hi - b->pv[i].lo);
    }
    b->holds_next = true;
    return ERR_OK;
}

/* ---- units ---- */

static real_t to_si(const struct block_signal *signal, const float unit[AHEAD_UNIT],
                    real_t fraction)
{
    real_t eu = signal->lo + (signal->hi - signal->lo) * fraction;
    return factor_or_1(unit[AHEAD_FACTOR]) * eu + unit[AHEAD_ZERO];
}

/* What a PV or its setpoint is: K, or a mole fraction. */
static real_t target_si(const struct ahead *b, unsigned i, num_t fraction)
{
    real_t value = to_si(&b->pv[i], b->s.pv_si[i], num_to_float(fraction));
    unsigned component = b->s.target[i][AHEAD_COMPONENT];
    if (component == 0 || b->s.basis == AHEAD_MOLE)
        return value;
    return ahead_model_mole_fraction(&b->m, b->s.target[i][AHEAD_STAGE] - 1u, component - 1u,
                                     value);
}

/* At states that were looked at last. */
static real_t target_of(const struct ahead *b, unsigned i, const real_t *x)
{
    unsigned component = b->s.target[i][AHEAD_COMPONENT];
    return ahead_model_value(&b->m, x, b->s.target[i][AHEAD_STAGE] - 1u, component > 0,
                             component ? component - 1u : 0);
}

static unsigned mv_of(const struct ahead *b, unsigned j)
{
    return b->s.moves[j] - 1u;
}

/* The column's inputs with the MVs of the loops where u[loops] has them. */
static void drive(struct ahead *b, const real_t *u, struct column_inputs *inputs)
{
    *inputs = b->m.inputs;
    for (unsigned j = 0; j < b->loops; j++) {
        unsigned k = mv_of(b, j);
        ahead_model_take(&b->m, inputs, (enum ahead_input)b->s.is[k], 0,
                         to_si(&b->input[k], b->s.si[k], u[j]));
    }
}

/* ---- where the column is ---- */

static void insert(struct ahead_said *said, size_t *n, struct ahead_said one)
{
    size_t at = *n;
    for (size_t k = 0; k < *n; k++)
        if (said[k].stage == one.stage && said[k].component == one.component)
            return; /* inputs come first: a PV there may be the noisier of the two */
    for (; at > 0 && said[at - 1].stage > one.stage; at--)
        said[at] = said[at - 1];
    said[at] = one;
    ++*n;
}

static size_t gather_said(const struct ahead *b, const struct block_io *io, struct ahead_said *said)
{
    size_t n = 0;
    for (unsigned k = 0; k < b->inputs; k++) {
        bool is_fraction = b->s.is[k] == AHEAD_FRACTION;
        if (!is_fraction && b->s.is[k] != AHEAD_TEMPERATURE)
            continue;
        struct ahead_said one = {.stage = (uint8_t)(b->s.place[k][AHEAD_STAGE] - 1u),
                                 .component = (uint8_t)(b->s.place[k][AHEAD_COMPONENT] - 1u),
                                 .is_fraction = is_fraction,
                                 .value =
                                     to_si(&b->input[k], b->s.si[k], num_to_float(io->input[k]))};
        if (is_fraction && b->s.basis == AHEAD_MASS)
            one.value = ahead_model_mole_fraction(&b->m, one.stage, one.component, one.value);
        insert(said, &n, one);
    }
    for (unsigned i = 0; i < b->loops; i++) {
        unsigned component = b->s.target[i][AHEAD_COMPONENT];
        insert(said, &n,
               (struct ahead_said){.stage = (uint8_t)(b->s.target[i][AHEAD_STAGE] - 1u),
                                   .component = (uint8_t)(component ? component - 1u : 0),
                                   .is_fraction = component > 0,
                                   .value = target_si(b, i, io->in[i])});
    }
    return n;
}

/* The MVs as they were in the interval that is over, everything else as it is now. */
static void take_drives(struct ahead *b, const struct block_io *io)
{
    for (unsigned k = 0; k < b->inputs; k++)
        ahead_model_take(&b->m, &b->m.inputs, (enum ahead_input)b->s.is[k],
                         b->s.place[k][AHEAD_COMPONENT] ? b->s.place[k][AHEAD_COMPONENT] - 1u : 0,
                         to_si(&b->input[k], b->s.si[k], num_to_float(io->input[k])));
}

/* Where the column is. carried: an interval is over since the last time. */
static enum err observe(struct ahead *b, const struct block_io *io, bool carried)
{
    struct ahead_said said[AHEAD_SAID_MOST];
    enum err err = ERR_OK;
    take_drives(b, io);
    if (carried)
        err = ahead_model_carry(&b->m, &b->m.inputs);
    for (unsigned k = 0; !err && k < (carried ? 1u : CORRECTIONS_AT_BEGIN); k++) {
        size_t n = gather_said(b, io, said);
        err = ahead_model_correct(&b->m, said, n, carried ? (real_t)b->s.trust : ONE);
    }
    return err;
}

/* ---- the law ---- */

/* y[] an interval later under u[], without what predictions miss. */
static enum err predict(struct ahead *b, const real_t *u, real_t *y)
{
    struct column_inputs inputs;
    drive(b, u, &inputs);
    enum err err = ahead_model_predict(&b->m, &inputs);
    for (unsigned i = 0; !err && i < b->loops; i++)
        y[i] = target_of(b, i, b->m.later);
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
        err = predict(b, u, there);
        for (unsigned i = 0; !err && i < b->loops; i++)
            b->law.b[i][j] = (there[i] - y[i]) / (b->span[i] * move);
    }
    return err;
}

/* What loop i is to be an interval later. */
static real_t asked_of(const struct ahead *b, const struct block_io *io, unsigned i)
{
    real_t now = target_of(b, i, b->m.x) + b->bias[i];
    real_t w = io->acting & (1u << i) ? target_si(b, i, io->setpoint[i]) : now;
    return now + (ONE - b->pole[i]) * (w - now);
}

/* Everything but the outputs of this step: where the column is is known, m.x looked at last. asked[] is given. */
static void take_misses(struct ahead *b, struct block_io *io, real_t *asked)
{
    for (unsigned i = 0; i < b->loops; i++) {
        real_t y = target_si(b, i, io->in[i]);
        real_t off = y - target_of(b, i, b->m.x);
        if (b->has_said) {
            real_t missed = y - b->said[i];
            real_t far = (real_t)b->s.far[i] * real_abs(b->span[i]) / (b->pv[i].hi - b->pv[i].lo);
            b->bias[i] += b->keep * (off - b->bias[i]);
            b->missed[i] += b->keep * missed;
            if (b->s.far[i] > 0 && real_abs(missed) > far) {
                io->raised |= 1u << EVENT_FAR;
                io->event_value[EVENT_FAR] = (float)(i + 1u);
            }
        } else {
            b->bias[i] = off;
        }
        asked[i] = asked_of(b, io, i);
    }
}

/* The MVs in effect, within their spans. */
static void take_applied(struct ahead *b, const struct block_io *io)
{
    for (unsigned j = 0; j < b->loops; j++) {
        real_t u = num_to_float(io->input[mv_of(b, j)]);
        b->law.u[j] = u < ZERO ? ZERO : u > ONE ? ONE : u;
    }
}

/* Predictions are such that what is in effect is what is asked for. */
static enum err hold(struct ahead *b, const real_t *asked)
{
    real_t y[AHEAD_LOOPS];
    enum err err = predict(b, b->law.u, y);
    for (unsigned i = 0; !err && i < b->loops; i++)
        b->missed[i] = asked[i] - y[i];
    return err;
}

/* False: no MVs would do it. */
static enum err find_outputs(struct ahead *b, const real_t *asked, bool *found)
{
    real_t y[AHEAD_LOOPS], e[AHEAD_LOOPS], before[AHEAD_LOOPS];
    enum err err = predict(b, b->law.u, y);
    real_t first[AHEAD_LOOPS];
    memcpy(first, y, sizeof first);
    if (!err)
        err = find_b(b, first);
    *found = true;
    for (unsigned turn = 0; !err && *found && turn < TURNS; turn++) {
        if (turn > 0)
            err = predict(b, b->law.u, y);
        for (unsigned i = 0; i < b->loops; i++)
            e[i] = (asked[i] - b->missed[i] - y[i]) / b->span[i];
        memcpy(before, b->law.u, sizeof before);
        *found = !err && ahead_law_solve(&b->law, e);
    }
    for (unsigned i = 0; i < b->loops; i++) {
        b->said[i] = y[i] + b->missed[i];
        for (unsigned j = 0; j < b->loops; j++)
            b->said[i] += b->span[i] * b->law.b[i][j] * (b->law.u[j] - before[j]);
    }
    return err;
}

/* ---- steps ---- */

static void give_up(struct block_io *io, enum err err)
{
    io->gives_up = err == ERR_NOT_FINITE ? "no number" : "no solution";
}

/* An input that is said to be the loop's MV is another one. */
static bool has_other_mv(const struct ahead *b, const struct block_io *io)
{
    for (unsigned j = 0; j < b->loops; j++)
        if (io->member_applied && io->input_applied &&
            io->member_applied[j] != io->input_applied[mv_of(b, j)])
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
    real_t asked[AHEAD_LOOPS];
    bool found = true;
    ahead_model_stands_here(&b->m, numbers_of(b));
    if (has_other_mv(b, io)) {
        io->gives_up = "moves another MV";
        return;
    }
    enum err err = b->observed ? ERR_OK : observe(b, io, true);
    b->observed = false;
    if (!err) {
        take_applied(b, io);
        take_misses(b, io, asked);
    }
    b->law.acting = io->acting;
    if (!err && b->holds_next)
        err = hold(b, asked);
    b->holds_next = false;
    if (!err)
        err = find_outputs(b, asked, &found);
    if (err || !found) {
        b->has_said = false;
        if (err)
            give_up(io, err);
        else
            io->gives_up = "singular";
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
        real_t applied = num_to_float(io->input[mv_of(b, j)]);
        for (unsigned i = 0; i < b->loops; i++)
            b->said[i] += b->span[i] * b->law.b[i][j] * (applied - b->law.u[j]);
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
    real_t asked[AHEAD_LOOPS];
    ahead_model_stands_here(&b->m, numbers_of(b));
    b->has_said = b->holds_next = false;
    enum err err = observe(b, io, false);
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
        err = hold(b, asked);
    }
    if (err)
        give_up(io, err);
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

#endif
