/* The whole block with its supervision, driven as the tick drives it: step, what took effect, back-calculation; its work is done between
 * steps. Settings are the defaults but for what every user has to say: the PI of the tune-in, and how many terms and inputs
 * there are. */
#include <math.h>
#include <stdalign.h>
#include <string.h>

#include "adapt/gmv_block.h"
#include "adapt/gmv_kind.h"
#include "endurance.h"

#define DEPTH       64
#define BYTES       12000
#define PARAMETER   50.0f
#define AT_REST     0.5f /* where the MV stands that gives the plants their u = 0 */
#define MODELS_MOST 100u /* more self-tunings than these in a run, and something is wrong */

struct bench {
    struct gmv_settings settings;
    struct block_setup setup;
    struct block_io io;
    num_t setpoint, in, out, input[2];
    uint8_t clamp, limited, quality[2];
    float age_s[2], event_value[BLOCK_EVENTS_MAX];
    const struct applied_history *applied[1];
    struct block_proposal proposal;
    struct block_excitation excite[BLOCK_EXCITES_MAX];
};

static alignas(8) char state[BYTES];
static alignas(8) char history[sizeof(struct applied_history) + DEPTH * sizeof(num_t)];

static void fill_defaults(struct gmv_settings *s)
{
    for (unsigned k = 0; k < gmv_kind.parameters; k++) {
        const struct block_parameter *p = &gmv_kind.parameter[k];
        for (unsigned i = 0; i < (unsigned)p->rows * p->cols; i++) {
            char *at = (char *)s + p->offset;
            if (p->type == BLOCK_FLOAT)
                ((float *)(void *)at)[i] = p->initial;
            else if (p->type == BLOCK_U16)
                ((uint16_t *)(void *)at)[i] = (uint16_t)p->initial;
            else
                ((uint8_t *)at)[i] = (uint8_t)p->initial;
        }
    }
}

static bool bench_begin(struct bench *b, enum course course)
{
    bool stiff = course == COURSE_STIFF;
    memset(b, 0, sizeof *b);
    fill_defaults(&b->settings);
    b->settings.tune_gain[0] = 1;
    if (stiff) {
        b->settings.form = GMV_POSITIONAL;
        b->settings.na = b->settings.nb = 2;
    }
    b->setup = (struct block_setup){.settings = &b->settings,
                                    .interval_s = 30,
                                    .members = 1,
                                    .there = 1,
                                    .inputs = (uint8_t)(stiff ? 2 : 1)};
    b->setup.member[0] = (struct block_member){.drives_mv = true, .pv_span = 1, .out_reach = 1};
    b->setup.pv[0] = (struct block_signal){.lo = 0, .hi = 1};
    b->setup.input[0] = b->setup.input[1] = b->setup.pv[0];
    struct block_fault fault;
    if (gmv_kind.check(&b->setup, &fault) != ERR_OK || gmv_kind.bytes(&b->setup) > sizeof state ||
        gmv_kind.history(&b->setup) > DEPTH)
        return false;
    b->applied[0] = (struct applied_history *)(void *)history;
    b->io = (struct block_io){.setpoint = &b->setpoint,
                              .in = &b->in,
                              .out = &b->out,
                              .clamp = &b->clamp,
                              .limited = &b->limited,
                              .input = b->input,
                              .quality = b->quality,
                              .age_s = b->age_s,
                              .event_value = b->event_value,
                              .member_applied = b->applied,
                              .excite = b->excite,
                              .divisor = 1,
                              .acting = 1};
    applied_history_begin((struct applied_history *)(void *)history, DEPTH,
                          num_from_float(AT_REST));
    b->out = num_from_float(AT_REST);
    return gmv_kind.configure(state, &b->setup, false) == ERR_OK;
}

static void bench_signals(struct bench *b, const struct course_plant *p)
{
    b->in = b->input[0] = num_from_float((float)course_reading(p));
    b->input[1] = num_from_float((float)p->load);
    b->setpoint = num_from_float((float)p->w);
}

/* What the main loop does in its time between two steps. */
static void do_work(struct bench *b)
{
    if (b->io.work_wanted && b->io.ask_work && --b->io.ask_work == 0) {
        while (gmv_kind.work(state)) {
        }
        b->io.work_done = true;
        b->io.work_wanted = false;
    }
}

static void check_estimator(struct verdict *v, const struct course_plant *p,
                            const struct gmv_block *block)
{
    const struct gmv *g = gmv_of_const(block);
    const struct rls *r = gmv_rls(g, 0);
    float least, most;
    rls_d_extremes(r, &least, &most);
    verdict_of(v, p, !(least > 0 && isfinite(most)), "D not positive");
    for (unsigned k = 0; k < gmv_parameters(&g->shape, 0); k++) {
        verdict_of(v, p, !(fabsf(num_to_float(gmv_used(g, 0, k))) < PARAMETER), "parameter in use");
        verdict_of(v, p, !(fabsf(num_to_float(rls_theta(r, k))) < PARAMETER), "parameter");
    }
}

struct verdict run_supervised(enum course course, uint64_t samples, uint64_t seed)
{
    struct verdict v = {0};
    struct course_plant plant;
    struct bench b;
    const struct gmv_block *block = (const struct gmv_block *)(const void *)state;
    uint64_t lawful = 0, begun = 0;
    course_begin(&plant, course, samples, seed);
    verdict_of(&v, &plant, !bench_begin(&b, course), "settings");
    for (uint64_t t = 0; t < samples && !v.at; t++) {
        course_prepare(&plant);
        bench_signals(&b, &plant);
        num_t before = b.out;
        if (t == 0)
            gmv_kind.follow(state, &b.io);
        do_work(&b);
        uint8_t waiting = b.io.ask_work;
        b.proposal.n = 0;
        b.io.proposal = &b.proposal;
        b.io.raised = 0;
        b.io.ask_work = 0;
        bool law = block->watch.state == GMV_SELF_TUNING;
        gmv_kind.step(state, &b.io);
        if (b.io.ask_work && !b.io.work_wanted)
            b.io.work_wanted = true;
        else
            b.io.ask_work = waiting;
        b.io.work_done = false;
        verdict_of(&v, &plant, b.io.gives_up != NULL, "gave up");
        b.out = num_clamp(b.out, num_zero(), num_one());
        gmv_kind.back_calculate(state, &b.io);
        applied_history_append((struct applied_history *)(void *)history, b.out);
        course_step(&plant, (double)(num_to_float(b.out) - AT_REST));
        verdict_of_control(&v, &plant, (double)num_to_float(num_sub(b.out, before)));
        check_estimator(&v, &plant, block);
        lawful += block->watch.state == GMV_SELF_TUNING;
        begun += !law && block->watch.state == GMV_SELF_TUNING;
        verdict_of(&v, &plant, begun > MODELS_MOST, "back to the PI too often");
    }
    /* A block that never adopts a model holds as well, but it is no self-tuner. */
    verdict_of(&v, &plant, 2 * lawful < samples, "PI more than half of the time");
    return v;
}
