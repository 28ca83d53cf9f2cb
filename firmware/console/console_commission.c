/* `commission`: automatic start-up from the console. */
#include <string.h>

#include "base/assertion.h"
#include "commission/commission.h"
#include "commission/expected.h"
#include "console/command_table.h"
#include "console/commission_listings.h"
#include "console/phrases.h"
#include "hal/tick.h"

static const char *const phases[] = {
    [COMMISSION_IDLE] = "idle",           [COMMISSION_TESTING] = "testing",
    [COMMISSION_RELAY] = "relay",         [COMMISSION_FITTING] = "fitting",
    [COMMISSION_ANALYSING] = "analysing", [COMMISSION_PAUSED] = "paused",
    [COMMISSION_READY] = "ready",         [COMMISSION_TRIAL] = "trial",
    [COMMISSION_KEPT] = "kept",           [COMMISSION_RETURNED] = "returned",
    [COMMISSION_ENDED] = "ended",         [COMMISSION_WATCHING] = "watching",
};

static const char *const stages[] = {
    [EXPERIMENT_REST] = "waits for rest", [EXPERIMENT_UP] = "positive half",
    [EXPERIMENT_DOWN] = "negative half",  [EXPERIMENT_BACK] = "back, waits for rest",
    [EXPERIMENT_DONE] = "done",           [EXPERIMENT_FAILED] = "failed",
};

static void text_quantity(struct text *t, const char *before, float x, const char *unit)
{
    text_str(t, before);
    text_float(t, x);
    text_str(t, unit);
}

static float output_span(const struct mv_config *o)
{
    return o->hi - o->lo;
}

/* Describes the test under way. It may end, and its memory go to the analysis, at any time. */
static void test_line(const struct commission *c, const struct config *config, struct text *line)
{
    const struct experiment *experiment = &c->work->experiment;
    hal_tick_lock();
    bool testing = status_phase(&c->status) == COMMISSION_TESTING;
    uint8_t turn = inputs_turn(&c->inputs);
    /* When the last input is through, none is under test. */
    const struct tested_input *in = testing ? inputs_under_test(&c->inputs) : NULL;
    bool direction = inputs_is_direction(&c->inputs);
    struct {
        enum experiment_phase phase;
        uint8_t worst_output;
        real_t amplitude, worst;
    } reached = {experiment_phase(experiment), limits_worst_output(experiment_limits(experiment)),
                 experiment_amplitude(experiment), limits_worst(experiment_limits(experiment))};
    hal_tick_unlock();
    if (!testing)
        return;
    REFLUX_ASSERT((unsigned)reached.phase < sizeof stages / sizeof stages[0]);
    const struct mv_config *o = &config->mv[in->output];
    text_str(line, "input ");
    text_str(line, direction ? DIRECTION_NAME : o->name);
    text_quantity(line, " (", (float)(turn + 1u), " of ");
    text_u32(line, inputs_slots(&c->inputs));
    text_str(line, "), round ");
    text_u32(line, inputs_round(&c->inputs));
    put_reason(line, stages[reached.phase]);
    text_quantity(line, ", amplitude ", (float)reached.amplitude * output_span(o), " ");
    text_str(line, o->unit);
    if (reached.worst > REAL_C(0.0)) {
        text_str(line, ", worst ");
        text_str(line,
                 config->measurement[outputs_measurement(&c->outputs, reached.worst_output)].name);
        text_quantity(line, " at ", (float)reached.worst, " of its limit");
    }
}

/* Prints how long start-up may still take. */
static void time_left_line(const struct client *c, struct text *line)
{
    const struct commission *m = c->service->commission;
    hal_tick_lock();
    enum commission_phase phase = status_phase(&m->status);
    bool testing =
        phase == COMMISSION_TESTING || phase == COMMISSION_FITTING || phase == COMMISSION_ANALYSING;
    struct expected_left left = {.planned = false};
    if (testing)
        left = expected_left(m, c->service->supervisor);
    hal_tick_unlock();
    if (!testing)
        return;
    text_str(line, left.planned ? "left at least " : "left about ");
    text_u32(line, (uint32_t)left.round_s);
    text_str(line, left.planned ? " s, at most " : " s of this round, ");
    text_u32(line, (uint32_t)left.most_s);
    text_str(line, left.planned ? " s" : " s if all rounds are needed");
}

