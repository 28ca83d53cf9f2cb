#include "commission/model.h"

#include "base/assertion.h"
#include "commission/certainty.h"
#include "commission/combine.h"
#include "commission/commission_state.h"
#include "commission/direction_sum.h"
#include "commission/experiment.h"
#include "commission/test_inputs.h"
#include "commission/test_outputs.h"
#include "commission/test_verdict.h"
#include "identify/shape_curve.h"
#include "identify/shape_tail.h"

#define FIT_UNITS  2u             /* evaluations in one piece: of a curved output each is long */
#define UNIFORM_SD REAL_C(0.2887) /* standard deviation of a value within an interval of 1 */
#define CLIMB_SDS  REAL_C(4.0)    /* standard deviations by which a climb exceeds the noise */
/* Share of the misfit that a bent drift may leave if it, and not the shape of the response, was the cause. */
#define BENT_LEAVES REAL_C(0.3)
/* Time constants of a level after which half of the response is missing. */
#define SLOW_LAGS REAL_C(0.7)
#define BEND_SDS  REAL_C(2.0)
/* Variances of a point that a bend must explain; it has an instant, a slope and a step. */
#define BENT_BETTER    REAL_C(12.0)
#define ASYMMETRY_MOST REAL_C(2000.0)

/* Error of a gain by a bend: docs/inside/commissioning.md. */
#define BEND_SHARE (REAL_C(1.0) / REAL_C(8.0))

/* Fits of an output: one lag with a straight drift, one lag with a drift that turns, a shape that competes with that drift, the
 * shape that stands. */
enum { STAGE_BEGIN, STAGE_STRAIGHT, STAGE_BENT, STAGE_RIVAL, STAGE_SHAPE };

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
    c->model.stage = STAGE_BEGIN;
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

static uint16_t flags_of_kind(const struct shape_found *f)
{
    static const uint16_t flags[] = {[SHAPE_UNKNOWN] = IDENTIFIED_UNKNOWN,
                                     [SHAPE_NO_RESPONSE] = IDENTIFIED_NO_GAIN,
                                     [SHAPE_INTEGRATING] = IDENTIFIED_RAMP,
                                     [SHAPE_SLOW] = IDENTIFIED_SLOW,
                                     [SHAPE_PERHAPS_SLOW] = IDENTIFIED_SLOW};
    REFLUX_ASSERT(f->kind <= SHAPE_PERHAPS_SLOW);
    bool inverse = f->parameters > 4 && f->shape.zero_s < REAL_C(0.0);
    return (uint16_t)(flags[f->kind] | (inverse ? IDENTIFIED_INVERSE : 0));
}

