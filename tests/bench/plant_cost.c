/* Cost of simulated columns in processor time. Numbers to look at, never pass or fail; one fact a line, for
 * tools/bench.
 *
 * plant_cost [PLANT]     plant time per wall time with ticks of 30, 10 and 1 s: inputs that stand still, that move by up
 *                        to 1 % of their nominal value every tick, that jump all over their range. pilot when none is named
 * plant_cost --sizes     microseconds per integration step for columns of 10 to 160 stages and of 2 to 10 components: with
 *                        holdups that follow composition, with all holdups moving, with activity coefficients
 * plant_cost --day MIN   a day of the splitter in 30 s ticks, inputs changing every MIN minutes as in splitter_scipy.py:
 *                        its inputs and what comes of them */
#include "columns/column_solver.h"
#include "model/activity.h"
#include "plants/plant_library.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static char err[256];

static double now_us(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e6 + (double)t.tv_nsec * 1e-3;
}

static double uniform(unsigned *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) / 16777216.0;
}

static bool said(void)
{
    fprintf(stderr, "%s\n", err);
    return false;
}

enum mode { STEADY, MOVING, JUMPING };

/* Both manipulated variables of a column: its first two channels. */
static bool drive(const struct plant_class *c, struct plant *p, enum mode mode, unsigned *seed)
{
    for (size_t i = 0; i < 2 && mode != STEADY; i++) {
        const struct plant_channel *mv = &c->channels[i];
        double u = mode == MOVING ? mv->nominal * (0.99 + 0.02 * uniform(seed))
                                  : mv->lo + (mv->hi - mv->lo) * uniform(seed);
        if (!c->set_input(p, i, u, err, sizeof err))
            return said();
    }
    return true;
}

static bool speed(const char *name)
{
    static const char *const title[] = {"steady", "moving", "jumping"};
    static const double tick[] = {30, 10, 1};
    const struct plant_class *c = plant_open(name, err, sizeof err);

    if (!c)
        return said();
    for (int mode = STEADY; mode <= JUMPING; mode++)
        for (int i = 0; i < 3; i++) {
            struct plant *p = plant_create(c, err, sizeof err);
            unsigned seed = 1;
            int ticks = 2000;
            double start = now_us();
            if (!p)
                return said();
            for (int k = 1; k <= ticks; k++)
                if (!drive(c, p, (enum mode)mode, &seed))
                    return false;
                else if (!c->advance(p, tick[i] * k, err, sizeof err))
                    return said();
            double us = (now_us() - start) / ticks;
            printf("%s %s tick_s %g us_per_tick %.2f times_real_time %.0f\n", name, title[mode],
                   tick[i], us, tick[i] * 1e6 / us);
            c->destroy(p);
        }
    return true;
}

enum sort { CONSERVATIVE, MOVING_HOLDUPS, ACTIVITY, SORTS };
static const char *const sort_name[SORTS] = {"conservative", "moving-holdups", "activity"};

/* A column of made-up homologues of trichloroethylene, each with a boiling point some 8 K above the last. */
static bool size_cost(size_t stages, size_t components, enum sort sort)
{
    static const real_t none[100];
    real_t a[100];
    struct component made[10];
    for (size_t j = 0; j < components; j++)
        made[j] = (struct component){.name = "made up",
                                     .antoine = {21.354957, 3177.86676, -36.672 - 8.0 * (double)j},
                                     .molar_mass = 0.13,
                                     .density = {1990.0, -1.79},
                                     .vaporisation_heat = 31400.0,
                                     .boiling_point = 360.0,
                                     .critical_temperature = 571.0,
                                     .heat_capacity = 124.0};
    struct column_config config = {.stages = stages,
                                   .components = components,
                                   .feed_stage = stages / 2,
                                   .component = made,
                                   .efficiency = 0.8,
                                   .pressure_drop = 100.0 * (double)stages,
                                   .holdup = COLUMN_HOLDUP_CONSERVATIVE,
                                   .holdup_reboiler = 1e-3,
                                   .holdup_tray = 3e-5,
                                   .holdup_condenser = 2e-4,
                                   .holdup_temperature_bottom = 380.0,
                                   .holdup_temperature_top = 360.0,
                                   .temperature_min = 280.0,
                                   .temperature_max = 540.0,
                                   .limit_softness = 0.02};
    struct activity activity = {
        .model = ACTIVITY_WILSON, .components = components, .a = a, .b = none};
    for (size_t i = 0; i < components * components; i++)
        a[i] = i % (components + 1) == 0 ? 0.0 : -0.2;
    if (sort == ACTIVITY) {
        config.activity = activity_coefficients;
        config.activity_context = &activity;
    }
    if (sort == MOVING_HOLDUPS) {
        config.holdup = COLUMN_HOLDUP_MOLAR;
        config.holdup_reboiler = 10.0;
        config.holdup_tray = 0.3;
        config.holdup_condenser = 2.0;
        config.hydraulic_time = 4.0;
        config.levels = COLUMN_LEVELS_HOLDUPS;
        config.condenser_level = config.reboiler_level =
            (struct column_level){.by = COLUMN_LEVEL_BY_PRODUCT, .gain = 0.05};
        config.level_capacity = 2.0;
    }
    struct column_inputs in = {.feed_flow = 0.015,
                               .feed_temperature = 335.0,
                               .reflux_flow = 0.013,
                               .reflux_subcooling = 5.0,
                               .heat = 750.0,
                               .pressure_top = 1e5};
    unsigned seed = 1;
    for (size_t j = 0; j < components; j++)
        in.feed_fraction[j] = 1.0 / (double)components;
    struct column_solver *s = column_solver_create(&config, &in, NULL, err, sizeof err);
    if (!s || !column_solver_settle(s, err, sizeof err))
        return said();

    struct column_solver_work before = column_solver_work(s);
    double start = now_us();
    int ticks = 400;
    for (int k = 1; k <= ticks; k++) {
        in.heat = 750.0 * (0.99 + 0.02 * uniform(&seed));
        in.reflux_flow = 0.013 * (0.99 + 0.02 * uniform(&seed));
        if (!column_solver_set_inputs(s, &in, err, sizeof err) ||
            !column_solver_advance(s, 30.0 * k, err, sizeof err))
            return said();
    }
    double us = now_us() - start;
    double steps = (double)(column_solver_work(s).steps - before.steps);
    printf(
        "%s stages %zu components %zu us_per_step %.2f steps_per_tick %.2f times_real_time %.0f\n",
        sort_name[sort], stages, components, us / steps, steps / ticks, 30e6 * ticks / us);
    column_solver_destroy(s);
    return true;
}

