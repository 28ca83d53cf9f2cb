#include "identify/moments.h"

#include <stdbool.h>
#include <stddef.h>

#include "base/assertion.h"
#include "identify/common.h"
#include "lti/fopdt.h" /* real_is_finite */

/* Times below are in samples, moments in units of 1/alpha (tau = alpha k h), unless a name ends in _s. */

#define NO_GAIN_SDS    REAL_C(3.0)
#define STRENGTH_MIN   REAL_C(0.01)  /* of U against its parts: below, they cancel */
#define WEIGHT_MIN     REAL_C(1e-20) /* a sample of this weight adds nothing any more */
#define LAG_MIN        REAL_C(0.02)  /* samples: shorter is no lag */
#define LAG_MAX_ALPHAS REAL_C(30.0)  /* alpha T: longer cannot be told from there */
#define FAR            REAL_C(1e9)   /* samples; fits an int32_t */
#define HALVINGS       40
#define CHOICES        8

static void add(struct moments_sum *s, real_t x)
{
    real_t term = x - s->carry;
    real_t sum = s->value + term;
    s->carry = (sum - s->value) - term;
    s->value = sum;
}

uint32_t moments_alphas_for(real_t h_s, real_t slowest_s)
{
    real_t eta = (real_t)MOMENTS_FASTEST;
    uint32_t n = 1;
    while (n < MOMENTS_ALPHAS_MAX && eta * slowest_s > h_s) {
        eta /= MOMENTS_RATIO;
        n++;
    }
    return n;
}

enum err moments_init(struct moments *m, const struct moments_config *config)
{
    enum err err = check_real(config->h_s, REAL_C(1e-3), REAL_C(1e5));
    if (!err)
        err = check_real(config->fastest, REAL_C(1e-4), ONE);
    if (!err)
        err = check_real(config->ratio, REAL_C(1.1), REAL_C(10.0));
    if (err)
        return err;
    if (config->outputs == 0 || config->outputs > CHANNEL_MAX || config->alphas == 0 ||
        config->alphas > MOMENTS_ALPHAS_MAX)
        return ERR_RANGE;
    real_t eta = config->fastest, decay[MOMENTS_ALPHAS_MAX];
    for (uint32_t i = 0; i < config->alphas; i++) {
        decay[i] = real_exp(-eta);
        if (!(decay[i] < ONE - REAL_C(16.0) * REAL_EPSILON)) /* slower than real_t can tell */
            return ERR_RANGE;
        eta /= config->ratio;
    }
    m->outputs = config->outputs;
    m->alphas = config->alphas;
    m->h_s = config->h_s;
    for (uint32_t i = 0; i < m->alphas; i++) {
        m->alpha[i].decay = decay[i];
        m->alpha[i].eta = -real_log(decay[i]); /* of the decay as it was rounded */
    }
    real_t none[CHANNEL_MAX] = {ZERO};
    return moments_begin(m, none);
}

enum err moments_begin(struct moments *m, const real_t *reference)
{
    REFLUX_ASSERT(m->outputs <= CHANNEL_MAX && m->alphas <= MOMENTS_ALPHAS_MAX);
    for (uint32_t o = 0; o < m->outputs; o++)
        if (!real_is_finite(reference[o]))
            return ERR_NOT_FINITE;
    const struct moments_sum empty = {ZERO, ZERO};
    for (uint32_t o = 0; o < m->outputs; o++)
        m->reference[o] = reference[o];
    for (uint32_t i = 0; i < m->alphas; i++) {
        m->alpha[i].weight = ONE;
        for (int n = 0; n < 4; n++)
            m->alpha[i].line[n] = empty;
        for (uint32_t o = 0; o < m->outputs; o++)
            for (int n = 0; n < 3; n++)
                m->alpha[i].sum[o][n] = empty;
    }
    m->samples = 0;
    return ERR_OK;
}

