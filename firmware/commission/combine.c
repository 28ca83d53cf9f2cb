#include "commission/combine.h"

#include "base/assertion.h"

/* Least lag, over the one that is joined by itself, that a residence time may leave. */
#define LAG_LEFT REAL_C(0.2)

static bool is_known(const struct shape_found *f)
{
    return f->kind != SHAPE_UNKNOWN && f->kind != SHAPE_SLOW && f->kind != SHAPE_PERHAPS_SLOW &&
           f->kind != SHAPE_NO_RESPONSE;
}

static bool is_ramp(const struct shape_found *f)
{
    return f->kind == SHAPE_INTEGRATING;
}

static real_t weight(real_t sd, real_t size)
{
    real_t floor = REAL_C(1e-4) * real_abs(size) + REAL_C(1e-9);
    real_t used = sd > floor ? sd : floor;
    return REAL_C(1.0) / (used * used);
}

/* Tests that disagree by more than their deviations allow are less certain than they claim (Birge 1932). */
static real_t disagreement(real_t a, real_t a_sd, real_t b, real_t b_sd)
{
    real_t apart = a - b, allowed = a_sd * a_sd + b_sd * b_sd;
    return apart * apart > allowed && allowed > REAL_C(0.0) ? real_abs(apart) / real_sqrt(allowed)
                                                            : REAL_C(1.0);
}

static void join(real_t *value, real_t *sd, real_t next, real_t next_sd)
{
    real_t a = weight(*sd, *value), b = weight(next_sd, next);
    real_t wider = disagreement(*value, *sd, next, next_sd);
    *value = (a * *value + b * next) / (a + b);
    *sd = wider / real_sqrt(a + b);
}

/* Relative variance of gain and residence time together. */
static real_t unsureness(const struct shape_found *f)
{
    real_t gain = f->sd[SHAPE_GAIN], time = f->residence_sd_s;
    real_t size = real_abs(f->shape.gain), lasts = f->shape.dead_time_s + f->shape.lag_s;
    gain = size > REAL_C(0.0) ? gain / size : REAL_C(1e6);
    time = lasts > REAL_C(0.0) ? time / lasts : REAL_C(0.0);
    return gain * gain + time * time;
}

/* The residence time is what every test knows best: it is joined by itself, and the lag is what dead time and zero leave of it. */
static void join_times(struct shape_found *sum, const struct shape_found *next)
{
    real_t before = shape_residence_s(&sum->shape), after = shape_residence_s(&next->shape);
    real_t a = weight(sum->residence_sd_s, before), b = weight(next->residence_sd_s, after);
    real_t wider = disagreement(before, sum->residence_sd_s, after, next->residence_sd_s);
    join(&sum->shape.dead_time_s, &sum->sd[SHAPE_DEAD], next->shape.dead_time_s,
         next->sd[SHAPE_DEAD]);
    join(&sum->shape.lag_s, &sum->sd[SHAPE_LAG], next->shape.lag_s, next->sd[SHAPE_LAG]);
    if (sum->parameters > 3)
        join(&sum->shape.square_s2, &sum->sd[SHAPE_SQUARE], next->shape.square_s2,
             next->sd[SHAPE_SQUARE]);
    if (sum->parameters > 4)
        join(&sum->shape.zero_s, &sum->sd[SHAPE_ZERO], next->shape.zero_s, next->sd[SHAPE_ZERO]);
    sum->residence_sd_s = wider / real_sqrt(a + b);
    real_t lag = (a * before + b * after) / (a + b) - sum->shape.dead_time_s + sum->shape.zero_s;
    if (!is_ramp(sum) && lag > LAG_LEFT * sum->shape.lag_s)
        sum->shape.lag_s = lag;
    a = weight(sum->residence_drawn_sd_s, before);
    b = weight(next->residence_drawn_sd_s, after);
    sum->residence_drawn_sd_s = wider / real_sqrt(a + b);
}

/* Gives a ramp another lag that stands for the integrator (lti/shape.h), which is as long as the record of its test asks. The
 * slope, gain over lag, stays. */
static void take_long_lag(struct shape_found *ramp, real_t lag_s)
{
    REFLUX_ASSERT(ramp->shape.lag_s > REAL_C(0.0));
    real_t part = lag_s / ramp->shape.lag_s;
    ramp->shape.lag_s = lag_s;
    ramp->shape.gain *= part;
    ramp->sd[SHAPE_GAIN] *= part;
    ramp->shape.square_s2 *= part;
    ramp->sd[SHAPE_SQUARE] *= part;
}

/* Both are ramps, or neither is. The other plausible shape and the correlations are those of the surer test, because a small
 * step leaves open what a larger one decides. */
static void join_known(struct shape_found *sum, const struct shape_found *next)
{
    struct shape_found other = *next;
    if (unsureness(next) < unsureness(sum)) {
        other = *sum;
        *sum = *next;
    }
    if (is_ramp(&other))
        take_long_lag(&other, sum->shape.lag_s);
    join(&sum->shape.gain, &sum->sd[SHAPE_GAIN], other.shape.gain, other.sd[SHAPE_GAIN]);
    if (sum->parameters == other.parameters && is_ramp(sum) == is_ramp(&other))
        join_times(sum, &other);
}

/* Joins two tests that are both perhaps slow. Each has seen a shape to its end, so the element is known. */
static void join_doubtful(struct shape_found *sum, const struct shape_found *next)
{
    static const uint8_t kinds[] = {SHAPE_ONE_LAG, SHAPE_TWO_LAGS, SHAPE_TWO_WITH_ZERO};
    join_known(sum, next);
    REFLUX_ASSERT(sum->parameters >= 3 && sum->parameters <= 5);
    sum->kind = kinds[sum->parameters - 3u];
}

void combine_shapes(struct shape_found *sum, const struct shape_found *next, bool longer)
{
    if (is_known(next)) {
        if (is_known(sum) && is_ramp(sum) == is_ramp(next))
            join_known(sum, next);
        else
            *sum = *next;
    } else if (next->kind == SHAPE_NO_RESPONSE) {
        if (sum->kind == SHAPE_NO_RESPONSE)
            join(&sum->shape.gain, &sum->sd[SHAPE_GAIN], next->shape.gain, next->sd[SHAPE_GAIN]);
        else if (!is_known(sum) && longer)
            *sum = *next;
    } else if (next->kind == SHAPE_PERHAPS_SLOW && sum->kind == SHAPE_PERHAPS_SLOW) {
        join_doubtful(sum, next);
    } else if (!is_known(sum) || next->kind == SHAPE_SLOW) {
        *sum = *next;
    }
}
