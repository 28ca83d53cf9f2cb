#include "kinds/inferential/inferential_gains.h"

#include <stddef.h>

#include "num/real.h"

/* Steps are halved until the matrix is this small, and the series of three terms is exact in float. */
#define SMALL_STEP  0.01f
#define HALVES_MOST 60u

static float largest_entry(float a[2][2])
{
    float most = 0;
    for (unsigned i = 0; i < 4; i++)
        if (real_abs(a[i / 2][i % 2]) > most)
            most = real_abs(a[i / 2][i % 2]);
    return most;
}

static void multiply_2x2(float a[2][2], float b[2][2], float out[2][2])
{
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++)
            out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j];
}

/* d = exp(m) - 1, without the digits that subtracting 1 would cost: d(2t) = 2 d(t) + d(t) d(t). */
static void exp_less_one(float m[2][2], float d[2][2])
{
    float m2[2][2], m3[2][2], square[2][2], part = 1;
    unsigned halves = 0;
    while (largest_entry(m) * part > SMALL_STEP && halves < HALVES_MOST) {
        part *= 0.5f;
        halves++;
    }
    for (unsigned i = 0; i < 4; i++)
        m[i / 2][i % 2] *= part;
    multiply_2x2(m, m, m2);
    multiply_2x2(m2, m, m3);
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++)
            d[i][j] = m[i][j] + m2[i][j] / 2 + m3[i][j] / 6;
    for (; halves; halves--) {
        multiply_2x2(d, d, square);
        for (unsigned i = 0; i < 2; i++)
            for (unsigned j = 0; j < 2; j++)
                d[i][j] = 2 * d[i][j] + square[i][j];
    }
}

/* (1 - exp(-rate step))/step */
static float rate_of_step(float rate, float step)
{
    float m[2][2] = {{-rate * step, 0}, {0, 0}}, d[2][2];
    exp_less_one(m, d);
    return -d[0][0] / step;
}

/* Factors of y1 and e2 in -u* and -u~, in EU. */
struct shares {
    float p1, p2, q1, q2;
};

static struct shares euler_shares(const struct inferential_config *c)
{
    float a2 = c->a[SECONDARY], r = c->a[PRIMARY] / a2;
    return (struct shares){.p1 = c->kc / c->a[PRIMARY],
                           .q1 = c->law == LAW_CLF ? c->kc2 * r / a2 : 0,
                           .q2 = c->kc2 / a2};
}

static struct shares joint_shares(const struct inferential_config *c)
{
    float h = c->interval_h, a1 = c->a[PRIMARY], a2 = c->a[SECONDARY], r = a1 / a2, d[2][2];
    float m[2][2] = {{-c->kc * h, -c->kc2 * r * h}, {0, -c->kc2 * h}};
    if (c->law == LAW_CLF) {
        m[0][0] -= c->kc2 * r * r * h;
        m[1][0] = m[0][1];
    }
    exp_less_one(m, d);
    struct shares s = {.q1 = -d[1][0] / (h * a2), .q2 = -d[1][1] / (h * a2)};
    s.p1 = -d[0][0] / (h * a1) - s.q1;
    s.p2 = -d[0][1] / (h * a1) - s.q2;
    return s;
}

static struct shares shares_of(const struct inferential_config *c, bool pair)
{
    if (pair)
        return c->form == FORM_JOINT ? joint_shares(c) : euler_shares(c);
    float kc = c->form == FORM_JOINT ? rate_of_step(c->kc, c->interval_h) : c->kc;
    return (struct shares){.p1 = kc / c->a[PRIMARY]};
}

void inferential_coefficients_of(const struct inferential_config *c, bool pair,
                                 struct inferential_coefficients *out)
{
    struct shares s = shares_of(c, pair);
    float ko = c->form == FORM_JOINT ? rate_of_step(c->ko, c->interval_h) : c->ko;
    float of1 = c->span[PRIMARY] / c->u_span, of2 = c->span[SECONDARY] / c->u_span;
    *out = (struct inferential_coefficients){
        .p1 = coefficient_from_float(s.p1 * of1),
        .q1 = coefficient_from_float(s.q1 * of1),
        .o1 = coefficient_from_float(ko / c->a[PRIMARY] * of1),
        .k = coefficient_from_float(-ko * c->interval_h),
    };
    if (!pair)
        return;
    out->p2 = coefficient_from_float(s.p2 * of2);
    out->q2 = coefficient_from_float(s.q2 * of2);
    out->o2 = coefficient_from_float(ko / c->a[SECONDARY] * of2);
    out->g2 = coefficient_from_float(c->a[SECONDARY] * c->interval_h / of2);
}

void inferential_predicted(const struct inferential_config *c, uint8_t law, float *frequency,
                           float *damping)
{
    float other = law == LAW_CONVENTIONAL ? c->ko : c->kc2, sum = c->kc + other;
    if (law == LAW_CLF) {
        float r = c->a[PRIMARY] / c->a[SECONDARY];
        sum += c->kc2 * r * r;
    }
    *frequency = law == LAW_HOLD ? 0 : real_sqrt(c->kc * other);
    *damping = law == LAW_HOLD ? 0 : sum / (2 * *frequency);
}

/* ---- checks ---- */

/* Larger factors between spans are a mistake of units, and more than Q7.24 could follow. */
#define SHARE_MOST   1000.0f
#define SLOPES_APART 1000.0f

static bool is_share(float x)
{
    return real_abs(x) <= SHARE_MOST; /* false for NaN */
}

static const char *wrong_pair(const struct inferential_config *c, const char **field)
{
    float r = real_abs(c->a[PRIMARY] / c->a[SECONDARY]);
    if (!(r <= SLOPES_APART && r >= 1 / SLOPES_APART)) {
        *field = "a";
        return "needs slopes of the two temperatures within a factor of 1000";
    }
    *field = "kc2";
    if (c->form == FORM_EULER && !(c->interval_h * (c->kc2 + c->ko) < 1))
        return "needs Ts (kc2 + ko) below 1 in form euler: form joint takes any";
    /* Else y1 overshoots within a step, and from about twice that on the loop is unstable. */
    if (c->form == FORM_EULER && c->law == LAW_CLF &&
        !(c->interval_h * (c->kc + c->kc2 * (1 + r * r)) < 1))
        return "needs Ts (kc + kc2 + kc2 (a1/a2)^2) below 1 in form euler: form joint takes any";
    struct shares s = shares_of(c, true);
    float of1 = c->span[PRIMARY] / c->u_span, of2 = c->span[SECONDARY] / c->u_span;
    if (!is_share(s.p1 * of1) || !is_share(s.q1 * of1) || !is_share(s.p2 * of2) ||
        !is_share(s.q2 * of2) || !is_share(c->ko / c->a[SECONDARY] * of2) ||
        !is_share(c->a[SECONDARY] * c->interval_h / of2))
        return "makes factors above 1000 between spans: slopes and gains do not fit";
    return NULL;
}

const char *inferential_wrong(const struct inferential_config *c, const char **field)
{
    float of1 = c->span[PRIMARY] / c->u_span;
    if (c->law == LAW_HOLD)
        return NULL;
    *field = "kc";
    if (c->form == FORM_EULER && !(c->interval_h * (c->kc + c->ko) < 1))
        return "needs Ts (kc + ko) below 1 in form euler: form joint takes any";
    *field = "a";
    if (!is_share(shares_of(c, false).p1 * of1) || !is_share(c->ko / c->a[PRIMARY] * of1))
        return "makes a gain above 1000 spans per span: slope and gains do not fit";
    return c->law == LAW_CONVENTIONAL ? NULL : wrong_pair(c, field);
}
