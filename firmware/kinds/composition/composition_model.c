/* The model of the estimator. It predicts with the linearly implicit step of model/column_implicit.h.
 *
 * The model of a linear Kalman filter is taken around the profile x0 and the inputs of the table, for which Phi = (I - h J)^-1 is
 * constant. A step of h is
 *
 *     x - x0 <- Phi (x - x0 + h (f(x0, u) + S e)),   T = T(x0) + dT/dx (x - x0)
 *
 * with the rates f at x0 for the inputs u of the step and their slopes S by what is found of the feed, e, at the table's inputs, so
 * that it is linear in what it estimates, and a tick costs no bubble points. Were e among the inputs, gains that belong to S would
 * drive it as far as the flows' limits. Folami 5.2 had such a model; the implicit step and f are ours. */
#include "kinds/composition/composition_model.h"

#include "base/assertion.h"
#include "kinds/composition/composition_model_state.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* The feed as it is found is at most this part of the given flow, and at least that. */
#define FEED_MOST  REAL_C(2.0)
#define FEED_LEAST REAL_C(0.25)
/* Standard deviations between the table's feed and the largest that is expected. */
#define FEED_EXPECTED REAL_C(3.0)

/* ---- settings ---- */

enum err composition_model_open(struct composition_model *m, const struct column_record *record)
{
    enum err err = column_record_open(record, &m->table, &m->column);
    if (err)
        return err;
    m->inputs = m->table.nominal;
    for (size_t s = 0; s < COLUMN_STAGES_MAX; s++)
        m->truncated[s] = s < m->table.config.stages && column_table_is_truncated(&m->table, s + 1);
    return ERR_OK;
}

void composition_model_set(struct composition_model *m, const struct block_setup *setup)
{
    const struct composition_settings *s = setup->settings;
    size_t fractions = m->table.config.components - 1;
    m->is_linear = s->method == METHOD_KALMAN;
    m->between = s->between;
    m->h = setup->interval_s;
    m->extras = (uint8_t)composition_extras(s, setup->inputs, fractions);
    REFLUX_ASSERT(m->extras <= COVARIANCE_EXTRAS_MAX);
    m->has_feed = m->extras && s->feed_z > 0;
    m->has_flow = m->extras && composition_feed_f(s, setup->inputs) > 0;
    m->feed = (uint8_t)((m->has_feed ? fractions : 0u) + (m->has_flow ? 1u : 0u));
}

void composition_model_point_column(const struct composition_model *m, struct column *column)
{
    column->config = &m->table.config;
    column->vle.component = m->table.config.component;
    column->vle.activity_context = m->table.config.activity_context;
}

void composition_model_relocate(struct composition_model *m, real_t *numbers)
{
    if (m->column.config != &m->table.config) {
        column_table_moved(&m->table);
        composition_model_point_column(m, &m->column);
    }
    m->linear.transition.factors = numbers;
    m->linear.push = numbers + m->table.config.stages *
                                   column_transition_stride(m->table.config.components - 1u);
}

void composition_model_begin(struct composition_model *m)
{
    const struct column_config *config = &m->table.config;
    for (size_t i = 0; i < m->column.n_fractions; i++)
        m->x[i] = m->table.profile[i];
    m->column.warm = false;
    for (size_t s = 0; s < config->stages; s++)
        m->column.temperature[s] =
            (config->temperature_min + config->temperature_max) / REAL_C(2.0);
    m->linear.h = ZERO;
    for (uint8_t k = 0; k < m->feed; k++) /* the offsets that analyses have found stay */
        m->extra[k] = ZERO;
}

void composition_model_count_restart(struct composition_model *m)
{
    if (m->restarts < UINT16_MAX)
        m->restarts++;
}

/* ---- what it has ---- */

const struct column_table *composition_model_table(const struct composition_model *m)
{
    return &m->table;
}

const struct column *composition_model_column(const struct composition_model *m)
{
    return &m->column;
}

const real_t *composition_model_x(const struct composition_model *m)
{
    return m->x;
}

real_t composition_model_fraction(const struct composition_model *m, size_t stage, size_t j)
{
    return column_fraction(&m->column, m->x, stage, j);
}

real_t composition_model_h(const struct composition_model *m)
{
    return m->h;
}

