/* The kind `composition`: an estimator of mole fractions on the stages of a column from temperatures (docs/composition-estimation.md). */
#include "kinds/composition/composition_job.h"

#include <string.h>

#include "base/channel.h"
#include "model/column_drive.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* To its own steady state: steps of an hour until none of them moves a mole fraction by more. */
#define SETTLE_S     REAL_C(3600.0)
#define SETTLE_MOST  300u
#define SETTLE_STILL REAL_C(1e-6)

static uint32_t composition_bytes(const struct block_setup *setup)
{
    size_t bytes = sizeof(struct composition_block) + composition_numbers(setup) * sizeof(real_t);
    return (uint32_t)((bytes + 7u) & ~(size_t)7u);
}

real_t *composition_gain_memory(struct composition_block *b)
{
    return (real_t *)(void *)(b + 1);
}

/* The state may stand elsewhere than in the last call. */
static void stand_here(struct composition_block *b)
{
    struct composition *c = &b->c;
    real_t *numbers = composition_gain_memory(b);
    composition_stands_here(c);
    if (c->gains.of)
        c->gains.of = numbers;
    c->linear.transition.of = numbers + c->sensors * composition_moved(c);
    c->linear.push =
        c->linear.transition.of +
        c->table.config.stages * column_transition_stride(c->table.config.components - 1u);
}

/* ---- settings ---- */

/* A column of the table that is named. Pointers into the record stay good: block.h. */
static enum err take_column(struct composition_block *b, const struct column_record *record)
{
    struct composition *c = &b->c;
    enum err err = column_record_open(record, &c->table, &c->column);
    if (err)
        return err;
    c->inputs = c->table.nominal;
    for (size_t s = 0; s < COLUMN_STAGES_MAX; s++)
        c->truncated[s] = s < c->table.config.stages && column_table_is_truncated(&c->table, s + 1);
    b->record = record;
    b->checksum = column_record_checksum(record);
    return ERR_OK;
}

/* Share of what an analysis says more, where nothing is said. */
#define SHARE_INITIAL REAL_C(0.7)

static void begin_analyses(struct composition_block *b)
{
    for (uint8_t k = 0; k < b->analyses; k++) {
        real_t *offset = composition_offset(b, k);
        composition_analysis_begin(&b->analysis[k], b->c.h, b->s.reach_s);
        if (offset)
            *offset = ZERO;
    }
}

/* keep: they are those that there were. */
static void take_analyses(struct composition_block *b, const struct composition_record *r,
                          bool keep)
{
    uint16_t before = b->analyses ? b->analysis[0].every : 0;
    b->analyses = 0;
    for (unsigned k = 0; k < b->inputs; k++) {
        if (b->s.is[k] != IS_ANALYSIS)
            continue;
        struct composition_analysis *a = &b->analysis[b->analyses++];
        a->input = (uint8_t)k;
        a->stage = (uint8_t)(b->s.place[k][AT_STAGE] - 1u);
        a->component = (uint8_t)(b->s.place[k][OF_COMPONENT] - 1u);
        a->share = r->tune[k][TUNE_LAMBDA] > 0 ? r->tune[k][TUNE_LAMBDA] : SHARE_INITIAL;
    }
    if (!keep || before != composition_analysis_every(b->c.h, b->s.reach_s))
        begin_analyses(b);
}

/* Not only as many: each means what it meant. */
static bool has_same_extras(const struct composition_settings *s,
                            const struct composition_settings *now, unsigned inputs)
{
    return (s->feed_z > 0) == (now->feed_z > 0) &&
           (composition_feed_f(s, inputs) > 0) == (composition_feed_f(now, inputs) > 0) &&
           (s->offset > 0) == (now->offset > 0);
}

static enum err composition_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct composition_block *b = state;
    const struct column_record *record = setup->named;
    const struct composition_settings *s = setup->settings;
    bool same = retune && b->checksum == column_record_checksum(record) && b->record == record &&
                b->s.method == s->method && b->s.covariance == s->covariance &&
                has_same_extras(&b->s, s, setup->inputs) &&
                !memcmp(b->s.place, s->place, sizeof s->place) &&
                !memcmp(b->s.is, s->is, sizeof s->is);
    if (retune && !same)
        composition_end_lease(b);
    if (!same) {
        memset(b, 0, sizeof *b);
        enum err err = take_column(b, record);
        if (err)
            return err;
    }
    b->s = *s;
    b->inputs = setup->inputs;
    b->points = setup->points;
    for (unsigned k = 0; k < BLOCK_INPUTS_MAX; k++)
        b->input[k] = (struct composition_span){setup->input[k].lo, setup->input[k].hi};
    for (unsigned k = 0; k < BLOCK_POINTS_MAX; k++)
        b->point[k] = (struct composition_span){setup->point[k].lo, setup->point[k].hi};
    composition_take_settings(&b->c, setup, same);
    take_analyses(b, setup->settings, same);
    if (!same)
        composition_begin(&b->c);
    composition_forget_steady(b); /* of other numbers than these */
    stand_here(b);
    return ERR_OK;
}

