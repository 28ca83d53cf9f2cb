/* Settings of a loop that nobody has set yet: would they come into force? */
#include "operate/operate_internal.h"

/* Compares a value with the range of its parameter, which is the same for all loops. */
static enum err check_tuned(const char *first, float value, struct answer *answer)
{
    struct parameter p;
    if (parameter_find(first, &p) != ERR_OK ||
        (value >= parameter_lo(&p) && value <= parameter_hi(&p)))
        return ERR_OK;
    return operate_refuse_range(answer, p.field->name, value, parameter_lo(&p), parameter_hi(&p),
                                parameter_unit(&p));
}

enum err operate_check_tuning(struct session *session, uint8_t loop, const struct tuning *tuning,
                              struct answer *answer)
{
    struct service *s = session->door->service;
    enum err err = check_tuned("loop1.gain", tuning->gain, answer);
    if (!err)
        err = check_tuned("loop1.ti", tuning->ti_s, answer);
    if (!err)
        err = check_tuned("loop1.td", tuning->td_s, answer);
    if (err || !operate_settings_are_free(s))
        return err;
    struct config *next = service_stage(s);
    next->loop[loop].own.gain = tuning->gain;
    next->loop[loop].own.ti_s = tuning->ti_s;
    next->loop[loop].own.td_s = tuning->td_s;
    next->loop[loop].own.action = (uint8_t)tuning->action;
    err = operate_keep_acting_loops(s, next, &answer->config);
    if (!err)
        err = service_check(s, next, &answer->config);
    answer->more = ANSWER_CONFIG;
    return err;
}
