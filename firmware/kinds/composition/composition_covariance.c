/* Pieces of the job that finds gains: the model at the estimate, its factors, what the feed does, the covariance over a cycle, temperatures,
 * analyses, and how sure the points are. */
#include <string.h>

#include "kinds/composition/composition_covariance.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)
#define HOUR REAL_C(3600.0)

/* Mole fractions that get their noise in a cycle: of a large whole covariance it costs as much as all the rest if all get it. Of a small
 * one all do: where trays are faster than a tick, gains would come and go with the noise. */
#define NOISE_COUNT 8u
#define NOISE_SMALL 36u
/* What a mole fraction gathers is proportional to x (1 - x), at least as much as at this one. */
#define NOISE_PURE REAL_C(0.01)
/* An offset of the model changes in so many seconds. */
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
    job->transition.of = job->factors;
    job->err = column_transition_make(&job->column, job->x, job->h, &job->transition);
}

/* Variance of a mole fraction where one of 1/2 has `half`. */
static real_t variance_at(real_t x, real_t half)
{
    real_t pure = NOISE_PURE * (ONE - NOISE_PURE), spread = x * (ONE - x);
    spread = (spread > pure ? spread : pure) * REAL_C(4.0);
    return half * spread * spread;
}

/* What a mole fraction gathers in a cycle. */
static void find_noise(const struct composition_block *b, struct composition_job *job)
{
    size_t n = job->column.n_fractions;
    size_t count = b->s.covariance == COVARIANCE_FULL && n > NOISE_SMALL ? NOISE_COUNT : n;
    real_t time_s = job->h * (real_t)n / (real_t)count;
    for (size_t i = 0; i < n; i++)
        job->noise[i] = variance_at(job->x[i], b->c.model2 * time_s);
    job->step.noise = job->noise;
    job->step.noise_count = count;
    job->step.noise_first = job->noise_first;
    size_t after = job->noise_first + count;
    job->noise_first = (uint16_t)(after < n ? after : after - n);
}

static real_t sd_of_extra(const struct composition_block *b, size_t k)
{
    const struct composition_gains *g = &b->c.gains;
    bool is_flow = g->has_flow && k + 1u == g->feed;
    return k >= g->feed ? b->s.offset
           : is_flow    ? composition_feed_f(&b->s, b->inputs)
                        : b->s.feed_z;
}

static void let_extra_grow(const struct composition_block *b, struct composition_job *job, size_t k)
{
    real_t sd = sd_of_extra(b, k);
    real_t keep = ONE - job->h / (k >= b->c.gains.feed ? OFFSET_S : b->s.feed_s);
    job->keep[k] = keep > ZERO ? keep : ZERO;
    job->grown[k] = sd * sd * (ONE - job->keep[k] * job->keep[k]);
}

/* How the feed moves the column, and what the extras gather. */
static void find_feed(const struct composition_block *b, struct composition_job *job)
{
    const struct composition_gains *g = &b->c.gains;
    size_t n = job->column.n_fractions;
    memset(job->push + g->feed * n, 0, (g->extras - g->feed) * n * sizeof(real_t));
    composition_push(g, &job->column, job->x, job->push, job->rates, job->work);
    for (size_t i = 0; i < g->feed * n; i++)
        job->push[i] *= job->h;
    for (size_t k = 0; k < g->extras; k++)
        let_extra_grow(b, job, k);
    job->step.transition = &job->transition;
    job->step.extras = g->extras;
    job->step.push = job->push;
    job->step.keep = job->keep;
    job->step.grown = job->grown;
}

/* Before any reading, however well the model is known: standard deviation of a mole fraction of 1/2. */
#define BEGIN_SD REAL_C(0.1)

/* Before any reading: each by itself. */
static void begin_covariance(const struct composition_block *b, struct composition_job *job)
{
    const struct composition_gains *g = &b->c.gains;
    size_t n = job->column.n_fractions, m = job->transition.m;
    real_t *variance = job->noise;
    real_t known = b->c.model2 * HOUR,
           half = known > BEGIN_SD * BEGIN_SD ? known : BEGIN_SD * BEGIN_SD;
    for (size_t i = 0; i < n; i++)
        variance[i] = variance_at(job->x[i], half);
    for (size_t k = 0; k < g->extras; k++)
        variance[n + k] = sd_of_extra(b, k) * sd_of_extra(b, k);
    job->err = composition_is_banded(&b->s)
                   ? covariance_band_begin(&job->covariance.band, job->transition.stages, m,
                                           g->extras, variance, job->memory)
                   : covariance_ud_begin(&job->covariance.ud, job->transition.stages, m, g->extras,
                                         variance, job->memory);
    job->begin = false;
}

