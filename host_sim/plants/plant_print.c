#include "plants/plant_print.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/text.h"
#include "linear/linear_plant.h"

static const char *kind_name(enum plant_kind kind)
{
    switch (kind) {
    case PLANT_MV:
        return "manipulated";
    case PLANT_DISTURBANCE:
        return "disturbance";
    case PLANT_MEASUREMENT:
        return "measurement";
    default:
        return "internal";
    }
}

void plant_print_line(const struct plant_class *class, const char *error)
{
    if (class == NULL) {
        (void)printf("  cannot be read: %s\n", error);
        return;
    }
    size_t count[4] = {0};
    for (size_t i = 0; i < class->n_channels; i++) {
        count[class->channels[i].kind]++;
    }
    (void)printf("%s: %s (%zu manipulated, %zu disturbances, %zu measurements, tick %g s)\n",
                 class->name, class->title, count[PLANT_MV], count[PLANT_DISTURBANCE],
                 count[PLANT_MEASUREMENT], class->tick_s);
}

void plant_print_full(const struct plant_class *class)
{
    (void)printf("%s: %s\n  source: %s\n", class->name, class->title, class->source);
    if (class->ours != NULL) {
        (void)printf("  ours: %s\n", class->ours);
    }
    if (class->time_unit != NULL) {
        (void)printf("  time unit of the source: %s\n", class->time_unit);
    }
    (void)printf("  tick: %g s%s\n", class->tick_s, class->period_s > 0.0 ? ", no other" : "");
    for (size_t i = 0; i < class->n_channels; i++) {
        const struct plant_channel *c = &class->channels[i];
        char nominal[32] = "-"; /* what a nonlinear plant shows follows from its inputs: --steady */
        if (c->kind == PLANT_MV || c->kind == PLANT_DISTURBANCE || class->model != NULL) {
            (void)snprintf(nominal, sizeof(nominal), "%g", c->nominal);
        }
        (void)printf("  %-12s %-15s %-8s %10g to %-10g nominal %-10s %s", kind_name(c->kind),
                     c->name, c->unit, c->lo, c->hi, nominal, c->help != NULL ? c->help : "");
        if (c->every_s > 0.0 || c->delay_s > 0.0) {
            (void)printf("%sanalyser: ", c->help != NULL && c->help[0] != '\0' ? "; " : "");
            if (c->every_s > 0.0) {
                (void)printf("every %g s, ", c->every_s);
            }
            (void)printf("sampled %g s before", c->delay_s);
        }
        (void)putchar('\n');
    }
}

void plant_print_values(const struct plant_class *class, const struct plant *p)
{
    (void)printf("kind,name,unit,value\n");
    for (size_t i = 0; i < class->n_channels; i++) {
        const struct plant_channel *c = &class->channels[i];
        (void)printf("%s,%s,%s,%.12g\n", kind_name(c->kind), c->name, c->unit, class->value(p, i));
    }
}

static void sparse_matrix(const char *name, const double *x, size_t rows, size_t columns)
{
    for (size_t i = 0; i < rows; i++) {
        for (size_t j = 0; j < columns; j++) {
            if (x[i * columns + j] != 0.0) {
                (void)printf("%s,%zu,%zu,%.17g\n", name, i + 1, j + 1, x[i * columns + j]);
            }
        }
    }
}

static void json_matrix(const char *name, const double *x, size_t rows, size_t columns)
{
    (void)printf(",\n  \"%s\": [", name);
    for (size_t i = 0; i < rows; i++) {
        (void)printf("%s\n    [", i > 0 ? "," : "");
        for (size_t j = 0; j < columns; j++) {
            (void)printf("%s%.17g", j > 0 ? ", " : "", x[i * columns + j]);
        }
        (void)printf("]");
    }
    (void)printf("]");
}

static void json_vector(const char *name, const double *x, size_t n)
{
    (void)printf(",\n  \"%s\": [", name);
    for (size_t i = 0; i < n; i++) {
        (void)printf("%s%.17g", i > 0 ? ", " : "", x[i]);
    }
    (void)printf("]");
}

/* Lines as texts; they hold names and numbers only. */
static void json_notes(const char *lines)
{
    (void)printf(",\n  \"notes\": [");
    for (const char *from = lines; *from != '\0';) {
        size_t length = strcspn(from, "\n");
        (void)printf("%s\"%.*s\"", from == lines ? "" : ", ", (int)length, from);
        from += length + (from[length] == '\n' ? 1 : 0);
    }
    (void)printf("]");
}

static void json_names(const char *key, const struct plant_class *class, const size_t *channel,
                       size_t n)
{
    (void)printf(",\n  \"%s\": [", key);
    for (size_t i = 0; i < n; i++) {
        (void)printf("%s\"%s\"", i > 0 ? ", " : "", class->channels[channel[i]].name);
    }
    (void)printf("]");
}

static void print_names(const char *what, const struct plant_class *class, const size_t *channel,
                        size_t n)
{
    (void)printf("# %s:", what);
    for (size_t i = 0; i < n; i++) {
        const struct plant_channel *c = &class->channels[channel[i]];
        (void)printf(" %s[%s]", c->name, c->unit);
    }
    (void)printf("\n");
}

