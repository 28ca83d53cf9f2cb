#include "kinds/experiment/experiment_record.h"

#include <string.h>

#include "base/assertion.h"
#include "base/channel.h"
#include "kinds/experiment/experiment_record_state.h"

#define ZERO REAL_C(0.0)

/* Samples in a row that may be without a reading. */
#define GAP_MOST 3u
/* One in so many of all may be without. */
#define GAPS_PART 10u
/* Readings in a row that may not be outside the band; one may be a spike, as in start-up. */
#define OUTSIDE_MOST 2u

/* Part of the amplitude that an MV may have moved before. */
#define MOVED_MOST REAL_C(0.5)

#define LIVE_NA 2u
#define LIVE_P0 1e6f

/* ---- memory ---- */

static uint8_t live_nb(unsigned n)
{
    return n <= 2 ? 4 : 3;
}

static uint32_t estimator_bytes(unsigned n)
{
    return (rls_bytes(LIVE_NA + n * live_nb(n)) + 7u) & ~UINT32_C(7);
}

static unsigned live_parameters(unsigned n)
{
    return LIVE_NA + n * live_nb(n);
}

uint32_t experiment_rows_bytes(unsigned n, uint32_t samples)
{
    return n * estimator_bytes(n) + 2u * n * samples * (uint32_t)sizeof(real_t);
}