size_t composition_model_length(const struct composition_model *m)
{
    return m->column.n_fractions + m->extras;
}

size_t composition_model_feed_extras(const struct composition_model *m)
{
    return m->feed;
}

size_t composition_model_extras(const struct composition_model *m)
{
    return m->extras;
}

bool composition_model_is_flow(const struct composition_model *m, size_t k)
{
    return m->has_flow && k + 1u == m->feed;
}

bool composition_model_has_feed(const struct composition_model *m)
{
    return m->has_feed;
}

bool composition_model_has_flow(const struct composition_model *m)
{
    return m->has_flow;
}

real_t composition_model_extra(const struct composition_model *m, size_t k)
{
    REFLUX_ASSERT(k < m->extras);
    return m->extra[k];
}

real_t *composition_model_offset(struct composition_model *m, unsigned i)
{
    REFLUX_ASSERT(m->extras <= m->feed || m->feed + i < m->extras);
    return m->extras > m->feed ? &m->extra[m->feed + i] : NULL;
}

bool composition_model_expects_feed(const struct composition_model *m, real_t sd_fraction,
                                    real_t sd_flow)
{
    for (uint8_t k = 0; k < m->feed; k++)
        if (real_abs(m->extra[k]) >
            FEED_EXPECTED * (composition_model_is_flow(m, k) ? sd_flow : sd_fraction))
            return false;
    return true;
}

const char *composition_model_describe(const struct composition_model *m, size_t i, float *value)
{
    const struct column_flows *f = &m->column.flows;
    static const char *const names[COMPOSITION_MODEL_VALUES] = {"states", "clipped", "bounced",
                                                                "distillate", "bottoms"};
    const float values[COMPOSITION_MODEL_VALUES] = {(float)column_table_states(&m->table),
                                                    (float)m->clipped, (float)m->restarts,
                                                    f->distillate, f->bottoms};
    if (i >= COMPOSITION_MODEL_VALUES)
        return NULL;
    *value = values[i];
    return names[i];
}

/* ---- inputs ---- */

void composition_model_drive(struct composition_model *m, enum column_drive drive, real_t value)
{
    column_drive_take(&m->table, &m->inputs, drive, value);
}

void composition_model_inputs(const struct composition_model *m, struct column_inputs *inputs)
{
    size_t fractions = m->table.config.components - 1;
    *inputs = m->inputs;
    if (m->has_feed) {
        real_t room = ONE;
        for (size_t j = 0; j < fractions; j++) {
            inputs->feed_fraction[j] =
                real_clamp(inputs->feed_fraction[j] + m->extra[j], ZERO, room);
            room -= inputs->feed_fraction[j];
        }
        inputs->feed_fraction[fractions] = room;
    }
    if (m->has_flow)
        inputs->feed_flow *= ONE + m->extra[m->feed - 1u];
}

/* The feed's composition also changes the moles of a flow that is given by mass or volume. */
void composition_model_push(const struct composition_model *m, struct column *column,
                            const real_t *x, real_t *push, real_t *flow, real_t *work)
{
    size_t n = column->n_fractions, fractions = column->config->components - 1;
    if (!m->feed)
        return;
    bool by_flow = m->has_flow || column->inputs.feed_basis != COLUMN_FLOW_MOLAR;
    if (by_flow)
        column_feed_flow_slope(column, x, flow, work);
    for (size_t j = 0; m->has_feed && j < fractions; j++, push += n) {
        real_t moles = column_feed_moles_slope(column, j);
        column_feed_slopes(column, x, j, push);
        for (size_t i = 0; by_flow && i < n; i++)
            push[i] = real_fma(moles, flow[i], push[i]);
    }
    for (size_t i = 0; m->has_flow && i < n; i++)
        push[i] = flow[i];
}

/* ---- temperatures ---- */

void composition_model_slopes(const struct composition_model *m, size_t stage, real_t *dt,
                              real_t *dy)
{
    REFLUX_ASSERT(stage < m->table.config.stages);
    size_t n = m->table.config.components;
    const real_t *x = m->is_linear ? m->table.profile : m->x;
    real_t full[COLUMN_COMPONENTS_MAX];
    for (size_t j = 0; j < n; j++)
        full[j] = column_fraction(&m->column, x, stage, j);
    vle_full_slopes(&m->column.vle, m->column.temperature[stage], full, &m->column.k[stage * n],
                    &m->column.dk[stage * n], dt, dy);
}

