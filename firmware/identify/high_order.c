#include "identify/high_order.h"

#include <stddef.h>
#include <string.h>

#include "base/assertion.h"
#include "identify/common.h"
#include "num/real_trig.h"

const struct high_order_shape high_order_siddha_joint = {5, 2, {3, 14}, {12, 8}};
const struct high_order_shape high_order_siddha_process = {2, 1, {3, 0}, {12, 0}};
const struct high_order_shape high_order_siddha_sensitivity = {20, 1, {15, 0}, {8, 0}};
const struct high_order_shape high_order_siddha_tracking = {13, 1, {3, 0}, {12, 0}};
const struct high_order_shape high_order_siddha_input = {15, 1, {10, 0}, {8, 0}};

/* Sums over the samples learnt from, of forget^age and of its square: what P has been divided by, and what the noise has been. */
struct high_order {
    struct high_order_shape shape;
    uint32_t samples; /* learnt from */
    uint16_t past;    /* samples in it, to what it holds */
    float weight, weight_squares;
    num_t value[]; /* y(k-1) ... y(k-na), then of each input u(k) ...; then the estimator */
};

/* ---- memory ---- */

unsigned high_order_parameters(const struct high_order_shape *s)
{
    unsigned n = s->na;
    for (unsigned j = 0; j < s->inputs; j++)
        n += s->nb[j];
    return n;
}

static unsigned reach_of(const struct high_order_shape *s, unsigned j)
{
    return (unsigned)s->delay[j] + s->nb[j];
}

static unsigned values_of(const struct high_order_shape *s)
{
    unsigned n = s->na;
    for (unsigned j = 0; j < s->inputs; j++)
        n += reach_of(s, j);
    return n;
}

static uint32_t rls_at(const struct high_order_shape *s)
{
    size_t bytes = offsetof(struct high_order, value) + values_of(s) * sizeof(num_t);
    return (uint32_t)((bytes + 7u) & ~(size_t)7u);
}

uint32_t high_order_bytes(const struct high_order_shape *s)
{
    return rls_at(s) + rls_bytes(high_order_parameters(s));
}

static struct rls *rls_of(struct high_order *h)
{
    return (struct rls *)(void *)((char *)h + rls_at(&h->shape));
}

const struct rls *high_order_rls(const struct high_order *h)
{
    return (const struct rls *)(const void *)((const char *)h + rls_at(&h->shape));
}

/* ---- settings ---- */

static enum err refuse_order(const char **field, const char **wanted, const char *name,
                             const char *range)
{
    if (field)
        *field = name;
    if (wanted)
        *wanted = range;
    return ERR_RANGE;
}

static void fill_rls_settings(const struct high_order_settings *s, unsigned n, float *p0,
                              struct rls_settings *r)
{
    for (unsigned i = 0; i < n; i++)
        p0[i] = s->p0;
    *r = (struct rls_settings){.n = (uint8_t)n,
                               .forgetting = s->forgetting,
                               .forget = s->forget,
                               .forget_least = s->forget_least,
                               .sigma0 = s->sigma0,
                               .memory = s->memory,
                               .trace = s->trace,
                               .p0 = p0,
                               .rate = 0.5f};
}

enum err high_order_check(const struct high_order_shape *shape,
                          const struct high_order_settings *settings, const char **field,
                          const char **wanted)
{
    float p0[RLS_MAX];
    struct rls_settings r;
    if (shape->inputs < 1 || shape->inputs > HIGH_ORDER_INPUTS)
        return refuse_order(field, wanted, "inputs", "1 or 2");
    for (unsigned j = 0; j < shape->inputs; j++) {
        if (shape->nb[j] < 1)
            return refuse_order(field, wanted, "nb", "1 and more for each input");
        if (reach_of(shape, j) > HIGH_ORDER_DELAY_MOST)
            return refuse_order(field, wanted, "delay", "with nb at most 100 samples");
    }
    if (high_order_parameters(shape) > RLS_MAX)
        return refuse_order(field, wanted, "na", "with nb at most 35 parameters");
    fill_rls_settings(settings, high_order_parameters(shape), p0, &r);
    return rls_check(&r, field, wanted);
}

/* ---- samples ---- */

