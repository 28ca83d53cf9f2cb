/* Sequences started, stopped, held and confirmed. */
#include "exchange/sequence_rows.h"
#include "operate/operate_internal.h"

static const char *const words[SEQUENCE_COMMANDS] = {
    [SEQUENCE_DO_START] = "start",     [SEQUENCE_DO_STOP] = "stop", [SEQUENCE_DO_HOLD] = "hold",
    [SEQUENCE_DO_GO] = "go",           [SEQUENCE_DO_SKIP] = "skip", [SEQUENCE_DO_ABORT] = "abort",
    [SEQUENCE_DO_CONFIRM] = "confirm",
};

const char *operate_sequence_word(enum sequence_command what)
{
    return words[what];
}

/* Why the sequence cannot do it, or NULL. An event reports what changes before the next tick. */
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
            return NO_PLANT;
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