static bool carry(const struct composition_block *b, struct composition_job *job)
{
    struct covariance_ud *ud = &job->covariance.ud;
    struct covariance_band *band = &job->covariance.band;
    bool banded = composition_is_banded(&b->s);
    if (!job->carrying)
        find_noise(b, job);
    job->carrying = banded ? covariance_band_carry_piece(band, &job->step, COVARIANCE_BAND_EFFORT)
                           : covariance_ud_carry_piece(ud, &job->step, COVARIANCE_UD_EFFORT);
    if (!job->carrying)
        job->err = banded ? band->err : ud->err;
    return job->carrying;
}

static real_t work_in(const struct composition_block *b, struct composition_job *job,
                      const struct covariance_measurement *z, real_t *gain)
{
    return composition_is_banded(&b->s) ? covariance_band_take(&job->covariance.band, z, gain)
                                        : covariance_ud_take(&job->covariance.ud, z, gain);
}

/* The largest gain of a cycle, and by how much one has moved since the cycle before. */
static void watch_gain(struct composition_job *job, const real_t *now, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        real_t moved = real_abs(now[i] - job->before[i]), size = real_abs(now[i]);
        job->moved = moved > job->moved ? moved : job->moved;
        job->largest = size > job->largest ? size : job->largest;
    }
}

static void slopes_at(const struct composition_job *job, size_t stage, real_t *dt)
{
    real_t full[COLUMN_COMPONENTS_MAX], dy[COLUMN_COMPONENTS_MAX * COLUMN_COMPONENTS_MAX];
    size_t c = job->transition.m + 1u;
    for (size_t j = 0; j < c; j++)
        full[j] = column_fraction(&job->column, job->x, stage, j);
    vle_full_slopes(&job->column.vle, job->column.temperature[stage], full,
                    &job->column.k[stage * c], &job->column.dk[stage * c], dt, dy);
}

static void work_in_sensor(const struct composition_block *b, struct composition_job *job,
                           unsigned k)
{
    const struct composition_sensor *s = &b->c.sensor[k];
    size_t length = composition_moved(&b->c);
    real_t *gain = &job->gain[k * length];
    real_t dt[COLUMN_COMPONENTS_MAX];
    struct covariance_measurement z = {.at = s->stage * job->transition.m,
                                       .count = job->transition.m,
                                       .slope = dt,
                                       .extra = COVARIANCE_EXTRAS_MAX,
                                       .variance = s->noise2};
    if (!(job->there & 1u << k)) {
        memset(gain, 0, length * sizeof(real_t));
        return;
    }
    slopes_at(job, s->stage, dt);
    if (b->s.covariance == COVARIANCE_STEADY)
        memcpy(job->before, gain, length * sizeof(real_t));
    job->spread[k] = work_in(b, job, &z, gain);
    if (b->s.covariance == COVARIANCE_STEADY)
        watch_gain(job, gain, length);
}

/* A mole fraction of a stage, the closing one too, with the offset of its place where there is an analysis. */
static void put_fraction(const struct composition_block *b, const struct composition_job *job,
                         size_t stage, size_t component, struct covariance_measurement *z,
                         real_t *slope)
{
    size_t m = job->transition.m;
    for (size_t j = 0; j < m; j++)
        slope[j] = component == m ? -ONE : j == component ? ONE : ZERO;
    *z = (struct covariance_measurement){.at = stage * m,
                                         .count = m,
                                         .slope = slope,
                                         .extra = COVARIANCE_EXTRAS_MAX,
                                         .extra_slope = ONE};
    for (uint8_t i = 0; b->s.offset > 0 && i < b->analyses; i++)
        if (b->analysis[i].stage == stage && b->analysis[i].component == component)
            z->extra = (size_t)b->c.gains.feed + i;
}

static void work_in_analysis(const struct composition_block *b, struct composition_job *job,
                             unsigned i)
{
    const struct composition_analysis *a = &b->analysis[i];
    size_t length = composition_moved(&b->c);
    real_t slope[COLUMN_COMPONENTS_MAX], *gain = &job->gain[(b->c.sensors + i) * length];
    struct covariance_measurement z;
    if (!(job->analysed & 1u << i))
        return;
    put_fraction(b, job, a->stage, a->component, &z, slope);
    z.variance = b->s.analyser * b->s.analyser + job->older[i];
    (void)work_in(b, job, &z, gain);
}

