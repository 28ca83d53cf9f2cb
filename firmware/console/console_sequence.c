/* Console command on sequences: seq. */
#include <string.h>

#include "base/assertion.h"
#include "console/command_table.h"
#include "console/phrases.h"
#include "console/sequence_words.h"
#include "exchange/sequence_rows.h"

static void seconds(struct text *line, uint32_t ms)
{
    text_u32(line, ms / 1000u);
    text_str(line, " s");
}

/* " 85 degC" */
static void amount(struct text *line, float x, const char *unit)
{
    text_char(line, ' ');
    put_amount(line, x, unit);
}

/* "TB above 85 degC for 60 s" */
static void condition_text(const struct plan *plan, unsigned k, struct text *line)
{
    static const char *const comparisons[] = {"at once", "above", "below", "steady within"};
    REFLUX_ASSERT(k < CONFIG_STEPS);
    const struct step_config *c = &plan->config.step[k];
    if (c->until == STEP_TIME) {
        seconds(line, c->wait_s * UINT32_C(1000));
        text_str(line, " have passed");
        return;
    }
    if (c->until == STEP_CONFIRM) {
        text_str(line, "the operator confirms");
        return;
    }
    REFLUX_ASSERT(c->until < sizeof comparisons / sizeof comparisons[0] &&
                  plan->step[k].measurement < CHANNEL_MAX);
    text_str(line, c->measurement);
    put_word(line, comparisons[c->until]);
    amount(line, c->limit, plan->config.measurement[plan->step[k].measurement].unit);
    if (c->wait_s && c->action != STEP_GUARD) {
        text_str(line, " for ");
        seconds(line, c->wait_s * UINT32_C(1000));
    }
}

static void action_text(const struct plan *plan, unsigned k, struct text *line)
{
    static const char *const names[] = {"wait", "out",       "manual",     "auto",  "cascade",
                                        "sp",   "offset on", "offset off", "guard", "drop"};
    REFLUX_ASSERT(k < CONFIG_STEPS &&
                  (unsigned)plan->config.step[k].action < sizeof names / sizeof names[0]);
    const struct step_config *c = &plan->config.step[k];
    uint8_t what = plan->step[k].what;
    text_str(line, names[c->action]);
    text_char(line, ' ');
    if (what != PLAN_NONE)
        text_str(line, c->what);
    if (c->action == STEP_OUT)
        amount(line, c->value, plan->config.mv[what].unit);
    else if (c->action == STEP_SETPOINT)
        amount(line, c->value, plan->config.measurement[plan->loop[what].pv].unit);
}

/* Describes a row in words. */
static void row_text(const struct plan *plan, unsigned k, struct text *line)
{
    static const char *const otherwise[] = {"abort", "go on", "hold"};
    REFLUX_ASSERT(k < CONFIG_STEPS && (unsigned)plan->config.step[k].otherwise <
                                          sizeof otherwise / sizeof otherwise[0]);
    const struct step_config *c = &plan->config.step[k];
    step_number(line, k);
    text_str(line, ": ");
    action_text(plan, k, line);
    if (c->action == STEP_GUARD) {
        condition_text(plan, k, line);
    } else if (c->until != STEP_AT_ONCE) {
        text_str(line, c->action == STEP_NOTHING ? "until " : ", until ");
        condition_text(plan, k, line);
    }
    uint32_t longest_s = c->action == STEP_GUARD ? c->wait_s : c->timeout_s;
    if (c->action != STEP_GUARD && !longest_s)
        return;
    text_str(line, "; after ");
    seconds(line, longest_s * UINT32_C(1000));
    text_str(line, c->action == STEP_GUARD ? " without " : " ");
    text_str(line, otherwise[c->otherwise]);
}

static void reading_text(const struct service *s, unsigned k, struct text *line)
{
    REFLUX_ASSERT(k < CONFIG_STEPS && service_in_force(s)->step[k].measurement < CHANNEL_MAX);
    const struct plan *plan = service_in_force(s);
    uint8_t i = plan->step[k].measurement;
    float value;
    text_str(line, plan->config.measurement[i].name);
    if (!sequence_reading(s->supervisor, i, &value)) {
        text_str(line, " is not valid");
        return;
    }
    text_str(line, " =");
    amount(line, value, plan->config.measurement[i].unit);
}

