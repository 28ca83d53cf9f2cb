#include "commission/commission.h"

#include "commission/acceptance.h"
#include "commission/background.h"
#include "commission/interim_fit.h"
#include "commission/lease.h"
#include "commission/model.h"
#include "commission/results.h"
#include "commission/start_stop.h"
#include "commission/tests.h"
#include "commission/watching.h"
#include "supervise/raise_gain.h"

#include <string.h>

_Static_assert(sizeof(struct commission_work) <= WORKSPACE_BYTES,
               "the board's workspace holds tests, analysis and the way back");

/* ---- main loop ---- */

/* Does a piece of the task that the tick has asked for. */
static bool startup_piece(void *commission)
{
    struct commission *c = commission;
    switch (background_task(&c->background)) {
    case TASK_INTERIM_FIT:
        return interim_fit_run(experiment_interim_fit(&c->work->experiment));
    case TASK_FIT:
        return model_piece(c);
    default:
        return analysis_job_piece(c);
    }
}

void commission_init(struct commission *c, struct event_queue *events, struct workspace *w)
{
    memset(c, 0, sizeof *c);
    status_init(&c->status, events);
    lease_init(&c->lease, w);
    c->work = w->memory;
    background_init(&c->background, COMMISSION_HOLDER, startup_piece, c);
}

struct job *commission_job(struct commission *c)
{
    return background_job(&c->background);
}

void commission_was_reset(struct commission *c)
{
    status_end(&c->status, REASON_RESET, NULL, REAL_C(0.0), 0);
}

bool commission_is_on_trial(const struct commission *c)
{
    return status_phase(&c->status) == COMMISSION_TRIAL ||
           requests_pending(&c->requests) == COMMISSION_ASK_TRIAL ||
           requests_want_old(&c->requests);
}

struct config *commission_old(struct commission *c)
{
    return &c->work->analysis.work.after.old;
}

enum err commission_may(const struct commission *c, enum commission_ask ask, const char **wanted)
{
    bool possible, old = requests_want_old(&c->requests);
    enum commission_phase phase = status_phase(&c->status);
    bool testing = status_is_testing(&c->status), trial = phase == COMMISSION_TRIAL;
    switch (ask) {
    case COMMISSION_ASK_BEGIN:
    case COMMISSION_ASK_RELAY:
        *wanted = old ? "the old settings wait for an open transaction: apply or abandon it"
                      : "start-up is running; `commission abort` ends it";
        possible = !testing && !trial && !old;
        break;
    case COMMISSION_ASK_PAUSE:
        *wanted = "only while an input is tested";
        possible = phase == COMMISSION_TESTING || phase == COMMISSION_RELAY;
        break;
    case COMMISSION_ASK_SKIP:
        *wanted = "only while an input is tested";
        possible = phase == COMMISSION_TESTING;
        break;
    case COMMISSION_ASK_RESUME:
        *wanted = "only after `commission pause`";
        possible = phase == COMMISSION_PAUSED;
        break;
    case COMMISSION_ASK_REPEAT:
        *wanted = "only while a later input is tested";
        possible = phase == COMMISSION_TESTING && inputs_can_repeat(&c->inputs);
        break;
    case COMMISSION_ASK_ABORT:
        *wanted = "start-up is not running";
        possible = testing || trial || phase == COMMISSION_WATCHING;
        break;
    case COMMISSION_ASK_WATCH:
        *wanted = "only after a trial that kept its loops, while its results are there";
        possible = commission_may_watch(c) && !old;
        break;
    case COMMISSION_ASK_TRIAL:
        *wanted = phase == COMMISSION_READY
                      ? "there is no proposal; `commission proposal` says why"
                      : "there is no proposal; `commission` shows the progress";
        possible = commission_has_proposal(c) && !old;
        break;
    default:
        *wanted = "there is nothing to reject";
        possible = phase == COMMISSION_READY;
        break;
    }
    return possible ? ERR_OK : ERR_STATE;
}

