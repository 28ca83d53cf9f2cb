#include "filter.h"

#include <string.h>

#include "base/workspace.h"
#include "column.h"
#include "kinds/composition/composition_job.h"

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
    struct composition *c = &b->c;
    memset(&state, 0, sizeof state);
    workspace_init(&workspace, memory, bytes);
    workspace_share(&workspace);
    if (!bench_begin(c, stages, method, ALL_STAGES))
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
    c->gains.has_feed = extras > 0;
    c->gains.has_flow = extras > 2;
    c->gains.feed = c->gains.extras = (uint8_t)extras;
    c->linear.transition.of = state.numbers + c->sensors * composition_moved(c);
    c->linear.push = c->linear.transition.of + stages * STRIDE;
    b->filter.begins = true;
    return filter_workspace_bytes() <= bytes;
}

enum err filter_tick(const float *t)
{
    struct composition_block *b = &state.block;
    composition_take_gains(b);
    composition_keep_lease(b, true);
    enum err err = composition_step(&b->c, t);
    (void)composition_order(b);
    return err;
}

bool filter_piece(void)
{
    return composition_job_piece(&state.block);
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
    return f->job && f->job->phase == PHASE_DONE && !f->job->err && state.block.c.gains.of;
}

uint32_t filter_workspace_bytes(void)
{
    const struct composition *c = &state.block.c;
    return composition_job_bytes(state.block.s.covariance, c->table.config.stages, 2,
                                 c->gains.extras);
}

uint32_t filter_state_bytes(void)
{
    const struct composition *c = &state.block.c;
    size_t numbers = c->sensors * composition_moved(c);
    if (c->method == METHOD_KALMAN)
        numbers += c->table.config.stages * STRIDE + c->gains.feed * c->column.n_fractions;
    return (uint32_t)(sizeof state.block + numbers * sizeof(real_t));
}
