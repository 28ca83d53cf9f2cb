/* Prints closed loops of the firmware's own PID on simulated first-order-plus-dead-time plants, as CSV, for
 * the figures of docs/methods/pid.md and docs/methods/feedforward.md (tools/figures/pid_figures.py).
 *
 *     pid_trace NAME            one table: t,sp and for every curve y_LABEL,u_LABEL
 *     pid_trace --list          the names
 */
#include <stdio.h>
#include <string.h>

#include "block/feedforward.h"
#include "fopdt_plant.h"
#include "kinds/pid/pid.h"

#define CURVES_MAX 3

struct curve {
    const char *label;
    struct pid_config config;
    float feedforward_gain;
    int windup; /* the controller is not told what took effect */
};

struct scene {
    const char *name;
    int seconds, step_at, step_back_at, load_at;
    double step, load, u_lo, u_hi;
    struct curve curves[CURVES_MAX];
};

/* Plant of every scene: gain 1, dead time 20 s, time constant 60 s, at rest at u 0.4, y 0.5. */
#define PI(K, TI) .gain = (K), .ti_s = (TI), .n = 8.0f, .b = 1.0f, .out_lo = 0.0f, .out_hi = 1.0f

static const struct scene scenes[] = {
    {"response",
     900,
     20,
     0,
     450,
     0.1,
     0.1,
     0.0,
     1.0,
     {{"Cohen-Coon PI", {PI(2.78333f, 39.5652f)}, 0.0f, 0},
      {"SIMC PI", {PI(1.5f, 60.0f)}, 0.0f, 0},
      {"SIMC PI b 0.5",
       {.gain = 1.5f, .ti_s = 60.0f, .n = 8.0f, .b = 0.5f, .out_hi = 1.0f},
       0.0f,
       0}}},
    {"inhibitor",
     400,
     20,
     0,
     0,
     0.1,
     0.0,
     0.0,
     1.0,
     {{"without", {PI(1.5f, 40.0f)}, 0.0f, 0},
      {"with", {PI(1.5f, 40.0f), .inhibit_s = 30.0f}, 0.0f, 0}}},
    {"windup",
     900,
     20,
     450,
     0,
     0.2,
     0.0,
     0.0,
     0.55,
     {{"not told", {PI(1.5f, 60.0f)}, 0.0f, 1}, {"told", {PI(1.5f, 60.0f)}, 0.0f, 0}}},
    {"feedforward",
     900,
     0,
     0,
     50,
     0.0,
     0.1,
     0.0,
     1.0,
     {{"PI alone", {PI(1.5f, 60.0f)}, 0.0f, 0}, {"with feedforward", {PI(1.5f, 60.0f)}, -0.5f, 0}}},
};

struct loop {
    struct pid pid;
    struct feedforward ff;
    struct fopdt_plant plant, disturbance;
    num_t ring[64];
};

static struct loop loops[CURVES_MAX];

/* The disturbance of "feedforward" reaches y by gain 0.5, dead time 30 s, time constant 80 s; everywhere
 * else the load adds to the plant's input. */
static int start(struct loop *l, const struct curve *c)
{
    struct feedforward_settings ff = feedforward_default_config();
    ff.gain = c->feedforward_gain;
    ff.lead_s = 60.0f;
    ff.lag_s = 80.0f;
    ff.dead_time_s = 10.0f;
    if (pid_init(&l->pid, &c->config, 1.0f) ||
        feedforward_init(&l->ff, &ff, 1.0f, l->ring, sizeof l->ring))
        return -1;
    fopdt_plant_init(&l->plant, 1.0, 60.0, 20, 1.0, 0.4, 0.5);
    fopdt_plant_init(&l->disturbance, 0.5, 80.0, 30, 1.0, 0.0, 0.0);
    pid_follow(&l->pid, num_from_float(0.5f), num_from_float(0.5f), num_from_float(0.4f));
    return 0;
}

static void run(const struct scene *s, int curves)
{
    int measured_load = strcmp(s->name, "feedforward") == 0;
    for (int t = 0; t < s->seconds; t++) {
        int stepped = s->step_at && t >= s->step_at && !(s->step_back_at && t >= s->step_back_at);
        float sp = 0.5f + (stepped ? (float)s->step : 0.0f);
        double load = s->load_at && t >= s->load_at ? s->load : 0.0;
        printf("%d,%.4f", t, (double)sp);
        for (int i = 0; i < curves; i++) {
            struct loop *l = &loops[i];
            double y = l->plant.y + l->disturbance.y;
            num_t v = pid_step(&l->pid, num_from_float(sp), num_from_float((float)y));
            num_t ff = feedforward_step(&l->ff, num_from_float(measured_load ? (float)load : 0.0f));
            num_t u = num_clamp(num_add(v, ff), num_from_float((float)s->u_lo),
                                num_from_float((float)s->u_hi));
            pid_back_calculate(&l->pid, s->curves[i].windup ? v : num_sub(u, ff), INTEGRAL_FREE);
            double applied = (double)num_to_float(u);
            printf(",%.6f,%.6f", y, applied);
            fopdt_plant_step(&l->plant, applied + (measured_load ? 0.0 : load));
            fopdt_plant_step(&l->disturbance, measured_load ? load : 0.0);
        }
        printf("\n");
    }
}

int main(int argc, char **argv)
{
    size_t n = sizeof scenes / sizeof scenes[0];
    if (argc == 2 && strcmp(argv[1], "--list") == 0) {
        for (size_t i = 0; i < n; i++)
            printf("%s\n", scenes[i].name);
        return 0;
    }
    for (size_t i = 0; argc == 2 && i < n; i++) {
        if (strcmp(argv[1], scenes[i].name) != 0)
            continue;
        int curves = 0;
        printf("t,sp");
        for (; curves < CURVES_MAX && scenes[i].curves[curves].label; curves++) {
            const struct curve *c = &scenes[i].curves[curves];
            printf(",y %s,u %s", c->label, c->label);
            if (start(&loops[curves], c))
                return 1;
        }
        printf("\n");
        run(&scenes[i], curves);
        return 0;
    }
    fprintf(stderr, "usage: pid_trace NAME | --list\n");
    return 2;
}
