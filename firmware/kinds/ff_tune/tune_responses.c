#include "kinds/ff_tune/tune_responses.h"

#include "base/assertion.h"
#include "identify/disturbance_ratio.h"
#include "kinds/ff_tune/tune_responses_state.h"

#define ONE REAL_C(1.0)

/* The grid where no band is set: rad per sample, and times the corner of the high-pass. */
#define GRID_LO    REAL_C(0.02)
#define GRID_HI    REAL_C(0.8)
#define ABOVE_BIAS REAL_C(4.0)
/* Half of the largest sensitivity bounds the band, if the sensitivity stays below 0 dB. */
#define BELOW_PEAK REAL_C(0.5)
/* Looks in a row that find no change. */
#define SETTLED_LOOKS 2u

void tune_responses_grid(struct tune_responses *r, const struct tune_context *c)
{
    real_t lo = c->s.band_lo, hi = c->s.band_hi;
    if (!(lo > 0)) {
        real_t bias = c->s.bias_s > 0 ? c->s.bias_s : REAL_C(0.25) * c->s.learn_s;
        real_t above = ABOVE_BIAS / bias;
        hi = GRID_HI / c->h_s;
        lo = GRID_LO / c->h_s;
        lo = above > lo && above < REAL_C(0.5) * hi ? above : lo;
    }
    real_t step = real_log(hi / lo) / (real_t)(FEEDFORWARD_POINTS - 1u);
    r->band.points = FEEDFORWARD_POINTS;
    for (unsigned i = 0; i < r->band.points; i++)
        r->band.omega[i] = lo * real_exp(step * (real_t)i);
}

void tune_responses_unsettle(struct tune_responses *r)
{
    r->settled_looks = 0;
}

void tune_responses_begin(struct tune_responses *r)
{
    r->settled_looks = 0;
    r->change = ONE;
}

/* ---- a look ---- */

void tune_responses_look(struct tune_responses *r)
{
    r->moved = r->size = 0;
}

/* By how much it has moved since the last look, weighted as J is. */
static void compare_looks(struct tune_responses *r, unsigned i, struct cplx before,
                          struct cplx after)
{
    real_t weight = ONE / r->band.omega[i];
    r->moved += weight * cplx_abs(cplx_sub(after, before));
    r->size += weight * cplx_abs(after);
}

enum err tune_responses_point(struct tune_responses *r, const struct tune_context *c,
                              const struct high_order *estimator, unsigned i, bool of_loop)
{
    REFLUX_ASSERT(i < r->band.points && r->band.points <= FEEDFORWARD_POINTS);
    real_t omega_h = r->band.omega[i] * c->h_s;
    bool staged = tune_is_staged(c);
    struct high_order_point *to = of_loop  ? &r->loop[i]
                                  : staged ? &r->disturbance[i]
                                           : &r->band.ratio[i];
    struct cplx before = to->value;
    enum err err;
    if (staged) {
        err = high_order_response(estimator, 0, omega_h, to);
    } else {
        err = high_order_ratio(estimator, omega_h, to);
        if (!err)
            err = high_order_response(estimator, 0, omega_h, &r->loop[i]);
    }
    if (!err)
        compare_looks(r, i, before, to->value);
    return err;
}

void tune_responses_looked(struct tune_responses *r)
{
    r->change = r->size > 0 ? r->moved / r->size : ONE;
}

bool tune_responses_settled(struct tune_responses *r, const struct tune_context *c)
{
    r->settled_looks = (uint8_t)(r->change * 100 < c->s.settled ? r->settled_looks + 1u : 0u);
    return r->settled_looks >= SETTLED_LOOKS;
}

real_t tune_responses_change(const struct tune_responses *r)
{
    return r->change;
}

/* ---- the ratio, and where it counts ---- */

/* The loop with the controller and the element that it has. */
static struct loop_response loop_at(const struct tune_context *c, real_t omega)
{
    struct loop_response l;
    const struct feedforward_shape element = {
        .k = c->s.k, .lead = c->s.lead_s, .lag = c->s.lag_s, .dead = c->s.dead_s};
    loop_response_of_pi(&l, c->s.gain, c->s.ti_s, c->s.b, true, c->tick_s, omega * c->tick_s);
    l.feedforward = feedforward_response(&element, c->tick_s, omega);
    return l;
}

/* Makes process, ratio and sensitivity of a point. The process of A and B is what was identified. */
static enum err ratio_at_point(struct tune_responses *r, const struct tune_context *c, unsigned i,
                               struct high_order_point *sensitivity)
{
    struct loop_response l = loop_at(c, r->band.omega[i]);
    const struct high_order_point *loop = &r->loop[i], *of_d = &r->disturbance[i];
    struct high_order_point *process = &r->band.process[i], *ratio = &r->band.ratio[i];
    enum err err = ERR_OK;
    *process = *loop;
    switch (c->s.method) {
    case TUNE_SENSITIVITY:
        err = ratio_from_process(loop, of_d, &l, ratio);
        break;
    case TUNE_TRACKING:
        err = ratio_from_tracking(loop, of_d, &l, ratio);
        break;
    case TUNE_INPUT:
        err = ratio_from_input(loop, of_d, &l, ratio);
        break;
    default:
        break;
    }
    if (!err && (c->s.method == TUNE_TRACKING || c->s.method == TUNE_INPUT))
        err = process_from_tracking(loop, &l, process);
    return err ? err : sensitivity_from_ratio(process, ratio, &l, sensitivity);
}

/* The band is where the disturbance comes through the loop stronger than it is, without feedforward (Siddha, 3.2). It is contiguous, about
 * the largest sensitivity that is known. */
static enum tune_verdict find_band(struct tune_band *b, const struct tune_context *c,
                                   const struct high_order_point *sensitivity)
{
    real_t largest = 0;
    unsigned at = 0;
    for (unsigned i = 0; i < b->points; i++) {
        real_t size = cplx_abs(sensitivity[i].value);
        if (tune_is_known(c, &sensitivity[i]) && size > largest) {
            largest = size;
            at = i;
        }
    }
    if (!(largest > 0))
        return TUNE_UNSURE;
    b->from = 0;
    b->to = b->points;
    if (c->s.band_lo > 0)
        return TUNE_NONE;
    real_t level = largest > ONE ? ONE : BELOW_PEAK * largest;
    unsigned from = at, to = at + 1u;
    while (from > 0 && cplx_abs(sensitivity[from - 1u].value) > level)
        from--;
    while (to < b->points && cplx_abs(sensitivity[to].value) > level)
        to++;
    b->from = (uint8_t)from;
    b->to = (uint8_t)to;
    return to - from < TUNE_POINTS_LEAST ? TUNE_NO_BAND : TUNE_NONE;
}

enum tune_verdict tune_responses_ratio(struct tune_responses *r, const struct tune_context *c)
{
    REFLUX_ASSERT(r->band.points <= FEEDFORWARD_POINTS);
    struct high_order_point sensitivity[FEEDFORWARD_POINTS];
    for (unsigned i = 0; i < r->band.points; i++)
        if (ratio_at_point(r, c, i, &sensitivity[i]))
            return TUNE_UNSURE;
    return find_band(&r->band, c, sensitivity);
}

const struct tune_band *tune_responses_band(const struct tune_responses *r)
{
    return &r->band;
}
