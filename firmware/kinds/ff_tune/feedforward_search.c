#include "kinds/ff_tune/feedforward_search.h"

#include "base/assertion.h"
#include "num/real_trig.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* Lags of the grid: 0, then geometric to the largest. */
#define LAGS 15u
/* Dead times of the grid, equally apart. */
#define DEADS 9u
/* Rounds of golden sections, each of lag and of dead time. */
#define ROUNDS    4u
#define CUTS      12u
#define REWEIGHTS 25u
/* Largest gain of the element. */
#define K_MOST REAL_C(100.0)

enum search_phase { SEARCH_GRID, SEARCH_LAG, SEARCH_DEAD, SEARCH_OVER };

/* ---- F ---- */

static struct cplx backward_difference(real_t h_s, real_t omega)
{
    real_t sine, cosine;
    real_sincos(omega * h_s, &sine, &cosine);
    return cplx((ONE - cosine) / h_s, sine / h_s);
}

/* e^(-dead w i)/(lag s + 1) */
static struct cplx without_lead(real_t lag, real_t dead, struct cplx s, real_t omega)
{
    real_t sine, cosine;
    real_sincos(omega * dead, &sine, &cosine);
    return cplx_div(cplx(cosine, -sine), cplx(ONE + lag * s.re, lag * s.im));
}

struct cplx feedforward_response(const struct feedforward_shape *f, real_t h_s, real_t omega)
{
    struct cplx s = backward_difference(h_s, omega);
    struct cplx lag = without_lead(f->lag, f->dead, s, omega);
    return cplx_scale(cplx_mul(lag, cplx(ONE + f->lead * s.re, f->lead * s.im)), f->k);
}

real_t feedforward_objective(const struct feedforward_wanted *w, const struct feedforward_shape *f)
{
    REFLUX_ASSERT(w->points <= FEEDFORWARD_POINTS);
    real_t j = ZERO;
    for (unsigned i = 0; i < w->points; i++)
        if (w->weight[i] > ZERO)
            j += w->weight[i] *
                 cplx_abs(cplx_add(w->ratio[i], feedforward_response(f, w->h_s, w->omega[i])));
    return j;
}

/* ---- K and K lead, for a lag and a dead time ---- */

/* The error is R + p a + q b at each frequency. It lacks q where `tied`: then lead is given and a is all of F/K. */
struct linear {
    const struct feedforward_wanted *w;
    struct cplx a[FEEDFORWARD_POINTS], b[FEEDFORWARD_POINTS];
    /* A smaller error counts as `least`. */
    real_t p, q, least;
    bool tied;
};

static struct cplx left_over_at(const struct linear *l, unsigned i)
{
    struct cplx e = cplx_add(l->w->ratio[i], cplx_scale(l->a[i], l->p));
    return l->tied ? e : cplx_add(e, cplx_scale(l->b[i], l->q));
}

static real_t inner_product(struct cplx a, struct cplx b)
{
    return a.re * b.re + a.im * b.im;
}

/* Least squares with weights W/|error|. */
static void reweighted_step(struct linear *l, bool first)
{
    real_t aa = ZERO, ab = ZERO, bb = ZERO, ar = ZERO, br = ZERO;
    for (unsigned i = 0; i < l->w->points; i++) {
        real_t size = first ? ONE : cplx_abs(left_over_at(l, i));
        real_t v = l->w->weight[i] / (size > l->least ? size : l->least);
        aa += v * cplx_square(l->a[i]);
        ab += v * inner_product(l->a[i], l->b[i]);
        bb += v * cplx_square(l->b[i]);
        ar += v * inner_product(l->a[i], l->w->ratio[i]);
        br += v * inner_product(l->b[i], l->w->ratio[i]);
    }
    real_t det = aa * bb - ab * ab;
    if (l->tied || !(det > REAL_C(1e-6) * aa * bb)) {
        l->p = aa > ZERO ? -ar / aa : ZERO;
        l->q = ZERO;
        return;
    }
    l->p = (-ar * bb + br * ab) / det;
    l->q = (-br * aa + ar * ab) / det;
}

static void reweighted_solve(struct linear *l)
{
    for (unsigned n = 0; n < REWEIGHTS; n++)
        reweighted_step(l, n == 0);
}

/* a becomes all of F/K for that lead. */
static void tie_lead(struct linear *l, real_t lead)
{
    for (unsigned i = 0; i < l->w->points; i++)
        l->a[i] = cplx_add(l->a[i], cplx_scale(l->b[i], lead));
    l->tied = true;
    reweighted_solve(l);
}

static real_t size_of_ratio(const struct feedforward_wanted *w)
{
    real_t largest = ZERO;
    for (unsigned i = 0; i < w->points; i++) {
        real_t size = cplx_abs(w->ratio[i]);
        if (w->weight[i] > ZERO && size > largest)
            largest = size;
    }
    return largest;
}

