#include "design/first_order.h"

#include "design/modes.h"

/* A shorter lag is cancelled in place of the longer one where the zero is that much nearer to it. */
#define NEAR REAL_C(1.6)
/* The lag that is left is at least this part of the sum of lags. */
#define LAG_LEAST REAL_C(0.1)

/* Returns which of the two lags a zero above 0 is cancelled against: the next longer one, or the shorter one where there is
 * no longer one or the zero is close to the shorter one. */
static int cancelled_lag(const real_t lag_s[2], real_t zero_s)
{
    if (zero_s >= lag_s[0])
        return 0;
    if (zero_s <= lag_s[1])
        return 1;
    bool shorter =
        lag_s[1] > REAL_C(0.0) && zero_s / lag_s[1] < lag_s[0] / zero_s && zero_s / lag_s[1] < NEAR;
    return shorter ? 1 : 0;
}

/* (zero s + 1)/(lag s + 1) as gain/(*lag s + 1): Skogestad's rules T1 to T3. */
static real_t cancel_zero(real_t *lag_s, real_t zero_s, real_t tau_c_s)
{
    real_t lag = *lag_s;
    *lag_s = REAL_C(0.0);
    if (zero_s >= lag) {
        real_t least = lag > tau_c_s ? lag : tau_c_s;
        return zero_s > least && least > REAL_C(0.0) ? zero_s / least : REAL_C(1.0);
    }
    if (zero_s >= REAL_C(5.0) * tau_c_s)
        return zero_s / lag;
    real_t shorter = lag < REAL_C(5.0) * tau_c_s ? lag : REAL_C(5.0) * tau_c_s;
    *lag_s = shorter - zero_s;
    return shorter / lag;
}

struct fopdt first_order_of(const struct fopdt *element, const struct interact_shape *shape)
{
    struct fopdt model = *element;
    if (interact_one_lag(shape))
        return model;
    struct modes modes;
    modes_of(element, shape, &modes);
    real_t sum = element->time_constant_s, lag_s[2] = {modes.lag_s[0], modes.lag_s[1]};
    if (modes.conjugate) {
        real_t late = shape->square_s2 / sum;
        model.dead_time_s += late;
        lag_s[0] = sum > late ? sum - late : REAL_C(0.0);
        lag_s[1] = REAL_C(0.0);
    }
    if (shape->zero_s > REAL_C(0.0)) {
        real_t tau_c_s = model.dead_time_s + REAL_C(0.5) * lag_s[1];
        model.gain *=
            cancel_zero(&lag_s[cancelled_lag(lag_s, shape->zero_s)], shape->zero_s, tau_c_s);
    } else {
        model.dead_time_s -= shape->zero_s;
    }
    bool first_longer = lag_s[0] > lag_s[1];
    real_t longer = first_longer ? lag_s[0] : lag_s[1],
           shorter = first_longer ? lag_s[1] : lag_s[0];
    model.time_constant_s = longer + REAL_C(0.5) * shorter;
    model.dead_time_s += REAL_C(0.5) * shorter;
    if (model.time_constant_s < LAG_LEAST * sum)
        model.time_constant_s = LAG_LEAST * sum;
    return model;
}
