#include "kinds/composition/composition_job.h"

#include <string.h>

#include "base/assertion.h"
#include "kinds/composition/composition_job_state.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)
#define HOUR REAL_C(3600.0)

/* Mole fractions that get their noise in a cycle. In a large whole covariance noise for all of them costs as much as everything else. In a
 * small one all get it, because gains would come and go with the noise where trays are faster than a tick. */
#define NOISE_COUNT 8u
#define NOISE_SMALL 36u
/* The noise of a mole fraction is proportional to x (1 - x), at least as much as at this one. */
#define NOISE_PURE REAL_C(0.01)
/* Correlation time of the model's offset, s. */
#define OFFSET_S REAL_C(86400.0)
/* A steady state is there when no gain moved by more than this part of the largest in a cycle. */
#define STEADY_PART   REAL_C(1e-5)
#define STEADY_CYCLES 20000u

static void find_model(struct composition_job *job)
{
    struct column_fault fault;
    job->err = column_set_inputs(&job->column, &job->inputs, &fault);
    if (!job->err)
        job->err = column_evaluate_near(&job->column, job->x);
}

static void find_factors(struct composition_job *job)
{
    job->transition.stages = job->column.config->stages;
    job->transition.m = job->column.config->components - 1;
    job->transition.factors = job->factors;
    job->err = column_transition_make(&job->column, job->x, job->h, &job->transition);
}

/* Variance of a mole fraction where one of 1/2 has `half`. */
static real_t variance_at(real_t x, real_t half)
{
    real_t pure = NOISE_PURE * (ONE - NOISE_PURE), spread = x * (ONE - x);
    spread = (spread > pure ? spread : pure) * REAL_C(4.0);
    return half * spread * spread;
}

/* Puts what mole fractions gather in a cycle. */
static void find_noise(struct composition_job *job, const struct composition_parts *p)
{
    size_t n = job->column.n_fractions;
    size_t count = p->settings->covariance == COVARIANCE_FULL && n > NOISE_SMALL ? NOISE_COUNT : n;
    real_t time_s = job->h * (real_t)n / (real_t)count;
    real_t half = composition_sensors_model2(p->sensors) * time_s;
    for (size_t i = 0; i < n; i++)
        job->noise[i] = variance_at(job->x[i], half);
    job->step.noise = job->noise;
    job->step.noise_count = count;
    job->step.noise_first = job->noise_first;
    size_t after = job->noise_first + count;
    job->noise_first = (uint16_t)(after < n ? after : after - n);
}

static real_t sd_of_extra(const struct composition_parts *p, size_t k)
{
    return k >= composition_model_feed_extras(p->model) ? p->settings->offset
           : composition_model_is_flow(p->model, k)     ? composition_feed_f(p->settings, p->inputs)
                                                        : p->settings->feed_z;
}

static void let_extra_grow(struct composition_job *job, const struct composition_parts *p, size_t k)
{
    REFLUX_ASSERT(k < COVARIANCE_EXTRAS_MAX);
    real_t sd = sd_of_extra(p, k);
    bool is_offset = k >= composition_model_feed_extras(p->model);
    real_t keep = ONE - job->h / (is_offset ? OFFSET_S : p->settings->feed_s);
    job->keep[k] = keep > ZERO ? keep : ZERO;
    job->grown[k] = sd * sd * (ONE - job->keep[k] * job->keep[k]);
}

/* Finds how the feed moves the column, and what the extras gather. */
static void find_feed(struct composition_job *job, const struct composition_parts *p)
{
    size_t n = job->column.n_fractions;
    size_t feed = composition_model_feed_extras(p->model);
    size_t extras = composition_model_extras(p->model);
    memset(job->push + feed * n, 0, (extras - feed) * n * sizeof(real_t));
    composition_model_push(p->model, &job->column, job->x, job->push, job->rates, job->work);
    for (size_t i = 0; i < feed * n; i++)
        job->push[i] *= job->h;
    for (size_t k = 0; k < extras; k++)
        let_extra_grow(job, p, k);
    job->step.transition = &job->transition;
    job->step.extras = extras;
    job->step.push = job->push;
    job->step.keep = job->keep;
    job->step.grown = job->grown;
}

/* Before any reading, however well the model is known: standard deviation of a mole fraction of 1/2. */
#define BEGIN_SD REAL_C(0.1)

