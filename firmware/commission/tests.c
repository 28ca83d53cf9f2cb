#include "commission/commission.h"
#include "commission/experiment.h"
#include "commission/model.h"
#include "exchange/config.h"

#include "commission/commission_internal.h"

#include <string.h>

#include "base/elapsed.h"

#define AGAIN_NOISE REAL_C(2.0) /* times the noise multiple, in later rounds */
#define AGAIN_SHARE REAL_C(0.6) /* of a limit, in later rounds */
#define REACHED_SHARE                                                                              \
    REAL_C(0.8) /* of a limit, that a later round may use by what the one before has */
#define AGAIN_MOST       REAL_C(3.0) /* times the amplitude of the round before */
#define SHAPE_SMALLER    REAL_C(0.35) /* times the amplitude before, where the response is no lag's */
#define SHAPE_COUNTS     REAL_C(0.02) /* of a gain */
#define LONGEST_SHARE    3u /* times what the inputs before have taken: no half is longer at first */
#define SHARE_LEAST      REAL_C(0.5) /* no half is shorter than this share of the longest before */
#define UNSETTLED_LONGER REAL_C(2.0) /* times the half that did not show the end of a response */
#define OVER             REAL_C(3.0) /* time constants: a twentieth is left */
#define TIME_KNOWN       REAL_C(0.5) /* of a time constant: standard deviation of one that is known */

const char *commission_input_name(const struct commission *c, const struct supervisor *s)
{
    return s->plan->config.mv[c->input[c->order[c->at]].output].name;
}

/* When every response to input k is over but for a twentieth, s, as far as it is surely known. */
real_t commission_lasts(const struct commission *c, uint8_t k)
{
    real_t longest_s = REAL_C(0.0);
    for (uint8_t j = 0; j < c->outputs; j++) {
        const struct identified *e = &c->work->element[j][k].fit;
        real_t time_s = e->dead_time_s + OVER * e->time_constant_s;
        bool known = !(e->flags & IDENTIFIED_NO_GAIN) &&
                     e->gain_sd < REAL_C(0.2) * real_abs(e->gain) &&
                     e->time_constant_sd_s < REAL_C(0.3) * e->time_constant_s;
        if (known && time_s > longest_s)
            longest_s = time_s;
    }
    return longest_s;
}

real_t commission_half_needed(const struct commission *c, uint8_t j, uint8_t k)
{
    const struct identified *e = &c->work->element[j][k].fit;
    real_t needed_s = UNSETTLED_LONGER * c->input[k].half_s;
    real_t over_s = e->dead_time_s + OVER * e->time_constant_s;
    bool timed = !(e->flags & IDENTIFIED_INTEGRATING) &&
                 e->time_constant_sd_s < TIME_KNOWN * e->time_constant_s;
    return timed && over_s > needed_s ? over_s : needed_s;
}

/* Is some response to input k no lag's, and that, not noise, what its gain is unsure by? A shorter half would see
 * less of what comes late, and be wrong by more; and what is slow by one input is mostly so by another, too. */
static bool shape_decides(const struct commission *c, uint8_t k)
{
    for (uint8_t j = 0; j < c->outputs; j++) {
        const struct element *e = &c->work->element[j][k];
        if (e->misfit > REAL_C(0.5) * e->fit.gain_sd &&
            e->misfit > SHAPE_COUNTS * real_abs(e->fit.gain))
            return true;
    }
    return false;
}

real_t commission_small_step(const struct commission *c)
{
    real_t least = REAL_C(0.0);
    for (uint8_t k = 0; k < c->inputs; k++) {
        real_t wanted = c->input[k].amplitude_wanted;
        if (wanted > REAL_C(0.0) && (!(least > REAL_C(0.0)) || wanted < least))
            least = wanted;
    }
    return least;
}

