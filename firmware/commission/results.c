#include "commission/model.h"
#include "exchange/config.h"

#include "commission/certainty.h"
#include "commission/commission_internal.h"
#include "commission/limits.h"

#define CLIMBS     REAL_C(0.7) /* second half of a level over the first: 1 for an integrator */
#define CLIMBS_TOO REAL_C(0.5) /* ... where the fit thinks so, too */
#define LONGER     3u          /* times the half before, where an output did not come to rest */
#define ASYMMETRY_MUCH                                                                             \
    REAL_C(0.5) /* gain up less gain down, of their mean: the step was too large */
#define ASYMMETRY_WANTED REAL_C(0.2)
#define GENTLER_MOST     REAL_C(0.6) /* times the step that was cut */
#define GENTLER_LEAST    REAL_C(0.2)
#define GENTLER_SHARE    REAL_C(0.5) /* of the room, that the response to it may take */
#define UNSEEN_MUCH      REAL_C(0.1) /* of a response that was still to come */
#define SLOW_KNOWN       REAL_C(0.5) /* of a time constant: standard deviation of one that is known */

uint32_t commission_samples(const struct supervisor *s, real_t seconds)
{
    return (uint32_t)(seconds / s->plan->tick_s + REAL_C(0.5));
}

void commission_ask_for(struct commission *c, enum model_job job, uint32_t ticks)
{
    job_give_up(&c->job); /* an interim fit that the end of its test has overtaken */
    c->doing = (uint8_t)job;
    job_ask(&c->job, ticks);
}

/* The analysis of a large plant takes a small board some seconds; the plant is at rest meanwhile. */
static void analyse(struct commission *c, const struct supervisor *s)
{
    c->phase = COMMISSION_ANALYSING;
    c->phase_ms = s->time_ms;
    model_begin_analysis(c, &s->plan->config, s->plan->tick_s);
    commission_ask_for(c, JOB_ANALYSE, 1u + commission_samples(s, REAL_C(20.0)));
}

bool commission_is_due(const struct commission *c, uint8_t k)
{
    return !c->input[k].skipped && (c->input[k].unsettled || !c->only_unsettled);
}

void commission_next_input(struct commission *c, struct supervisor *s)
{
    do
        c->at++;
    while (c->at < c->inputs && !commission_is_due(c, c->order[c->at]));
    if (c->at < c->inputs)
        commission_start_input(c, s);
    else
        analyse(c, s);
}

/* Of the inputs whose tests left something open that a longer one may resolve. */
static void want_longer_tests(struct commission *c)
{
    const struct analysis *a = &c->work->analysis;
    for (uint8_t i = 0; i < a->plant.inputs; i++)
        c->input[c->column[i]].unsettled = (a->unsettled & (1u << i)) != 0u;
}

static void next_round(struct commission *c, struct supervisor *s)
{
    want_longer_tests(c);
    /* The other inputs are known well enough where nothing else is open. */
    c->only_unsettled = c->work->analysis.doubts == DOUBT_SHAPE;
    c->round++;
    c->at = 0;
    if (!commission_is_due(c, c->order[0]))
        commission_next_input(c, s);
    else
        commission_start_input(c, s);
}

/* An output that looks like an integrator may only be slow: once more with three times the half, as long as that fits and
 * no output was near its limit. */
static bool test_longer(struct commission *c, struct supervisor *s)
{
    const struct experiment *x = &c->work->test.experiment;
    struct tested_input *in = &c->input[c->order[c->at]];
    if (x->cut || x->config.half > 0 || x->half >= commission_longest(s) ||
        in->longer == LONGER_MOST)
        return false;
    in->longer++;
    in->half_wanted = LONGER * x->half;
    event_put(c->events, s->time_ms, EVENT_TEST_LONGER, commission_input_name(c, s),
              (real_t)in->half_wanted * x->config.h_s, in->longer);
    commission_start_input(c, s);
    return true;
}

/* Does output j look like an integrator of the input just tested? Not where it came to rest in an earlier round. */
static bool looks_integrating(const struct commission *c, uint8_t j, uint8_t k)
{
    bool fit_says = c->fitted[j].flags & IDENTIFIED_INTEGRATING;
    return c->input[k].rounds == 0 && c->climbs[j] >= (fit_says ? CLIMBS_TOO : CLIMBS);
}

/* An output that answers a step up and a step down so differently is not linear over so much of its range: the gain is
 * not that at the operating point, and no lag fits both ways. Once more with a smaller step, which grows again where
 * the noise hides what it does. */
static bool test_smaller(struct commission *c, struct supervisor *s)
{
    const struct experiment *x = &c->work->test.experiment;
    uint8_t k = c->order[c->at];
    struct tested_input *in = &c->input[k];
    real_t worst = REAL_C(0.0);
    for (uint8_t j = 0; j < c->outputs; j++) {
        real_t asymmetry = real_abs((real_t)c->work->element[j][k].asymmetry) / ASYMMETRY_UNIT;
        if (asymmetry > worst)
            worst = asymmetry;
    }
    bool grown = x->record.input.edges > 3u; /* a smaller one did not stand out of the noise */
    if (worst < ASYMMETRY_MUCH || grown || in->rounds > 0 || x->cut ||
        x->config.amplitude > REAL_C(0.0) || in->smaller == SMALLER_MOST)
        return false;
    in->smaller++;
    in->amplitude_wanted = x->amplitude * ASYMMETRY_WANTED / worst;
    event_put(c->events, s->time_ms, EVENT_TEST_SMALLER, commission_input_name(c, s),
              in->amplitude_wanted, in->smaller);
    commission_start_input(c, s);
    return true;
}

