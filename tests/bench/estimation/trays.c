/* A tick of the kind `inferential`: step and back-calculation of a whole block; and of the loops' own PID beside it. */
#include <stdalign.h>
#include <string.h>

#include "base/channel.h"
#include "cost.h"
#include "kinds/inferential/inferential.h"
#include "kinds/pid/pid.h"

#define SAMPLES 300

static alignas(8) char state[4000];

static void settings_of(struct inferential_settings *c, uint8_t law, uint8_t form)
{
    memset(c, 0, sizeof *c);
    for (unsigned k = 0; k < INFERENTIAL_LOOPS; k++) {
        c->law[k] = law;
        c->a[k][PRIMARY] = 10;
        c->a[k][SECONDARY] = 8;
        c->kc[k] = 2;
        c->kc2[k] = 4;
        c->ko[k] = 20;
    }
    c->form = form;
}

static void cost_of(const char *what, uint8_t loops, uint8_t law)
{
    struct inferential_settings settings;
    struct block_setup setup;
    struct block_fault fault;
    struct cost cost = {0};
    num_t setpoint[2], in[2], out[2], input[4];
    uint8_t quality[4] = {QUALITY_GOOD, QUALITY_GOOD, QUALITY_GOOD, QUALITY_GOOD};
    uint8_t clamp[2] = {0, 0}, limited[2] = {0, 0};
    float value[BLOCK_EVENTS_MAX];
    const struct applied_history *none[4] = {NULL, NULL, NULL, NULL};
    settings_of(&settings, law, FORM_EULER);
    memset(&setup, 0, sizeof setup);
    setup.settings = &settings;
    setup.interval_s = 30;
    setup.members = loops;
    setup.present = (uint8_t)((1u << loops) - 1u);
    setup.inputs = (uint8_t)(2 * loops);
    for (unsigned k = 0; k < 4; k++) {
        setup.input[k] = (struct block_signal){280, 400, k >= loops};
        setup.pv[k & 1] = setup.input[0];
        setup.member[k & 1].drives_mv = true;
        input[k] = num_from_float(0.5f);
    }
    if (inferential_kind.check(&setup, &fault) != ERR_OK)
        return; /* a row is missing */
    if (inferential_kind.configure(state, &setup, false) != ERR_OK)
        return;
    for (unsigned k = 0; k < 2; k++)
        setpoint[k] = in[k] = out[k] = num_from_float(0.5f);
    struct block_io io = {.members.acting = setup.present,
                          .members.setpoint = setpoint,
                          .members.in = in,
                          .members.out = out,
                          .members.clamp = clamp,
                          .members.limited = limited,
                          .inputs.value = input,
                          .inputs.quality = quality,
                          .members.applied = none,
                          .inputs.applied = none,
                          .requests.event_value = value,
                          .members.divisor = 1};
    inferential_kind.follow(state, &io);
    for (unsigned t = 0; t < SAMPLES; t++) {
        for (unsigned k = 0; k < loops; k++) {
            in[k] = num_from_float(0.5f + 0.01f * cost_random());
            input[k] = num_from_float(0.4f + 0.01f * cost_random());
        }
        cost_paint_stack();
        uint32_t from = cost_now();
        inferential_kind.step(state, &io);
        inferential_kind.back_calculate(state, &io);
        uint32_t to = cost_now();
        if (t > 20)
            cost_add(&cost, from, to);
        cost_stack(&cost);
    }
    cost_tell(what, loops, &cost, inferential_kind.bytes(&setup));
}

static void cost_of_pid(void)
{
    struct pid *pid = (struct pid *)(void *)state;
    struct pid_config c = pid_default_config();
    struct cost cost = {0};
    c.ti_s = 740;
    if (pid_init(pid, &c, 30) != ERR_OK)
        return; /* a row is missing */
    pid_follow(pid, num_from_float(0.5f), num_from_float(0.5f), num_from_float(0.5f));
    for (unsigned t = 0; t < SAMPLES; t++) {
        num_t y = num_from_float(0.5f + 0.01f * cost_random());
        cost_paint_stack();
        uint32_t from = cost_now();
        num_t u = pid_step(pid, num_from_float(0.5f), y);
        pid_back_calculate(pid, u, INTEGRAL_FREE);
        uint32_t to = cost_now();
        if (t > 20)
            cost_add(&cost, from, to);
        cost_stack(&cost);
    }
    cost_tell("PI", 1, &cost, sizeof *pid);
}

void cost_of_trays(void)
{
    cost_of_pid();
    cost_of("conventional", 1, LAW_CONVENTIONAL);
    cost_of("cascade", 1, LAW_CASCADE);
    cost_of("CLF", 1, LAW_CLF);
    cost_of("CLF", 2, LAW_CLF);
}
