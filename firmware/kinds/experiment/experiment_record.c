/* The record: of the measurements one reading in a control interval, MVs as the mean of what took effect in each sample, both as fractions
 * of span about the operating point. The same rows go into recursive estimators as they come, of low orders, to see how it gets on. */
#include "kinds/experiment/plant_experiment_block.h"

#include <string.h>

#include "base/channel.h"

#define ZERO REAL_C(0.0)

#define GAP_MOST     3u  /* samples without a reading, in a row */
#define GAPS_PART    10u /* of all, one in so many */
#define OUTSIDE_MOST 2u  /* readings in a row; one may be a spike, as in start-up */

/* Part of the amplitude that an MV may have moved before. */
#define MOVED_MOST REAL_C(0.5)

#define LIVE_NA 2u
#define LIVE_P0 1e6f

/* ---- memory ---- */

static uint8_t live_nb(unsigned n)
{
    return n <= 2 ? 4 : 3;
}

static uint32_t rounded_up(uint32_t bytes)
{
    return (bytes + 7u) & ~UINT32_C(7);
}

static unsigned live_parameters(unsigned n)
{
    return LIVE_NA + n * live_nb(n);
}

uint32_t experiment_job_bytes(unsigned n, uint32_t samples)
{
    return rounded_up((uint32_t)sizeof(struct experiment_job)) +
           n * rounded_up(rls_bytes(live_parameters(n))) +
           2u * n * samples * (uint32_t)sizeof(real_t);
}

static void begin_live(struct experiment_job *job, unsigned n)
{
    float p0[RLS_MAX];
    num_t start[RLS_MAX];
    memset(&job->live, 0, sizeof job->live);
    memset(job->history, 0, sizeof job->history);
    job->live.na = LIVE_NA;
    for (unsigned j = 0; j < n; j++) {
        job->live.first[j] = 1;
        job->live.last[j] = live_nb(n);
    }
    for (unsigned k = 0; k < RLS_MAX; k++) {
        p0[k] = LIVE_P0;
        start[k] = num_zero();
    }
    struct rls_settings settings = {.n = (uint8_t)live_parameters(n),
                                    .forgetting = RLS_CONSTANT,
                                    .forget = 1,
                                    .forget_least = 0.5f,
                                    .sigma0 = 1,
                                    .memory = 1,
                                    .trace = 1e9f,
                                    .p0 = p0,
                                    .rate = 0.5f};
    for (unsigned i = 0; i < n; i++)
        rls_init(job->rls[i], &settings, start);
}

void experiment_record_begin(struct experiment *e, struct experiment_job *job)
{
    unsigned n = e->n;
    char *at = (char *)job + rounded_up((uint32_t)sizeof *job);
    for (unsigned i = 0; i < n; i++) {
        job->rls[i] = (struct rls *)(void *)at;
        at += rounded_up(rls_bytes(live_parameters(n)));
    }
    job->y = (real_t *)(void *)at;
    job->u = job->y + (size_t)n * e->wanted;
    job->begun = job->over = false;
    begin_live(job, n);
}

/* ---- readings ---- */

static real_t band_of(const struct experiment *e, unsigned i)
{
    return e->s.band[i] / (e->input[i].hi - e->input[i].lo);
}

static bool is_missed(struct experiment *e, unsigned i, bool good)
{
    if (good) {
        e->gap[i] = 0;
        return false;
    }
    e->gap[i]++;
    e->gaps[i]++;
    return e->gap[i] > GAP_MOST * e->ticks ||
           e->gaps[i] > experiment_samples(&e->s) * e->ticks / GAPS_PART;
}

static bool has_left_band(struct experiment *e, unsigned i, bool good)
{
    if (!good || e->stage != EXPERIMENT_EXCITES)
        return false;
    bool outside = !(real_abs(e->held[i] - e->level[i]) <= band_of(e, i));
    e->out[i] = outside ? (uint8_t)(e->out[i] + 1u) : 0;
    return e->out[i] >= OUTSIDE_MOST;
}

enum experiment_reason experiment_read(struct experiment *e, const struct block_io *io)
{
    for (unsigned i = 0; i < e->n; i++) {
        bool good = io->quality[i] == QUALITY_GOOD;
        if (good)
            e->held[i] = num_to_float(io->input[i]);
        e->at_fault = (uint8_t)(i + 1u);
        if (is_missed(e, i, good))
            return REASON_MEASUREMENT;
        if (has_left_band(e, i, good))
            return REASON_BAND;
    }
    e->at_fault = 0;
    return REASON_NONE;
}

/* All decimators are at the same sample. */
static bool decimate_all(struct experiment *e, real_t *y)
{
    bool due = false;
    for (unsigned i = 0; i < e->n; i++)
        due = decimator_step(&e->filter[i], e->held[i], &y[i]);
    return due;
}

static real_t applied_of(const struct experiment *e, const struct block_io *io, unsigned j)
{
    const struct applied_history *h = io->input_applied[e->n + j];
    return h ? num_to_float(applied_ticks_ago(h, 1)) : e->rest[j];
}

/* ---- rest ---- */

static void widen(real_t *least, real_t *most, real_t x, bool first)
{
    *least = !first && *least < x ? *least : x;
    *most = !first && *most > x ? *most : x;
}

