/* Counts the instructions of a Kalman filter's covariance on the splitter with several numbers of stages: a step with three extras and
 * noise on eight fractions (of the banded form on all), and four temperatures; beside it the same step with the transition as a matrix. */
#include <stdalign.h>
#include <string.h>

#include "column.h"
#include "cost.h"
#include "kinds/composition/covariance_band.h"
#include "kinds/composition/covariance_ud.h"
#include "num/ud.h"
#include "thornton.h"

#define STEPS   40u
#define FIRST   8u
#define EXTRAS  3
#define NOISY   8
#define STATES  (80 + EXTRAS)
#define SENSORS 4

/* First the covariance's own, behind them what the opponent needs besides. */
#define OWN 4500
static alignas(8) real_t memory[OWN + STATES * (STATES + NOISY + EXTRAS) + 2 * STATES];
static real_t numbers[40 * 29], push[COVARIANCE_EXTRAS_MAX * 120], work[80], noise[120];
static real_t gain[COVARIANCE_STATES_MAX];
static struct covariance_band band;
static struct composition_block estimator;
static struct covariance_ud ud;
static struct covariance_step step;
static struct column_transition transition;
#if COLUMN_STAGES_MAX < 100
static real_t matrix[STATES * STATES];
#endif

static bool begin(size_t stages)
{
    static const real_t keep[EXTRAS] = {1, 1, 1};
    static const real_t grown[EXTRAS] = {1e-7f, 1e-7f, 1e-7f};
    struct composition_block *c = &estimator;
    transition.factors = numbers;
    size_t n = 2 * stages;
    real_t variance[STATES], t[BENCH_SENSORS];
    if (!bench_begin(&estimator, stages, METHOD_REKF, ALL_STAGES))
        return false;
    bench_next(&estimator, t);
    if (whole_step(c, t) != ERR_OK || column_rates(&c->model.column, c->model.x, work) != ERR_OK ||
        column_transition_make(&c->model.column, c->model.x, BENCH_STEP_S, &transition) != ERR_OK)
        return false;
    for (size_t e = 0; e < 2; e++)
        column_feed_slopes(&c->model.column, c->model.x, e, push + e * n);
    column_feed_flow_slope(&c->model.column, c->model.x, push + 2 * n, work);
    for (size_t i = 0; i < EXTRAS * n; i++)
        push[i] *= BENCH_STEP_S;
    for (size_t i = 0; i < n; i++)
        noise[i] = 1e-7f;
    for (size_t i = 0; i < n + EXTRAS; i++)
        variance[i] = i < n ? 1e-4f : 1e-2f;
    step = (struct covariance_step){.transition = &transition,
                                    .extras = EXTRAS,
                                    .push = push,
                                    .keep = keep,
                                    .grown = grown,
                                    .noise = noise,
                                    .noise_count = NOISY};
    return covariance_ud_begin(&ud, stages, 2, EXTRAS, variance, memory) == ERR_OK;
}

static void cost_of_pieces(struct cost *step_cost, struct cost *piece)
{
    uint32_t all = 0;
    bool more = true;
    while (more) {
        uint32_t from = cost_now();
        more = covariance_ud_carry_piece(&ud, &step, COVARIANCE_UD_EFFORT);
        uint32_t to = cost_now();
        cost_add(piece, from, to);
        all += to - from;
    }
    cost_add(step_cost, 0, all);
}

static struct covariance_measurement temperature_at(size_t stages, unsigned k)
{
    static const uint8_t at[SENSORS] = {5, 30, 31, 33};
    static const real_t slope[2] = {-40, -15};
    return (struct covariance_measurement){.first = 2 * ((at[k] - 1u) * (stages - 1) / 36),
                                           .count = 2,
                                           .slope = slope,
                                           .extra = EXTRAS,
                                           .variance = 0.04f};
}

static void measure_at(size_t stages, unsigned k, struct cost *cost)
{
    struct covariance_measurement z = temperature_at(stages, k);
    uint32_t from = cost_now();
    (void)covariance_ud_take(&ud, &z, gain);
    uint32_t to = cost_now();
    cost_add(cost, from, to);
}