enum err moments_step(struct moments *m, const real_t *y)
{
    REFLUX_ASSERT(m->outputs <= CHANNEL_MAX && m->alphas <= MOMENTS_ALPHAS_MAX);
    real_t d[CHANNEL_MAX] = {ZERO};
    for (uint32_t o = 0; o < m->outputs; o++) {
        d[o] = y[o] - m->reference[o];
        enum err err = check_real(d[o], -VALUE_MAX, VALUE_MAX);
        if (err)
            return err;
    }
    for (uint32_t i = 0; i < m->alphas; i++) {
        real_t tau = m->alpha[i].eta * (real_t)m->samples;
        real_t w0 = m->alpha[i].weight, w1 = w0 * tau, w2 = w1 * tau;
        if (w0 < WEIGHT_MIN)
            continue;
        add(&m->alpha[i].line[0], w0);
        add(&m->alpha[i].line[1], w1);
        add(&m->alpha[i].line[2], w2);
        add(&m->alpha[i].line[3], w2 * tau);
        for (uint32_t o = 0; o < m->outputs; o++) {
            struct moments_sum *sum = m->alpha[i].sum[o];
            add(&sum[0], w0 * d[o]);
            add(&sum[1], w1 * d[o]);
            add(&sum[2], w2 * d[o]);
        }
        m->alpha[i].weight = w0 * m->alpha[i].decay;
    }
    m->samples++;
    return ERR_OK;
}

real_t moments_alpha(const struct moments *m, uint32_t i)
{
    REFLUX_ASSERT(i < m->alphas);
    return m->alpha[i].eta / m->h_s;
}

/* A signal seen at one alpha: its value, and -(ln)' and (ln)'' with respect to alpha, in samples. */
struct view {
    real_t value, a, b;
};

/* Input under the zero-order hold: sum over its edges of change e^(-eta k)/(1 - e^-eta). */
static enum err view_input(const struct excitation *u, real_t eta, real_t decay, struct view *v)
{
    real_t e0 = ZERO, e1 = ZERO, e2 = ZERO, parts = ZERO;
    for (uint32_t j = 0; j < u->edges; j++) {
        real_t tau = eta * (real_t)(u->edge[j].sample - u->edge[0].sample);
        real_t part = tau > REAL_C(80.0) ? ZERO : u->edge[j].change * real_exp(-tau);
        e0 += part;
        e1 += part * tau;
        e2 += part * tau * tau;
        parts += real_abs(part);
    }
    if (!(real_abs(e0) > STRENGTH_MIN * parts))
        return ERR_SINGULAR;
    real_t gap = ONE - decay, mean = e1 / e0;
    v->value = e0 / gap;
    v->a = mean / eta + decay / gap;
    v->b = (e2 / e0 - mean * mean) / (eta * eta) + decay / (gap * gap);
    return ERR_OK;
}

/* Derivatives of K, T and L by the three sums: d ln K, dT, dL per unit of each; eta taken as 1. */
struct gradient {
    real_t ln_g[3], a[3], b[3];
};

static real_t propagated_variance(const real_t g[3], const real_t noise[5], const real_t line[4],
                                  real_t eta, real_t offset_sd, real_t slope_sd)
{
    real_t sum = ZERO, offset = ZERO, slope = ZERO;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            sum += g[i] * g[j] * noise[i + j];
        offset += g[i] * line[i];
        slope += g[i] * line[i + 1];
    }
    offset *= offset_sd;
    slope *= slope_sd / eta;
    sum = sum > ZERO ? sum : ZERO;
    return sum + offset * offset + slope * slope;
}

struct element {
    real_t gain, lag, dead; /* samples */
};

/* First-order element under a zero-order hold, from its view at eta: p = e^(-1/T), m the sample in which the response
 * begins, x the part of its weight that falls one sample later:
 *     A = m + x + v/(1 - v),  B = x (1 - x) + v/(1 - v)^2,  v = p e^-eta
 * B grows with T at given A. */
static real_t spread(real_t a, real_t eta, real_t lag, real_t *m, real_t *x)
{
    real_t rest = eta + ONE / lag;
    real_t d = one_less_exp(rest);
    real_t tail = (ONE - d) / d;
    real_t start = a - tail;
    /* Below 0 the dead time is negative: the caller sees it in m. Magnitudes beyond FAR do not get here. */
    real_t whole = start >= ZERO ? (real_t)(int32_t)start : (real_t)((int32_t)start - 1);
    *m = whole;
    *x = start - whole;
    return *x * (ONE - *x) + tail / d;
}

