#include "identify/rls.h"

#include <string.h>

#include "base/assertion.h"
#include "num/real.h"
#include "num/ud_num.h"

/* D is kept within these whatever the rule of forgetting does: beyond them float has no digits left for what follows.
 * rls_clamped() counts how often it had to be. */
#define D_LEAST 1e-12f
#define D_MOST  1e12f

#define ERROR_MEMORY 200.0f /* samples over which the size of e is measured */
#define THETA_MOST   127.0f /* no parameter is larger: num_t ends there in the fixed build */

struct rls {
    uint8_t n, forgetting, correction;
    bool normalise;
    uint8_t looked_at; /* whose range is looked at next: D_i at 2 i, theta_i at 2 i + 1 */
    scaled_t forget, forget_least, sigma0, memory, trace, rate;
    scaled_t dead_zone_square; /* in mean squares of e */
    num_t error_most;          /* 0: none */
    scaled_t mean_square;      /* of e */
    scaled_t forgot, variance,
        alpha; /* of the last step that learnt: v, phi'P phi, v + phi'P phi */
    uint32_t clamped;
    uint16_t sized;             /* samples that sizes are means of, of RLS_YDSTIE_TRACE */
    float size_of_error;        /* mean square of e, as far as it has been clipped and normalised */
    struct accumulator theta[]; /* [n]; then p0, sizes of phi, lo, hi [n], then P */
};

static scaled_t one(void)
{
    return scaled_from_num(num_one());
}

static float *start_diagonal(struct rls *r)
{
    return (float *)(void *)&r->theta[r->n];
}

/* Mean squares of phi. */
static float *sizes(struct rls *r)
{
    return start_diagonal(r) + r->n;
}

static num_t *bounds(struct rls *r)
{
    return (num_t *)(void *)(sizes(r) + r->n);
}

static ud_cell_t *ud_of(struct rls *r)
{
    return (ud_cell_t *)(void *)(bounds(r) + 2 * (size_t)r->n);
}

static const ud_cell_t *ud_of_const(const struct rls *r)
{
    const float *p0 = (const float *)(const void *)&r->theta[r->n];
    const num_t *lo = (const num_t *)(const void *)(p0 + 2 * (size_t)r->n);
    return (const ud_cell_t *)(const void *)(lo + 2 * (size_t)r->n);
}

uint32_t rls_bytes(unsigned n)
{
    size_t bytes = sizeof(struct rls) +
                   n * (sizeof(struct accumulator) + 2 * sizeof(float) + 2 * sizeof(num_t)) +
                   ud_num_cells(n) * sizeof(ud_cell_t);
    return (uint32_t)((bytes + 7u) & ~(size_t)7u);
}

/* ---- settings ---- */

static bool bounded_by(const struct rls_settings *s, unsigned i)
{
    return s->lo && s->hi && s->hi[i] > s->lo[i];
}

static enum err settings_fault(const char **field, const char **wanted, const char *name,
                               const char *range)
{
    if (field)
        *field = name;
    if (wanted)
        *wanted = range;
    return ERR_RANGE;
}

enum err rls_check(const struct rls_settings *s, const char **field, const char **wanted)
{
    const struct {
        const char *name;
        float value, lo, hi;
        const char *range;
    } row[] = {
        {"forget", s->forget, 0.5f, 1, "0.5 to 1"},
        {"forget_least", s->forget_least, 0.01f, 1, "0.01 to 1"},
        {"sigma0", s->sigma0, 1e-12f, 1e6f, "1e-12 to 1e6"},
        {"memory", s->memory, 1e-12f, 1e6f, "1e-12 to 1e6"},
        {"trace", s->trace, 1e-6f, 1e12f, "1e-6 to 1e12"},
        {"error_most", s->error_most, 0, 100, "0 to 100"},
        {"dead_zone", s->dead_zone, 0, 100, "0 to 100"},
    };
    if (s->n < 1 || s->n > RLS_MAX)
        return settings_fault(field, wanted, "n", "1 to 35 parameters");
    for (size_t k = 0; k < sizeof row / sizeof row[0]; k++)
        if (!(row[k].value >= row[k].lo && row[k].value <= row[k].hi))
            return settings_fault(field, wanted, row[k].name, row[k].range);
    float most = 0;
    for (unsigned i = 0; i < s->n; i++) {
        if (!(s->p0[i] >= 1e-6f && s->p0[i] <= 1e9f))
            return settings_fault(field, wanted, "p0", "1e-6 to 1e9");
        most = s->p0[i] > most ? s->p0[i] : most;
    }
    if (s->correction == RLS_CORRECT_SPC && !(s->rate > 0 && s->rate < 2))
        return settings_fault(field, wanted, "correct_rate", "above 0 and below 2");
    if (s->correction == RLS_CORRECT_PC && !(s->rate > 0 && s->rate * most < 2))
        return settings_fault(field, wanted, "correct_rate",
                              "above 0, and with p0 as a factor below 2");
    return ERR_OK;
}

