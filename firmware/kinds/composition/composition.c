/* Geometric estimator with partial innovation, Frau (7.1), and reduced EKF, (7.6), on one step of the model.
 *
 * Both predict with the linearly implicit step of model/column_implicit.h. The geometric estimator puts its innovation into that step:
 *
 *     dx_mu/dt = f + (1/b_mu) (Kp e + Ki z),  dz/dt = e,  b = dT/dx
 *
 * with e at the end of the step, e - sum_j b_j d_j, and z likewise: (Kp + h Ki) on e and Ki z besides, stable for any h. The reduced
 * EKF has a variance P of each mole fraction that is moved:
 *
 *     P <- P exp(2 F h) + Q (exp(2 F h) - 1)/(2 F);  K = P b / (b P b + R);  x_mu <- x_mu + K e;  P <- (1 - K b) P = P R / (b P b + R)
 *
 * F: the rate's derivative by this mole fraction, flows held. */
#include "kinds/composition/composition.h"

#include "num/real.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* Ki z moves a temperature no faster than so many kelvin in 1/lambda. */
#define PULL_MOST_K REAL_C(100.0)

void composition_begin(struct composition *c)
{
    const struct column_config *config = &c->table.config;
    for (size_t i = 0; i < c->column.n_fractions; i++)
        c->x[i] = c->table.profile[i];
    c->column.warm = false;
    for (size_t s = 0; s < config->stages; s++)
        c->column.temperature[s] =
            (config->temperature_min + config->temperature_max) / REAL_C(2.0);
    c->watched = 0;
    c->linear.h = ZERO;
    for (uint8_t k = 0; k < c->gains.feed; k++) /* what analyses said of the model stays */
        c->gains.extra[k] = ZERO;
    for (uint8_t k = 0; k < c->sensors; k++) {
        struct composition_sensor *s = &c->sensor[k];
        s->sum = s->pull = s->square = s->product = s->last = s->e = s->correction = ZERO;
        s->variance = c->model2 * REAL_C(3600.0);
        s->outside = 0;
    }
}

/* ---- slopes ---- */

void composition_slopes(const struct composition *c, size_t stage, real_t *dt, real_t *dy)
{
    size_t n = c->table.config.components;
    const real_t *x = c->method == METHOD_KALMAN ? c->table.profile : c->x;
    real_t full[COLUMN_COMPONENTS_MAX];
    for (size_t j = 0; j < n; j++)
        full[j] = column_fraction(&c->column, x, stage, j);
    vle_full_slopes(&c->column.vle, c->column.temperature[stage], full, &c->column.k[stage * n],
                    &c->column.dk[stage * n], dt, dy);
}

/* By how much the step moves the temperature of a stage that is not truncated. */
static real_t step_moves(const struct composition *c, size_t stage, const real_t *dt)
{
    size_t m = c->table.config.components - 1;
    real_t sum = ZERO;
    for (size_t j = 0; j < m; j++)
        sum += dt[j] * c->blocks.change[stage * m + j];
    return sum;
}

real_t composition_temperature(const struct composition *c, size_t stage)
{
    real_t dt[COLUMN_COMPONENTS_MAX], dy[COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX];
    real_t t = composition_temperature_before(c, stage);
    if (c->truncated[stage] || !c->solved)
        return t;
    composition_slopes(c, stage, dt, dy);
    return t + step_moves(c, stage, dt);
}

/* ---- innovation ---- */

/* Whether another temperature of its section agrees with the estimate. */
static bool is_contradicted(const struct composition *c, const struct composition_sensor *s)
{
    for (uint8_t k = 0; k < c->sensors; k++) {
        const struct composition_sensor *other = &c->sensor[k];
        if (other != s && composition_draws(other) && !composition_is_far(c, other) &&
            composition_is_above_feed(c, other) == composition_is_above_feed(c, s))
            return true;
    }
    return false;
}

