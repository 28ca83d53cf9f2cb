/* Console commands on loops: loop, mode, sp, out, tune. */
#include <string.h>

#include "console/console.h"
#include "design/tuning.h"
#include "service/parameters.h"

static const char *const mode_names[] = {"manual", "auto", "cascade"};

static bool find_loop(struct console *c, const char *name, uint8_t *loop)
{
    *loop = config_find_loop(&service_plan(c->service)->config, name);
    if (*loop != PLAN_NONE)
        return true;
    console_err_about(c, ERR_UNKNOWN, name, "no such loop; `loop` lists them");
    return false;
}

static bool find_number(struct console *c, const char *text, const char *what, float *x)
{
    enum err err = text_parse_float(text, x);
    if (!err)
        return true;
    char why[80];
    struct text t = text_on(why, sizeof why);
    text_str(&t, "is no number; ");
    text_str(&t, what);
    text_str(&t, " is wanted, like 78.5");
    console_err_about(c, err, text, why);
    return false;
}

static bool in_range(struct console *c, float x, float lo, float hi, const char *subject,
                     const char *unit)
{
    if (x >= lo && x <= hi)
        return true;
    char why[100];
    struct text t = text_on(why, sizeof why);
    text_float(&t, x);
    text_str(&t, " refused, allowed: ");
    text_float(&t, lo);
    text_str(&t, " .. ");
    text_float(&t, hi);
    text_char(&t, ' ');
    text_str(&t, unit);
    console_err_about(c, ERR_RANGE, subject, why);
    return false;
}

static void ask(struct console *c, struct request *request)
{
    enum err err = service_request(c->service, request);
    if (err)
        console_err(c, err, "more requests waiting than the queue holds, try again");
    else
        console_ok(c);
}

static void set_mode(struct console *c, uint8_t loop, enum loop_mode mode)
{
    if (mode != LOOP_MANUAL) {
        const char *what, *wanted;
        enum err err = service_may_act(c->service, loop, mode, &what, &wanted);
        if (err) {
            console_err_about(c, err, what, wanted);
            return;
        }
    }
    struct request r = {
        .kind = REQUEST_MODE, .loop = loop, .output = PLAN_NONE, .mode = (uint8_t)mode};
    ask(c, &r);
}

void command_mode(struct console *c, unsigned n, char **word)
{
    uint8_t loop;
    if (n == 1 && strcmp(word[0], "machine") == 0) {
        c->machine = true;
        console_ok(c);
        return;
    }
    if (n == 1 && strcmp(word[0], "human") == 0) {
        c->machine = false;
        console_ok(c);
        return;
    }
    if (!find_loop(c, word[0], &loop))
        return;
    for (unsigned m = 0; n == 2 && m < 3; m++) {
        if (strcmp(word[1], mode_names[m]) == 0) {
            set_mode(c, loop, (enum loop_mode)m);
            return;
        }
    }
    console_err_about(c, ERR_PARSE, n == 2 ? word[1] : word[0],
                      "wanted: mode LOOP manual|auto|cascade, or mode machine|human");
}

void command_sp(struct console *c, unsigned n, char **word)
{
    struct service *s = c->service;
    const struct plan *plan = service_plan(s);
    uint8_t loop;
    float x, lo, hi;
    (void)n;
    if (!find_loop(c, word[0], &loop) || !find_number(c, word[1], "a setpoint", &x))
        return;
    plan_setpoint_limits(plan, loop, &lo, &hi);
    if (!in_range(c, x, lo, hi, word[0], plan->config.measurement[plan->loop[loop].pv].unit))
        return;
    enum loop_mode mode = service_mode(s, loop);
    if (mode == LOOP_CASCADE) {
        console_err_about(c, ERR_STATE, word[0],
                          "is in cascade, its setpoint comes from its outer loop");
        return;
    }
    if (mode == LOOP_MANUAL && plan->config.loop[loop].sp_track) {
        console_err_about(c, ERR_STATE, word[0],
                          "is in manual and its setpoint follows the measurement (sp_track on)");
        return;
    }
    struct request r = {.kind = REQUEST_SETPOINT, .loop = loop, .output = PLAN_NONE, .value = x};
    ask(c, &r);
}

