/* Geometric estimator with partial innovation, Frau (7.1), reduced EKF, (7.6), and complete innovation, (7.5), on one step of the model.
 *
 * The geometric estimator puts its innovation into the step:
 *
 *     dx_mu/dt = f + (1/b_mu) (Kp e + Ki z),  dz/dt = e,  b = dT/dx
 *
 * with e at the end of the step, e - sum_j b_j d_j, and z likewise: (Kp + h Ki) on e and Ki z besides, stable for any h. The reduced
 * EKF has a variance P of each mole fraction that is moved:
 *
 *     P <- P exp(2 F h) + Q (exp(2 F h) - 1)/(2 F);  K = P b / (b P b + R);  x_mu <- x_mu + K e;  P <- (1 - K b) P = P R / (b P b + R)
 *
 * F: the rate's derivative by this mole fraction, flows held. With complete innovation a temperature moves every mole fraction and
 * what nobody measures of the feed, by gains that are computed from their covariance (kinds/composition/composition_job.c), scalar by
 * scalar: each deviation is taken after the ones before it have moved the estimate. */
#include "kinds/composition/composition_sensors.h"

#include "base/assertion.h"
#include "kinds/composition/composition_sensors_state.h"
#include "num/real.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)
#define HOUR REAL_C(3600.0)

/* Most that Ki z moves a temperature in 1/lambda, K. */
#define PULL_MOST_K REAL_C(100.0)
/* The least noise that is found of a reading, K2. */
#define NOISE_LEAST2 REAL_C(0.0025)

/* Values where none are given: lambda 10 1/h and zeta 3, Frau 2.4, docs/methods/composition-estimation.md. */
#define LAMBDA_INITIAL REAL_C(10.0)
#define ZETA_INITIAL   REAL_C(3.0)
/* noise and model, docs/methods/kalman.md, docs/methods/composition-estimation.md. */
#define NOISE_INITIAL REAL_C(0.2)
#define MODEL_INITIAL REAL_C(0.1)
#define MODEL_TRUSTED REAL_C(0.011)

/* ---- settings ---- */

static void set_sensor(struct composition_sensors *all, const struct composition_record *r,
                       unsigned k)
{
    REFLUX_ASSERT(all->n < SENSORS_MAX);
    const struct composition_settings *s = &r->s;
    struct composition_sensor *o = &all->sensor[all->n++]; /* its past stays */
    real_t lambda = r->tune[k][TUNE_LAMBDA] > 0 ? r->tune[k][TUNE_LAMBDA] : LAMBDA_INITIAL;
    real_t zeta = r->tune[k][TUNE_ZETA] > 0 ? r->tune[k][TUNE_ZETA] : ZETA_INITIAL;
    lambda /= HOUR;
    o->input = (uint8_t)k;
    o->stage = (uint8_t)(s->place[k][AT_STAGE] - 1u);
    o->moves = s->place[k][OF_COMPONENT] > 0;
    o->component = (uint8_t)(o->moves ? s->place[k][OF_COMPONENT] - 1u : 0u);
    if (r->noise > 0)
        o->noise2 = r->noise * r->noise;
    else if (!all->finds_noise)
        o->noise2 = NOISE_INITIAL * NOISE_INITIAL;
    else if (o->noise2 < NOISE_LEAST2)
        o->noise2 = NOISE_LEAST2;
    o->time = REAL_C(1.0) / lambda;
    o->kp = REAL_C(2.0) * zeta * lambda;
    real_t ki = s->method == METHOD_GEOMETRIC ? lambda * lambda : REAL_C(0.0);
    if (ki > 0 && o->ki > 0) /* keeps what the integral draws */
        o->sum *= o->ki / ki;
    o->ki = ki;
}

void composition_sensors_set(struct composition_sensors *all, const struct block_setup *setup)
{
    const struct composition_record *r = setup->settings;
    const struct composition_settings *s = &r->s;
    bool trusted = composition_follows_model(s);
    all->n = 0;
    all->finds_noise = trusted && !(r->noise > 0);
    for (unsigned k = 0; k < setup->inputs; k++)
        if (composition_is_sensor(s, k))
            set_sensor(all, r, k);
    all->method = s->method;
    real_t model = r->model > 0 ? r->model : trusted ? MODEL_TRUSTED : MODEL_INITIAL;
    all->model2 = model * model / HOUR;
    all->gate = r->gate;
    all->gate_steps = (uint32_t)(r->gate_s / setup->interval_s);
}