/* The guard has cut the step before its responses were over: what would have come is not known. Once more with one that
 * leaves room for them. An amplitude that is given stays. */
static bool test_gentler(struct commission *c, struct supervisor *s)
{
    const struct experiment *x = &c->work->test.experiment;
    uint8_t k = c->order[c->at];
    struct tested_input *in = &c->input[k];
    real_t a = GENTLER_MOST * x->amplitude;
    bool missing = x->one_sided;
    for (uint8_t j = 0; j < c->outputs; j++) {
        const struct identified *f = &c->fitted[j];
        real_t room = limits_room(x, j), most = real_abs(f->gain) + REAL_C(2.0) * f->gain_sd;
        if (f->flags & IDENTIFIED_NO_GAIN)
            continue;
        if (model_unseen(x, f) > UNSEEN_MUCH)
            missing = true;
        if (!(most * a < GENTLER_SHARE * room))
            a = GENTLER_SHARE * room / most;
    }
    if (!x->cut || !missing || x->config.amplitude > REAL_C(0.0) || in->gentler == GENTLER_TIMES)
        return false;
    if (a < GENTLER_LEAST * x->amplitude)
        a = GENTLER_LEAST * x->amplitude;
    in->gentler++;
    in->amplitude_most = a;
    event_put(c->events, s->time_ms, EVENT_TEST_SMALLER, commission_input_name(c, s), a,
              in->gentler);
    commission_start_input(c, s);
    return true;
}

/* Output j goes on climbing to the end of the longest level: it is slow, where the fit knows its time constant, or it
 * integrates. */
static enum commission_reason reason_of_climb(const struct commission *c, uint8_t j)
{
    const struct identified *f = &c->fitted[j];
    bool timed = f->time_constant_sd_s > REAL_C(0.0) &&
                 f->time_constant_sd_s < SLOW_KNOWN * f->time_constant_s;
    return timed && !(f->flags & IDENTIFIED_INTEGRATING) ? REASON_TOO_SLOW : REASON_INTEGRATES;
}

static void take_fit(struct commission *c, struct supervisor *s)
{
    uint8_t k = c->order[c->at];
    if (c->job_error) {
        commission_end(c, s, REASON_NUMBERS, commission_input_name(c, s), (real_t)c->job_error);
        return;
    }
    for (uint8_t j = 0; j < c->outputs; j++) {
        if (!looks_integrating(c, j, k))
            continue;
        if (test_longer(c, s))
            return;
        /* A step that was cut short says less: there the fit must think so, too. */
        if (c->work->test.experiment.cut && !(c->fitted[j].flags & IDENTIFIED_INTEGRATING))
            continue;
        commission_end(c, s, reason_of_climb(c, j),
                       s->plan->config.measurement[c->measurement[j]].name, c->input[k].worst);
        return;
    }
    if (test_gentler(c, s) || test_smaller(c, s))
        return;
    const struct experiment *x = &c->work->test.experiment;
    if (x->one_sided) {
        commission_end(c, s, REASON_REVERSAL,
                       s->plan->config.measurement[c->measurement[x->culprit]].name, x->predicted);
        return;
    }
    model_keep(c);
    c->input[k].rounds++;
    uint32_t lasts = commission_samples(s, commission_lasts(c, k));
    if (lasts > c->half_least && c->round == 1)
        c->half_least = lasts;
    commission_next_input(c, s);
}

/* Would more of the same tests help? Not when the gains are already as sure as a first-order model can be, nor where a response
 * is not that of one at all. */
static bool more_would_help(const struct analysis *a)
{
    if (certainty_is_final(a))
        return false;
    if (a->doubts & DOUBT_SHAPE)
        return true;
    for (uint8_t j = 0; j < a->plant.outputs; j++)
        for (uint8_t k = 0; k < a->plant.inputs; k++)
            if (a->plant.gain_sd[j][k] > a->config.floor * real_abs(a->plant.element[j][k].gain))
                return true;
    return false;
}

static void take_analysis(struct commission *c, struct supervisor *s)
{
    const struct analysis *a = &c->work->analysis;
    if (c->job_error == ERR_EMPTY) {
        commission_end(c, s, REASON_NO_INPUT, NULL, REAL_C(0.0));
        return;
    }
    if (c->job_error) {
        commission_end(c, s, REASON_NUMBERS, NULL, (real_t)c->job_error);
        return;
    }
    bool open = a->verdict != PAIRING_DETERMINED;
    if (open && c->round < s->plan->config.test.rounds && more_would_help(a)) {
        event_put(c->events, s->time_ms, EVENT_TEST_EXTENDED, NULL, a->probability,
                  (uint8_t)(c->round + 1u));
        next_round(c, s);
        return;
    }
    c->phase = COMMISSION_READY;
    c->analysed = c->unseen = true;
    c->phase_ms = c->ended_ms = s->time_ms;
    event_put(c->events, s->time_ms, open ? EVENT_NOT_DETERMINED : EVENT_PROPOSAL, NULL,
              a->probability, a->designed);
}

void commission_wait_for_job(struct commission *c, struct supervisor *s)
{
    if (!job_take(&c->job, c->events, s->time_ms))
        return;
    if (c->doing == JOB_FIT)
        take_fit(c, s);
    else
        take_analysis(c, s);
}
