#include "kinds/gmv/gmv_config.h"

struct rls_settings gmv_rls_settings(const struct gmv_config *c, unsigned i, float *p0)
{
    struct rls_settings s = c->rls;
    const struct gmv_shape *shape = &c->shape;
    unsigned n = gmv_parameters(shape, i);
    for (unsigned k = 0; k < n && k < GMV_PARAMETERS; k++)
        p0[k] = k >= shape->na && k < gmv_pv_and_mv_terms(shape, i) ? c->p0_u : c->p0;
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

/* Longest P and R: beyond it the change in a step drowns in rounding. */
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
        struct rls_settings s = gmv_rls_settings(c, i, p0);
        err = rls_check(&s, field, wanted);
    }
    return err;
}
