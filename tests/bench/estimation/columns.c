/* Counts the instructions of a step of the estimator `composition` on columns of several sizes, and of the dense extended Kalman
 * filter of the same model beside it. */
#include "column.h"
#include "cost.h"
#include "dense_ekf.h"

#define SAMPLES 220u
#define FIRST   20u

static struct composition_block estimator;

static void cost_of(const char *what, size_t stages, enum composition_method method,
                    enum bench_truncated truncated)
{
    struct cost cost = {0}, first = {0};
    real_t t[BENCH_SENSORS];
    if (!bench_begin(&estimator, stages, method, truncated))
        return; /* a row is missing */
    for (unsigned k = 0; k < SAMPLES; k++) {
        bench_next(&estimator, t);
        cost_paint_stack();
        uint32_t from = cost_now();
        enum err err = whole_step(&estimator, t);
        uint32_t to = cost_now();
        if (err)
            return;
        if (k == 0) /* bubble points from the middle of the temperature range */
            cost_add(&first, from, to);
        if (k >= FIRST)
            cost_add(&cost, from, to);
        cost_stack(&cost);
    }
    cost_say(what, (unsigned)stages, cost.sum / cost.count, cost.most,
             sizeof(struct composition_block));
    cost_say("first", (unsigned)stages, first.most, first.most, 0);
    cost_say("stack", (unsigned)stages, cost.stack, cost.stack, 0);
}

#if COLUMN_STAGES_MAX < 100 /* its matrices leave no room for more */
static void cost_of_dense(const char *what, enum dense_form form)
{
    static struct dense_ekf ekf;
    struct cost cost = {0}, covariance = {0};
    real_t t[BENCH_SENSORS];
    if (!bench_begin(&estimator, DENSE_STAGES, METHOD_REKF, ALL_STAGES) ||
        dense_ekf_begin(&ekf, &estimator, form) != ERR_OK)
        return;
    for (unsigned k = 0; k < SAMPLES / 4; k++) {
        bench_next(&estimator, t);
        cost_paint_stack();
        uint32_t from = cost_now();
        enum err err = dense_ekf_model(&ekf, &estimator.model.inputs, t);
        uint32_t between = cost_now();
        dense_ekf_covariance(&ekf);
        uint32_t to = cost_now();
        if (err)
            return;
        if (k >= FIRST) {
            cost_add(&cost, from, to);
            cost_add(&covariance, between, to);
        }
        cost_stack(&cost);
    }
    cost_tell(what, DENSE_STAGES, &cost, dense_ekf_bytes(form));
    cost_say("covariance", DENSE_STAGES, covariance.sum / covariance.count, covariance.most, 0);
    if (form == DENSE_STEPS)
        cost_say("steps", DENSE_STAGES, ekf.steps, ekf.steps, 0);
}
#endif

int main(void)
{
    static const uint8_t stages[] = {12, 37, 100};
    for (unsigned k = 0; k < sizeof stages && stages[k] <= COLUMN_STAGES_MAX; k++) {
        cost_of("geometric", stages[k], METHOD_GEOMETRIC, ALL_STAGES);
        cost_of("rekf", stages[k], METHOD_REKF, ALL_STAGES);
    }
    cost_of("geometric-truncated", 37, METHOD_GEOMETRIC, BETWEEN_ON_A_LINE);
    cost_of("rekf-truncated", 37, METHOD_REKF, BETWEEN_ON_A_LINE);
    cost_of("geometric-mean", 37, METHOD_GEOMETRIC, BETWEEN_BY_THE_MEAN);
#if COLUMN_STAGES_MAX < 100
    cost_of_dense("dense-euler", DENSE_EULER);
    cost_of_dense("dense-steps", DENSE_STEPS);
    cost_of_dense("dense-band", DENSE_BAND);
    cost_of_dense("dense-transition", DENSE_TRANSITION);
#endif
    cost_say("done", 0, 0, 0, 0);
    for (;;) {
    }
}
