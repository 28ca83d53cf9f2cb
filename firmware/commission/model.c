#include "commission/model.h"

#include "commission/certainty.h"
#include "commission/combine.h"
#include "commission/commission_state.h"
#include "commission/experiment.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"
#include "commission/test_verdict.h"

#define FIT_UNITS 4u /* evaluations in one piece */
/* Spread that levels of three time constants leave, share of the gain. */
#define SPREAD_LEFT REAL_C(0.1)
#define HOPELESS    REAL_C(1.0) /* standard deviation over gain from which a fit says nothing */
#define CLIMB_SDS   REAL_C(4.0) /* standard deviations by which a climb exceeds the noise */
/* Share of the misfit that a bent drift may leave if it, and not the shape of the response, was the cause. */
#define BENT_LEAVES  REAL_C(0.3)
#define MISFIT_SHARE REAL_C(1.2) /* error of the gain, over the misfit of a first-order model */
/* Time constants of a level after which half of the response is missing. */
#define SLOW_LAGS REAL_C(0.7)
#define BEND_SDS  REAL_C(2.0)
/* Variances of a point that a bend must explain; it has an instant, a slope and a step. */
#define BENT_BETTER REAL_C(12.0)
#define NO_NOISE    REAL_C(0.5) /* of the residual variance: the response is not that of one lag */
/* Least share of a response that levels must show to give the gain. */
#define LEVEL_LEAST        REAL_C(0.8)
#define LEVEL_DOUBT        REAL_C(0.25) /* share of the difference between fit and levels */
#define LEVEL_SD_RATIO_MAX REAL_C(0.5)  /* of the deviation of the fit, to use the levels instead */
#define UNSEEN_DOUBT       REAL_C(0.5) /* share of the part of a response that a cut test has not shown */
/* Of the deviation of the dead time of the fit, likewise. */
#define BEGINNING_SD_RATIO_MAX REAL_C(0.5)
#define ASYMMETRY_MOST         REAL_C(2000.0)
#define ASYMMETRY_AGAIN        REAL_C(2.5) /* factor between two tests of the same asymmetry */

/* Error of a gain by a bend: docs/commissioning-method.md. */
#define BEND_SHARE (REAL_C(1.0) / REAL_C(8.0))

real_t model_unseen(const struct experiment *x, const struct identified *fit)
{
    real_t seen_s = experiment_half_s(x) - fit->dead_time_s;
    if (seen_s <= REAL_C(0.0))
        return REAL_C(1.0);
    return fit->time_constant_s > REAL_C(0.0) ? real_exp(-seen_s / fit->time_constant_s)
                                              : REAL_C(0.0);
}

void model_begin_fit(struct commission *c)
{
    c->model.output = 0;
    c->model.running = false;
    c->model.error = ERR_OK;
}

/* The latest test of input k lasted longer than the one before, to show the end of a response. */
static bool was_longer(const struct commission *c, uint8_t k)
{
    const struct experiment *x = &c->work->experiment;
    return inputs_get(&c->inputs, k)->unsettled &&
           experiment_half(x) >= experiment_settings(x)->half_least &&
           experiment_settings(x)->half_least <
               experiment_settings(x)->half_most; /* else there was no room for it */
}

void model_keep(struct commission *c)
{
    uint8_t k = inputs_current(&c->inputs);
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        struct element *e = &c->work->element[j][k];
        if (inputs_get(&c->inputs, k)->rounds == 0) {
            e->fit = c->model.fitted[j];
            e->misfit = c->model.misfit[j];
        } else {
            real_t misfit =
                combine_by_gains(e->misfit, &e->fit, c->model.misfit[j], &c->model.fitted[j]);
            model_combine(&e->fit, &c->model.fitted[j]);
            /* A response that goes on would have grown in a longer test; one that is gone was noise. */
            if (was_longer(c, k) && (c->model.fitted[j].flags & IDENTIFIED_NO_GAIN))
                e->fit.flags &= (uint16_t)~CERTAINTY_OPEN_FLAGS;
            e->misfit = misfit;
        }
        /* The deviation from the shape of a lag is the same in every round. */
        if (e->fit.gain_sd < e->misfit)
            e->fit.gain_sd = e->misfit;
    }
}

