/* Estimators without supervision: every rule of forgetting over UDU', and the covariance as it is printed. */
#include <math.h>
#include <stdalign.h>
#include <string.h>

#include "endurance.h"

#define DEPTH     48
#define PARAMETER 50.0f /* no parameter of these plants is above 2 */

static alignas(8) char state[6000];
static alignas(8) char history[sizeof(struct applied_history) + DEPTH * sizeof(num_t)];

void loop_begin(struct loop *l, enum course course, uint64_t samples, uint64_t seed)
{
    memset(l, 0, sizeof *l);
    course_begin(&l->plant, course, samples, seed);
    l->config = course_config(course);
    l->gmv = (struct gmv *)(void *)state;
    l->sample.divisor = 1;
    l->sample.applied[0] = (struct applied_history *)(void *)history;
    applied_history_begin((struct applied_history *)(void *)history, DEPTH, num_zero());
}

void loop_take(struct loop *l)
{
    course_prepare(&l->plant);
    l->sample.y[0] = num_from_float((float)course_reading(&l->plant));
    l->sample.w[0] = num_from_float((float)l->plant.w);
    l->sample.disturbance[0] = num_from_float((float)l->plant.load);
    gmv_take(l->gmv, &l->sample);
}

void loop_act(struct loop *l, struct verdict *v)
{
    struct gmv_range range = {.lo = {num_from_float(-2)}, .hi = {num_from_float(2)}};
    double before = (double)num_to_float(l->u);
    (void)gmv_solve(l->gmv, &l->sample, 1, &range, &l->u);
    applied_history_append((struct applied_history *)(void *)history, l->u);
    course_step(&l->plant, (double)num_to_float(l->u));
    verdict_of_control(v, &l->plant, (double)num_to_float(l->u) - before);
}

struct verdict run_rule(enum course course, unsigned rule, uint64_t samples, uint64_t seed)
{
    struct verdict v = {0};
    struct loop l;
    loop_begin(&l, course, samples, seed);
    l.config.rls.forgetting = (uint8_t)rule;
    l.config.rls.sigma0 =
        course == COURSE_REST ? 1e-8f : 1e-4f; /* a hundred or more noise variances */
    gmv_init(l.gmv, &l.config);
    unsigned n = gmv_parameters(&l.config.shape, 0);
    for (uint64_t t = 0; t < samples && !v.sample; t++) {
        float least, most;
        loop_take(&l);
        (void)gmv_learn(l.gmv, &l.sample, 1);
        const struct rls *r = gmv_rls(l.gmv, 0);
        for (unsigned p = 0; p < n; p++) {
            float theta = num_to_float(rls_theta(r, p));
            verdict_of(&v, &l.plant, !(fabsf(theta) < PARAMETER), "parameter");
            gmv_use(l.gmv, 0, p, rls_theta(r, p));
        }
        rls_d_extremes(r, &least, &most);
        verdict_of(&v, &l.plant, !(least > 0 && isfinite(most)), "D not positive");
        verdict_of(&v, &l.plant, rls_clamped(r) > 0, "D had to be clamped");
        loop_act(&l, &v);
    }
    return v;
}

/* ---- the covariance as it is printed ---- */

/* phi of the course's regression, in double, from what the loop has had. */
struct past {
    double y[4], u[4], load[2]; /* [0]: now, or just applied */
};

static unsigned regressor_of(const struct past *s, const struct gmv_shape *shape, double *phi)
{
    unsigned n = 0;
    bool incremental = shape->form == GMV_INCREMENTAL;
    for (unsigned a = 1; a <= shape->na; a++)
        phi[n++] = s->y[a] - (incremental ? s->y[a + 1] : 0);
    for (unsigned b = 0; b < shape->nb; b++)
        phi[n++] = s->u[b] - (incremental ? s->u[b + 1] : 0);
    if (shape->disturbances)
        phi[n++] = s->load[1];
    if (!incremental)
        phi[n++] = 1;
    return n;
}

