#include "commission/commission.h"

#include "commission/model.h"
#include "exchange/config.h"

#include "commission/commission_internal.h"

#include <string.h>

static const char *const reason_texts[REASON_COUNT] = {
    [REASON_NOT] = "",
    [REASON_ASKED] = "asked for",
    [REASON_SAFE] = "safe state",
    [REASON_LOST] = "measurement is not valid",
    [REASON_INTERLOCK] = "an interlock holds the output",
    [REASON_ACTUATOR] = "the output does not follow its command",
    [REASON_HAND] = "moved by somebody else",
    [REASON_CONFIG] = "another configuration was applied",
    [REASON_RESTLESS] = "does not come to rest before the test",
    [REASON_LIMIT] = "went past its test limit",
    [REASON_AWAY] = "does not come back after the test: unstable or integrating",
    [REASON_INTEGRATES] =
        "integrates, or is many times slower than `test.longest`: it must come to rest by itself",
    [REASON_TOO_SLOW] =
        "is slower than `test.longest` or its `test_time` allows: set more, or leave it out",
    [REASON_LEFT] =
        "is farther from where it was than its drift explains: bring it back, and begin anew",
    [REASON_SPAN] = "reads an end of its span, not the plant: widen the span, or repair the sensor",
    [REASON_REVERSAL] =
        "would go past its test limit at the reversal: a smaller `test_step`, or a wider limit",
    [REASON_NO_INPUT] = "every input was skipped",
    [REASON_NUMBERS] = "the analysis refused the model",
    [REASON_SAMPLES] = "samples were missing",
    [REASON_RESET] = "the board was reset",
    [REASON_TRIAL_LIMIT] = "went past its test limit on trial",
    [REASON_TRIAL_SLOW] = "took far longer than predicted on trial",
    [REASON_TRIAL_PEAK] = "overshot far more than predicted on trial",
    [REASON_TRIAL_REST] = "did not come to rest on trial",
    [REASON_TRIAL_ROOM] = "an output stood at its limit on trial",
    [REASON_SEQUENCE] = "a sequence is under way; `seq` shows it",
    [REASON_EXCITED] =
        "excites the plant; `block BLOCK off` ends that, or a change of mode of its loop",
    [REASON_TRIAL_SWINGS] = "oscillated on trial without decaying fast enough",
    [REASON_NO_ANSWER] =
        "its measurement does not answer to the relay, or its action is the wrong one",
    [REASON_ACTION] =
        "its action is the wrong one, the measurement went the other way: change `action`",
    [REASON_NO_CYCLE] = "no steady cycle under the relay",
};

const char *commission_reason_text(enum commission_reason reason)
{
    return reason < REASON_COUNT ? reason_texts[reason] : "";
}

_Static_assert(sizeof(struct commission_work) <= WORKSPACE_BYTES,
               "the board's workspace holds tests, analysis and the way back");

void commission_init(struct commission *c, struct event_queue *events, struct workspace *w)
{
    memset(c, 0, sizeof *c);
    c->events = events;
    c->workspace = w;
    c->work = w->memory;
    job_init(&c->job, COMMISSION_HOLDER, model_work, c);
}

void commission_was_reset(struct commission *c)
{
    c->phase = COMMISSION_ENDED;
    c->reason = REASON_RESET;
    event_put(c->events, 0, EVENT_COMMISSION_ENDED, NULL, 0.0f, REASON_RESET);
}

bool commission_is_testing(const struct commission *c)
{
    return c->phase == COMMISSION_TESTING || c->phase == COMMISSION_RELAY ||
           c->phase == COMMISSION_FITTING || c->phase == COMMISSION_ANALYSING ||
           c->phase == COMMISSION_PAUSED;
}

static bool holds(const struct commission *c)
{
    return !c->lost && workspace_holds(c->workspace, COMMISSION_HOLDER);
}

bool commission_has_proposal(const struct commission *c)
{
    return c->phase == COMMISSION_READY && holds(c) && c->work->analysis.designed;
}