static void finish_element(const struct view *g, real_t eta, real_t decay, real_t lag, real_t m,
                           real_t x, struct element *e)
{
    real_t big_p = one_less_exp(ONE / lag), share = decay + x * (ONE - decay);
    real_t first = decay * big_p * (ONE - x) / share; /* of the step, in sample m */
    e->lag = lag;
    e->dead = m + lag * real_log(ONE - first);
    e->gain = g->value * real_exp(eta * (m + ONE)) * share * one_less_exp(eta + ONE / lag) / big_p;
}

static void without_lag(const struct view *g, real_t eta, struct element *e)
{
    real_t a = g->a > ONE ? g->a : ONE; /* an effect is seen one sample later, at the earliest */
    e->lag = ZERO;
    e->dead = a - REAL_C(0.5);
    if (e->dead < REAL_C(0.75)) /* dead times within the first sample look alike */
        e->dead = ZERO;
    e->gain = g->value * real_exp(eta * a);
}

/* Dead time 0: A alone gives T. */
static bool without_dead_time(const struct view *g, real_t eta, real_t decay, struct element *e)
{
    if (!(g->a > ONE))
        return false;
    real_t rate = real_log(g->a / (g->a - ONE)) - eta;
    if (!(rate > ZERO) || rate * LAG_MIN > ONE)
        return false;
    e->lag = ONE / rate;
    e->dead = ZERO;
    e->gain = g->value * one_less_exp(eta + rate) / (one_less_exp(rate) * decay);
    return true;
}

/* K, T, L from the view of the element; which fall-back was taken goes into the flags. *raw: T before it. */
static uint16_t solve(const struct view *g, real_t eta, real_t decay, struct element *e,
                      real_t *raw)
{
    real_t m, x, lo = LAG_MIN, hi = LAG_MAX_ALPHAS / eta;
    if (!(g->b > spread(g->a, eta, lo, &m, &x))) {
        *raw = ZERO;
        without_lag(g, eta, e);
        return IDENTIFIED_NEGATIVE_RADICAND;
    }
    uint16_t flags = 0;
    if (g->b > spread(g->a, eta, hi, &m, &x)) {
        real_t a = real_sqrt(g->b) * eta;
        if (!(a < ONE)) {
            *raw = a / ((ONE - a) * eta);
            if (!(real_abs(*raw) < REAL_C(1e9)))
                *raw = REAL_C(-1e9);
            without_lag(g, eta, e);
            return IDENTIFIED_NEGATIVE_T;
        }
        flags = IDENTIFIED_SHORT; /* longer than this alpha can tell: the longest it can, below */
        lo = hi;
    }
    for (int i = 0; i < HALVINGS; i++) {
        real_t middle = real_sqrt(lo * hi);
        if (g->b > spread(g->a, eta, middle, &m, &x))
            lo = middle;
        else
            hi = middle;
    }
    *raw = hi;
    (void)spread(g->a, eta, hi, &m, &x);
    finish_element(g, eta, decay, hi, m, x, e);
    if (e->dead > REAL_C(-0.02)) { /* rounding */
        e->dead = e->dead > ZERO ? e->dead : ZERO;
        return flags;
    }
    if (!without_dead_time(g, eta, decay, e)) {
        without_lag(g, eta, e);
        return IDENTIFIED_NEGATIVE_L | IDENTIFIED_NEGATIVE_T;
    }
    return IDENTIFIED_NEGATIVE_L;
}

static enum err check_arguments(const struct moments *m, uint32_t output,
                                const struct excitation *u, const struct baseline *b)
{
    if (output >= m->outputs)
        return ERR_RANGE;
    if (m->samples == 0 || u->edges == 0)
        return ERR_EMPTY;
    return b ? baseline_validate(b) : ERR_OK;
}

