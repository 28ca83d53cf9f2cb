/* The kind `composition`: an estimator of mole fractions on the stages of a column from temperatures (docs/methods/composition-estimation.md). */
#include <string.h>

#include "base/assertion.h"
#include "base/channel.h"
#include "kinds/composition/composition_block.h"
#include "kinds/composition/composition_filter.h"
#include "kinds/composition/composition_judge.h"
#include "kinds/composition/composition_parameters.h"
#include "kinds/composition/composition_values.h"
#include "model/column_drive.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* Settling: steps of an hour until none of them moves a mole fraction by more. */
#define SETTLE_S     REAL_C(3600.0)
#define SETTLE_MOST  300u
#define SETTLE_STILL REAL_C(1e-6)

/* Numbers that the state needs behind its struct: gains, and the linear model. 0 for other methods. */
static size_t composition_numbers(const struct block_setup *setup)
{
    const struct composition_settings *s = setup->settings;
    const struct column_record *record = setup->named;
    unsigned sensors = 0;
    if (!record || !composition_is_complete(s))
        return 0;
    float table_stages = record->value[COLUMN_TABLE_N_STAGES];
    float components = record->value[COLUMN_TABLE_N_COMPONENTS];
    if (!(table_stages >= 1 && table_stages <= (float)COLUMN_STAGES_MAX && components >= 2 &&
          components <= (float)COLUMN_COMPONENTS_MAX))
        return 0; /* check() refuses it */
    size_t stages = (size_t)table_stages, m = (size_t)components - 1u;
    for (unsigned k = 0; k < setup->inputs; k++)
        sensors += composition_is_sensor(s, k) ? 1u : 0u;
    size_t n = sensors * (stages * m + composition_extras(s, setup->inputs, m));
    size_t feed = (s->feed_z > 0 ? m : 0u) + (composition_feed_f(s, setup->inputs) > 0 ? 1u : 0u);
    return s->method == METHOD_KALMAN ? n + stages * (column_transition_stride(m) + feed * m) : n;
}

static uint32_t composition_bytes(const struct block_setup *setup)
{
    size_t bytes = sizeof(struct composition_block) + composition_numbers(setup) * sizeof(real_t);
    return (uint32_t)((bytes + 7u) & ~(size_t)7u);
}

static NOT_INLINE struct composition_parts parts_of(struct composition_block *b)
{
    return (struct composition_parts){.settings = &b->s,
                                      .model = &b->model,
                                      .sensors = &b->sensors,
                                      .watch = &b->watch,
                                      .analyses = &b->analyses,
                                      .filter = &b->filter,
                                      .judge = &b->judge,
                                      .gains = (real_t *)(void *)(b + 1),
                                      .inputs = b->inputs,
                                      .points = b->points};
}

/* Sets pointers into the state anew, since it may have been moved since the last call. */
static void relocate(const struct composition_parts *p)
{
    size_t gains = composition_sensors_count(p->sensors) * composition_model_length(p->model);
    composition_filter_relocate(p->filter, p->gains);
    composition_model_relocate(p->model, p->gains + gains);
}

static void begin_estimate(const struct composition_parts *p)
{
    composition_model_begin(p->model);
    composition_sensors_begin(p->sensors);
    composition_watch_begin(p->watch, p->sensors);
}

/* Begins anew where the model has no solution. */
static enum err begin_after(const struct composition_parts *p, enum err err)
{
    if (err) {
        begin_estimate(p);
        composition_model_count_restart(p->model);
    }
    return err;
}

/* ---- settings ---- */

/* True: the extras mean what they meant, and are not only as many. */
static bool has_same_extras(const struct composition_settings *s,
                            const struct composition_settings *wanted, unsigned inputs)
{
    return (s->feed_z > 0) == (wanted->feed_z > 0) &&
           (composition_feed_f(s, inputs) > 0) == (composition_feed_f(wanted, inputs) > 0) &&
           (s->offset > 0) == (wanted->offset > 0);
}

