#include "design/static_decoupler.h"

#include <stdbool.h>
#include <stddef.h>

#include "base/assertion.h"

void static_decoupler_config_default(struct static_decoupler_config *config)
{
    *config = (struct static_decoupler_config){.element_hi = REAL_C(100.0),
                                               .lambda_hi = REAL_C(10.0),
                                               .significance = REAL_C(3.0),
                                               .floor = REAL_C(0.005),
                                               .left_hi = REAL_C(0.3)};
}

static enum err check_decoupling(const struct static_decoupler_config *c,
                                 struct interact_refusal *reason)
{
    const struct interact_range ranges[] = {
        {c->element_hi, REAL_C(1.0), REAL_C(1000.0), "element_hi", "1 to 1000"},
        {c->lambda_hi, REAL_C(1.0), REAL_C(1000.0), "lambda_hi", "1 to 1000"},
        {c->significance, REAL_C(0.0), REAL_C(20.0), "significance", "0 to 20"},
        {c->floor, REAL_C(0.0), REAL_C(0.5), "floor", "0 to 0.5"},
        {c->left_hi, REAL_C(0.01), REAL_C(10.0), "left_hi", "0.01 to 10"}};
    return interact_check_ranges(ranges, sizeof ranges / sizeof ranges[0], reason);
}

static enum err refuse_element(struct interact_refusal *reason, const char *field,
                               const char *wanted, const struct pairs *pairs, size_t row,
                               size_t col)
{
    *reason = (struct interact_refusal){field, wanted, pairs->output[row], pairs->input[col]};
    return ERR_SINGULAR;
}

static real_t gain_variance(const struct interact_plant *plant, const struct pairs *pairs,
                            real_t floor, size_t k, size_t l)
{
    REFLUX_ASSERT(k < pairs->n && l < pairs->n);
    size_t i = pairs->output[k], j = pairs->input[l];
    real_t sd = plant->gain_sd[i][j], part = floor * plant->element[i][j].gain;
    return sd * sd + part * part;
}

static enum err check_bounds(const struct pairs *pairs, const struct static_decoupler_config *c,
                             struct static_decoupler_work *work, struct interact_refusal *reason)
{
    size_t n = pairs->n;
    for (size_t k = 0; k < n; k++)
        for (size_t l = 0; l < n; l++) {
            real_t lambda = work->gains.value[k][l] * work->inverse.value[l][k];
            if (!real_within(real_abs(lambda), REAL_C(0.0), c->lambda_hi))
                return refuse_element(reason, "relative gain",
                                      "small enough that inputs need not be exact", pairs, k, l);
        }
    for (size_t k = 0; k < n; k++)
        for (size_t l = 0; l < n; l++)
            if (!(real_abs(work->inverse.value[l][k]) <=
                  c->element_hi * real_abs(work->inverse.value[k][k])))
                return refuse_element(reason, "element", "within the firmware's range", pairs, k,
                                      l);
    return ERR_OK;
}

enum err static_decoupler(const struct interact_plant *plant, const struct pairs *pairs,
                          const struct static_decoupler_config *config,
                          struct static_decoupler_work *work,
                          struct static_decoupler_result *result, struct interact_refusal *reason)
{
    struct interact_refusal unused;
    reason = reason ? reason : &unused;
    enum err err = interact_check(plant, reason);
    if (!err)
        err = pairs_check(plant, pairs, reason);
    if (!err)
        err = check_decoupling(config, reason);
    if (err)
        return err;
    size_t n = pairs->n;
    *reason = (struct interact_refusal){"pairs", "1 to 8 loops", INTERACT_NONE, INTERACT_NONE};
    if (n < 1)
        return ERR_RANGE;
    if (n > STATIC_DECOUPLER_LOOPS)
        return ERR_FULL;
    interact_gains(plant, pairs, &work->gains);
    *reason = (struct interact_refusal){"gains", "a matrix with an inverse", INTERACT_NONE,
                                        INTERACT_NONE};
    if (matrix_pseudo_inverse(&work->gains, &work->pseudo, &work->inverse))
        return ERR_SINGULAR;
    err = check_bounds(pairs, config, work, reason);
    if (err)
        return err;

    result->d.rows = result->d.cols = pairs->n;
    for (size_t k = 0; k < n; k++)
        for (size_t l = 0; l < n; l++)
            result->d.value[l][k] = work->inverse.value[l][k] / work->inverse.value[k][k];
    /* K D with K wrong by E is diag(gain) + E D. */
    result->left_sd = REAL_C(0.0);
    for (size_t k = 0; k < n; k++) {
        result->gain[k] = REAL_C(1.0) / work->inverse.value[k][k];
        for (size_t l = 0; l < n; l++) {
            real_t sum = REAL_C(0.0);
            for (size_t j = 0; j < n; j++)
                sum += gain_variance(plant, pairs, config->floor, k, j) * result->d.value[j][l] *
                       result->d.value[j][l];
            real_t sd = real_sqrt(sum);
            if (l == k)
                result->gain_sd[k] = sd;
            else if (sd > result->left_sd * real_abs(result->gain[k]))
                result->left_sd = sd / real_abs(result->gain[k]);
            if (!(result->left_sd <= config->left_hi))
                return refuse_element(reason, "gains", "known well enough to decouple", pairs, k,
                                      l);
        }
        if (!(real_abs(result->gain[k]) >= config->significance * result->gain_sd[k]))
            return refuse_element(reason, "gain of the decoupled loop", "sure of its sign", pairs,
                                  k, k);
    }
    *reason = (struct interact_refusal){"", "", INTERACT_NONE, INTERACT_NONE};
    return ERR_OK;
}