/* One update with every operation rounded to the format: a number is stored through store(). */
static double store(double x, bool in_double)
{
    return in_double ? x : (double)num_to_float(num_from_float((float)x));
}

struct covariance {
    double p[COURSE_PARAMETERS][COURSE_PARAMETERS], theta[COURSE_PARAMETERS];
    bool in_double, bounded;
};

static double trace_of(const struct covariance *c, unsigned n)
{
    double trace = 0;
    for (unsigned i = 0; i < n; i++)
        trace += c->p[i][i];
    return trace;
}

static void update(struct covariance *c, unsigned n, const double *phi, double y, double v,
                   double most)
{
    double p_phi[COURSE_PARAMETERS], k[COURSE_PARAMETERS], alpha = v, error = y;
    for (unsigned i = 0; i < n; i++) {
        p_phi[i] = 0;
        for (unsigned j = 0; j < n; j++)
            p_phi[i] = store(p_phi[i] + store(c->p[i][j] * phi[j], c->in_double), c->in_double);
        alpha = store(alpha + store(p_phi[i] * phi[i], c->in_double), c->in_double);
        error = store(error - store(phi[i] * c->theta[i], c->in_double), c->in_double);
    }
    if (c->bounded)
        v = fmax(v, fmin(1, trace_of(c, n) / most));
    for (unsigned i = 0; i < n; i++) {
        k[i] = store(p_phi[i] / alpha, c->in_double);
        c->theta[i] = store(c->theta[i] + store(k[i] * error, c->in_double), c->in_double);
    }
    for (unsigned i = 0; i < n; i++)
        for (unsigned j = 0; j < n; j++)
            c->p[i][j] =
                store(store(c->p[i][j] - store(k[i] * p_phi[j], c->in_double), c->in_double) / v,
                      c->in_double);
    for (unsigned i = 0; i < n && c->in_double; i++) /* the reference has only one half */
        for (unsigned j = 0; j < i; j++)
            c->p[i][j] = c->p[j][i];
}

struct verdict run_covariance(enum course course, bool in_double, bool bounded, uint64_t samples,
                              uint64_t seed)
{
    struct verdict v = {0};
    struct loop l;
    struct past s = {0};
    struct covariance c = {.in_double = in_double, .bounded = bounded};
    loop_begin(&l, course, samples, seed);
    gmv_init(l.gmv, &l.config);
    unsigned n = gmv_parameters(&l.config.shape, 0);
    for (unsigned i = 0; i < n; i++) {
        c.p[i][i] = store((double)l.config.p0, in_double);
        c.theta[i] = (double)l.config.theta[0][i];
    }
    for (uint64_t t = 0; t < samples && !v.sample; t++) {
        double phi[COURSE_PARAMETERS];
        loop_take(&l);
        memmove(&s.y[1], &s.y[0], 3 * sizeof s.y[0]);
        s.y[0] = (double)num_to_float(l.sample.y[0]);
        s.load[1] = s.load[0];
        s.load[0] = (double)num_to_float(l.sample.disturbance[0]);
        if (t > gmv_reach(&l.config.shape)) {
            (void)regressor_of(&s, &l.config.shape, phi);
            double target = l.config.shape.form == GMV_INCREMENTAL ? s.y[0] - s.y[1] : s.y[0];
            update(&c, n, phi, target, (double)l.config.rls.forget, (double)l.config.rls.trace);
        }
        for (unsigned i = 0; i < n; i++) {
            verdict_of(&v, &l.plant, !(c.p[i][i] > 0), "P not positive");
            verdict_of(&v, &l.plant, !(fabs(c.theta[i]) < (double)PARAMETER), "parameter");
            verdict_of(&v, &l.plant, !(c.p[i][i] < 1e30), "P beyond 1e30");
            gmv_use(l.gmv, 0, i, num_from_float((float)c.theta[i]));
        }
        loop_act(&l, &v);
        memmove(&s.u[1], &s.u[0], 3 * sizeof s.u[0]);
        s.u[0] = (double)num_to_float(l.u);
    }
    return v;
}
