/* Alarms acknowledged and shelved; sequences told what to do. */
#include "exchange/alarm_names.h"
#include "exchange/sequence_rows.h"
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
        return operate_refuse(answer, ERR_BUSY, NULL, "too many requests wait for the next tick");
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

#if CONFIG_STEPS

static const char *const words[SEQUENCE_COMMANDS] = {
    [SEQUENCE_DO_START] = "start",     [SEQUENCE_DO_STOP] = "stop", [SEQUENCE_DO_HOLD] = "hold",
    [SEQUENCE_DO_GO] = "go",           [SEQUENCE_DO_SKIP] = "skip", [SEQUENCE_DO_ABORT] = "abort",
    [SEQUENCE_DO_CONFIRM] = "confirm",
};

const char *operate_sequence_word(enum sequence_command what)
{
    return words[what];
}

/* Why not, or NULL. What happens until the tick is told by an event. */
static const char *objection(const struct service *s, enum sequence_command what)
{
    const struct sequence *q = &s->supervisor->sequence;
    const struct plan *plan = service_plan(s);
    bool active = sequence_active(q);
    switch (what) {
    case SEQUENCE_DO_START:
    case SEQUENCE_DO_STOP:
        if (sequence_next(&plan->config, what == SEQUENCE_DO_START ? SEQUENCE_START : SEQUENCE_STOP,
                          -1) == PLAN_NONE)
            return "no row is configured for it; `help step1.seq`";
        if (s->io.state(s->io.context) != IO_READY)
            return "no plant is connected";
        if (s->supervisor->testing)
            return "automatic start-up is under way; `commission abort` ends it";
        if (active && (what == SEQUENCE_DO_START || q->kind == SEQUENCE_STOP))
            return "a sequence is under way; `seq` shows it";
        for (uint8_t i = 0; i < CONFIG_LOOPS && what == SEQUENCE_DO_START; i++)
            if (plan->loop[i].used && service_mode(s, i) != LOOP_MANUAL)
                return "a start-up begins with all loops in manual; `loop` shows them";
        return NULL;
    case SEQUENCE_DO_GO:
        return q->state == SEQUENCE_HELD ? NULL : "no sequence is held";
    case SEQUENCE_DO_CONFIRM:
        return q->state == SEQUENCE_CONFIRM ? NULL : "nothing waits to be confirmed";
    case SEQUENCE_DO_HOLD:
        if (q->state == SEQUENCE_HELD)
            return "is held already";
        /* fall through */
    default:
        return active ? NULL : "no sequence is under way";
    }
}

enum err operate_sequence(struct session *session, enum sequence_command what,
                          struct answer *answer)
{
    struct service *s = session->door->service;
    if ((unsigned)what >= SEQUENCE_COMMANDS)
        return operate_refuse(answer, ERR_UNKNOWN, NULL, NULL);
    enum err err = what == SEQUENCE_DO_SKIP ? operate_admit(session, "seq skip", answer) : ERR_OK;
    if (err)
        return err;
    const char *reason = objection(s, what);
    if (reason)
        return operate_refuse(answer, ERR_STATE, words[what], reason);
    struct request r = {.kind = REQUEST_SEQUENCE,
                        .loop = PLAN_NONE,
                        .output = s->supervisor->sequence.step,
                        .mode = (uint8_t)what};
    err = operate_request(session, &r, answer);
    if (!err)
        operate_record(session, EVENT_DO_SEQUENCE, words[what], 0.0f);
    return err;
}

#endif