/* What is far from the estimate is not believed, once the estimate has had time to find it: for a while, or for as long as another
 * temperature of the section agrees with the estimate. */
static bool is_outside(const struct composition *c, struct composition_sensor *s)
{
    bool found = (real_t)c->watched * c->h > s->time;
    if (!found || !composition_is_far(c, s)) {
        s->outside = 0;
        return false;
    }
    if (s->outside < c->gate_steps)
        s->outside++;
    else if (!is_contradicted(c, s))
        return false;
    return true;
}

static real_t decayed_part(real_t rate, real_t h)
{
    real_t part = rate * h;
    return part < ONE ? part : ONE;
}

/* Deviations before the step. What is not there for a while is forgotten as fast as it was learned. */
static void take_readings(struct composition *c, const real_t *t)
{
    bool outside[SENSORS_MAX];
    for (uint8_t k = 0; k < c->sensors; k++)
        if (c->sensor[k].there)
            c->sensor[k].e = t[k] - composition_temperature_before(c, c->sensor[k].stage);
    for (uint8_t k = 0; k < c->sensors; k++)
        outside[k] = c->sensor[k].there && is_outside(c, &c->sensor[k]);
    for (uint8_t k = 0; k < c->sensors; k++) {
        struct composition_sensor *s = &c->sensor[k];
        s->there = s->there && !outside[k];
        if (!s->there && s->moves)
            s->sum -= s->sum * decayed_part(s->ki / s->kp, c->h);
    }
}

static size_t pulls_of(const struct composition *c, struct column_pull *pull)
{
    size_t n = 0;
    for (uint8_t k = 0; k < c->sensors; k++) {
        const struct composition_sensor *s = &c->sensor[k];
        if (c->method == METHOD_GEOMETRIC && composition_draws(s))
            pull[n++] = (struct column_pull){.stage = s->stage,
                                             .component = s->component,
                                             .deviation = s->e,
                                             .gain = s->kp + c->h * s->ki,
                                             .rate = s->ki * s->sum};
    }
    return n;
}

/* Whether the step takes the mole fraction past its limits: then the integral has nothing to do. */
static bool leaves_limits(const struct composition *c, const struct composition_sensor *s)
{
    size_t at = s->stage * (c->table.config.components - 1) + s->component;
    real_t wanted = c->x[at] + c->blocks.change[at];
    return wanted < ZERO || wanted > ONE;
}

/* z, by what is left of the deviation at the end of the step. */
static void integrate(const struct composition *c, struct composition_sensor *s, real_t moved)
{
    real_t most = PULL_MOST_K / (s->time * s->ki), left = s->e - moved;
    s->correction = (s->kp + c->h * s->ki) * left + s->ki * s->sum;
    if (leaves_limits(c, s) && left * s->sum > ZERO)
        return;
    s->sum += c->h * left;
    if (s->sum > most)
        s->sum = most;
    if (s->sum < -most)
        s->sum = -most;
}

/* d(dx/dt)/dx of the mole fraction that the sensor moves, with flows and the vapour from below held. */
static real_t own_rate(const struct composition *c, const struct composition_sensor *s,
                       const real_t *dy)
{
    const struct column *column = &c->column;
    const struct column_config *config = &c->table.config;
    size_t top = config->stages - 1, at = s->stage, m = config->components - 1;
    real_t in = at == top ? ZERO : column->liquid[at + 1];
    real_t out = column->vapour_flow[at];
    real_t efficiency = at == 0 ? ONE : config->efficiency;
    if (at > 0)
        in += column->vapour_flow[at - 1];
    if (at + 1 == config->feed_stage)
        in += column->flows.feed;
    return (out - in - out * efficiency * dy[s->component * m + s->component]) / column->holdup[at];
}

