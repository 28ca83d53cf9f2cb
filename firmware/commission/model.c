#include "supervise/config.h"
#if COMMISSION_CHANNELS

#include "commission/judge.h"
#include "commission/model.h"

#include <string.h>

#define FIT_UNITS   4u           /* evaluations in one piece */
#define GAIN_FLOOR  REAL_C(0.01) /* a first-order model is not the plant: no gain is known better */
#define SPREAD_LEFT REAL_C(0.1)  /* of the gain: what levels of three time constants leave */
#define HOPELESS    REAL_C(1.0)  /* standard deviation over gain from which a fit says nothing */
#define STEP        REAL_C(0.05) /* of the predicted setpoint steps, fraction of span */

#define CLIMB_SDS  REAL_C(4.0) /* what goes on climbing stands out of the noise by so much */
#define BEND_SDS   REAL_C(2.0)
#define BEND_SHARE (REAL_C(1.0) / REAL_C(8.0)) /* docs/commissioning.md: what a bend leaves */

static real_t weight(real_t sd, real_t size)
{
    real_t floor = REAL_C(1e-4) * real_abs(size) + REAL_C(1e-9);
    real_t used = sd > floor ? sd : floor;
    return REAL_C(1.0) / (used * used);
}

static real_t mean_of(real_t a, real_t wa, real_t b, real_t wb)
{
    return (wa * a + wb * b) / (wa + wb);
}

/* Without a lag to be seen the deviations of the times say nothing, however small. */
static bool has_times(const struct identified *e)
{
    return !(e->flags & IDENTIFIED_NO_GAIN) && e->time_constant_s > REAL_C(0.0) &&
           e->time_constant_sd_s > REAL_C(0.0);
}

void model_combine(struct identified *sum, const struct identified *next)
{
    real_t ws = weight(sum->gain_sd, sum->gain), wn = weight(next->gain_sd, next->gain);
    real_t sd = REAL_C(1.0) / real_sqrt(ws + wn);
    /* Rounds that disagree by more than their deviations allow are less sure than they say (Birge 1932). */
    real_t apart = sum->gain - next->gain;
    real_t allowed = sum->gain_sd * sum->gain_sd + next->gain_sd * next->gain_sd;
    if (apart * apart > allowed && allowed > REAL_C(0.0))
        sd *= real_abs(apart) / real_sqrt(allowed);
    bool times_s = has_times(sum), times_n = has_times(next);
    real_t gain = mean_of(sum->gain, ws, next->gain, wn);
    if (times_s && times_n) {
        real_t wt = weight(sum->time_constant_sd_s, sum->time_constant_s);
        real_t wu = weight(next->time_constant_sd_s, next->time_constant_s);
        sum->time_constant_s = mean_of(sum->time_constant_s, wt, next->time_constant_s, wu);
        sum->time_constant_sd_s = REAL_C(1.0) / real_sqrt(wt + wu);
        real_t wl = weight(sum->dead_time_sd_s, sum->dead_time_s);
        real_t wm = weight(next->dead_time_sd_s, next->dead_time_s);
        sum->dead_time_s = mean_of(sum->dead_time_s, wl, next->dead_time_s, wm);
        sum->dead_time_sd_s = REAL_C(1.0) / real_sqrt(wl + wm);
    } else if (times_n) {
        real_t old_gain = sum->gain, old_sd = sum->gain_sd;
        *sum = *next;
        sum->gain = old_gain; /* replaced below; only the times were missing */
        sum->gain_sd = old_sd;
    }
    sum->gain = gain;
    sum->gain_sd = sd;
    if (real_abs(gain) > REAL_C(3.0) * sd && (times_s || times_n))
        sum->flags &= (uint16_t)~IDENTIFIED_NO_GAIN;
    sum->flags |= (uint16_t)(next->flags & ~IDENTIFIED_NO_GAIN);
}

void model_begin_fit(struct commission *c)
{
    c->fit_at = 0;
    c->fit_running = false;
    c->job_error = ERR_OK;
}

void model_keep(struct commission *c)
{
    uint8_t k = c->order[c->at];
    for (uint8_t j = 0; j < c->outputs; j++) {
        struct element *e = &c->element[j][k];
        if (c->input[k].rounds == 0)
            e->fit = c->fitted[j];
        else
            model_combine(&e->fit, &c->fitted[j]);
    }
}

/* One output of the test that has just ended: moments at once, then the fit in pieces. */
static void begin_output(struct commission *c)
{
    const struct experiment *x = &c->work.test.experiment;
    uint8_t j = c->fit_at;
    struct element *e = &c->element[j][c->order[c->at]];
    struct baseline b;
    struct identified moments;
    enum err err = experiment_baseline(x, j, &b);
    if (!err)
        err = moments_element(&x->moments, j, &x->record.input, &b, REAL_C(0.0), &moments, NULL);
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
    err = fopdt_fit_begin(&c->work.test.experiment.look.fit, &x->record, j, &o);
    if (err)
        c->job_error = err;
    c->fit_running = !err;
}