real_t composition_model_temperature_before(const struct composition_model *m, size_t stage)
{
    REFLUX_ASSERT(stage < m->table.config.stages);
    real_t dt[COLUMN_COMPONENTS_MAX], dy[COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX];
    real_t t = m->column.temperature[stage];
    size_t fractions = m->table.config.components - 1;
    if (!m->is_linear || !(m->linear.h > ZERO)) /* no slopes yet */
        return t;
    composition_model_slopes(m, stage, dt, dy);
    for (size_t j = 0; j < fractions; j++)
        t += dt[j] * (m->x[stage * fractions + j] - m->table.profile[stage * fractions + j]);
    return t;
}

real_t composition_model_temperature_change(const struct composition_model *m, size_t stage,
                                            const real_t *dt)
{
    REFLUX_ASSERT(stage < m->table.config.stages);
    size_t fractions = m->table.config.components - 1;
    real_t sum = ZERO;
    for (size_t j = 0; j < fractions; j++)
        sum += dt[j] * m->blocks.change[stage * fractions + j];
    return sum;
}

real_t composition_model_temperature(const struct composition_model *m, size_t stage)
{
    REFLUX_ASSERT(stage < m->table.config.stages);
    real_t dt[COLUMN_COMPONENTS_MAX], dy[COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX];
    real_t t = composition_model_temperature_before(m, stage);
    if (m->truncated[stage] || !m->solved)
        return t;
    composition_model_slopes(m, stage, dt, dy);
    return t + composition_model_temperature_change(m, stage, dt);
}

/* ---- the linear model ---- */

static enum err linearise(struct composition_model *m)
{
    struct column_fault fault;
    enum err err = column_set_inputs(&m->column, &m->table.nominal, &fault);
    m->linear.transition.stages = m->table.config.stages;
    m->linear.transition.m = m->table.config.components - 1;
    if (!err)
        err = column_rates(&m->column, m->table.profile, m->rates);
    if (!err)
        err = column_transition_make(&m->column, m->table.profile, m->h, &m->linear.transition);
    if (!err)
        composition_model_push(m, &m->column, m->table.profile, m->linear.push, m->rates,
                               m->blocks.change);
    m->linear.h = err ? ZERO : m->h;
    return err;
}

/* Rates at the profile, with what has been found of the feed. */
static enum err linear_rates(struct composition_model *m)
{
    struct column_fault fault;
    size_t n = m->column.n_fractions;
    enum err err = real_within(m->linear.h, m->h, m->h) ? ERR_OK : linearise(m);
    if (!err)
        err = column_set_inputs(&m->column, &m->inputs, &fault);
    if (!err)
        err = column_rates_again(&m->column, m->table.profile, m->rates);
    for (size_t k = 0; !err && k < m->feed; k++)
        for (size_t i = 0; i < n; i++)
            m->rates[i] = real_fma(m->extra[k], m->linear.push[k * n + i], m->rates[i]);
    return err;
}

static void linear_step(struct composition_model *m)
{
    real_t *change = m->blocks.change;
    for (size_t i = 0; i < m->column.n_fractions; i++)
        change[i] = m->x[i] - m->table.profile[i] + m->h * m->rates[i];
    column_transition_apply(&m->linear.transition, change);
    for (size_t i = 0; i < m->column.n_fractions; i++)
        change[i] -= m->x[i] - m->table.profile[i];
}

/* ---- a step ---- */

enum err composition_model_evaluate(struct composition_model *m)
{
    struct column_fault fault;
    struct column_inputs inputs;
    m->solved = false;
    if (m->is_linear)
        return linear_rates(m);
    composition_model_inputs(m, &inputs);
    enum err err = column_set_inputs(&m->column, &inputs, &fault);
    return err ? err
               : column_truncated_rates(&m->column, m->truncated, (enum column_between)m->between,
                                        m->x, m->rates);
}

enum err composition_model_solve(struct composition_model *m, const struct column_pull *pull,
                                 size_t pulls)
{
    if (m->is_linear) {
        linear_step(m);
        return ERR_OK;
    }
    return column_implicit_step(&m->column, m->truncated, m->x, m->rates, m->h, pull, pulls,
                                &m->blocks);
}