/* ---- what comes in ---- */

/* In SI units. */
static real_t reading_si(const struct composition_block *b, const struct block_io *io, unsigned k)
{
    real_t eu = b->input[k].lo + (b->input[k].hi - b->input[k].lo) * num_to_float(io->input[k]);
    return column_drive_factor(b->s.si[k][UNIT_FACTOR]) * eu + b->s.si[k][UNIT_ZERO];
}

static real_t kept_between(real_t x, real_t lo, real_t hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}

/* Which inputs are missing; what they were last holds on. */
static void take_inputs(struct composition_block *b, const struct block_io *io, real_t *t)
{
    uint8_t sensor = 0;
    b->missing = 0;
    for (unsigned k = 0; k < b->inputs; k++) {
        if (composition_is_sensor(&b->s, k)) {
            t[sensor] = reading_si(b, io, k);
            b->c.sensor[sensor++].there = io->quality[k] == QUALITY_GOOD;
        } else if (b->s.is[k] == IS_ANALYSIS) {
            continue;
        } else if (quality_usable((enum quality)io->quality[k])) {
            column_drive_take(&b->c.table, &b->c.inputs, (enum column_drive)(b->s.is[k] - IS_FEED),
                              reading_si(b, io, k));
        } else if (!b->missing) {
            b->missing = (uint8_t)(k + 1u);
        }
    }
}

/* After a step. The number of the first analysis that is missed, too old or not believed, or 0. */
static unsigned step_analyses(struct composition_block *b, const struct block_io *io)
{
    unsigned odd = 0;
    for (uint8_t i = 0; i < b->analyses; i++) {
        struct composition_analysis *a = &b->analysis[i];
        real_t *offset = composition_offset(b, i);
        unsigned k = a->input;
        if (offset)
            a->correction = *offset;
        a->told = b->c.gains.of && b->filter.job && !b->filter.declined;
        bool too_old = composition_analysis_step(
            a, b->c.h, column_fraction(&b->c.column, b->c.x, a->stage, a->component),
            io->quality[k] == QUALITY_GOOD, reading_si(b, io, k), (real_t)io->age_s[k], b->s.far);
        if (offset)
            *offset = a->correction;
        bool missed = b->s.late_s > 0 && (real_t)io->age_s[k] > b->s.late_s;
        if (!odd && (too_old || missed || a->far || io->quality[k] != QUALITY_GOOD))
            odd = k + 1u;
    }
    return odd;
}

/* What analyses say of a place, or 0. */
static real_t correction_at(const struct composition_block *b, size_t stage, size_t component)
{
    for (uint8_t i = 0; i < b->analyses; i++)
        if (b->analysis[i].stage == stage && b->analysis[i].component == component)
            return b->analysis[i].correction;
    return ZERO;
}

/* ---- what comes out ---- */

/* Of component j (from 0) on a stage, with what analyses say of it. */
static real_t mole_fraction_at(const struct composition_block *b, size_t stage, size_t j)
{
    return kept_between(
        column_fraction(&b->c.column, b->c.x, stage, j) + correction_at(b, stage, j), ZERO, ONE);
}

/* The same by mass: the others share what is left as they do in the model. */
static real_t mass_fraction_at(const struct composition_block *b, size_t stage, size_t j)
{
    size_t n = b->c.table.config.components;
    real_t full[COLUMN_COMPONENTS_MAX], own = mole_fraction_at(b, stage, j);
    real_t rest = ONE - column_fraction(&b->c.column, b->c.x, stage, j);
    real_t share = rest > ZERO ? (ONE - own) / rest : ZERO;
    for (size_t i = 0; i < n; i++)
        full[i] = i == j ? own : share * column_fraction(&b->c.column, b->c.x, stage, i);
    return mass_fraction_of(b->c.table.component, n, full, j);
}

