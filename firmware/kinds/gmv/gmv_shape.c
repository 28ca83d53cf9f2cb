/* Settings, places and sizes of the self-tuner. */
#include <string.h>

#include "kinds/gmv/gmv_inside.h"
#include "num/real.h"

static unsigned inputs_of(const struct gmv_shape *shape, unsigned i)
{
    unsigned count = 0;
    for (unsigned j = 0; j < shape->loops; j++)
        count += shape->delay[i][j] != 0;
    return count;
}

static bool has_bias(const struct gmv_shape *shape)
{
    return shape->form == GMV_POSITIONAL && shape->bias < GMV_BIAS_NONE;
}

static unsigned before_disturbance(const struct gmv_shape *shape, unsigned i)
{
    return shape->na + inputs_of(shape, i) * shape->nb;
}

unsigned gmv_parameters(const struct gmv_shape *shape, unsigned i)
{
    return before_disturbance(shape, i) + shape->disturbances + shape->nc + has_bias(shape);
}

int gmv_place_of_u(const struct gmv_shape *shape, unsigned i, unsigned j)
{
    unsigned place = shape->na;
    if (!shape->delay[i][j])
        return -1;
    for (unsigned k = 0; k < shape->loops && j != i; k++) /* its own stands first */
        place += (k == i || k < j) && shape->delay[i][k] ? shape->nb : 0u;
    return (int)place;
}

int gmv_place_of_disturbance(const struct gmv_shape *shape, unsigned i)
{
    return shape->disturbances ? (int)before_disturbance(shape, i) : -1;
}

int gmv_place_of_noise(const struct gmv_shape *shape, unsigned i)
{
    return shape->nc ? (int)(before_disturbance(shape, i) + shape->disturbances) : -1;
}

int gmv_place_of_bias(const struct gmv_shape *shape, unsigned i)
{
    return has_bias(shape) ? (int)gmv_parameters(shape, i) - 1 : -1;
}

unsigned gmv_horizon(const struct gmv_shape *shape, unsigned i)
{
    return shape->way == GMV_EXPLICIT ? 1u : shape->delay[i][i];
}

unsigned gmv_behind(const struct gmv_shape *shape, unsigned i, unsigned j)
{
    return shape->delay[i][j] - gmv_horizon(shape, i);
}

static unsigned more_steps(unsigned a, unsigned b)
{
    return a > b ? a : b;
}

/* Steps from now to the oldest value of any signal that a regression or the law looks at. */
unsigned gmv_reach(const struct gmv_shape *shape)
{
    unsigned reach = 0;
    for (unsigned i = 0; i < shape->loops; i++) {
        unsigned k = shape->delay[i][i], last = shape->na - 1u;
        for (unsigned j = 0; j < shape->loops; j++)
            if (shape->delay[i][j])
                last = more_steps(last, shape->delay[i][j] + shape->nb - 2u);
        last = more_steps(last, more_steps(shape->nc, shape->disturbance_delay));
        reach = more_steps(reach, 2u * k + last + shape->average);
    }
    return reach;
}

unsigned gmv_history(const struct gmv_shape *shape)
{
    return gmv_reach(shape) + 1u;
}

uint32_t gmv_bytes(const struct gmv_shape *shape)
{
    uint32_t bytes = (sizeof(struct gmv) + 7u) & ~7u;
    for (unsigned i = 0; i < shape->loops; i++)
        bytes += rls_bytes(gmv_parameters(shape, i));
    return bytes;
}

struct rls *gmv_rls_of(struct gmv *g, unsigned i)
{
    return (struct rls *)(void *)((char *)g + g->rls_at[i]);
}

const struct rls *gmv_rls(const struct gmv *g, unsigned i)
{
    return (const struct rls *)(const void *)((const char *)g + g->rls_at[i]);
}

num_t gmv_used(const struct gmv *g, unsigned i, unsigned p)
{
    return g->used[i][p];
}

void gmv_use(struct gmv *g, unsigned i, unsigned p, num_t value)
{
    g->used[i][p] = value;
}

/* ---- settings ---- */

/* Settings of loop i's estimator: what stands in its pointers is the caller's. */
static struct rls_settings settings_of_loop(const struct gmv_config *c, unsigned i, float *p0)
{
    struct rls_settings s = c->rls;
    const struct gmv_shape *shape = &c->shape;
    unsigned n = gmv_parameters(shape, i);
    for (unsigned k = 0; k < n && k < GMV_PARAMETERS; k++)
        p0[k] = k >= shape->na && k < before_disturbance(shape, i) ? c->p0_u : c->p0;
    s.n = (uint8_t)n;
    s.p0 = p0;
    s.lo = c->lo[i];
    s.hi = c->hi[i];
    return s;
}

