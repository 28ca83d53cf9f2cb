/* Modes, setpoints and outputs of loops, and settings for one from a model of its process. */
#include "base/assertion.h"
#include "hal/tick.h"
#include "operate/operate_internal.h"

enum err operate_refuse_range(struct answer *answer, const char *subject, float value, float lo,
                              float hi, const char *unit)
{
    answer->subject = subject;
    answer->more = ANSWER_RANGE;
    answer->range.value = value;
    answer->range.lo = lo;
    answer->range.hi = hi;
    answer->range.unit = unit;
    return ERR_RANGE;
}

enum err operate_request(struct session *session, const struct request *request,
                         struct answer *answer)
{
    enum err err = service_request(session->door->service, request);
    return err ? operate_refuse(answer, err, NULL, QUEUE_FULL) : ERR_OK;
}

enum err operate_find_loop(const struct session *session, const char *name, uint8_t *loop,
                           struct answer *answer)
{
    *loop = config_find_loop(operate_settings(session), name);
    return *loop == PLAN_NONE ? operate_refuse(answer, ERR_UNKNOWN, name, NO_SUCH_LOOP) : ERR_OK;
}

static bool is_loop(const struct plan *plan, uint8_t loop)
{
    return loop < CONFIG_LOOPS && plan->loop[loop].used;
}

enum err operate_mode(struct session *session, uint8_t loop, enum loop_mode mode,
                      struct answer *answer)
{
    struct service *s = session->door->service;
    const struct plan *plan = service_plan(s);
    if (!is_loop(plan, loop))
        return operate_refuse(answer, ERR_UNKNOWN, NULL, NO_SUCH_LOOP);
    const char *name = plan->config.loop[loop].name;
    if ((unsigned)mode > LOOP_CASCADE)
        return operate_refuse_range(answer, name, (float)mode, 0.0f, (float)LOOP_CASCADE, "");
    if (mode != LOOP_MANUAL) {
        const char *what, *wanted;
        enum err err = service_may_act(s, loop, mode, &what, &wanted);
        if (err)
            return operate_refuse(answer, err, what, wanted);
    }
    struct request r = {
        .kind = REQUEST_MODE, .loop = loop, .output = PLAN_NONE, .mode = (uint8_t)mode};
    enum err err = operate_request(session, &r, answer);
    if (!err)
        operate_record(session, EVENT_DO_MODE, name, (float)mode);
    return err;
}

enum err operate_setpoint(struct session *session, uint8_t loop, float value, struct answer *answer)
{
    struct service *s = session->door->service;
    const struct plan *plan = service_plan(s);
    float lo, hi;
    if (!is_loop(plan, loop))
        return operate_refuse(answer, ERR_UNKNOWN, NULL, NO_SUCH_LOOP);
    const char *name = plan->config.loop[loop].name;
    plan_setpoint_limits(plan, loop, &lo, &hi);
    if (!(value >= lo && value <= hi))
        return operate_refuse_range(answer, name, value, lo, hi,
                                    plan->config.measurement[plan->loop[loop].pv].unit);
    enum loop_mode mode = service_mode(s, loop);
    if (mode == LOOP_CASCADE)
        return operate_refuse(answer, ERR_STATE, name,
                              "is in cascade, its setpoint comes from its outer loop");
    if (mode == LOOP_MANUAL && plan->config.loop[loop].sp_track)
        return operate_refuse(
            answer, ERR_STATE, name,
            "is in manual and its setpoint follows the measurement (sp_track on)");
    struct request r = {
        .kind = REQUEST_SETPOINT, .loop = loop, .output = PLAN_NONE, .value = value};
    enum err err = operate_request(session, &r, answer);
    if (!err)
        operate_record(session, EVENT_DO_SETPOINT, name, value);
    return err;
}

