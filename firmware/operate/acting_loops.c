/* Settings that must not change while a loop acts. */
#include <string.h>

#include "exchange/calibration.h"
#include "operate/operate_internal.h"

/* A channel that stands in both configurations keeps its unit, its span and its calibration. */
static bool keeps_pv(const struct config *a, const struct config *b, const char *name)
{
    uint8_t i = config_find_measurement(a, name), k = config_find_measurement(b, name);
    if (i == PLAN_NONE || k == PLAN_NONE)
        return true;
    const struct measurement_config *x = &a->measurement[i], *y = &b->measurement[k];
    return strcmp(x->unit, y->unit) == 0 && x->lo == y->lo && x->hi == y->hi &&
           same_calibration(x, y);
}

static bool keeps_mv(const struct config *a, const struct config *b, const char *name)
{
    uint8_t i = config_find_mv(a, name), k = config_find_mv(b, name);
    if (i == PLAN_NONE || k == PLAN_NONE)
        return true;
    const struct mv_config *x = &a->mv[i], *y = &b->mv[k];
    return strcmp(x->unit, y->unit) == 0 && x->lo == y->lo && x->hi == y->hi;
}

/* The PV, or what the loop drives, has another name. A name that nothing has is left to the plan, which refuses it in better words. */
static bool another_pv(const struct config *new, const char *before, const char *name)
{
    return strcmp(before, name) != 0 && config_find_measurement(new, name) != PLAN_NONE;
}

static bool another_out(const struct config *new, const char *before, const char *name)
{
    return strcmp(before, name) != 0 &&
           (config_find_mv(new, name) != PLAN_NONE || config_find_loop(new, name) != PLAN_NONE);
}

/* Returns the field of loop i that another configuration changes although it must not change while the loop acts; NULL: none. */
static const char *field_turned(const struct config *old, const struct config *new, uint8_t i)
{
    const struct loop_config *a = &old->loop[i], *b = &new->loop[i];
    if (strcmp(a->name, b->name) != 0)
        return NULL; /* another loop */
    if (another_pv(new, a->pv, b->pv) || !keeps_pv(old, new, a->pv))
        return "pv";
    if (another_out(new, a->out, b->out) || !keeps_mv(old, new, a->out))
        return "out";
    return a->own.action != b->own.action ? "action" : NULL;
}

enum err operate_keep_acting_loops(const struct service *s, const struct config *next,
                                   struct config_fault *fault)
{
    const struct config *old = &service_plan(s)->config;
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++) {
        const char *field = old->loop[i].name[0] ? field_turned(old, next, i) : NULL;
        if (!field || service_mode(s, i) == LOOP_MANUAL)
            continue;
        *fault = (struct config_fault){.code = ERR_STATE,
                                       .group = "loop",
                                       .index = (uint8_t)(i + 1u),
                                       .field = field,
                                       .wanted =
                                           "acts: its action, PV, MV, units, spans and calibration "
                                           "change in manual only; `mode LOOP manual` first"};
        memcpy(fault->subject, old->loop[i].name, CHANNEL_NAME_SIZE);
        return ERR_STATE;
    }
    return ERR_OK;
}
