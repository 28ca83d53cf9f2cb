/* Between ticks: first-order models of the process and of the disturbance's path, and Shinskey's rule from both. */
#include "kinds/ff_tune/feedforward_tune_block.h"

#include "design/feedforward_rules.h"

#define ZERO REAL_C(0.0)

/* r.m.s. of what a first-order model leaves of the response, over its size. */
#define OFF_MOST REAL_C(0.5)
/* Of the time constant, over the time of the lowest frequency: more, and it integrates, as far as the grid tells. */
#define INTEGRATES REAL_C(100.0)
/* Times within this are equal, for the rules. */
#define SAME REAL_C(0.1)

/* What an MV that is held between samples is late at the least: the process has that, whatever noise makes of its response. */
static real_t held_late(const struct tune *t)
{
    return REAL_C(0.5) * t->h_s;
}

/* Of the band, where it is known: the process without what the hold is late, or the path of the disturbance, which is the ratio times the process. */
static unsigned known_points(const struct tune *t, bool of_path, real_t *omega, struct cplx *g)
{
    unsigned n = 0;
    for (unsigned i = t->band_from; i < t->band_to; i++) {
        if (!tune_is_known(t, &t->process[i]) || (of_path && !tune_is_known(t, &t->ratio.at[i])))
            continue;
        g[n] = of_path ? cplx_mul(t->ratio.at[i].is, t->process[i].is)
                       : cplx_mul(t->process[i].is, cplx_turned(t->omega[i] * held_late(t)));
        omega[n++] = t->omega[i];
    }
    return n;
}

/* Of the fit, a piece. False: there is no model. */
static bool model_fit_piece(struct tune *t, bool of_path, bool *more)
{
    struct cplx g[FEEDFORWARD_POINTS];
    real_t omega[FEEDFORWARD_POINTS];
    unsigned n = known_points(t, of_path, omega, g);
    *more = true;
    if (!t->fitting) {
        t->fitting = true;
        return n >= TUNE_POINTS_LEAST &&
               response_fit_begin(&t->fit, n, omega, g, tune_dead_reach(t)) == ERR_OK;
    }
    *more = response_fit_piece(&t->fit, n, omega, g);
    if (*more)
        return true;
    t->fitting = false;
    return t->fit.error < OFF_MOST &&
           t->fit.best.time_constant_s * t->omega[t->band_from] < INTEGRATES;
}

enum tune_verdict tune_process_piece(struct tune *t, bool *more)
{
    if (!model_fit_piece(t, false, more))
        return TUNE_NO_MODEL;
    if (*more)
        return TUNE_NONE;
    t->found = (struct tune_model){t->fit.best, t->fit.error};
    t->found.is.dead_time_s += held_late(t);
    return t->found.is.gain * t->s.gain > ZERO ? TUNE_NONE : TUNE_NO_MODEL;
}

/* ---- the rule ---- */

/* The rules are for a time constant above 0. */
static struct fopdt for_rules(const struct tune *t, struct fopdt m)
{
    real_t least = REAL_C(0.01) * t->tick_s;
    m.time_constant_s = m.time_constant_s > least ? m.time_constant_s : least;
    return m;
}

static real_t bounded_number(real_t x, real_t least, real_t most)
{
    return x < least ? least : x > most ? most : x;
}

/* What the element can be: no lead below 0, and no more than `kick` and the search are allowed. A lag is made longer before a lead is cut. */
static struct feedforward_shape element_from(const struct tune *t, const struct feedforward_rule *r)
{
    real_t h = t->tick_s, kick = t->s.kick, lead = bounded_number(r->lead_s, ZERO, REAL_C(1e6));
    real_t lag = bounded_number(r->lag_s, bounded_number((lead + h) / kick - h, ZERO, REAL_C(1e6)),
                                REAL_C(1e6));
    lag = bounded_number(lag, ZERO, t->s.lag_most_s);
    return (struct feedforward_shape){.k = bounded_number(r->gain, REAL_C(-100.0), REAL_C(100.0)),
                                      .lead = bounded_number(lead, ZERO, kick * (lag + h) - h),
                                      .lag = lag,
                                      .dead = bounded_number(r->dead_s, ZERO, t->wanted.dead_most)};
}

static void make_rule(struct tune *t)
{
    struct fopdt process = for_rules(t, t->found.is), path = for_rules(t, t->fit.best);
    struct feedforward_case which = feedforward_case_of(&process, &path, SAME);
    struct feedforward_rule r;
    /* A lead below 0 would imitate the dead time that the element has itself. */
    bool waits = which.late == LATE_DISTURBANCE && t->wanted.dead_most > ZERO;
    if (waits ? feedforward_exact(&process, &path, &r)
              : feedforward_shinskey(&process, &path, SAME, &r))
        return;
    t->rule.there = true;
    t->rule.which = (uint8_t)(10u * (which.late + 1u) + which.slow + 1u);
    t->rule.path = (struct tune_model){t->fit.best, t->fit.error};
    t->rule.shape = element_from(t, &r);
    t->rule.j = feedforward_objective(&t->wanted, &t->rule.shape);
}

void tune_path_piece(struct tune *t, bool *more)
{
    if (!model_fit_piece(t, true, more)) {
        t->fitting = *more = false;
        return;
    }
    if (!*more)
        make_rule(t);
}

bool tune_falls_back(const struct tune *t)
{
    return t->s.rules && t->rule.there && !t->by_rule && t->rule.j < t->search.j0;
}

void tune_take_rule(struct tune *t)
{
    t->candidate = t->rule.shape;
    t->by_rule = true;
}
