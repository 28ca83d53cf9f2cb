#include "kinds/gmv/gmv_values.h"

#include "base/assertion.h"
#include "num/real.h"

/* In use, estimated, its standard deviation. */
#define VALUES_OF_PARAMETER ((size_t)3)
#define VALUES_OF_BLOCK     7u
#define VALUES_OF_LOOP      8u

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

static const char *block_value(const struct gmv_view *view, size_t n, float *value)
{
    const struct gmv_status *s = view->status;
    const struct {
        const char *name;
        float value;
    } inner[VALUES_OF_BLOCK] = {
        {"state", s->state},
        {"on_trial", s->testing},
        {"refusal", s->refusal},
        {"decay", s->outcome.decay},
        {"proposed", view->stored},
        {"better", 1 - s->outcome.ratio},
        {"lambda_times", view->lambda_times},
    };
    *value = inner[n].value;
    return inner[n].name;
}

static const char *loop_value(const struct gmv_view *view, unsigned loop, size_t n, float *value)
{
    REFLUX_ASSERT(loop < GMV_LOOPS);
    const struct gmv_status *s = view->status;
    const struct rls *r = gmv_rls(view->gmv, loop);
    struct gmv_predicted predicted = gmv_predicted(view->gmv, loop);
    const struct {
        const char *name[GMV_LOOPS];
        float value;
    } inner[VALUES_OF_LOOP] = {
        {{"rests_1", "rests_2"}, s->rest[loop]},
        {{"measured_1", "measured_2"}, num_to_float(predicted.measured)},
        {{"predicted_1", "predicted_2"}, num_to_float(predicted.used)},
        {{"error_sd_1", "error_sd_2"}, rls_error_sd(r)},
        {{"v_1", "v_2"}, rls_forgot(r)},
        {{"told_1", "told_2"}, view->information[loop]},
        {{"trace_1", "trace_2"}, rls_trace(r)},
        {{"lambda_1", "lambda_2"}, num_to_float(gmv_lambda(view->gmv, loop))},
    };
    *value = inner[n].value;
    return inner[n].name[loop];
}

const char *gmv_value(const struct gmv_view *view, size_t n, float *value)
{
    const struct gmv *g = view->gmv;
    const struct gmv_shape *shape = gmv_shape(g);
    if (n < VALUES_OF_BLOCK)
        return block_value(view, n, value);
    n -= VALUES_OF_BLOCK;
    for (unsigned loop = 0; loop < shape->loops; loop++) {
        size_t parameters = gmv_parameters(shape, loop);
        const struct rls *r = gmv_rls(g, loop);
        if (n < VALUES_OF_LOOP)
            return loop_value(view, loop, n, value);
        n -= VALUES_OF_LOOP;
        if (n < VALUES_OF_PARAMETER * parameters) {
            unsigned which = (unsigned)n % VALUES_OF_PARAMETER,
                     p = (unsigned)n / VALUES_OF_PARAMETER;
            *value = which == 0   ? num_to_float(gmv_used(g, loop, p))
                     : which == 1 ? num_to_float(rls_theta(r, p))
                                  : rls_error_sd(r) * real_sqrt(rls_covariance(r, p, p));
            return parameter_names[which][loop][p];
        }
        n -= VALUES_OF_PARAMETER * parameters;
    }
    return NULL;
}
