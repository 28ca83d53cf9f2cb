/* `commission advice`: what to change where start-up has ended without a proposal, and what the samples say about the sensors. */
#include "commission/advice.h"
#include "commission/commission.h"
#include "commission/sensor_advice.h"
#include "console/commission_listings.h"
#include "console/commission_words.h"
#include "console/phrases.h"
#include "hal/tick.h"

static const char *const settings[] = {
    [ADVICE_LONGEST] = "test.longest", [ADVICE_TIME] = "test_time",
    [ADVICE_STEP] = "test_step",       [ADVICE_LARGER] = "test_step",
    [ADVICE_STRONGER] = "test_step",   [ADVICE_NOISE] = "test.noise",
    [ADVICE_ROUNDS] = "test.rounds",   [ADVICE_WINDOW] = "test.window",
    [ADVICE_LEAVE] = "test",           [ADVICE_RELAY] = "",
    [ADVICE_OTHERS_FIRST] = "",        [ADVICE_THEN_THIS] = "",
};

static const char *const because[] = {
    [ADVICE_LONGEST] = "a half must show the end of the response",
    [ADVICE_TIME] = "a half must show the end of the response",
    [ADVICE_STEP] = "the step went past a limit",
    [ADVICE_LARGER] = "the sensor reads in coarse steps",
    [ADVICE_STRONGER] = "a larger step makes the gains surer",
    [ADVICE_NOISE] = "larger steps make the gains surer",
    [ADVICE_ROUNDS] = "more tests make the gains surer",
    [ADVICE_WINDOW] = "slow waves are normal here",
    [ADVICE_LEAVE] = "it does not settle: leave this input out",
    [ADVICE_RELAY] = "",
    [ADVICE_OTHERS_FIRST] = "",
    [ADVICE_THEN_THIS] = "",
};

static void set_test(const char *group, unsigned i, bool on, struct text *line)
{
    text_str(line, " `set ");
    text_str(line, group);
    text_u32(line, i + 1u);
    text_str(line, on ? ".test on`" : ".test off`");
}

/* Inputs that act nearly alike: the others first, and then this pair while their loops are closed. */
static void turn_words(const struct config *config, const struct advice *a, struct text *line)
{
    bool then = a->kind == ADVICE_THEN_THIS;
    text_str(line, then ? "then" : "first");
    set_test("mv", a->input, then, line);
    set_test("meas", a->measurement, then, line);
    for (unsigned i = 0; then && i < CHANNEL_MAX; i++) {
        if (i != a->input && config->mv[i].name[0] && config->mv[i].start_up.test)
            set_test("mv", i, false, line);
        if (i != a->measurement && config->measurement[i].name[0] &&
            config->measurement[i].start_up.test)
            set_test("meas", i, false, line);
    }
    text_str(line, then ? ": start up and accept " : ": start up and accept all but ");
    text_str(line, config->measurement[a->measurement].name);
    text_str(line, " by ");
    text_str(line, config->mv[a->input].name);
    if (!then) {
        text_str(line, ", because the inputs act nearly alike");
        return;
    }
    text_str(line, " while the other loops are closed; both together at least ");
    text_float4(line, (float)a->value);
    text_str(line, " h");
}

static void set_words(const struct config *config, const struct advice *a, struct text *line)
{
    text_str(line, "`set ");
    bool is_step = a->kind == ADVICE_STEP || a->kind == ADVICE_LARGER || a->kind == ADVICE_STRONGER;
    if (is_step || a->kind == ADVICE_TIME || a->kind == ADVICE_LEAVE) {
        text_str(line, "mv");
        text_u32(line, a->input + 1u);
        text_str(line, ".");
    }
    text_str(line, settings[a->kind]);
    text_str(line, " ");
    if (a->kind == ADVICE_LEAVE) {
        text_str(line, "off`");
    } else {
        text_float4(line, (float)a->value);
        text_str(line, "` instead of ");
        text_float4(line, (float)a->present);
        if (a->kind == ADVICE_LONGEST || a->kind == ADVICE_TIME)
            text_str(line, " s");
        else if (is_step)
            put_word(line, config->mv[a->input].unit);
    }
}

void commission_advice_text(const struct config *config, const struct advice *a, struct text *line)
{
    if (a->kind == ADVICE_RELAY) {
        text_str(line, "set ");
        text_str(line, config->measurement[a->measurement].name);
        text_str(line, " by ");
        text_str(line, config->mv[a->input].name);
        text_str(line, " by relay: `commission relay LOOP`, once a loop has this pair");
        return;
    }
    if (a->kind == ADVICE_OTHERS_FIRST || a->kind == ADVICE_THEN_THIS) {
        turn_words(config, a, line);
        return;
    }
    set_words(config, a, line);
    put_reason(line, because[a->kind]);
    if (a->measurement < CHANNEL_MAX) {
        text_str(line, ", ");
        text_str(line, config->measurement[a->measurement].name);
    }
}

static void sensor_text(const struct config *config, const struct measurement_config *m,
                        const struct sensor_advice *a, real_t tick_s, struct text *line)
{
    text_str(line, m->name);
    if (a->renewal > 1u) {
        text_str(line, " is renewed every ");
        text_u32(line, a->renewal);
        text_str(line, " ticks: sample interval ");
        text_float4(line, (float)((real_t)a->renewal * tick_s));
        text_str(line, " s instead of ");
        text_float4(line, (float)tick_s);
        text_str(line, " s");
    } else if (a->step_share > REAL_C(0.0)) {
        text_str(line, " reads in steps of ");
        text_float4(line, (float)(REAL_C(100.0) * a->step_share));
        text_str(line, " % of its span");
        if (a->step_least > REAL_C(0.0)) {
            text_str(line, ": test_step of ");
            text_str(line, config->mv[a->input].name);
            text_str(line, " at least ");
            text_float4(line, (float)a->step_least);
            put_word(line, config->mv[a->input].unit);
        }
    } else {
        text_str(line, " moved by at most ");
        text_float4(line, (float)(REAL_C(100.0) * a->moved_share));
        text_str(line, " % of its span: span of ");
        text_float4(line, (float)a->span_wanted);
        put_word(line, m->unit);
        text_str(line, " instead of ");
        text_float4(line, m->hi - m->lo);
    }
}

bool commission_advice_line(struct client *c, unsigned n, struct text *line)
{
    const struct commission *m = c->service->commission;
    const struct supervisor *s = c->service->supervisor;
    const struct config *config = client_settings(c);
    struct advice advice[ADVICE_MOST];
    struct sensor_advice sensor = {.renewal = 1u};
    unsigned count = 0, outputs;
    bool tells = false;
    hal_tick_lock();
    if (n < ADVICE_MOST)
        count = advice_of(m, s, advice);
    outputs = sensor_advices(m, s);
    if (n >= ADVICE_MOST && n - ADVICE_MOST < outputs)
        tells = sensor_advice_of(m, s, (uint8_t)(n - ADVICE_MOST), &sensor);
    hal_tick_unlock();
    if (n == 0 && inputs_count(&m->inputs) > 0 && !commission_keeps(m))
        text_str(line, RESULTS_DISCARDED);
    if (n < count)
        commission_advice_text(config, &advice[n], line);
    if (tells)
        sensor_text(config, &config->measurement[outputs_measurement(&m->outputs, n - ADVICE_MOST)],
                    &sensor, s->plan->tick_s, line);
    return n < ADVICE_MOST + outputs;
}
