/* On the host, under callgrind: estimation_cost WHAT STAGES STEPS; tools/bench takes the difference of two counts of steps. WHAT:
 * geometric, rekf, dense-FORM, or METHOD-COVARIANCE-EXTRAS of a Kalman filter. */
#include <stdalign.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "column.h"
#include "dense_ekf.h"
#include "filter.h"

static const char *const names[] = {[DENSE_EULER] = "dense-euler",
                                    [DENSE_STEPS] = "dense-steps",
                                    [DENSE_BAND] = "dense-band",
                                    [DENSE_TRANSITION] = "dense-transition"};

static const struct filter {
    const char *name;
    enum composition_method method;
    enum composition_covariance covariance;
    size_t extras;
} filters[] = {{"ekf-full-2", METHOD_EKF, COVARIANCE_FULL, 2},
               {"ekf-band-2", METHOD_EKF, COVARIANCE_BAND, 2},
               {"kalman-full-2", METHOD_KALMAN, COVARIANCE_FULL, 2},
               {"kalman-band-2", METHOD_KALMAN, COVARIANCE_BAND, 2},
               {"ekf-full-0", METHOD_EKF, COVARIANCE_FULL, 0},
               {"ekf-band-0", METHOD_EKF, COVARIANCE_BAND, 0},
               {"ekf-full-3", METHOD_EKF, COVARIANCE_FULL, 3},
               {"ekf-band-3", METHOD_EKF, COVARIANCE_BAND, 3}};

static struct composition_block estimator;
static struct dense_ekf dense;

/* Work that is counted; the truth beside it is not. */
enum err measured(struct dense_ekf *ekf, const float *t);
enum err measured_tick(const float *t);
void measured_job(void);

__attribute__((noinline)) enum err measured(struct dense_ekf *ekf, const float *t)
{
    return ekf ? dense_ekf_step(ekf, &estimator.model.inputs, t) : whole_step(&estimator, t);
}

__attribute__((noinline)) enum err measured_tick(const float *t)
{
    return filter_tick(t);
}

__attribute__((noinline)) void measured_job(void)
{
    filter_job();
}

static int no_solution(int step)
{
    fprintf(stderr, "step %d has no solution\n", step);
    return 1;
}

static int run_filter(const struct filter *f, size_t stages, int steps)
{
    static alignas(max_align_t) uint8_t memory[1u << 19];
    float t[BENCH_SENSORS];
    if (!filter_begin(stages, f->method, f->covariance, f->extras, memory, sizeof memory)) {
        fprintf(stderr, "there is no such filter\n");
        return 1;
    }
    for (int k = 0; k < steps; k++) {
        bench_next(filter_block, t);
        if (measured_tick(t) != ERR_OK)
            return no_solution(k);
        measured_job();
    }
    printf("largest mole fraction off at the end: %.9g; state %u, workspace %u\n",
           (double)bench_off(filter_block->model.x), (unsigned)filter_state_bytes(),
           (unsigned)filter_workspace_bytes());
    return filter_is_well() ? 0 : 1;
}

static int run_estimator(struct dense_ekf *ekf, int steps)
{
    float t[BENCH_SENSORS];
    for (int k = 0; k < steps; k++) {
        bench_next(&estimator, t);
        if (measured(ekf, t) != ERR_OK)
            return no_solution(k);
    }
    printf("largest mole fraction off at the end: %.9g\n",
           (double)bench_off(ekf ? ekf->x : estimator.model.x));
    return 0;
}

int main(int argc, char **argv)
{
    struct dense_ekf *ekf = NULL;
    if (argc != 4) {
        fprintf(stderr, "estimation_cost WHAT STAGES STEPS\n");
        return 2;
    }
    size_t stages = (size_t)atoi(argv[2]);
    int steps = atoi(argv[3]);
    for (size_t k = 0; k < sizeof filters / sizeof *filters; k++)
        if (strcmp(argv[1], filters[k].name) == 0)
            return run_filter(&filters[k], stages, steps);
    if (!bench_begin(&estimator, stages, argv[1][0] == 'g' ? METHOD_GEOMETRIC : METHOD_REKF,
                     ALL_STAGES)) {
        fprintf(stderr, "this column has no steady state\n");
        return 1;
    }
    for (unsigned form = 0; form < sizeof names / sizeof *names; form++)
        if (strcmp(argv[1], names[form]) == 0) {
            ekf = &dense;
            if (dense_ekf_begin(ekf, &estimator, (enum dense_form)form) != ERR_OK)
                return 1;
        }
    return run_estimator(ekf, steps);
}