static void take_settings(struct rls *r, const struct rls_settings *s)
{
    num_t *bound = bounds(r);
    r->forgetting = s->forgetting;
    r->correction = s->correction;
    r->normalise = s->normalise;
    r->forget = scaled_from_float(s->forget);
    r->forget_least = scaled_from_float(s->forget_least);
    r->sigma0 = scaled_from_float(s->sigma0);
    r->memory = scaled_from_float(s->memory);
    r->trace = scaled_from_float(s->trace);
    r->rate = scaled_from_float(s->rate);
    r->dead_zone_square = scaled_from_float(s->dead_zone * s->dead_zone);
    r->error_most = num_from_float(s->error_most);
    for (unsigned i = 0; i < s->n; i++) {
        start_diagonal(r)[i] = s->p0[i];
        bound[i] = num_from_float(bounded_by(s, i) ? s->lo[i] : 0);
        bound[s->n + i] = num_from_float(bounded_by(s, i) ? s->hi[i] : 0);
    }
}

void rls_reset(struct rls *r)
{
    REFLUX_ASSERT(r->n <= RLS_MAX);
    scaled_t diagonal[RLS_MAX];
    for (unsigned i = 0; i < r->n; i++)
        diagonal[i] = scaled_from_float(start_diagonal(r)[i]);
    ud_num_set_diagonal(ud_of(r), r->n, diagonal);
    r->forgot = scaled_from_float(1);
    r->variance = scaled_from_float(0);
    r->alpha = one();
}

void rls_set(struct rls *r, const num_t *theta)
{
    for (unsigned i = 0; i < r->n; i++)
        accumulator_set(&r->theta[i], theta[i]);
}

void rls_init(struct rls *r, const struct rls_settings *s, const num_t *theta)
{
    REFLUX_ASSERT(s->n >= 1 && s->n <= RLS_MAX);
    memset(r, 0, sizeof *r);
    r->n = s->n;
    take_settings(r, s);
    memset(sizes(r), 0, s->n * sizeof(float));
    rls_set(r, theta);
    rls_reset(r);
}

void rls_retune(struct rls *r, const struct rls_settings *s)
{
    REFLUX_ASSERT(s->n == r->n);
    take_settings(r, s);
}

/* ---- a sample ---- */

/* Quantities that rules of forgetting look at, all of before the measurement. */
struct measured {
    scaled_t error, variance; /* e; phi'P phi */
    const num_t *phi;
};

static scaled_t larger_scaled(scaled_t a, scaled_t b)
{
    return scaled_lt(a, b) ? b : a;
}

/* e^2/(1 + phi'P phi) */
static scaled_t surprise(const struct measured *m)
{
    return scaled_div(scaled_mul(m->error, m->error), scaled_add(one(), m->variance));
}

/* Mean squares of phi and e go on. */
static void take_sizes(struct rls *r, const struct measured *m)
{
    float e = scaled_to_float(m->error);
    r->sized = (uint16_t)(r->sized + ((float)r->sized < ERROR_MEMORY));
    r->size_of_error += (e * e - r->size_of_error) / (float)r->sized;
    for (unsigned i = 0; i < r->n; i++) {
        float x = num_to_float(m->phi[i]);
        sizes(r)[i] += (x * x - sizes(r)[i]) / (float)r->sized;
    }
}

