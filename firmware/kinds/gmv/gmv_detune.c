#include "kinds/gmv/gmv_detune.h"

#include <string.h>

#include "base/assertion.h"
#include "kinds/gmv/gmv_detune_state.h"

/* From one multiple to the next. */
#define FACTOR 1.41421356f
/* Moves caused by sensor noise count as many times (mean squares), because the parameters will change, and a law that goes back to
 * the PI a day later has won nothing. */
#define NOISE_MARGIN 2.0f
/* Two ratios within this factor are equal: the search then takes the larger lambda, which moves the MV less. */
#define AS_GOOD 1.05f

void gmv_detune_begin(struct gmv_detune *d, float times, float most, float better,
                      const struct gmv_record *record)
{
    memset(d, 0, sizeof *d);
    d->times = times;
    d->most = most;
    d->better = better;
    d->noise_margin = most > times ? NOISE_MARGIN : 1;
    memcpy(d->record, record, sizeof d->record);
}

static bool shakes_at_rest(const struct gmv_detune *d, const struct gmv_trial *t, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    const struct gmv_record *r = &d->record[i];
    float noise = gmv_record_noise(r), error_more = 0, moves = 0;
    gmv_trial_noise(t, i, &error_more, &moves);
    return gmv_record_would(r, gmv_record_error(r) + noise * error_more,
                            d->noise_margin * noise * moves);
}

/* Takes the outcome of a trial that is over. True: another one is needed. */
static bool take_outcome(struct gmv_detune *d, const struct gmv_trial *t)
{
    float answer[GMV_LOOPS] = {0};
    for (unsigned i = 0; i < GMV_LOOPS; i++)
        answer[i] = gmv_record_answer(&d->record[i]);
    struct gmv_outcome o = {
        .times = d->times, .decay = gmv_trial_worst(t), .ratio = gmv_trial_ratio(t, answer)};
    for (unsigned i = 0; i < GMV_LOOPS; i++)
        o.shakes = o.shakes || (gmv_trial_acts(t, i) && shakes_at_rest(d, t, i));
    bool passes = gmv_outcome_passes(&o, d->better);
    if (passes && (!d->passes || o.ratio < d->least))
        d->least = o.ratio;
    bool best = passes && (!d->passes || o.ratio <= AS_GOOD * d->least);
    if (best || !d->any)
        d->best = o;
    d->passes = d->passes || passes;
    d->any = true;
    return d->times > 0 && d->times * FACTOR <= d->most && (best || !d->passes);
}

bool gmv_detune_piece(struct gmv_detune *d, struct gmv_trial *t)
{
    if (gmv_trial_piece(t))
        return true;
    if (!take_outcome(d, t))
        return false;
    d->times *= FACTOR;
    gmv_trial_again(t, FACTOR);
    return true;
}

const struct gmv_outcome *gmv_detune_best(const struct gmv_detune *d)
{
    return &d->best;
}
