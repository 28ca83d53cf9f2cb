/* The record of the kind `experiment`: samples of all measurements, filtered and decimated, and of what was applied of all MVs, as
 * deviations from where the plant was at rest; and a recursive model beside it, so that one sees how it goes. */
#include "adapt/prbs_inside.h"

#if CONFIG_BLOCKS

#include <string.h>

#include "base/channel.h"

#define ZERO REAL_C(0.0)

/* Readings may be missing for so many samples in a row, and for this part of all ticks: the last one stands in for them. */
#define LOST_SAMPLES 2u
#define LOST_PART    20u

/* ---- the workspace ---- */

static real_t *record_u(const struct experiment_block *b)
{
    return b->work->numbers;
}

static real_t *record_y(const struct experiment_block *b)
{
    return b->work->numbers + (size_t)b->samples * b->mvs;
}

/* Behind the record, where eight divides the address. */
static struct rls *live_estimator(const struct experiment_block *b, unsigned i)
{
    unsigned n = experiment_live_parameters(&b->s, b->mvs);
    if (n == 0)
        return NULL;
    uintptr_t at = (uintptr_t)(record_y(b) + (size_t)b->samples * b->outputs);
    at = (at + 7u) & ~(uintptr_t)7u;
    return (struct rls *)(void *)(at + (uintptr_t)i * ((rls_bytes(n) + 7u) & ~UINT32_C(7)));
}

static void begin_live(struct experiment_block *b, unsigned i)
{
    struct rls *r = live_estimator(b, i);
    static const num_t none[RLS_MAX];
    float p0[RLS_MAX];
    if (!r)
        return;
    for (unsigned k = 0; k < RLS_MAX; k++)
        p0[k] = 1e4f;
    struct rls_settings s = {.n = (uint8_t)experiment_live_parameters(&b->s, b->mvs),
                             .forget = 1,
                             .forget_least = 0.5f,
                             .sigma0 = 1,
                             .memory = 1,
                             .trace = 1e6f,
                             .p0 = p0};
    rls_init(r, &s, none);
}

void experiment_place_work(struct experiment_block *b, void *memory)
{
    struct experiment_work *w = memory;
    memset(w, 0, sizeof *w);
    b->work = w;
    w->data = (struct arx_data){
        .samples = b->samples, .outputs = b->outputs, .inputs = b->mvs, .u = record_u(b)};
    w->data.y = record_y(b);
    w->all = (struct arx_orders){.na = (uint8_t)b->s.na, .constant = true};
    for (unsigned j = 0; j < b->mvs; j++) {
        w->all.first[j] = 1;
        w->all.last[j] = (uint8_t)b->s.nb;
    }
    for (unsigned i = 0; i < b->outputs; i++)
        begin_live(b, i);
}

/* ---- readings ---- */

enum experiment_end experiment_watch(struct experiment_block *b, const struct block_io *io)
{
    bool lost = false;
    for (unsigned i = 0; i < b->outputs; i++) {
        if (io->quality[i] != QUALITY_GOOD) {
            lost = true;
            b->detail = (uint8_t)(i + 1u);
            continue;
        }
        b->last[i] = num_to_float(io->input[i]);
        float away = b->last[i] - b->level[i];
        if (b->stage == EXPERIMENT_MOVES && b->s.reach[i] > 0 &&
            !(away <= b->s.reach[i] && away >= -b->s.reach[i])) {
            b->detail = (uint8_t)(i + 1u);
            return END_REACH;
        }
    }
    b->lost_in_a_row = (uint16_t)(lost ? b->lost_in_a_row + 1u : 0u);
    b->lost += lost;
    /* Before the first sample there is nothing that could stand in. */
    if (lost && (b->lost_in_a_row > LOST_SAMPLES * b->ratio || b->at == 0 ||
                 b->lost > b->samples / LOST_PART * b->ratio))
        return END_MEASUREMENT;
    return END_NOTHING;
}

