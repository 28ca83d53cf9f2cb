#include "identify/settling.h"

#include <stdbool.h>

#include "base/assertion.h"
#include "identify/common.h"

#define BAND REAL_C(0.02)
/* The band stands this far above the noise of what is held against it. */
#define NOISE_SDS REAL_C(4.0)
#define LN_50     REAL_C(3.912023005)

/* Mean of the count points from at. */
static real_t mean_of_points(const real_t *y, uint32_t at, uint32_t count)
{
    real_t sum = ZERO;
    for (uint32_t i = 0; i < count; i++)
        sum += y[at + i];
    return sum / (real_t)count;
}

/* Sum of squared successive differences. */
static real_t differences(const real_t *y, uint32_t at, uint32_t count)
{
    real_t sum = ZERO;
    for (uint32_t i = 1; i < count; i++)
        sum += (y[at + i] - y[at + i - 1]) * (y[at + i] - y[at + i - 1]);
    return sum;
}

static bool still_moves(const real_t *y, uint32_t at, uint32_t count, real_t noise, real_t change)
{
    real_t middle = REAL_C(0.5) * (real_t)(count - 1), cross = ZERO, spread = ZERO;
    for (uint32_t i = 0; i < count; i++) {
        real_t t = (real_t)i - middle;
        cross += t * y[at + i];
        spread += t * t;
    }
    real_t climb = real_abs(cross / spread) * (real_t)count;
    real_t sd = noise * (real_t)count / real_sqrt(spread);
    return climb > REAL_C(0.5) * BAND * change + REAL_C(3.0) * sd;
}

enum err settling_from_record(const struct record *r, uint32_t output, struct settling *result)
{
    REFLUX_ASSERT(r->outputs <= CHANNEL_MAX && r->points <= RECORD_POINTS);
    if (output >= r->outputs)
        return ERR_RANGE;
    if (r->input.edges != 1)
        return ERR_STATE;
    const real_t *y = r->y[output];
    uint32_t edge = r->input.edge[0].sample;
    uint32_t before = (edge + 1) / r->block; /* whole points that have not seen it */
    if (before < 4 || r->points < before + 16)
        return ERR_EMPTY;
    uint32_t last = (r->points - before) / 4, from = r->points - last;
    real_t initial = mean_of_points(y, 0, before), final = mean_of_points(y, from, last);
    real_t noise = real_sqrt((differences(y, 0, before) + differences(y, from, last)) /
                             (TWO * (real_t)(before + last - 2)));
    real_t change = real_abs(final - initial);
    /* Neighbours are averaged until the band stands out of the noise. */
    real_t wanted = NOISE_SDS * noise / (BAND * change), count = wanted * wanted;
    uint32_t most = (r->points - before) / 16;
    if (!(count < (real_t)most))
        return ERR_RANGE;
    if (still_moves(y, from, last, noise, change))
        return ERR_STATE;
    uint32_t n = 1u + (uint32_t)count;
    real_t outside = ZERO, inside = ZERO, at = (real_t)edge;
    bool found = false;
    for (uint32_t i = from; i > before && !found; i--) {
        real_t here = real_abs(mean_of_points(y, i - 1, n) - final);
        if (here > BAND * change) {
            outside = here;
            real_t part = (outside - BAND * change) / (outside - inside);
            at =
                ((real_t)(i - 1) + part + REAL_C(0.5) * (real_t)n) * (real_t)r->block - REAL_C(0.5);
            found = true;
        }
        inside = here;
    }
    real_t t_98 = (at - (real_t)edge) * r->h_s;
    if (!found || !(t_98 > ZERO)) /* faster than a point of the record */
        return ERR_RANGE;
    *result = (struct settling){
        .change = final - initial,
        .t_98_s = t_98,
        .omega_per_s = REAL_C(4.0) / t_98,
        .noise_sd = noise,
        .mean_of = n,
    };
    return ERR_OK;
}

enum err settling_from_model(const struct identified *model, real_t *t_98_s, real_t *omega_per_s)
{
    enum err err = check_real(model->time_constant_s, ZERO, REAL_C(1e9));
    if (!err)
        err = check_real(model->dead_time_s, ZERO, REAL_C(1e9));
    if (err)
        return err;
    real_t t_98 = model->dead_time_s + LN_50 * model->time_constant_s;
    if (!(t_98 > ZERO))
        return ERR_RANGE;
    *t_98_s = t_98;
    *omega_per_s = REAL_C(4.0) / t_98;
    return ERR_OK;
}