static bool needs_workspace(const struct commission *c)
{
    return requests_begin(&c->requests) || commission_is_on_trial(c) ||
           status_is_testing(&c->status) || status_phase(&c->status) == COMMISSION_WATCHING ||
           requests_pending(&c->requests) == COMMISSION_ASK_WATCH;
}

/* The command that frees the workspace; NULL: nobody needs the results. */
static const char *command_that_frees(const struct commission *c)
{
    if (requests_want_old(&c->requests))
        return "abandon"; /* an open transaction holds the old settings up */
    if (needs_workspace(c))
        return "commission abort";
    if (commission_has_proposal(c))
        return "commission reject";
    return status_is_unseen(&c->status) ? "commission discard" : NULL;
}

static void update_lease(struct commission *c)
{
    lease_frees(&c->lease, command_that_frees(c));
}

void commission_seen(struct commission *c)
{
    if (status_is_testing(&c->status))
        return; /* it goes on */
    status_set_unseen(&c->status, false);
    update_lease(c);
}

static enum err lease_memory(struct commission *c, const char **wanted)
{
    void *memory;
    enum err err = lease_take(&c->lease, sizeof *c->work, &memory);
    if (err)
        *wanted = NULL;
    else
        c->work = memory;
    return err;
}

enum err commission_put(struct commission *c, enum commission_ask ask, const char **wanted)
{
    enum commission_ask before = requests_pending(&c->requests);
    if (before != COMMISSION_ASK_NONE && ask != COMMISSION_ASK_ABORT) {
        *wanted = "the last request waits for the next sample";
        return ERR_BUSY;
    }
    if (before == COMMISSION_ASK_BEGIN || before == COMMISSION_ASK_RELAY ||
        before == COMMISSION_ASK_TRIAL) {
        requests_put(&c->requests, COMMISSION_ASK_NONE); /* not begun, so there is nothing to end */
        requests_set_want_old(&c->requests, before == COMMISSION_ASK_TRIAL);
        update_lease(c);
        return ERR_OK;
    }
    enum err err = commission_may(c, ask, wanted);
    if (!err && (ask == COMMISSION_ASK_BEGIN || ask == COMMISSION_ASK_RELAY))
        err = lease_memory(c, wanted);
    if (!err)
        requests_put(&c->requests, ask);
    return err;
}

enum err commission_discard(struct commission *c, const char **wanted)
{
    bool proposes = commission_has_proposal(c);
    *wanted = !lease_holds(&c->lease) ? "there is nothing to discard"
              : proposes ? "a proposal waits: `commission accept` or `commission reject`"
                         : "start-up is running; `commission abort` ends it";
    if (!lease_holds(&c->lease) || proposes || needs_workspace(c))
        return ERR_STATE;
    status_set_unseen(&c->status, false);
    update_lease(c);
    return ERR_OK;
}

static void pause_test(struct commission *c, struct supervisor *s)
{
    commission_release(c, s);
    background_give_up(&c->background);
    status_enter(&c->status, COMMISSION_PAUSED, s->time_ms);
}

/* The request would overwrite the memory that the background works on. */
static bool overwrites(enum commission_ask ask)
{
    return ask == COMMISSION_ASK_BEGIN || ask == COMMISSION_ASK_RELAY ||
           ask == COMMISSION_ASK_RESUME || ask == COMMISSION_ASK_SKIP ||
           ask == COMMISSION_ASK_REPEAT;
}