bool experiment_take(struct experiment_block *b, const struct block_io *io, real_t *y, real_t *u)
{
    bool sample = false;
    for (unsigned j = 0; j < b->mvs && !b->anew; j++)
        b->sum[j] += num_to_float(applied_ticks_ago(io->input_applied[b->outputs + j], 1));
    if (!b->anew)
        b->ticks++;
    b->anew = false;
    for (unsigned i = 0; i < b->outputs; i++)
        sample = decimator_step(&b->filter[i], (real_t)b->last[i], &y[i]);
    for (unsigned j = 0; j < b->mvs && sample; j++) {
        u[j] = b->ticks > 0 ? (real_t)(b->sum[j] / (float)b->ticks) : ZERO;
        b->sum[j] = 0;
    }
    if (sample)
        b->ticks = 0;
    return sample;
}

/* ---- at rest ---- */

/* y is of now, u of the interval that ends now: the first sample has none. */
void experiment_rest(struct experiment_block *b, const real_t *y, const real_t *u)
{
    float n = (float)b->at + 1.0f;
    for (unsigned i = 0; i < b->outputs; i++) {
        float off = (float)y[i] - b->level[i];
        b->level[i] += off / n;
        b->square[i] += off * ((float)y[i] - b->level[i]);
        b->noise[i] = b->at > 0 ? real_sqrt(b->square[i] / (float)b->at) : 0;
    }
    for (unsigned j = 0; j < b->mvs && b->at > 0; j++) {
        float *level = &b->level[CHANNELS + j];
        *level += ((float)u[j] - *level) / (float)b->at;
    }
    b->at++;
}

/* ---- moving ---- */

/* theta is A, B of each MV, constant. */
static float own_gain(const struct experiment_block *b, const struct rls *r, unsigned i)
{
    unsigned j = i < b->mvs ? i : 0;
    float a = 1, sum = 0;
    for (unsigned k = 0; k < b->s.na; k++)
        a += num_to_float(rls_theta(r, k));
    for (unsigned k = 0; k < b->s.nb; k++)
        sum += num_to_float(rls_theta(r, b->s.na + j * b->s.nb + k));
    return a > 1e-3f || a < -1e-3f ? sum / a : 0;
}

/* The sample before, with what was applied since, is history; this one is told. */
static void learn_live(struct experiment_block *b, unsigned i, const real_t *u)
{
    struct experiment_work *w = b->work;
    struct rls *r = live_estimator(b, i);
    real_t phi[ARX_MOST];
    num_t row[RLS_MAX];
    if (!r || b->at == 0)
        return;
    arx_push(&w->history[i], b->mvs, record_y(b)[(size_t)(b->at - 1u) * b->outputs + i], u, ZERO);
    arx_regressor(&w->all, b->mvs, &w->history[i], phi);
    for (unsigned k = 0; k < experiment_live_parameters(&b->s, b->mvs); k++)
        row[k] = num_from_float((float)phi[k]);
    (void)rls_step(r, row, num_from_float((float)record_y(b)[(size_t)b->at * b->outputs + i]),
                   true);
    b->live_error[i] = rls_error_sd(r);
    b->live_gain[i] = own_gain(b, r, i);
}

void experiment_record(struct experiment_block *b, const real_t *y, const real_t *u)
{
    real_t *of_u = record_u(b), *of_y = record_y(b), off[CHANNELS] = {ZERO};
    for (unsigned j = 0; j < b->mvs && b->at > 0; j++)
        of_u[(size_t)(b->at - 1u) * b->mvs + j] = off[j] = u[j] - (real_t)b->level[CHANNELS + j];
    for (unsigned i = 0; i < b->outputs; i++)
        of_y[(size_t)b->at * b->outputs + i] = y[i] - (real_t)b->level[i];
    for (unsigned i = 0; i < b->outputs; i++)
        learn_live(b, i, off);
    b->at++;
    /* What the last sample would be followed by acts on nothing that is in the record. */
    for (unsigned j = 0; j < b->mvs && b->at == b->samples; j++)
        of_u[(size_t)(b->samples - 1u) * b->mvs + j] = off[j];
}

#endif
