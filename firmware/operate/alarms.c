/* Alarms acknowledged and shelved. */
#include "exchange/alarm_names.h"
#include "operate/operate_internal.h"

static enum err alarm_request(struct session *session, const char *name, struct request *r,
                              struct answer *answer)
{
    r->loop = PLAN_NONE;
    r->output = name ? alarm_find(operate_settings(session), name) : PLAN_NONE;
    if (r->output == PLAN_NONE && (name || r->kind == REQUEST_SHELVE))
        return operate_refuse(answer, ERR_UNKNOWN, name,
                              "no such alarm; `list alarm` shows those configured");
    if (!(r->value >= 0.0f && r->value <= 86400.0f))
        return operate_refuse(answer, ERR_RANGE, NULL, SHELVE_WANTED);
    if (service_request(session->door->service, r) != ERR_OK)
        return operate_refuse(answer, ERR_BUSY, NULL, QUEUE_FULL);
    operate_record(session, EVENT_DO_ALARM, name ? name : "all", r->value);
    return ERR_OK;
}

enum err operate_acknowledge(struct session *session, const char *name, struct answer *answer)
{
    struct request r = {.kind = REQUEST_ACK};
    return alarm_request(session, name, &r, answer);
}

enum err operate_shelve(struct session *session, const char *name, float seconds,
                        struct answer *answer)
{
    struct request r = {.kind = REQUEST_SHELVE, .value = seconds};
    return alarm_request(session, name, &r, answer);
}
