/* `commission`: automatic start-up from the console. */
#include <string.h>

#include "commission/proposal.h"
#include "hal/tick.h"
#include "console/console.h"
#include "service/storage.h"

#if COMMISSION_CHANNELS

static const char *const phases[] = {
    [COMMISSION_IDLE] = "idle",           [COMMISSION_TESTING] = "testing",
    [COMMISSION_RELAY] = "relay",         [COMMISSION_FITTING] = "fitting",
    [COMMISSION_ANALYSING] = "analysing", [COMMISSION_PAUSED] = "paused",
    [COMMISSION_READY] = "ready",         [COMMISSION_TRIAL] = "trial",
    [COMMISSION_KEPT] = "kept",           [COMMISSION_RETURNED] = "returned",
    [COMMISSION_ENDED] = "ended",
};

static const char *const stages[] = {
    [EXPERIMENT_REST] = "waits for rest", [EXPERIMENT_UP] = "positive half",
    [EXPERIMENT_DOWN] = "negative half",  [EXPERIMENT_BACK] = "back, waits for rest",
    [EXPERIMENT_DONE] = "done",           [EXPERIMENT_FAILED] = "failed",
};

static void number(struct text *t, const char *before, float x, const char *unit)
{
    text_str(t, before);
    text_float(t, x);
    text_str(t, unit);
}

static float output_span(const struct output_config *o)
{
    return o->hi - o->lo;
}

/* The test may end, and its memory go to the analysis, at any time. */
static void test_line(const struct commission *c, const struct config *config, struct text *line)
{
    const struct experiment *experiment = &c->work.test.experiment;
    hal_tick_lock();
    bool testing = c->phase == COMMISSION_TESTING;
    uint8_t at = c->at;
    struct {
        enum experiment_phase phase;
        uint8_t worst_output;
        real_t amplitude, worst;
    } now = {experiment->phase, experiment->worst_output, experiment->amplitude, experiment->worst};
    hal_tick_unlock();
    if (!testing)
        return;
    const struct output_config *o = &config->output[c->input[c->order[at]].output];
    text_str(line, "input ");
    text_str(line, o->name);
    number(line, " (", (float)(at + 1u), " of ");
    text_u32(line, c->inputs);
    text_str(line, "), round ");
    text_u32(line, c->round);
    text_str(line, ": ");
    text_str(line, stages[now.phase]);
    number(line, ", amplitude ", (float)now.amplitude * output_span(o), " ");
    text_str(line, o->unit);
    if (now.worst > REAL_C(0.0)) {
        text_str(line, ", worst ");
        text_str(line, config->measurement[c->measurement[now.worst_output]].name);
        number(line, " at ", (float)now.worst, " of its limit");
    }
}

static bool commission_status_line(struct console *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct config *config = console_settings(c);
    if (n == 0) {
        text_str(line, "phase ");
        text_str(line, phases[m->phase]);
        if (m->phase != COMMISSION_IDLE) {
            text_str(line, ", outputs ");
            text_u32(line, m->outputs);
            text_str(line, ", inputs ");
            text_u32(line, m->inputs);
            uint64_t to = m->ended_ms ? m->ended_ms : service_time_ms(c->service);
            text_str(line, ", plant time s ");
            text_seconds(line, to > m->began_ms ? to - m->began_ms : 0); /* time may be set back */
        }
        return true;
    }
    if (n > 1)
        return false;
    if (m->phase == COMMISSION_TESTING) {
        test_line(m, config, line);
    } else if (m->phase == COMMISSION_RELAY) {
        commission_relay_now(c, line);
    } else if (m->phase == COMMISSION_READY) {
        text_str(line, commission_has_proposal(m)
                           ? "a proposal waits: `commission proposal`, then accept, edit or reject"
                           : "no proposal: `commission pairing` says why");
    } else if (m->why != WHY_NOT) {
        text_str(line, m->subject[0] ? m->subject : "-");
        text_char(line, ' ');
        text_str(line, commission_why_text(m->why));
    } else if (m->phase == COMMISSION_TRIAL) {
        text_str(line, "loop ");
        text_u32(line, m->adoption.at + 1u);
        text_str(line, " of ");
        text_u32(line, m->adoption.n);
        text_str(line, " on trial");
    }
    return true;
}