/* Before any reading: each by itself. */
static void begin_covariance(struct composition_job *job, const struct composition_parts *p)
{
    size_t n = job->column.n_fractions, m = job->transition.m;
    size_t extras = composition_model_extras(p->model);
    real_t *variance = job->noise;
    real_t known = composition_sensors_model2(p->sensors) * HOUR,
           half = known > BEGIN_SD * BEGIN_SD ? known : BEGIN_SD * BEGIN_SD;
    for (size_t i = 0; i < n; i++)
        variance[i] = variance_at(job->x[i], half);
    for (size_t k = 0; k < extras; k++)
        variance[n + k] = sd_of_extra(p, k) * sd_of_extra(p, k);
    job->err = composition_is_banded(p->settings)
                   ? covariance_band_begin(&job->covariance.band, job->transition.stages, m, extras,
                                           variance, job->memory)
                   : covariance_ud_begin(&job->covariance.ud, job->transition.stages, m, extras,
                                         variance, job->memory);
    job->begin = false;
}

static bool carry(struct composition_job *job, const struct composition_parts *p)
{
    struct covariance_ud *ud = &job->covariance.ud;
    struct covariance_band *band = &job->covariance.band;
    bool banded = composition_is_banded(p->settings);
    if (!job->carrying)
        find_noise(job, p);
    job->carrying = banded ? covariance_band_carry_piece(band, &job->step, COVARIANCE_BAND_EFFORT)
                           : covariance_ud_carry_piece(ud, &job->step, COVARIANCE_UD_EFFORT);
    if (!job->carrying)
        job->err = banded ? covariance_band_err(band) : covariance_ud_err(ud);
    return job->carrying;
}

static real_t work_in(struct composition_job *job, const struct composition_parts *p,
                      const struct covariance_measurement *z, real_t *gain)
{
    return composition_is_banded(p->settings) ? covariance_band_take(&job->covariance.band, z, gain)
                                              : covariance_ud_take(&job->covariance.ud, z, gain);
}

/* The largest gain of a cycle, and by how much one has moved since the cycle before. */
static void watch_gain(struct composition_job *job, const real_t *gain, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        real_t moved = real_abs(gain[i] - job->before[i]), size = real_abs(gain[i]);
        job->moved = moved > job->moved ? moved : job->moved;
        job->largest = size > job->largest ? size : job->largest;
    }
}

static void slopes_at(const struct composition_job *job, size_t stage, real_t *dt)
{
    REFLUX_ASSERT(stage < job->transition.stages);
    real_t full[COLUMN_COMPONENTS_MAX], dy[COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX];
    size_t c = job->transition.m + 1u;
    for (size_t j = 0; j < c; j++)
        full[j] = column_fraction(&job->column, job->x, stage, j);
    vle_full_slopes(&job->column.vle, job->column.temperature[stage], full,
                    &job->column.k[stage * c], &job->column.dk[stage * c], dt, dy);
}

static void work_in_sensor(struct composition_job *job, const struct composition_parts *p,
                           unsigned k)
{
    REFLUX_ASSERT(k < SENSORS_MAX && composition_model_length(p->model) <= COMPOSITION_LENGTH_MOST);
    size_t length = composition_model_length(p->model);
    size_t stage = composition_sensors_stage(p->sensors, k);
    real_t *gain = &job->gain[k * length];
    real_t dt[COLUMN_COMPONENTS_MAX];
    struct covariance_measurement z = {.first = stage * job->transition.m,
                                       .count = job->transition.m,
                                       .slope = dt,
                                       .extra = COVARIANCE_EXTRAS_MAX,
                                       .variance = composition_sensors_noise2(p->sensors, k)};
    if (!(job->present & 1u << k)) {
        memset(gain, 0, length * sizeof(real_t));
        return;
    }
    slopes_at(job, stage, dt);
    if (p->settings->covariance == COVARIANCE_STEADY)
        memcpy(job->before, gain, length * sizeof(real_t));
    job->spread[k] = work_in(job, p, &z, gain);
    if (p->settings->covariance == COVARIANCE_STEADY)
        watch_gain(job, gain, length);
}

/* A mole fraction of a stage, the closing one too, with the offset of its place where there is an analysis. */
static void put_fraction(const struct composition_job *job, const struct composition_parts *p,
                         size_t stage, size_t component, struct covariance_measurement *z,
                         real_t *slope)
{
    size_t m = job->transition.m;
    for (size_t j = 0; j < m; j++)
        slope[j] = component == m ? -ONE : j == component ? ONE : ZERO;
    *z = (struct covariance_measurement){.first = stage * m,
                                         .count = m,
                                         .slope = slope,
                                         .extra = COVARIANCE_EXTRAS_MAX,
                                         .extra_slope = ONE};
    for (unsigned i = 0; p->settings->offset > 0 && i < composition_analyses_count(p->analyses);
         i++)
        if (composition_analyses_is_at(p->analyses, i, stage, component))
            z->extra = composition_model_feed_extras(p->model) + i;
}