/* Takes the request, unless it no longer makes sense. */
static void take_ask(struct commission *c, struct supervisor *s)
{
    const char *wanted;
    enum commission_ask ask = requests_pending(&c->requests);
    if (ask == COMMISSION_ASK_TRIAL &&
        (int32_t)(s->plan->serial - requests_trial_serial(&c->requests)) < 0)
        return; /* its plan comes with a later tick */
    bool possible = commission_may(c, ask, &wanted) == ERR_OK;
    if (possible && overwrites(ask)) {
        background_give_up(&c->background);
        if (background_is_working(&c->background))
            return; /* a piece of the job that is given up still runs under this tick: next time */
    }
    requests_put(&c->requests, COMMISSION_ASK_NONE);
    if (!possible)
        return;
    switch (ask) {
    case COMMISSION_ASK_BEGIN:
        commission_begin(c, s);
        break;
    case COMMISSION_ASK_RELAY:
        commission_begin_relay(c, s);
        break;
    case COMMISSION_ASK_PAUSE:
        pause_test(c, s);
        break;
    case COMMISSION_ASK_RESUME:
        if (by_relay_is_latest(&c->by_relay))
            commission_start_relay(c, s);
        else
            commission_start_input(c, s);
        break;
    case COMMISSION_ASK_SKIP:
        commission_release(c, s);
        inputs_skip(&c->inputs);
        commission_next_input(c, s);
        break;
    case COMMISSION_ASK_REPEAT:
        commission_release(c, s);
        inputs_repeat(&c->inputs);
        commission_start_input(c, s);
        break;
    case COMMISSION_ASK_ABORT:
        if (status_phase(&c->status) == COMMISSION_TRIAL)
            commission_back_to_old(c, s, REASON_ASKED, NULL, REAL_C(0.0));
        else if (status_phase(&c->status) == COMMISSION_WATCHING)
            commission_end_watch(c, s, REASON_ASKED, NULL);
        else
            commission_end(c, s, REASON_ASKED, NULL, REAL_C(0.0));
        break;
    case COMMISSION_ASK_TRIAL:
        commission_begin_trial(c, s);
        break;
    case COMMISSION_ASK_WATCH:
        commission_begin_watch(c, s);
        break;
    default:
        status_rejected(&c->status);
        break;
    }
}

/* Ends tests or trial because of a disturbance. True: they are over. */
static bool is_disturbed(struct commission *c, struct supervisor *s)
{
    const char *subject;
    outputs_watch_spans(&c->outputs, s);
    if (status_phase(&c->status) == COMMISSION_TRIAL)
        return commission_acceptance_is_disturbed(c, s);
    if (!status_is_testing(&c->status))
        return false;
    enum commission_reason reason = commission_disturbance(c, s, &subject);
    if (reason != REASON_NOT)
        commission_end(c, s, reason, subject, REAL_C(0.0));
    return reason != REASON_NOT;
}

static void act(struct commission *c, struct supervisor *s)
{
    /* Disturbances come before requests, because another plan may lack the channels and loops of a request. */
    if (is_disturbed(c, s))
        return;
    if (requests_pending(&c->requests) != COMMISSION_ASK_NONE)
        take_ask(c, s);
    switch (status_phase(&c->status)) {
    case COMMISSION_TESTING:
        commission_test(c, s);
        break;
    case COMMISSION_RELAY:
        commission_relay(c, s);
        break;
    case COMMISSION_FITTING:
    case COMMISSION_ANALYSING:
        commission_wait_for_job(c, s);
        break;
    case COMMISSION_TRIAL:
        commission_acceptance(c, s);
        break;
    case COMMISSION_WATCHING:
        commission_watch(c, s);
        break;
    default:
        break;
    }
}

void commission_tick(struct commission *c, struct supervisor *s)
{
    act(c, s);
    bool trial = status_phase(&c->status) == COMMISSION_TRIAL;
    /* Whatever has ended the trial has ended the probe, too. */
    supervisor_raise_gain(s, trial ? adoption_raised(&c->adoption) : PLAN_NONE,
                          trial ? (float)c->work->analysis.config.probe : 0.0f);
    s->testing = status_is_testing(&c->status) || trial;
    s->proposal_waits = commission_has_proposal(c);
    update_lease(c);
}