void command_out(struct console *c, unsigned n, char **word)
{
    const struct plan *plan = service_plan(c->service);
    const struct config *config = &plan->config;
    struct request r = {.kind = REQUEST_OUTPUT, .output = PLAN_NONE, .loop = PLAN_NONE};
    float lo, hi;
    const char *unit;
    (void)n;
    if (!find_number(c, word[1], "an output", &r.value))
        return;
    uint8_t j = config_find_output(config, word[0]);
    uint8_t loop = j != PLAN_NONE ? plan->owner[j] : config_find_loop(config, word[0]);
    if (j == PLAN_NONE && loop == PLAN_NONE) {
        console_err_about(c, ERR_UNKNOWN, word[0], "no such loop or manipulated variable");
        return;
    }
    if (loop != PLAN_NONE && service_mode(c->service, loop) != LOOP_MANUAL) {
        console_err_about(c, ERR_STATE, config->loop[loop].name,
                          "is not in manual; `mode NAME manual` first");
        return;
    }
    if (j == PLAN_NONE)
        j = plan->loop[loop].output;
    const char *what, *wanted;
    /* By hand an output can be moved without the measurement of its loop. */
    enum err err = j != PLAN_NONE ? service_output_there(c->service, j, &what, &wanted)
                                  : service_may_act(c->service, loop, LOOP_MANUAL, &what, &wanted);
    if (err) {
        console_err_about(c, err, what, wanted);
        return;
    }
    if (j == PLAN_NONE && service_mode(c->service, plan->loop[loop].inner) != LOOP_CASCADE) {
        console_err_about(c, ERR_STATE, word[0],
                          "its output follows the inner loop while that is not in cascade");
        return;
    }
    if (j != PLAN_NONE) {
        plan_manual_limits(plan, j, &lo, &hi);
        unit = config->output[j].unit;
    } else {
        plan_setpoint_limits(plan, plan->loop[loop].inner, &lo, &hi);
        unit = config->measurement[plan->loop[plan->loop[loop].inner].pv].unit;
    }
    if (!in_range(c, r.value, lo, hi, word[0], unit))
        return;
    r.loop = loop;
    if (loop == PLAN_NONE)
        r.output = j;
    ask(c, &r);
}

static void eu(struct text *line, num_t x, float lo, float hi, const char *unit)
{
    text_float(line, span_to_eu(x, lo, hi));
    text_char(line, ' ');
    text_str(line, unit);
}

static void loop_summary(const struct service *s, uint8_t i, struct text *line)
{
    const struct plan *plan = service_in_force(s);
    const struct loop_state *l = &s->supervisor->loop[i];
    const struct loop_plan *p = &plan->loop[i];
    const struct measurement_config *m = &plan->config.measurement[p->pv];
    text_str(line, plan->config.loop[i].name);
    text_char(line, ' ');
    text_str(line, mode_names[l->mode]);
    text_str(line, "  pv ");
    text_str(line, m->name);
    text_str(line, " = ");
    eu(line, s->supervisor->measurement[p->pv].value, m->lo, m->hi, m->unit);
    text_str(line, "  sp ");
    eu(line, l->setpoint, m->lo, m->hi, m->unit);
    text_str(line, "  out ");
    if (p->output != PLAN_NONE) {
        const struct output_config *o = &plan->config.output[p->output];
        text_str(line, o->name);
        text_str(line, " = ");
        eu(line, s->supervisor->output[p->output].applied, o->lo, o->hi, o->unit);
    } else {
        const struct measurement_config *inner = &plan->config.measurement[plan->loop[p->inner].pv];
        text_str(line, plan->config.loop[p->inner].name);
        text_str(line, " = ");
        eu(line, l->v, inner->lo, inner->hi, inner->unit);
    }
}

