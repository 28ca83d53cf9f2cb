/* What a block of the kind `gmv` may be told, and what it shows. */
#include "kinds/gmv/gmv_block.h"

#include "num/real.h"

/* ---- verbs ---- */

static const char *run_freeze(void *state, const float *number)
{
    struct gmv_block *s = state;
    (void)number;
    s->watch.asked_to_rest = true;
    return NULL;
}

static const char *run_thaw(void *state, const float *number)
{
    struct gmv_block *s = state;
    (void)number;
    s->watch.asked_to_rest = false;
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        s->watch.is_quiet[i] = false;
        s->watch.told[i] = 1;
    }
    return NULL;
}

static const char *run_tune(void *state, const float *number)
{
    struct gmv_block *s = state;
    (void)number;
    gmv_supervise_begin(&s->watch);
    s->proposes = s->on_trial = false;
    return NULL;
}

static const char *run_reset(void *state, const float *number)
{
    gmv_start_again(state);
    return run_tune(state, number);
}

static const char *run_adopt(void *state, const float *number)
{
    struct gmv_block *s = state;
    const struct gmv *g = gmv_of_const(s);
    (void)number;
    if (s->watch.state == GMV_SELF_TUNING)
        return "adopted already";
    for (unsigned i = 0; i < s->loops; i++) {
        int own = gmv_place_of_u(&g->shape, i, i);
        float gain = num_to_float(rls_theta(gmv_rls(g, i), (unsigned)own));
        if ((s->acting & (1u << i)) &&
            !((s->watch.config.negative[i] ? -gain : gain) >= s->watch.config.gain_least))
            return "sign or size of a gain";
    }
    if (s->watch.state == GMV_WAITING)
        gmv_supervise_begin(&s->watch);
    s->watch.adopt_now = true;
    return NULL;
}

const struct block_verb gmv_verb_rows[GMV_VERBS] = {
    {"freeze", NULL, "nothing is learnt until `thaw`", 0, 0, false, ACCESS_OPERATOR, run_freeze},
    {"thaw", NULL, "it learns again", 0, 0, false, ACCESS_OPERATOR, run_thaw},
    {"tune", NULL, "back to the PI; a model is tested anew", 0, 0, false, ACCESS_OPERATOR,
     run_tune},
    {"reset", NULL, "the same, and from the start values", 0, 0, false, ACCESS_ENGINEER, run_reset},
    {"adopt", NULL, "the law takes over with what is estimated, untested", 0, 0, false,
     ACCESS_ENGINEER, run_adopt},
};

/* ---- inner values ---- */

#define OF_PARAMETERS ((size_t)3)

static const char parameter_names[3][GMV_LOOPS][GMV_PARAMETERS][8] = {
    {{"use1_1", "use1_2", "use1_3", "use1_4", "use1_5", "use1_6", "use1_7", "use1_8", "use1_9",
      "use1_10", "use1_11", "use1_12"},
     {"use2_1", "use2_2", "use2_3", "use2_4", "use2_5", "use2_6", "use2_7", "use2_8", "use2_9",
      "use2_10", "use2_11", "use2_12"}},
    {{"est1_1", "est1_2", "est1_3", "est1_4", "est1_5", "est1_6", "est1_7", "est1_8", "est1_9",
      "est1_10", "est1_11", "est1_12"},
     {"est2_1", "est2_2", "est2_3", "est2_4", "est2_5", "est2_6", "est2_7", "est2_8", "est2_9",
      "est2_10", "est2_11", "est2_12"}},
    {{"sd1_1", "sd1_2", "sd1_3", "sd1_4", "sd1_5", "sd1_6", "sd1_7", "sd1_8", "sd1_9", "sd1_10",
      "sd1_11", "sd1_12"},
     {"sd2_1", "sd2_2", "sd2_3", "sd2_4", "sd2_5", "sd2_6", "sd2_7", "sd2_8", "sd2_9", "sd2_10",
      "sd2_11", "sd2_12"}},
};

static const char *describe_block(const struct gmv_block *s, size_t i, float *value)
{
    const struct {
        const char *name;
        float value;
    } inner[] = {
        {"state", s->watch.state},     {"on_trial", s->watch.testing},
        {"refusal", s->watch.refusal}, {"decay", s->watch.outcome.decay},
        {"proposed", s->proposed},     {"better", 1 - s->watch.outcome.ratio},
        {"lambda_times", s->times},
    };
    if (i >= sizeof inner / sizeof inner[0])
        return NULL;
    *value = inner[i].value;
    return inner[i].name;
}
#define OF_BLOCK 7u

static const char *describe_loop(const struct gmv_block *s, unsigned loop, size_t i, float *value)
{
    const struct gmv *g = gmv_of_const(s);
    const struct rls *r = gmv_rls(g, loop);
    struct gmv_predicted of = gmv_predicted(g, loop);
    const struct {
        const char *name[GMV_LOOPS];
        float value;
    } inner[] = {
        {{"rests_1", "rests_2"}, s->watch.rest[loop]},
        {{"measured_1", "measured_2"}, num_to_float(of.measured)},
        {{"predicted_1", "predicted_2"}, num_to_float(of.used)},
        {{"error_sd_1", "error_sd_2"}, rls_error_sd(r)},
        {{"v_1", "v_2"}, rls_forgot(r)},
        {{"told_1", "told_2"}, s->watch.told[loop]},
        {{"trace_1", "trace_2"}, rls_trace(r)},
        {{"lambda_1", "lambda_2"}, num_to_float(g->lambda[loop])},
    };
    *value = inner[i].value;
    return inner[i].name[loop];
}
#define OF_LOOP 8u

const char *gmv_describe(const void *state, size_t i, float *value)
{
    const struct gmv_block *s = state;
    const struct gmv *g = gmv_of_const(s);
    if (i < OF_BLOCK)
        return describe_block(s, i, value);
    i -= OF_BLOCK;
    for (unsigned loop = 0; loop < s->loops; loop++) {
        unsigned n = gmv_parameters(&g->shape, loop);
        const struct rls *r = gmv_rls(g, loop);
        if (i < OF_LOOP)
            return describe_loop(s, loop, i, value);
        i -= OF_LOOP;
        if (i < OF_PARAMETERS * n) {
            unsigned what = (unsigned)i % OF_PARAMETERS, p = (unsigned)i / OF_PARAMETERS;
            *value = what == 0   ? num_to_float(gmv_used(g, loop, p))
                     : what == 1 ? num_to_float(rls_theta(r, p))
                                 : rls_error_sd(r) * real_sqrt(rls_covariance(r, p, p));
            return parameter_names[what][loop][p];
        }
        i -= OF_PARAMETERS * n;
    }
    return NULL;
}
