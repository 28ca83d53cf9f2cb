#include "signal/pid.h"

#include <stddef.h>
#include <string.h>

#include "signal/check.h"

/* Filter of the inhibitor's slope: an eighth of the prediction time, as N = 8 does for the derivative. */
#define INHIBIT_FILTER_RATIO 8.0f

struct pid_config pid_default_config(void)
{
    return (struct pid_config){
        .gain = 1.0f,
        .n = 8.0f,
        .b = 1.0f,
        .out_hi = 1.0f,
        .action = PID_REVERSE,
        .form = PID_POSITIONAL,
    };
}

struct range {
    const char *field, *wanted;
    float lo, hi;
    /* Place of the float in struct pid_config. */
    uint8_t offset;
    /* 0 is allowed although below lo. */
    bool zero_too;
};

#define AT(field) (uint8_t) offsetof(struct pid_config, field)

static const struct range ranges[] = {
    {"gain", "1e-6 to 100", 1e-6f, 100.0f, AT(gain), false},
    {"ti_s", "0 (no integral action) or 0.01 to 1e6 s", 0.01f, 1e6f, AT(ti_s), true},
    {"td_s", "0 to 1e5 s", 0.0f, 1e5f, AT(td_s), false},
    {"n", "1 to 100", 1.0f, 100.0f, AT(n), false},
    {"b", "0 to 1", 0.0f, 1.0f, AT(b), false},
    {"c", "0 to 1", 0.0f, 1.0f, AT(c), false},
    {"tt_s", "0 (automatic) or 0.01 to 1e6 s", 0.01f, 1e6f, AT(tt_s), true},
    {"out_lo", "-127 to 127", -PID_OUTPUT_MAX, PID_OUTPUT_MAX, AT(out_lo), false},
    {"out_hi", "-127 to 127", -PID_OUTPUT_MAX, PID_OUTPUT_MAX, AT(out_hi), false},
    {"rate_per_s", "0 (no limit) or 1e-9 to 1e6 per second", 1e-9f, 1e6f, AT(rate_per_s), true},
    {"inhibit_s", "0 (off) to 1e5 s", 0.0f, 1e5f, AT(inhibit_s), false},
};

static enum err check(const struct pid_config *config, const struct range *r)
{
    float value;
    memcpy(&value, (const uint8_t *)config + r->offset, sizeof value);
    if (r->zero_too && value <= 0.0f && value >= 0.0f)
        return ERR_OK;
    return check_range(value, r->lo, r->hi);
}

enum err pid_validate(const struct pid_config *config, const char **field, const char **wanted)
{
    const char *unused;
    field = field ? field : &unused;
    wanted = wanted ? wanted : &unused;
    for (size_t i = 0; i < sizeof(ranges) / sizeof(ranges[0]); i++) {
        *field = ranges[i].field;
        *wanted = ranges[i].wanted;
        enum err err = check(config, &ranges[i]);
        if (err)
            return err;
    }
    *field = "action";
    *wanted = "0 (reverse) or 1 (direct)";
    if (config->action != PID_REVERSE && config->action != PID_DIRECT)
        return ERR_RANGE;
    *field = "form";
    *wanted = "0 (positional) or 1 (velocity)";
    if (config->form != PID_POSITIONAL && config->form != PID_VELOCITY)
        return ERR_RANGE;
    /* Ordered as num_t: limits that fall on the same step of num_t would leave no output to choose. */
    *field = "out_hi";
    *wanted = "above out_lo";
    return num_lt(num_from_float(config->out_lo), num_from_float(config->out_hi)) ? ERR_OK
                                                                                  : ERR_RANGE;
}

/* Newton from a halved exponent: 3 rounds reach float precision. x > 0, normal. */
static float square_root(float x)
{
    union {
        float f;
        uint32_t u;
    } guess = {.f = x};
    guess.u = (guess.u >> 1) + 0x1FBD1DF5u;
    for (int i = 0; i < 3; i++)
        guess.f = 0.5f * (guess.f + x / guess.f);
    return guess.f;
}

static float tracking_time(const struct pid_config *c)
{
    if (c->tt_s > 0.0f)
        return c->tt_s;
    return c->td_s > 0.0f ? square_root(c->ti_s) * square_root(c->td_s) : c->ti_s;
}

