/* A tick of the kind `experiment` while its signals move the MVs, and what it takes to find the model: all of it, and its largest piece. The plant is made up:
 * first order, each output by its own input and a third of the others. */
#include <stdalign.h>
#include <string.h>

#include "base/channel.h"
#include "base/workspace.h"
#include "cost.h"
#include "decoupling.h"
#include "kinds/experiment/experiment_job.h"
#include "kinds/experiment/experiment_settings.h"
#include "kinds/experiment/experiment_state.h"

static alignas(8) char state[4000];
static alignas(8) char memory[WORKSPACE_BYTES];
static alignas(8) char history[EXPERIMENT_MOST][sizeof(struct applied_history) + 4 * sizeof(num_t)];
static struct workspace workspace;
static struct experiment_settings settings;
static struct block_setup setup;
static struct block_fault fault;
static float level[EXPERIMENT_MOST];

static void setup_experiment(unsigned n)
{
    memset(&settings, 0, sizeof settings);
    settings.bits = 6;
    settings.clock = 2;
    settings.periods = 2;
    settings.settle = 10;
    settings.na = 2;
    settings.nb = 5;
    settings.cutoff = 1;
    settings.method = ARX_IV;
    memset(&setup, 0, sizeof setup);
    setup.settings = &settings;
    setup.interval_s = 60;
    setup.inputs = (uint8_t)(2 * n);
    for (unsigned k = 0; k < n; k++) {
        settings.amplitude[k] = 0.1f;
        settings.band[k] = 1;
        setup.input[k] = (struct block_signal){0, 1, false};
        setup.input[n + k] = (struct block_signal){0, 1, true};
        applied_history_begin((struct applied_history *)(void *)history[k], 4,
                              num_from_float(0.5f));
        level[k] = 0.5f;
    }
}

static void move_plant(unsigned n, const struct block_io *io, num_t *input)
{
    for (unsigned i = 0; i < n; i++) {
        float sum = 0;
        for (unsigned j = 0; j < n; j++) {
            float u = io->requests.excite[j].what ? num_to_float(io->requests.excite[j].value) : 0;
            sum += (i == j ? 0.1f : 0.033f) * u;
        }
        level[i] += 0.15f * (0.5f - level[i]) + sum;
        input[i] = num_from_float(level[i] + 0.001f * cost_random());
    }
    for (unsigned j = 0; j < n; j++) {
        num_t u = io->requests.excite[j].what ? io->requests.excite[j].value : num_zero();
        applied_history_append((struct applied_history *)(void *)history[j],
                               num_add(num_from_float(0.5f), u));
    }
}

static void cost_of_experiment(unsigned n)
{
    struct experiment *b = (struct experiment *)(void *)state;
    const struct applied_history *applied[2 * EXPERIMENT_MOST] = {NULL};
    struct block_excitation excite[BLOCK_EXCITES_MAX];
    uint8_t quality[2 * EXPERIMENT_MOST];
    num_t input[2 * EXPERIMENT_MOST];
    float value[BLOCK_EVENTS_MAX];
    struct cost tick = {0}, find = {0};
    setup_experiment(n);
    workspace_init(&workspace, memory, sizeof memory);
    workspace_share(&workspace);
    for (unsigned k = 0; k < 2 * n; k++) {
        quality[k] = QUALITY_GOOD;
        input[k] = num_from_float(0.5f);
        if (k >= n)
            applied[k] = (struct applied_history *)(void *)history[k - n];
    }
    if (experiment_kind.check(&setup, &fault) != ERR_OK ||
        experiment_kind.bytes(&setup) > sizeof state ||
        experiment_kind.configure(state, &setup, false) != ERR_OK)
        return; /* a row is missing */
    struct block_io io = {.inputs.value = input,
                          .inputs.quality = quality,
                          .inputs.applied = applied,
                          .requests.excite = excite,
                          .requests.event_value = value,
                          .members.divisor = 1};
    memset(excite, 0, sizeof excite);
    (void)experiment_kind.verb[0].run(state, NULL);
    for (unsigned t = 0; t < 2000 && b->stages.stage != EXPERIMENT_COMPUTES; t++) {
        uint8_t stage = b->stages.stage;
        memset(excite, 0, sizeof excite);
        io.requests.excite_state = stage == EXPERIMENT_EXCITES ? EXCITE_RUNS : EXCITE_OFF;
        io.requests.ask_work = 0;
        cost_paint_stack();
        uint32_t from = cost_now();
        experiment_kind.step(state, &io);
        uint32_t to = cost_now();
        if (stage == EXPERIMENT_EXCITES && b->stages.stage == EXPERIMENT_EXCITES)
            cost_add(&tick, from, to);
        cost_stack(&tick);
        io.requests.work_done = io.requests.ask_work > 0;
        if (io.requests.ask_work && b->stages.stage == EXPERIMENT_ASKED)
            (void)experiment_kind.work(state);
        move_plant(n, &io, input);
        workspace_tick(&workspace);
    }
    /* As many pieces as a step has, then the step that takes them. */
    for (unsigned k = 0; k < 10000 && b->stages.stage == EXPERIMENT_COMPUTES; k++) {
        cost_paint_stack();
        uint32_t from = cost_now();
        bool more = experiment_kind.work(state);
        uint32_t to = cost_now();
        cost_add(&find, from, to);
        cost_stack(&find);
        if (more)
            continue;
        io.requests.work_done = true;
        experiment_kind.step(state, &io);
    }
    if (tick.count == 0 || find.count == 0)
        return;
    cost_say("experiment", n * 10 + settings.nb, tick.sum / tick.count, tick.most,
             experiment_kind.bytes(&setup));
    cost_say("stack", n, tick.stack, tick.stack, 0);
    cost_say("find", n, find.sum, find.most,
             experiment_job_bytes(n, experiment_samples(&settings)));
    cost_say("stack", n, find.stack, find.stack, 0);
}

void cost_of_experiments(void)
{
    cost_of_experiment(1);
    cost_of_experiment(2);
    cost_of_experiment(4);
}