static void cost_of(size_t stages)
{
    struct cost carry = {0}, quiet = {0}, piece = {0}, take = {0}, of = {0}, factors = {0};
    if (!begin(stages))
        return;
    for (unsigned k = 0; k < STEPS; k++) {
        step.noise_first = k * NOISY % (2 * stages);
        cost_paint_stack();
        struct cost one = {0};
        cost_of_pieces(&one, &piece);
        cost_stack(&of);
        if (k >= FIRST)
            cost_add(&carry, 0, one.sum);
        uint32_t all = take.sum;
        for (unsigned s = 0; s < SENSORS; s++)
            measure_at(stages, s, &take);
        cost_add(&of, 0, take.sum - all);
    }
    static const real_t none[EXTRAS] = {0};
    step.grown = none;
    step.noise_count = 0;
    for (unsigned k = 0; k < 4; k++)
        cost_of_pieces(&quiet, &piece);
    uint32_t from = cost_now();
    enum err err = column_transition_make(&estimator.model.column, estimator.model.x, BENCH_STEP_S,
                                          &transition);
    uint32_t to = cost_now();
    if (err || covariance_ud_err(&ud))
        return;
    cost_add(&factors, from, to);
    cost_say("ud-carry", (unsigned)stages, carry.sum / carry.count, carry.most,
             (uint32_t)covariance_ud_bytes(stages, 2, EXTRAS));
    cost_say("ud-carry-without-noise", (unsigned)stages, quiet.sum / quiet.count, quiet.most, 0);
    cost_say("ud-piece", (unsigned)stages, piece.sum / piece.count, piece.most, 0);
    cost_say("ud-measurements", (unsigned)stages, of.sum / of.count, of.most, 0);
    cost_say("transition", (unsigned)stages, factors.most, factors.most,
             (uint32_t)(stages * column_transition_stride(2) * sizeof(real_t)));
    cost_say("stack", (unsigned)stages, of.stack, of.stack, 0);
}

static void cost_of_band_step(struct cost *carry, struct cost *piece)
{
    struct cost one = {0};
    bool more = true;
    while (more) {
        uint32_t from = cost_now();
        more = covariance_band_carry_piece(&band, &step, COVARIANCE_BAND_EFFORT);
        uint32_t to = cost_now();
        cost_add(&one, from, to);
        cost_add(piece, from, to);
    }
    cost_add(carry, 0, one.sum);
}

static void cost_of_band(size_t stages)
{
    struct cost carry = {0}, piece = {0}, of = {0};
    real_t variance[STATES];
    if (!begin(stages))
        return;
    for (size_t i = 0; i < 2 * stages + EXTRAS; i++)
        variance[i] = i < 2 * stages ? 1e-4f : 1e-2f;
    step.noise_count = 2 * stages;
    if (covariance_band_begin(&band, stages, 2, EXTRAS, variance, memory) != ERR_OK)
        return;
    for (unsigned k = 0; k < STEPS; k++) {
        struct cost taken = {0};
        cost_paint_stack();
        cost_of_band_step(&carry, &piece);
        for (unsigned s = 0; s < SENSORS; s++) {
            struct covariance_measurement z = temperature_at(stages, s);
            uint32_t from = cost_now();
            (void)covariance_band_take(&band, &z, gain);
            uint32_t to = cost_now();
            cost_add(&taken, from, to);
        }
        cost_stack(&of);
        cost_add(&of, 0, taken.sum);
    }
    if (band.err)
        return;
    cost_say("band-carry", (unsigned)stages, carry.sum / carry.count, carry.most,
             (uint32_t)(covariance_band_bytes(stages, 2, EXTRAS) + sizeof band));
    cost_say("band-piece", (unsigned)stages, piece.sum / piece.count, piece.most, 0);
    cost_say("band-measurements", (unsigned)stages, of.sum / of.count, of.most, 0);
    cost_say("stack", (unsigned)stages, of.stack, of.stack, 0);
}