static bool commission_status_line(struct client *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct config *config = client_settings(c);
    enum commission_phase phase = status_phase(&m->status);
    if (n == 0) {
        text_str(line, "phase ");
        text_str(line, phases[phase]);
        if (phase != COMMISSION_IDLE) {
            text_str(line, ", outputs ");
            text_u32(line, outputs_count(&m->outputs));
            text_str(line, ", inputs ");
            text_u32(line, inputs_count(&m->inputs));
            text_str(line, ", plant time s ");
            text_seconds(line, status_duration_ms(&m->status, service_time_ms(c->service)));
        }
        return true;
    }
    if (n == 2)
        time_left_line(c, line);
    if (n > 1)
        return n == 2;
    if (phase == COMMISSION_TESTING) {
        test_line(m, config, line);
    } else if (phase == COMMISSION_RELAY) {
        relay_progress_line(c, line);
    } else if (phase == COMMISSION_WATCHING) {
        watch_progress_line(c, line);
    } else if (phase == COMMISSION_READY) {
        text_str(line, commission_has_proposal(m)
                           ? "a proposal waits: `commission proposal`, then accept, edit or reject"
                           : "no proposal: `commission pairing` says why");
    } else if (status_reason(&m->status) != REASON_NOT) {
        const char *subject = status_subject(&m->status);
        text_str(line, subject[0] ? subject : "-");
        put_word(line, commission_reason_text(status_reason(&m->status)));
    } else if (phase == COMMISSION_TRIAL) {
        text_str(line, "loop ");
        text_u32(line, adoption_turn(&m->adoption) + 1u);
        text_str(line, " of ");
        text_u32(line, adoption_loops(&m->adoption));
        text_str(line, " on trial");
    }
    return true;
}

static const struct {
    const char *word;
    reply_listing listing;
} listings[] = {
    {"plant", commission_plant_line},       {"plan", commission_plan_line},
    {"model", commission_model_line},       {"gains", commission_gains_line},
    {"pairing", commission_pairing_line},   {"structure", commission_structure_line},
    {"proposal", commission_proposal_line}, {"trial", commission_trial_line},
    {"advice", commission_advice_line},     {"status", commission_status_line},
    {"watched", commission_watched_line},
};

static reply_listing listing_of(const char *word)
{
    for (unsigned i = 0; i < sizeof listings / sizeof listings[0]; i++)
        if (strcmp(word, listings[i].word) == 0)
            return listings[i].listing;
    return NULL;
}

/* Finds what `begin`, `pause` and so on ask for. COMMISSION_ASK_NONE: the word is another. */
static enum commission_ask ask_of(const char *word)
{
    for (unsigned i = COMMISSION_ASK_NONE; i <= COMMISSION_ASK_REJECT; i++) {
        const char *known = operate_startup_word((enum commission_ask)i);
        if (known && strcmp(word, known) == 0)
            return (enum commission_ask)i;
    }
    return COMMISSION_ASK_NONE;
}

void command_commission(struct client *c, unsigned n, char **word)
{
    struct answer a;
    if (n == 0) {
        reply_list(c, commission_status_line, "");
        return;
    }
    if (strcmp(word[0], "relay") == 0) {
        commission_relay_command(c, n, word);
        return;
    }
    if (strcmp(word[0], "watch") == 0) {
        commission_watch_command(c, n, word);
        return;
    }
    if (n > 1) {
        reply_err_about(c, ERR_PARSE, word[1], "only `commission relay` takes a loop");
        return;
    }
    reply_listing listing = listing_of(word[0]);
    enum commission_ask what = ask_of(word[0]);
    if (listing) {
        reply_list(c, listing, "");
    } else if (what != COMMISSION_ASK_NONE) {
        enum err err = operate_startup(&c->session, what, &a);
        if (!err && what == COMMISSION_ASK_BEGIN)
            /* nothing moves before the plant has been at rest for a while */
            reply_list(c, commission_plan_line, "");
        else
            reply_answer(c, err, &a);
    } else if (strcmp(word[0], "accept") == 0) {
        reply_answer(c, operate_accept(&c->session, &a), &a);
    } else if (strcmp(word[0], "edit") == 0) {
        reply_answer(c, operate_edit(&c->session, &a), &a);
    } else if (strcmp(word[0], "discard") == 0) {
        reply_answer(c, operate_discard(&c->session, &a), &a);
    } else {
        reply_err_about(c, ERR_PARSE, word[0], "no such word; `help commission` lists them");
    }
}