void model_keep(struct commission *c)
{
    uint8_t k = inputs_current(&c->inputs);
    struct interim_fit *fits = experiment_interim_fit(&c->work->experiment);
    for (uint8_t j = 0; j < outputs_count(&c->outputs); j++) {
        struct element *e = &c->work->element[j][k];
        const struct shape_found *found = interim_fit_shape(fits, j);
        if (inputs_get(&c->inputs, k)->rounds == 0)
            e->found = *found;
        else
            combine_shapes(&e->found, found, was_longer(c, k));
        e->flags = flags_of_kind(&e->found);
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
    c->model.plateau_read = false;
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
    err = fopdt_fit_begin(interim_fit_memory(experiment_interim_fit(&c->work->experiment)),
                          experiment_record(x), j, &o);
    if (err)
        c->model.error = err;
    else
        c->model.stage = STAGE_STRAIGHT;
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

/* Notes by how much the output responds differently up and down. */
static void note_asymmetry(struct commission *c, const struct test_verdict *v)
{
    real_t now = REAL_C(0.0);
    if (v->asymmetry > REAL_C(0.0) || v->asymmetry < REAL_C(0.0))
        now = ASYMMETRY_UNIT * v->asymmetry / v->level;
    if (!(real_abs(now) < ASYMMETRY_MOST)) /* no gain to speak of */
        now = REAL_C(0.0);
    c->work->element[c->model.output][inputs_current(&c->inputs)].asymmetry = (int16_t)now;
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
static bool fit_again(struct commission *c)
{
    struct experiment *x = &c->work->experiment;
    struct interim_fit *fits = experiment_interim_fit(x);
    struct fopdt_fit_options o = {.bent = true, .start = &fits->shape.straight.element};
    real_t sd, bend = real_abs(experiment_bend(x, c->model.output, &sd));
    if (!(bend >
          BEND_SDS * sd)) /* how much of it is the response's tail is known only afterwards */
        return false;
    experiment_baseline_before(x, c->model.output, &o.baseline);
    bool begun = fopdt_fit_begin(interim_fit_memory(fits), experiment_record(x), c->model.output,
                                 &o) == ERR_OK;
    if (begun)
        c->model.stage = STAGE_BENT;
    return begun;
}

static void verdict_of_output(struct commission *c, const struct baseline *b, real_t bend,
                              const struct identified *fit)
{
    const struct experiment *x = &c->work->experiment;
    uint8_t j = c->model.output;
    struct test_verdict v;
    test_verdict_of(experiment_record(x), j, b, experiment_amplitude(x),
                    sure_slope(experiment_before(x, j)), &v);
    verdict_on_climb(c, &v, bend, fit);
    note_asymmetry(c, &v);
}

/* The fit with a drift that turns may stand for the output. */
static bool bend_is_usable(const struct commission *c, const struct fopdt_fit_result *straight,
                           const struct fopdt_fit_result *bent)
{
    return !(bent->element.flags & (IDENTIFIED_NO_GAIN | IDENTIFIED_INTEGRATING)) &&
           (drift_bend(&c->work->experiment, c->model.output, &bent->element) > REAL_C(0.0) ||
            bent->misfit < BENT_LEAVES * straight->misfit);
}

/* Begins with the shape, from one lag. */
static void begin_shape(struct commission *c, const struct fopdt_fit_result *one, uint8_t stage)
{
    struct experiment *x = &c->work->experiment;
    struct fopdt_fit_options o = {0};
    experiment_baseline_before(x, c->model.output, &o.baseline);
    enum err err = shape_fit_begin(&experiment_interim_fit(x)->shape.fit, experiment_record(x),
                                   c->model.output, &o, one);
    if (err)
        c->model.error = err;
    c->model.stage = stage;
}

/* Judges an output whose drift is taken as straight. */
static void judge_straight(struct commission *c)
{
    const struct experiment *x = &c->work->experiment;
    uint8_t j = c->model.output;
    const struct identified *fit =
        &experiment_interim_fit(&c->work->experiment)->shape.straight.element;
    struct baseline b;
    c->model.doubt = c->model.sd_least = c->model.climbs[j] = REAL_C(0.0);
    if (experiment_baseline(x, j, &b) == ERR_OK)
        verdict_of_output(c, &b, drift_bend(x, j, fit), fit);
}

/* Takes the drift that turns off the record, and judges the output without it. */
static void take_bend(struct commission *c, const struct fopdt_fit_result *bent)
{
    struct experiment *x = &c->work->experiment;
    uint8_t j = c->model.output;
    struct baseline b = {.offset = bent->offset,
                         .slope_per_s = bent->slope_per_s,
                         .noise_sd = experiment_before(x, j)->noise_sd};
    c->work->element[j][inputs_current(&c->inputs)].plateau_gain = bent->plateau_gain;
    c->model.doubt = REAL_C(0.0);
    c->model.sd_least = bent->element.gain_sd; /* the shape knows nothing of the bend's error */
    straighten(experiment_record_to_edit(x), j, bent);
    verdict_of_output(c, &b, REAL_C(0.0), &bent->element);
}

/* Squares that the best formula leaves, and the variance of a point by them. */
static real_t shape_squares(const struct shape_fit *f, real_t *variance)
{
    const struct shape_candidate *best = &f->candidate[SHAPE_FORMULA_ONE];
    for (unsigned k = 0; k < SHAPE_FORMULAS; k++) {
        real_t squares = f->candidate[k].squares; /* below 0: not fitted */
        if (!(squares < REAL_C(0.0)) && squares < best->squares)
            best = &f->candidate[k];
    }
    *variance = best->squares / (real_t)f->points * (REAL_C(1.0) + best->correlation) /
                (REAL_C(1.0) - best->correlation);
    real_t with_tail = shape_tail_squares(f);
    return with_tail < best->squares ? with_tail : best->squares;
}

static real_t bend_variance(const struct fopdt_fit_result *bent)
{
    real_t r = bent->correlation;
    return bent->residual_sd * bent->residual_sd * (REAL_C(1.0) + r) / (REAL_C(1.0) - r);
}

/* Decides whether a drift that turns or the shape of the response is what one lag does not explain. A slow tail looks like a
 * turn, so the shape is asked first. True: the shape is to be fitted once more, without the turn. */
static bool bend_stands(struct commission *c, const struct shape_found *shape)
{
    struct interim_fit *fits = experiment_interim_fit(&c->work->experiment);
    const struct fopdt_fit_result *bent = &fits->shape.bent;
    real_t variance, rival = shape_squares(&fits->shape.fit, &variance);
    if (rival - bent->squares > BENT_BETTER * bend_variance(bent)) {
        take_bend(c, bent);
        begin_shape(c, bent, STAGE_SHAPE);
        return true;
    }
    judge_straight(c);
    if (bent->squares - rival < BENT_BETTER * variance) { /* either may be true */
        real_t apart = bent->element.gain - shape->shape.gain;
        c->model.doubt += apart * apart;
    }
    return false;
}

/* Nothing explains the turn of the drift, if there is one: the error by it is a doubt. */
static void doubt_bend(struct commission *c)
{
    const struct experiment *x = &c->work->experiment;
    const struct identified *fit =
        &experiment_interim_fit(&c->work->experiment)->shape.straight.element;
    real_t duration_s = (real_t)experiment_samples(x) * experiment_settings(x)->h_s;
    real_t left =
        BEND_SHARE * drift_bend(x, c->model.output, fit) * duration_s / experiment_amplitude(x);
    c->model.doubt += left * left;
}

/* An asymmetry counts only where the fit has found terms of second order, because up and down also differ while a slow tail dies
 * away. The gain is then that at the operating point, but for terms of third order. */
static void judge_curve(struct commission *c, const struct shape *shape)
{
    struct element *e = &c->work->element[c->model.output][inputs_current(&c->inputs)];
    if (!shape_curve_is_on(&experiment_interim_fit(&c->work->experiment)->shape.fit))
        e->asymmetry = 0;
    real_t share = (real_t)e->asymmetry / ASYMMETRY_UNIT;
    real_t third = REAL_C(0.25) * share * share * shape->gain;
    c->model.doubt += third * third;
}

/* Reads the plateaus of a direction's response, in a piece of its own. False: they have been read, or it is none. */
static bool read_plateau(struct commission *c)
{
    if (!inputs_is_direction(&c->inputs) || c->model.plateau_read)
        return false;
    c->model.plateau_read = true;
    c->model.has_plateau = direction_plateau(c, c->model.output, &c->model.plateau);
    return true;
}

/* Takes the end of a direction's response from its plateaus where they say more than the shape. */
static void take_plateau(struct commission *c, struct shape_found *f)
{
    real_t gain = c->model.plateau, sd, within[15] = {0};
    bool straight = !(c->model.sd_least > REAL_C(0.0)); /* else the record was straightened */
    if (!straight || !c->model.has_plateau || !direction_plateau_sd(c, c->model.output, gain, &sd))
        return;
    bool open = (flags_of_kind(f) & CERTAINTY_OPEN_FLAGS) != 0;
    if (!open && f->sd[SHAPE_GAIN] < sd)
        return;
    within[0] = sd * sd;
    const struct shape s = {
        .gain = gain, .dead_time_s = f->shape.dead_time_s, .lag_s = f->shape.lag_s};
    shape_found_pack(f, &s, 3, &s, 3, REAL_C(0.0), within, REAL_C(0.0));
    f->kind = SHAPE_ONE_LAG;
}

/* A value that is renewed rarely is of any age up to the interval: so is what the fit takes for dead time, by the steps' luck. */
static void doubt_dead_time(const struct experiment *x, uint8_t j, struct shape_found *f)
{
    real_t age_s =
        (real_t)(experiment_renewal(x, j) - 1u) * experiment_settings(x)->h_s * UNIFORM_SD;
    f->sd[SHAPE_DEAD] = real_sqrt(f->sd[SHAPE_DEAD] * f->sd[SHAPE_DEAD] + age_s * age_s);
}

static void take_shape(struct commission *c)
{
    uint8_t j = c->model.output;
    struct interim_fit *fits = experiment_interim_fit(&c->work->experiment);
    struct shape_found *f = interim_fit_shape(fits, j);
    enum err err = shape_fit_result(&fits->shape.fit, f);
    if (err) {
        c->model.error = err;
        return;
    }
    if (c->model.stage == STAGE_RIVAL && bend_stands(c, f))
        return;
    judge_curve(c, &f->shape);
    if (inputs_is_direction(&c->inputs))
        take_plateau(c, f);
    real_t sd = f->sd[SHAPE_GAIN] > c->model.sd_least ? f->sd[SHAPE_GAIN] : c->model.sd_least;
    f->sd[SHAPE_GAIN] = real_sqrt(sd * sd + c->model.doubt);
    doubt_dead_time(&c->work->experiment, j, f);
    uint16_t flags = flags_of_kind(f);
    c->model.fitted[j] = element_of_found(f, flags);
    /* The end of an open shape is unknown, so the fit with one lag tells how long the response might take. */
    if (flags & CERTAINTY_OPEN_FLAGS) {
        const struct identified *lag = &fits->shape.straight.element;
        c->model.fitted[j] = *lag;
        c->model.fitted[j].flags = (uint16_t)(flags | (lag->flags & IDENTIFIED_INTEGRATING));
    }
    c->model.output++;
    c->model.stage = STAGE_BEGIN;
}

/* After the fits with one lag: the shape, which competes with a drift that turns where that may be what is left. */
static void end_lags(struct commission *c)
{
    struct interim_fit *fits = experiment_interim_fit(&c->work->experiment);
    const struct fopdt_fit_result *straight = &fits->shape.straight;
    if (c->model.stage == STAGE_BENT && bend_is_usable(c, straight, &fits->shape.bent)) {
        begin_shape(c, straight, STAGE_RIVAL);
        return;
    }
    judge_straight(c);
    doubt_bend(c);
    begin_shape(c, straight, STAGE_SHAPE);
}

/* A piece of a fit with one lag. */
static void piece_of_lag(struct commission *c)
{
    struct interim_fit *fits = experiment_interim_fit(&c->work->experiment);
    bool bent = c->model.stage == STAGE_BENT;
    struct fopdt_fit_result *r = bent ? &fits->shape.bent : &fits->shape.straight;
    if (!fopdt_fit_run(interim_fit_memory(fits), FIT_UNITS))
        return;
    enum err err = fopdt_fit_result(interim_fit_memory(fits), r);
    if (err) {
        c->model.error = err;
        return;
    }
    if (!bent)
        c->work->element[c->model.output][inputs_current(&c->inputs)].plateau_gain =
            r->plateau_gain;
    if (bent || !fit_again(c))
        end_lags(c);
}

bool model_piece(struct commission *c)
{
    if (c->model.output >= outputs_count(&c->outputs) || c->model.error)
        return false;
    if (c->model.stage == STAGE_BEGIN)
        begin_output(c);
    else if (c->model.stage < STAGE_RIVAL)
        piece_of_lag(c);
    else if (shape_fit_run(&experiment_interim_fit(&c->work->experiment)->shape.fit, FIT_UNITS) &&
             !read_plateau(c))
        take_shape(c);
    return c->model.output < outputs_count(&c->outputs) && !c->model.error;
}
