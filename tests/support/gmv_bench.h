/* A self-tuner (kinds/gmv/gmv.h) that controls a small linear plant, step by step; everything in fractions of span, the plant
 * in double:
 *
 *     y_i(t) = a_i y_i(t-1) + sum over j of b_ij u_j(t - k_ij) + e_i(t) + d_i + c_i e_i(t-1)
 */
#ifndef REFLUX_TESTS_GMV_BENCH_H
#define REFLUX_TESTS_GMV_BENCH_H

#include <stdalign.h>
#include <string.h>

#include "kinds/gmv/gmv.h"

#define BENCH_DEPTH 64

struct gmv_plant {
    double a[GMV_LOOPS], b[GMV_LOOPS][GMV_LOOPS], c[GMV_LOOPS], d[GMV_LOOPS];
    unsigned k[GMV_LOOPS][GMV_LOOPS];
    double y[GMV_LOOPS], e_before[GMV_LOOPS], u[GMV_LOOPS][BENCH_DEPTH];
};

struct gmv_bench {
    struct gmv_config config;
    struct gmv_plant plant;
    struct gmv_range range;
    struct {
        alignas(8) char bytes[sizeof(struct applied_history) + BENCH_DEPTH * sizeof(num_t)];
    } history[GMV_LOOPS];
    alignas(8) char state[8192];
    struct gmv *gmv;
    num_t u[GMV_LOOPS];
    enum gmv_solved solved;
    uint8_t acting, learn;
};

static inline struct gmv_config gmv_plain_config(uint8_t loops)
{
    struct gmv_config c = {.shape = {.loops = loops,
                                     .na = 1,
                                     .nb = 1,
                                     .average = 1,
                                     .delay = {{1, loops == 2}, {loops == 2, 1}},
                                     .form = GMV_INCREMENTAL},
                           .interval_s = 30,
                           .determinant = 0.01f,
                           .p0 = 1e4f,
                           .p0_u = 1e4f,
                           .rls = {.forget = 1,
                                   .forget_least = 0.2f,
                                   .sigma0 = 1e-4f,
                                   .memory = 1,
                                   .trace = 1e5f,
                                   .rate = 0.2f}};
    return c;
}

static inline struct applied_history *gmv_history_of(struct gmv_bench *b, unsigned j)
{
    return (struct applied_history *)(void *)b->history[j].bytes;
}

/* Everything has been at rest at u0. */
static inline void gmv_bench_begin(struct gmv_bench *b, double u0)
{
    b->gmv = (struct gmv *)(void *)b->state;
    b->acting = b->learn = (uint8_t)((1u << b->config.shape.loops) - 1u);
    for (unsigned j = 0; j < GMV_LOOPS; j++) {
        applied_history_begin(gmv_history_of(b, j), BENCH_DEPTH, num_from_float((float)u0));
        b->range.lo[j] = num_from_float(-100);
        b->range.hi[j] = num_from_float(100);
        b->u[j] = num_from_float((float)u0);
        for (unsigned s = 0; s < BENCH_DEPTH; s++)
            b->plant.u[j][s] = u0;
    }
    gmv_init(b->gmv, &b->config);
}

/* The plant takes a step with what was applied last, e being its noise. */
static inline void gmv_plant_step(struct gmv_plant *p, unsigned loops, const double *e)
{
    for (unsigned i = 0; i < loops; i++) {
        double y = p->a[i] * p->y[i] + e[i] + p->c[i] * p->e_before[i] + p->d[i];
        for (unsigned j = 0; j < loops; j++)
            if (p->k[i][j])
                y += p->b[i][j] * p->u[j][p->k[i][j] - 1u];
        p->y[i] = y;
        p->e_before[i] = e[i];
    }
}

static inline struct gmv_sample gmv_bench_sample(struct gmv_bench *b, const double *w)
{
    struct gmv_sample s = {.divisor = 1};
    for (unsigned i = 0; i < b->config.shape.loops; i++) {
        s.y[i] = num_from_float((float)b->plant.y[i]);
        s.w[i] = num_from_float((float)w[i]);
        s.applied[i] = gmv_history_of(b, i);
    }
    return s;
}

/* u takes effect. */
static inline void gmv_bench_apply(struct gmv_bench *b)
{
    for (unsigned j = 0; j < b->config.shape.loops; j++) {
        applied_history_append(gmv_history_of(b, j), b->u[j]);
        memmove(&b->plant.u[j][1], &b->plant.u[j][0], (BENCH_DEPTH - 1u) * sizeof(double));
        b->plant.u[j][0] = (double)num_to_float(b->u[j]);
    }
}

/* Measures, learns, uses what it has learnt when `adapt`, and moves the MVs; then the plant goes a step on. */
static inline void gmv_bench_step(struct gmv_bench *b, const double *w, const double *e, bool adapt)
{
    struct gmv_sample s = gmv_bench_sample(b, w);
    unsigned loops = b->config.shape.loops;
    gmv_take(b->gmv, &s);
    (void)gmv_learn(b->gmv, &s, adapt ? b->learn : 0);
    for (unsigned i = 0; i < loops && adapt; i++)
        for (unsigned p = 0; p < gmv_parameters(&b->config.shape, i); p++)
            gmv_use(b->gmv, i, p, rls_theta(gmv_rls(b->gmv, i), p));
    b->solved = gmv_solve(b->gmv, &s, b->acting, &b->range, b->u);
    gmv_bench_apply(b);
    gmv_plant_step(&b->plant, loops, e);
}

#endif
