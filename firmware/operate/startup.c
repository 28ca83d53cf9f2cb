/* Automatic start-up: requests to it, and the way back to the old settings. */
#include <string.h>

#include "commission/commission.h"
#include "commission/proposal.h"
#include "commission/trial_plan.h"
#include "commission/watching.h"
#include "hal/tick.h"
#include "operate/operate_internal.h"
#include "storage/storage.h"

#define CHANNELS_CHANGED "channels or spans have changed since the tests; begin again"

static const struct {
    const char *word;
    bool engineer;
} asks[] = {
    [COMMISSION_ASK_BEGIN] = {"begin", true},   [COMMISSION_ASK_PAUSE] = {"pause", false},
    [COMMISSION_ASK_RESUME] = {"resume", true}, [COMMISSION_ASK_SKIP] = {"skip", true},
    [COMMISSION_ASK_REPEAT] = {"repeat", true}, [COMMISSION_ASK_ABORT] = {"abort", false},
    [COMMISSION_ASK_REJECT] = {"reject", true},
};

const char *operate_startup_word(enum commission_ask what)
{
    return (unsigned)what < sizeof asks / sizeof asks[0] ? asks[what].word : NULL;
}

static enum err admit_to_startup(struct session *session, bool engineer, struct answer *answer)
{
    enum err err = engineer ? operate_admit(session, NULL, answer) : ERR_OK;
    if (err)
        answer->words = "only for engineers: `unlock KEY` first";
    return err;
}

/* The refusal is about start-up itself where nothing else is named. */
static enum err refuse_startup(struct answer *answer, enum err err, const char *subject,
                               const char *words)
{
    return operate_refuse(answer, err, subject ? subject : "commission", words);
}

/* Words a refusal of commission_put() to begin. */
static enum err refuse_begin(const struct session *session, struct answer *answer, enum err err,
                             const char *subject, const char *words)
{
    if (words)
        return refuse_startup(answer, err, subject, words);
    (void)!operate_refuse(answer, err, "workspace", NULL);
    answer->more = ANSWER_TAKEN;
    answer->workspace = session->door->service->workspace;
    return err;
}

static enum err startup_done(const struct session *session, const char *act)
{
    operate_record(session, EVENT_DO_COMMISSION, act, 0.0f);
    return ERR_OK;
}

enum err operate_startup(struct session *session, enum commission_ask what, struct answer *answer)
{
    struct service *s = session->door->service;
    const char *wanted = "", *subject = NULL;
    if (!operate_startup_word(what))
        return operate_refuse(answer, ERR_UNKNOWN, NULL, NULL);
    enum err err = admit_to_startup(session, asks[what].engineer, answer);
    if (err)
        return err;
    service_flush(s); /* what was applied before counts */
    hal_tick_lock();
    if (what == COMMISSION_ASK_BEGIN)
        err = commission_may_begin(s->supervisor, &subject, &wanted);
    if (!err)
        err = commission_put(s->commission, what, &wanted);
    hal_tick_unlock();
    return err ? refuse_begin(session, answer, err, subject, wanted)
               : startup_done(session, asks[what].word);
}

enum err operate_relay(struct session *session, uint8_t loop, struct answer *answer)
{
    struct service *s = session->door->service;
    struct commission *m = s->commission;
    const char *wanted = NO_SUCH_LOOP, *subject = NULL;
    enum err err = admit_to_startup(session, true, answer);
    if (err)
        return err;
    service_flush(s); /* what was applied before counts */
    if (loop >= CONFIG_LOOPS || !service_plan(s)->loop[loop].used)
        return operate_refuse(answer, ERR_UNKNOWN, NULL, wanted);
    hal_tick_lock();
    err = commission_may_relay(s->supervisor, loop, &subject, &wanted);
    if (!err)
        err = commission_put(m, COMMISSION_ASK_RELAY, &wanted);
    if (!err)
        requests_put_relay(&m->requests, loop, s->supervisor->plan->serial);
    hal_tick_unlock();
    return err ? refuse_begin(session, answer, err, subject, wanted)
               : startup_done(session, "relay");
}

/* The configuration the proposal goes into: an open transaction's as it stands, where the proposal was put into it
 * before; else a copy of the one in force with the proposal in it. NULL: *err says why not. */
static struct config *proposed(struct session *session, enum err *err, struct answer *answer)
{
    struct service *s = session->door->service;
    struct config *config = operate_stage(session, answer);
    *err = config ? ERR_OK : ERR_BUSY;
    if (*err || s->staging)
        return config;
    *err = proposal_write(s->commission, config);
    if (!*err)
        return config;
    *err = refuse_startup(answer, *err, NULL,
                          *err == ERR_FULL ? "the proposal has more loops than there are places"
                          : *err == ERR_CONFLICT
                              ? CHANNELS_CHANGED
                              : "there is no proposal; `commission` shows the progress");
    return NULL;
}