static bool sizes(void)
{
    static const size_t stages[] = {10, 20, 40, 80, 160}, components[] = {2, 3, 5, 10};
    for (int sort = 0; sort < SORTS; sort++) {
        for (size_t i = 0; i < 5; i++)
            if (!size_cost(stages[i], 3, (enum sort)sort))
                return false;
        for (size_t i = 0; i < 4; i++)
            if (!size_cost(40, components[i], (enum sort)sort))
                return false;
        if (!size_cost(100, 3, (enum sort)sort))
            return false;
    }
    return true;
}

/* Frau's first scenario from the first hour on, its sines sampled at every change. */
static bool day(double minutes)
{
    static const char *const name[] = {"F", "TF", "zC2", "zC3", "ziC4", "znC4"};
    static const double nominal[] = {88.2, 320, 0.0036, 0.281, 0.236, 0.4746};
    static const double step[] = {6.8, -3, -0.0016, -0.011, -0.0128, 0.0254};
    static const double swing[] = {10, 10, 0, 0.02, 0.02, -0.04};
    const struct plant_class *c = plant_open("splitter", err, sizeof err);
    struct plant *p = c ? plant_create(c, err, sizeof err) : NULL;
    size_t every = (size_t)fmax(1.0, round(minutes * 2.0)), ticks = 24 * 120;
    double spent = 0.0;

    if (!p)
        return said();
    for (size_t k = 0; k < ticks; k++) {
        double hours = (double)k / 120.0, u[6], start;
        bool change = k % every == 0;
        for (size_t i = 0; i < 6; i++)
            u[i] = nominal[i] + (hours >= 1.0 ? step[i] + swing[i] * sin(6.0 * M_PI * hours) : 0.0);
        start = now_us();
        for (size_t i = 0; i < 6 && change; i++)
            for (size_t j = 0; j < c->n_channels; j++)
                if (strcmp(c->channels[j].name, name[i]) == 0 &&
                    !c->set_input(p, j, u[i], err, sizeof err))
                    return said();
        if (!c->advance(p, 30.0 * ((double)k + 1.0), err, sizeof err))
            return said();
        spent += now_us() - start;
        if (change) {
            printf("inputs %.17g", 30.0 * (double)k);
            for (size_t i = 0; i < 6; i++)
                printf(" %.17g", u[i]);
            putchar('\n');
        }
        if ((k + 1) % every == 0) {
            printf("temperatures %.17g", 30.0 * ((double)k + 1.0));
            for (size_t j = 0; j < c->n_channels; j++)
                if (strcmp(c->channels[j].unit, "K") == 0 && c->channels[j].name[0] == 'T' &&
                    isdigit((unsigned char)c->channels[j].name[1]) &&
                    c->channels[j].kind != PLANT_DISTURBANCE)
                    printf(" %s %.17g", c->channels[j].name + 1, c->value(p, j));
            putchar('\n');
        }
    }
    printf("seconds %.6f\n", spent * 1e-6);
    c->destroy(p);
    return true;
}

int main(int argc, char **argv)
{
    const char *what = argc > 1 ? argv[1] : "pilot";
    bool good = strcmp(what, "--sizes") == 0 ? sizes()
                : strcmp(what, "--day") == 0 ? day(argc > 2 ? atof(argv[2]) : 15.0)
                                             : speed(what);
    plant_library_free();
    return good ? 0 : 1;
}
