/* A loop that runs for a million samples under one estimator: what the parts of the program share. */
#ifndef REFLUX_CAMPAIGN_ENDURANCE_H
#define REFLUX_CAMPAIGN_ENDURANCE_H

#include <stdbool.h>
#include <stdint.h>

#include "kinds/gmv/gmv.h"
#include "random_source.h"

enum course { COURSE_REST, COURSE_STIFF, COURSE_DRIFT, COURSE_NOISE, COURSES };

#define COURSE_PARAMETERS 6
#define COURSE_MOVES      600u  /* samples with setpoint steps at the beginning of each course */
#define COURSE_LAST       1000u /* and at the end of those that rest */

/* The plant of a course: y(t) = a1 y(t-1) + a2 y(t-2) + g (b1 u(t-1) + b2 u(t-2)) + v L(t-1) + e(t) + d. */
struct course_plant {
    enum course course;
    struct random_source noise;
    uint64_t t;
    double y[2], u[2], load, gain, w, sensor; /* sensor: its noise in this sample */
    uint64_t samples;                         /* of the whole run */
};

void course_begin(struct course_plant *p, enum course course, uint64_t samples, uint64_t seed);
/* w, load and gain of the sample that comes now. */
void course_prepare(struct course_plant *p);
/* Returns the reading of y. */
double course_reading(const struct course_plant *p);
/* The plant goes a step on with u. */
void course_step(struct course_plant *p, double u);
/* Settings with which each estimator of the course works. */
struct gmv_config course_config(enum course course);

/* The first thing that went wrong, and its sample. */
struct verdict {
    uint64_t sample; /* 0: nothing went wrong */
    const char *what;
    /* mean squares of the moves: over 50 samples, and as they were at the end of tune-in */
    double size, rest;
    double error;   /* sum of |w - y| over the last tenth */
    uint64_t still; /* samples since the setpoint moved */
    double w;
};

/* After each sample: y and u are finite and in range, moves have not burst while the setpoint rests. */
void verdict_of_control(struct verdict *v, const struct course_plant *p, double move);
void verdict_of(struct verdict *v, const struct course_plant *p, bool wrong, const char *what);

/* ---- estimators ---- */

/* One of enum rls_forgetting over UDU', what it finds used as it is. */
struct verdict run_rule(enum course course, unsigned rule, uint64_t samples, uint64_t seed);
/* Constant forgetting with P = (P - K phi'P)/v kept as it is printed, in the number format of the build, or in double. */
struct verdict run_covariance(enum course course, bool in_double, bool bounded, uint64_t samples,
                              uint64_t seed);
/* The whole block with its supervision and its defaults. */
struct verdict run_supervised(enum course course, uint64_t samples, uint64_t seed);

/* The loop around any of them: a gmv whose estimator learns or not. */
struct loop {
    struct course_plant plant;
    struct gmv_config config;
    struct gmv *gmv;
    struct gmv_sample sample;
    num_t u;
};
void loop_begin(struct loop *l, enum course course, uint64_t samples, uint64_t seed);
/* Takes the sample that comes now. */
void loop_take(struct loop *l);
/* Solves the law, applies it, lets the plant go on and judges. */
void loop_act(struct loop *l, struct verdict *v);

#endif