static enum err refused(const char **field, const char **wanted, const char *name, const char *what)
{
    *field = name;
    *wanted = what;
    return ERR_RANGE;
}

static enum err check_delays(const struct gmv_shape *shape, unsigned *loop, const char **field,
                             const char **wanted)
{
    for (unsigned i = 0; i < shape->loops; i++)
        for (unsigned j = 0; j < shape->loops; j++) {
            unsigned own = shape->delay[i][i], k = shape->delay[i][j];
            *loop = i;
            if (own < 1 || own > GMV_DELAY_MAX)
                return refused(field, wanted, "delay",
                               "needs 1 to 8 steps from each loop's own MV");
            if (k && (k < own || k > GMV_DELAY_MAX))
                return refused(field, wanted, "delay",
                               "needs 0, or at least the loop's own delay, to 8 steps");
        }
    return ERR_OK;
}

/* How long P and R may be: beyond it the change in a step drowns in rounding. */
#define SLOWEST_STEPS 200.0f

enum err gmv_check(const struct gmv_config *c, unsigned *loop, const char **field,
                   const char **wanted)
{
    const struct gmv_shape *shape = &c->shape;
    float p0[GMV_PARAMETERS];
    if (shape->bias == GMV_BIAS_ERROR &&
        (shape->form != GMV_INCREMENTAL || shape->way != GMV_IMPLICIT))
        return refused(field, wanted, "bias",
                       "must not be error unless form is incremental and way implicit");
    enum err err = check_delays(shape, loop, field, wanted);
    for (unsigned i = 0; i < shape->loops && !err; i++) {
        *loop = i;
        if (gmv_parameters(shape, i) > GMV_PARAMETERS)
            return refused(field, wanted, "na", "makes more than 12 parameters, with nb and nc");
        if (c->tau_p_s[i] > SLOWEST_STEPS * c->interval_s)
            return refused(field, wanted, "tau_p", "must be 200 steps or less");
        if (c->tau_r_s[i] > SLOWEST_STEPS * c->interval_s)
            return refused(field, wanted, "tau_r", "must be 200 steps or less");
        struct rls_settings s = settings_of_loop(c, i, p0);
        err = rls_check(&s, field, wanted);
    }
    return err;
}

static float decay(float tau_s, float interval_s)
{
    return tau_s > 0 ? real_exp(-interval_s / tau_s) : 0;
}

static void take_config(struct gmv *g, const struct gmv_config *c)
{
    g->shape = c->shape;
    g->determinant = num_from_float(c->determinant);
    for (unsigned i = 0; i < c->shape.loops; i++) {
        float p = decay(c->tau_p_s[i], c->interval_s);
        g->p[i] = num_from_float(p);
        g->p_scale[i] = num_from_float(1 / (1 - p));
        g->weighs_setpoint[i] = c->tau_r_s[i] < 0;
        g->r_share[i] = coefficient_from_float(1 - decay(c->tau_r_s[i], c->interval_s));
        g->lambda[i] = num_from_float(c->lambda[i]);
    }
}

void gmv_init(struct gmv *g, const struct gmv_config *c)
{
    float p0[GMV_PARAMETERS];
    uint32_t at = (sizeof(struct gmv) + 7u) & ~7u;
    memset(g, 0, sizeof *g);
    take_config(g, c);
    for (unsigned i = 0; i < c->shape.loops; i++) {
        struct rls_settings s = settings_of_loop(c, i, p0);
        for (unsigned k = 0; k < s.n; k++)
            g->used[i][k] = num_from_float(c->theta[i][k]);
        g->rls_at[i] = at;
        at += rls_bytes(s.n);
        rls_init(gmv_rls_of(g, i), &s, g->used[i]);
    }
}

void gmv_retune(struct gmv *g, const struct gmv_config *c)
{
    float p0[GMV_PARAMETERS];
    take_config(g, c);
    for (unsigned i = 0; i < c->shape.loops; i++) {
        struct rls_settings s = settings_of_loop(c, i, p0);
        rls_retune(gmv_rls_of(g, i), &s);
    }
}

void gmv_begin(struct gmv *g)
{
    g->steps = 0;
}
