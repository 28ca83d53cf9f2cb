#include "commission/next_test.h"

#include "base/assertion.h"
#include "commission/certainty.h"
#include "commission/channels.h"
#include "commission/commission_state.h"
#include "commission/direction.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"

#define AGAIN_NOISE REAL_C(2.0) /* times the noise multiple, in later rounds */
#define AGAIN_SHARE REAL_C(0.6) /* of a limit, in later rounds */
/* Share of a limit that a later round may use, by the one before. */
#define REACHED_SHARE    REAL_C(0.8)
#define AGAIN_MOST       REAL_C(3.0) /* times the amplitude of the round before */
#define LONGEST_SHARE    3u          /* longest first half over the slowest known response */
#define SHARE_LEAST      REAL_C(0.5) /* shortest half over the slowest known response */
#define UNSETTLED_LONGER REAL_C(2.0) /* factor for a half that did not show the end of a response */
#define UNSETTLED_FREE                                                                             \
    REAL_C(4.0) /* likewise from the third round on where no longest half is set */

real_t commission_lasts(const struct commission *c, uint8_t k)
{
    REFLUX_ASSERT(k < CHANNEL_MAX);
    real_t longest_s = REAL_C(0.0);
    for (uint8_t j = 0, n = outputs_count(&c->outputs); j < n; j++) {
        const struct identified e = element_fit(&c->work->element[j][k]);
        real_t time_s = identified_over_s(&e);
        bool known = !(e.flags & (IDENTIFIED_NO_GAIN | IDENTIFIED_RAMP | CERTAINTY_OPEN_FLAGS)) &&
                     e.gain_sd < REAL_C(0.2) * real_abs(e.gain) &&
                     e.time_constant_sd_s < REAL_C(0.3) * e.time_constant_s;
        if (known && time_s > longest_s)
            longest_s = time_s;
    }
    return longest_s;
}

real_t commission_half_needed(const struct commission *c, uint8_t j, uint8_t k)
{
    REFLUX_ASSERT(j < CHANNEL_MAX && k < CHANNEL_MAX);
    const struct identified e = element_fit(&c->work->element[j][k]);
    real_t needed_s = UNSETTLED_LONGER * inputs_get(&c->inputs, k)->half_s;
    real_t over_s = identified_over_s(&e);
    return identified_is_timed(&e) && over_s > needed_s ? over_s : needed_s;
}

/* The end of a response has not been seen. Of one that is perhaps slow an end has been. */
static bool end_is_unseen(const struct commission *c, uint8_t j, uint8_t k)
{
    REFLUX_ASSERT(j < CHANNEL_MAX && k < CHANNEL_MAX);
    const struct element *e = &c->work->element[j][k];
    return (e->flags & CERTAINTY_OPEN_FLAGS) != 0 && e->found.kind != SHAPE_PERHAPS_SLOW;
}

/* No longest half is set, and no drift would spoil one that is much longer. */
static bool may_be_long(const struct commission *c, const struct config *config)
{
    return !(config->test.longest_s > 0.0f) && !origin_drifts(&c->origin);
}