/* Folami 8.48 with P in units of the regressors' sizes and e in units of its own, and so that v is `forget` in the long run. */
static scaled_t forgetting_by_trace(struct rls *r, const struct measured *m)
{
    scaled_t trace = scaled_from_float(0), most = scaled_from_float((float)r->n);
    scaled_t share = scaled_div(scaled_sub(one(), r->forget), r->forget);
    take_sizes(r, m);
    for (unsigned i = 0; i < r->n; i++)
        trace = scaled_add(trace, scaled_mul(ud_num_element(ud_of(r), r->n, i, i),
                                             scaled_from_float(sizes(r)[i])));
    if (!(r->size_of_error > 0) || !scaled_lt(scaled_from_float(0), trace))
        return one();
    scaled_t times = scaled_div(surprise(m), scaled_from_float(r->size_of_error));
    scaled_t less = scaled_mul(scaled_mul(most, scaled_mul(share, share)), times);
    return scaled_div(trace, scaled_add(trace, less));
}

/* Folami 8.42 to 8.48; forget where the rule is constant. */
static scaled_t forgetting_factor(struct rls *r, const struct measured *m)
{
    scaled_t v = r->forget, size;
    switch (r->forgetting) {
    case RLS_FORTESCUE:
        v = scaled_sub(one(), scaled_div(surprise(m), r->sigma0));
        break;
    case RLS_YDSTIE:
        v = scaled_div(r->memory, scaled_add(r->memory, surprise(m)));
        break;
    case RLS_YDSTIE_TRACE:
        v = forgetting_by_trace(r, m);
        break;
    case RLS_BOUNDED: /* P/v is not to pass the trace */
        size = scaled_div(ud_num_trace(ud_of(r), r->n), r->trace);
        v = larger_scaled(v, scaled_lt(size, one()) ? size : one());
        break;
    default:
        return v;
    }
    return larger_scaled(v, r->forget_least);
}

/* Cao and Schwartz (2000): P grows along what is measured alone, P += ((1 - v)/v) phi phi'/(phi'P^-1 phi), but not past the
 * trace. x, y: space for n each. */
static void forget_along(struct rls *r, const num_t *phi, scaled_t *x, scaled_t *y)
{
    scaled_t form = scaled_from_float(0), square = form;
    for (unsigned i = 0; i < r->n; i++)
        x[i] = scaled_from_num(phi[i]);
    ud_num_solve(ud_of(r), r->n, x, y);
    for (unsigned i = 0; i < r->n; i++) {
        form = scaled_add(form, scaled_mul(x[i], y[i]));
        square = scaled_add(square, scaled_mul(x[i], x[i]));
    }
    if (!scaled_lt(scaled_from_float(0), form) || !scaled_lt(scaled_from_float(0), square))
        return;
    scaled_t c = scaled_div(scaled_sub(one(), r->forget), scaled_mul(r->forget, form));
    scaled_t room = scaled_sub(r->trace, ud_num_trace(ud_of(r), r->n));
    if (!scaled_lt(scaled_from_float(0), room))
        return;
    scaled_t most = scaled_div(room, square);
    ud_num_add(ud_of(r), r->n, scaled_lt(most, c) ? most : c, x);
}

/* Distance of theta from its bounds (Folami 8.50). */
static num_t outside(struct rls *r, unsigned i)
{
    REFLUX_ASSERT(i < r->n);
    const num_t *bound = bounds(r);
    num_t theta = accumulator_get(&r->theta[i]), lo = bound[i], hi = bound[r->n + i];
    if (num_lt(lo, hi) && num_lt(hi, theta))
        return num_sub(theta, hi);
    if (num_lt(lo, hi) && num_lt(theta, lo))
        return num_sub(theta, lo);
    return num_zero();
}

/* Finds the move of theta besides the gain: -mu f, or -alpha P f with the P of before. */
static void find_correction(struct rls *r, scaled_t *move)
{
    memset(move, 0, RLS_MAX * sizeof move[0]);
    for (unsigned i = 0; i < r->n; i++)
        move[i] = scaled_mul(scaled_neg(r->rate), scaled_from_num(outside(r, i)));
    if (r->correction == RLS_CORRECT_PC)
        ud_num_multiply(ud_of(r), r->n, move, move);
}