static void ask(struct console *c, enum commission_ask what)
{
    struct commission *m = c->service->commission;
    const char *wanted = "", *subject = NULL;
    service_settle(c->service); /* what was applied before counts */
    hal_tick_lock();
    enum err err = what == COMMISSION_ASK_BEGIN
                       ? commission_may_begin(c->service->supervisor, &subject, &wanted)
                       : ERR_OK;
    if (!err)
        err = commission_put(m, what, &wanted);
    hal_tick_unlock();
    if (err)
        console_err_about(c, err, subject ? subject : "commission", wanted);
    else if (what ==
             COMMISSION_ASK_BEGIN) /* nothing moves before the plant has been at rest for a while */
        console_list(c, commission_plan_line, "");
    else
        console_ok(c);
}

#define CHANNELS_CHANGED "channels or spans are not those that were tested; begin anew"

/* The configuration the proposal goes into: an open transaction's as it stands, where the proposal was put into it
 * before; else a copy of the one in force with the proposal in it. NULL: refused, and said so. */
static struct config *proposed(struct console *c)
{
    struct service *s = c->service;
    struct config *config = s->staging ? service_staged(s) : service_stage(s);
    if (s->staging)
        return config;
    enum err err = proposal_write(s->commission, config);
    if (!err)
        return config;
    console_err_about(c, err, "commission",
                      err == ERR_FULL ? "the proposal has more loops than there are places"
                      : err == ERR_CONFLICT
                          ? CHANNELS_CHANGED
                          : "there is no proposal; `commission` says how far it is");
    return NULL;
}

/* May a proposal be put on trial now? Says so where not. */
static bool may_try(struct console *c)
{
    struct service *s = c->service;
    const char *wanted = "", *subject = NULL;
    service_settle(s);
    bool changed = commission_channels(&service_plan(s)->config) != s->commission->channels;
    hal_tick_lock();
    enum err err = commission_may(s->commission, COMMISSION_ASK_TRIAL, &wanted);
    if (!err && s->commission->ask != COMMISSION_ASK_NONE) {
        err = ERR_BUSY;
        wanted = "what was asked before waits for the next sample";
    }
    if (!err && s->io.state(s->io.context) != IO_READY) {
        err = ERR_STATE;
        wanted = "no plant is connected";
    }
    if (!err && changed) {
        err = ERR_CONFLICT;
        wanted = CHANNELS_CHANGED;
    }
    if (!err)
        err = commission_may_try(s->commission, s->supervisor, &subject, &wanted);
    hal_tick_unlock();
    if (err)
        console_err_about(c, err, subject ? subject : "commission", wanted);
    return err == ERR_OK;
}

static void accept(struct console *c)
{
    struct service *s = c->service;
    struct commission *m = s->commission;
    struct config_fault fault;
    if (!may_try(c))
        return;
    if (s->staging && !s->staged_proposal) {
        console_err(c, ERR_STATE,
                    "a transaction is open that the proposal is not in: apply or abandon it");
        return;
    }
    struct config *config = proposed(c);
    if (!config)
        return;
    enum err err = proposal_prepare_trial(m, s->supervisor, config);
    if (err) {
        console_err_about(c, err, "commission",
                          err == ERR_CONFLICT ? CHANNELS_CHANGED
                                              : "a pair of the proposal has no loop in the open "
                                                "transaction; `abandon` it, then accept or edit");
        return;
    }
    m->old = service_plan(s)->config;
    if (service_apply(s, config, &fault) != ERR_OK) {
        console_refuse_config(c, &fault);
        return;
    }
    s->staging = false;
    hal_tick_lock();
    m->trial_serial = service_plan(s)->serial;
    m->ask = COMMISSION_ASK_TRIAL;
    hal_tick_unlock();
    console_ok(c);
}

static void edit(struct console *c)
{
    struct service *s = c->service;
    if (s->staging) {
        console_err(c, ERR_STATE, "a transaction is open already: apply or abandon it");
        return;
    }
    if (!proposed(c))
        return;
    s->staging = s->staged_proposal = true;
    console_ok(c);
}