enum err commission_may(const struct commission *c, enum commission_ask ask, const char **wanted)
{
    bool possible;
    switch (ask) {
    case COMMISSION_ASK_BEGIN:
    case COMMISSION_ASK_RELAY:
        *wanted = c->wants_old
                      ? "the old settings are on their way back; an open transaction holds "
                        "them up: apply or abandon it"
                      : "is under way already; `commission abort` first";
        possible = !commission_is_testing(c) && c->phase != COMMISSION_TRIAL && !c->wants_old;
        break;
    case COMMISSION_ASK_PAUSE:
        *wanted = "only while an input is tested";
        possible = c->phase == COMMISSION_TESTING || c->phase == COMMISSION_RELAY;
        break;
    case COMMISSION_ASK_SKIP:
        *wanted = "only while an input is tested";
        possible = c->phase == COMMISSION_TESTING;
        break;
    case COMMISSION_ASK_RESUME:
        *wanted = "only after `commission pause`";
        possible = c->phase == COMMISSION_PAUSED;
        break;
    case COMMISSION_ASK_REPEAT:
        *wanted = "only while a later input is tested";
        possible = c->phase == COMMISSION_TESTING && c->at > 0;
        break;
    case COMMISSION_ASK_ABORT:
        *wanted = "nothing is under way";
        possible = commission_is_testing(c) || c->phase == COMMISSION_TRIAL;
        break;
    case COMMISSION_ASK_TRIAL:
        *wanted = "there is no proposal; `commission` says how far it is";
        possible = commission_has_proposal(c) && !c->wants_old;
        break;
    default:
        *wanted = "there is nothing to reject";
        possible = c->phase == COMMISSION_READY;
        break;
    }
    return possible ? ERR_OK : ERR_STATE;
}

/* Only a new beginning overwrites them, and only the main loop asks for one. */
static bool begins(const struct commission *c)
{
    return c->ask == COMMISSION_ASK_BEGIN || c->ask == COMMISSION_ASK_RELAY;
}

bool commission_keeps(const struct commission *c)
{
    return !begins(c) && holds(c);
}

bool commission_had_results(const struct commission *c)
{
    return c->analysed && !begins(c);
}

bool commission_has_results(const struct commission *c)
{
    return commission_had_results(c) && holds(c);
}

static bool needs_workspace(const struct commission *c)
{
    bool in_acceptance = c->phase == COMMISSION_TRIAL || c->ask == COMMISSION_ASK_TRIAL;
    return begins(c) || in_acceptance || c->wants_old || commission_is_testing(c);
}

/* What frees the workspace now; NULL: nobody needs what is there. */
static const char *command_that_frees(const struct commission *c)
{
    if (c->wants_old)
        return "abandon"; /* what holds the way back up is a transaction */
    if (needs_workspace(c))
        return "commission abort";
    if (commission_has_proposal(c))
        return "commission reject";
    return c->unseen ? "commission discard" : NULL;
}

static void update_lease(struct commission *c)
{
    workspace_frees(c->workspace, COMMISSION_HOLDER, command_that_frees(c));
}

void commission_seen(struct commission *c)
{
    if (commission_is_testing(c))
        return; /* it goes on */
    c->unseen = false;
    update_lease(c);
}

/* What was there is gone where somebody else has had it. */
static enum err lease(struct commission *c, const char **wanted)
{
    void *memory;
    bool held = holds(c);
    enum err err = workspace_lease(c->workspace, COMMISSION_HOLDER, "commission abort",
                                   sizeof *c->work, &memory);
    *wanted = err ? NULL : *wanted;
    if (!err) {
        c->work = memory;
        c->lost = !held;
    }
    return err;
}

enum err commission_put(struct commission *c, enum commission_ask ask, const char **wanted)
{
    enum commission_ask before = (enum commission_ask)c->ask;
    if (before != COMMISSION_ASK_NONE && ask != COMMISSION_ASK_ABORT) {
        *wanted = "what was asked before waits for the next sample";
        return ERR_BUSY;
    }
    if (before == COMMISSION_ASK_BEGIN || before == COMMISSION_ASK_RELAY ||
        before == COMMISSION_ASK_TRIAL) {
        c->ask = COMMISSION_ASK_NONE; /* not begun, so there is nothing to end */
        c->wants_old = before == COMMISSION_ASK_TRIAL;
        update_lease(c);
        return ERR_OK;
    }
    enum err err = commission_may(c, ask, wanted);
    if (!err && (ask == COMMISSION_ASK_BEGIN || ask == COMMISSION_ASK_RELAY))
        err = lease(c, wanted);
    if (!err)
        c->ask = (uint8_t)ask;
    return err;
}

enum err commission_discard(struct commission *c, const char **wanted)
{
    bool proposes = commission_has_proposal(c);
    *wanted = !holds(c)  ? "there is nothing to be given up"
              : proposes ? "a proposal waits: `commission accept` or `commission reject`"
                         : "is under way; `commission abort` first";
    if (!holds(c) || proposes || needs_workspace(c))
        return ERR_STATE;
    c->unseen = false;
    update_lease(c);
    return ERR_OK;
}

void commission_release(struct commission *c, struct supervisor *s)
{
    for (uint8_t k = 0; k < c->inputs; k++)
        supervisor_excite(s, c->input[k].output, num_zero());
}