/* Of the feed as it is found: its flow in the unit of the table, or the fraction of a component. */
static real_t feed_estimate(const struct composition_block *b, unsigned k)
{
    struct column_inputs inputs;
    composition_inputs(&b->c, &inputs);
    if (b->s.of[k] == OF_FEED_FLOW)
        return inputs.feed_flow;
    size_t j = b->s.point[k][OF_COMPONENT] - 1u;
    return b->s.basis == BASIS_MOLE
               ? inputs.feed_fraction[j]
               : mass_fraction_of(b->c.table.component, b->c.table.config.components,
                                  inputs.feed_fraction, j);
}

static real_t stage_estimate(const struct composition_block *b, unsigned k)
{
    size_t stage = b->s.point[k][AT_STAGE] - 1u, component = b->s.point[k][OF_COMPONENT];
    if (component == 0)
        return composition_temperature(&b->c, stage);
    return b->s.basis == BASIS_MOLE ? mole_fraction_at(b, stage, component - 1)
                                    : mass_fraction_at(b, stage, component - 1);
}

/* What a point is, in its own unit. */
static real_t estimate_of(const struct composition_block *b, unsigned k)
{
    real_t value = b->s.of[k] == OF_STAGE ? stage_estimate(b, k) : feed_estimate(b, k);
    return column_drive_factor(b->s.show[k][UNIT_FACTOR]) * value + b->s.show[k][UNIT_ZERO];
}

static void give_estimates(const struct composition_block *b, struct block_io *io,
                           enum quality quality)
{
    for (unsigned k = 0; k < b->points; k++) {
        real_t span = b->point[k].hi - b->point[k].lo;
        io->point[k] = num_from_float((estimate_of(b, k) - b->point[k].lo) / span);
        bool unsure = quality == QUALITY_GOOD &&
                      (composition_point_is_unsure(b, k) || composition_point_is_unseen(b, k));
        io->point_quality[k] = (uint8_t)(unsure ? QUALITY_UNCERTAIN : quality);
    }
}

/* ---- steps ---- */

static void composition_follow(void *state, struct block_io *io)
{
    struct composition_block *b = state;
    (void)io;
    stand_here(b);
    b->steps = b->without = b->dry = 0;
    b->begun = b->seen = false;
    composition_begin_filter(b);
    begin_analyses(b);
    if (!b->settle) /* else work is on the column */
        composition_begin(&b->c);
}

/* Before a step: what the background has done. False: the model is the background's. */
static bool take_result(struct composition_block *b, struct block_io *io)
{
    bool settled = io->work_done && b->work == WORK_SETTLE;
    if (io->work_done && b->work == WORK_GAINS)
        composition_take_gains(b);
    if (!io->work_wanted)
        b->work = WORK_NONE;
    composition_keep_lease(b, b->work == WORK_GAINS);
    if (settled)
        b->settle = false;
    if (!b->settle || b->work == WORK_GAINS)
        return true;
    b->work = WORK_SETTLE;
    io->ask_work = 1;
    return false;
}

/* After a step. */
static void ask_for_gains(struct composition_block *b, struct block_io *io)
{
    if (io->work_wanted || b->settle)
        return;
    io->ask_work = composition_order(b);
    if (io->ask_work)
        b->work = WORK_GAINS;
}

static void composition_block_step(void *state, struct block_io *io)
{
    struct composition_block *b = state;
    real_t t[SENSORS_MAX];
    stand_here(b);
    if (!take_result(b, io)) {
        give_estimates(b, io, QUALITY_UNCERTAIN);
        return;
    }
    take_inputs(b, io, t);
    if (!b->begun) { /* nobody knows yet what was applied before this tick */
        b->begun = true;
        enum err none = composition_evaluate(&b->c);
        give_estimates(b, io, none || !composition_is_drawn(b) ? QUALITY_BAD : QUALITY_UNCERTAIN);
        return;
    }
    enum err err = composition_step(&b->c, t);
    if (err)
        composition_begin_filter(b);
    composition_count_step(b, err != ERR_OK);
    enum quality quality = composition_judge(b, io, err);
    unsigned odd = composition_is_locked_on(b) ? step_analyses(b, io) : 0;
    if (!b->missing)
        composition_raise(io, EVENT_NO_INPUT, odd);
    give_estimates(b, io, odd && quality == QUALITY_GOOD ? QUALITY_UNCERTAIN : quality);
    ask_for_gains(b, io);
}

/* One step of an hour without any temperature. */
static bool settle_piece(struct composition_block *b)
{
    real_t most = ZERO, h = b->c.h;
    b->c.h = SETTLE_S;
    enum err err = composition_predict(&b->c);
    b->c.h = h;
    for (size_t i = 0; !err && i < b->c.column.n_fractions; i++)
        if (real_abs(b->c.blocks.change[i]) > most)
            most = real_abs(b->c.blocks.change[i]);
    b->settling++;
    return !err && most > SETTLE_STILL && b->settling < SETTLE_MOST;
}