/* Finds the best K and lead for this lag and dead time, keeps them where J is the least so far, and returns J. */
static real_t try_pair(struct feedforward_search *s, const struct feedforward_wanted *w, real_t lag,
                       real_t dead)
{
    REFLUX_ASSERT(w->points <= FEEDFORWARD_POINTS);
    struct linear l = {.w = w, .least = REAL_C(1e-4) * size_of_ratio(w) + REAL_C(1e-9)};
    for (unsigned i = 0; i < w->points; i++) {
        struct cplx difference = backward_difference(w->h_s, w->omega[i]);
        l.a[i] = without_lead(lag, dead, difference, w->omega[i]);
        l.b[i] = cplx_mul(l.a[i], difference);
    }
    reweighted_solve(&l);
    real_t most = w->kick * (lag + w->h_s) - w->h_s;
    real_t lead = l.p * l.q > ZERO ? l.q / l.p : ZERO;
    if (!(l.p * l.q > ZERO) || lead > most) {
        lead = lead > most ? most : ZERO;
        tie_lead(&l, lead);
    }
    struct feedforward_shape f = {.k = l.p, .lead = lead, .lag = lag, .dead = dead};
    f.k = f.k > K_MOST ? K_MOST : f.k < -K_MOST ? -K_MOST : f.k;
    real_t j = feedforward_objective(w, &f);
    if (j < s->j) {
        s->j = j;
        s->best = f;
    }
    return j;
}

/* ---- lag and dead time ---- */

void feedforward_search_begin(struct feedforward_search *s, const struct feedforward_wanted *wanted)
{
    *s = (struct feedforward_search){0};
    s->j0 = s->j = feedforward_objective(wanted, &s->best);
}

void feedforward_search_skip(struct feedforward_search *s, const struct feedforward_wanted *wanted,
                             real_t j)
{
    s->j0 = feedforward_objective(wanted, &(const struct feedforward_shape){0});
    s->j = j;
}

static real_t no_more_than(real_t x, real_t most)
{
    return x < most ? x : most;
}

void feedforward_search_near(struct feedforward_search *s, const struct feedforward_wanted *wanted,
                             const struct feedforward_shape *near)
{
    (void)try_pair(s, wanted, no_more_than(near->lag, wanted->lag_most),
                   no_more_than(near->dead, wanted->dead_most));
}

static real_t grid_lag(const struct feedforward_wanted *w, unsigned i)
{
    if (i == 0 || !(w->lag_most > ZERO))
        return ZERO;
    real_t least = REAL_C(0.5) * w->h_s < w->lag_most ? REAL_C(0.5) * w->h_s : w->lag_most;
    real_t part = (real_t)(i - 1u) / (real_t)(LAGS - 2u);
    return no_more_than(least * real_exp(part * real_log(w->lag_most / least)), w->lag_most);
}

static bool grid_piece(struct feedforward_search *s, const struct feedforward_wanted *w)
{
    real_t dead = w->dead_most * (real_t)s->dead_at / (real_t)(DEADS - 1u);
    (void)try_pair(s, w, grid_lag(w, s->lag_at), dead);
    if (++s->lag_at < LAGS)
        return true;
    s->lag_at = 0;
    return w->dead_most > ZERO && ++s->dead_at < DEADS;
}

static real_t tried_at(struct feedforward_search *s, const struct feedforward_wanted *w, real_t x)
{
    return s->phase == SEARCH_LAG ? try_pair(s, w, x, s->best.dead)
                                  : try_pair(s, w, s->best.lag, x);
}

/* Searches about the best so far: half to twice the lag; a step of the grid of dead times to either side, half of that in each round. */
static void begin_section(struct feedforward_search *s, const struct feedforward_wanted *w)
{
    real_t width = w->dead_most / (real_t)(DEADS - 1u);
    for (unsigned k = 0; k < s->round; k++)
        width *= REAL_C(0.5);
    if (s->phase == SEARCH_LAG)
        golden_begin(&s->section, REAL_C(0.5) * s->best.lag,
                     no_more_than(REAL_C(2.0) * s->best.lag + REAL_C(0.5) * w->h_s, w->lag_most));
    else
        golden_begin(&s->section, s->best.dead > width ? s->best.dead - width : ZERO,
                     no_more_than(s->best.dead + width, w->dead_most));
}

/* Makes a trial of a golden section; false: the section is narrow enough. */
static bool section_piece(struct feedforward_search *s, const struct feedforward_wanted *w)
{
    golden_take(&s->section, tried_at(s, w, golden_next(&s->section)));
    return s->section.taken < CUTS;
}

static void next_phase(struct feedforward_search *s, const struct feedforward_wanted *w)
{
    if (s->phase == SEARCH_LAG && w->dead_most > ZERO) {
        s->phase = SEARCH_DEAD;
    } else {
        s->round = (uint8_t)(s->phase == SEARCH_GRID ? 0 : s->round + 1u);
        s->phase = s->round < ROUNDS ? SEARCH_LAG : SEARCH_OVER;
    }
    if (s->phase != SEARCH_OVER)
        begin_section(s, w);
}

bool feedforward_search_piece(struct feedforward_search *s, const struct feedforward_wanted *w)
{
    if (s->phase == SEARCH_OVER)
        return false;
    bool more = s->phase == SEARCH_GRID ? grid_piece(s, w) : section_piece(s, w);
    if (!more)
        next_phase(s, w);
    return s->phase != SEARCH_OVER;
}
