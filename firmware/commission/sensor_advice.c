#include "commission/sensor_advice.h"

#include "base/assertion.h"
#include "commission/commission_state.h"
#include "commission/lease.h"
#include "commission/next_test.h"
#include "commission/sensor_watch.h"
#include "commission/status.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"

#define STEPS_WANTED REAL_C(6.0) /* steps of a coarse sensor that a response must have */
/* A response below LOST_FLOORS times the noise floor is lost in a span that is too wide. It should be SHOWN_SHARE of its span. */
#define LOST_FLOORS REAL_C(20.0)
#define SHOWN_SHARE REAL_C(0.1)
#define MOVED_SDS   REAL_C(3.0) /* a gain nearer to 0 may be none */

unsigned sensor_advices(const struct commission *c, const struct supervisor *s)
{
    bool there = status_phase(&c->status) != COMMISSION_IDLE && lease_holds(&c->lease) &&
                 outputs_are_those_of(&c->outputs, &s->plan->config);
    return there ? outputs_count(&c->outputs) : 0u;
}

bool sensor_advice_of(const struct commission *c, const struct supervisor *s, uint8_t j,
                      struct sensor_advice *advice)
{
    REFLUX_ASSERT(j < outputs_count(&c->outputs));
    const struct measurement_config *m =
        &s->plan->config.measurement[outputs_measurement(&c->outputs, j)];
    const struct sensor_watch *w = &c->work->sensor[j];
    *advice = (struct sensor_advice){.step_share = sensor_watch_coarse(w),
                                     .renewal = sensor_watch_noted(w)};
    real_t largest = REAL_C(0.0);
    bool tested = false;
    for (uint8_t k = 0; k < inputs_count(&c->inputs); k++) {
        const struct tested_input *in = inputs_get(&c->inputs, k);
        const struct element *e = &c->work->element[j][k];
        real_t gain = real_abs(e->found.shape.gain);
        if (in->rounds == 0)
            continue;
        tested = true;
        real_t moved = gain * in->amplitude;
        if (moved > advice->moved_share && gain >= MOVED_SDS * e->found.sd[SHAPE_GAIN])
            advice->moved_share = moved;
        if ((e->flags & IDENTIFIED_NO_GAIN) || !(gain > largest))
            continue;
        const struct mv_config *o = &s->plan->config.mv[in->output];
        largest = gain;
        advice->input = in->output;
        advice->step_least = STEPS_WANTED * advice->step_share / largest * (o->hi - o->lo);
    }
    if (tested && advice->moved_share < LOST_FLOORS * NOISE_FLOOR &&
        advice->moved_share > REAL_C(0.0))
        advice->span_wanted = (m->hi - m->lo) * advice->moved_share / SHOWN_SHARE;
    return advice->step_share > REAL_C(0.0) || advice->renewal > 1u ||
           advice->span_wanted > REAL_C(0.0);
}

enum sensor_fault sensor_fault_of(const struct sensor_advice *a, real_t *value)
{
    *value = a->renewal > 1u               ? (real_t)a->renewal
             : a->step_share > REAL_C(0.0) ? a->step_share
                                           : a->moved_share;
    return a->renewal > 1u               ? SENSOR_RARE
           : a->step_share > REAL_C(0.0) ? SENSOR_COARSE
                                         : SENSOR_LOST;
}
