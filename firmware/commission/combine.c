#include "commission/combine.h"

#include "commission/certainty.h"

static real_t weight(real_t sd, real_t size)
{
    real_t floor = REAL_C(1e-4) * real_abs(size) + REAL_C(1e-9);
    real_t used = sd > floor ? sd : floor;
    return REAL_C(1.0) / (used * used);
}

static real_t mean_of(real_t a, real_t wa, real_t b, real_t wb)
{
    return (wa * a + wb * b) / (wa + wb);
}

/* The element has times that count: without a visible lag their deviations say nothing, however small. */
static bool has_times(const struct identified *e)
{
    return !(e->flags & IDENTIFIED_NO_GAIN) && e->time_constant_s > REAL_C(0.0) &&
           e->time_constant_sd_s > REAL_C(0.0);
}

real_t combine_by_gains(real_t a, const struct identified *of_a, real_t b,
                        const struct identified *of_b)
{
    return mean_of(a, weight(of_a->gain_sd, of_a->gain), b, weight(of_b->gain_sd, of_b->gain));
}

void model_combine(struct identified *sum, const struct identified *next)
{
    real_t ws = weight(sum->gain_sd, sum->gain), wn = weight(next->gain_sd, next->gain);
    real_t sd = REAL_C(1.0) / real_sqrt(ws + wn);
    /* Rounds that disagree by more than their deviations allow are less certain than they claim (Birge 1932). */
    real_t apart = sum->gain - next->gain;
    real_t allowed = sum->gain_sd * sum->gain_sd + next->gain_sd * next->gain_sd;
    if (apart * apart > allowed && allowed > REAL_C(0.0))
        sd *= real_abs(apart) / real_sqrt(allowed);
    bool times_s = has_times(sum), times_n = has_times(next);
    real_t gain = mean_of(sum->gain, ws, next->gain, wn);
    if (times_s && times_n) {
        real_t wt = weight(sum->time_constant_sd_s, sum->time_constant_s);
        real_t wu = weight(next->time_constant_sd_s, next->time_constant_s);
        sum->time_constant_s = mean_of(sum->time_constant_s, wt, next->time_constant_s, wu);
        sum->time_constant_sd_s = REAL_C(1.0) / real_sqrt(wt + wu);
        real_t wl = weight(sum->dead_time_sd_s, sum->dead_time_s);
        real_t wm = weight(next->dead_time_sd_s, next->dead_time_s);
        sum->dead_time_s = mean_of(sum->dead_time_s, wl, next->dead_time_s, wm);
        sum->dead_time_sd_s = REAL_C(1.0) / real_sqrt(wl + wm);
    } else if (times_n) {
        real_t old_gain = sum->gain, old_sd = sum->gain_sd;
        *sum = *next;
        sum->gain = old_gain; /* replaced below; only the times were missing */
        sum->gain_sd = old_sd;
    }
    sum->gain = gain;
    sum->gain_sd = sd;
    if (real_abs(gain) > REAL_C(3.0) * sd && (times_s || times_n))
        sum->flags &= (uint16_t)~IDENTIFIED_NO_GAIN;
    sum->flags |= (uint16_t)(next->flags & ~IDENTIFIED_NO_GAIN);
    if (!(next->flags & IDENTIFIED_NO_GAIN)) /* it resolves what an earlier test left open */
        sum->flags &= (uint16_t)(next->flags | ~(unsigned)CERTAINTY_FLAGS | CERTAINTY_FINAL_FLAGS);
}
