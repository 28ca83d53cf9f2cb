/* Not a test: identifies records from its standard input as the commissioning would, and prints what it found. For
 * tools/figures/identification_table.py, which makes the records and tries scipy on the same ones.
 *
 *   identify_records < records           a record: struct head, then head.samples doubles, native byte order
 *   identify_records --memory            bytes of an experiment, computed by the compiler
 *
 * A line a record: moments K T L flags, least squares K T L flags sd_K sd_T sd_L plateau sd_plateau, noise sd.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "identify/fopdt_fit.h"
#include "identify/guard.h"
#include "identify/moments.h"
#include "identify/steady.h"

struct head {
    uint32_t samples;
    /* samples of rest, of which the last is the one at whose instant the step begins */
    uint32_t before;
    uint32_t half;   /* of the double step */
    uint32_t window; /* samples looked at for rest: multiple of STEADY_BLOCKS, at most before */
    double h_s, amplitude, noise_floor;
};

static struct moments moments;
static struct record record;
static struct fopdt_fit fit;
static struct steady steady;

static void must(enum err err, const char *what)
{
    if (!err)
        return;
    fprintf(stderr, "identify_records: %s: %s\n", what, err_text(err));
    exit(1);
}

static void identify(const struct head *h, const double *y)
{
    real_t reference = (real_t)y[0];
    struct steady_config s = {
        1, h->window / STEADY_BLOCKS, (real_t)h->h_s, (real_t)h->noise_floor, 3, 4};
    struct moments_config m = {1, moments_alphas_for((real_t)h->h_s, (real_t)(h->half * h->h_s)),
                               (real_t)h->h_s, MOMENTS_FASTEST, MOMENTS_RATIO};
    struct steady_result before = {.age_s = 0}, after;
    must(steady_init(&steady, &s), "steady_init");
    must(moments_init(&moments, &m), "moments_init");
    must(moments_begin(&moments, &reference), "moments_begin");
    must(record_init(&record, 1, (real_t)h->h_s), "record_init");
    must(record_begin(&record, &reference), "record_begin");
    uint32_t start = h->before - 1;
    for (uint32_t k = 0; k < h->samples; k++) {
        real_t v = (real_t)y[k], level = (real_t)h->amplitude;
        must(steady_step(&steady, &v), "steady_step");
        must(record_step(&record, &v), "record_step");
        if (k == start)
            must(steady_look(&steady, 0, &before), "steady_look");
        if (k >= start)
            must(moments_step(&moments, &v), "moments_step");
        if (k == start)
            must(record_move(&record, level), "record_move");
        if (k == start + h->half)
            must(record_move(&record, -level), "record_move");
        if (k == start + 2 * h->half)
            must(record_move(&record, 0), "record_move");
    }
    must(steady_look(&steady, 0, &after), "steady_look");

    /* Offset and drift by the means of before and after; time from the step. */
    struct baseline base;
    real_t end_s = (real_t)((h->samples - h->before) * h->h_s);
    must(baseline_from_means(-before.age_s, before.mean - reference, before.mean_sd,
                             end_s - after.age_s, after.mean - reference, after.mean_sd,
                             before.noise_sd, &base),
         "baseline_from_means");
    struct identified by_moments;
    must(moments_element(&moments, 0, &record.input, &base, 0, &by_moments, NULL),
         "moments_element");
    struct fopdt_fit_options options = {.baseline = {.noise_sd = before.noise_sd},
                                        .free_offset = true,
                                        .free_slope = true,
                                        .start = &by_moments};
    struct fopdt_fit_result r;
    must(fopdt_fit_begin(&fit, &record, 0, &options), "fopdt_fit_begin");
    while (!fopdt_fit_run(&fit, 20))
        ;
    must(fopdt_fit_result(&fit, &r), "fopdt_fit_result");
    printf("%.9g %.9g %.9g %u ", (double)by_moments.gain, (double)by_moments.time_constant_s,
           (double)by_moments.dead_time_s, by_moments.flags);
    printf("%.9g %.9g %.9g %u %.9g %.9g %.9g ", (double)r.element.gain,
           (double)r.element.time_constant_s, (double)r.element.dead_time_s, r.element.flags,
           (double)r.element.gain_sd, (double)r.element.time_constant_sd_s,
           (double)r.element.dead_time_sd_s);
    printf("%.9g %.9g %.9g\n", (double)r.plateau_gain, (double)r.plateau_gain_sd,
           (double)before.noise_sd);
}

static void memory(void)
{
    printf("moments %zu\n", sizeof(struct moments));
    printf("moments per output and alpha %zu\n", sizeof(moments.alpha[0].sum[0]));
    printf("record %zu\n", sizeof(struct record));
    printf("record per output %zu\n", sizeof(record.y[0]));
    printf("steady %zu\n", sizeof(struct steady));
    printf("guard %zu\n", sizeof(struct guard));
    printf("fit %zu\n", sizeof(struct fopdt_fit));
    printf("element %zu\n", sizeof(struct identified));
    printf("outputs %d\n", CHANNEL_MAX);
    printf("alphas %d\n", MOMENTS_ALPHAS_MAX);
    printf("points %d\n", RECORD_POINTS);
}

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "--memory") == 0) {
        memory();
        return 0;
    }
    struct head h;
    while (fread(&h, sizeof h, 1, stdin) == 1) {
        if (h.before < h.window || h.window < STEADY_BLOCKS ||
            h.samples < h.before + 2 * h.half + h.window) {
            fprintf(stderr, "identify_records: a record of %u samples cannot be\n", h.samples);
            return 1;
        }
        double *y = malloc(h.samples * sizeof *y);
        if (!y || fread(y, sizeof *y, h.samples, stdin) != h.samples) {
            fprintf(stderr, "identify_records: input ends in a record\n");
            free(y);
            return 1;
        }
        identify(&h, y);
        free(y);
    }
    return 0;
}
