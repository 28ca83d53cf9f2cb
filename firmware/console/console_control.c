/* Console commands on loops: loop, mode, sp, out, tune. */
#include <string.h>

#include "base/assertion.h"
#include "console/command_table.h"
#include "console/phrases.h"
#include "console/spelling.h"
#include "console/tune_doubt.h"
#include "hal/tick.h"

static bool find_loop(struct client *c, const char *name, uint8_t *loop)
{
    struct answer a;
    enum err err = operate_find_loop(&c->session, name, loop, &a);
    if (err)
        reply_answer(c, err, &a);
    return !err;
}

void command_mode(struct client *c, unsigned n, char **word)
{
    struct answer a;
    uint8_t loop;
    if (n == 1 && strcmp(word[0], "machine") == 0) {
        client_set_machine(c, true);
        reply_ok(c);
        return;
    }
    if (n == 1 && strcmp(word[0], "human") == 0) {
        client_set_machine(c, false);
        reply_ok(c);
        return;
    }
    if (!find_loop(c, word[0], &loop))
        return;
    for (unsigned m = 0; n == 2 && m < MODE_NAMES; m++) {
        if (same_letters(word[1], mode_names[m])) {
            reply_answer(c, operate_mode(&c->session, loop, (enum loop_mode)m, &a), &a);
            return;
        }
    }
    reply_usage(c, n == 2 ? word[1] : word[0], "mode");
}

void command_sp(struct client *c, unsigned n, char **word)
{
    struct answer a;
    uint8_t loop;
    float x;
    (void)n;
    if (find_loop(c, word[0], &loop) && reply_number(c, word[1], "a setpoint", &x))
        reply_answer(c, operate_setpoint(&c->session, loop, x, &a), &a);
}

void command_out(struct client *c, unsigned n, char **word)
{
    const struct config *config = operate_settings(&c->session);
    struct answer a;
    uint8_t loop, output;
    float x;
    (void)n;
    if (!reply_number(c, word[1], "an output", &x))
        return;
    output = config_find_mv(config, word[0]);
    loop = output == PLAN_NONE ? config_find_loop(config, word[0]) : PLAN_NONE;
    enum err err = operate_output(&c->session, loop, output, x, &a);
    if (err == ERR_UNKNOWN && !a.subject)
        a.subject = word[0];
    reply_answer(c, err, &a);
}

static void loop_summary(const struct client *c, uint8_t i, struct text *line)
{
    const struct plan *plan = service_in_force(c->service);
    struct loop_reading r;
    if (!operate_loop(&c->session, i, &r))
        return;
    REFLUX_ASSERT((unsigned)r.mode < MODE_NAMES);
    text_str(line, plan->config.loop[i].name);
    put_word(line, mode_names[r.mode]);
    text_str(line, "  pv ");
    text_str(line, r.pv->name);
    text_str(line, " = ");
    reply_amount(c, line, r.value, r.pv->unit);
    text_str(line, "  sp ");
    reply_amount(c, line, r.setpoint, r.pv->unit);
    text_str(line, "  out ");
    text_str(line, r.mv ? r.mv->name : plan->config.loop[r.inner].name);
    text_str(line, " = ");
    reply_amount(c, line, r.output,
                 r.mv ? r.mv->unit : plan->config.measurement[plan->loop[r.inner].pv].unit);
}

static bool loop_line(struct client *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    const struct plan *plan = service_in_force(s);
    if (!c->argument[0]) { /* all loops, a line each */
        if (n >= CONFIG_LOOPS)
            return false;
        loop_summary(c, (uint8_t)n, line);
        return true;
    }
    uint8_t i = config_find_loop(&plan->config, c->argument);
    if (i == PLAN_NONE)
        return false;
    if (n == 0) {
        loop_summary(c, i, line);
        return true;
    }
    float value;
    const struct block_kind *kind = plan_kind(plan, i);
    hal_tick_lock(); /* a value may be computed from several that the tick writes together */
    const char *name = kind->describe(supervisor_block(s->supervisor, i), n - 1, &value);
    hal_tick_unlock();
    if (!name)
        return false;
    text_str(line, "  ");
    text_str(line, name);
    text_str(line, " = ");
    reply_value(c, line, value);
    return true;
}

void command_loop(struct client *c, unsigned n, char **word)
{
    const struct plan *plan = service_in_force(c->service);
    if (n && config_find_loop(&plan->config, word[0]) == PLAN_NONE) {
        reply_err_about(c, ERR_UNKNOWN, word[0], "no such loop in force; `loop` lists them");
        return;
    }
    reply_list(c, loop_line, n ? word[0] : "");
}

static void print_setting(struct client *c, uint8_t loop, const char *field, const char *word,
                          float value)
{
    char line[CONSOLE_OUTPUT_MAX];
    struct text t = text_on(line, sizeof line);
    text_str(&t, "set loop");
    text_u32(&t, loop + 1u);
    text_char(&t, '.');
    text_str(&t, field);
    text_char(&t, ' ');
    if (word)
        text_str(&t, word);
    else
        text_float(&t, value);
    reply_print(c, line);
}

void command_tune(struct client *c, unsigned n, char **word)
{
    static const char *const rules[TUNING_RULES] = {"simc", "cohen-coon", "cohen-coon-pid"};
    struct answer a;
    struct tuning result;
    struct fopdt model;
    uint8_t loop;
    float lambda_s = 0.0f;
    unsigned rule = 0;
    if (!find_loop(c, word[0], &loop) || !reply_number(c, word[2], "a process gain", &model.gain) ||
        !reply_number(c, word[3], "a dead time in s", &model.dead_time_s) ||
        !reply_number(c, word[4], "a time constant in s", &model.time_constant_s) ||
        (n == 6 && !reply_number(c, word[5], "lambda in s", &lambda_s)))
        return;
    while (rule < TUNING_RULES && strcmp(word[1], rules[rule]) != 0)
        rule++;
    if (n == 6 && rule != TUNE_SIMC) {
        reply_err_about(c, ERR_PARSE, word[5], "LAMBDA goes with the rule simc only");
        return;
    }
    if (rule == TUNING_RULES) {
        reply_err_about(c, ERR_PARSE, word[1], "rule must be simc, cohen-coon or cohen-coon-pid");
        return;
    }
    enum err err = operate_tune(&c->session, loop, (enum tuning_rule)rule, &model,
                                n == 6 ? lambda_s : model.dead_time_s, &result, &a);
    if (!err) {
        print_setting(c, loop, "gain", NULL, result.gain);
        print_setting(c, loop, "ti", NULL, result.ti_s);
        print_setting(c, loop, "td", NULL, result.td_s);
        print_setting(c, loop, "action", result.action == TUNING_DIRECT ? "direct" : "reverse",
                      0.0f);
        print_tune_doubt(c, loop, &result);
    }
    reply_answer(c, err, &a);
}