void high_order_init(struct high_order *h, const struct high_order_shape *shape,
                     const struct high_order_settings *settings)
{
    REFLUX_ASSERT(shape->inputs <= HIGH_ORDER_INPUTS && high_order_parameters(shape) <= RLS_MAX);
    float p0[RLS_MAX];
    num_t start[RLS_MAX];
    struct rls_settings r;
    memset(h, 0, rls_at(shape));
    h->shape = *shape;
    for (unsigned i = 0; i < values_of(shape); i++)
        h->value[i] = num_zero();
    for (unsigned i = 0; i < RLS_MAX; i++)
        start[i] = num_zero();
    fill_rls_settings(settings, high_order_parameters(shape), p0, &r);
    rls_init(rls_of(h), &r, start);
}

void high_order_retune(struct high_order *h, const struct high_order_settings *settings)
{
    REFLUX_ASSERT(high_order_parameters(&h->shape) <= RLS_MAX);
    float p0[RLS_MAX];
    struct rls_settings r;
    fill_rls_settings(settings, high_order_parameters(&h->shape), p0, &r);
    rls_retune(rls_of(h), &r);
}

void high_order_reset(struct high_order *h)
{
    rls_reset(rls_of(h));
    h->weight = h->weight_squares = 0;
    h->samples = 0;
}

/* The newest to the front of n values. */
static void push_newest(num_t *value, unsigned n, num_t newest)
{
    if (!n)
        return;
    memmove(value + 1, value, (n - 1u) * sizeof *value);
    value[0] = newest;
}

static uint16_t past_wanted(const struct high_order_shape *s)
{
    unsigned most = s->na;
    for (unsigned j = 0; j < s->inputs; j++)
        most = reach_of(s, j) > most ? reach_of(s, j) : most;
    return (uint16_t)most;
}

static void form_regressor(const struct high_order *h, num_t *phi)
{
    const struct high_order_shape *s = &h->shape;
    const num_t *from = h->value + s->na;
    for (unsigned i = 0; i < s->na; i++)
        *phi++ = num_neg(h->value[i]);
    for (unsigned j = 0; j < s->inputs; j++) {
        memcpy(phi, from + s->delay[j], s->nb[j] * sizeof *phi);
        phi += s->nb[j];
        from += reach_of(s, j);
    }
}

num_t high_order_step(struct high_order *h, num_t y, const num_t *u, bool learn)
{
    REFLUX_ASSERT(h->shape.inputs <= HIGH_ORDER_INPUTS &&
                  high_order_parameters(&h->shape) <= RLS_MAX);
    const struct high_order_shape *s = &h->shape;
    num_t phi[RLS_MAX], *to = h->value + s->na;
    for (unsigned j = 0; j < s->inputs; j++) {
        push_newest(to, reach_of(s, j), u[j]);
        to += reach_of(s, j);
    }
    bool whole = h->past >= past_wanted(s);
    h->past = (uint16_t)(whole ? h->past : h->past + 1u);
    form_regressor(h, phi);
    num_t e = rls_step(rls_of(h), phi, y, learn && whole);
    if (learn && whole) {
        float v = rls_forgot(rls_of(h));
        h->weight = v * h->weight + 1;
        h->weight_squares = v * v * h->weight_squares + 1;
        h->samples++;
    }
    push_newest(h->value, s->na, y);
    return e;
}

void high_order_interrupt(struct high_order *h)
{
    h->past = 0;
}

uint32_t high_order_samples(const struct high_order *h)
{
    return h->samples;
}

/* ---- response ---- */

static real_t theta_of(const struct high_order *h, unsigned i)
{
    return num_to_float(rls_theta(high_order_rls(h), i));
}

/* theta[from] + theta[from + 1] back + ...; *size gets the sum of magnitudes. */
static struct cplx sum_of_theta(const struct high_order *h, unsigned from, unsigned n,
                                struct cplx back, real_t *size)
{
    struct cplx sum = cplx(ZERO, ZERO);
    *size = ZERO;
    for (unsigned k = n; k-- > 0;) {
        sum = cplx_mul(sum, back);
        sum.re += theta_of(h, from + k);
        *size += real_abs(theta_of(h, from + k));
    }
    return sum;
}