/* (7.6) */
static void filter(struct composition *c, struct composition_sensor *s, const real_t *dt,
                   const real_t *dy, real_t moved)
{
    size_t m = c->table.config.components - 1;
    real_t rate = own_rate(c, s, dy), b = dt[s->component], grown;
    if (real_abs(rate) * c->h > REAL_C(1e-3)) {
        real_t part = real_exp(REAL_C(2.0) * rate * c->h);
        grown = c->model2 * (part - ONE) / (REAL_C(2.0) * rate);
        s->variance = part * s->variance + grown;
    } else {
        s->variance += c->h * (REAL_C(2.0) * rate * s->variance + c->model2);
    }
    s->spread = b * s->variance * b + s->noise2;
    if (!composition_draws(s))
        return;
    s->e -= moved; /* the reading belongs to the end of the step */
    real_t gain = s->variance * b / s->spread;
    c->blocks.change[s->stage * m + s->component] += gain * s->e;
    s->correction = b * gain * s->e / c->h;
    s->variance *= s->noise2 / s->spread; /* rounding leaves it above 0 */
}

/* What the step means for the sensors, and of the reduced EKF what the sensors mean for the step. */
static void take_step(struct composition *c)
{
    real_t dt[COLUMN_COMPONENTS_MAX], dy[COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX];
    for (uint8_t k = 0; k < c->sensors; k++) {
        struct composition_sensor *s = &c->sensor[k];
        composition_slopes(c, s->stage, dt, dy);
        real_t moved = step_moves(c, s->stage, dt);
        s->slope = dt[s->component];
        if (c->gains.of && composition_draws(s)) {
            s->e -= moved;
            composition_innovate(c, s, k, dt);
        } else if (c->method != METHOD_GEOMETRIC && s->moves && !c->gains.of)
            filter(c, s, dt, dy, moved);
        else if (c->method == METHOD_GEOMETRIC && composition_draws(s))
            integrate(c, s, moved);
    }
}

/* From x over c->h, drawn by pull[pulls], into c->blocks. */
static enum err solve_step(struct composition *c, const struct column_pull *pull, size_t pulls)
{
    if (c->method == METHOD_KALMAN) {
        composition_linear_step(c);
        return ERR_OK;
    }
    return column_implicit_step(&c->column, c->truncated, c->x, c->rates, c->h, pull, pulls,
                                &c->blocks);
}

static enum err evaluate_model_at(struct composition *c)
{
    struct column_fault fault;
    struct column_inputs inputs;
    if (c->method == METHOD_KALMAN)
        return composition_linear_rates(c);
    composition_inputs(c, &inputs);
    enum err err = column_set_inputs(&c->column, &inputs, &fault);
    return err ? err
               : column_truncated_rates(&c->column, c->truncated, (enum column_between)c->between,
                                        c->x, c->rates);
}

static enum err begin_anew(struct composition *c, enum err why)
{
    composition_begin(c);
    if (c->bounced < UINT16_MAX)
        c->bounced++;
    return why;
}

enum err composition_evaluate(struct composition *c)
{
    c->solved = false;
    enum err err = evaluate_model_at(c);
    return err ? begin_anew(c, err) : ERR_OK;
}

enum err composition_predict(struct composition *c)
{
    c->solved = false;
    enum err err = evaluate_model_at(c);
    if (!err)
        err = solve_step(c, NULL, 0);
    if (err)
        return begin_anew(c, err);
    c->clipped = (uint16_t)column_move(&c->column, c->x, c->blocks.change);
    return ERR_OK;
}

enum err composition_step(struct composition *c, const real_t *t)
{
    struct column_pull pull[SENSORS_MAX];
    c->solved = false;
    enum err err = evaluate_model_at(c);
    if (!err) {
        take_readings(c, t);
        size_t pulls = pulls_of(c, pull);
        err = solve_step(c, pull, pulls);
    }
    if (err)
        return begin_anew(c, err);
    take_step(c);
    c->solved = true;
    c->clipped = (uint16_t)column_move(&c->column, c->x, c->blocks.change);
    return ERR_OK;
}