static void take_change(struct composition_model *m, bool solved)
{
    m->solved = solved;
    m->clipped = (uint16_t)column_move(&m->column, m->x, m->blocks.change);
}

void composition_model_move(struct composition_model *m)
{
    take_change(m, true);
}

enum err composition_model_predict(struct composition_model *m)
{
    enum err err = composition_model_evaluate(m);
    if (!err)
        err = composition_model_solve(m, NULL, 0);
    if (!err)
        take_change(m, false);
    return err;
}

enum err composition_model_settle(struct composition_model *m, real_t h, real_t *largest)
{
    real_t tick = m->h;
    m->h = h;
    enum err err = composition_model_predict(m);
    m->h = tick;
    *largest = ZERO;
    for (size_t i = 0; !err && i < m->column.n_fractions; i++)
        if (real_abs(m->blocks.change[i]) > *largest)
            *largest = real_abs(m->blocks.change[i]);
    return err;
}

/* ---- what temperatures add to it ---- */

real_t composition_model_own_rate(const struct composition_model *m, size_t stage, size_t component,
                                  const real_t *dy)
{
    REFLUX_ASSERT(stage < m->table.config.stages && component + 1 < m->table.config.components);
    const struct column *column = &m->column;
    const struct column_config *config = &m->table.config;
    size_t top = config->stages - 1, fractions = config->components - 1;
    real_t in = stage == top ? ZERO : column->liquid[stage + 1];
    real_t out = column->vapour_flow[stage];
    real_t efficiency = stage == 0 ? ONE : config->efficiency;
    if (stage > 0)
        in += column->vapour_flow[stage - 1];
    if (stage + 1 == config->feed_stage)
        in += column->flows.feed;
    return (out - in - out * efficiency * dy[component * fractions + component]) /
           column->holdup[stage];
}

static size_t place_of_fraction(const struct composition_model *m, size_t stage, size_t component)
{
    return stage * (m->table.config.components - 1) + component;
}

bool composition_model_leaves_limits(const struct composition_model *m, size_t stage,
                                     size_t component)
{
    size_t place = place_of_fraction(m, stage, component);
    real_t wanted = m->x[place] + m->blocks.change[place];
    return wanted < ZERO || wanted > ONE;
}

void composition_model_add(struct composition_model *m, size_t stage, size_t component, real_t by)
{
    m->blocks.change[place_of_fraction(m, stage, component)] += by;
}

/* Keeps the feed as it is found possible: otherwise an extra would have to come all the way back. */
static void keep_feed_possible(struct composition_model *m)
{
    size_t fractions = m->table.config.components - 1;
    for (size_t j = 0; m->has_feed && j < fractions; j++)
        m->extra[j] =
            real_clamp(m->extra[j], -m->inputs.feed_fraction[j], ONE - m->inputs.feed_fraction[j]);
    if (m->has_flow)
        m->extra[m->feed - 1u] =
            real_clamp(m->extra[m->feed - 1u], FEED_LEAST - ONE, FEED_MOST - ONE);
}

static void move_extras(struct composition_model *m, const real_t *gain, real_t e)
{
    for (size_t k = 0; k < m->extras; k++)
        m->extra[k] = real_fma(gain[m->column.n_fractions + k], e, m->extra[k]);
    keep_feed_possible(m);
}

real_t composition_model_innovate(struct composition_model *m, const real_t *gain, real_t e,
                                  size_t stage, const real_t *dt)
{
    size_t n = m->column.n_fractions, fractions = m->table.config.components - 1;
    real_t drawn = ZERO;
    for (size_t i = 0; i < n; i++)
        m->blocks.change[i] = real_fma(gain[i], e, m->blocks.change[i]);
    move_extras(m, gain, e);
    for (size_t j = 0; j < fractions; j++)
        drawn += dt[j] * gain[stage * fractions + j];
    return drawn;
}

void composition_model_correct(struct composition_model *m, const real_t *gain, real_t e)
{
    real_t change[COLUMN_STATES_MAX];
    for (size_t k = 0; k < m->column.n_fractions; k++)
        change[k] = gain[k] * e;
    (void)column_move(&m->column, m->x, change);
    move_extras(m, gain, e);
}