/* back^n, of magnitude 1 whatever n is. */
static struct cplx phase_of_delay(real_t omega_h, unsigned n)
{
    real_t sine, cosine;
    real_sincos(omega_h * (real_t)n, &sine, &cosine);
    return cplx(cosine, -sine);
}

/* Derivatives by n parameters from `from` on: factor, factor back, ... */
static void put_derivatives(float *re, float *im, unsigned from, unsigned n, struct cplx factor,
                            struct cplx back)
{
    for (unsigned k = 0; k < n; k++, factor = cplx_mul(factor, back)) {
        re[from + k] = (float)factor.re;
        im[from + k] = (float)factor.im;
    }
}

/* With old data forgotten, theta varies by P (sum v^2age phi phi') P, not by P: by as much less as the two sums are apart, where
 * the data have always been alike. */
static real_t deviation_of(const struct high_order *h, const float *re, const float *im)
{
    const struct rls *r = high_order_rls(h);
    float size = rls_error_sd(r);
    float share = h->weight > 0 ? h->weight_squares / h->weight : 1;
    float square = (rls_form(r, re) + rls_form(r, im)) * share * size * size;
    return real_sqrt((real_t)square);
}

static bool is_root(struct cplx sum, real_t size)
{
    return real_abs(sum.re) + real_abs(sum.im) <= REAL_C(16.0) * REAL_EPSILON * size;
}

static enum err check_frequency(real_t omega_h)
{
    return check_real(omega_h, REAL_C(1e-6), REAL_C(3.141594));
}

enum err high_order_response(const struct high_order *h, unsigned j, real_t omega_h,
                             struct high_order_point *p)
{
    const struct high_order_shape *s = &h->shape;
    float re[RLS_MAX] = {0}, im[RLS_MAX] = {0};
    unsigned from = s->na;
    real_t size;
    enum err err = j >= s->inputs ? ERR_RANGE : check_frequency(omega_h);
    if (err)
        return err;
    for (unsigned k = 0; k < j; k++)
        from += s->nb[k];
    struct cplx back = phase_of_delay(omega_h, 1);
    struct cplx a = cplx_mul(sum_of_theta(h, 0, s->na, back, &size), back);
    a.re += ONE;
    if (is_root(a, size + ONE))
        return ERR_SINGULAR;
    struct cplx factor = cplx_div(phase_of_delay(omega_h, s->delay[j]), a);
    p->value = cplx_mul(sum_of_theta(h, from, s->nb[j], back, &size), factor);
    /* dG/db_i = back^(delay + i)/A, dG/da_i = -G back^i/A */
    put_derivatives(re, im, from, s->nb[j], factor, back);
    struct cplx by_a = cplx_mul(cplx_div(cplx_scale(p->value, -ONE), a), back);
    put_derivatives(re, im, 0, s->na, by_a, back);
    p->sd = deviation_of(h, re, im);
    return ERR_OK;
}

enum err high_order_ratio(const struct high_order *h, real_t omega_h, struct high_order_point *p)
{
    const struct high_order_shape *s = &h->shape;
    float re[RLS_MAX] = {0}, im[RLS_MAX] = {0};
    real_t size;
    enum err err = s->inputs < 2 ? ERR_RANGE : check_frequency(omega_h);
    if (err)
        return err;
    struct cplx back = phase_of_delay(omega_h, 1);
    struct cplx below = sum_of_theta(h, s->na, s->nb[0], back, &size);
    if (is_root(below, size))
        return ERR_SINGULAR;
    below = cplx_mul(below, phase_of_delay(omega_h, s->delay[0]));
    struct cplx factor = cplx_div(phase_of_delay(omega_h, s->delay[1]), below);
    p->value = cplx_mul(sum_of_theta(h, (unsigned)s->na + s->nb[0], s->nb[1], back, &size), factor);
    put_derivatives(re, im, (unsigned)s->na + s->nb[0], s->nb[1], factor, back);
    struct cplx by_b =
        cplx_mul(cplx_div(cplx_scale(p->value, -ONE), below), phase_of_delay(omega_h, s->delay[0]));
    put_derivatives(re, im, s->na, s->nb[0], by_b, back);
    p->sd = deviation_of(h, re, im);
    return ERR_OK;
}
