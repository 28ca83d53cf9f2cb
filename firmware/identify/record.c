#include "identify/record.h"

#include <stddef.h>

#include "base/assertion.h"
#include "identify/common.h"
#include "lti/fopdt.h" /* real_is_finite */

#define SAMPLES_MAX (1u << 31)

_Static_assert(RECORD_POINTS >= 16 && RECORD_POINTS % 2 == 0, "points are averaged in pairs");

enum err record_init(struct record *r, uint32_t outputs, real_t h_s)
{
    if (!real_is_finite(h_s))
        return ERR_NOT_FINITE;
    if (outputs == 0 || outputs > CHANNEL_MAX || h_s < REAL_C(1e-3) || h_s > REAL_C(1e5))
        return ERR_RANGE;
    r->outputs = outputs;
    r->h_s = h_s;
    real_t none[CHANNEL_MAX] = {ZERO};
    return record_begin(r, none);
}

enum err record_begin(struct record *r, const real_t *reference)
{
    REFLUX_ASSERT(r->outputs <= CHANNEL_MAX);
    for (uint32_t o = 0; o < r->outputs; o++)
        if (!real_is_finite(reference[o]))
            return ERR_NOT_FINITE;
    for (uint32_t o = 0; o < r->outputs; o++) {
        r->reference[o] = reference[o];
        r->sum[o] = ZERO;
    }
    r->samples = 0;
    r->block = 1;
    r->points = 0;
    r->waiting = 0;
    excitation_clear(&r->input);
    return ERR_OK;
}

/* The block that was just finished is the second half of one twice as long, as there is an even number of points. */
static void halve(struct record *r)
{
    for (uint32_t o = 0; o < r->outputs; o++)
        for (uint32_t i = 0; i < RECORD_POINTS / 2; i++)
            r->y[o][i] = REAL_C(0.5) * (r->y[o][(size_t)2 * i] + r->y[o][(size_t)2 * i + 1]);
    r->points = RECORD_POINTS / 2;
    r->block *= 2;
}

enum err record_step(struct record *r, const real_t *y)
{
    REFLUX_ASSERT(r->outputs <= CHANNEL_MAX && r->points <= RECORD_POINTS && r->waiting < r->block);
    real_t d[CHANNEL_MAX] = {ZERO};
    for (uint32_t o = 0; o < r->outputs; o++) {
        d[o] = y[o] - r->reference[o];
        enum err err = check_real(d[o], -VALUE_MAX, VALUE_MAX);
        if (err)
            return err;
    }
    if (r->samples >= SAMPLES_MAX)
        return ERR_FULL;
    if (r->points == RECORD_POINTS) /* only now that there is more */
        halve(r);
    for (uint32_t o = 0; o < r->outputs; o++)
        r->sum[o] += d[o];
    r->samples++;
    r->waiting++;
    if (r->waiting == r->block) {
        for (uint32_t o = 0; o < r->outputs; o++) {
            r->y[o][r->points] = r->sum[o] / (real_t)r->block;
            r->sum[o] = ZERO;
        }
        r->points++;
        r->waiting = 0;
    }
    return ERR_OK;
}

enum err record_move(struct record *r, real_t level)
{
    if (r->samples == 0)
        return ERR_EMPTY;
    return excitation_move(&r->input, r->samples - 1, level);
}

real_t record_time(const struct record *r, uint32_t i)
{
    real_t block = (real_t)r->block;
    return ((real_t)i * block + REAL_C(0.5) * (block - REAL_C(1.0))) * r->h_s;
}

uint32_t record_first_edge(const struct record *r)
{
    return r->input.edges ? r->input.edge[0].sample : 0;
}