/* Standard deviations by linear propagation through the source's formulas (h -> 0), eta taken as 1. */
static void deviations(const struct gradient *g, uint16_t flags, real_t a, real_t b, real_t eta,
                       const real_t noise[5], const real_t line[4], const struct baseline *base,
                       real_t h_s, struct identified *result)
{
    real_t k[3], t[3], l[3];
    for (int i = 0; i < 3; i++) {
        real_t da = g->a[i];
        if (flags & (IDENTIFIED_NEGATIVE_RADICAND | IDENTIFIED_NEGATIVE_T)) {
            k[i] = g->ln_g[i] + da;
            t[i] = ZERO;
            l[i] = da;
        } else if (flags & IDENTIFIED_NEGATIVE_L) {
            real_t rest = a < REAL_C(0.97) ? ONE - a : REAL_C(0.03);
            k[i] = g->ln_g[i] + da / rest;
            t[i] = da / (rest * rest);
            l[i] = ZERO;
        } else {
            real_t root = b > REAL_C(1e-6) ? real_sqrt(b) : REAL_C(1e-3);
            real_t rest = root < REAL_C(0.97) ? ONE - root : REAL_C(0.03);
            real_t d_root = g->b[i] / (REAL_C(2.0) * root);
            k[i] = g->ln_g[i] + da + root / rest * d_root;
            t[i] = d_root / (rest * rest);
            l[i] = da - d_root;
        }
    }
    real_t slope_sd = base->slope_sd_per_s * h_s, unit_s = h_s / eta;
    result->gain_sd =
        real_abs(result->gain) *
        real_sqrt(propagated_variance(k, noise, line, eta, base->offset_sd, slope_sd));
    result->time_constant_sd_s =
        unit_s * real_sqrt(propagated_variance(t, noise, line, eta, base->offset_sd, slope_sd));
    result->dead_time_sd_s =
        unit_s * real_sqrt(propagated_variance(l, noise, line, eta, base->offset_sd, slope_sd));
}

enum err moments_at(const struct moments *m, uint32_t i, uint32_t output,
                    const struct excitation *u, const struct baseline *b, struct identified *result,
                    real_t *raw_time_constant_s)
{
    enum err err = check_arguments(m, output, u, b);
    if (err)
        return err;
    if (i >= m->alphas)
        return ERR_RANGE;
    const struct baseline quiet = {ZERO, ZERO, ZERO, ZERO, ZERO};
    const struct baseline *base = b ? b : &quiet;
    real_t eta = m->alpha[i].eta, decay = m->alpha[i].decay, line[4], y[3];
    struct view input;
    err = view_input(u, eta, decay, &input);
    if (err)
        return err;

    for (int n = 0; n < 4; n++)
        line[n] = m->alpha[i].line[n].value;
    for (int n = 0; n < 3; n++)
        y[n] = m->alpha[i].sum[output][n].value - base->offset * line[n] -
               base->slope_per_s * m->h_s / eta * line[n + 1];
    /* Sums of tau^n e^(-2 tau): n!/2^(n + 1) / eta, the first exactly. */
    real_t s2 = base->noise_sd * base->noise_sd;
    const real_t noise[5] = {s2 / (ONE - decay * decay), s2 * REAL_C(0.25) / eta,
                             s2 * REAL_C(0.25) / eta, s2 * REAL_C(0.375) / eta,
                             s2 * REAL_C(0.75) / eta};

    const real_t only[3] = {ONE, ZERO, ZERO};
    real_t y_sd = real_sqrt(propagated_variance(only, noise, line, eta, base->offset_sd,
                                                base->slope_sd_per_s * m->h_s));
    *result = (struct identified){.flags = 0};
    if (!(real_abs(y[0]) > NO_GAIN_SDS * y_sd)) {
        result->gain = y[0] / input.value;
        result->gain_sd = y_sd / real_abs(input.value);
        result->flags = IDENTIFIED_NO_GAIN;
        if (raw_time_constant_s)
            *raw_time_constant_s = ZERO;
        return real_is_finite(result->gain + result->gain_sd) ? ERR_OK : ERR_NOT_FINITE;
    }

    real_t r1 = y[1] / y[0], r2 = y[2] / y[0];
    struct view plant = {
        .value = y[0] / input.value,
        .a = r1 / eta - input.a,
        .b = (r2 - r1 * r1) / (eta * eta) - input.b,
    };
    /* Rubbish (moments of noise alone, offered without its deviation) can be far out. */
    if (!(real_abs(plant.a) < FAR && real_abs(plant.b) < FAR * FAR))
        return ERR_NOT_FINITE;
    struct element e;
    real_t raw;
    result->flags = solve(&plant, eta, decay, &e, &raw);
    result->gain = e.gain;
    result->time_constant_s = e.lag * m->h_s;
    result->dead_time_s = e.dead * m->h_s;
    if (!real_is_finite(e.gain) || !real_is_finite(e.lag) || !real_is_finite(e.dead))
        return ERR_NOT_FINITE;

    struct gradient g;
    g.ln_g[0] = ONE / y[0];
    g.ln_g[1] = g.ln_g[2] = ZERO;
    g.a[0] = -r1 / y[0];
    g.a[1] = ONE / y[0];
    g.a[2] = ZERO;
    g.b[0] = (REAL_C(2.0) * r1 * r1 - r2) / y[0];
    g.b[1] = REAL_C(-2.0) * r1 / y[0];
    g.b[2] = ONE / y[0];
    deviations(&g, result->flags, plant.a * eta, plant.b * eta * eta, eta, noise, line, base,
               m->h_s, result);
    if (eta * (real_t)m->samples < REAL_C(3.0))
        result->flags |= IDENTIFIED_SHORT;
    if (raw_time_constant_s)
        *raw_time_constant_s = raw * m->h_s;
    return real_is_finite(result->gain_sd + result->time_constant_sd_s + result->dead_time_sd_s)
               ? ERR_OK
               : ERR_NOT_FINITE;
}