void composition_sensors_begin(struct composition_sensors *all)
{
    for (uint8_t k = 0; k < all->n; k++) {
        struct composition_sensor *s = &all->sensor[k];
        s->sum = s->e = s->correction = ZERO;
        s->variance = all->model2 * HOUR;
        s->outside = 0;
    }
}

void composition_sensors_put(struct composition_sensors *all, unsigned k, bool present)
{
    REFLUX_ASSERT(k < all->n);
    all->sensor[k].present = present;
}

/* ---- each of them ---- */

static bool draws(const struct composition_sensor *s)
{
    return s->moves && s->present;
}

static bool sits_above(const struct composition_sensor *s, size_t feed_stage)
{
    return s->stage + 1u > feed_stage;
}

/* The reading is outside the gate. */
static bool is_far(const struct composition_sensors *all, const struct composition_sensor *s)
{
    return all->gate > REAL_C(0.0) && real_abs(s->e) > all->gate;
}

unsigned composition_sensors_count(const struct composition_sensors *all)
{
    return all->n;
}

unsigned composition_sensors_input(const struct composition_sensors *all, unsigned k)
{
    REFLUX_ASSERT(k < all->n);
    return all->sensor[k].input + 1u;
}

size_t composition_sensors_stage(const struct composition_sensors *all, unsigned k)
{
    REFLUX_ASSERT(k < all->n);
    return all->sensor[k].stage;
}

real_t composition_sensors_noise2(const struct composition_sensors *all, unsigned k)
{
    REFLUX_ASSERT(k < all->n);
    return all->sensor[k].noise2;
}

real_t composition_sensors_model2(const struct composition_sensors *all)
{
    return all->model2;
}

bool composition_sensors_draws(const struct composition_sensors *all, unsigned k)
{
    REFLUX_ASSERT(k < all->n);
    return draws(&all->sensor[k]);
}

bool composition_sensors_draws_in(const struct composition_sensors *all, unsigned k,
                                  size_t feed_stage, bool above)
{
    REFLUX_ASSERT(k < all->n);
    return draws(&all->sensor[k]) && sits_above(&all->sensor[k], feed_stage) == above;
}

bool composition_sensors_innovation(const struct composition_sensors *all, unsigned k,
                                    struct composition_innovation *innovation)
{
    REFLUX_ASSERT(k < all->n);
    const struct composition_sensor *s = &all->sensor[k];
    bool filters = all->method != METHOD_GEOMETRIC && s->moves && s->spread > ZERO;
    *innovation =
        (struct composition_innovation){s->e, filters ? s->spread : s->noise2, s->correction};
    return s->present;
}

void composition_sensors_find_noise(struct composition_sensors *all, unsigned k, real_t noise2)
{
    REFLUX_ASSERT(k < all->n);
    if (all->finds_noise)
        all->sensor[k].noise2 = noise2 < NOISE_LEAST2 ? NOISE_LEAST2 : noise2;
}

bool composition_sensors_finds_noise(const struct composition_sensors *all)
{
    return all->finds_noise;
}

real_t composition_sensors_e(const struct composition_sensors *all, unsigned k)
{
    REFLUX_ASSERT(k < all->n);
    return all->sensor[k].e;
}

real_t composition_sensors_slope(const struct composition_sensors *all, unsigned k)
{
    REFLUX_ASSERT(k < all->n);
    return all->sensor[k].slope;
}

/* ---- all of them ---- */

real_t composition_sensors_slowest(const struct composition_sensors *all)
{
    real_t slowest = ZERO;
    for (uint8_t k = 0; k < all->n; k++) {
        const struct composition_sensor *s = &all->sensor[k];
        if (s->moves && s->time > slowest)
            slowest = s->time;
    }
    return slowest;
}

