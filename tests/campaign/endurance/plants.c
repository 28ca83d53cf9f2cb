/* The courses, and how a loop is judged. */
#include <math.h>
#include <string.h>

#include "endurance.h"

/* Mean square of moves that wear nothing out, and that one step of the converter makes: 0.1 % of span r.m.s. */
#define LEAST_SQUARE 1e-6

static double normal(struct random_source *r)
{
    double u = ((double)(random_next(r) >> 11) + 0.5) / 9007199254740992.0;
    double v = (double)(random_next(r) >> 11) / 9007199254740992.0;
    return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

void course_begin(struct course_plant *p, enum course course, uint64_t samples, uint64_t seed)
{
    memset(p, 0, sizeof *p);
    p->course = course;
    p->samples = samples;
    p->noise.state = seed + (uint64_t)course;
    p->gain = 1;
}

/* Rest and noise: after the tune-in no setpoint moves until the last thousand samples. Stiff and drift: steps all the time. */
static double setpoint_of(const struct course_plant *p)
{
    uint64_t t = p->t;
    switch (p->course) {
    case COURSE_REST:
    case COURSE_NOISE:
        if (t >= COURSE_MOVES && t + COURSE_LAST < p->samples)
            return 0;
        return t / 50u % 2u ? 0.05 : -0.05;
    case COURSE_STIFF:
        return t / 40u % 2u ? 0.1 : -0.1;
    default:
        return t / 60u % 2u ? 0.05 : -0.05;
    }
}

void course_prepare(struct course_plant *p)
{
    p->w = setpoint_of(p);
    if (p->course == COURSE_STIFF)
        p->load = 1e-4 * normal(&p->noise);
    if (p->course == COURSE_DRIFT) { /* 1 to 4 in 100,000 samples, and back */
        double phase = (double)(p->t % 200000u) / 100000.0;
        p->gain = pow(4, phase < 1 ? phase : 2 - phase);
    }
    if (p->course == COURSE_NOISE)
        p->sensor = 0.005 * normal(&p->noise);
}

/* A converter of 12 bits; what is smaller is not seen. */
double course_reading(const struct course_plant *p)
{
    return p->course == COURSE_REST ? round(p->y[0] * 4096) / 4096 : p->y[0] + p->sensor;
}

void course_step(struct course_plant *p, double u)
{
    bool stiff = p->course == COURSE_STIFF;
    double sigma = p->course == COURSE_DRIFT ? 1e-3 : (stiff ? 1e-4 : 1e-5);
    double y = stiff ? 1.2 * p->y[0] - 0.35 * p->y[1] + 0.15 * u + 0.05 * p->u[0] + p->load + 0.02
                     : 0.9 * p->y[0] + 0.2 * p->gain * u;
    y += sigma * normal(&p->noise);
    p->y[1] = p->y[0];
    p->y[0] = y;
    p->u[1] = p->u[0];
    p->u[0] = u;
    p->t++;
}

struct gmv_config course_config(enum course course)
{
    struct gmv_config c = {
        .shape = {.loops = 1, .na = 1, .nb = 1, .average = 1, .form = GMV_INCREMENTAL},
        .interval_s = 30,
        .determinant = 0.01f,
        .p0 = 100,
        .p0_u = 100,
        .rls = {
            .forget = 0.98f, .forget_least = 0.2f, .memory = 1, .trace = 1e4f, .sigma0 = 1e-4f}};
    c.shape.delay[0][0] = 1;
    c.lambda[0] = 0.04f;
    c.theta[0][0] = 0.5f;
    c.theta[0][1] = 0.3f;
    if (course == COURSE_STIFF) {
        c.shape.form = GMV_POSITIONAL;
        c.shape.na = c.shape.nb = 2;
        c.shape.disturbances = 1;
        c.theta[0][2] = 0.3f;
        c.theta[0][1] = 0;
    }
    return c;
}

void verdict_of(struct verdict *v, const struct course_plant *p, bool wrong, const char *what)
{
    if (!wrong || v->sample)
        return;
    v->sample = p->t ? p->t : 1;
    v->what = what;
}

void verdict_of_control(struct verdict *v, const struct course_plant *p, double move)
{
    double error = fabs(p->w - p->y[0]);
    v->still = p->w == v->w ? v->still + 1u : 0;
    v->w = p->w;
    v->size += (move * move - v->size) / 50;
    if (p->t == COURSE_MOVES * 3u) /* noise of the plant alone */
        v->rest = v->size;
    verdict_of(v, p, !isfinite(p->y[0]) || fabs(p->y[0]) > 1, "control lost");
    verdict_of(v, p,
               p->course == COURSE_REST && p->t > 3u * COURSE_MOVES &&
                   p->t + COURSE_LAST < p->samples && v->size > 100 * v->rest + LEAST_SQUARE,
               "burst");
    if (p->t * 10u >= p->samples * 9u)
        v->error += error;
}