/* What the operator, and earlier rounds, know of the times of this input. */
static uint32_t least_half(const struct commission *c, const struct supervisor *s, uint8_t k,
                           struct experiment_config *x)
{
    const struct config *config = &s->plan->config;
    real_t longest_s = REAL_C(0.0);
    for (unsigned p = 0; p < CONFIG_PAIRS; p++) {
        const struct pair_config *pair = &config->pair[p];
        if (!pair->measurement[0] || config_find_mv(config, pair->mv) != c->input[k].output)
            continue;
        uint8_t i = config_find_measurement(config, pair->measurement);
        const struct measurement_config *m = &config->measurement[i];
        const struct mv_config *o = &config->mv[c->input[k].output];
        if (pair->time_s * REAL_C(4.0) > longest_s)
            longest_s = pair->time_s * REAL_C(4.0);
        real_t gain = real_abs(pair->gain) * (o->hi - o->lo) / (m->hi - m->lo);
        /* A first amplitude that brings the output a quarter of the way to its limit. */
        for (uint8_t j = 0; gain > REAL_C(0.0) && j < c->outputs; j++)
            if (c->measurement[j] == i)
                x->amplitude_first = x->limit[j] * REAL_C(0.25) / gain;
    }
    real_t found_s = c->input[k].rounds > 0 ? commission_lasts(c, k) : REAL_C(0.0);
    if (found_s > longest_s)
        longest_s = found_s;
    if (c->input[k].rounds > 0 && shape_decides(c, k)) {
        real_t slowest_s = (real_t)c->half_least * x->h_s;
        real_t took_s = c->input[k].half_s;
        if (slowest_s > took_s)
            took_s = slowest_s;
        if (took_s > longest_s)
            longest_s = took_s;
    }
    if (c->input[k].rounds > 0 && c->input[k].unsettled &&
        longest_s < UNSETTLED_LONGER * c->input[k].half_s)
        longest_s = UNSETTLED_LONGER * c->input[k].half_s;
    uint32_t known = commission_samples(s, longest_s);
    /* What the round before has found out holds: a half that goes on for longer only gathers drift. */
    if (c->input[k].rounds > 0 && known > x->window) {
        uint32_t most = known + known / 4u;
        x->half_most = most < x->half_most ? most : x->half_most;
        return known;
    }
    /* Nothing is: then it is noise that hides it, and a longer half hides it no less. */
    uint32_t took = commission_samples(s, c->input[k].half_s);
    if (c->input[k].rounds > 0 && took > x->window && took < x->half_most)
        x->half_most = took;
    if (known < c->input[k].half_wanted)
        known = c->input[k].half_wanted;
    real_t share = SHARE_LEAST;
    if (commission_small_step(c) > REAL_C(0.0))
        share = REAL_C(1.0); /* not linear: up may be over when down is not */
    uint32_t before = (uint32_t)(share * (real_t)c->half_least);
    return known > before ? known : before;
}

/* Of test channel j, less what earlier tests have left. */
static real_t room_of(const struct commission *c, const struct experiment_config *x, uint8_t j)
{
    real_t room = x->limit[j] - real_abs(c->origin.channel[j].left);
    return room > REAL_C(0.0) ? room : REAL_C(0.0);
}

/* From the second round on the gains are known: as much as the limits leave room for. */
static real_t amplitude_by_model(const struct commission *c, uint8_t k,
                                 const struct experiment_config *x)
{
    real_t a = x->amplitude_max < AMPLITUDE_MOST ? x->amplitude_max : AMPLITUDE_MOST;
    real_t stands_out = REAL_C(0.0); /* largest response to 1, in noise standard deviations */
    for (uint8_t j = 0; j < c->outputs; j++) {
        const struct identified *f = &c->work->element[j][k].fit;
        real_t most = real_abs(f->gain) + REAL_C(2.0) * f->gain_sd;
        if (most * a > AGAIN_SHARE * room_of(c, x, j))
            a = AGAIN_SHARE * room_of(c, x, j) / most;
        if (real_abs(f->gain) > stands_out * c->noise_sd[j])
            stands_out = real_abs(f->gain) / c->noise_sd[j];
    }
    /* More than stands out well is asked of no plant: it is not linear. */
    /* What the model does not show, such as an overshoot, was there in the round before. */
    const struct tested_input *in = &c->input[k];
    if (in->worst * a > REACHED_SHARE * in->amplitude)
        a = REACHED_SHARE * in->amplitude / in->worst;
    real_t enough = AGAIN_NOISE * x->noise_multiple;
    if (a * stands_out > enough) {
        real_t least = c->input[k].amplitude;
        if (shape_decides(c, k)) /* a smaller step sees less of what is not linear */
            least *= SHAPE_SMALLER;
        least = least < a ? least : a;
        a = enough / stands_out > least ? enough / stands_out : least;
    }
    real_t before = c->input[k].amplitude * AGAIN_MOST;
    return a < before ? a : before;
}