unsigned composition_sensors_lost(const struct composition_sensors *all)
{
    for (uint8_t k = 0; k < all->n; k++)
        if (all->sensor[k].moves && !all->sensor[k].present)
            return all->sensor[k].input + 1u;
    return 0;
}

bool composition_sensors_any_draws(const struct composition_sensors *all)
{
    bool drawn = false;
    for (uint8_t k = 0; k < all->n; k++)
        drawn = drawn || draws(&all->sensor[k]);
    return drawn;
}

bool composition_sensors_use_outside(const struct composition_sensors *all)
{
    for (uint8_t k = 0; k < all->n; k++) {
        const struct composition_sensor *s = &all->sensor[k];
        if (draws(s) && is_far(all, s))
            return true;
    }
    return false;
}

bool composition_sensors_lost_section(const struct composition_sensors *all, size_t feed_stage)
{
    bool has[2] = {false, false}, sees[2] = {false, false};
    for (uint8_t k = 0; k < all->n; k++) {
        const struct composition_sensor *s = &all->sensor[k];
        unsigned above = sits_above(s, feed_stage);
        has[above] = has[above] || s->moves;
        sees[above] = sees[above] || draws(s);
    }
    return (has[0] && !sees[0]) || (has[1] && !sees[1]);
}

bool composition_sensors_in_section(const struct composition_sensors *all, size_t feed_stage,
                                    bool above)
{
    for (uint8_t i = 0; i < all->n; i++)
        if (all->sensor[i].moves && sits_above(&all->sensor[i], feed_stage) == above)
            return true;
    return false;
}

uint16_t composition_sensors_present(const struct composition_sensors *all, bool always)
{
    uint16_t present = 0;
    for (uint8_t k = 0; k < all->n; k++)
        if (all->sensor[k].moves && (always || all->sensor[k].present))
            present = (uint16_t)(present | 1u << k);
    return present;
}

void composition_sensors_take_spread(struct composition_sensors *all, const real_t *spread)
{
    for (uint8_t k = 0; k < all->n; k++)
        all->sensor[k].spread = spread[k];
}

/* ---- readings ---- */

/* True: another temperature of the section agrees with the estimate. */
static bool is_contradicted(const struct composition_sensors *all,
                            const struct composition_sensor *s, size_t feed_stage)
{
    for (uint8_t k = 0; k < all->n; k++) {
        const struct composition_sensor *other = &all->sensor[k];
        if (other != s && draws(other) && !is_far(all, other) &&
            sits_above(other, feed_stage) == sits_above(s, feed_stage))
            return true;
    }
    return false;
}

/* A reading outside the gate waits, once the estimate has had time to find it: for a while, or for as long as another temperature of
 * the section agrees with the estimate. */
static bool is_outside(const struct composition_sensors *all, struct composition_sensor *s,
                       size_t feed_stage, real_t watched_s)
{
    bool found = watched_s > s->time;
    if (!found || !is_far(all, s)) {
        s->outside = 0;
        return false;
    }
    if (s->outside < all->gate_steps)
        s->outside++;
    else if (!is_contradicted(all, s, feed_stage))
        return false;
    return true;
}

static real_t decayed_part(real_t rate, real_t h)
{
    real_t part = rate * h;
    return part < ONE ? part : ONE;
}

/* Deviations before the step. The integral of a sensor that is lost decays as fast as it was learned. */
static void take_readings(struct composition_sensors *all, const struct composition_model *model,
                          const real_t *t, real_t watched_s)
{
    size_t feed_stage = composition_model_table(model)->config.feed_stage;
    bool outside[SENSORS_MAX];
    for (uint8_t k = 0; k < all->n; k++)
        if (all->sensor[k].present)
            all->sensor[k].e =
                t[k] - composition_model_temperature_before(model, all->sensor[k].stage);
    for (uint8_t k = 0; k < all->n; k++)
        outside[k] =
            all->sensor[k].present && is_outside(all, &all->sensor[k], feed_stage, watched_s);
    for (uint8_t k = 0; k < all->n; k++) {
        struct composition_sensor *s = &all->sensor[k];
        s->present = s->present && !outside[k];
        if (!s->present && s->moves)
            s->sum -= s->sum * decayed_part(s->ki / s->kp, composition_model_h(model));
    }
}

