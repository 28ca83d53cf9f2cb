#include "interact/direction.h"

#include "base/assertion.h"
#include "base/error.h"

NOT_INLINE real_t direction_sd(const struct interact_plant *plant, size_t output, size_t input,
                               real_t floor)
{
    real_t sd = plant->gain_sd[output][input], part = floor * plant->element[output][input].gain;
    return real_sqrt(sd * sd + part * part);
}

/* Variance of the sum along the direction before the test; *error: of the measured sum, squared. */
NOT_INLINE static real_t variance_along(const struct interact_plant *plant, size_t output,
                                        real_t floor, real_t *error)
{
    REFLUX_ASSERT(output < INTERACT_MAX && plant->inputs <= INTERACT_MAX);
    real_t variance = REAL_C(0.0), sum = REAL_C(0.0);
    for (size_t k = 0; k < plant->inputs; k++) {
        real_t part = plant->share[k] * direction_sd(plant, output, k, floor);
        variance += part * part;
        sum += plant->share[k] * plant->element[output][k].gain;
    }
    real_t sd = plant->along_sd[output], part = floor * sum;
    *error = sd * sd + part * part;
    return variance;
}

static bool is_measured(const struct interact_plant *plant, size_t output)
{
    REFLUX_ASSERT(output < INTERACT_MAX);
    return plant->along_sd[output] > REAL_C(0.0);
}

void direction_take(struct interact_plant *plant, size_t output, real_t floor, real_t measured,
                    real_t sd)
{
    REFLUX_ASSERT(output < plant->outputs && plant->outputs <= INTERACT_MAX);
    if (!real_is_finite(measured) || !real_is_finite(sd) || !(sd > REAL_C(0.0)))
        return;
    real_t gain[INTERACT_MAX], left = measured, error, part = floor * measured;
    real_t variance = variance_along(plant, output, floor, &error);
    if (!(variance > REAL_C(0.0)))
        return;
    error = sd * sd + part * part;
    for (size_t k = 0; k < plant->inputs; k++)
        left -= plant->share[k] * plant->element[output][k].gain;
    for (size_t k = 0; k < plant->inputs; k++) {
        real_t own = direction_sd(plant, output, k, floor);
        gain[k] = plant->element[output][k].gain +
                  plant->share[k] * own * own / (variance + error) * left;
    }
    for (size_t k = 0; k < plant->inputs; k++)
        plant->element[output][k].gain = gain[k];
    plant->along_sd[output] = sd;
}

void direction_correct(const struct interact_plant *plant, size_t output, real_t floor,
                       real_t *errors)
{
    real_t error, sum = REAL_C(0.0);
    if (!is_measured(plant, output))
        return;
    real_t variance = variance_along(plant, output, floor, &error);
    if (!(variance > REAL_C(0.0)))
        return;
    for (size_t k = 0; k < plant->inputs; k++)
        sum += plant->share[k] * errors[k];
    real_t kept = real_sqrt(error / (variance + error)); /* share of that sum */
    for (size_t k = 0; k < plant->inputs; k++) {
        real_t own = direction_sd(plant, output, k, floor);
        errors[k] -= (REAL_C(1.0) - kept) * plant->share[k] * own * own / variance * sum;
    }
}

bool direction_common(const struct interact_plant *plant, size_t output, real_t floor, real_t *q)
{
    real_t error, variance = variance_along(plant, output, floor, &error);
    bool common = is_measured(plant, output) && variance > REAL_C(0.0);
    for (size_t k = 0; k < plant->inputs; k++) {
        real_t own = direction_sd(plant, output, k, floor);
        q[k] = common ? plant->share[k] * own * own / real_sqrt(variance + error) : REAL_C(0.0);
    }
    return common;
}

void direction_draw(const struct interact_plant *plant, size_t output, real_t floor,
                    struct random *random, real_t *gains)
{
    for (size_t k = 0; k < plant->inputs; k++)
        gains[k] = direction_sd(plant, output, k, floor) * random_normal(random);
    direction_correct(plant, output, floor, gains);
    for (size_t k = 0; k < plant->inputs; k++)
        gains[k] += plant->element[output][k].gain;
}