/* What is left of the response itself in the slope after the test: fraction of span per second. */
static real_t tail_slope(const struct experiment *x, uint8_t j, const struct identified *fit)
{
    const struct excitation *u = &x->record.input;
    if (u->edges == 0 || !(fit->time_constant_s > REAL_C(0.0)))
        return REAL_C(0.0);
    real_t since_s = (real_t)(x->samples - u->edge[u->edges - 1u].sample) * x->config.h_s;
    real_t gone_s = since_s - x->after[j].age_s - fit->dead_time_s;
    real_t share = gone_s > REAL_C(0.0) ? real_exp(-gone_s / fit->time_constant_s) : REAL_C(1.0);
    return real_abs(fit->gain) * x->amplitude * share / fit->time_constant_s;
}

/* What the record says by itself: a bent drift makes the three parts of a double step disagree about the gain, and the
 * fit cannot know. */
static void judge(struct commission *c, struct identified *fit)
{
    const struct experiment *x = &c->work.test.experiment;
    struct judgement verdict;
    struct baseline b;
    if (experiment_baseline(x, c->fit_at, &b) != ERR_OK)
        return;
    judge_record(&x->record, c->fit_at, &b, x->amplitude, &verdict);
    real_t bend_sd, bend = real_abs(experiment_bend(x, c->fit_at, &bend_sd));
    real_t tail = REAL_C(2.0) * tail_slope(x, c->fit_at, fit);
    bend = bend > tail ? bend - tail : REAL_C(0.0);
    real_t half_s = (real_t)x->half * x->config.h_s;
    /* A drift that is the same in both halves cancels in the changes; one that bends does not. */
    real_t explained = CLIMB_SDS * verdict.change_sd + bend * half_s;
    bool slow = (fit->flags & (IDENTIFIED_INTEGRATING | IDENTIFIED_SHORT)) ||
                fit->dead_time_s + fit->time_constant_s > REAL_C(0.75) * half_s;
    c->climbs[c->fit_at] = slow && verdict.second > explained ? verdict.climbs : REAL_C(0.0);
    real_t more = REAL_C(0.5) * (verdict.spread - SPREAD_LEFT * real_abs(fit->gain));
    real_t variance = fit->gain_sd * fit->gain_sd;
    if (more > REAL_C(0.0))
        variance += more * more;
    if (bend > BEND_SDS * bend_sd) {
        real_t duration_s = (real_t)x->samples * x->config.h_s;
        real_t left = BEND_SHARE * bend * duration_s / x->amplitude;
        variance += left * left;
    }
    fit->gain_sd = real_sqrt(variance);
}

/* A fit that says nothing of the gain, because the response is not that of a lag: the moments' answer, which weighs the
 * beginning most, stands instead, as no better known than its size. */
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

static bool fit_piece(struct commission *c)
{
    if (!c->fit_running) {
        if (c->fit_at >= c->outputs || c->job_error)
            return false;
        begin_output(c);
        return true;
    }
    if (!fopdt_fit_run(&c->work.test.experiment.look.fit, FIT_UNITS))
        return true;
    struct fopdt_fit_result r;
    enum err err = fopdt_fit_result(&c->work.test.experiment.look.fit, &r);
    if (err) {
        c->job_error = err;
        return false;
    }
    c->element[c->fit_at][c->order[c->at]].plateau_gain = r.plateau_gain;
    if (r.element.gain_sd > HOPELESS * real_abs(r.element.gain) &&
        !(r.element.flags & IDENTIFIED_NO_GAIN))
        use_moments(&c->element[c->fit_at][c->order[c->at]], &r.element);
    judge(c, &r.element);
    c->fitted[c->fit_at] = r.element;
    c->fit_running = false;
    c->fit_at++;
    return c->fit_at < c->outputs;
}

void model_begin_analysis(struct commission *c, const struct config *config, real_t h_s)
{
    struct analysis *a = &c->work.analysis;
    memset(&a->plant, 0, sizeof a->plant);
    a->plant.outputs = c->outputs;
    uint8_t n = 0;
    for (uint8_t k = 0; k < c->inputs; k++) {
        if (c->input[k].skipped)
            continue;
        for (uint8_t j = 0; j < c->outputs; j++) {
            const struct identified *e = &c->element[j][k].fit;
            a->plant.element[j][n] = (struct fopdt){.gain = e->gain,
                                                    .dead_time_s = e->dead_time_s,
                                                    .time_constant_s = e->time_constant_s};
            a->plant.gain_sd[j][n] = e->gain_sd;
        }
        c->column[n++] = k;
    }
    a->plant.inputs = n;
    c->settings = (struct analysis_config){.h_s = h_s,
                                           .confidence = config->test.confidence,
                                           .floor = GAIN_FLOOR,
                                           .step = STEP,
                                           .loops_max = CONFIG_LOOPS};
    c->analysis_begun = false;
    c->job_error = n == 0 ? ERR_EMPTY : ERR_OK;
}

static bool analysis_piece(struct commission *c)
{
    if (c->job_error)
        return false;
    enum err err = c->analysis_begun ? analysis_step(&c->work.analysis)
                                     : analysis_begin(&c->work.analysis, &c->settings);
    if (err && err != ERR_BUSY)
        c->job_error = err;
    bool more = err == ERR_BUSY || (!c->analysis_begun && !err);
    c->analysis_begun = true;
    return more;
}

bool model_work(struct commission *c, enum model_job job)
{
    if (job == JOB_LOOK)
        return look_run(&c->work.test.experiment.look);
    if (job == JOB_FIT)
        return fit_piece(c);
    return analysis_piece(c);
}

#endif
