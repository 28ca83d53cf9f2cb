#include "filter.h"

#include <string.h>

#include "base/workspace.h"
#include "column.h"
#include "kinds/composition/composition_job_state.h"

#define EXTRAS 3
#define STATES (2 * COLUMN_STAGES_MAX)
#define STRIDE ((size_t)3 * 2 * 2 + 2) /* column_transition_stride() of two mole fractions */

/* A block, with gains and a linear model behind it as the kind has them. */
static struct {
    struct composition_block block;
    real_t
        numbers[BENCH_SENSORS * (STATES + EXTRAS) + COLUMN_STAGES_MAX * STRIDE + EXTRAS * STATES];
} state;
static struct workspace workspace;

struct composition_block *const filter_block = &state.block;

bool filter_begin(size_t stages, enum composition_method method,
                  enum composition_covariance covariance, size_t extras, void *memory,
                  uint32_t bytes)
{
    struct composition_block *b = &state.block;
    struct composition_model *m = &b->model;
    memset(&state, 0, sizeof state);
    workspace_init(&workspace, memory, bytes);
    workspace_share(&workspace);
    if (!bench_begin(b, stages, method, ALL_STAGES))
        return false;
    b->s.method = (uint8_t)method;
    b->s.covariance = (uint8_t)covariance;
    b->s.feed_z = extras > 0 ? 0.02f : 0;
    b->s.feed_f = extras > 2 ? 0.05f : 0;
    b->s.feed_s = 7200;
    b->points = 2; /* what goes out of both ends */
    b->s.point[0][AT_STAGE] = 1;
    b->s.point[0][OF_COMPONENT] = 2;
    b->s.point[1][AT_STAGE] = (uint16_t)stages;
    b->s.point[1][OF_COMPONENT] = 1;
    m->has_feed = extras > 0;
    m->has_flow = extras > 2;
    m->feed = m->extras = (uint8_t)extras;
    m->linear.transition.factors = state.numbers + b->sensors.n * composition_model_length(m);
    m->linear.push = m->linear.transition.factors + stages * STRIDE;
    b->filter.begins = true;
    return filter_workspace_bytes() <= bytes;
}

static struct composition_parts filter_parts(void)
{
    return whole_parts(&state.block);
}

enum err filter_tick(const float *t)
{
    struct composition_block *b = &state.block;
    struct composition_parts p = filter_parts();
    composition_filter_take(&p);
    composition_filter_keep(&p, true);
    enum err err = whole_step(b, t);
    (void)composition_filter_order(&p);
    return err;
}

bool filter_piece(void)
{
    struct composition_parts p = filter_parts();
    return composition_filter_work(&p);
}

void filter_job(void)
{
    while (filter_piece()) {
    }
}

unsigned filter_phase(void)
{
    return state.block.filter.job ? state.block.filter.job->phase : (unsigned)PHASE_DONE;
}

bool filter_is_well(void)
{
    const struct composition_filter *f = &state.block.filter;
    return f->job && f->job->phase == PHASE_DONE && !f->job->err && state.block.filter.gain;
}

uint32_t filter_workspace_bytes(void)
{
    const struct composition_block *c = &state.block;
    return composition_job_bytes(state.block.s.covariance, c->model.table.config.stages, 2,
                                 c->model.extras);
}

uint32_t filter_state_bytes(void)
{
    const struct composition_block *c = &state.block;
    size_t numbers = c->sensors.n * composition_model_length(&c->model);
    if (c->sensors.method == METHOD_KALMAN)
        numbers +=
            c->model.table.config.stages * STRIDE + c->model.feed * c->model.column.n_fractions;
    return (uint32_t)(sizeof state.block + numbers * sizeof(real_t));
}