static float amplitude_of(const struct experiment *e, unsigned j)
{
    return e->s.amplitude[j] / (e->input[e->n + j].hi - e->input[e->n + j].lo);
}

/* The means, and who was not at rest. */
static void end_of_rest(struct experiment *e)
{
    for (unsigned i = 0; i < e->n; i++) {
        e->level[i] /= (real_t)e->samples;
        e->rest[i] /= (real_t)e->settled;
        if (e->most[i] - e->least[i] > MOVED_MOST * amplitude_of(e, i))
            e->at_fault = (uint8_t)(e->n + i + 1u);
        if (e->highest[i] - e->lowest[i] > band_of(e, i))
            e->at_fault = (uint8_t)(i + 1u);
    }
}

bool experiment_settle(struct experiment *e, const struct block_io *io)
{
    real_t y[EXPERIMENT_MOST];
    for (unsigned j = 0; j < e->n; j++) {
        real_t u = applied_of(e, io, j);
        e->rest[j] += u;
        widen(&e->least[j], &e->most[j], u, e->settled == 0);
    }
    e->settled++;
    if (!decimate_all(e, y))
        return false;
    for (unsigned i = 0; i < e->n; i++) {
        e->level[i] += y[i];
        widen(&e->lowest[i], &e->highest[i], y[i], e->samples == 0);
    }
    if (++e->samples < e->s.settle)
        return false;
    end_of_rest(e);
    return true;
}

/* ---- the experiment ---- */

/* What took effect in the sample that ends now. */
static void put_inputs(struct experiment *e)
{
    real_t *row = &e->job->u[(size_t)(e->samples - 1u) * e->n];
    for (unsigned j = 0; j < e->n; j++) {
        real_t moved = e->applied[j] / (real_t)e->ticks - e->rest[j];
        real_t others = moved - e->signal[j];
        row[j] = moved;
        e->sum[j].all += moved * moved;
        e->sum[j].others += others * others;
        e->applied[j] = ZERO;
    }
}

/* The recursive estimators: of the row before, and the measurements now. */
static void learn_live(struct experiment *e, const real_t *y)
{
    struct experiment_job *job = e->job;
    const real_t *u = &job->u[(size_t)(e->samples - 1u) * e->n],
                 *last = &job->y[(size_t)(e->samples - 1u) * e->n];
    for (unsigned i = 0; i < e->n; i++) {
        real_t phi[ARX_MOST];
        num_t row[RLS_MAX];
        arx_push(&job->history[i], e->n, last[i], u, ZERO);
        arx_regressor(&job->live, e->n, &job->history[i], phi);
        for (unsigned k = 0; k < live_parameters(e->n); k++)
            row[k] = num_from_float((float)phi[k]);
        (void)rls_step(job->rls[i], row, num_from_float((float)y[i]),
                       e->samples > DIFFERENCE_B_MOST);
        e->live_error[i] = 100 * rls_error_sd(job->rls[i]);
    }
}

bool experiment_record(struct experiment *e, const struct block_io *io)
{
    real_t y[EXPERIMENT_MOST];
    for (unsigned j = 0; j < e->n && e->samples > 0; j++)
        e->applied[j] += applied_of(e, io, j);
    if (!decimate_all(e, y))
        return false;
    for (unsigned i = 0; i < e->n; i++)
        y[i] -= e->level[i];
    if (e->samples > 0) {
        put_inputs(e);
        learn_live(e, y);
    }
    if (e->samples >= e->wanted)
        return true;
    memcpy(&e->job->y[(size_t)e->samples * e->n], y, e->n * sizeof y[0]);
    prbs_step(&e->prbs, e->signal);
    e->samples++;
    return false;
}

void experiment_ask_signal(struct experiment *e, struct block_io *io)
{
    e->asked_signal = e->samples > 0;
    for (unsigned j = 0; j < e->n && e->samples > 0; j++) {
        float span = e->input[e->n + j].hi - e->input[e->n + j].lo;
        real_t reach = (e->s.reach[j] > 0 ? e->s.reach[j] : 2 * e->s.amplitude[j]) / span;
        io->excite[j] = (struct block_excitation){.what = EXCITE_INPUT,
                                                  .which = (uint8_t)(e->n + j),
                                                  .value = num_from_float(e->signal[j]),
                                                  .amplitude = num_from_float(amplitude_of(e, j)),
                                                  .lo = num_from_float(e->rest[j] - reach),
                                                  .hi = num_from_float(e->rest[j] + reach)};
    }
}

real_t experiment_others(const struct experiment *e, unsigned j)
{
    return e->sum[j].all > ZERO ? e->sum[j].others / e->sum[j].all : ZERO;
}

float experiment_live_gain(const struct experiment *e, unsigned i, unsigned j)
{
    const struct rls *r = e->job->rls[i];
    float at_rest = 1, sum = 0;
    unsigned nb = live_nb(e->n);
    for (unsigned k = 0; k < LIVE_NA; k++)
        at_rest += num_to_float(rls_theta(r, k));
    for (unsigned k = 0; k < nb; k++)
        sum += num_to_float(rls_theta(r, LIVE_NA + j * nb + k));
    float scale =
        (e->input[i].hi - e->input[i].lo) / (e->input[e->n + j].hi - e->input[e->n + j].lo);
    return at_rest > 1e-6f ? scale * sum / at_rest : 0;
}
