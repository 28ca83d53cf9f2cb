/* Linear plants from files against tables worked out apart from them (tests/reference/linear_reference.py). */
#include "linear/dense.h"
#include "linear/linear_plant.h"
#include "plants/plant_json.h"
#include "plants/plant_library.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char err[1024];

void setUp(void) {}

void tearDown(void)
{
    plant_library_free();
}

static size_t channel(const struct plant_class *class, const char *name)
{
    for (size_t i = 0; i < class->n_channels; i++)
        if (strcmp(class->channels[i].name, name) == 0)
            return i;
    TEST_FAIL_MESSAGE(name);
    return 0;
}

static const struct plant_class *open_plant(const char *name)
{
    const struct plant_class *class = plant_open(name, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(class, err);
    return class;
}

static struct plant *create(const struct plant_class *class)
{
    struct plant *p = plant_create(class, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(p, err);
    return p;
}

static void set(const struct plant_class *class, struct plant *p, size_t i, double value)
{
    TEST_ASSERT_TRUE_MESSAGE(class->set_input(p, i, value, err, sizeof err), err);
}

static void run_to(const struct plant_class *class, struct plant *p, double t)
{
    TEST_ASSERT_TRUE_MESSAGE(class->advance(p, t, err, sizeof err), err);
}

/* Next row of a table with three names and, after them, numbers. */
static int named_row(FILE *f, char name[3][48], double *x, int n)
{
    char line[512];
    while (fgets(line, sizeof line, f)) {
        if (line[0] == '#' || strncmp(line, "plant,", 6) == 0)
            continue;
        int at = 0;
        TEST_ASSERT_EQUAL_INT_MESSAGE(
            3, sscanf(line, "%47[^,],%47[^,],%47[^,],%n", name[0], name[1], name[2], &at), line);
        char *from = line + at;
        for (int i = 0; i < n; i++) {
            char *end;
            x[i] = strtod(from, &end);
            TEST_ASSERT_TRUE_MESSAGE(end != from, line);
            from = end + 1;
        }
        return 1;
    }
    return 0;
}

static FILE *open_table(const char *path)
{
    FILE *f = fopen(path, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(f, path);
    return f;
}

/* Sizes of step that every input allows from its nominal value; linear plants scale exactly. */
static double step_of(const struct plant_channel *c)
{
    double size = 0.05 * (c->hi - c->lo);
    return c->nominal + size <= c->hi ? size : -size;
}

static void the_matrix_exponential_agrees_with_scipy(void)
{
    FILE *f = open_table("reference/linear_exp.csv");
    char line[8192];
    int rows = 0;
    while (fgets(line, sizeof line, f)) {
        if (line[0] == '#' || line[0] == 'n')
            continue;
        double a[36], e[36], want, largest = 0.0;
        char *at;
        size_t n = (size_t)strtod(line, &at);
        for (size_t i = 0; i < n * n; i++)
            a[i] = strtod(at + 1, &at);
        TEST_ASSERT_TRUE(dense_exp(n, a, e));
        for (size_t i = 0; i < n * n; i++) {
            want = strtod(at + 1, &at);
            largest = fmax(largest, fabs(want));
            TEST_ASSERT_DOUBLE_WITHIN(1e-12 * largest + 1e-11 * fabs(want), want, e[i]);
        }
        rows++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL_INT(6, rows);
}

static void settling_gives_the_steady_state_gains(void)
{
    char name[3][48];
    double gain;
    int rows = 0;
    FILE *f = open_table("reference/linear_gains.csv");
    while (named_row(f, name, &gain, 1)) {
        const struct plant_class *class = open_plant(name[0]);
        struct plant *p = create(class);
        size_t u = channel(class, name[2]), y = channel(class, name[1]);
        double h = step_of(&class->channels[u]), before = class->value(p, y);
        TEST_ASSERT_EQUAL_DOUBLE(class->channels[y].nominal, before);
        set(class, p, u, class->channels[u].nominal + h);
        TEST_ASSERT_TRUE_MESSAGE(class->settle(p, err, sizeof err), err);
        double found = (class->value(p, y) - before) / h;
        double rounding = 1e-15 * fabs(before) / fabs(h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 * fabs(gain) + 1e-14 + 4.0 * rounding, gain, found);
        class->destroy(p);
        rows++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL_INT(142, rows);
}

/* Every row of the step table: there in one stride, and once more in ticks that cut across it. */
static void step_responses_agree(size_t strides)
{
    char name[3][48];
    double x[2];
    int rows = 0;
    FILE *f = open_table("reference/linear_steps.csv");
    while (named_row(f, name, x, 2)) {
        const struct plant_class *class = open_plant(name[0]);
        size_t parts = class->period_s > 0.0 ? 1 : strides;
        struct plant *p = create(class);
        size_t u = channel(class, name[2]), y = channel(class, name[1]);
        double h = step_of(&class->channels[u]), before = class->value(p, y);
        set(class, p, u, class->channels[u].nominal + h);
        for (size_t k = 1; k <= parts; k++)
            run_to(class, p, x[0] * (double)k / (double)parts);
        double found = (class->value(p, y) - before) / h;
        double rounding = 1e-15 * fabs(before) / fabs(h);
        char message[200];
        snprintf(message, sizeof message, "%s %s to %s at %g s", name[0], name[1], name[2], x[0]);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-8 * fabs(x[1]) + 1e-10 + 4.0 * rounding, x[1], found,
                                          message);
        class->destroy(p);
        rows++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL_INT(750, rows);
}

static void step_responses_agree_in_one_stride(void)
{
    step_responses_agree(1);
}

static void step_responses_agree_in_many_strides(void)
{
    step_responses_agree(7);
}

/* A file made here, so that what is tested stands next to the test. */
static struct plant_class *parse(const char *elements, const char *more)
{
    char text[2000];
    snprintf(text, sizeof text,
             "{\"name\": \"t\", \"title\": \"t\", \"source\": \"t\", \"tick_s\": 1, "
             "\"inputs\": [{\"name\": \"u\", \"lo\": -10, \"hi\": 10, \"nominal\": 0}], "
             "\"outputs\": [{\"name\": \"y\", \"lo\": -10, \"hi\": 10, \"nominal\": 1}], "
             "%s \"model\": \"transfer\", \"elements\": %s}",
             more, elements);
    struct plant_class *class = plant_json_read("t.json", text, strlen(text), err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(class, err);
    return class;
}

static void a_dead_time_is_exact_whatever_the_tick(void)
{
    /* A pure dead time shows every change when it is due and not before. */
    struct plant_class *class = parse("[[{\"gain\": 2, \"dead_time\": 2.7182818}]]", "");
    struct plant *p = create(class);
    set(class, p, 0, 1.0);
    run_to(class, p, 1.0);
    set(class, p, 0, 3.0);
    run_to(class, p, 2.7182817);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, class->value(p, 1));
    run_to(class, p, 2.7182818);
    TEST_ASSERT_EQUAL_DOUBLE(3.0, class->value(p, 1));
    run_to(class, p, 3.7182817);
    TEST_ASSERT_EQUAL_DOUBLE(3.0, class->value(p, 1));
    run_to(class, p, 3.7182818);
    TEST_ASSERT_EQUAL_DOUBLE(7.0, class->value(p, 1));
    class->destroy(p);
    plant_json_free(class);
}

static void inputs_that_change_often_superpose(void)
{
    /* 0.3 s ticks against a dead time of 2.71 s: nine changes are on their way at any time. */
    struct plant_class *class =
        parse("[[{\"gain\": 2, \"lags\": [3, 1], \"zero\": -1.5, \"dead_time\": 2.71}]]", "");
    struct plant *p = create(class);
    double u[200], t = 0.0, tick = 0.3;
    for (int k = 0; k < 200; k++) {
        u[k] = (double)((k * 37) % 11) - 5.0;
        set(class, p, 0, u[k]);
        t = tick * (k + 1);
        run_to(class, p, t);
    }
    double want = 1.0;
    for (int k = 0; k < 200; k++) {
        double s = t - tick * k - 2.71, du = u[k] - (k > 0 ? u[k - 1] : 0.0);
        /* residues of 2 (1 - 1.5 s) / ((3 s + 1)(s + 1) s) */
        want += s > 0.0 ? du * 2.0 * (1.0 - 2.25 * exp(-s / 3.0) + 1.25 * exp(-s)) : 0.0;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, want, class->value(p, 1));
    class->destroy(p);
    plant_json_free(class);
}

static void integrators_ramp_and_have_no_steady_state_when_driven(void)
{
    struct plant_class *class =
        parse("[[{\"gain\": 0.5, \"lags\": 2, \"integrator\": true, \"dead_time\": 1}]]",
              "\"time_unit\": \"min\",");
    struct plant *p = create(class);
    TEST_ASSERT_TRUE(class->settle(p, err, sizeof err));
    set(class, p, 0, 2.0);
    run_to(class, p, 660.0); /* 10 min after the dead time */
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, 1.0 + 0.5 * 2.0 * (10.0 - 2.0 * (1.0 - exp(-5.0))),
                              class->value(p, 1));
    TEST_ASSERT_FALSE(class->settle(p, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING(
        "t: no steady state: y integrates, and an input of it is not at its nominal value", err);
    class->destroy(p);
    plant_json_free(class);

    const struct plant_class *boiler = open_plant("boiler-9002");
    p = create(boiler);
    TEST_ASSERT_TRUE(boiler->settle(p, err, sizeof err));
    set(boiler, p, 0, 0.5);
    TEST_ASSERT_FALSE(boiler->settle(p, err, sizeof err));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err, "no steady state"), err);
    boiler->destroy(p);
}

static void a_regime_keeps_what_is_under_way(void)
{
    const struct plant_class *class = open_plant("siddha-regimes");
    struct plant *p = create(class);
    size_t d = channel(class, "d"), regime = channel(class, "regime"), y = channel(class, "y");
    set(class, p, d, 1.0);
    run_to(class, p, 1.0);
    double want = 2.0 * (1.0 - exp(-0.6 / 0.25)); /* case III c: dead time 0.4, lag 0.25 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, want, class->value(p, y));
    set(class, p, regime, 9.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, want, class->value(p, y));
    run_to(class, p, 1.5);
    want = 2.0 + (want - 2.0) * exp(-0.5 / 0.5); /* case II a: lag 0.5, the step is through */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, want, class->value(p, y));
    set(class, p, d, 0.0);
    run_to(class, p, 2.3); /* its dead time, 0.8 */
    want = 2.0 + (want - 2.0) * exp(-0.8 / 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, want, class->value(p, y));
    TEST_ASSERT_FALSE(class->set_input(p, regime, 2.5, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("siddha-regimes: regime = 2.5 must be a whole number, 1 to 9", err);
    TEST_ASSERT_FALSE(class->set_input(p, regime, 10.0, err, sizeof err));
    class->destroy(p);
}

static void folamis_system_is_his_difference_equation(void)
{
    const struct plant_class *class = open_plant("folami-linear");
    struct plant *p = create(class);
    double y = 0.0, u = 0.0, d = 0.0;
    for (int k = 1; k <= 60; k++) {
        run_to(class, p, 30.0 * k);
        d = k % 20 < 10 ? 1.5 : -1.5;
        set(class, p, 1, d);
        y = 0.9 * y + u + d;
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, y, class->value(p, 2));
        u = sin(0.3 * k);
        set(class, p, 0, u);
    }
    class->destroy(p);
}

static void a_discrete_plant_takes_no_other_step(void)
{
    const struct plant_class *class = open_plant("kotyk-column");
    struct plant *p = create(class);
    TEST_ASSERT_FALSE(class->advance(p, 100.0, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING(
        "kotyk-column: a discrete plant of period 120 s cannot advance by 100 s; "
        "the tick must be a multiple of the period",
        err);
    run_to(class, p, 240.0);
    class->destroy(p);
}

static void wrong_calls_are_refused_with_one_line(void)
{
    const struct plant_class *class = open_plant("wood-berry");
    struct plant *p = create(class);
    TEST_ASSERT_FALSE(class->set_input(p, 0, 4.1, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("wood-berry: R = 4.1 lb/min is outside 0 to 4", err);
    TEST_ASSERT_FALSE(class->set_input(p, 0, (double)NAN, err, sizeof err));
    TEST_ASSERT_FALSE(class->set_input(p, 2, 1.0, err, sizeof err));
    run_to(class, p, 60.0);
    TEST_ASSERT_FALSE(class->advance(p, 59.0, err, sizeof err));
    TEST_ASSERT_FALSE(class->advance(p, (double)NAN, err, sizeof err));
    class->destroy(p);
}

/* Inputs that are moved: a column's manipulated variables, for its feed's fractions may not take all values at once. */
static size_t moved_inputs(const struct plant_class *class)
{
    size_t n = 0;
    if (class->model != NULL)
        return class->model->n_inputs;
    while (class->channels[n].kind == PLANT_MV)
        n++;
    return n;
}

static unsigned long long hash_of_run(const struct plant_class *class)
{
    struct plant *p = create(class);
    unsigned long long hash = 1469598103934665603ull;
    for (int k = 1; k <= 300; k++) {
        for (size_t i = 0; i < moved_inputs(class); i++) {
            const struct plant_channel *c = &class->channels[i];
            double part = (double)((k * (int)(i + 3) * 29) % 101) / 100.0;
            if ((k + (int)i) % 3 == 0)
                set(class, p, i, fmin(c->lo + part * (c->hi - c->lo), c->hi));
        }
        run_to(class, p, class->tick_s * k);
        for (size_t i = 0; i < class->n_channels; i++) {
            double v = class->value(p, i);
            unsigned char bytes[sizeof v];
            TEST_ASSERT_TRUE(isfinite(v));
            memcpy(bytes, &v, sizeof v);
            for (size_t b = 0; b < sizeof v; b++)
                hash = (hash ^ bytes[b]) * 1099511628211ull;
        }
    }
    class->destroy(p);
    return hash;
}

static void the_same_calls_give_the_same_bits(void)
{
    for (const struct plant_text *t = plant_texts; t->name != NULL; t++) {
        const struct plant_class *class = open_plant(t->name);
        TEST_ASSERT_EQUAL_STRING(t->name, class->name);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(hash_of_run(class), hash_of_run(class), t->name);
    }
}

/* Files spoilt at random: refused with one line or read, never a crash (run with sanitizers). */
static void spoilt_files_are_refused_or_read(void)
{
    unsigned seed = 1;
    int refused = 0, read = 0;
    for (const struct plant_text *t = plant_texts; t->name != NULL; t++) {
        char *text = malloc(t->length);
        TEST_ASSERT_NOT_NULL(text);
        for (int round = 0; round < 200; round++) {
            memcpy(text, t->text, t->length);
            for (int k = 0; k < 1 + round % 3; k++) {
                seed = seed * 1664525u + 1013904223u;
                text[(seed >> 8) % t->length] = "0159-.eE[]{}\",:xn \n"[(seed >> 3) % 19];
            }
            err[0] = '\0';
            struct plant_class *class = plant_json_read("f", text, t->length, err, sizeof err);
            refused += class == NULL;
            read += class != NULL;
            TEST_ASSERT_TRUE(class != NULL || (err[0] == 'f' && strchr(err, '\n') == NULL));
            if (class != NULL) {
                err[0] = '\0';
                struct plant *p = plant_create(class, err, sizeof err);
                TEST_ASSERT_TRUE(p != NULL || (class->column != NULL && err[0] != '\0'));
                if (p != NULL) {
                    (void)class->advance(p, class->tick_s, err, sizeof err);
                    class->destroy(p);
                }
            }
            plant_json_free(class);
        }
        free(text);
    }
    TEST_ASSERT_GREATER_THAN(100, refused);
    TEST_ASSERT_GREATER_THAN(100, read);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_matrix_exponential_agrees_with_scipy);
    RUN_TEST(settling_gives_the_steady_state_gains);
    RUN_TEST(step_responses_agree_in_one_stride);
    RUN_TEST(step_responses_agree_in_many_strides);
    RUN_TEST(a_dead_time_is_exact_whatever_the_tick);
    RUN_TEST(inputs_that_change_often_superpose);
    RUN_TEST(integrators_ramp_and_have_no_steady_state_when_driven);
    RUN_TEST(a_regime_keeps_what_is_under_way);
    RUN_TEST(folamis_system_is_his_difference_equation);
    RUN_TEST(a_discrete_plant_takes_no_other_step);
    RUN_TEST(wrong_calls_are_refused_with_one_line);
    RUN_TEST(the_same_calls_give_the_same_bits);
    RUN_TEST(spoilt_files_are_refused_or_read);
    return UNITY_END();
}
