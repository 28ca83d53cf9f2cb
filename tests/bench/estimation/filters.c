/* Counts the instructions of Kalman filters of several columns: a tick, and the job between two of them, whole, by its largest piece, and by
 * what it is about. */
#include <stdalign.h>

#include "base/workspace.h"
#include "column.h"
#include "cost.h"
#include "filter.h"

#define SAMPLES 94u
#define FIRST   20u /* the rest is one round of noise over 74 mole fractions, eight a time */

static alignas(8) uint8_t memory[WORKSPACE_BYTES];

static const char *const phase_names[PHASE_DONE] = {
    "phase-model",   "phase-factors",  "phase-feed",  "phase-carry",
    "phase-sensors", "phase-analyses", "phase-points"};

static void count_job(struct cost *job, struct cost *piece, struct cost *phase)
{
    struct cost all = {0}, of[PHASE_DONE] = {{0}};
    bool more = true;
    while (more) {
        unsigned is = filter_phase();
        uint32_t from = cost_now();
        more = filter_piece();
        uint32_t to = cost_now();
        cost_add(&all, from, to);
        cost_add(piece, from, to);
        cost_add(&of[is], from, to);
    }
    cost_sum(job, all.sum);
    for (unsigned k = 0; k < PHASE_DONE; k++)
        cost_sum(&phase[k], of[k].sum);
}

static void cost_of(const char *what, size_t stages, enum composition_method method,
                    enum composition_covariance covariance, size_t extras)
{
    struct cost tick = {0}, job = {0}, piece = {0}, phase[PHASE_DONE] = {{0}};
    float t[BENCH_SENSORS];
    if (!filter_begin(stages, method, covariance, extras, memory, sizeof memory))
        return; /* a row is missing */
    for (unsigned k = 0; k < SAMPLES; k++) {
        struct cost before = {0}, unused[PHASE_DONE] = {{0}};
        bool counts = k >= FIRST;
        bench_next(filter_block, t);
        cost_paint_stack();
        uint32_t from = cost_now();
        enum err err = filter_tick(t);
        uint32_t to = cost_now();
        if (err)
            return;
        if (counts)
            cost_add(&tick, from, to);
        cost_stack(&tick);
        if (!filter_block->filter.job) { /* it gets its workspace before its first order */
            filter_job();
            continue;
        }
        cost_paint_stack();
        count_job(counts ? &job : &before, counts ? &piece : &before, counts ? phase : unused);
        cost_stack(&job);
    }
    if (!filter_is_well())
        return;
    unsigned n = (unsigned)stages;
    cost_say(what, n, tick.sum / tick.count, tick.most, filter_state_bytes());
    cost_say("tick-stack", n, tick.stack, tick.stack, 0);
    cost_say("job", n, job.sum / job.count, job.most, filter_workspace_bytes());
    cost_say("piece", n, piece.sum / piece.count, piece.most, 0);
    cost_say("job-stack", n, job.stack, job.stack, 0);
    for (unsigned k = 0; k < PHASE_DONE; k++)
        cost_say(phase_names[k], n, phase[k].sum / phase[k].count, phase[k].most, 0);
}

int main(void)
{
    static const uint8_t stages[] = {12, 37};
    for (unsigned k = 0; k < sizeof stages; k++) {
        cost_of("ekf-full-2", stages[k], METHOD_EKF, COVARIANCE_FULL, 2);
        cost_of("ekf-band-2", stages[k], METHOD_EKF, COVARIANCE_BAND, 2);
        cost_of("ekf-full-0", stages[k], METHOD_EKF, COVARIANCE_FULL, 0);
        cost_of("ekf-band-0", stages[k], METHOD_EKF, COVARIANCE_BAND, 0);
        cost_of("kalman-full-2", stages[k], METHOD_KALMAN, COVARIANCE_FULL, 2);
        cost_of("kalman-band-2", stages[k], METHOD_KALMAN, COVARIANCE_BAND, 2);
    }
    cost_of("ekf-full-3", 37, METHOD_EKF, COVARIANCE_FULL, 3);
    cost_of("ekf-band-3", 37, METHOD_EKF, COVARIANCE_BAND, 3);
    cost_say("done", 0, 0, 0, 0);
    for (;;) {
    }
}