static enum err composition_configure(void *state, const struct block_setup *setup, bool retune)
{
    REFLUX_ASSERT(setup->inputs <= BLOCK_INPUTS_MAX && setup->points <= BLOCK_POINTS_MAX);
    struct composition_block *b = state;
    const struct column_record *record = setup->named;
    const struct composition_settings *s = setup->settings;
    bool same = retune && b->checksum == column_record_checksum(record) && b->record == record &&
                b->s.method == s->method && b->s.covariance == s->covariance &&
                has_same_extras(&b->s, s, setup->inputs) &&
                !memcmp(b->s.place, s->place, sizeof s->place) &&
                !memcmp(b->s.role, s->role, sizeof s->role);
    if (retune && !same)
        composition_filter_end(&b->filter);
    if (!same) {
        memset(b, 0, sizeof *b);
        enum err err = composition_model_open(&b->model, record);
        if (err)
            return err;
        b->record = record;
        b->checksum = column_record_checksum(record);
    }
    b->s = *s;
    b->inputs = setup->inputs;
    b->points = setup->points;
    for (unsigned k = 0; k < BLOCK_INPUTS_MAX; k++)
        b->input[k] = (struct composition_span){setup->input[k].lo, setup->input[k].hi};
    for (unsigned k = 0; k < BLOCK_POINTS_MAX; k++)
        b->point[k] = (struct composition_span){setup->point[k].lo, setup->point[k].hi};
    composition_model_set(&b->model, setup);
    composition_sensors_set(&b->sensors, setup);
    composition_watch_set(&b->watch, setup);
    composition_analyses_set(&b->analyses, &b->model, setup, same);
    struct composition_parts p = parts_of(b);
    if (!same)
        begin_estimate(&p);
    composition_filter_retune(&b->filter, &b->s); /* a steady state is one of the settings */
    relocate(&p);
    return ERR_OK;
}

/* ---- inputs ---- */

static real_t reading_si(const struct composition_block *b, const struct block_io *io, unsigned k)
{
    REFLUX_ASSERT(k < b->inputs);
    real_t eu =
        b->input[k].lo + (b->input[k].hi - b->input[k].lo) * num_to_float(io->inputs.value[k]);
    return column_drive_factor(b->s.si[k][UNIT_FACTOR]) * eu + b->s.si[k][UNIT_ZERO];
}

/* Takes the readings t[sensors] and the inputs; an input that is missing keeps its last value. */
static void take_inputs(struct composition_block *b, const struct block_io *io, real_t *t)
{
    unsigned sensor = 0, missing = 0;
    for (unsigned k = 0; k < b->inputs; k++) {
        if (composition_is_sensor(&b->s, k)) {
            t[sensor] = reading_si(b, io, k);
            composition_sensors_put(&b->sensors, sensor++, io->inputs.quality[k] == QUALITY_GOOD);
        } else if (b->s.role[k] == IS_ANALYSIS) {
            continue;
        } else if (quality_usable((enum quality)io->inputs.quality[k])) {
            composition_model_drive(&b->model, (enum column_drive)(b->s.role[k] - IS_FEED),
                                    reading_si(b, io, k));
        } else if (!missing) {
            missing = k + 1u;
        }
    }
    composition_judge_put_missing(&b->judge, missing);
}

/* Takes the analyses after a step. Returns the number of the first input that is missed, too old or not believed, or 0. */
static unsigned step_analyses(struct composition_block *b, const struct block_io *io)
{
    unsigned odd = 0;
    bool filtered = composition_filter_takes_analyses(&b->filter);
    for (unsigned i = 0; i < composition_analyses_count(&b->analyses); i++) {
        unsigned k = composition_analyses_input(&b->analyses, i);
        const struct composition_sample sample = {.y = reading_si(b, io, k),
                                                  .age_s = (real_t)io->inputs.age_s[k],
                                                  .most = b->s.analysis_gate,
                                                  .usable = io->inputs.quality[k] == QUALITY_GOOD};
        bool poor = composition_analyses_step(&b->analyses, &b->model, i, &sample, filtered);
        bool missed = b->s.late_s > 0 && sample.age_s > b->s.late_s;
        if (!odd && (poor || missed || !sample.usable))
            odd = k + 1u;
    }
    return odd;
}

/* ---- points ---- */