static void work_in_analysis(struct composition_job *job, const struct composition_parts *p,
                             unsigned i)
{
    REFLUX_ASSERT(i < ANALYSES_MAX && composition_sensors_count(p->sensors) <= SENSORS_MAX);
    size_t length = composition_model_length(p->model);
    real_t slope[COLUMN_COMPONENTS_MAX];
    real_t *gain = &job->gain[(composition_sensors_count(p->sensors) + i) * length];
    struct covariance_measurement z;
    if (!(job->analysed & 1u << i))
        return;
    put_fraction(job, p, composition_analyses_stage(p->analyses, i),
                 composition_analyses_component(p->analyses, i), &z, slope);
    z.variance = p->settings->analyser * p->settings->analyser + job->older[i];
    (void)work_in(job, p, &z, gain);
}

static real_t variance_of(struct composition_job *job, const struct composition_parts *p,
                          const struct covariance_measurement *z)
{
    real_t variance = composition_is_banded(p->settings)
                          ? covariance_band_of(&job->covariance.band, z)
                          : covariance_ud_of(&job->covariance.ud, z);
    return variance > ZERO ? variance : ZERO;
}

/* A point of the feed, mole fraction or part of its flow; false: no extra stands for it. */
static bool put_feed(const struct composition_job *job, const struct composition_parts *p,
                     unsigned k, struct covariance_measurement *z, real_t *slope)
{
    bool is_flow = p->settings->quantity[k] == OF_FEED_FLOW;
    for (size_t j = 0; j < job->transition.m; j++)
        slope[j] = ZERO;
    *z = (struct covariance_measurement){.first = 0,
                                         .count = job->transition.m,
                                         .slope = slope,
                                         .extra = is_flow
                                                      ? composition_model_feed_extras(p->model) - 1u
                                                      : p->settings->point[k][OF_COMPONENT] - 1u,
                                         .extra_slope = ONE};
    return is_flow ? composition_model_has_flow(p->model) : composition_model_has_feed(p->model);
}

static void find_point(struct composition_job *job, const struct composition_parts *p, unsigned k)
{
    REFLUX_ASSERT(k < p->points && k < BLOCK_POINTS_MAX);
    size_t stage = p->settings->point[k][AT_STAGE] - 1u,
           component = p->settings->point[k][OF_COMPONENT];
    real_t slope[COLUMN_COMPONENTS_MAX];
    struct covariance_measurement z;
    if (p->settings->quantity[k] != OF_STAGE) {
        bool is_found = put_feed(job, p, k, &z, slope);
        job->certainty.sd[k] = is_found ? real_sqrt(variance_of(job, p, &z)) : ZERO;
        return;
    }
    put_fraction(job, p, stage, component ? component - 1u : 0, &z, slope);
    if (!component) {
        slopes_at(job, stage, slope);
        z.extra = COVARIANCE_EXTRAS_MAX;
    }
    job->certainty.sd[k] = real_sqrt(variance_of(job, p, &z));
}

static void end_points(struct composition_job *job, const struct composition_parts *p)
{
    real_t least, most;
    if (composition_is_banded(p->settings))
        covariance_band_extremes(&job->covariance.band, &least, &most);
    else
        covariance_ud_extremes(&job->covariance.ud, &least, &most);
    job->certainty.least = real_sqrt(least > ZERO ? least : ZERO);
    job->certainty.most = real_sqrt(most);
    if (!isfinite(job->certainty.most) || !(least > ZERO))
        job->err = ERR_NOT_FINITE;
}

/* True: a steady state needs another cycle. */
static bool goes_round(struct composition_job *job, const struct composition_parts *p)
{
    if (p->settings->covariance != COVARIANCE_STEADY)
        return false;
    bool still = job->moved <= STEADY_PART * job->largest;
    job->moved = job->largest = ZERO;
    return !still && ++job->cycles < STEADY_CYCLES;
}

static void go_to_phase(struct composition_job *job, enum composition_phase phase)
{
    job->phase = (uint8_t)phase;
    job->next = 0;
}

static void do_phase(struct composition_job *job, const struct composition_parts *p)
{
    switch ((enum composition_phase)job->phase) {
    case PHASE_MODEL:
        find_model(job);
        go_to_phase(job, PHASE_FACTORS);
        break;
    case PHASE_FACTORS:
        find_factors(job);
        go_to_phase(job, PHASE_FEED);
        break;
    case PHASE_FEED:
        find_feed(job, p);
        if (job->begin)
            begin_covariance(job, p);
        go_to_phase(job, PHASE_CARRY);
        break;
    case PHASE_CARRY:
        if (!carry(job, p))
            go_to_phase(job, PHASE_SENSORS);
        break;
    case PHASE_SENSORS:
        if (job->next < composition_sensors_count(p->sensors))
            work_in_sensor(job, p, job->next++);
        else
            go_to_phase(job, goes_round(job, p) ? PHASE_CARRY : PHASE_ANALYSES);
        break;
    case PHASE_ANALYSES:
        if (job->next < composition_analyses_count(p->analyses))
            work_in_analysis(job, p, job->next++);
        else
            go_to_phase(job, PHASE_POINTS);
        break;
    case PHASE_POINTS:
        if (job->next < p->points)
            find_point(job, p, job->next++);
        else {
            end_points(job, p);
            go_to_phase(job, PHASE_DONE);
        }
        break;
    default:
        REFLUX_ASSERT(false); /* a job that is done has no piece */
        break;
    }
}