/* Begins with an output of the finished test: moments at once, then the fit in pieces. */
static void begin_output(struct commission *c)
{
    const struct experiment *x = &c->work->experiment;
    uint8_t j = c->model.output;
    struct element *e = &c->work->element[j][inputs_current(&c->inputs)];
    struct baseline b;
    struct identified moments;
    enum err err = experiment_baseline(x, j, &b);
    if (!err)
        err = moments_element(experiment_moments(x), j, &experiment_record(x)->input, &b,
                              REAL_C(0.0), &moments, NULL);
    bool have_moments = !err;
    if (have_moments) {
        e->moments = (struct fopdt){.gain = moments.gain,
                                    .dead_time_s = moments.dead_time_s,
                                    .time_constant_s = moments.time_constant_s};
        e->moments_flags = moments.flags;
    }
    struct fopdt_fit_options o = {
        .baseline = b,
        .start = have_moments && !(moments.flags & IDENTIFIED_NO_GAIN) ? &moments : NULL};
    c->model.bent = false;
    err = fopdt_fit_begin(interim_fit_memory(experiment_interim_fit(&c->work->experiment)),
                          experiment_record(x), j, &o);
    if (err)
        c->model.error = err;
    c->model.running = !err;
}

/* Slope after the test that the end of the response explains, fraction of span per second. */
static real_t tail_slope(const struct experiment *x, uint8_t j, const struct identified *fit)
{
    const struct excitation *u = &experiment_record(x)->input;
    if (u->edges == 0 || !(fit->time_constant_s > REAL_C(0.0)))
        return REAL_C(0.0);
    real_t since_s = (real_t)(experiment_samples(x) - u->edge[u->edges - 1u].sample) *
                     experiment_settings(x)->h_s;
    real_t gone_s = since_s - experiment_after(x, j)->age_s - fit->dead_time_s;
    real_t share = gone_s > REAL_C(0.0) ? real_exp(-gone_s / fit->time_constant_s) : REAL_C(1.0);
    return real_abs(fit->gain) * experiment_amplitude(x) * share / fit->time_constant_s;
}

/* Change of the drift's slope over the test beyond the end of the response, fraction of span per second; 0 where that is not
 * significant. */
static real_t drift_bend(const struct experiment *x, uint8_t j, const struct identified *fit)
{
    real_t sd, bend = real_abs(experiment_bend(x, j, &sd));
    bend -= REAL_C(2.0) * tail_slope(x, j, fit);
    return bend > BEND_SDS * sd ? bend : REAL_C(0.0);
}

static real_t sure_slope(const struct steady_result *at)
{
    real_t slope = real_abs(at->slope_per_s) - BEND_SDS * at->slope_sd_per_s;
    return slope > REAL_C(0.0) ? slope : REAL_C(0.0);
}

/* Takes the gain from the levels where the response is not that of one lag (a fast part and a slow tail, or different lags
 * up and down). The fit then does not know where the response ends, and its deviation shows that. The gain is half way
 * between the levels and the final value of the fit; the other half counts as standard deviation. */
static bool take_level(const struct experiment *x, const struct test_verdict *v,
                       struct identified *fit)
{
    real_t of = test_verdict_level_of(experiment_record(x), fit->dead_time_s, fit->time_constant_s);
    if (!(v->level_sd > REAL_C(0.0)) || experiment_is_cut(x) || of < LEVEL_LEAST ||
        (fit->flags & IDENTIFIED_NO_GAIN))
        return false;
    real_t to_come = REAL_C(0.5) * (REAL_C(1.0) / of - REAL_C(1.0)) * v->level;
    real_t gain = v->level + to_come, doubt = LEVEL_DOUBT * (gain - fit->gain);
    real_t sd = real_sqrt(v->level_sd * v->level_sd + to_come * to_come + doubt * doubt);
    if (!(sd < LEVEL_SD_RATIO_MAX * fit->gain_sd) || v->level * fit->gain <= REAL_C(0.0))
        return false;
    fit->gain = gain;
    fit->gain_sd = sd;
    return true;
}