void commission_end(struct commission *c, struct supervisor *s, enum commission_reason reason,
                    const char *subject, real_t value)
{
    bool in_acceptance = c->phase == COMMISSION_TRIAL;
    commission_release(c, s);
    /* An interlock or the operator may have moved what was held; back to it, unless somebody else decides now. */
    bool others =
        in_acceptance || reason == REASON_HAND || reason == REASON_CONFIG || reason == REASON_SAFE;
    for (uint8_t k = 0; k < c->inputs && !others; k++)
        s->mv[c->input[k].output].manual = num_from_float(c->input[k].test_base);
    for (uint8_t k = 0; k < c->inputs && !in_acceptance; k++)
        c->unseen = c->unseen || c->input[k].rounds > 0; /* a part of the model */
    c->phase = COMMISSION_ENDED;
    c->reason = reason;
    c->value = value;
    memset(c->subject, 0, sizeof c->subject);
    for (unsigned i = 0; subject && subject[i] && i + 1 < sizeof c->subject; i++)
        c->subject[i] = subject[i];
    job_give_up(&c->job);
    c->ended_ms = s->time_ms;
    event_put(c->events, s->time_ms, in_acceptance ? EVENT_TRIAL_FAILED : EVENT_COMMISSION_ENDED,
              subject, value, (uint8_t)reason);
}

static void pause_test(struct commission *c, struct supervisor *s)
{
    commission_release(c, s);
    job_give_up(&c->job);
    c->phase = COMMISSION_PAUSED;
    c->phase_ms = s->time_ms;
}

/* Does it put something else into the memory that the background works on? */
static bool overwrites(enum commission_ask ask)
{
    return ask == COMMISSION_ASK_BEGIN || ask == COMMISSION_ASK_RELAY ||
           ask == COMMISSION_ASK_RESUME || ask == COMMISSION_ASK_SKIP ||
           ask == COMMISSION_ASK_REPEAT;
}

/* What was asked for may not make sense any more. */
static void take_ask(struct commission *c, struct supervisor *s)
{
    const char *wanted;
    enum commission_ask ask = (enum commission_ask)c->ask;
    if (ask == COMMISSION_ASK_TRIAL && (int32_t)(s->plan->serial - c->trial_serial) < 0)
        return; /* its plan comes with a later tick */
    bool possible = commission_may(c, ask, &wanted) == ERR_OK;
    if (possible && overwrites(ask)) {
        job_give_up(&c->job);
        if (job_is_working(&c->job))
            return; /* a piece of the job that is given up still runs under this tick: next time */
    }
    c->ask = COMMISSION_ASK_NONE;
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
        if (c->by_relay.on)
            commission_start_relay(c, s);
        else
            commission_start_input(c, s);
        break;
    case COMMISSION_ASK_SKIP:
        commission_release(c, s);
        c->input[c->order[c->at]].skipped = true;
        commission_next_input(c, s);
        break;
    case COMMISSION_ASK_REPEAT:
        commission_release(c, s);
        c->at--;
        c->input[c->order[c->at]].rounds = 0;
        c->input[c->order[c->at]].skipped = false;
        commission_start_input(c, s);
        break;
    case COMMISSION_ASK_ABORT:
        if (c->phase == COMMISSION_TRIAL)
            commission_back_to_old(c, s, REASON_ASKED, NULL, REAL_C(0.0));
        else
            commission_end(c, s, REASON_ASKED, NULL, REAL_C(0.0));
        break;
    case COMMISSION_ASK_TRIAL:
        commission_begin_trial(c, s);
        break;
    default:
        c->phase = COMMISSION_IDLE;
        c->unseen = false;
        break;
    }
}

/* True: what was under way is over. */
static bool is_disturbed(struct commission *c, struct supervisor *s)
{
    const char *subject;
    commission_watch_spans(c, s);
    if (c->phase == COMMISSION_TRIAL)
        return commission_acceptance_is_disturbed(c, s);
    if (!commission_is_testing(c))
        return false;
    enum commission_reason reason = commission_disturbance(c, s, &subject);
    if (reason != REASON_NOT)
        commission_end(c, s, reason, subject, REAL_C(0.0));
    return reason != REASON_NOT;
}

static void act(struct commission *c, struct supervisor *s)
{
    /* Before anything that was asked: in another plan the channels and loops that it is about may not be there. */
    if (is_disturbed(c, s))
        return;
    if (c->ask != COMMISSION_ASK_NONE)
        take_ask(c, s);
    if (c->phase == COMMISSION_TESTING)
        commission_test(c, s);
    else if (c->phase == COMMISSION_RELAY)
        commission_relay(c, s);
    else if (c->phase == COMMISSION_FITTING || c->phase == COMMISSION_ANALYSING)
        commission_wait_for_job(c, s);
    else if (c->phase == COMMISSION_TRIAL)
        commission_acceptance(c, s);
}

void commission_tick(struct commission *c, struct supervisor *s)
{
    act(c, s);
    s->testing = commission_is_testing(c) || c->phase == COMMISSION_TRIAL;
    update_lease(c);
}