/* Describes the progress of the step. */
static void progress_text(const struct service *s, struct text *line)
{
    const struct plan *plan = service_in_force(s);
    const struct sequence *q = &s->supervisor->sequence;
    REFLUX_ASSERT(q->step < CONFIG_STEPS);
    const struct step_config *c = &plan->config.step[q->step];
    bool looks = plan->step[q->step].measurement != PLAN_NONE;
    text_str(line, "  ");
    if (q->state == SEQUENCE_HELD)
        text_str(line, "waits for `seq go`; ");
    else if (q->state == SEQUENCE_CONFIRM)
        text_str(line, "waits for `seq confirm`; ");
    if (looks) {
        reading_text(s, q->step, line);
        text_str(line, "; ");
    }
    if (looks || c->until == STEP_TIME) {
        text_str(line, looks ? "has held " : "waited ");
        seconds(line, q->met_ms);
        text_str(line, " of ");
        seconds(line, c->wait_s * UINT32_C(1000));
        text_str(line, "; ");
    }
    text_str(line, "in step ");
    seconds(line, q->elapsed_ms);
    if (!c->timeout_s)
        return;
    uint32_t limit_ms = c->timeout_s * UINT32_C(1000);
    text_str(line, ", time-out in ");
    seconds(line, limit_ms > q->elapsed_ms ? limit_ms - q->elapsed_ms : 0);
}

static void guard_text(const struct service *s, unsigned k, struct text *line)
{
    const struct sequence *q = &s->supervisor->sequence;
    text_str(line, "  ");
    row_text(service_in_force(s), k, line);
    text_str(line, "; ");
    reading_text(s, k, line);
    if (q->violated_ms[k]) {
        text_str(line, ", violated for ");
        seconds(line, q->violated_ms[k]);
    }
}

static bool seq_line(struct client *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    const struct sequence *q = &s->supervisor->sequence;
    const struct plan *plan = service_in_force(s);
    bool active = sequence_active(q);
    if (n == 0) {
        sequence_headline(s, line);
        text_str(line, q->state == SEQUENCE_IDLE ? "idle" : "");
    } else if (n == 1) {
        /* After a reset the rows may have come from elsewhere. */
        if (q->state != SEQUENCE_IDLE && plan->config.step[q->step].sequence == q->kind) {
            text_str(line, "  ");
            row_text(plan, q->step, line);
        }
    } else if (n == 2) {
        if (active)
            progress_text(s, line);
    } else if (n - 3u < CONFIG_STEPS) {
        if (active && (q->guards & UINT32_C(1) << (n - 3u)))
            guard_text(s, n - 3u, line);
    } else {
        return false;
    }
    return true;
}

/* All rows in words, those of one sequence behind each other. */
static bool seq_row_line(struct client *c, unsigned n, struct text *line)
{
    const struct plan *plan = service_in_force(c->service);
    if (n >= 2u * CONFIG_STEPS)
        return false;
    uint8_t kind = n < CONFIG_STEPS ? SEQUENCE_START : SEQUENCE_STOP;
    unsigned k = n % CONFIG_STEPS;
    if (plan->config.step[k].sequence == kind) {
        text_str(line, sequence_kind_text(kind));
        text_char(line, ' ');
        row_text(plan, k, line);
    }
    return true;
}

void command_seq(struct client *c, unsigned n, char **word)
{
    struct answer a;
    unsigned what = 0;
    if (n == 0) {
        reply_list(c, seq_line, "");
        return;
    }
    if (strcmp(word[0], "list") == 0) {
        reply_list(c, seq_row_line, "");
        return;
    }
    while (what < SEQUENCE_COMMANDS &&
           strcmp(word[0], operate_sequence_word((enum sequence_command)what)) != 0)
        what++;
    if (what == SEQUENCE_COMMANDS) {
        reply_usage(c, word[0], "seq");
        return;
    }
    reply_answer(c, operate_sequence(&c->session, (enum sequence_command)what, &a), &a);
}