static bool composition_work(void *state)
{
    struct composition_block *b = state;
    stand_here(b);
    return b->work == WORK_SETTLE  ? settle_piece(b)
           : b->work == WORK_GAINS ? composition_job_piece(b)
                                   : false; /* asked for by other settings than these */
}

static const char *run_settle(void *state, const float *number)
{
    struct composition_block *b = state;
    (void)number;
    b->settle = true;
    b->settling = 0;
    b->steps = 0;
    composition_begin_filter(b); /* where it comes out nobody knows how well it fits */
    b->c.watched = 0;            /* temperatures may be far from there */
    return NULL;
}

static const char *run_begin(void *state, const float *number)
{
    (void)number;
    struct composition_block *b = state;
    if (b->settle) /* work is on the state */
        return "settles";
    stand_here(b);
    b->steps = 0;
    composition_begin_filter(b);
    b->filter.steady = false;
    composition_begin(&b->c);
    return NULL;
}

static const char *run_free(void *state, const float *number)
{
    struct composition_block *b = state;
    (void)number;
    if (!composition_is_complete(&b->c))
        return "method";
    b->filter.declined = true;
    return NULL;
}

static const char *run_take(void *state, const float *number)
{
    struct composition_block *b = state;
    (void)number;
    if (!composition_is_complete(&b->c))
        return "method";
    if (!b->filter.job && composition_workspace_holder())
        return composition_workspace_holder();
    b->filter.declined = false;
    return NULL;
}

static const struct block_verb composition_verbs[] = {
    {.name = "settle",
     .help = "to the steady state of its own model at the inputs that there are",
     .access = ACCESS_ENGINEER,
     .run = run_settle},
    {.name = "begin",
     .help = "with the profile of the table",
     .access = ACCESS_ENGINEER,
     .run = run_begin},
    {.name = "free",
     .help = "ekf, kalman: the workspace, for start-up; the last gains go on",
     .access = ACCESS_ENGINEER,
     .run = run_free},
    {.name = "take",
     .help = "ekf, kalman: the workspace again",
     .access = ACCESS_ENGINEER,
     .run = run_take},
};

static const struct block_event composition_events[COMPOSITION_EVENTS] = {
    [EVENT_LOST] =
        {"lost", BLOCK_INFO,
         "a temperature is missing or too far off, the estimate goes on without; its input, or 0: "
         "the covariance has no workspace"},
    [EVENT_ALONE] = {"alone", BLOCK_ALARM, "no temperature moves the model any more, -"},
    [EVENT_PULL] = {"pull", BLOCK_ALARM, "a temperature draws the model too hard; its input"},
    [EVENT_NIS] = {"nis", BLOCK_ALARM,
                   "innovations are larger than they may be; input of the temperature"},
    [EVENT_APART] = {"apart", BLOCK_ALARM,
                     "temperatures of a section contradict each other; input of the oddest"},
    [EVENT_NO_STATE] = {"no_state", BLOCK_ALARM, "the model has no solution and begins anew, -"},
    [EVENT_NO_INPUT] = {"no_input", BLOCK_ALARM,
                        "a flow is missing, its last value holds, or an analysis is late or not "
                        "believed; which input"},
    [EVENT_NO_BOIL] = {"no_boil", BLOCK_INFO,
                       "no vapour reaches the model's condenser: heat and feed, or their units, -"},
};

const struct block_kind composition_kind = {
    .name = "composition",
    .stage = STAGE_ESTIMATE,
    .parameter = composition_parameter_rows,
    .parameters = COMPOSITION_PARAMETER_ROWS,
    .settings_bytes = sizeof(struct composition_record),
    .returns = offsetof(struct composition_record, back),
    .names = 1,
    .named_kind = "column",
    .inputs_most = BLOCK_INPUTS_MAX,
    .points_most = BLOCK_POINTS_MAX,
    .bad_input = BAD_INPUT_IS_TOLD,
    .work = composition_work,
    .verb = composition_verbs,
    .verbs = sizeof composition_verbs / sizeof composition_verbs[0],
    .event = composition_events,
    .events = COMPOSITION_EVENTS,
    .bytes = composition_bytes,
    .check = composition_check,
    .configure = composition_configure,
    .step = composition_block_step,
    .follow = composition_follow,
    .describe = composition_describe,
};
