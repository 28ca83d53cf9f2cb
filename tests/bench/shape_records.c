/* Not a test: fits shapes to records from its standard input as the commissioning would, and prints what it found. For
 * tests/bench/shape_deviations.py, which makes the records.
 *
 *   shape_records < records         a record: struct head, then head.samples doubles, native byte order
 *   shape_records --members N < records     likewise, with N plausible members of each element at the end of its line
 *   shape_records --memory          bytes of the structs, computed by the compiler
 *
 * A line a record: kind, evaluations; shape; deviations; that of the residence time; weight of the other; then of each
 * formula: squares, correlation, place, gain and zero, variances of gain and residence time.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "identify/shape_choice.h"
#include "identify/shape_fit.h"

struct head {
    uint32_t samples, edges;
    uint32_t known; /* the baseline is known with its deviations; else it is free */
    uint32_t units; /* of a piece */
    double h_s;
    double offset, slope_per_s, offset_sd, slope_sd_per_s, noise_sd;
    struct {
        double sample, level;
    } edge[EXCITATION_EDGES_MAX];
};

static struct record record;
static struct fopdt_fit one_fit;
static struct shape_fit fit;

static void must(enum err err, const char *what)
{
    if (!err)
        return;
    fprintf(stderr, "shape_records: %s: %s\n", what, err_text(err));
    exit(1);
}

static void take_record(const struct head *h, const double *y)
{
    must(record_init(&record, 1, (real_t)h->h_s), "record_init");
    for (uint32_t k = 0, e = 0; k < h->samples; k++) {
        real_t v = (real_t)y[k];
        must(record_step(&record, &v), "record_step");
        for (; e < h->edges && (uint32_t)h->edge[e].sample == k; e++)
            must(record_move(&record, (real_t)h->edge[e].level), "record_move");
    }
}

static void print_candidates(void)
{
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++) {
        const struct shape_candidate *c = &fit.candidate[k];
        struct shape s;
        shape_choice_shape(&fit, (enum shape_formula)k, &s);
        printf(" %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g", (double)c->squares,
               (double)c->correlation, (double)s.gain, (double)s.dead_time_s, (double)s.lag_s,
               (double)s.square_s2, (double)s.zero_s, (double)c->covariance[0],
               (double)c->covariance[5]);
    }
}

static void print_members(const struct shape_found *found, uint32_t members)
{
    for (uint32_t n = 0; n < members; n++) {
        struct shape s;
        shape_found_draw(found, 1, n, &s);
        printf(" %.9g %.9g %.9g %.9g %.9g", (double)s.gain, (double)s.dead_time_s, (double)s.lag_s,
               (double)s.square_s2, (double)s.zero_s);
    }
}

static void fit_shapes(const struct head *h, uint32_t members)
{
    struct fopdt_fit_options o = {.baseline = {(real_t)h->offset, (real_t)h->slope_per_s,
                                               (real_t)h->offset_sd, (real_t)h->slope_sd_per_s,
                                               (real_t)h->noise_sd},
                                  .free_offset = !h->known,
                                  .free_slope = !h->known};
    struct fopdt_fit_result one;
    struct shape_found found;
    must(fopdt_fit_begin(&one_fit, &record, 0, &o), "fopdt_fit_begin");
    while (!fopdt_fit_run(&one_fit, 20))
        ;
    must(fopdt_fit_result(&one_fit, &one), "fopdt_fit_result");
    must(shape_fit_begin(&fit, &record, 0, &o, &one), "shape_fit_begin");
    while (!shape_fit_run(&fit, h->units))
        ;
    must(shape_fit_result(&fit, &found), "shape_fit_result");
    printf("%d %u %u %.9g %.9g %.9g %.9g %.9g", found.kind, fit.evaluations, fit.points,
           (double)found.shape.gain, (double)found.shape.dead_time_s, (double)found.shape.lag_s,
           (double)found.shape.square_s2, (double)found.shape.zero_s);
    for (unsigned k = 0; k < SHAPE_PARAMETERS; k++)
        printf(" %.9g", (double)found.sd[k]);
    printf(" %.9g %.9g %.9g %.9g", (double)found.residence_sd_s, found.other_weight / 255.0,
           (double)one.element.gain, (double)one.element.gain_sd);
    printf(" %.9g", (double)fit.total);
    print_candidates();
    print_members(&found, members);
    printf("\n");
}

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "--memory") == 0) {
        printf("fit of one lag %zu\nfit of shapes %zu\nkept %zu\n", sizeof one_fit, sizeof fit,
               sizeof(struct shape_found));
        return 0;
    }
    uint32_t members = 0;
    if (argc == 3 && strcmp(argv[1], "--members") == 0)
        members = (uint32_t)strtoul(argv[2], NULL, 10);
    struct head h;
    while (fread(&h, sizeof h, 1, stdin) == 1) {
        double *y = malloc(h.samples * sizeof *y);
        if (!y || h.edges > EXCITATION_EDGES_MAX ||
            fread(y, sizeof *y, h.samples, stdin) != h.samples) {
            fprintf(stderr, "shape_records: not a record\n");
            free(y);
            return 1;
        }
        take_record(&h, y);
        free(y);
        fit_shapes(&h, members);
    }
    return 0;
}
