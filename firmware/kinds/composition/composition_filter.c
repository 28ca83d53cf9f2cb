#include "kinds/composition/composition_filter.h"

#include <string.h>

#include "base/assertion.h"
#include "base/workspace.h"
#include "kinds/composition/composition_filter_state.h"

#define ONE REAL_C(1.0)

#define HOLDER "composition"
#define FREES  "block N free"

/* Ticks for which this block, before its settings changed, may still have the workspace. */
#define REFUSALS_MOST (WORKSPACE_TICKS + 1u)

/* Time for the computation of a steady state, s. */
#define STEADY_S REAL_C(20.0)

/* ---- beginning and end ---- */

void composition_filter_relocate(struct composition_filter *f, const real_t *gains)
{
    if (f->gain)
        f->gain = gains;
}

void composition_filter_begin(struct composition_filter *f)
{
    f->begins = true;
    f->analysed = 0;
}

void composition_filter_forget_steady(struct composition_filter *f)
{
    f->steady = false;
}

void composition_filter_retune(struct composition_filter *f,
                               const struct composition_settings *settings)
{
    f->begins = f->begins || settings->covariance == COVARIANCE_STEADY;
    f->steady = false;
}

void composition_filter_end(struct composition_filter *f)
{
    if (f->job)
        workspace_end(workspace_shared(), f->lease);
    f->job = NULL;
}

void composition_filter_decline(struct composition_filter *f)
{
    f->declined = true;
}

static const char *workspace_holder(void)
{
    const struct workspace *w = workspace_shared();
    return w && w->frees ? w->holder : NULL;
}

const char *composition_filter_resume(struct composition_filter *f)
{
    if (!f->job && workspace_holder())
        return workspace_holder();
    f->declined = false;
    return NULL;
}

void composition_filter_keep(const struct composition_parts *p, bool working)
{
    struct composition_filter *f = p->filter;
    if (!f->job)
        return;
    if ((f->declined || f->steady || !composition_is_complete(p->settings)) && !working) {
        composition_filter_end(f);
    } else if (!workspace_renew(workspace_shared(), f->lease)) {
        f->job = NULL;
    }
}

/* ---- the order ---- */

static uint8_t cycle_steps(const struct composition_parts *p)
{
    real_t wanted = p->settings->covariance == COVARIANCE_STEADY ? STEADY_S : p->settings->cycle_s;
    real_t steps = wanted / composition_model_h(p->model) + REAL_C(0.5);
    return steps < ONE ? 1u : steps > REAL_C(255.0) ? 255u : (uint8_t)steps;
}

/* Without a workspace nobody takes the samples of analyses. */
static void drop_analyses(struct composition_analyses *all)
{
    real_t surprise, moved;
    for (unsigned i = 0; i < composition_analyses_count(all); i++)
        (void)composition_analyses_take(all, i, &surprise, &moved);
}

uint8_t composition_filter_order(const struct composition_parts *p)
{
    struct composition_filter *f = p->filter;
    if (!composition_is_complete(p->settings) || f->declined || f->steady)
        return 0;
    uint8_t steps = cycle_steps(p);
    if (f->job) {
        if (composition_job_order(f->job, p, steps, f->begins, f->surprise, &f->analysed))
            f->begins = false;
        return steps;
    }
    drop_analyses(p->analyses);
    return 1; /* for the workspace */
}

/* ---- the result ---- */

/* The last sample of an analyser moves everything once. */
static void apply_analyses(const struct composition_parts *p)
{
    const struct composition_filter *f = p->filter;
    size_t sensors = composition_sensors_count(p->sensors);
    size_t length = composition_model_length(p->model);
    for (unsigned i = 0; i < composition_analyses_count(p->analyses); i++)
        if (f->analysed & 1u << i)
            composition_model_correct(
                p->model, composition_job_gains(f->job) + (sensors + i) * length, f->surprise[i]);
}

void composition_filter_take(const struct composition_parts *p)
{
    struct composition_filter *f = p->filter;
    const struct composition_job *job = f->job;
    if (!job || !workspace_renew(workspace_shared(), f->lease) || !composition_job_is_done(job))
        return; /* it has only just got its memory, or none */
    if (composition_job_err(job)) {
        f->begins = true;
        return;
    }
    memcpy(p->gains, composition_job_gains(job),
           composition_sensors_count(p->sensors) * composition_model_length(p->model) *
               sizeof(real_t));
    f->gain = p->gains;
    composition_sensors_take_spread(p->sensors, composition_job_spread(job));
    f->certainty = *composition_job_certainty(job);
    apply_analyses(p);
    f->steady = p->settings->covariance == COVARIANCE_STEADY && !f->begins;
    if (f->count < UINT32_MAX)
        f->count++;
}

/* ---- the workspace, and work in it ---- */

static void lease_workspace(const struct composition_parts *p)
{
    struct composition_filter *f = p->filter;
    struct workspace *w = workspace_shared();
    const struct column_config *config = &composition_model_table(p->model)->config;
    void *memory = NULL;
    uint32_t bytes =
        composition_job_bytes(p->settings->covariance, config->stages, config->components - 1,
                              composition_model_extras(p->model));
    if (!w || workspace_lease_for_now(w, HOLDER, FREES, bytes, &f->lease, &memory) != ERR_OK) {
        f->refusals = (uint8_t)(f->refusals < UINT8_MAX ? f->refusals + 1u : UINT8_MAX);
        return;
    }
    f->refusals = 0;
    f->begins = true;
    f->job = composition_job_make(memory, p->model);
}

bool composition_filter_work(const struct composition_parts *p)
{
    struct composition_filter *f = p->filter;
    if (f->declined)
        return false;
    if (!f->job) {
        lease_workspace(p);
        return false;
    }
    return workspace_renew(workspace_shared(), f->lease) && composition_job_piece(f->job, p);
}

/* ---- what it has ---- */

const real_t *composition_filter_gain(const struct composition_filter *f)
{
    return f->gain;
}

real_t composition_filter_sd(const struct composition_filter *f, unsigned k)
{
    REFLUX_ASSERT(k < BLOCK_POINTS_MAX);
    return f->certainty.sd[k];
}

bool composition_filter_takes_analyses(const struct composition_filter *f)
{
    return f->gain && f->job && !f->declined;
}

bool composition_filter_is_unsure(const struct composition_parts *p)
{
    return composition_is_complete(p->settings) &&
           (!p->filter->gain ||
            !composition_model_expects_feed(p->model, p->settings->feed_z,
                                            composition_feed_f(p->settings, p->inputs)));
}

bool composition_filter_lacks_workspace(const struct composition_parts *p)
{
    const struct composition_filter *f = p->filter;
    return composition_is_complete(p->settings) && !f->job && !f->steady &&
           (f->declined || f->refusals > REFUSALS_MOST);
}

const char *composition_filter_describe(const struct composition_filter *f, size_t i, float *value)
{
    static const char *const names[COMPOSITION_FILTER_VALUES] = {"workspace", "cycles", "sd_least",
                                                                 "sd_most"};
    const float values[COMPOSITION_FILTER_VALUES] = {f->job ? 1.0f : 0.0f, (float)f->count,
                                                     f->certainty.least, f->certainty.most};
    if (i >= COMPOSITION_FILTER_VALUES)
        return NULL;
    *value = values[i];
    return names[i];
}
