/* Cost of adaptive feedforward, by each of its methods: a tick of the kind `ff_tune` while it learns, tests and runs, and all the work
 * between ticks from the responses to the element, with its largest piece. The plant is Siddha's loop in float, sampled once a
 * tick, under a PI. */
#include <stdalign.h>
#include <string.h>

#include "base/channel.h"
#include "cost.h"
#include "kinds/ff_tune/feedforward_tune.h"
#include "kinds/ff_tune/tune_state.h"

#define DEPTH 20u

static alignas(8) char state[20000];
static alignas(8) char history[sizeof(struct applied_history) + 4 * sizeof(num_t)];
static struct tune_settings settings;
static struct block_setup setup;
static struct block_fault fault;

static struct {
    float x, xd, u[DEPTH], d[DEPTH], integral, r;
    uint32_t t;
} plant;

static void setup_tune(uint8_t method)
{
    memset(&setup, 0, sizeof setup);
    for (unsigned k = 0; k < TUNE_PARAMETERS; k++) {
        const struct block_parameter *p = &tune_parameter_rows[k];
        char *at = (char *)&settings + p->offset;
        for (unsigned n = 0; n < p->rows * p->cols; n++) {
            uint16_t word = (uint16_t)p->initial;
            if (p->type == BLOCK_FLOAT)
                memcpy(at + n * sizeof(float), &p->initial, sizeof(float));
            else if (p->type == BLOCK_U16)
                memcpy(at + n * sizeof word, &word, sizeof word);
            else
                at[n] = (char)word;
        }
    }
    settings.method = method;
    settings.gain = 0.65f;
    settings.ti_s = 13.2f;
    settings.learn_s = 1000;
    settings.confident = 1000; /* it is short */
    settings.check_s = 320;
    settings.dead_most_s = 20;
    settings.lag_most_s = 60;
    settings.step = 0.025f;
    settings.step_period_s = 400;
    settings.adopt = TUNE_ADOPT_AT_ONCE;
    setup.settings = &settings;
    setup.interval_s = 1;
    setup.members = 1;
    setup.present = 1;
    setup.inputs = 2;
    setup.member[0] = (struct block_member){0, true, 1, 1};
    setup.pv[0] = setup.input[0] = setup.input[1] = (struct block_signal){0, 1, false};
    applied_history_begin((struct applied_history *)(void *)history, 4, num_zero());
    memset(&plant, 0, sizeof plant);
}

static float square(uint32_t period)
{
    return plant.t % period < period / 2 ? 0.025f : -0.025f;
}

/* Gains of 1 in spans, a path of its own for d; the controller as the firmware has it. Returns what the controller gives. */
static float move_plant(float signal, bool disturbed, num_t *y, num_t *d)
{
    float now = plant.x + plant.xd + 0.00125f * cost_random();
    plant.r = signal;
    memmove(plant.u + 1, plant.u, (DEPTH - 1) * sizeof plant.u[0]);
    memmove(plant.d + 1, plant.d, (DEPTH - 1) * sizeof plant.d[0]);
    plant.d[0] = disturbed ? 4 * square(300) : 0;
    plant.u[0] = 0.65f * (plant.r - now) + plant.integral;
    plant.integral += 0.65f / 13.2f * (plant.r - now);
    plant.x = 0.8825f * plant.x + 0.1175f * plant.u[12];
    plant.xd = 0.8187f * plant.xd + 0.5f * 0.1813f * plant.d[8];
    plant.t++;
    *y = num_from_float(now);
    *d = num_from_float(plant.d[0]);
    return plant.u[0];
}

struct counted {
    struct cost learn, test, run, work;
};

static void count_tick(struct counted *c, const struct tune *t, uint8_t stage, uint32_t from,
                       uint32_t to)
{
    if (stage == TUNE_LOOP || stage == TUNE_DISTURBANCE)
        cost_add(&c->learn, from, to);
    else if (stage == TUNE_TESTS)
        cost_add(&c->test, from, to);
    else if (stage == TUNE_RUNS && t->stages.acts)
        cost_add(&c->run, from, to);
    cost_stack(&c->run);
}

