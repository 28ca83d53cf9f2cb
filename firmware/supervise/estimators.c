#include "supervise/estimators.h"

#include "exchange/span.h"
#include "supervise/numbered.h"
#include "supervise/validate.h"

/* Returns true if the input has given a number, or has been found bad: an estimator does not wait for a sensor that
 * is dead from the start. It waits for an analyser until the analyser's first turn. */
static bool input_has_come(const struct supervisor *s, uint8_t input)
{
    if (input & INPUT_IS_MV)
        return s->mv[input & ~INPUT_IS_MV].bound;
    const struct measurement_state *m = &s->measurement[input];
    return m->bound && (m->seen || m->alarm);
}

static void give_points(struct supervisor *s, uint8_t block, const struct gathered *g)
{
    const struct numbered_plan *r = numbered_at(s, block);
    bool there = true;
    for (uint8_t k = 0; k < r->inputs; k++)
        there = there && input_has_come(s, r->input[k]);
    for (uint8_t k = 0; k < r->points; k++) {
        uint8_t i = r->point[k];
        const struct measurement_config *m = &s->plan->config.measurement[i];
        struct reading reading = {span_to_eu(g->point[k], m->lo, m->hi),
                                  (enum quality)g->numbered.point_quality[k]};
        /* A point is bound once all inputs of its block have come, and stays so as long as they are bound. */
        s->measurement[i].bound = there || s->measurement[i].bound;
        validate_measurement(s, i, &reading);
    }
}

void estimators_step(struct supervisor *s)
{
    uint8_t end = plan_stage_end(s->plan, STAGE_ESTIMATE);
    for (uint8_t k = plan_stage_begin(s->plan, STAGE_ESTIMATE); k < end; k++) {
        uint8_t block = s->plan->listed[k];
        struct gathered g;
        gather_all(s, block, &g);
        if (s->block[block].must_follow && block_kind_at(s, block)->follow)
            block_kind_at(s, block)->follow(supervisor_block(s, block), &g.io);
        s->block[block].must_follow = false;
        numbered_step(s, block, &g);
        numbered_grant(s, block, &g);
        give_points(s, block, &g);
    }
}
