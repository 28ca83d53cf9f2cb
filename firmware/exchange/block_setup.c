#include "exchange/block_setup.h"
#include "exchange/numbered_setup.h"
#include "exchange/reach.h"

#include <string.h>

void plan_feedforward_span(const struct plan *plan, uint8_t element, float *lo, float *hi)
{
    uint8_t input = plan->feedforward[element].input;
    if (input & INPUT_IS_MV) {
        const struct mv_config *o = &plan->config.mv[input & (uint8_t)~INPUT_IS_MV];
        *lo = o->lo;
        *hi = o->hi;
        return;
    }
    *lo = plan->config.measurement[input].lo;
    *hi = plan->config.measurement[input].hi;
}

void plan_setup_own(const struct plan *plan, uint8_t i, struct block_instance *b)
{
    const struct loop_config *l = &plan->config.loop[i];
    const struct measurement_config *m = &plan->config.measurement[plan->loop[i].pv];
    b->setup.settings = &l->own;
    b->setup.interval_s = plan->tick_s * (float)l->divisor;
    b->setup.members = 1;
    b->setup.present = 1;
    b->setup.member[0] =
        (struct block_member){i, plan->loop[i].mv != PLAN_NONE, m->hi - m->lo, 1.0f};
}

void plan_setup_matrix(const struct plan *plan, struct block_setup *setup,
                       struct matrix_settings *matrix)
{
    matrix->d = plan->config.decoupler;
    setup->settings = matrix;
    setup->interval_s = plan->tick_s;
    setup->members = DECOUPLER_MAX;
    setup->present = 0;
    for (uint8_t i = 0; i < DECOUPLER_MAX; i++) {
        bool there = plan->loop[i].used && plan->loop[i].decouple;
        setup->present = (uint8_t)(setup->present | (there ? 1u << i : 0u));
        setup->member[i] =
            (struct block_member){i, true, 0.0f, there ? plan_own_reach(plan, i) : 0.0f};
    }
}

void plan_setup_feedforward(const struct plan *plan, uint8_t k, struct block_instance *b)
{
    const struct ff_config *f = &plan->config.feedforward[k];
    float lo, hi;
    plan_feedforward_span(plan, k, &lo, &hi);
    b->setup.settings = &b->settings;
    b->settings.element = (struct feedforward_settings){
        .gain = f->gain,
        .lead_s = f->lead_s,
        .lag_s = f->lag_s,
        .dead_time_s = f->dead_s,
        .reference = (f->reference - lo) / (hi - lo),
        .out_lo = f->lo,
        .out_hi = f->hi,
    };
    b->setup.interval_s = plan->tick_s;
    b->setup.members = 1;
    b->setup.present = 1;
    b->setup.member[0] = (struct block_member){PLAN_NONE, true, hi - lo, 0.0f};
}

void plan_block_setup(const struct plan *plan, uint8_t block, struct block_instance *b)
{
    if (block >= BLOCK_NUMBERED)
        plan_setup_numbered(plan, (uint8_t)(block - BLOCK_NUMBERED), &b->setup);
    else if (block >= BLOCK_FEEDFORWARDS)
        plan_setup_feedforward(plan, (uint8_t)(block - BLOCK_FEEDFORWARDS), b);
    else if (block == BLOCK_MATRIX)
        plan_setup_matrix(plan, &b->setup, &b->settings.matrix);
    else
        plan_setup_own(plan, block, b);
}