#if COLUMN_STAGES_MAX < 100
static void cost_of_thornton(size_t stages)
{
    size_t n = 2 * stages, all = n + EXTRAS, at[NOISY + EXTRAS];
    real_t gathered[NOISY + EXTRAS];
    struct cost cost = {0}, made = {0};
    if (!begin(stages))
        return;
    for (unsigned k = 0; k < 6; k++) {
        for (size_t i = 0; i < NOISY + EXTRAS; i++) {
            at[i] = i < NOISY ? (k * NOISY + i) % n : n + i - NOISY;
            gathered[i] = 1e-7f;
        }
        uint32_t from = cost_now();
        thornton_transition(&step, n, matrix);
        uint32_t between = cost_now();
        thornton_carry(ud.ud, all, matrix, NOISY + EXTRAS, at, gathered, memory + OWN);
        uint32_t to = cost_now();
        cost_add(&made, from, between);
        cost_add(&cost, between, to);
    }
    cost_say("thornton-carry", (unsigned)stages, cost.sum / cost.count, cost.most,
             (uint32_t)((ud_count(all) + all * all + thornton_numbers(all, NOISY + EXTRAS)) *
                        sizeof(real_t)));
    cost_say("thornton-matrix", (unsigned)stages, made.sum / made.count, made.most, 0);
}
#endif

/* Other numbers of components: the factors' values are of no consequence here, only that deviations do not grow. */
static void cost_of_any(const char *what, size_t m, size_t stages)
{
    size_t stride = column_transition_stride(m), n = stages * m;
    struct cost carry = {0}, piece = {0};
    real_t variance[120 + EXTRAS];
    for (size_t i = 0; i < stages * stride; i++)
        numbers[i] = i % stride % (m + 1) == 0 ? 0.3f : 0.02f;
    for (size_t i = 0; i < n + EXTRAS; i++)
        variance[i] = 1e-4f;
    transition.stages = stages;
    transition.m = m;
    for (size_t i = 0; i < n; i++)
        noise[i] = 1e-7f;
    if (covariance_ud_begin(&ud, stages, m, EXTRAS, variance, memory) != ERR_OK)
        return;
    step.noise_count = NOISY;
    for (unsigned k = 0; k < 8; k++) {
        struct cost one = {0};
        step.noise_first = k * NOISY % n;
        cost_of_pieces(&one, &piece);
        cost_add(&carry, 0, one.sum);
    }
    cost_say(what, (unsigned)stages, carry.sum / carry.count, carry.most,
             (uint32_t)covariance_ud_bytes(stages, m, EXTRAS));
    cost_say("ud-piece", (unsigned)stages, piece.sum / piece.count, piece.most, 0);
}

/* As many numbers as a board may have: what a piece costs at most. */
static void cost_of_band_most(size_t m, size_t stages)
{
    static const real_t keep[COVARIANCE_EXTRAS_MAX] = {1, 1, 1, 1, 1, 1, 1, 1};
    static const real_t grown[COVARIANCE_EXTRAS_MAX] = {1e-7f, 1e-7f, 1e-7f, 1e-7f,
                                                        1e-7f, 1e-7f, 1e-7f, 1e-7f};
    static real_t variance[COVARIANCE_STATES_MAX];
    struct cost carry = {0}, piece = {0};
    for (size_t i = 0; i < COVARIANCE_STATES_MAX; i++)
        variance[i] = 1e-4f;
    step.extras = COVARIANCE_EXTRAS_MAX;
    step.keep = keep;
    step.grown = grown;
    step.noise_first = 0;
    step.noise_count = stages * m;
    if (covariance_band_begin(&band, stages, m, COVARIANCE_EXTRAS_MAX, variance, memory) != ERR_OK)
        return;
    for (unsigned k = 0; k < 8; k++)
        cost_of_band_step(&carry, &piece);
    cost_say("band-carry-4-components-8-extras", (unsigned)stages, carry.sum / carry.count,
             carry.most,
             (uint32_t)(covariance_band_bytes(stages, m, COVARIANCE_EXTRAS_MAX) + sizeof band));
    cost_say("band-piece", (unsigned)stages, piece.sum / piece.count, piece.most, 0);
}

int main(void)
{
    static const uint8_t stages[] = {12, 37, 40};
    for (unsigned k = 0; k < sizeof stages; k++) {
        cost_of(stages[k]);
        cost_of_band(stages[k]);
#if COLUMN_STAGES_MAX < 100
        cost_of_thornton(stages[k]);
#endif
    }
    cost_of_any("ud-carry-2-components", 1, 40);
    cost_of_any("ud-carry-3-components", 2, 40);
    cost_of_any("ud-carry-4-components", 3, 40);
    cost_of_band_most(3, 40); /* with the factors of the last */
    cost_say("done", 0, 0, 0, 0);
    for (;;) {
    }
}
