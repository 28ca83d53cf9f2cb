#include "kinds/composition/composition_job.h"

#include <string.h>

#include "kinds/composition/composition_covariance.h"

#define ONE REAL_C(1.0)

#define HOLDER "composition"
#define FREES  "block N free"

/* What was here before, with other settings, may have had it for so many ticks. */
#define REFUSALS_MOST (WORKSPACE_TICKS + 1u)

/* A steady state is looked for during so many seconds. */
#define STEADY_S REAL_C(20.0)

const char *composition_workspace_holder(void)
{
    const struct workspace *w = workspace_shared();
    return w && w->frees ? w->holder : NULL;
}

bool composition_lacks_workspace(const struct composition_block *b)
{
    const struct composition_filter *f = &b->filter;
    return composition_is_complete(&b->c) && !f->job && !f->steady &&
           (f->declined || f->refusals > REFUSALS_MOST);
}

void composition_begin_filter(struct composition_block *b)
{
    b->filter.begins = true;
    b->filter.analysed = 0;
}

void composition_forget_steady(struct composition_block *b)
{
    struct composition_filter *f = &b->filter;
    f->begins = f->begins || b->s.covariance == COVARIANCE_STEADY;
    f->steady = false;
}

void composition_end_lease(struct composition_block *b)
{
    if (b->filter.job)
        workspace_end(workspace_shared(), b->filter.lease);
    b->filter.job = NULL;
}

/* A feed so many standard deviations from the table's is not to be expected. */
#define FEED_MOST REAL_C(3.0)

static bool expects_feed(const struct composition_block *b)
{
    const struct composition_gains *g = &b->c.gains;
    for (uint8_t k = 0; k < g->feed; k++) {
        bool is_flow = g->has_flow && k + 1u == g->feed;
        if (real_abs(g->extra[k]) >
            FEED_MOST * (is_flow ? composition_feed_f(&b->s, b->inputs) : b->s.feed_z))
            return false;
    }
    return true;
}

bool composition_is_unsure(const struct composition_block *b)
{
    return composition_is_complete(&b->c) && (!b->c.gains.of || !expects_feed(b));
}

/* ---- sizes ---- */

uint32_t composition_job_bytes(unsigned covariance, size_t stages, size_t m, size_t extras)
{
    size_t bytes = covariance == COVARIANCE_BAND ? covariance_band_bytes(stages, m, extras)
                                                 : covariance_ud_bytes(stages, m, extras);
    return (uint32_t)(sizeof(struct composition_job) + bytes);
}

size_t composition_numbers(const struct block_setup *setup)
{
    const struct composition_settings *s = setup->settings;
    const struct column_record *record = setup->named;
    unsigned sensors = 0;
    if (!record || (s->method != METHOD_EKF && s->method != METHOD_KALMAN))
        return 0;
    float stages_said = record->value[COLUMN_TABLE_N_STAGES];
    float components = record->value[COLUMN_TABLE_N_COMPONENTS];
    if (!(stages_said >= 1 && stages_said <= (float)COLUMN_STAGES_MAX && components >= 2 &&
          components <= (float)COLUMN_COMPONENTS_MAX))
        return 0; /* refused by check() */
    size_t stages = (size_t)stages_said, m = (size_t)components - 1u;
    for (unsigned k = 0; k < setup->inputs; k++)
        sensors += composition_is_sensor(s, k) ? 1u : 0u;
    size_t n = sensors * (stages * m + composition_extras(s, setup->inputs, m));
    size_t feed = (s->feed_z > 0 ? m : 0u) + (composition_feed_f(s, setup->inputs) > 0 ? 1u : 0u);
    return s->method == METHOD_KALMAN ? n + stages * (column_transition_stride(m) + feed * m) : n;
}

/* ---- the order ---- */

static uint8_t cycle_steps(const struct composition_block *b)
{
    real_t wanted = b->s.covariance == COVARIANCE_STEADY ? STEADY_S : b->s.cycle_s;
    real_t steps = wanted / b->c.h + REAL_C(0.5);
    return steps < ONE ? 1u : steps > REAL_C(255.0) ? 255u : (uint8_t)steps;
}

/* Where the model is linear it stays at the profile of the table; gains that are found once are those of that profile. */
static bool at_profile(const struct composition_block *b)
{
    return b->c.method == METHOD_KALMAN || b->s.covariance == COVARIANCE_STEADY;
}

/* Bubble points as the tick has left them, a step from the state; where those are not the table's profile's, but that is asked for, only as
 * a beginning. */
static void put_column(const struct composition_block *b, struct column *column)
{
    const struct column *from = &b->c.column;
    size_t stages = b->c.table.config.stages, all = stages * b->c.table.config.components;
    memcpy(column->temperature, from->temperature, stages * sizeof(real_t));
    memcpy(column->k, from->k, all * sizeof(real_t));
    memcpy(column->dk, from->dk, all * sizeof(real_t));
    column->inputs.pressure_top = from->inputs.pressure_top;
    column->warm = from->warm && (b->c.method == METHOD_KALMAN || !at_profile(b));
}

static void put_state(const struct composition_block *b, struct composition_job *job)
{
    const struct composition *c = &b->c;
    size_t n = c->column.n_fractions;
    const real_t *x = at_profile(b) ? c->table.profile : c->x;
    memcpy(job->x, x, n * sizeof(real_t));
    put_column(b, &job->column);
    if (at_profile(b))
        job->inputs = c->table.nominal;
    else
        composition_inputs(c, &job->inputs);
}