/* P after the measurement, theta moved by the gain times e. */
static void take_in(struct rls *r, ud_cell_t *p, struct measured *m, scaled_t *f, scaled_t *g)
{
    scaled_t v = forgetting_factor(r, m), noise = v, growth = one();
    if (r->forgetting == RLS_DIRECTIONAL) {
        forget_along(r, m->phi, f, g);
        ud_num_project(p, r->n, m->phi, f, g);
    }
    if (r->forgetting == RLS_DIRECTIONAL || r->forgetting == RLS_HELD_TRACE)
        noise = one();
    else
        growth = scaled_div_positive(one(), v);
    scaled_t alpha = ud_num_correct(p, r->n, f, g, noise, growth);
    if (r->forgetting == RLS_HELD_TRACE) {
        v = scaled_div(ud_num_trace(p, r->n), r->trace);
        ud_num_scale(p, r->n, scaled_div(one(), v));
    }
    scaled_t share = scaled_div_positive(m->error, alpha);
    struct accumulator *theta = r->theta, *end = theta + r->n;
    if (r->n & 1u)
        scaled_accumulate(theta++, *g++, share);
    for (; theta < end; theta += 2, g += 2) { /* two a turn, for speed */
        scaled_accumulate(&theta[0], g[0], share);
        scaled_accumulate(&theta[1], g[1], share);
    }
    r->forgot = v;
    r->variance = scaled_sub(alpha, noise);
    r->alpha = alpha;
}

/* Forgets old data completely when the trace is small (RLS_RESET). */
static void reset_when_small(struct rls *r)
{
    ud_cell_t *p = ud_of(r);
    scaled_t diagonal[RLS_MAX];
    if (!scaled_lt(ud_num_trace(p, r->n), scaled_div(r->trace, scaled_from_float(100))))
        return;
    for (unsigned i = 0; i < r->n; i++)
        diagonal[i] = scaled_div(r->trace, scaled_from_float((float)r->n));
    ud_num_set_diagonal(p, r->n, diagonal);
}

/* The last resort, for one parameter or one D a step: within 2 n steps neither gets far. */
static void keep_in_range(struct rls *r, ud_cell_t *p)
{
    unsigned i = r->looked_at / 2u;
    if (r->looked_at & 1u) {
        num_t most = num_from_float(THETA_MOST);
        accumulator_clamp(&r->theta[i], num_neg(most), most);
    } else if (ud_num_clamp(p, r->n, i, scaled_from_float(D_LEAST), scaled_from_float(D_MOST))) {
        r->clamped++;
    }
    r->looked_at = (uint8_t)(r->looked_at + 1u < 2u * r->n ? r->looked_at + 1u : 0u);
}

static void learn_from(struct rls *r, const num_t *phi, num_t error)
{
    scaled_t f[RLS_MAX], g[RLS_MAX], move[RLS_MAX];
    bool corrects = r->correction != RLS_CORRECT_NONE;
    ud_cell_t *p = ud_of(r);
    struct measured m = {.error = scaled_from_num(error), .phi = phi};
    if (corrects)
        find_correction(r, move);
    ud_num_project(p, r->n, phi, f, g);
    if (r->forgetting >= RLS_FORTESCUE && r->forgetting <= RLS_YDSTIE_TRACE)
        m.variance = ud_num_variance(f, g, r->n);
    take_in(r, p, &m, f, g);
    if (r->forgetting == RLS_RESET)
        reset_when_small(r);
    for (unsigned i = 0; i < r->n && corrects; i++)
        scaled_accumulate(&r->theta[i], move[i], one());
    keep_in_range(r, p);
}

/* Returns true when e is within the dead zone; its mean square goes on. */
static bool says_nothing(struct rls *r, num_t error)
{
    scaled_t e = scaled_from_num(error), square = scaled_mul(e, e);
    bool small = scaled_lt(square, scaled_mul(r->dead_zone_square, r->mean_square));
    r->mean_square = scaled_add(r->mean_square, scaled_mul(scaled_sub(square, r->mean_square),
                                                           scaled_from_float(1 / ERROR_MEMORY)));
    return small;
}