/* Mole fraction of component j (from 0) on a stage, with the correction by an analysis. */
static real_t mole_fraction_at(const struct composition_block *b, size_t stage, size_t j)
{
    unsigned i = composition_analyses_find(&b->analyses, stage, j);
    real_t correction = i < ANALYSES_MAX ? composition_analyses_correction(&b->analyses, i) : ZERO;
    return real_clamp(composition_model_fraction(&b->model, stage, j) + correction, ZERO, ONE);
}

/* The same by mass: the others share the rest as they do in the model. */
static real_t mass_fraction_at(const struct composition_block *b, size_t stage, size_t j)
{
    const struct column_table *table = composition_model_table(&b->model);
    size_t n = table->config.components;
    real_t full[COLUMN_COMPONENTS_MAX], own = mole_fraction_at(b, stage, j);
    real_t rest = ONE - composition_model_fraction(&b->model, stage, j);
    real_t share = rest > ZERO ? (ONE - own) / rest : ZERO;
    for (size_t i = 0; i < n; i++)
        full[i] = i == j ? own : share * composition_model_fraction(&b->model, stage, i);
    return mass_fraction_of(table->component, n, full, j);
}

/* The feed as it is found: its flow in the unit of the table, or the fraction of a component. */
static real_t feed_estimate(const struct composition_block *b, unsigned k)
{
    const struct column_table *table = composition_model_table(&b->model);
    struct column_inputs inputs;
    composition_model_inputs(&b->model, &inputs);
    if (b->s.quantity[k] == OF_FEED_FLOW)
        return inputs.feed_flow;
    size_t j = b->s.point[k][OF_COMPONENT] - 1u;
    return b->s.basis == BASIS_MOLE ? inputs.feed_fraction[j]
                                    : mass_fraction_of(table->component, table->config.components,
                                                       inputs.feed_fraction, j);
}

static real_t stage_estimate(const struct composition_block *b, unsigned k)
{
    size_t stage = b->s.point[k][AT_STAGE] - 1u, component = b->s.point[k][OF_COMPONENT];
    if (component == 0)
        return composition_model_temperature(&b->model, stage);
    return b->s.basis == BASIS_MOLE ? mole_fraction_at(b, stage, component - 1)
                                    : mass_fraction_at(b, stage, component - 1);
}

/* A point in its own unit. */
static real_t estimate_of(const struct composition_block *b, unsigned k)
{
    REFLUX_ASSERT(k < b->points);
    real_t value = b->s.quantity[k] == OF_STAGE ? stage_estimate(b, k) : feed_estimate(b, k);
    return column_drive_factor(b->s.show[k][UNIT_FACTOR]) * value + b->s.show[k][UNIT_ZERO];
}

static void give_estimates(const struct composition_block *b, const struct composition_parts *p,
                           struct block_io *io, enum quality quality)
{
    for (unsigned k = 0; k < b->points; k++) {
        real_t span = b->point[k].hi - b->point[k].lo;
        io->points.value[k] = num_from_float((estimate_of(b, k) - b->point[k].lo) / span);
        bool unsure = quality == QUALITY_GOOD &&
                      (composition_judge_is_unsure(p, k) || composition_judge_is_unseen(p, k));
        io->points.quality[k] = (uint8_t)(unsure ? QUALITY_UNCERTAIN : quality);
    }
}

/* ---- steps ---- */

static void composition_follow(void *state, struct block_io *io)
{
    struct composition_block *b = state;
    struct composition_parts p = parts_of(b);
    (void)io;
    relocate(&p);
    composition_judge_begin(&b->judge);
    b->begun = false;
    composition_filter_begin(&b->filter);
    composition_analyses_begin(&b->analyses, &b->model, b->s.reach_s);
    if (!b->settle) /* else work is on the column */
        begin_estimate(&p);
}

/* Takes the work of the main loop before a step. False: the main loop has the model. */
static bool take_result(struct composition_block *b, const struct composition_parts *p,
                        struct block_io *io)
{
    bool settled = io->requests.work_done && b->work == WORK_SETTLE;
    if (io->requests.work_done && b->work == WORK_GAINS)
        composition_filter_take(p);
    if (!io->requests.work_wanted)
        b->work = WORK_NONE;
    composition_filter_keep(p, b->work == WORK_GAINS);
    if (settled)
        b->settle = false;
    if (!b->settle || b->work == WORK_GAINS)
        return true;
    b->work = WORK_SETTLE;
    io->requests.ask_work = 1;
    return false;
}