static void cost_of_method(uint8_t method)
{
    struct tune *t = (struct tune *)(void *)state;
    const struct block_kind *kind = &feedforward_tune_kind;
    const struct applied_history *applied = (struct applied_history *)(void *)history;
    struct block_excitation excite[BLOCK_EXCITES_MAX];
    struct block_proposal room;
    float value[BLOCK_EVENTS_MAX];
    uint8_t quality[2] = {QUALITY_GOOD, QUALITY_GOOD};
    num_t input[2] = {num_zero(), num_zero()}, in, out, setpoint = num_zero();
    struct counted c = {0};
    cost_seed(1);
    setup_tune(method);
    if (kind->check(&setup, &fault) != ERR_OK || kind->bytes(&setup) > sizeof state ||
        kind->configure(state, &setup, false) != ERR_OK)
        return; /* a row is missing */
    struct block_io io = {.members.acting = 1,
                          .members.setpoint = &setpoint,
                          .members.in = &in,
                          .members.out = &out,
                          .inputs.value = input,
                          .inputs.quality = quality,
                          .members.applied = &applied,
                          .requests.excite = excite,
                          .requests.event_value = value,
                          .members.divisor = 1};
    (void)kind->verb[0].run(state, NULL);
    memset(excite, 0, sizeof excite);
    for (unsigned k = 0; k < 20000 && c.run.count < 400; k++) {
        float signal = excite[0].what ? num_to_float(excite[0].value) : 0;
        bool asked = excite[0].what != EXCITE_NOTHING;
        uint8_t stage = t->stages.stage;
        in = num_from_float(move_plant(signal, stage != TUNE_LOOP, &input[0], &input[1]));
        setpoint = num_from_float(signal);
        memset(excite, 0, sizeof excite);
        memset(&room, 0, sizeof room);
        io.requests.excite_state = asked ? EXCITE_RUNS : EXCITE_OFF;
        io.requests.proposal = &room;
        io.requests.ask_work = 0;
        cost_paint_stack();
        uint32_t from = cost_now();
        kind->step(state, &io);
        uint32_t to = cost_now();
        if (!io.requests.work_done)
            count_tick(&c, t, stage, from, to);
        io.requests.work_done = io.requests.ask_work > 0;
        /* The look at the responses alone, while a stage lasts, is not counted with the work. */
        for (bool more = io.requests.ask_work > 0; more;) {
            bool whole = t->stages.stage == TUNE_COMPUTES && !t->stages.acts;
            cost_paint_stack();
            from = cost_now();
            more = kind->work(state);
            to = cost_now();
            if (whole)
                cost_add(&c.work, from, to);
            cost_stack(&c.work);
        }
        applied_history_append((struct applied_history *)(void *)history, in);
        if (room.n == 8) { /* as if it had been accepted */
            settings.k = (float)t->search.candidate.k;
            settings.lead_s = (float)t->search.candidate.lead;
            settings.lag_s = (float)t->search.candidate.lag;
            settings.dead_s = (float)t->search.candidate.dead;
            (void)kind->configure(state, &setup, true);
        }
    }
    unsigned n = high_order_parameters(&t->context.shape[1]);
    if (!c.learn.count || !c.test.count || !c.run.count || !c.work.count)
        return;
    cost_say("learn", n, c.learn.sum / c.learn.count, c.learn.most, kind->bytes(&setup));
    cost_say("test", n, c.test.sum / c.test.count, c.test.most, kind->bytes(&setup));
    cost_say("run", n, c.run.sum / c.run.count, c.run.most, kind->bytes(&setup));
    cost_say("stack", n, c.run.stack, c.run.stack, 0);
    cost_say("tune", n, c.work.sum, c.work.most, c.work.count);
    cost_say("stack", n, c.work.stack, c.work.stack, 0);
}

int main(void)
{
    cost_of_method(TUNE_JOINT);
    cost_of_method(TUNE_SENSITIVITY);
    cost_of_method(TUNE_INPUT);
    cost_say("done", 0, 0, 0, 0);
    for (;;) {
    }
}