/* Folami 8.53: phi divided by its largest entry, at least 1. Returns that. */
static num_t normalised(const struct rls *r, const num_t *phi, num_t *scaled_phi)
{
    num_t eta = num_one();
    for (unsigned i = 0; i < r->n; i++)
        eta = num_max(eta, num_abs(phi[i]));
    for (unsigned i = 0; i < r->n; i++)
        scaled_phi[i] = num_div(phi[i], eta);
    return eta;
}

/* Judges a sample that is not learnt from. */
static void judge_unlearnt(struct rls *r, const num_t *phi)
{
    scaled_t f[RLS_MAX], g[RLS_MAX];
    bool unweighted = r->forgetting == RLS_DIRECTIONAL || r->forgetting == RLS_HELD_TRACE;
    ud_num_project(ud_of(r), r->n, phi, f, g);
    r->variance = ud_num_variance(f, g, r->n);
    r->alpha = scaled_add(unweighted ? one() : r->forgot, r->variance);
}

num_t rls_step(struct rls *r, const num_t *phi, num_t y, bool learn)
{
    REFLUX_ASSERT(r->n >= 1 && r->n <= RLS_MAX);
    num_t error = num_sub(y, rls_predict(r, phi)), clipped = error, eta = num_one();
    num_t scaled_phi[RLS_MAX];
    if (learn) {
        if (num_lt(num_zero(), r->error_most))
            clipped = num_clamp(error, num_neg(r->error_most), r->error_most);
        if (says_nothing(r, clipped))
            return error;
    }
    if (r->normalise) {
        eta = normalised(r, phi, scaled_phi);
        phi = scaled_phi;
    }
    if (learn)
        learn_from(r, phi, r->normalise ? num_div(clipped, eta) : clipped);
    else
        judge_unlearnt(r, phi);
    return error;
}

num_t rls_predict(const struct rls *r, const num_t *phi)
{
    num_wide_t sum = num_wide_zero();
    const struct accumulator *theta = r->theta, *end = theta + r->n;
    if (r->n & 1u)
        sum = num_wide_add(sum, accumulator_get(theta++), *phi++);
    for (; theta < end; theta += 2, phi += 2) { /* two a turn, for speed */
        sum = num_wide_add(sum, accumulator_get(&theta[0]), phi[0]);
        sum = num_wide_add(sum, accumulator_get(&theta[1]), phi[1]);
    }
    return num_from_wide(sum);
}

/* ---- what it knows ---- */

num_t rls_theta(const struct rls *r, unsigned i)
{
    REFLUX_ASSERT(i < r->n);
    return accumulator_get(&r->theta[i]);
}

float rls_covariance(const struct rls *r, unsigned i, unsigned j)
{
    return scaled_to_float(ud_num_element(ud_of_const(r), r->n, i, j));
}

float rls_form(const struct rls *r, const float *c)
{
    scaled_t f[RLS_MAX], g[RLS_MAX];
    num_t phi[RLS_MAX];
    float most = 0;
    for (unsigned i = 0; i < r->n; i++)
        most = real_abs(c[i]) > most ? real_abs(c[i]) : most;
    if (!(most > 0))
        return 0;
    for (unsigned i = 0; i < r->n; i++)
        phi[i] = num_from_float(c[i] / most);
    ud_num_project(ud_of_const(r), r->n, phi, f, g);
    return scaled_to_float(ud_num_variance(f, g, r->n)) * most * most;
}

float rls_trace(const struct rls *r)
{
    return scaled_to_float(ud_num_trace(ud_of_const(r), r->n));
}

void rls_d_extremes(const struct rls *r, float *least, float *most)
{
    scaled_t lo, hi;
    ud_num_extremes(ud_of_const(r), r->n, &lo, &hi);
    *least = scaled_to_float(lo);
    *most = scaled_to_float(hi);
}

float rls_forgot(const struct rls *r)
{
    return scaled_to_float(r->forgot);
}

float rls_told(const struct rls *r)
{
    return scaled_to_float(scaled_div(r->variance, r->alpha));
}

float rls_error_sd(const struct rls *r)
{
    return real_sqrt(scaled_to_float(r->mean_square));
}

uint32_t rls_clamped(const struct rls *r)
{
    return r->clamped;
}
