#include "signal/ramp.h"

#include "signal/check.h"

enum err ramp_retune(struct ramp *f, float rate_per_s, float h_s)
{
    enum err err = check_range(rate_per_s, 0.0f, 1e6f);
    if (err)
        return err;
    if (rate_per_s > 0.0f && rate_per_s < 1e-9f)
        return ERR_RANGE;
    err = check_interval(h_s);
    if (err)
        return err;
    float step = rate_per_s * h_s;
    f->jump = rate_per_s <= 0.0f || step > 100.0f;
    f->step = coefficient_from_float(step);
    f->reach = num_from_float(step);
    return ERR_OK;
}

enum err ramp_init(struct ramp *f, float rate_per_s, float h_s)
{
    enum err err = ramp_retune(f, rate_per_s, h_s);
    if (err)
        return err;
    ramp_reset(f, num_zero());
    return ERR_OK;
}

void ramp_reset(struct ramp *f, num_t value)
{
    accumulator_set(&f->position, value);
}

num_t ramp_limit(struct ramp *f, num_t target)
{
    num_t distance = num_sub(target, accumulator_get(&f->position));
    if (num_lt(f->reach, num_abs(distance)))
        accumulator_add_product(&f->position, f->step,
                                num_lt(distance, num_zero()) ? num_neg(num_one()) : num_one());
    else
        accumulator_set(&f->position, target);
    return accumulator_get(&f->position);
}