/* Sets everything that follows from settings alone; config has been validated. The state stays. */
static enum err place(struct pid *pid, const struct pid_config *config, float h_s)
{
    float signed_gain = config->action == PID_DIRECT ? -config->gain : config->gain;
    /* Without a derivative, the rest of an old one decays as before. */
    float filter_s = config->td_s > 0.0f ? config->td_s / config->n : pid->derivative_filter_s;
    enum err err = washout_retune(&pid->derivative, signed_gain, config->td_s, filter_s, h_s);
    if (err)
        return err;
    pid->derivative_filter_s = filter_s;
    float inhibit_filter_s = config->inhibit_s / INHIBIT_FILTER_RATIO;
    err = washout_retune(&pid->prediction, 1.0f, config->inhibit_s, inhibit_filter_s, h_s);
    if (err)
        return err;
    err = ramp_retune(&pid->rate, config->rate_per_s, h_s);
    if (err)
        return err;
    pid->action = config->action;
    pid->form = config->form;
    pid->derives = config->td_s > 0.0f;
    pid->inhibits = config->inhibit_s > 0.0f;
    pid->b = num_from_float(config->b);
    pid->c = num_from_float(config->c);
    pid->lo = num_from_float(config->out_lo);
    pid->hi = num_from_float(config->out_hi);
    pid->gain = coefficient_from_float(signed_gain);
    bool integrates = config->ti_s > 0.0f;
    float pull = integrates ? h_s / tracking_time(config) : 0.0f;
    pid->integral = coefficient_from_float(integrates ? signed_gain * (h_s / config->ti_s) : 0.0f);
    pid->tracking = coefficient_from_float(pull < 1.0f ? pull : 1.0f);
    return ERR_OK;
}

enum err pid_init(struct pid *pid, const struct pid_config *config, float h_s)
{
    enum err err = pid_validate(config, NULL, NULL);
    if (err)
        return err;
    err = check_interval(h_s);
    if (err)
        return err;
    *pid = (struct pid){0};
    return place(pid, config, h_s);
}

/* b r - y for the setpoint weight in force. */
static num_t proportional_in(const struct pid *pid, num_t r, num_t y)
{
    return num_sub(num_mul(pid->b, r), y);
}

static num_t derivative_in(const struct pid *pid, num_t r, num_t y)
{
    return num_sub(num_mul(pid->c, r), y);
}

/* Returns the output of the last step at full width, before limits, with the change of a back-calculation since. */
static struct accumulator whole_output(const struct pid *pid)
{
    struct accumulator whole = pid->sum;
    if (pid->form == PID_POSITIONAL) {
        accumulator_add_product(&whole, pid->gain, pid->proportional_in);
        accumulator_add_sum(&whole, &pid->derivative.d);
    }
    return whole;
}

/* Sets the integral part so that the output is `whole`, with the other parts as they are. */
static void set_whole_output(struct pid *pid, const struct accumulator *whole)
{
    pid->sum = *whole;
    if (pid->form == PID_POSITIONAL) {
        accumulator_add_product(&pid->sum, pid->gain, num_neg(pid->proportional_in));
        accumulator_take_sum(&pid->sum, &pid->derivative.d);
    }
}

enum err pid_retune(struct pid *pid, const struct pid_config *config, float h_s)
{
    enum err err = pid_validate(config, NULL, NULL);
    if (err)
        return err;
    if (!pid->primed)
        return place(pid, config, h_s);

    /* The output as a whole at full width, then split again with the new settings. The derivative stays what it is. */
    struct accumulator whole = whole_output(pid);
    bool was_blind = !pid->inhibits; /* the slope of y was not watched */
    err = place(pid, config, h_s);
    if (err)
        return err;
    pid->proportional_in = proportional_in(pid, pid->last_r, pid->last_y);
    pid->derivative.last_x = derivative_in(pid, pid->last_r, pid->last_y);
    if (was_blind || config->inhibit_s <= 0.0f)
        washout_reset(&pid->prediction, pid->last_y);
    set_whole_output(pid, &whole);
    return ERR_OK;
}

/* Returns whether the measurement is still on one side of the setpoint, but at its present slope will be on the other
 * within the prediction time: more integral would only have to be removed after it. */
