#include "commission/kept_watch.h"

#include "commission/commission_state.h"
#include "commission/swing.h"

#include <string.h>

#define SWINGS       8u           /* half cycles in a row that do not decay: four periods */
#define SWING_HEIGHT REAL_C(0.05) /* of the limit: mean height of a half cycle that matters */
#define NOISE_HEIGHT REAL_C(2.0)  /* ... and in deviations of the noise */
#define NOISE_PEAK   REAL_C(4.0)
#define MANUAL_SHARE 10u         /* a loop may be in manual for the n-th part of the watch */
#define STUCK_TIMES  REAL_C(2.0) /* of a step's time */
#define MOVED_LEAST  REAL_C(1e-6)
#define AT_LIMIT     REAL_C(1e-5) /* of span */

static uint32_t step_samples(const struct adoption *a, const struct supervisor *s, uint8_t k)
{
    return adoption_step_samples(adoption_loop(a, k), s->plan->tick_s);
}

static real_t output_now(const struct adoption *a, const struct supervisor *s, uint8_t k)
{
    const struct adoption_loop *l = adoption_loop(a, k);
    uint8_t j = s->plan->loop[l->loop].mv;
    return j == PLAN_NONE ? num_to_float(s->loop[l->loop].v) : num_to_float(s->mv[j].constrained);
}

void kept_watch_begin(struct kept_watch *w, const struct adoption *a, const struct supervisor *s,
                      uint32_t length)
{
    memset(w, 0, sizeof *w);
    w->length = length;
    for (uint8_t k = 0; k < adoption_loops(a); k++) {
        struct watched_loop *l = &w->loop[k];
        l->limit = adoption_channel(a, k)->limit;
        l->target = num_to_float(s->loop[adoption_loop(a, k)->loop].setpoint);
        l->output = output_now(a, s, k);
        l->held = step_samples(a, s, k);
    }
}

/* A person, and not the firmware, has put the loop into manual: its measurement is good, and no interlock holds its output. */
static bool by_hand(const struct adoption *a, const struct supervisor *s, uint8_t k)
{
    uint8_t i = adoption_loop(a, k)->loop, j = s->plan->loop[i].mv;
    bool good = measurement_may_control(&s->measurement[s->plan->loop[i].pv]);
    return good && (j == PLAN_NONE || !s->mv[j].interlocked);
}

static bool is_stuck(const struct adoption *a, const struct supervisor *s, uint8_t k)
{
    uint8_t j = s->plan->loop[adoption_loop(a, k)->loop].mv;
    if (j == PLAN_NONE)
        return false;
    const struct mv_config *o = &s->plan->config.mv[j];
    real_t u = num_to_float(s->mv[j].constrained), span = o->hi - o->lo;
    return u <= (o->min - o->lo) / span + AT_LIMIT || u >= (o->max - o->lo) / span - AT_LIMIT;
}

/* The loop oscillates: its half cycles do not decay, and they are more than noise. */
static bool oscillates(const struct watched_loop *l, real_t noise_sd)
{
    real_t least = SWING_HEIGHT * l->limit;
    if (least < NOISE_HEIGHT * noise_sd)
        least = NOISE_HEIGHT * noise_sd;
    return swing_in_a_row(&l->swing) >= SWINGS && swing_height(&l->swing) > least;
}

/* Counts a sample of a loop in automatic whose setpoint counts. */
static enum kept_sign look_at_error(struct watched_loop *l, real_t error, real_t noise_sd)
{
    real_t size = real_abs(error);
    l->samples++;
    l->sum += error;
    l->square += error * error;
    l->largest = size > l->largest ? size : l->largest;
    swing_step(&l->swing, error, &swing_accepted, noise_sd, REAL_C(0.0));
    if (size > l->limit + NOISE_PEAK * noise_sd)
        return KEPT_PAST_LIMIT;
    return oscillates(l, noise_sd) ? KEPT_SWINGS : KEPT_FINE;
}

static enum kept_sign look_at_loop(struct kept_watch *w, const struct adoption *a,
                                   const struct supervisor *s, uint8_t k)
{
    REFLUX_ASSERT(k < CONFIG_LOOPS);
    struct watched_loop *l = &w->loop[k];
    const struct adoption_channel *c = adoption_channel(a, k);
    const struct loop_state *loop = &s->loop[adoption_loop(a, k)->loop];
    real_t u = output_now(a, s, k);
    l->moves += real_abs(u - l->output);
    l->output = u;
    if (loop->mode == LOOP_MANUAL) {
        l->stuck = 0;
        l->held = step_samples(a, s, k);
        if (by_hand(a, s, k) && l->manual == 0)
            return KEPT_HAND;
        return ++l->manual > w->length / MANUAL_SHARE ? KEPT_IN_MANUAL : KEPT_FINE;
    }
    uint32_t lasts = step_samples(a, s, k);
    l->stuck = is_stuck(a, s, k) ? l->stuck + 1u : 0;
    if ((real_t)l->stuck > STUCK_TIMES * (real_t)lasts)
        return KEPT_STUCK;
    real_t target = num_to_float(loop->setpoint);
    if (real_abs(target - l->target) > MOVED_LEAST) {
        l->held = lasts;
        memset(&l->swing, 0, sizeof l->swing);
    }
    l->target = target;
    if (l->held > 0) {
        l->held--;
        return KEPT_FINE;
    }
    real_t error = target - num_to_float(s->measurement[c->measurement].value);
    return look_at_error(l, error, c->noise_sd);
}

enum kept_sign kept_watch_tick(struct kept_watch *w, const struct adoption *a,
                               const struct supervisor *s)
{
    w->ticks++;
    for (uint8_t k = 0; k < adoption_loops(a); k++) {
        enum kept_sign sign = look_at_loop(w, a, s, k);
        if (sign == KEPT_FINE)
            continue;
        w->culprit = k;
        w->sign = (uint8_t)sign;
        return sign;
    }
    return w->ticks < w->length ? KEPT_FINE : KEPT_OVER;
}

bool kept_watch_is_near(const struct kept_watch *w, const struct adoption *a,
                        const struct supervisor *s)
{
    for (uint8_t k = 0; k < adoption_loops(a); k++) {
        real_t target = num_to_float(s->loop[adoption_loop(a, k)->loop].target);
        if (real_abs(target - trial_line_rest(&adoption_channel(a, k)->line)) > w->loop[k].limit)
            return false;
    }
    return true;
}

real_t kept_watch_sd(const struct kept_watch *w, uint8_t k)
{
    REFLUX_ASSERT(k < CONFIG_LOOPS);
    const struct watched_loop *l = &w->loop[k];
    if (l->samples == 0)
        return REAL_C(0.0);
    real_t mean = l->sum / (real_t)l->samples, square = l->square / (real_t)l->samples;
    return square > mean * mean ? real_sqrt(square - mean * mean) : REAL_C(0.0);
}