static void begin_live(struct experiment_rows *rows, unsigned n)
{
    float p0[RLS_MAX];
    num_t start[RLS_MAX];
    memset(&rows->live, 0, sizeof rows->live);
    memset(rows->history, 0, sizeof rows->history);
    rows->live.na = LIVE_NA;
    for (unsigned j = 0; j < n; j++) {
        rows->live.first[j] = 1;
        rows->live.last[j] = live_nb(n);
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
        rls_init(rows->rls[i], &settings, start);
}

void experiment_rows_begin(struct experiment_rows *rows, const struct experiment_context *c,
                           void *memory)
{
    REFLUX_ASSERT(c->n <= EXPERIMENT_MOST);
    char *at = memory;
    for (unsigned i = 0; i < c->n; i++) {
        rows->rls[i] = (struct rls *)(void *)at;
        at += estimator_bytes(c->n);
    }
    rows->y = (real_t *)(void *)at;
    rows->u = rows->y + (size_t)c->n * c->wanted;
    begin_live(rows, c->n);
}

struct arx_data experiment_rows_data(const struct experiment_rows *rows,
                                     const struct experiment_context *c)
{
    return (struct arx_data){
        .samples = c->wanted, .outputs = c->n, .inputs = c->n, .u = rows->u, .y = rows->y};
}

/* ---- readings ---- */

void experiment_record_start(struct experiment_record *r)
{
    memset(r->gap, 0, sizeof r->gap);
    memset(r->gaps, 0, sizeof r->gaps);
}

void experiment_record_stage(struct experiment_record *r)
{
    r->samples = 0;
}

static real_t band_of(const struct experiment_context *c, unsigned i)
{
    return c->s.band[i] / experiment_span(c, i);
}

static bool is_missed(struct experiment_record *r, const struct experiment_context *c, unsigned i,
                      bool good)
{
    if (good) {
        r->gap[i] = 0;
        return false;
    }
    r->gap[i]++;
    r->gaps[i]++;
    return r->gap[i] > GAP_MOST * c->ticks ||
           r->gaps[i] > (uint32_t)c->wanted * c->ticks / GAPS_PART;
}

static bool has_left_band(struct experiment_record *r, const struct experiment_context *c,
                          unsigned i)
{
    bool outside = !(real_abs(r->held[i] - r->level[i]) <= band_of(c, i));
    r->outside[i] = outside ? (uint8_t)(r->outside[i] + 1u) : 0;
    return r->outside[i] >= OUTSIDE_MOST;
}

enum experiment_reason experiment_read(struct experiment_record *r,
                                       const struct experiment_context *c,
                                       const struct block_io *io, bool excites, uint8_t *at_fault)
{
    REFLUX_ASSERT(c->n <= EXPERIMENT_MOST);
    for (unsigned i = 0; i < c->n; i++) {
        bool good = io->inputs.quality[i] == QUALITY_GOOD;
        if (good)
            r->held[i] = num_to_float(io->inputs.value[i]);
        *at_fault = (uint8_t)(i + 1u);
        if (is_missed(r, c, i, good))
            return REASON_MEASUREMENT;
        if (good && excites && has_left_band(r, c, i))
            return REASON_BAND;
    }
    *at_fault = 0;
    return REASON_NONE;
}

/* All decimators are at the same sample. */
static bool decimate_all(struct experiment_record *r, unsigned n, real_t *y)
{
    bool due = false;
    for (unsigned i = 0; i < n; i++)
        due = decimator_step(&r->filter[i], r->held[i], &y[i]);
    return due;
}

static real_t applied_of(const struct experiment_record *r, const struct experiment_context *c,
                         const struct block_io *io, unsigned j)
{
    REFLUX_ASSERT(j < c->n);
    const struct applied_history *h = io->inputs.applied[c->n + j];
    return h ? num_to_float(applied_ticks_ago(h, 1)) : r->rest[j];
}

/* ---- rest ---- */

void experiment_settling_begin(struct experiment_record *r, const struct experiment_context *c)
{
    for (unsigned i = 0; i < c->n; i++) {
        enum err none = decimator_init(&r->filter[i], c->ticks, c->s.cutoff); /* checked */
        (void)none;
        r->level[i] = r->rest[i] = r->applied[i] = 0;
        r->gaps[i] = 0;
        r->outside[i] = 0;
        r->sum[i].all = r->sum[i].others = 0;
    }
    r->settled = 0;
}

static void widen(real_t *least, real_t *most, real_t x, bool first)
{
    *least = !first && *least < x ? *least : x;
    *most = !first && *most > x ? *most : x;
}

static float amplitude_of(const struct experiment_context *c, unsigned j)
{
    return c->s.amplitude[j] / experiment_span(c, c->n + j);
}

/* Makes means of the sums, and finds who was not at rest. */
static void end_of_rest(struct experiment_record *r, const struct experiment_context *c,
                        uint8_t *at_fault)
{
    for (unsigned i = 0; i < c->n; i++) {
        r->level[i] /= (real_t)r->samples;
        r->rest[i] /= (real_t)r->settled;
        if (r->most[i] - r->least[i] > MOVED_MOST * amplitude_of(c, i))
            *at_fault = (uint8_t)(c->n + i + 1u);
        if (r->highest[i] - r->lowest[i] > band_of(c, i))
            *at_fault = (uint8_t)(i + 1u);
    }
}

bool experiment_settle(struct experiment_record *r, const struct experiment_context *c,
                       const struct block_io *io, uint8_t *at_fault)
{
    REFLUX_ASSERT(c->n <= EXPERIMENT_MOST);
    real_t y[EXPERIMENT_MOST];
    for (unsigned j = 0; j < c->n; j++) {
        real_t u = applied_of(r, c, io, j);
        r->rest[j] += u;
        widen(&r->least[j], &r->most[j], u, r->settled == 0);
    }
    r->settled++;
    if (!decimate_all(r, c->n, y))
        return false;
    for (unsigned i = 0; i < c->n; i++) {
        r->level[i] += y[i];
        widen(&r->lowest[i], &r->highest[i], y[i], r->samples == 0);
    }
    if (++r->samples < c->s.settle)
        return false;
    end_of_rest(r, c, at_fault);
    return true;
}

/* ---- the experiment ---- */

void experiment_signal_begin(struct experiment_record *r, const struct experiment_context *c)
{
    struct prbs_settings settings = {.inputs = c->n,
                                     .bits = (uint8_t)c->s.bits,
                                     .independence = PRBS_SHIFTS,
                                     .clock = c->s.clock};
    for (unsigned j = 0; j < c->n; j++)
        settings.amplitude[j] = amplitude_of(c, j);
    prbs_init(&r->prbs, &settings);
}

/* Puts what took effect in the sample that ends. */
static void put_inputs(struct experiment_record *r, const struct experiment_context *c,
                       struct experiment_rows *rows)
{
    REFLUX_ASSERT(r->samples >= 1 && r->samples <= c->wanted);
    real_t *row = &rows->u[(size_t)(r->samples - 1u) * c->n];
    for (unsigned j = 0; j < c->n; j++) {
        real_t moved = r->applied[j] / (real_t)c->ticks - r->rest[j];
        real_t others = moved - r->signal[j];
        row[j] = moved;
        r->sum[j].all += moved * moved;
        r->sum[j].others += others * others;
        r->applied[j] = ZERO;
    }
}

/* Steps the recursive estimators with the row before and the present measurements. */
static void learn_live(struct experiment_record *r, const struct experiment_context *c,
                       struct experiment_rows *rows, const real_t *y)
{
    REFLUX_ASSERT(r->samples >= 1 && r->samples <= c->wanted && live_parameters(c->n) <= RLS_MAX);
    const real_t *u = &rows->u[(size_t)(r->samples - 1u) * c->n],
                 *last = &rows->y[(size_t)(r->samples - 1u) * c->n];
    for (unsigned i = 0; i < c->n; i++) {
        real_t phi[ARX_MOST];
        num_t row[RLS_MAX];
        arx_push(&rows->history[i], c->n, last[i], u, ZERO);
        arx_regressor(&rows->live, c->n, &rows->history[i], phi);
        for (unsigned k = 0; k < live_parameters(c->n); k++)
            row[k] = num_from_float((float)phi[k]);
        (void)rls_step(rows->rls[i], row, num_from_float((float)y[i]),
                       r->samples > DIFFERENCE_B_MOST);
        r->live_error[i] = 100 * rls_error_sd(rows->rls[i]);
    }
}

bool experiment_record_tick(struct experiment_record *r, const struct experiment_context *c,
                            struct experiment_rows *rows, const struct block_io *io)
{
    REFLUX_ASSERT(c->n <= EXPERIMENT_MOST);
    real_t y[EXPERIMENT_MOST];
    for (unsigned j = 0; j < c->n && r->samples > 0; j++)
        r->applied[j] += applied_of(r, c, io, j);
    if (!decimate_all(r, c->n, y))
        return false;
    for (unsigned i = 0; i < c->n; i++)
        y[i] -= r->level[i];
    if (r->samples > 0) {
        put_inputs(r, c, rows);
        learn_live(r, c, rows, y);
    }
    if (r->samples >= c->wanted)
        return true;
    memcpy(&rows->y[(size_t)r->samples * c->n], y, c->n * sizeof y[0]);
    prbs_step(&r->prbs, r->signal);
    r->samples++;
    return false;
}

bool experiment_ask_signal(const struct experiment_record *r, const struct experiment_context *c,
                           struct block_io *io)
{
    REFLUX_ASSERT(c->n <= EXPERIMENT_MOST);
    for (unsigned j = 0; j < c->n && r->samples > 0; j++) {
        float span = experiment_span(c, c->n + j);
        real_t reach = (c->s.reach[j] > 0 ? c->s.reach[j] : 2 * c->s.amplitude[j]) / span;
        io->requests.excite[j] =
            (struct block_excitation){.what = EXCITE_INPUT,
                                      .which = (uint8_t)(c->n + j),
                                      .value = num_from_float(r->signal[j]),
                                      .amplitude = num_from_float(amplitude_of(c, j)),
                                      .lo = num_from_float(r->rest[j] - reach),
                                      .hi = num_from_float(r->rest[j] + reach)};
    }
    return r->samples > 0;
}

/* ---- values ---- */

uint32_t experiment_record_samples(const struct experiment_record *r)
{
    return r->samples;
}

real_t experiment_others(const struct experiment_record *r, unsigned j)
{
    REFLUX_ASSERT(j < EXPERIMENT_MOST);
    return r->sum[j].all > ZERO ? r->sum[j].others / r->sum[j].all : ZERO;
}

float experiment_live_error(const struct experiment_record *r, unsigned i)
{
    REFLUX_ASSERT(i < EXPERIMENT_MOST);
    return r->live_error[i];
}

float experiment_live_gain(const struct experiment_rows *rows, const struct experiment_context *c,
                           unsigned i, unsigned j)
{
    REFLUX_ASSERT(i < c->n && j < c->n);
    const struct rls *r = rows->rls[i];
    float at_rest = 1, sum = 0;
    unsigned nb = live_nb(c->n);
    for (unsigned k = 0; k < LIVE_NA; k++)
        at_rest += num_to_float(rls_theta(r, k));
    for (unsigned k = 0; k < nb; k++)
        sum += num_to_float(rls_theta(r, LIVE_NA + j * nb + k));
    float scale = experiment_span(c, i) / experiment_span(c, c->n + j);
    return at_rest > 1e-6f ? scale * sum / at_rest : 0;
}
