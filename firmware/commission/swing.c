#include "commission/swing.h"

#include "commission/swing_state.h"

/* Standard deviations of its noise by which an integral must return to have turned. */
#define SWING_SDS REAL_C(4.0)
#define DECAY     REAL_C(0.7) /* largest ratio of half cycles that decay: a damping of 0.11 */
/* A raised gain must only be borne: a damping of 0.05 is enough, and noise gets less of the benefit of the doubt. */
#define RAISED_DECAY REAL_C(0.85)
#define RAISED_SDS   REAL_C(1.0)
/* Longest half cycle of the same oscillation, times the one before. */
#define SWING_TAIL  2u
#define IN_A_ROW    2u
#define SWING_SHARE REAL_C(0.05) /* of the largest half cycle: smaller ones do not matter */

const struct swing_rule swing_accepted = {DECAY, SWING_SDS};
const struct swing_rule swing_raised = {RAISED_DECAY, RAISED_SDS};

/* The present half cycle is not smaller than the one before, by area and by mean height, and is no tail. The part of either
 * area that noise and a constant can explain does not count. */
static bool is_larger(const struct swing *w, const struct swing_rule *rule, real_t noise_sd,
                      real_t constant)
{
    real_t area = real_abs(w->extreme - w->turned);
    real_t samples = (real_t)(w->length + w->took);
    real_t unsure = rule->sds * noise_sd * real_sqrt(samples) + constant * samples;
    if (w->took == 0 || w->length == 0 || w->length > SWING_TAIL * w->took ||
        !(area > rule->decay * w->area + unsure))
        return false;
    return area / (real_t)w->length > rule->decay * w->area / (real_t)w->took;
}

static void count_larger(struct swing *w, const struct swing_rule *rule, real_t noise_sd,
                         real_t constant)
{
    if (!is_larger(w, rule, noise_sd, constant))
        w->larger = 0;
    else if (w->larger < UINT8_MAX)
        w->larger++;
    w->grows = w->grows || w->larger >= IN_A_ROW;
}

static void turn(struct swing *w, const struct swing_rule *rule, real_t noise_sd, real_t constant)
{
    real_t area = real_abs(w->extreme - w->turned);
    count_larger(w, rule, noise_sd, constant);
    w->area = area;
    w->took = w->length;
    if (area > w->largest)
        w->largest = area;
    w->turned = w->extreme;
    w->length = w->since;
    w->direction = (int8_t)-w->direction;
}

void swing_step(struct swing *w, real_t error, const struct swing_rule *rule, real_t noise_sd,
                real_t constant)
{
    w->integral += error;
    if (w->direction == 0)
        w->direction = error < REAL_C(0.0) ? -1 : 1;
    real_t beyond = (w->integral - w->extreme) * (real_t)w->direction;
    w->since++;
    if (beyond > REAL_C(0.0)) {
        w->length += w->since;
        w->since = 0;
        w->extreme = w->integral;
        return;
    }
    real_t turns = SWING_SDS * noise_sd * real_sqrt((real_t)w->since);
    real_t least = SWING_SHARE * w->largest;
    real_t now = SWING_SHARE * real_abs(w->extreme - w->turned);
    least = now > least ? now : least;
    if (-beyond > turns + least + constant * (real_t)w->since) {
        turn(w, rule, noise_sd, constant);
        w->extreme = w->integral;
        w->since = 0;
    }
}

void swing_end(struct swing *w, const struct swing_rule *rule, real_t noise_sd, real_t constant)
{
    count_larger(w, rule, noise_sd, constant);
}