static const struct {
    const char *word;
    enum commission_ask ask;
    bool engineer;
} asks[] = {
    {"begin", COMMISSION_ASK_BEGIN, true},   {"pause", COMMISSION_ASK_PAUSE, false},
    {"resume", COMMISSION_ASK_RESUME, true}, {"skip", COMMISSION_ASK_SKIP, true},
    {"repeat", COMMISSION_ASK_REPEAT, true}, {"abort", COMMISSION_ASK_ABORT, false},
    {"reject", COMMISSION_ASK_REJECT, true},
};

static const struct {
    const char *word;
    console_listing listing;
} listings[] = {
    {"plant", commission_plant_line},       {"plan", commission_plan_line},
    {"model", commission_model_line},       {"gains", commission_gains_line},
    {"pairing", commission_pairing_line},   {"structure", commission_structure_line},
    {"proposal", commission_proposal_line}, {"trial", commission_trial_line},
};

static bool may(struct console *c, bool engineer)
{
    if (!engineer || console_is_engineer(c)) {
        if (engineer)
            console_engineer_acts(c);
        return true;
    }
    console_err(c, ERR_LOCKED, "only for engineers: `unlock KEY` first");
    return false;
}

static console_listing listing_of(const char *word)
{
    for (unsigned i = 0; i < sizeof listings / sizeof listings[0]; i++)
        if (strcmp(word, listings[i].word) == 0)
            return listings[i].listing;
    return NULL;
}

bool console_commission_looks(unsigned n, char **word)
{
    return n == 0 || (n == 1 && (listing_of(word[0]) || strcmp(word[0], "relay") == 0));
}

void command_commission(struct console *c, unsigned n, char **word)
{
    if (n == 0) {
        console_list(c, commission_status_line, "");
        return;
    }
    if (strcmp(word[0], "relay") == 0) {
        if (n == 1 || may(c, true))
            commission_relay_command(c, n, word);
        return;
    }
    if (n > 1) {
        console_err_about(c, ERR_PARSE, word[1], "only `commission relay` takes a loop");
        return;
    }
    console_listing listing = listing_of(word[0]);
    if (listing) {
        console_list(c, listing, "");
        return;
    }
    for (unsigned i = 0; i < sizeof asks / sizeof asks[0]; i++) {
        if (strcmp(word[0], asks[i].word) == 0) {
            if (may(c, asks[i].engineer))
                ask(c, asks[i].ask);
            return;
        }
    }
    bool accepts = strcmp(word[0], "accept") == 0;
    if (!accepts && strcmp(word[0], "edit") != 0) {
        console_err_about(c, ERR_PARSE, word[0], "no such word; `help commission` lists them");
        return;
    }
    if (!may(c, true))
        return;
    if (accepts)
        accept(c);
    else
        edit(c);
}

bool console_commission_poll(struct console *c)
{
    struct service *s = c->service;
    struct config_fault fault;
    /* Behind an open transaction it waits: that is somebody's work. So is a sequence, and a save, which has the
     * scratch plan; and a line of telemetry under way needs the names of its plan. */
    if (!s->commission->wants_old || s->staging || storage_saving(s->storage) || c->row ||
        c->header_of)
        return false;
#if CONFIG_STEPS
    if (sequence_active(&s->supervisor->sequence))
        return false;
#endif
    enum err err = service_apply(s, &s->commission->old, &fault);
    if (err && !fault.group)
        return true; /* no room for it at the moment */
    s->commission->wants_old = false;
    if (err)
        service_record(s, EVENT_CONFIG_REFUSED, fault.group, (float)err, 0);
    return true;
}

bool console_commission_on_trial(const struct console *c)
{
    const struct commission *m = c->service->commission;
    return m->phase == COMMISSION_TRIAL || m->ask == COMMISSION_ASK_TRIAL || m->wants_old;
}

#else

bool console_commission_on_trial(const struct console *c)
{
    (void)c;
    return false;
}

bool console_commission_looks(unsigned n, char **word)
{
    (void)n;
    (void)word;
    return true;
}

void command_commission(struct console *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    console_err(c, ERR_UNSUPPORTED, "automatic start-up is left out of this board's build");
}

#endif