/* Asks for gains after a step. */
static void ask_for_gains(struct composition_block *b, const struct composition_parts *p,
                          struct block_io *io)
{
    if (io->requests.work_wanted || b->settle)
        return;
    io->requests.ask_work = composition_filter_order(p);
    if (io->requests.ask_work)
        b->work = WORK_GAINS;
}

static void composition_block_step(void *state, struct block_io *io)
{
    struct composition_block *b = state;
    struct composition_parts p = parts_of(b);
    real_t t[SENSORS_MAX];
    relocate(&p);
    if (!take_result(b, &p, io)) {
        give_estimates(b, &p, io, QUALITY_UNCERTAIN);
        return;
    }
    take_inputs(b, io, t);
    if (!b->begun) { /* the inputs before this tick are unknown */
        b->begun = true;
        enum err none = begin_after(&p, composition_model_evaluate(&b->model));
        give_estimates(b, &p, io,
                       none || !composition_judge_sees(&p) ? QUALITY_BAD : QUALITY_UNCERTAIN);
        return;
    }
    real_t watched_s = (real_t)composition_watch_steps(&b->watch) * composition_model_h(&b->model);
    enum err err = begin_after(&p, composition_sensors_step(&b->sensors, &b->model,
                                                            composition_filter_gain(&b->filter), t,
                                                            watched_s));
    if (err)
        composition_filter_begin(&b->filter);
    composition_judge_count(&p, err != ERR_OK);
    enum quality quality = composition_judge_step(&p, io, err);
    unsigned odd = composition_judge_is_settled(&p) ? step_analyses(b, io) : 0;
    composition_judge_put_analysis(&p, io, odd);
    give_estimates(b, &p, io, odd && quality == QUALITY_GOOD ? QUALITY_UNCERTAIN : quality);
    ask_for_gains(b, &p, io);
}

/* Takes one step of an hour without any temperature. */
static bool settle_piece(struct composition_block *b, const struct composition_parts *p)
{
    real_t largest;
    enum err err = begin_after(p, composition_model_settle(&b->model, SETTLE_S, &largest));
    b->settling++;
    return !err && largest > SETTLE_STILL && b->settling < SETTLE_MOST;
}

static bool composition_work(void *state)
{
    struct composition_block *b = state;
    struct composition_parts p = parts_of(b);
    relocate(&p);
    return b->work == WORK_SETTLE  ? settle_piece(b, &p)
           : b->work == WORK_GAINS ? composition_filter_work(&p)
                                   : false; /* other settings than these have asked for it */
}

static const char *composition_describe(const void *state, size_t i, float *value)
{
    struct composition_parts p = parts_of((struct composition_block *)state);
    return composition_values(&p, i, value);
}

/* ---- verbs ---- */

static const char *run_settle(void *state, const float *number)
{
    struct composition_block *b = state;
    (void)number;
    b->settle = true;
    b->settling = 0;
    composition_judge_restart(&b->judge);
    composition_filter_begin(&b->filter); /* the fit of the steady state is unknown */
    composition_watch_restart(&b->watch); /* temperatures may be far from it */
    return NULL;
}

static const char *run_begin(void *state, const float *number)
{
    (void)number;
    struct composition_block *b = state;
    struct composition_parts p = parts_of(b);
    if (b->settle) /* work is on the state */
        return "settles";
    relocate(&p);
    composition_judge_restart(&b->judge);
    composition_filter_begin(&b->filter);
    composition_filter_forget_steady(&b->filter);
    begin_estimate(&p);
    return NULL;
}

static const char *run_free(void *state, const float *number)
{
    struct composition_block *b = state;
    (void)number;
    if (!composition_is_complete(&b->s))
        return "method";
    composition_filter_decline(&b->filter);
    return NULL;
}

static const char *run_take(void *state, const float *number)
{
    struct composition_block *b = state;
    (void)number;
    return composition_is_complete(&b->s) ? composition_filter_resume(&b->filter) : "method";
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
