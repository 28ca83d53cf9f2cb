#include "signal/lag.h"

#include "signal/check.h"

enum err lag_retune(struct lag *f, float time_constant_s, float h_s)
{
    enum err err = check_range(time_constant_s, 0.0f, 1e6f);
    if (err)
        return err;
    err = check_interval(h_s);
    if (err)
        return err;
    f->through = time_constant_s <= 0.0f;
    f->k = coefficient_from_float(h_s / (time_constant_s + h_s));
    return ERR_OK;
}

enum err lag_init(struct lag *f, float time_constant_s, float h_s)
{
    enum err err = lag_retune(f, time_constant_s, h_s);
    if (err)
        return err;
    lag_reset(f, num_zero());
    return ERR_OK;
}

void lag_reset(struct lag *f, num_t value)
{
    accumulator_set(&f->y, value);
}

num_t lag_filter(struct lag *f, num_t x)
{
    accumulator_add_product(&f->y, f->k, num_sub(x, accumulator_get(&f->y)));
    return accumulator_get(&f->y);
}
