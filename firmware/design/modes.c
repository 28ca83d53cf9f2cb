#include "design/modes.h"

#include "num/real_trig.h"

/* Least difference of two lags over their sum: 3 % of either. */
#define APART REAL_C(0.015)
/* A lag below this part of a sample answers within the sample. */
#define AT_ONCE REAL_C(1e-3)
/* Conjugate lags that decay by exp(-FORGOTTEN) within a sample answer within it. */
#define FORGOTTEN REAL_C(30.0)

void modes_of(const struct fopdt *element, const struct interact_shape *shape, struct modes *modes)
{
    real_t sum = element->time_constant_s, square = shape->square_s2;
    *modes = (struct modes){.lag_s = {sum, REAL_C(0.0)}, .share = REAL_C(1.0)};
    if (interact_one_lag(shape))
        return;
    modes->second = true;
    real_t split_square = REAL_C(1.0) - REAL_C(4.0) * square / (sum * sum);
    if (split_square <= -APART * APART) {
        modes->conjugate = true;
        modes->rate = sum / (REAL_C(2.0) * square);
        modes->turn = modes->rate * real_sqrt(-split_square);
        modes->share = (modes->rate - shape->zero_s / square) / modes->turn;
        return;
    }
    bool near = split_square < APART * APART;
    real_t split = near ? APART : real_sqrt(split_square);
    modes->lag_s[0] = REAL_C(0.5) * sum * (REAL_C(1.0) + split);
    modes->lag_s[1] = near ? REAL_C(0.5) * sum * (REAL_C(1.0) - split) : square / modes->lag_s[0];
    modes->share = (modes->lag_s[0] - shape->zero_s) / (modes->lag_s[0] - modes->lag_s[1]);
}

/* 1 - exp(-x), x at least 0. */
static real_t rise_of(real_t x)
{
    if (x > REAL_C(0.01))
        return REAL_C(1.0) - real_exp(-x);
    real_t sum = REAL_C(1.0); /* Taylor to x^7, from the back */
    for (int n = 7; n > 1; n--)
        sum = REAL_C(1.0) - sum * x / (real_t)n;
    return sum * x;
}

void modes_rise(const struct modes *modes, real_t time_s, real_t step_s, real_t rise[2])
{
    if (!modes->conjugate) {
        for (int m = 0; m < (modes->second ? 2 : 1); m++) {
            bool at_once = modes->lag_s[m] < AT_ONCE * step_s;
            rise[m] = at_once ? REAL_C(1.0) : rise_of(time_s / modes->lag_s[m]);
        }
        if (!modes->second)
            rise[1] = REAL_C(0.0);
        return;
    }
    rise[0] = REAL_C(1.0);
    rise[1] = REAL_C(0.0);
    if (modes->rate * step_s > FORGOTTEN)
        return;
    /* 1 - e^{-a} (cos b + i sin b), a = rate t, b = turn t */
    real_t half_sine, half_cosine, fallen = rise_of(modes->rate * time_s);
    real_sincos(REAL_C(0.5) * modes->turn * time_s, &half_sine, &half_cosine);
    real_t left = REAL_C(2.0) * (REAL_C(1.0) - fallen) * half_sine;
    rise[0] = fallen + left * half_sine;
    rise[1] = -left * half_cosine;
}

/* Real lags: the sum over both of w_i w_j r_i r_j / (r_i + r_j - r_i r_j), r = 1 - exp(-h/T). */
static real_t variance_of_real(const struct modes *modes, const real_t rise[2])
{
    real_t weight[2] = {modes->share, REAL_C(1.0) - modes->share}, sum = REAL_C(0.0);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            sum +=
                weight[i] * weight[j] * rise[i] * rise[j] / (rise[i] + rise[j] - rise[i] * rise[j]);
    return sum;
}

real_t modes_noise(const struct modes *modes, real_t interval_s)
{
    real_t rise[2], variance;
    modes_rise(modes, interval_s, interval_s, rise);
    if (!modes->second) {
        variance = rise[0] / (REAL_C(2.0) - rise[0]);
    } else if (!modes->conjugate) {
        variance = variance_of_real(modes, rise);
    } else {
        /* the same with weights 1/2 -+ i share/2 */
        struct cplx w = cplx(REAL_C(0.5), REAL_C(-0.5) * modes->share), r = cplx(rise[0], rise[1]);
        struct cplx square = cplx_mul(r, r), both = cplx_sub(cplx_scale(r, REAL_C(2.0)), square);
        struct cplx own = cplx_div(cplx_mul(cplx_mul(w, w), square), both);
        bool at_once = modes->rate * interval_s > FORGOTTEN;
        real_t kept = at_once ? REAL_C(1.0) : rise_of(REAL_C(2.0) * modes->rate * interval_s);
        real_t cross = cplx_square(w) * cplx_square(r) / kept;
        variance = REAL_C(2.0) * (cross + own.re);
    }
    return real_sqrt(variance > REAL_C(0.0) ? variance : REAL_C(0.0));
}