void plant_print_matrices(const struct plant_class *class, const struct linearised *l, bool json)
{
    static const char names[5][7] = {"A", "B", "C", "D", "dead_s"};
    const double *const matrix[5] = {l->a, l->b, l->c, l->d, l->dead_s};
    const size_t rows[5] = {l->n, l->n, l->p, l->p, l->p};
    const size_t columns[5] = {l->n, l->m, l->n, l->m, l->m};
    if (json) {
        (void)printf("{\n  \"plant\": \"%s\",\n  \"period_s\": %.17g", class->name, l->period_s);
        json_names("inputs", class, l->input, l->m);
        json_names("outputs", class, l->output, l->p);
        for (size_t k = 0; k < 5; k++) {
            json_matrix(names[k], matrix[k], rows[k], columns[k]);
        }
        if (l->x != NULL) {
            json_vector("x", l->x, l->n);
            json_vector("u", l->u, l->m);
            json_vector("y", l->y, l->p);
        }
        json_notes(l->notes);
        (void)printf("\n}\n");
        return;
    }
    (void)printf("# plant %s, %zu states (%s), %s; y(t) = C x(t) + D u(t - dead_s)\n", class->name,
                 l->n, l->state_unit,
                 l->period_s > 0.0 ? "x(k+1) = A x + B u per period" : "dx/dt = A x + B u, per s");
    print_names("inputs", class, l->input, l->m);
    print_names("outputs", class, l->output, l->p);
    for (const char *from = l->notes; *from != '\0';) {
        size_t length = strcspn(from, "\n");
        (void)printf("# %.*s\n", (int)length, from);
        from += length + (from[length] == '\n' ? 1 : 0);
    }
    (void)printf("# 1-based; what is not listed is zero\nmatrix,row,col,value\n");
    for (size_t k = 0; k < 5; k++) {
        sparse_matrix(names[k], matrix[k], rows[k], columns[k]);
    }
}

/* Responses of one plant: values[(tick * inputs + input) * outputs + output], deviations from the start. */
struct responses {
    const struct plant_class *class;
    size_t input[64], output[64], n_inputs, n_outputs, ticks;
    double tick_s, percent, *values;
};

static void choose_channels(struct responses *r)
{
    const struct plant_class *class = r->class;
    for (size_t i = 0; i < class->n_channels; i++) {
        enum plant_kind kind = class->channels[i].kind;
        if (kind == PLANT_MEASUREMENT && r->n_outputs < 64) {
            r->output[r->n_outputs++] = i;
        } else if ((kind == PLANT_MV || kind == PLANT_DISTURBANCE) && r->n_inputs < 64 &&
                   (class->model == NULL || i < class->model->n_inputs)) {
            r->input[r->n_inputs++] = i;
        }
    }
}

static double step_size(const struct responses *r, const struct plant *p, size_t channel)
{
    const struct plant_channel *c = &r->class->channels[channel];
    double size = 0.01 * r->percent * (c->hi - c->lo);
    return r->class->value(p, channel) + size <= c->hi ? size : -size;
}

static bool one_input(struct responses *r, struct plant *p, size_t j, char *err, size_t err_size)
{
    const struct plant_class *class = r->class;
    size_t channel = r->input[j];
    double start[64], size = step_size(r, p, channel);
    for (size_t i = 0; i < r->n_outputs; i++) {
        start[i] = class->value(p, r->output[i]);
    }
    double from = class->value(p, channel);
    if (!class->set_input(p, channel, from + size, err, err_size)) {
        char ignored[SIM_ERROR_SIZE]; /* what stands in err is about the way that was wanted */
        size = -size;
        if (!class->set_input(p, channel, from + size, ignored, sizeof(ignored))) {
            return false;
        }
        err[0] = '\0';
    }
    (void)printf("# step of %s: %+.6g %s from %.6g\n", class->channels[channel].name, size,
                 class->channels[channel].unit, from);
    for (size_t k = 0; k <= r->ticks; k++) {
        if (k > 0 && !class->advance(p, (double)k * r->tick_s, err, err_size)) {
            return false;
        }
        for (size_t i = 0; i < r->n_outputs; i++) {
            r->values[(k * r->n_inputs + j) * r->n_outputs + i] =
                class->value(p, r->output[i]) - start[i];
        }
    }
    return true;
}

static void print_responses(const struct responses *r)
{
    const struct plant_channel *c = r->class->channels;
    (void)printf("# deviations; y.u is the response of y to the step of u\nnumber,time[s]");
    for (size_t j = 0; j < r->n_inputs; j++) {
        for (size_t i = 0; i < r->n_outputs; i++) {
            (void)printf(",%s.%s[%s]", c[r->output[i]].name, c[r->input[j]].name,
                         c[r->output[i]].unit);
        }
    }
    size_t width = r->n_inputs * r->n_outputs;
    for (size_t k = 0; k <= r->ticks; k++) {
        (void)printf("\n%zu,%.9g", k, (double)k * r->tick_s);
        for (size_t i = 0; i < width; i++) {
            (void)printf(",%.12g", r->values[k * width + i]);
        }
    }
    (void)printf("\n");
}

bool plant_print_steps(const struct plant_class *class,
                       struct plant *(*begin)(char *err, size_t err_size), double tick_s,
                       size_t ticks, double percent, char *err, size_t err_size)
{
    struct responses r = {.class = class, .tick_s = tick_s, .ticks = ticks, .percent = percent};
    choose_channels(&r);
    r.values = calloc((ticks + 1) * r.n_inputs * r.n_outputs + 1, sizeof(double));
    bool good = r.values != NULL || sim_fail(err, err_size, "%s: out of memory", class->name);
    for (size_t j = 0; j < r.n_inputs && good; j++) {
        struct plant *p = begin(err, err_size);
        good = p != NULL && one_input(&r, p, j, err, err_size);
        if (p != NULL) {
            class->destroy(p);
        }
    }
    if (good) {
        print_responses(&r);
    }
    free(r.values);
    return good;
}
