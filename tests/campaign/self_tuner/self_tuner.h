/* Weeks of a self-tuner on plants that it does not know, beside a PI on the same plant with the same noise: what the parts of the
 * program share. Everything in fractions of span; time in seconds. */
#ifndef REFLUX_CAMPAIGN_SELF_TUNER_H
#define REFLUX_CAMPAIGN_SELF_TUNER_H

#include <stdbool.h>
#include <stdint.h>

#include "gmv_block_bench.h"
#include "random_source.h"

#define REST      0.5 /* where PVs and MVs stand at first */
#define STATES    4
#define DEAD_MOST 4096 /* s, of a dead time */

/* gain (1 - zero s) exp(-dead s)/((t1 s + 1)(t2 s + 1)(s^2/w^2 + 2 damping s/w + 1)); t2, zero, 1/w may be 0. */
struct element_spec {
    double gain, t1, t2, zero, dead, resonance_s, damping;
};

struct element {
    unsigned dead; /* s */
    double gain;
    double a[STATES][STATES], b[STATES], c[STATES], x[STATES]; /* steps of a second */
    double late[DEAD_MOST];
    unsigned newest;
};

struct plant_spec {
    unsigned loops;
    struct element_spec element[GMV_LOOPS][GMV_LOOPS];
    double noise[GMV_LOOPS];
    double stuck;                   /* dead band of each valve */
    double late_from_s, late_s;     /* all dead times are late_s from then on; 0: never */
    double gain_from_s, gain_times; /* all gains are so many times theirs from then on */
};

/* When setpoints and loads move. */
enum schedule { WEEK, WEEK_LOADS, WEEK_REST, SCHEDULES };

struct tuner_case {
    char name[128];
    struct plant_spec plant;
    double step_s;
    enum schedule schedule;
    double move_s, size; /* setpoint moves at first: every so often, so far */
    float pi_gain[GMV_LOOPS], pi_ti_s[GMV_LOOPS];
    unsigned delay[GMV_LOOPS][GMV_LOOPS];
    bool positional;
    uint64_t seed;
};

/* ---- plants.c ---- */

struct linear_plant {
    struct element element[GMV_LOOPS][GMV_LOOPS];
    double valve[GMV_LOOPS];
    const struct plant_spec *spec;
    double time_s;
};
void plant_begin(struct linear_plant *p, const struct plant_spec *spec);
/* A second with these MVs and loads. */
void plant_second(struct linear_plant *p, const double *u, const double *load);
double plant_pv(const struct linear_plant *p, unsigned i);

double random_uniform(struct random_source *r, double lo, double hi);
double random_normal(struct random_source *r);

/* ---- sets.c ---- */

/* Times from which `delay` is chosen: the dead time and the time constant of the right-half-plane zero, with half the second lag or without
 * it; or the dead time alone. */
enum delay_rule { DELAY_ALL, DELAY_ZERO, DELAY_DEAD };
/* The n-th case of a set, "-rest" after its name: without moves between the first day and the last hours; false past its end. */
bool case_of(const char *set, unsigned n, uint64_t seed, enum delay_rule rule,
             struct tuner_case *c);

/* ---- run.c ---- */

#define WINDOW 64u /* steps */

struct tuner_result {
    double ratio, measured_ratio;   /* IAE to the PI's, the week: of PVs, of measurements */
    double first_ratio, last_ratio; /* last quarters of the first day and of the last one */
    double worst_ratio;             /* of a day */
    double adopted_s, ended_s,
        found_s;   /* first; given up for good; from the first window beyond to the first alarm */
    double lawful; /* share of the week in which the law acts */
    /* of the first loop: after the first day, before the last quarter of one */
    double g0_begun, g0_rest;
    unsigned adoptions, returns, beyond_most, beyond_moves_most; /* windows one after the other */
    unsigned by[8]; /* returns by alarm, in the order of enum gmv_alarm */
};
/* set: settings by name, "quiet=1 nb=3". False: the block refuses them. */
bool run_case(const struct tuner_case *c, const char *const *set, unsigned sets, double days,
              struct tuner_result *r);

#endif