/* Shortest half by what the operator and earlier rounds know of the times of this input, samples. */
static uint32_t least_half(const struct commission *c, const struct supervisor *s, uint8_t k,
                           struct experiment_config *x)
{
    const struct config *config = &s->plan->config;
    const struct tested_input *in = inputs_get(&c->inputs, k);
    uint32_t half_least = inputs_half_least(&c->inputs);
    uint8_t outputs = outputs_count(&c->outputs);
    real_t longest_s = REAL_C(0.0);
    for (unsigned p = 0; p < CONFIG_PAIRS && !inputs_is_direction(&c->inputs); p++) {
        const struct pair_config *pair = &config->pair[p];
        if (!pair->measurement[0] || config_find_mv(config, pair->mv) != in->output)
            continue;
        uint8_t i = config_find_measurement(config, pair->measurement);
        const struct measurement_config *m = &config->measurement[i];
        const struct mv_config *o = &config->mv[in->output];
        if (pair->time_s * REAL_C(4.0) > longest_s)
            longest_s = pair->time_s * REAL_C(4.0);
        real_t gain = real_abs(pair->gain) * (o->hi - o->lo) / (m->hi - m->lo);
        /* A first amplitude that brings the output a quarter of the way to its limit. */
        for (uint8_t j = 0; gain > REAL_C(0.0) && j < outputs; j++)
            if (outputs_measurement(&c->outputs, j) == i) {
                x->amplitude_first = x->limit[j] * REAL_C(0.25) / gain;
                x->gains_unknown = false;
            }
    }
    real_t found_s = in->rounds > 0 ? commission_lasts(c, k) : REAL_C(0.0);
    if (found_s > longest_s)
        longest_s = found_s;
    bool free = may_be_long(c, config) && in->rounds > 1;
    real_t longer = free ? UNSETTLED_FREE : UNSETTLED_LONGER;
    bool open = false;
    for (uint8_t j = 0; j < outputs; j++)
        open = open || end_is_unseen(c, j, k);
    if (!open) /* another test as long, with a larger step, tells as well */
        longer = REAL_C(1.0);
    if (in->rounds > 0 && in->unsettled && longest_s < longer * in->half_s)
        longest_s = longer * in->half_s;
    for (uint8_t j = 0; in->rounds > 0 && in->unsettled && j < outputs; j++) {
        real_t needed_s = commission_half_needed(c, j, k);
        if (end_is_unseen(c, j, k) && needed_s > longest_s)
            longest_s = needed_s;
    }
    uint32_t known = commission_samples(s, longest_s);
    /* Times of the round before count: a longer half would only gather drift. */
    if (in->rounds > 0 && known > x->window) {
        uint32_t most = known + known / 4u;
        x->half_most = most < x->half_most ? most : x->half_most;
        return known;
    }
    /* Nothing is known: noise hides the response, in a longer half as well. */
    uint32_t took = commission_samples(s, in->half_s);
    if (in->rounds > 0 && took > x->window && took < x->half_most)
        x->half_most = took;
    if (known < in->half_wanted)
        known = in->half_wanted;
    real_t share = SHARE_LEAST;
    if (inputs_small_step(&c->inputs) > REAL_C(0.0))
        share = REAL_C(1.0); /* not linear: up may be over when down is not */
    uint32_t before = (uint32_t)(share * (real_t)half_least);
    return known > before ? known : before;
}

/* Limit of output j less the deviation that earlier tests have left. */
static real_t room_of(const struct commission *c, const struct experiment_config *x, uint8_t j)
{
    REFLUX_ASSERT(j < CHANNEL_MAX);
    real_t room = x->limit[j] - real_abs(origin_left(&c->origin, j));
    return room > REAL_C(0.0) ? room : REAL_C(0.0);
}

/* Amplitude from the second round on: the gains are known, so it is as large as the limits allow. */
static real_t amplitude_by_model(const struct commission *c, uint8_t k,
                                 const struct experiment_config *x)
{
    REFLUX_ASSERT(k < CHANNEL_MAX);
    real_t a = x->amplitude_max < AMPLITUDE_MOST ? x->amplitude_max : AMPLITUDE_MOST;
    const struct tested_input *in = inputs_get(&c->inputs, k);
    const real_t *noise_sd = outputs_noise(&c->outputs);
    uint8_t outputs = outputs_count(&c->outputs);
    real_t stands_out = REAL_C(0.0); /* largest response to 1, in noise standard deviations */
    for (uint8_t j = 0; j < outputs; j++) {
        const struct identified f = element_fit(&c->work->element[j][k]);
        real_t most = real_abs(f.gain) + REAL_C(2.0) * f.gain_sd;
        if (most * a > AGAIN_SHARE * room_of(c, x, j))
            a = AGAIN_SHARE * room_of(c, x, j) / most;
        if (real_abs(f.gain) > stands_out * noise_sd[j])
            stands_out = real_abs(f.gain) / noise_sd[j];
    }
    /* No plant is asked for more than a clear response, because plants are not linear. */
    /* Properties that the model does not show, such as an overshoot, were present in the round before. */
    if (in->worst * a > REACHED_SHARE * in->amplitude)
        a = REACHED_SHARE * in->amplitude / in->worst;
    real_t enough = AGAIN_NOISE * x->noise_multiple;
    if (a * stands_out > enough) {
        real_t least = in->amplitude;
        least = least < a ? least : a;
        a = enough / stands_out > least ? enough / stands_out : least;
    }
    real_t before = in->amplitude * AGAIN_MOST;
    return a < before ? a : before;
}