static bool overshoot_ahead(struct pid *pid, num_t measurement)
{
    if (!pid->inhibits)
        return false;
    num_t error_ahead = num_sub(pid->error, washout_step(&pid->prediction, measurement));
    if (num_lt(num_zero(), pid->error))
        return num_lt(error_ahead, num_zero());
    return num_lt(pid->error, num_zero()) && num_lt(num_zero(), error_ahead);
}

num_t pid_step(struct pid *pid, num_t setpoint, num_t measurement)
{
    if (!pid->primed) /* the output in effect is unknown: start from the lowest, without a kick */
        pid_follow(pid, setpoint, measurement, pid->lo);
    num_t p = proportional_in(pid, setpoint, measurement);
    if (pid->form == PID_VELOCITY) {
        accumulator_add_product(&pid->sum, pid->gain, num_sub(p, pid->proportional_in));
        accumulator_take_sum(&pid->sum, &pid->derivative.d);
    }
    if (pid->derives || !num_eq(washout_value(&pid->derivative), num_zero()))
        (void)washout_step(&pid->derivative, derivative_in(pid, setpoint, measurement));
    if (pid->form == PID_VELOCITY)
        accumulator_add_sum(&pid->sum, &pid->derivative.d);
    pid->error = num_sub(setpoint, measurement);
    pid->inhibited = overshoot_ahead(pid, measurement);
    pid->proportional_in = p;
    pid->last_r = setpoint;
    pid->last_y = measurement;
    struct accumulator whole = whole_output(pid);
    pid->raw = accumulator_get(&whole);
    pid->output = ramp_step(&pid->rate, num_clamp(pid->raw, pid->lo, pid->hi));
    return pid->output;
}

/* Tracks from the whole output, not from raw, because raw ends with the range of num_t and back-calculation must not. */
static void track(struct pid *pid, num_t applied)
{
    if (num_eq(applied, pid->raw))
        return; /* exactly nothing, whatever is finer than num_t */
    struct accumulator whole = whole_output(pid), gap;
    accumulator_set(&gap, applied);
    accumulator_take_sum(&gap, &whole);
    accumulator_add_scaled(&pid->sum, pid->tracking, &gap);
}

void pid_back_calculate(struct pid *pid, num_t applied, uint8_t clamp)
{
    if (!pid->primed)
        return;
    if (pid->form == PID_POSITIONAL)
        track(pid, applied);
    else if (!num_eq(pid->output, pid->raw))
        accumulator_set(&pid->sum, applied);
    else /* as a difference, so that what is finer than num_t survives */
        accumulator_add(&pid->sum, num_sub(applied, pid->raw));

    bool up = num_lt(num_zero(), pid->error) == (pid->action == PID_REVERSE);
    uint8_t against = up ? INTEGRAL_CLAMP_UP : INTEGRAL_CLAMP_DOWN;
    if (!(clamp & against) && !pid->inhibited)
        accumulator_add_product(&pid->sum, pid->integral, pid->error);

    if (!num_eq(applied, pid->output)) {
        ramp_reset(&pid->rate, applied);
        pid->output = applied;
    }
}

void pid_follow(struct pid *pid, num_t setpoint, num_t measurement, num_t applied)
{
    pid->proportional_in = proportional_in(pid, setpoint, measurement);
    washout_reset(&pid->derivative, derivative_in(pid, setpoint, measurement));
    washout_reset(&pid->prediction, measurement);
    ramp_reset(&pid->rate, applied);
    accumulator_set(&pid->sum, applied);
    if (pid->form == PID_POSITIONAL)
        accumulator_add_product(&pid->sum, pid->gain, num_neg(pid->proportional_in));
    pid->last_r = setpoint;
    pid->last_y = measurement;
    pid->error = num_sub(setpoint, measurement);
    pid->raw = applied;
    pid->output = applied;
    pid->inhibited = false;
    pid->primed = true;
}

void pid_shift(struct pid *pid, num_t applied)
{
    if (num_eq(pid->raw, pid->output)) {
        accumulator_add(&pid->sum, applied);
        accumulator_add(&pid->sum, num_neg(pid->raw));
    } else {
        struct accumulator whole;
        accumulator_set(&whole, applied);
        set_whole_output(pid, &whole);
    }
    ramp_reset(&pid->rate, applied);
    pid->raw = applied;
    pid->output = applied;
}
