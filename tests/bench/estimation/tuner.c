/* A sample of the self-tuner (kinds/gmv/gmv.h): taken, learnt from, solved. SV: one loop; MD1: two, solved together. */
#include <stdalign.h>
#include <stdbool.h>
#include <string.h>

#include "cost.h"
#include "kinds/gmv/gmv.h"

#define SAMPLES 300
#define DEPTH   48

static alignas(8) char state[6000];
static alignas(8) char history[GMV_LOOPS][sizeof(struct applied_history) + DEPTH * sizeof(num_t)];

static void cost_of(const char *what, uint8_t loops, uint8_t form)
{
    struct gmv *g = (struct gmv *)(void *)state;
    struct gmv_config c;
    struct cost cost = {0};
    struct gmv_range range;
    memset(&c, 0, sizeof c);
    c.shape = (struct gmv_shape){.loops = loops, .form = form, .na = 1, .nb = 1, .average = 1};
    c.interval_s = 30;
    c.determinant = 0.01f;
    c.p0 = c.p0_u = 1e4f;
    c.rls =
        (struct rls_settings){.forgetting = RLS_DIRECTIONAL, .forget = 0.98f, .forget_least = 0.2f};
    c.rls.sigma0 = c.rls.memory = 1;
    c.rls.trace = 1e5f;
    for (unsigned i = 0; i < loops; i++) {
        c.lambda[i] = 0.1f;
        c.theta[i][0] = 0.8f;
        c.theta[i][1] = 0.3f;
        range.lo[i] = num_zero();
        range.hi[i] = num_one();
        for (unsigned j = 0; j < loops; j++)
            c.shape.delay[i][j] = 1;
        applied_history_begin((struct applied_history *)(void *)history[i], DEPTH, num_zero());
    }
    gmv_init(g, &c);
    for (unsigned t = 0; t < SAMPLES; t++) {
        struct gmv_sample s = {.divisor = 1};
        num_t u[GMV_LOOPS];
        for (unsigned i = 0; i < loops; i++) {
            s.applied[i] = (struct applied_history *)(void *)history[i];
            s.y[i] = num_from_float(0.5f + 0.05f * cost_random());
            s.w[i] = num_from_float(0.5f);
        }
        cost_paint_stack();
        uint32_t from = cost_now();
        gmv_take(g, &s);
        (void)gmv_learn(g, &s, 3);
        for (unsigned i = 0; i < loops; i++)
            for (unsigned p = 0; p < gmv_parameters(&c.shape, i); p++)
                gmv_use(g, i, p, rls_theta(gmv_rls(g, i), p));
        (void)gmv_solve(g, &s, loops == 2 ? 3 : 1, &range, u);
        uint32_t to = cost_now();
        if (t > 20)
            cost_add(&cost, from, to);
        cost_stack(&cost);
        for (unsigned i = 0; i < loops; i++)
            applied_history_append((struct applied_history *)(void *)history[i], u[i]);
    }
    cost_tell(what, loops, &cost, gmv_bytes(&c.shape));
}

void cost_of_tuners(void)
{
    cost_of("PSV", 1, GMV_POSITIONAL);
    cost_of("ISV", 1, GMV_INCREMENTAL);
    cost_of("PMD1", 2, GMV_POSITIONAL);
    cost_of("IMD1", 2, GMV_INCREMENTAL);
}