void next_test_config(struct commission *c, const struct supervisor *s, struct experiment_config *x)
{
    const struct config *config = &s->plan->config;
    uint8_t k = inputs_current(&c->inputs), outputs = outputs_count(&c->outputs);
    const struct tested_input *in = inputs_get(&c->inputs, k);
    uint32_t half_least = inputs_half_least(&c->inputs);
    const struct mv_config *o = &config->mv[in->output];
    real_t ways = commission_room(s, in->output, in->test_base);
    *x = (struct experiment_config){
        .outputs = outputs,
        .h_s = s->plan->tick_s,
        .window = config->test.window < STEADY_BLOCKS ? STEADY_BLOCKS : config->test.window,
        .noise_floor = NOISE_FLOOR,
        .amplitude = o->start_up.step / (o->hi - o->lo),
        .amplitude_first = AMPLITUDE_FIRST,
        .amplitude_max = ways,
        .repeats = !(o->start_up.step > 0.0f) && in->cut_retries < RETRIES_MAX,
        .noise_multiple = config->test.noise_multiple,
        .half = commission_samples(s, o->start_up.time_s),
        .blank_s = config->test.blank_s,
        .origin = &c->origin,
        .line_guard = config->test.guard == TEST_GUARD_LINE};
    for (uint8_t j = 0; j < outputs; j++) {
        x->limit[j] = commission_limit(&config->measurement[outputs_measurement(&c->outputs, j)]);
        if (in->rounds > 0)
            x->dead_time_s[j] = c->work->element[j][k].found.shape.dead_time_s;
    }
    if (inputs_is_direction(&c->inputs))
        direction_config(c, s, x);
    /* The window for a drift is as long as the responses are. */
    uint32_t wider = half_least / 4u;
    if (wider > x->window)
        x->window = wider;
    if (in->amplitude_most > REAL_C(0.0) && in->amplitude_most < ways)
        x->amplitude_max = in->amplitude_most;
    if (x->amplitude > x->amplitude_max)
        x->amplitude = x->amplitude_max;
    if (x->amplitude <= REAL_C(0.0)) {
        real_t small = inputs_small_step(&c->inputs);
        bool direction = inputs_is_direction(&c->inputs);
        x->gains_unknown = in->rounds == 0 && !(in->amplitude_wanted > REAL_C(0.0)) && !direction;
        if (in->rounds > 0)
            x->amplitude_first = amplitude_by_model(c, k, x);
        else if (in->amplitude_wanted > REAL_C(0.0))
            x->amplitude_first = in->amplitude_wanted;
        else if (!direction && small > REAL_C(0.0) && small < AMPLITUDE_FIRST)
            x->amplitude_first = small;
        if (x->amplitude_max > AMPLITUDE_MOST)
            x->amplitude_max = AMPLITUDE_MOST;
    }
    x->half_most = commission_longest(s);
    if (!(config->test.longest_s > 0.0f))
        x->half_plenty = COMMISSION_HALF_PLENTY;
    /* No response that is known was so slow; if this one is, the next try takes longer. */
    uint32_t all = x->half_most;
    uint32_t most = LONGEST_SHARE * half_least;
    bool longer = in->unsettled && may_be_long(c, config);
    if (most > x->window && most < x->half_most && !longer)
        x->half_most = most;
    if (x->half_most < in->half_wanted)
        x->half_most = in->half_wanted < all ? in->half_wanted : all;
    if (x->half_most <= x->window)
        x->half_most = x->window + 1u;
    x->half_least = least_half(c, s, k, x);
    if (inputs_is_direction(&c->inputs)) {
        uint32_t shows = direction_half(c, s);
        x->half_least = x->half_least > shows ? x->half_least : shows;
        x->half_most = LONGEST_SHARE * x->half_least < all ? LONGEST_SHARE * x->half_least : all;
    }
    if (x->half_most < x->half)
        x->half_most = x->half;
    if (x->half_least < x->window)
        x->half_least = x->window;
    if (x->half_least > x->half_most)
        x->half_least = x->half_most;
    if (!(x->amplitude_first > NOISE_FLOOR))
        x->amplitude_first = NOISE_FLOOR;
}