/* ---- the order ---- */

uint32_t composition_job_bytes(unsigned covariance, size_t stages, size_t m, size_t extras)
{
    size_t bytes = covariance == COVARIANCE_BAND ? covariance_band_bytes(stages, m, extras)
                                                 : covariance_ud_bytes(stages, m, extras);
    return (uint32_t)(sizeof(struct composition_job) + bytes);
}

struct composition_job *composition_job_make(void *memory, const struct composition_model *model)
{
    struct composition_job *job = memory;
    memset(job, 0, sizeof *job);
    job->column = *composition_model_column(model); /* what changes comes with the order */
    job->phase = PHASE_POINTS;                      /* there is no result */
    return job;
}

/* Bubble points as the tick has left them, a step from the state. Where the profile of the table is asked for and they are not its own,
 * they are only a beginning. */
static void put_column(const struct column *from, bool warm, struct column *column)
{
    size_t stages = from->config->stages, all = stages * from->config->components;
    memcpy(column->temperature, from->temperature, stages * sizeof(real_t));
    memcpy(column->k, from->k, all * sizeof(real_t));
    memcpy(column->dk, from->dk, all * sizeof(real_t));
    column->inputs.pressure_top = from->inputs.pressure_top;
    column->warm = from->warm && warm;
}

/* A linear model stays at the profile of the table; gains of a steady state are those of that profile. */
static void put_state(struct composition_job *job, const struct composition_parts *p)
{
    const struct column_table *table = composition_model_table(p->model);
    const struct column *column = composition_model_column(p->model);
    bool is_linear = p->settings->method == METHOD_KALMAN;
    bool at_profile = is_linear || p->settings->covariance == COVARIANCE_STEADY;
    memcpy(job->x, at_profile ? table->profile : composition_model_x(p->model),
           column->n_fractions * sizeof(real_t));
    put_column(column, is_linear || !at_profile, &job->column);
    if (at_profile)
        job->inputs = table->nominal;
    else
        composition_model_inputs(p->model, &job->inputs);
}

static void put_analyses(struct composition_job *job, const struct composition_parts *p,
                         real_t *surprise)
{
    job->analysed = 0;
    for (unsigned i = 0; i < composition_analyses_count(p->analyses); i++) {
        real_t moved;
        if (!composition_analyses_take(p->analyses, i, &surprise[i], &moved))
            continue;
        job->analysed = (uint8_t)(job->analysed | 1u << i);
        job->older[i] = moved * moved;
    }
}

bool composition_job_order(struct composition_job *job, const struct composition_parts *p,
                           uint8_t steps, bool begins, real_t *surprise, uint8_t *analysed)
{
    bool steady = p->settings->covariance == COVARIANCE_STEADY;
    if (!begins && job->phase != PHASE_DONE)
        return false; /* given up half-way: it goes on, since the covariance is half-way too */
    put_state(job, p);
    job->h = composition_model_h(p->model) * (steady ? REAL_C(1.0) : (real_t)steps);
    job->present = composition_sensors_present(p->sensors, steady);
    put_analyses(job, p, surprise);
    *analysed = job->analysed;
    job->begin = begins;
    job->phase = PHASE_MODEL;
    job->next = 0;
    job->cycles = 0;
    job->err = ERR_OK;
    job->carrying = false;
    return true;
}

bool composition_job_piece(struct composition_job *job, const struct composition_parts *p)
{
    if (job->phase == PHASE_DONE)
        return false;
    composition_model_point_column(p->model, &job->column); /* the state may have been moved */
    do_phase(job, p);
    if (job->err)
        job->phase = PHASE_DONE;
    return job->phase != PHASE_DONE;
}

/* ---- the result ---- */

bool composition_job_is_done(const struct composition_job *job)
{
    return job->phase == PHASE_DONE;
}

enum err composition_job_err(const struct composition_job *job)
{
    return job->err;
}

const real_t *composition_job_gains(const struct composition_job *job)
{
    return job->gain;
}

const real_t *composition_job_spread(const struct composition_job *job)
{
    return job->spread;
}

const struct composition_certainty *composition_job_certainty(const struct composition_job *job)
{
    return &job->certainty;
}