static real_t variance_of(const struct composition_block *b, struct composition_job *job,
                          const struct covariance_measurement *z)
{
    real_t variance = composition_is_banded(&b->s) ? covariance_band_of(&job->covariance.band, z)
                                                   : covariance_ud_of(&job->covariance.ud, z);
    return variance > ZERO ? variance : ZERO;
}

/* What was found of the feed, mole fraction or part of its flow; false: nothing is looked for. */
static bool put_feed(const struct composition_block *b, const struct composition_job *job,
                     unsigned k, struct covariance_measurement *z, real_t *slope)
{
    const struct composition_gains *g = &b->c.gains;
    bool is_flow = b->s.of[k] == OF_FEED_FLOW;
    for (size_t j = 0; j < job->transition.m; j++)
        slope[j] = ZERO;
    *z = (struct covariance_measurement){.at = 0,
                                         .count = job->transition.m,
                                         .slope = slope,
                                         .extra = is_flow ? g->feed - 1u
                                                          : b->s.point[k][OF_COMPONENT] - 1u,
                                         .extra_slope = ONE};
    return is_flow ? g->has_flow : g->has_feed;
}

static void find_point(const struct composition_block *b, struct composition_job *job, unsigned k)
{
    size_t stage = b->s.point[k][AT_STAGE] - 1u, component = b->s.point[k][OF_COMPONENT];
    real_t slope[COLUMN_COMPONENTS_MAX];
    struct covariance_measurement z;
    if (b->s.of[k] != OF_STAGE) {
        bool is_found = put_feed(b, job, k, &z, slope);
        job->sd[k] = is_found ? real_sqrt(variance_of(b, job, &z)) : ZERO;
        return;
    }
    put_fraction(b, job, stage, component ? component - 1u : 0, &z, slope);
    if (!component) {
        slopes_at(job, stage, slope);
        z.extra = COVARIANCE_EXTRAS_MAX;
    }
    job->sd[k] = real_sqrt(variance_of(b, job, &z));
}

static void end_points(const struct composition_block *b, struct composition_job *job)
{
    real_t least, most;
    if (composition_is_banded(&b->s))
        covariance_band_extremes(&job->covariance.band, &least, &most);
    else
        covariance_ud_extremes(&job->covariance.ud, &least, &most);
    job->least = real_sqrt(least > ZERO ? least : ZERO);
    job->most = real_sqrt(most);
    if (!isfinite(job->most) || !(least > ZERO))
        job->err = ERR_NOT_FINITE;
}

/* Of a steady state: whether another cycle is needed. */
static bool goes_round(const struct composition_block *b, struct composition_job *job)
{
    if (b->s.covariance != COVARIANCE_STEADY)
        return false;
    bool still = job->moved <= STEADY_PART * job->largest;
    job->moved = job->largest = ZERO;
    return !still && ++job->cycles < STEADY_CYCLES;
}

static void go_to(struct composition_job *job, enum composition_phase phase)
{
    job->phase = (uint8_t)phase;
    job->at = 0;
}

void composition_covariance_piece(struct composition_block *b, struct composition_job *job)
{
    switch ((enum composition_phase)job->phase) {
    case PHASE_MODEL:
        find_model(job);
        go_to(job, PHASE_FACTORS);
        break;
    case PHASE_FACTORS:
        find_factors(job);
        go_to(job, PHASE_FEED);
        break;
    case PHASE_FEED:
        find_feed(b, job);
        if (job->begin)
            begin_covariance(b, job);
        go_to(job, PHASE_CARRY);
        break;
    case PHASE_CARRY:
        if (!carry(b, job))
            go_to(job, PHASE_SENSORS);
        break;
    case PHASE_SENSORS:
        if (job->at < b->c.sensors)
            work_in_sensor(b, job, job->at++);
        else
            go_to(job, goes_round(b, job) ? PHASE_CARRY : PHASE_ANALYSES);
        break;
    case PHASE_ANALYSES:
        if (job->at < b->analyses)
            work_in_analysis(b, job, job->at++);
        else
            go_to(job, PHASE_POINTS);
        break;
    case PHASE_POINTS:
        if (job->at < b->points)
            find_point(b, job, job->at++);
        else {
            end_points(b, job);
            go_to(job, PHASE_DONE);
        }
        break;
    default:
        break;
    }
}