/* Takes the beginning of such a response, which is faster than the lag that fits all of it and matters most for a loop. The
 * long record is too coarse for it, an early interim fit was not. */
static void take_beginning(struct element *e, const struct experiment *x, uint8_t j,
                           const struct identified *fit)
{
    real_t slope = experiment_early(x, j)->slope;
    if (!(slope * fit->time_constant_s > real_abs(fit->gain)) ||
        !(experiment_early(x, j)->dead_sd_s < BEGINNING_SD_RATIO_MAX * fit->dead_time_sd_s))
        return;
    e->early_slope = slope;
    e->early_dead_s = experiment_early(x, j)->dead_s + experiment_early(x, j)->dead_sd_s;
}

/* The output is not linear: it responds differently up and down, and in the same way every time, which a disturbance does
 * not. The mean of both is then the gain, up to third-order terms. */
static bool is_curved(struct commission *c, const struct test_verdict *v)
{
    struct element *e = &c->work->element[c->model.output][inputs_current(&c->inputs)];
    real_t now = REAL_C(0.0), before = (real_t)e->asymmetry;
    if (v->asymmetry > REAL_C(0.0) || v->asymmetry < REAL_C(0.0))
        now = ASYMMETRY_UNIT * v->asymmetry / v->level;
    if (!(real_abs(now) < ASYMMETRY_MOST)) /* no gain to speak of */
        now = REAL_C(0.0);
    e->asymmetry = (int16_t)now;
    if (inputs_small_step(&c->inputs) > REAL_C(0.0))
        return e->asymmetry != 0;
    real_t ratio = before > REAL_C(0.0) || before < REAL_C(0.0) ? now / before : REAL_C(0.0);
    return ratio > REAL_C(1.0) / ASYMMETRY_AGAIN && ratio < ASYMMETRY_AGAIN;
}

/* Judges whether the output goes on climbing. bend: of its drift, not taken off. */
static void verdict_on_climb(struct commission *c, const struct test_verdict *v, real_t bend,
                             const struct identified *fit)
{
    const struct experiment *x = &c->work->experiment;
    real_t half_s = experiment_half_s(x);
    /* A constant drift cancels in the changes; a drift that bends does not. */
    real_t explained = CLIMB_SDS * v->change_sd + bend * half_s;
    real_t lag_s = fit->time_constant_s + REAL_C(2.0) * fit->time_constant_sd_s;
    bool slow = (fit->flags & (IDENTIFIED_INTEGRATING | IDENTIFIED_SHORT)) ||
                fit->dead_time_s + SLOW_LAGS * lag_s > half_s;
    c->model.climbs[c->model.output] = slow && v->second > explained ? v->climbs : REAL_C(0.0);
}

/* Judges the gain by the record alone: a drift that is not a straight line makes the three parts of a double step disagree,
 * and the fit cannot know that. */