enum err operate_output(struct session *session, uint8_t loop, uint8_t output, float value,
                        struct answer *answer)
{
    struct service *s = session->door->service;
    const struct plan *plan = service_plan(s);
    const struct config *config = &plan->config;
    bool by_loop = output == PLAN_NONE;
    if (by_loop ? !is_loop(plan, loop) : output >= CHANNEL_MAX || !config->mv[output].name[0])
        return operate_refuse(answer, ERR_UNKNOWN, NULL, "no such loop or manipulated variable");
    const char *asked = by_loop ? config->loop[loop].name : config->mv[output].name;
    if (by_loop)
        output = plan->loop[loop].mv;
    else
        loop = plan->owner[output];
    if (loop != PLAN_NONE && service_mode(s, loop) != LOOP_MANUAL)
        return operate_refuse(answer, ERR_STATE, config->loop[loop].name,
                              "is not in manual; `mode NAME manual` first");
    const char *what, *wanted;
    /* By hand an output can be moved without the measurement of its loop. */
    enum err err = output != PLAN_NONE ? service_output_there(s, output, &what, &wanted)
                                       : service_may_act(s, loop, LOOP_MANUAL, &what, &wanted);
    if (err)
        return operate_refuse(answer, err, what, wanted);
    if (output == PLAN_NONE && service_mode(s, plan->loop[loop].inner) != LOOP_CASCADE)
        return operate_refuse(answer, ERR_STATE, asked,
                              "its output follows the inner loop while that is not in cascade");
    float lo, hi;
    const char *unit;
    if (output != PLAN_NONE) {
        plan_manual_limits(plan, output, &lo, &hi);
        unit = config->mv[output].unit;
    } else {
        plan_setpoint_limits(plan, plan->loop[loop].inner, &lo, &hi);
        unit = config->measurement[plan->loop[plan->loop[loop].inner].pv].unit;
    }
    if (!(value >= lo && value <= hi))
        return operate_refuse_range(answer, asked, value, lo, hi, unit);
    struct request r = {.kind = REQUEST_OUTPUT,
                        .loop = loop,
                        .output = loop == PLAN_NONE ? output : PLAN_NONE,
                        .value = value};
    err = operate_request(session, &r, answer);
    if (!err)
        operate_record(session, EVENT_DO_OUTPUT, asked, value);
    return err;
}

static void read_loop(const struct service *s, uint8_t loop, struct loop_reading *reading)
{
    REFLUX_ASSERT(loop < CONFIG_LOOPS && service_in_force(s)->loop[loop].pv < CHANNEL_MAX);
    const struct plan *plan = service_in_force(s);
    const struct loop_plan *p = &plan->loop[loop];
    const struct loop_state *l = &s->supervisor->loop[loop];
    const struct measurement_state *m = &s->supervisor->measurement[p->pv];
    const struct measurement_config *pv = &plan->config.measurement[p->pv];
    reading->mode = l->mode;
    reading->pv = pv;
    reading->value = span_to_eu(m->value, pv->lo, pv->hi);
    reading->quality = m->quality;
    reading->setpoint = span_to_eu(l->setpoint, pv->lo, pv->hi);
    reading->mv = NULL;
    reading->inner = p->inner;
    if (p->mv != PLAN_NONE) {
        const struct mv_config *o = &plan->config.mv[p->mv];
        reading->mv = o;
        reading->output = span_to_eu(s->supervisor->mv[p->mv].applied, o->lo, o->hi);
    } else {
        const struct measurement_config *inner = &plan->config.measurement[plan->loop[p->inner].pv];
        reading->output = span_to_eu(l->v, inner->lo, inner->hi);
    }
}

bool operate_loop(const struct session *session, uint8_t loop, struct loop_reading *reading)
{
    const struct service *s = session->door->service;
    hal_tick_lock();
    bool exists = is_loop(service_in_force(s), loop);
    if (exists)
        read_loop(s, loop, reading);
    hal_tick_unlock();
    return exists;
}

enum err operate_tune(const struct session *session, uint8_t loop, enum tuning_rule rule,
                      const struct fopdt *process, float lambda_s, struct tuning *tuning,
                      struct answer *answer)
{
    const struct plan *plan = service_plan(session->door->service);
    if (!is_loop(plan, loop))
        return operate_refuse(answer, ERR_UNKNOWN, NULL, NO_SUCH_LOOP);
    const struct loop_plan *p = &plan->loop[loop];
    const struct config *config = &plan->config;
    const struct measurement_config *m = &config->measurement[p->pv];
    float out_span;
    if (p->mv != PLAN_NONE) {
        out_span = config->mv[p->mv].hi - config->mv[p->mv].lo;
    } else {
        const struct measurement_config *inner = &config->measurement[plan->loop[p->inner].pv];
        out_span = inner->hi - inner->lo;
    }
    /* The rules work on fractions of span, as the loop does. */
    struct fopdt model = *process;
    model.gain = model.gain * out_span / (m->hi - m->lo);
    struct tuning_refusal reason = {NULL, NULL};
    enum err err = rule == TUNE_SIMC         ? tuning_simc_pi(&model, lambda_s, tuning, &reason)
                   : rule == TUNE_COHEN_COON ? tuning_cohen_coon_pi(&model, tuning, &reason)
                                             : tuning_cohen_coon_pid(&model, tuning, &reason);
    return err ? operate_refuse(answer, err, reason.field, reason.wanted) : ERR_OK;
}
