#include "signal/lead_lag.h"

#include "signal/check.h"

enum err lead_lag_retune(struct lead_lag *f, float lead_s, float lag_s, float h_s)
{
    enum err err = check_range(lead_s, 0.0f, 1e6f);
    if (err)
        return err;
    err = check_range(lag_s, 0.0f, 1e6f);
    if (err)
        return err;
    err = check_interval(h_s);
    if (err)
        return err;
    float lead = lead_s / (lag_s + h_s);
    if (lead > LEAD_LAG_MAX_RATIO)
        return ERR_RANGE;
    f->through = !(lead_s < lag_s) && !(lead_s > lag_s);
    f->k = coefficient_from_float(h_s / (lag_s + h_s));
    f->lead = coefficient_from_float(lead);
    return ERR_OK;
}

enum err lead_lag_init(struct lead_lag *f, float lead_s, float lag_s, float h_s)
{
    enum err err = lead_lag_retune(f, lead_s, lag_s, h_s);
    if (err)
        return err;
    lead_lag_reset(f, num_zero());
    return ERR_OK;
}

void lead_lag_reset(struct lead_lag *f, num_t value)
{
    accumulator_set(&f->y, value);
    f->last_x = value;
}

num_t lead_lag_step(struct lead_lag *f, num_t x)
{
    if (f->through) {
        accumulator_set(&f->y, x);
    } else {
        num_t behind = num_sub(x, accumulator_get(&f->y));
        accumulator_add_product(&f->y, f->k, behind);
        accumulator_add_product(&f->y, f->lead, num_sub(x, f->last_x));
    }
    f->last_x = x;
    return accumulator_get(&f->y);
}