static void verdict_on_gain(struct commission *c, const struct test_verdict *v, real_t bend,
                            real_t misfit, real_t share, struct identified *fit)
{
    const struct experiment *x = &c->work->experiment;
    if (share > NO_NOISE && take_level(x, v, fit)) {
        take_beginning(&c->work->element[c->model.output][inputs_current(&c->inputs)], x,
                       c->model.output, fit);
        misfit = REAL_C(0.0); /* the residual is no error of the levels; theirs comes again */
        share = REAL_C(1.0);
    }
    real_t spread = v->spread;
    real_t variance = fit->gain_sd * fit->gain_sd;
    if (is_curved(c, v)) {
        real_t third = v->asymmetry * v->asymmetry / (REAL_C(4.0) * v->level);
        variance += third * third;
        spread = v->left;
    }
    real_t more = REAL_C(0.5) * (spread - SPREAD_LEFT * real_abs(fit->gain));
    if (more > REAL_C(0.0))
        variance += more * more;
    real_t duration_s = (real_t)experiment_samples(x) * experiment_settings(x)->h_s;
    real_t left = BEND_SHARE * bend * duration_s / experiment_amplitude(x);
    variance += left * left;
    real_t wrong = MISFIT_SHARE * misfit / experiment_amplitude(x);
    /* The part of the fit's deviation by those residuals comes again in every round, too. */
    real_t again = share * fit->gain_sd * fit->gain_sd + wrong * wrong;
    variance += wrong * wrong;
    /* After a cut test the fit alone predicts the part that was not seen. */
    if (experiment_is_cut(x)) {
        real_t unseen = UNSEEN_DOUBT * model_unseen(x, fit);
        real_t gain_sd = unseen * fit->gain, lag_sd = unseen * fit->time_constant_s;
        variance += gain_sd * gain_sd;
        fit->time_constant_sd_s =
            real_sqrt(fit->time_constant_sd_s * fit->time_constant_sd_s + lag_sd * lag_sd);
    }
    c->model.misfit[c->model.output] = real_sqrt(again);
    fit->gain_sd = real_sqrt(variance);
}

/* Uses the moments where the fit says nothing of the gain, because the response is not that of a lag. They weigh the
 * beginning most, so the gain is known no better than its size. */
static void use_moments(const struct element *e, struct identified *fit)
{
    real_t size = real_abs(e->moments.gain);
    fit->gain = e->moments.gain;
    fit->time_constant_s = e->moments.time_constant_s;
    fit->dead_time_s = e->moments.dead_time_s;
    if (fit->gain_sd > size)
        fit->gain_sd = size;
    fit->time_constant_sd_s = fit->time_constant_s;
    fit->dead_time_sd_s = fit->dead_time_s;
}

/* Removes the bend that the fit has found from the record of output j. */
static void straighten(struct record *r, uint8_t j, const struct fopdt_fit_result *f)
{
    for (uint32_t i = 0; i < r->points; i++) {
        real_t since_s = record_time(r, i) + REAL_C(0.5) * r->h_s - f->bend_at_s;
        if (since_s > REAL_C(0.0))
            r->y[j][i] -= f->bend_step + f->bend_per_s * since_s;
    }
}

/* After the fit with a straight drift: fits once more with a drift that turns, where it has turned. */
static bool fit_again(struct commission *c, const struct fopdt_fit_result *straight)
{
    struct experiment *x = &c->work->experiment;
    struct fopdt_fit_options o = {.bent = true, .start = &c->model.fitted[c->model.output]};
    real_t sd, bend = real_abs(experiment_bend(x, c->model.output, &sd));
    if (!(bend >
          BEND_SDS * sd)) /* how much of it is the response's tail is known only afterwards */
        return false;
    experiment_baseline_before(x, c->model.output, &o.baseline);
    c->model.squares = straight->squares;
    c->model.bent = c->model.running =
        fopdt_fit_begin(interim_fit_memory(experiment_interim_fit(x)), experiment_record(x),
                        c->model.output, &o) == ERR_OK;
    return c->model.bent;
}

/* A drift that turns explains the record significantly better. */
static bool bent_is_better(const struct commission *c, const struct fopdt_fit_result *bent)
{
    real_t r = bent->correlation, variance = bent->residual_sd * bent->residual_sd;
    variance *= (REAL_C(1.0) + r) / (REAL_C(1.0) - r);
    return c->model.squares - bent->squares > BENT_BETTER * variance;
}

/* Share of the remaining variance that is not noise. */
static real_t misfit_share(const struct fopdt_fit_result *r)
{
    real_t all = r->residual_sd * r->residual_sd, part = r->misfit * r->misfit;
    return part < all ? part / all : REAL_C(1.0);
}