static bool loop_line(struct console *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    const struct plan *plan = service_in_force(s);
    if (!c->argument[0]) { /* all loops, a line each */
        if (n >= CONFIG_LOOPS)
            return false;
        if (plan->loop[n].used)
            loop_summary(s, (uint8_t)n, line);
        return true;
    }
    uint8_t i = config_find_loop(&plan->config, c->argument);
    if (i == PLAN_NONE)
        return false;
    if (n == 0) {
        loop_summary(s, i, line);
        return true;
    }
    float value;
    const struct loop_state *l = &s->supervisor->loop[i];
    const char *name = plan_is_two_position(plan, i)
                           ? two_position_block.describe(&l->two, n - 1, &value)
                           : pid_block.describe(&l->pid, n - 1, &value);
    if (!name)
        return false;
    text_str(line, "  ");
    text_str(line, name);
    text_str(line, " = ");
    text_float(line, value);
    return true;
}

void command_loop(struct console *c, unsigned n, char **word)
{
    const struct plan *plan = service_in_force(c->service);
    if (n && config_find_loop(&plan->config, word[0]) == PLAN_NONE) {
        console_err_about(c, ERR_UNKNOWN, word[0], "no such loop in force; `loop` lists them");
        return;
    }
    console_list(c, loop_line, n ? word[0] : "");
}

static void propose(struct console *c, uint8_t loop, const char *field, const char *word,
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
    console_print(c, line);
}

void command_tune(struct console *c, unsigned n, char **word)
{
    const struct plan *plan = service_plan(c->service);
    uint8_t loop;
    float k, dead_s, lag_s, lambda_s = 0.0f;
    if (!find_loop(c, word[0], &loop) || !find_number(c, word[2], "a process gain", &k) ||
        !find_number(c, word[3], "a dead time in s", &dead_s) ||
        !find_number(c, word[4], "a time constant in s", &lag_s) ||
        (n == 6 && !find_number(c, word[5], "lambda in s", &lambda_s)))
        return;
    if (n == 6 && strcmp(word[1], "simc") != 0) {
        console_err_about(c, ERR_PARSE, word[5], "LAMBDA goes with the rule simc only");
        return;
    }
    const struct loop_plan *p = &plan->loop[loop];
    const struct config *config = &plan->config;
    const struct measurement_config *m = &config->measurement[p->pv];
    float out_span;
    if (p->output != PLAN_NONE) {
        out_span = config->output[p->output].hi - config->output[p->output].lo;
    } else {
        const struct measurement_config *inner = &config->measurement[plan->loop[p->inner].pv];
        out_span = inner->hi - inner->lo;
    }
    /* The rules work on fractions of span, as the loop does. */
    struct fopdt model = {
        .gain = k * out_span / (m->hi - m->lo), .dead_time_s = dead_s, .time_constant_s = lag_s};
    struct tuning result;
    struct tuning_refusal why = {NULL, NULL};
    enum err err;
    if (strcmp(word[1], "simc") == 0)
        err = tuning_simc_pi(&model, n == 6 ? lambda_s : dead_s, &result, &why);
    else if (strcmp(word[1], "cohen-coon") == 0)
        err = tuning_cohen_coon_pi(&model, &result, &why);
    else if (strcmp(word[1], "cohen-coon-pid") == 0)
        err = tuning_cohen_coon_pid(&model, &result, &why);
    else {
        console_err_about(c, ERR_PARSE, word[1], "rule must be simc, cohen-coon or cohen-coon-pid");
        return;
    }
    if (err) {
        console_err_about(c, err, why.field, why.wanted);
        return;
    }
    propose(c, loop, "gain", NULL, result.gain);
    propose(c, loop, "ti", NULL, result.ti_s);
    propose(c, loop, "td", NULL, result.td_s);
    propose(c, loop, "action", result.action == TUNING_DIRECT ? "direct" : "reverse", 0.0f);
    console_ok(c);
}