static enum err begin_input(struct commission *c, const struct supervisor *s)
{
    const struct config *config = &s->plan->config;
    uint8_t k = c->order[c->at];
    const struct mv_config *o = &config->mv[c->input[k].output];
    real_t ways = commission_room(s, c->input[k].output, c->input[k].test_base);
    struct experiment_config x = {
        .outputs = c->outputs,
        .h_s = s->plan->tick_s,
        .window = config->test.window < STEADY_BLOCKS ? STEADY_BLOCKS : config->test.window,
        .noise_floor = NOISE_FLOOR,
        .amplitude = o->test_step / (o->hi - o->lo),
        .amplitude_first = AMPLITUDE_FIRST,
        .amplitude_max = ways,
        .noise_multiple = config->test.noise_multiple,
        .half = commission_samples(s, o->test_time_s),
        .blank_s = config->test.blank_s,
        .origin = &c->origin,
        .line_guard = config->test.guard == TEST_GUARD_LINE};
    for (uint8_t j = 0; j < c->outputs; j++) {
        x.limit[j] = commission_limit(&config->measurement[c->measurement[j]]);
        if (c->input[k].rounds > 0)
            x.dead_time_s[j] = c->work->element[j][k].fit.dead_time_s;
    }
    /* A drift is seen over a window as long as the responses are. */
    uint32_t wider = c->half_least / 4u;
    if (wider > x.window)
        x.window = wider;
    if (c->input[k].amplitude_most > REAL_C(0.0) && c->input[k].amplitude_most < ways)
        x.amplitude_max = c->input[k].amplitude_most;
    if (x.amplitude > x.amplitude_max)
        x.amplitude = x.amplitude_max;
    if (x.amplitude <= REAL_C(0.0)) {
        if (c->input[k].rounds > 0)
            x.amplitude_first = amplitude_by_model(c, k, &x);
        else if (commission_small_step(c) > REAL_C(0.0))
            x.amplitude_first = commission_small_step(c);
        if (x.amplitude_max > AMPLITUDE_MOST)
            x.amplitude_max = AMPLITUDE_MOST;
    }
    x.half_most = commission_longest(s);
    /* Nothing that is surely known was so slow; if this is, the next try takes longer. */
    uint32_t all = x.half_most;
    uint32_t most = LONGEST_SHARE * c->half_least;
    if (most > x.window && most < x.half_most)
        x.half_most = most;
    if (x.half_most < c->input[k].half_wanted)
        x.half_most = c->input[k].half_wanted < all ? c->input[k].half_wanted : all;
    if (x.half_most <= x.window)
        x.half_most = x.window + 1u;
    x.half_least = least_half(c, s, k, &x);
    if (x.half_most < x.half)
        x.half_most = x.half;
    if (x.half_least < x.window)
        x.half_least = x.window;
    if (x.half_least > x.half_most)
        x.half_least = x.half_most;
    if (!(x.amplitude_first > NOISE_FLOOR))
        x.amplitude_first = NOISE_FLOOR;
    commission_age_origin(c, s);
    c->phase = COMMISSION_TESTING;
    c->phase_ms = s->time_ms;
    return experiment_begin(&c->work->test.experiment, &x);
}

uint32_t commission_longest(const struct supervisor *s)
{
    real_t longest_s = s->plan->config.test.longest_s;
    return longest_s > REAL_C(0.0) ? commission_samples(s, longest_s) : COMMISSION_HALF_MOST;
}

void commission_age_origin(struct commission *c, const struct supervisor *s)
{
    if (c->origin.fixed)
        c->origin.since_s += elapsed_ms(s->time_ms, c->sample_ms) / REAL_C(1000.0);
    c->sample_ms = s->time_ms;
}

void commission_start_input(struct commission *c, struct supervisor *s)
{
    enum err err = begin_input(c, s);
    if (err)
        commission_end(c, s, REASON_NUMBERS, commission_input_name(c, s), (real_t)err);
}

/* All but the large parts, which whoever uses them next clears: this is a tick. */
void commission_forget(struct commission *c, const struct supervisor *s)
{
    job_give_up(&c->job);
    struct event_queue *events = c->events;
    struct job job = c->job;
    struct workspace *workspace = c->workspace;
    struct commission_work *work = c->work;
    memset(c, 0, sizeof *c);
    c->events = events;
    c->job = job;
    c->workspace = workspace;
    c->work = work;
    memset(c->work->element, 0, sizeof c->work->element);
    c->plan_serial = s->plan->serial;
    c->channels = commission_channels(&s->plan->config);
    c->safe_count = s->safe_count;
    c->began_ms = s->time_ms;
}