/* May a proposal be put on trial now? */
static enum err may_try(struct service *s, struct answer *answer)
{
    const char *wanted = "", *subject = NULL;
    service_flush(s);
    bool changed = !outputs_are_those_of(&s->commission->outputs, &service_plan(s)->config);
    hal_tick_lock();
    enum err err = commission_may(s->commission, COMMISSION_ASK_TRIAL, &wanted);
    if (!err && requests_pending(&s->commission->requests) != COMMISSION_ASK_NONE) {
        err = ERR_BUSY;
        wanted = "the last request waits for the next sample";
    }
    if (!err && s->io.state(s->io.context) != IO_READY) {
        err = ERR_STATE;
        wanted = NO_PLANT;
    }
    if (!err && changed) {
        err = ERR_CONFLICT;
        wanted = CHANNELS_CHANGED;
    }
    if (!err)
        err = commission_may_try(s->commission, s->supervisor, &subject, &wanted);
    hal_tick_unlock();
    return err ? refuse_startup(answer, err, subject, wanted) : ERR_OK;
}

/* With the proposal staged: it goes into force on trial. */
static enum err begin_trial(struct session *session, struct config *config, struct answer *answer)
{
    struct service *s = session->door->service;
    struct commission *m = s->commission;
    enum err err = proposal_prepare_trial(m, s->supervisor, config);
    if (err)
        return refuse_startup(answer, err, NULL,
                              err == ERR_CONFLICT
                                  ? CHANNELS_CHANGED
                                  : "a pair of the proposal has no loop in the open "
                                    "transaction; `abandon` it, then accept or edit");
    *commission_old(m) = service_plan(s)->config;
    err = operate_activate(session, answer);
    if (err)
        return err;
    operate_transaction_over(session->door, true);
    hal_tick_lock();
    requests_put_trial(&m->requests, service_plan(s)->serial);
    hal_tick_unlock();
    return startup_done(session, "accept");
}

enum err operate_accept(struct session *session, struct answer *answer)
{
    struct service *s = session->door->service;
    enum err err = admit_to_startup(session, true, answer);
    if (!err)
        err = may_try(s, answer);
    if (err)
        return err;
    if (s->staging && !s->staged_proposal)
        return operate_refuse(answer, ERR_STATE, NULL,
                              "the open transaction lacks the proposal: apply or abandon it");
    struct config *config = proposed(session, &err, answer);
    return err ? err : begin_trial(session, config, answer);
}

enum err operate_edit(struct session *session, struct answer *answer)
{
    struct service *s = session->door->service;
    enum err err = admit_to_startup(session, true, answer);
    if (err)
        return err;
    if (s->staging)
        return operate_refuse(answer, ERR_STATE, NULL, OPEN_ALREADY);
    (void)proposed(session, &err, answer);
    if (err)
        return err;
    s->staging = s->staged_proposal = true;
    session->door->editor = session;
    return startup_done(session, "edit");
}

enum err operate_watch(struct session *session, float hours, struct answer *answer)
{
    struct service *s = session->door->service;
    const char *wanted = "";
    enum err err = admit_to_startup(session, true, answer);
    if (err)
        return err;
    if (!(hours > 0.0f) || hours > (float)KEPT_WATCH_HOURS_MOST)
        return operate_refuse(answer, ERR_RANGE, "hours", "above 0, 1000 at most");
    service_flush(s); /* what was applied before counts */
    float samples = hours * 3600.0f / service_plan(s)->tick_s;
    hal_tick_lock();
    err = commission_may(s->commission, COMMISSION_ASK_WATCH, &wanted);
    if (!err && !outputs_plan_in_force(&s->commission->outputs, s->supervisor)) {
        err = ERR_STATE;
        wanted = "other settings are in force since the trial";
    }
    if (!err)
        commission_set_watch(s->commission, samples < 1.0f   ? 1u
                                            : samples > 4e9f ? 4000000000u
                                                             : (uint32_t)samples);
    if (!err)
        err = commission_put(s->commission, COMMISSION_ASK_WATCH, &wanted);
    hal_tick_unlock();
    return err ? refuse_startup(answer, err, NULL, wanted) : startup_done(session, "watch");
}

enum err operate_discard(struct session *session, struct answer *answer)
{
    const char *wanted = "";
    enum err err = admit_to_startup(session, true, answer);
    if (err)
        return err;
    hal_tick_lock();
    err = commission_discard(session->door->service->commission, &wanted);
    hal_tick_unlock();
    return err ? refuse_startup(answer, err, NULL, wanted) : startup_done(session, "discard");
}

void operate_startup_shown(const struct session *session)
{
    hal_tick_lock();
    commission_seen(session->door->service->commission);
    hal_tick_unlock();
}

struct startup_reading operate_startup_reading(const struct session *session)
{
    const struct commission *m = session->door->service->commission;
    struct startup_reading r;
    hal_tick_lock();
    r.phase = status_phase(&m->status);
    r.proposal = commission_has_proposal(m);
    r.reason = status_reason(&m->status);
    memcpy(r.subject, status_subject(&m->status), sizeof r.subject);
    hal_tick_unlock();
    return r;
}

bool operate_poll(struct operate *door)
{
    struct service *s = door->service;
    struct config_fault fault;
    if (!requests_want_old(&s->commission->requests) || !operate_settings_are_free(s))
        return false;
    enum err err = service_apply(s, commission_old(s->commission), &fault);
    if (err && !fault.group)
        return true; /* no room for it at the moment */
    requests_set_want_old(&s->commission->requests, false);
    if (err)
        service_record(s, EVENT_CONFIG_REFUSED, fault.group, (float)err, 0);
    return true;
}