static void verdict_of_output(const struct experiment *x, uint8_t j, const struct baseline *b,
                              struct test_verdict *v)
{
    test_verdict_of(experiment_record(x), j, b, experiment_amplitude(x),
                    sure_slope(experiment_before(x, j)), v);
}

/* Takes the fits of an output; bent is NULL where its drift has not turned. */
static void take_fits(struct commission *c, const struct fopdt_fit_result *bent)
{
    struct experiment *x = &c->work->experiment;
    uint8_t j = c->model.output;
    struct identified *kept = &c->model.fitted[j];
    struct element *e = &c->work->element[j][inputs_current(&c->inputs)];
    struct baseline b;
    struct test_verdict v;
    bool usable = bent && !(bent->element.flags & (IDENTIFIED_NO_GAIN | IDENTIFIED_INTEGRATING)) &&
                  (drift_bend(x, j, &bent->element) > REAL_C(0.0) ||
                   bent->misfit < BENT_LEAVES * c->model.straight_misfit);
    if (usable && bent_is_better(c, bent)) {
        e->plateau_gain = bent->plateau_gain;
        *kept = bent->element;
        straighten(experiment_record_to_edit(x), j, bent);
        b = (struct baseline){.offset = bent->offset,
                              .slope_per_s = bent->slope_per_s,
                              .noise_sd = experiment_before(x, j)->noise_sd};
        verdict_of_output(x, j, &b, &v);
        verdict_on_climb(c, &v, REAL_C(0.0), kept);
        verdict_on_gain(c, &v, REAL_C(0.0), bent->misfit, misfit_share(bent), kept);
        return;
    }
    real_t bend = drift_bend(x, j, kept);
    bool straight = experiment_baseline(x, j, &b) == ERR_OK;
    c->model.climbs[j] = c->model.misfit[j] = REAL_C(0.0);
    if (straight) {
        verdict_of_output(x, j, &b, &v);
        verdict_on_climb(c, &v, bend, kept);
    }
    if (usable) { /* it turned before the step, or after all was over; how much else it could be is known */
        real_t apart = bent->element.gain - kept->gain;
        kept->gain_sd = real_sqrt(kept->gain_sd * kept->gain_sd + apart * apart);
    }
    if (kept->gain_sd > HOPELESS * real_abs(kept->gain) && !(kept->flags & IDENTIFIED_NO_GAIN))
        use_moments(e, kept);
    if (straight && usable)
        verdict_on_gain(c, &v, REAL_C(0.0), bent->misfit, misfit_share(bent), kept);
    else if (straight)
        verdict_on_gain(c, &v, bend, c->model.straight_misfit, c->model.straight_share, kept);
}

/* Ends a fit. True: another one follows for this output. */
static bool end_fit(struct commission *c, const struct fopdt_fit_result *r)
{
    uint8_t j = c->model.output;
    if (c->model.bent) {
        take_fits(c, r);
        return false;
    }
    c->work->element[j][inputs_current(&c->inputs)].plateau_gain = r->plateau_gain;
    c->model.fitted[j] = r->element;
    c->model.straight_misfit = r->misfit;
    c->model.straight_share = misfit_share(r);
    if (fit_again(c, r))
        return true;
    take_fits(c, NULL);
    return false;
}

bool model_piece(struct commission *c)
{
    if (!c->model.running) {
        if (c->model.output >= outputs_count(&c->outputs) || c->model.error)
            return false;
        begin_output(c);
        return true;
    }
    if (!fopdt_fit_run(interim_fit_memory(experiment_interim_fit(&c->work->experiment)), FIT_UNITS))
        return true;
    struct fopdt_fit_result r;
    enum err err =
        fopdt_fit_result(interim_fit_memory(experiment_interim_fit(&c->work->experiment)), &r);
    if (err) {
        c->model.error = err;
        return false;
    }
    c->model.running = false;
    if (end_fit(c, &r))
        return true;
    c->model.output++;
    return c->model.output < outputs_count(&c->outputs);
}