void commission_begin(struct commission *c, struct supervisor *s)
{
    const char *what, *wanted;
    struct event_queue *events = c->events;
    if (commission_may_begin(s, &what, &wanted) != ERR_OK) {
        event_put(events, s->time_ms, EVENT_REQUEST_REFUSED, what, 0.0f, 0);
        return;
    }
    commission_forget(c, s);
    c->round = 1;
    for (uint8_t i = 0; i < CHANNEL_MAX; i++)
        if (commission_measurement_is_tested(s, i))
            c->measurement[c->outputs++] = i;
    for (uint8_t j = 0; j < CHANNEL_MAX; j++) {
        if (!commission_input_is_tested(s, j))
            continue;
        c->input[c->inputs].output = j;
        c->input[c->inputs++].test_base = commission_test_base(s, j);
    }
    uint8_t n = 0;
    for (unsigned critical = 2; critical-- > 0;)
        for (uint8_t k = 0; k < c->inputs; k++)
            if (s->plan->config.mv[c->input[k].output].test_critical == critical)
                c->order[n++] = k;
    event_put(events, s->time_ms, EVENT_COMMISSION_BEGUN, NULL, (float)c->inputs, 0);
    commission_start_input(c, s);
}

static void end_test(struct commission *c, struct supervisor *s)
{
    const struct experiment *x = &c->work->test.experiment;
    struct tested_input *in = &c->input[c->order[c->at]];
    in->amplitude = x->amplitude;
    in->half_s = (real_t)x->half * x->config.h_s;
    c->tests++;
    c->tested_s += elapsed_ms(s->time_ms, c->phase_ms) / REAL_C(1000.0);
    in->cut = x->cut;
    in->small = x->small;
    if (x->worst > in->worst)
        in->worst = x->worst;
    for (uint8_t j = 0; j < c->outputs; j++)
        c->noise_sd[j] = x->before[j].noise_sd;
    event_put(c->events, s->time_ms, EVENT_TEST_DONE, commission_input_name(c, s), in->half_s,
              c->round);
    c->phase = COMMISSION_FITTING;
    c->phase_ms = s->time_ms;
    model_begin_fit(c);
    commission_ask_for(c, JOB_FIT, 1u + commission_samples(s, REAL_C(2.0)));
}

void commission_test(struct commission *c, struct supervisor *s)
{
    struct experiment *x = &c->work->test.experiment;
    uint8_t k = c->order[c->at];
    real_t y[CHANNEL_MAX];
    enum experiment_phase before = x->phase;
    enum err err = ERR_OK;
    uint32_t missed = commission_samples(s, elapsed_ms(s->time_ms, c->sample_ms) / REAL_C(1000.0));
    c->sample_ms = s->time_ms;
    if (x->begun && missed > MISSED_MOST + 1u) {
        commission_end(c, s, REASON_SAMPLES, NULL, (real_t)(missed - 1u));
        return;
    }
    for (; x->begun && missed > 1 && !err; missed--)
        err = experiment_missed(x);
    for (uint8_t j = 0; j < c->outputs; j++)
        y[j] = num_to_float(s->measurement[c->measurement[j]].value);
    if (job_take(&c->job, c->events, s->time_ms))
        experiment_take_interim_fit(x);
    if (!err)
        err = experiment_step(x, y);
    if (err) {
        commission_end(c, s, REASON_NUMBERS, commission_input_name(c, s), REAL_C(0.0));
        return;
    }
    supervisor_excite(s, c->input[k].output, num_from_float(x->level));
    if (x->interim_fitting && !job_is_asked(&c->job) && c->ask == COMMISSION_ASK_NONE)
        commission_ask_for(c, JOB_LOOK, 1u + commission_samples(s, REAL_C(2.0)));
    if (before == EXPERIMENT_REST && x->phase == EXPERIMENT_UP)
        event_put(c->events, s->time_ms, EVENT_TEST_STEP, commission_input_name(c, s), x->amplitude,
                  c->round);
    if (before == EXPERIMENT_UP && x->phase > EXPERIMENT_UP && x->cut) {
        c->input[k].cut_by = x->culprit;
        c->input[k].cut_predicted = x->predicted;
        event_put(c->events, s->time_ms, EVENT_TEST_CUT,
                  s->plan->config.measurement[c->measurement[x->culprit]].name, x->predicted, 0);
    }
    if (x->phase == EXPERIMENT_FAILED) {
        static const enum commission_reason reason[] = {[EXPERIMENT_FINE] = REASON_NUMBERS,
                                                        [EXPERIMENT_RESTLESS] = REASON_RESTLESS,
                                                        [EXPERIMENT_LIMIT] = REASON_LIMIT,
                                                        [EXPERIMENT_AWAY] = REASON_AWAY,
                                                        [EXPERIMENT_LEFT] = REASON_LEFT};
        c->input[k].worst = x->worst;
        commission_end(c, s, reason[x->failure],
                       s->plan->config.measurement[c->measurement[x->culprit]].name, x->worst);
    } else if (x->phase == EXPERIMENT_DONE) {
        end_test(c, s);
    }
}
