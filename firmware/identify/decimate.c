#include "identify/decimate.h"

#include <string.h>

#include "identify/common.h"
#include "num/real_trig.h"

#define PI   REAL_C(3.14159265358979324)
#define ROOT REAL_C(1.41421356237309505)

enum err decimator_init(struct decimator *d, uint32_t ratio, real_t cutoff)
{
    bool filters = cutoff < ZERO || cutoff > ZERO;
    enum err err = check_real(cutoff, filters ? REAL_C(0.01) : ZERO, ONE);
    if (err || ratio < 1 || ratio > 10000)
        return err ? err : ERR_RANGE;
    memset(d, 0, sizeof *d);
    d->ratio = (uint16_t)ratio;
    if (ratio == 1 || !filters)
        return ERR_OK;
    real_t sine, cosine;
    real_sincos(PI * cutoff / (TWO * (real_t)ratio), &sine, &cosine);
    d->k = sine / cosine;
    d->share = ONE / (ONE + d->k * (d->k + ROOT));
    return ERR_OK;
}

static real_t filtered_sample(struct decimator *d, real_t x)
{
    real_t between = d->share * (d->speed + d->k * (x - d->level));
    real_t low = d->level + d->k * between;
    d->speed = TWO * between - d->speed;
    d->level = TWO * low - d->level;
    return low;
}

bool decimator_step(struct decimator *d, real_t x, real_t *kept)
{
    if (!d->begun)
        d->level = x;
    real_t low = d->k > ZERO ? filtered_sample(d, x) : x;
    bool due = !d->begun || d->count + 1u >= d->ratio;
    d->begun = true;
    d->count = due ? 0 : (uint16_t)(d->count + 1u);
    if (due)
        *kept = low;
    return due;
}
