#include "kinds/ff_tune/tune_paths.h"

#include "base/assertion.h"
#include "design/feedforward_rules.h"
#include "kinds/ff_tune/tune_paths_state.h"

#define ZERO REAL_C(0.0)

/* Largest r.m.s. of what a first-order model leaves of the response, over its size. */
#define MISFIT_MOST REAL_C(0.5)
/* A time constant this many times the time of the lowest frequency integrates, as far as the grid tells. */
#define INTEGRATES REAL_C(100.0)
/* Times within this part are equal, for the rules. */
#define SAME REAL_C(0.1)

void tune_paths_begin(struct tune_paths *p)
{
    p->rule.valid = false;
    p->fitting = false;
}

/* An MV that is held between samples is late by so much at the least. The process has that, whatever noise makes of its response. */
static real_t held_late(const struct tune_context *c)
{
    return REAL_C(0.5) * c->h_s;
}

/* Collects the known points of the band: the process without what the hold is late, or the path of the disturbance, which is the ratio times
 * the process. */
static unsigned known_points(const struct tune_context *c, const struct tune_band *b, bool of_path,
                             real_t *omega, struct cplx *g)
{
    REFLUX_ASSERT(b->from <= b->to && b->to <= FEEDFORWARD_POINTS);
    unsigned n = 0;
    for (unsigned i = b->from; i < b->to; i++) {
        if (!tune_is_known(c, &b->process[i]) || (of_path && !tune_is_known(c, &b->ratio[i])))
            continue;
        g[n] = of_path ? cplx_mul(b->ratio[i].value, b->process[i].value)
                       : cplx_mul(b->process[i].value, cplx_turned(b->omega[i] * held_late(c)));
        omega[n++] = b->omega[i];
    }
    return n;
}

/* A piece of the fit. False: there is no model. */
static bool model_fit_piece(struct tune_paths *p, const struct tune_context *c,
                            const struct tune_band *b, bool of_path, bool *more)
{
    struct cplx g[FEEDFORWARD_POINTS];
    real_t omega[FEEDFORWARD_POINTS];
    unsigned n = known_points(c, b, of_path, omega, g);
    *more = true;
    if (!p->fitting) {
        p->fitting = true;
        return n >= TUNE_POINTS_LEAST &&
               response_fit_begin(&p->fit, n, omega, g, tune_dead_reach(c)) == ERR_OK;
    }
    *more = response_fit_piece(&p->fit, n, omega, g);
    if (*more)
        return true;
    p->fitting = false;
    return p->fit.error < MISFIT_MOST &&
           p->fit.best.time_constant_s * b->omega[b->from] < INTEGRATES;
}

enum tune_verdict tune_process_piece(struct tune_paths *p, const struct tune_context *c,
                                     const struct tune_band *band, bool *more)
{
    if (!model_fit_piece(p, c, band, false, more))
        return TUNE_NO_MODEL;
    if (*more)
        return TUNE_NONE;
    p->process = (struct tune_model){p->fit.best, p->fit.error};
    p->process.element.dead_time_s += held_late(c);
    return p->process.element.gain * c->s.gain > ZERO ? TUNE_NONE : TUNE_NO_MODEL;
}

/* ---- the rule ---- */

/* The rules need a time constant above 0. */
static struct fopdt for_rules(const struct tune_context *c, struct fopdt m)
{
    real_t least = REAL_C(0.01) * c->tick_s;
    m.time_constant_s = m.time_constant_s > least ? m.time_constant_s : least;
    return m;
}

/* The element that comes nearest to the rule: no lead below 0, no more than `kick`, and what the search is allowed. A lag is made longer before
 * a lead is cut. */
static struct feedforward_shape element_from(const struct tune_context *c,
                                             const struct feedforward_rule *r, real_t dead_most)
{
    real_t h = c->tick_s, kick = c->s.kick, lead = real_clamp(r->lead_s, ZERO, REAL_C(1e6));
    real_t lag =
        real_clamp(r->lag_s, real_clamp((lead + h) / kick - h, ZERO, REAL_C(1e6)), REAL_C(1e6));
    lag = real_clamp(lag, ZERO, c->s.lag_most_s);
    return (struct feedforward_shape){.k = real_clamp(r->gain, REAL_C(-100.0), REAL_C(100.0)),
                                      .lead = real_clamp(lead, ZERO, kick * (lag + h) - h),
                                      .lag = lag,
                                      .dead = real_clamp(r->dead_s, ZERO, dead_most)};
}

static void make_rule(struct tune_paths *p, const struct tune_context *c,
                      const struct feedforward_wanted *wanted)
{
    struct fopdt process = for_rules(c, p->process.element), path = for_rules(c, p->fit.best);
    struct feedforward_case number = feedforward_case_of(&process, &path, SAME);
    struct feedforward_rule r;
    /* A lead below 0 would imitate the dead time that the element has itself. */
    bool waits = number.late == LATE_DISTURBANCE && wanted->dead_most > ZERO;
    if (waits ? feedforward_exact(&process, &path, &r)
              : feedforward_shinskey(&process, &path, SAME, &r))
        return;
    p->rule.valid = true;
    p->rule.number = (uint8_t)(10u * (number.late + 1u) + number.slow + 1u);
    p->rule.path = (struct tune_model){p->fit.best, p->fit.error};
    p->rule.shape = element_from(c, &r, wanted->dead_most);
    p->rule.j = feedforward_objective(wanted, &p->rule.shape);
}

void tune_path_piece(struct tune_paths *p, const struct tune_context *c,
                     const struct tune_band *band, const struct feedforward_wanted *wanted,
                     bool *more)
{
    if (!model_fit_piece(p, c, band, true, more)) {
        p->fitting = *more = false;
        return;
    }
    if (!*more)
        make_rule(p, c, wanted);
}

const struct tune_model *tune_process_model(const struct tune_paths *p)
{
    return &p->process;
}

const struct tune_rule *tune_paths_rule(const struct tune_paths *p)
{
    return &p->rule;
}
