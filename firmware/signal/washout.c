#include "signal/washout.h"

#include "signal/check.h"

enum err washout_retune(struct washout *f, float scale, float td_s, float tf_s, float h_s)
{
    enum err err = check_range(scale, -1e6f, 1e6f);
    if (err)
        return err;
    err = check_range(td_s, 0.0f, 1e6f);
    if (err)
        return err;
    err = check_range(tf_s, 0.0f, 1e6f);
    if (err)
        return err;
    err = check_interval(h_s);
    if (err)
        return err;
    f->gain = coefficient_from_float(scale * (td_s / (tf_s + h_s)));
    f->decay = coefficient_from_float(-h_s / (tf_s + h_s));
    return ERR_OK;
}

enum err washout_init(struct washout *f, float scale, float td_s, float tf_s, float h_s)
{
    enum err err = washout_retune(f, scale, td_s, tf_s, h_s);
    if (err)
        return err;
    washout_reset(f, num_zero());
    return ERR_OK;
}

void washout_reset(struct washout *f, num_t x)
{
    accumulator_set(&f->d, num_zero());
    f->last_x = x;
}

num_t washout_step(struct washout *f, num_t x)
{
    struct accumulator before = f->d;
    accumulator_add_scaled(&f->d, f->decay, &before);
    accumulator_add_product(&f->d, f->gain, num_sub(x, f->last_x));
    f->last_x = x;
    return accumulator_get(&f->d);
}

num_t washout_value(const struct washout *f)
{
    return accumulator_get(&f->d);
}