/* ---- innovation ---- */

static size_t put_pulls(const struct composition_sensors *all, real_t h, struct column_pull *pull)
{
    size_t n = 0;
    for (uint8_t k = 0; k < all->n; k++) {
        const struct composition_sensor *s = &all->sensor[k];
        if (all->method == METHOD_GEOMETRIC && draws(s))
            pull[n++] = (struct column_pull){.stage = s->stage,
                                             .component = s->component,
                                             .deviation = s->e,
                                             .gain = s->kp + h * s->ki,
                                             .rate = s->ki * s->sum};
    }
    return n;
}

/* z, by what the step leaves of the deviation. A step past the limits of the mole fraction leaves the integral alone. */
static void integrate(struct composition_sensor *s, const struct composition_model *model,
                      real_t moved)
{
    real_t most = PULL_MOST_K / (s->time * s->ki), left = s->e - moved;
    real_t h = composition_model_h(model);
    s->correction = (s->kp + h * s->ki) * left + s->ki * s->sum;
    if (composition_model_leaves_limits(model, s->stage, s->component) && left * s->sum > ZERO)
        return;
    s->sum += h * left;
    if (s->sum > most)
        s->sum = most;
    if (s->sum < -most)
        s->sum = -most;
}

/* (7.6) */
static void filter(const struct composition_sensors *all, struct composition_sensor *s,
                   struct composition_model *model, const real_t *dt, const real_t *dy,
                   real_t moved)
{
    real_t h = composition_model_h(model);
    real_t rate = composition_model_own_rate(model, s->stage, s->component, dy);
    real_t b = dt[s->component], grown;
    if (real_abs(rate) * h > REAL_C(1e-3)) {
        real_t part = real_exp(REAL_C(2.0) * rate * h);
        grown = all->model2 * (part - ONE) / (REAL_C(2.0) * rate);
        s->variance = part * s->variance + grown;
    } else {
        s->variance += h * (REAL_C(2.0) * rate * s->variance + all->model2);
    }
    s->spread = b * s->variance * b + s->noise2;
    if (!draws(s))
        return;
    s->e -= moved; /* the reading belongs to the end of the step */
    real_t gain = s->variance * b / s->spread;
    composition_model_add(model, s->stage, s->component, gain * s->e);
    s->correction = b * gain * s->e / h;
    s->variance *= s->noise2 / s->spread; /* rounding leaves it above 0 */
}

/* Moves the sensors by the step, and with an EKF the step by the sensors. */
static void take_step(struct composition_sensors *all, struct composition_model *model,
                      const real_t *gain)
{
    real_t dt[COLUMN_COMPONENTS_MAX], dy[COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX];
    for (uint8_t k = 0; k < all->n; k++) {
        struct composition_sensor *s = &all->sensor[k];
        composition_model_slopes(model, s->stage, dt, dy);
        real_t moved = composition_model_temperature_change(model, s->stage, dt);
        s->slope = dt[s->component];
        if (gain && draws(s)) {
            s->e -= moved;
            real_t drawn = composition_model_innovate(
                model, gain + k * composition_model_length(model), s->e, s->stage, dt);
            s->correction = drawn * s->e / composition_model_h(model);
        } else if (all->method != METHOD_GEOMETRIC && s->moves && !gain)
            filter(all, s, model, dt, dy, moved);
        else if (all->method == METHOD_GEOMETRIC && draws(s))
            integrate(s, model, moved);
    }
}

enum err composition_sensors_step(struct composition_sensors *all, struct composition_model *model,
                                  const real_t *gain, const real_t *t, real_t watched_s)
{
    struct column_pull pull[SENSORS_MAX];
    enum err err = composition_model_evaluate(model);
    if (!err) {
        take_readings(all, model, t, watched_s);
        size_t pulls = put_pulls(all, composition_model_h(model), pull);
        err = composition_model_solve(model, pull, pulls);
    }
    if (err)
        return err;
    take_step(all, model, gain);
    composition_model_move(model);
    return ERR_OK;
}