static void put_analyses(struct composition_block *b, struct composition_job *job)
{
    job->analysed = 0;
    for (uint8_t i = 0; i < b->analyses; i++) {
        struct composition_analysis *a = &b->analysis[i];
        if (!a->fresh)
            continue;
        job->analysed = (uint8_t)(job->analysed | 1u << i);
        job->older[i] = a->moved * a->moved;
        b->taken[i] = a->surprise;
        a->fresh = false;
    }
    b->filter.analysed = job->analysed;
}

static void put_order(struct composition_block *b, uint8_t steps)
{
    struct composition_job *job = b->filter.job;
    bool steady = b->s.covariance == COVARIANCE_STEADY;
    if (!b->filter.begins && job->phase != PHASE_DONE)
        return; /* given up half-way: it goes on, since the covariance is half-way too */
    put_state(b, job);
    job->h = b->c.h * (steady ? REAL_C(1.0) : (real_t)steps);
    job->there = 0;
    for (uint8_t k = 0; k < b->c.sensors; k++)
        if (b->c.sensor[k].moves && (steady || b->c.sensor[k].there))
            job->there = (uint16_t)(job->there | 1u << k);
    put_analyses(b, job);
    job->begin = b->filter.begins;
    b->filter.begins = false;
    job->phase = PHASE_MODEL;
    job->at = 0;
    job->cycles = 0;
    job->err = ERR_OK;
    job->carrying = false;
}

uint8_t composition_order(struct composition_block *b)
{
    struct composition_filter *f = &b->filter;
    if (!composition_is_complete(&b->c) || f->declined || f->steady)
        return 0;
    uint8_t steps = cycle_steps(b);
    if (f->job) {
        put_order(b, steps);
        return steps;
    }
    for (uint8_t i = 0; i < b->analyses; i++)
        b->analysis[i].fresh = false; /* there was nobody to take it in */
    return 1;                         /* the workspace */
}

void composition_keep_lease(struct composition_block *b, bool working)
{
    struct composition_filter *f = &b->filter;
    struct workspace *w = workspace_shared();
    if (!f->job)
        return;
    if ((f->declined || f->steady || !composition_is_complete(&b->c)) && !working) {
        composition_end_lease(b);
    } else if (!workspace_renew(w, f->lease)) {
        f->job = NULL;
    }
}

/* ---- the result ---- */

/* What a sample of an analyser said when it was compared moves everything once. */
static void apply_analyses(struct composition_block *b)
{
    struct composition *c = &b->c;
    const struct composition_job *job = b->filter.job;
    size_t n = c->column.n_fractions, stride = composition_moved(c);
    for (uint8_t i = 0; i < b->analyses; i++) {
        if (!(b->filter.analysed & 1u << i))
            continue;
        const real_t *gain = &job->gain[(c->sensors + i) * stride];
        real_t change[COLUMN_STATES_MAX], left = b->taken[i];
        for (size_t k = 0; k < n; k++)
            change[k] = gain[k] * left;
        (void)column_move(&c->column, c->x, change);
        composition_move_extras(c, gain, left);
    }
}

void composition_take_gains(struct composition_block *b)
{
    struct composition_filter *f = &b->filter;
    struct composition *c = &b->c;
    const struct composition_job *job = f->job;
    if (!job || !workspace_renew(workspace_shared(), f->lease) || job->phase != PHASE_DONE)
        return; /* it has only just got its memory, or none */
    if (job->err) {
        f->begins = true;
        return;
    }
    memcpy(composition_gain_memory(b), job->gain,
           c->sensors * composition_moved(c) * sizeof(real_t));
    c->gains.of = composition_gain_memory(b);
    for (uint8_t k = 0; k < c->sensors; k++)
        c->sensor[k].spread = job->spread[k];
    memcpy(f->sd, job->sd, sizeof f->sd);
    f->least = job->least;
    f->most = job->most;
    apply_analyses(b);
    f->steady = b->s.covariance == COVARIANCE_STEADY && !f->begins;
    if (f->count < UINT32_MAX)
        f->count++;
}

/* ---- the workspace, and work in it ---- */

static bool lease_workspace(struct composition_block *b)
{
    struct composition_filter *f = &b->filter;
    struct workspace *w = workspace_shared();
    void *memory = NULL;
    size_t m = b->c.table.config.components - 1;
    uint32_t bytes =
        composition_job_bytes(b->s.covariance, b->c.table.config.stages, m, b->c.gains.extras);
    if (!w || workspace_lease_for_now(w, HOLDER, FREES, bytes, &f->lease, &memory) != ERR_OK) {
        f->refusals = (uint8_t)(f->refusals < UINT8_MAX ? f->refusals + 1u : UINT8_MAX);
        return false;
    }
    f->refusals = 0;
    struct composition_job *job = memory;
    memset(job, 0, sizeof *job);
    job->column = b->c.column; /* what does not change; the rest comes with the order */
    job->phase = PHASE_POINTS; /* nothing to be taken */
    f->begins = true;
    f->job = job;
    return true;
}

bool composition_job_piece(struct composition_block *b)
{
    struct composition_filter *f = &b->filter;
    if (f->declined)
        return false;
    if (!f->job) {
        (void)lease_workspace(b);
        return false;
    }
    struct composition_job *job = f->job;
    if (!workspace_renew(workspace_shared(), f->lease) || job->phase == PHASE_DONE)
        return false;
    job->column.config = &b->c.table.config; /* the state may have been moved */
    job->column.vle.component = b->c.table.config.component;
    job->column.vle.activity_context = b->c.table.config.activity_context;
    composition_covariance_piece(b, job);
    if (job->err)
        job->phase = PHASE_DONE;
    return job->phase != PHASE_DONE;
}