/* Alpha of the bank nearest to 1/samples, in ratio. */
static uint32_t nearest(const struct moments *m, real_t samples)
{
    uint32_t best = 0;
    real_t distance = REAL_C(1e30);
    for (uint32_t i = 0; i < m->alphas; i++) {
        real_t off = m->alpha[i].eta * samples;
        off = off < ONE ? ONE / off : off;
        if (off < distance) {
            distance = off;
            best = i;
        }
    }
    return best;
}

/* Times that say where to look next. */
static bool usable_times(enum err err, const struct identified *r)
{
    return !err && (r->flags & ~IDENTIFIED_SHORT) == 0 && r->time_constant_s > ZERO;
}

enum err moments_element(const struct moments *m, uint32_t output, const struct excitation *u,
                         const struct baseline *b, real_t guess_s, struct identified *result,
                         uint32_t *chosen)
{
    enum err err = check_arguments(m, output, u, b);
    if (!err)
        err = check_real(guess_s, ZERO, REAL_C(1e7));
    if (err)
        return err;
    uint32_t length = u->edges > 1 ? u->edge[1].sample - u->edge[0].sample : m->samples;
    if (length == 0)
        return ERR_EMPTY;
    real_t samples =
        guess_s > ZERO ? guess_s / m->h_s : (real_t)length / REAL_C(5.991464547); /* 2 ln 20 */
    uint32_t at = nearest(m, samples > REAL_C(1e-3) ? samples : REAL_C(1e-3));
    struct identified first;
    err = moments_at(m, at, output, u, b, &first, NULL);
    /* Nothing to be seen so early in the response, or alpha t too small: look along the bank. */
    while (err == ERR_SINGULAR && at > 0)
        err = moments_at(m, --at, output, u, b, &first, NULL);
    while (!err && (first.flags & IDENTIFIED_NO_GAIN) && at + 1 < m->alphas) {
        struct identified slower;
        if (moments_at(m, at + 1, output, u, b, &slower, NULL))
            break;
        first = slower;
        at++;
    }
    if (err)
        return err;
    struct identified now = first;
    for (int i = 0; i < CHOICES && usable_times(ERR_OK, &now); i++) {
        uint32_t next = nearest(m, (now.time_constant_s + now.dead_time_s) / m->h_s);
        struct identified other;
        if (next == at || !usable_times(moments_at(m, next, output, u, b, &other, NULL), &other))
            break;
        at = next;
        now = other;
    }
    *result = now;
    if (chosen)
        *chosen = at;
    return ERR_OK;
}
