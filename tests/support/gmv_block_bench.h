/* A block of the kind `gmv` driven as the tick drives it: step, limits of the MVs, back-calculation, and its work between steps.
 * Settings begin at their defaults. */
#ifndef REFLUX_TESTS_GMV_BLOCK_BENCH_H
#define REFLUX_TESTS_GMV_BLOCK_BENCH_H

#include <stdalign.h>
#include <string.h>

#include "block_defaults.h"
#include "kinds/gmv/gmv_kind.h"
#include "kinds/gmv/gmv_kind_state.h"
#include "kinds/gmv/gmv_settings.h"

#define GMV_BENCH_DEPTH  64
#define GMV_BENCH_INPUTS (GMV_LOOPS + GMV_DISTURBANCES)

struct gmv_block_bench {
    struct gmv_settings settings;
    struct block_setup setup;
    struct block_io io;
    num_t setpoint[GMV_LOOPS], in[GMV_LOOPS], out[GMV_LOOPS], input[GMV_BENCH_INPUTS];
    uint8_t clamp[GMV_LOOPS], limited[GMV_LOOPS], quality[GMV_BENCH_INPUTS];
    float age_s[GMV_BENCH_INPUTS], event_value[BLOCK_EVENTS_MAX];
    const struct applied_history *applied[GMV_LOOPS];
    struct block_proposal proposal;
    struct block_excitation excite[BLOCK_EXCITES_MAX];
    struct {
        alignas(8) char bytes[sizeof(struct applied_history) + GMV_BENCH_DEPTH * sizeof(num_t)];
    } history[GMV_LOOPS];
    alignas(8) char state[16384];
    bool followed;
};

static inline const struct gmv_block *gmv_bench_block(const struct gmv_block_bench *b)
{
    return (const struct gmv_block *)(const void *)b->state;
}

static inline struct applied_history *gmv_bench_history(struct gmv_block_bench *b, unsigned j)
{
    return (struct applied_history *)(void *)b->history[j].bytes;
}

/* With the settings as they are; everything has been at rest with the MVs at `rest`. False: the block refuses them. */
static inline bool gmv_block_begin(struct gmv_block_bench *b, float interval_s, unsigned loops,
                                   unsigned disturbances, float rest)
{
    struct block_fault fault;
    struct gmv_settings settings = b->settings;
    memset(b, 0, sizeof *b);
    b->settings = settings;
    b->setup = (struct block_setup){.settings = &b->settings,
                                    .interval_s = interval_s,
                                    .members = (uint8_t)loops,
                                    .present = (uint8_t)((1u << loops) - 1u),
                                    .inputs = (uint8_t)(loops + disturbances)};
    for (unsigned i = 0; i < loops + disturbances; i++)
        b->setup.input[i] = (struct block_signal){.lo = 0, .hi = 1};
    for (unsigned i = 0; i < loops; i++) {
        b->setup.member[i] = (struct block_member){
            .loop = (uint8_t)i, .drives_mv = true, .pv_span = 1, .out_reach = 1};
        b->setup.pv[i] = b->setup.input[i];
        applied_history_begin(gmv_bench_history(b, i), GMV_BENCH_DEPTH, num_from_float(rest));
        b->applied[i] = gmv_bench_history(b, i);
        b->out[i] = num_from_float(rest);
    }
    b->io = (struct block_io){.members.setpoint = b->setpoint,
                              .members.in = b->in,
                              .members.out = b->out,
                              .members.clamp = b->clamp,
                              .members.limited = b->limited,
                              .inputs.value = b->input,
                              .inputs.quality = b->quality,
                              .inputs.age_s = b->age_s,
                              .requests.event_value = b->event_value,
                              .members.applied = b->applied,
                              .requests.excite = b->excite,
                              .members.divisor = 1,
                              .members.acting = (uint8_t)((1u << loops) - 1u)};
    return gmv_kind.check(&b->setup, &fault) == ERR_OK &&
           gmv_kind.bytes(&b->setup) <= sizeof b->state &&
           gmv_kind.history(&b->setup) <= GMV_BENCH_DEPTH &&
           gmv_kind.configure(b->state, &b->setup, false) == ERR_OK;
}

static inline void gmv_block_signals(struct gmv_block_bench *b, unsigned i, double w, double y)
{
    b->in[i] = b->input[i] = num_from_float((float)y);
    b->setpoint[i] = num_from_float((float)w);
}

/* Does the main loop's work between two steps. */
static inline void gmv_block_work(struct gmv_block_bench *b)
{
    if (b->io.requests.work_wanted && b->io.requests.ask_work && --b->io.requests.ask_work == 0) {
        while (gmv_kind.work(b->state)) {
        }
        b->io.requests.work_done = true;
        b->io.requests.work_wanted = false;
    }
}

/* A step: b->out is what is applied, within the MVs' limits 0 and 1. False: the block has given up for good. */
static inline bool gmv_block_step(struct gmv_block_bench *b)
{
    if (!b->followed)
        gmv_kind.follow(b->state, &b->io);
    b->followed = true;
    gmv_block_work(b);
    uint8_t waiting = b->io.requests.ask_work;
    b->proposal.n = 0;
    b->io.requests.proposal = &b->proposal;
    b->io.requests.raised = 0;
    b->io.requests.ask_work = 0;
    gmv_kind.step(b->state, &b->io);
    if (b->io.requests.ask_work && !b->io.requests.work_wanted)
        b->io.requests.work_wanted = true;
    else
        b->io.requests.ask_work = waiting;
    b->io.requests.work_done = false;
    for (unsigned i = 0; i < b->setup.members; i++)
        b->out[i] = num_clamp(b->out[i], num_zero(), num_one());
    gmv_kind.back_calculate(b->state, &b->io);
    for (unsigned i = 0; i < b->setup.members; i++)
        applied_history_append(gmv_bench_history(b, i), b->out[i]);
    return b->io.requests.gives_up == NULL;
}

#endif
