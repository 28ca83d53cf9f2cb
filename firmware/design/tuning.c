#include "design/tuning.h"

static enum err refuse_tuning(struct tuning_refusal *reason, const char *field, const char *wanted,
                              enum err err)
{
    if (reason)
        *reason = (struct tuning_refusal){field, wanted};
    return err;
}

static enum err check_time(const char *field, const char *wanted, real_t value, real_t hi,
                           struct tuning_refusal *reason)
{
    if (!real_is_finite(value))
        return refuse_tuning(reason, field, wanted, ERR_NOT_FINITE);
    return value < REAL_C(0.0) || value > hi ? refuse_tuning(reason, field, wanted, ERR_RANGE)
                                             : ERR_OK;
}

static enum err check_model(const struct fopdt *model, struct tuning_refusal *reason)
{
    const char *field, *wanted;
    enum err err = fopdt_validate(model, &field, &wanted);
    if (err)
        return refuse_tuning(reason, field, wanted, err);
    if (model->gain <= REAL_C(0.0) && model->gain >= REAL_C(0.0))
        return refuse_tuning(reason, "gain", "not 0: an input without effect cannot control",
                             ERR_RANGE);
    return ERR_OK;
}

static enum err check_dead_time(const struct fopdt *model, struct tuning_refusal *reason)
{
    if (model->dead_time_s > REAL_C(0.0))
        return ERR_OK;
    return refuse_tuning(reason, "dead_time_s", "above 0 s: the rule divides by it (SIMC takes 0)",
                         ERR_RANGE);
}

/* Action from the sign of the model, and nothing given out that is not a positive finite number. */
static enum err hand_over(const struct fopdt *model, real_t gain, real_t ti_s, real_t td_s,
                          struct tuning *result, struct tuning_refusal *reason)
{
    gain = real_abs(gain);
    if (!real_is_finite(gain) || gain <= REAL_C(0.0))
        return refuse_tuning(reason, "gain", "such that the controller gain can be represented",
                             ERR_RANGE);
    if (!real_is_finite(ti_s) || ti_s <= REAL_C(0.0))
        return refuse_tuning(reason, "dead_time_s",
                             "such that the integral time can be represented", ERR_RANGE);
    *result = (struct tuning){
        .gain = gain,
        .ti_s = ti_s,
        .td_s = td_s,
        .action = model->gain < REAL_C(0.0) ? TUNING_DIRECT : TUNING_REVERSE,
    };
    return ERR_OK;
}

enum err tuning_cohen_coon_pi(const struct fopdt *model, struct tuning *result,
                              struct tuning_refusal *reason)
{
    enum err err = check_model(model, reason);
    if (err)
        return err;
    err = check_dead_time(model, reason);
    if (err)
        return err;
    real_t td = model->dead_time_s;
    real_t rho = td / model->time_constant_s;
    real_t gain = (REAL_C(0.9) + rho / REAL_C(12.0)) / (model->gain * rho);
    real_t ti = td * ((REAL_C(30.0) + REAL_C(3.0) * rho) / (REAL_C(9.0) + REAL_C(20.0) * rho));
    return hand_over(model, gain, ti, REAL_C(0.0), result, reason);
}

enum err tuning_cohen_coon_pid(const struct fopdt *model, struct tuning *result,
                               struct tuning_refusal *reason)
{
    enum err err = check_model(model, reason);
    if (err)
        return err;
    err = check_dead_time(model, reason);
    if (err)
        return err;
    real_t td = model->dead_time_s;
    real_t rho = td / model->time_constant_s;
    real_t gain = (REAL_C(4.0) / REAL_C(3.0) + rho / REAL_C(4.0)) / (model->gain * rho);
    real_t ti = td * ((REAL_C(32.0) + REAL_C(6.0) * rho) / (REAL_C(13.0) + REAL_C(8.0) * rho));
    real_t derivative = td * (REAL_C(4.0) / (REAL_C(11.0) + REAL_C(2.0) * rho));
    return hand_over(model, gain, ti, derivative, result, reason);
}

enum err tuning_simc_pid(const struct fopdt *model, real_t tau2_s, real_t tau_c_s,
                         struct tuning *result, struct tuning_refusal *reason)
{
    enum err err = check_model(model, reason);
    if (err)
        return err;
    err = check_time("tau2_s", "0 to the time constant, s", tau2_s, model->time_constant_s, reason);
    if (err)
        return err;
    err = check_time("tau_c_s", "0 to 1e6 s", tau_c_s, REAL_C(1e6), reason);
    if (err)
        return err;
    real_t closed = tau_c_s + model->dead_time_s;
    if (closed <= REAL_C(0.0))
        return refuse_tuning(reason, "tau_c_s", "above 0 s where the model has no dead time",
                             ERR_RANGE);
    real_t gain = model->time_constant_s / (model->gain * closed);
    real_t ti = REAL_C(4.0) * closed;
    if (model->time_constant_s < ti)
        ti = model->time_constant_s;
    real_t f = REAL_C(1.0) + tau2_s / ti;
    return hand_over(model, gain * f, ti * f, tau2_s / f, result, reason);
}

enum err tuning_simc_pi(const struct fopdt *model, real_t tau_c_s, struct tuning *result,
                        struct tuning_refusal *reason)
{
    return tuning_simc_pid(model, REAL_C(0.0), tau_c_s, result, reason);
}

enum err tuning_tyreus_luyben_pi(real_t gain, real_t period_s, struct tuning *result,
                                 struct tuning_refusal *reason)
{
    const char *either = "1e-6 to 1e6, of either sign", *period = "1e-6 to 1e6 s";
    if (!real_is_finite(gain))
        return refuse_tuning(reason, "gain", either, ERR_NOT_FINITE);
    if (!(real_abs(gain) >= REAL_C(1e-6) && real_abs(gain) <= REAL_C(1e6)))
        return refuse_tuning(reason, "gain", either, ERR_RANGE);
    if (!real_is_finite(period_s))
        return refuse_tuning(reason, "period_s", period, ERR_NOT_FINITE);
    if (!(period_s >= REAL_C(1e-6) && period_s <= REAL_C(1e6)))
        return refuse_tuning(reason, "period_s", period, ERR_RANGE);
    *result = (struct tuning){
        .gain = real_abs(gain) / REAL_C(3.2),
        .ti_s = REAL_C(2.2) * period_s,
        .action = gain < REAL_C(0.0) ? TUNING_DIRECT : TUNING_REVERSE,
    };
    return ERR_OK;
}
