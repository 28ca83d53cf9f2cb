/* On the host, under callgrind: estimation_cost WHAT STAGES STEPS; tools/bench takes the difference of two counts of steps. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "column.h"
#include "dense_ekf.h"

static const char *const names[] = {[DENSE_EULER] = "dense-euler",
                                    [DENSE_STEPS] = "dense-steps",
                                    [DENSE_BAND] = "dense-band",
                                    [DENSE_TRANSITION] = "dense-transition"};

/* What is counted; the truth beside it is not. */
enum err measured(struct dense_ekf *ekf, const float *t);

__attribute__((noinline)) enum err measured(struct dense_ekf *ekf, const float *t)
{
    return ekf ? dense_ekf_step(ekf, &bench_estimator.inputs, t)
               : composition_step(&bench_estimator, t);
}

int main(int argc, char **argv)
{
    static struct dense_ekf dense;
    struct dense_ekf *ekf = NULL;
    real_t t[BENCH_SENSORS];
    if (argc != 4) {
        fprintf(stderr, "estimation_cost WHAT STAGES STEPS\n");
        return 2;
    }
    enum composition_method method = argv[1][0] == 'g' ? METHOD_GEOMETRIC : METHOD_REKF;
    if (!bench_begin((size_t)atoi(argv[2]), method, ALL_STAGES)) {
        fprintf(stderr, "this column has no steady state\n");
        return 1;
    }
    for (unsigned form = 0; form < sizeof names / sizeof *names; form++)
        if (strcmp(argv[1], names[form]) == 0) {
            ekf = &dense;
            if (dense_ekf_begin(ekf, &bench_estimator, (enum dense_form)form) != ERR_OK)
                return 1;
        }
    int steps = atoi(argv[3]);
    double off = 0;
    for (int k = 0; k < steps; k++) {
        bench_next(t);
        if (measured(ekf, t) != ERR_OK) {
            fprintf(stderr, "step %d has no solution\n", k);
            return 1;
        }
        off = bench_off(ekf ? ekf->x : bench_estimator.x);
    }
    printf("largest mole fraction off at the end: %.9g\n", off);
    return 0;
}
