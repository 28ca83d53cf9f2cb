/* First-order-plus-dead-time elements by weighted moments (Johansson 1994, section "method of weighted moments"),
 * without a stored trajectory: three running sums per output and alpha.
 *
 * The right alpha is about 1/(L + T), and the length of the step that gives a second choice is known only when the
 * step is over; so a bank of alphas in fixed ratio runs, and the choice is made at the end.
 *
 * Sampling is accounted for exactly, not by a quadrature: the sums M_n = sum (alpha k h)^n e^(-alpha k h) y(k h) are
 * derivatives of the z transform at z = e^(alpha h), and so is the input's (closed form from its edges). Their
 * logarithmic derivatives subtract to those of the pulse transfer function of the element under a zero-order hold, and
 * that is solved for K, T and L: a noise-free first-order record gives them back to rounding, whatever T/h. With
 * h -> 0 it is the source's a = sqrt(G''/G - (G'/G)^2), T = a/(1 - alpha a), L = -G'/G - a.
 *
 * Usage, in a tick:   y = sample;  moments_step(y);  then the input moves (edge at this sample)
 * The first sample after moments_begin() is the one at whose instant the first edge takes place.
 */
#ifndef REFLUX_IDENTIFY_MOMENTS_H
#define REFLUX_IDENTIFY_MOMENTS_H

#include <stdint.h>

#include "base/channel.h"
#include "base/error.h"
#include "identify/excitation.h"
#include "identify/identified.h"
#include "num/real.h"

#ifndef MOMENTS_ALPHAS_MAX
#define MOMENTS_ALPHAS_MAX 12
#endif
#define MOMENTS_FASTEST 0.5f /* alpha h of the first of the bank, by default */
#define MOMENTS_RATIO   2.0f /* from one alpha to the next, by default */

struct moments_config {
    uint32_t outputs; /* 1 to CHANNEL_MAX */
    uint32_t alphas;  /* 1 to MOMENTS_ALPHAS_MAX */
    real_t h_s;       /* sample interval, s, [1e-3, 1e5] */
    real_t fastest;   /* alpha h of the first, (0, 1]; MOMENTS_FASTEST */
    real_t ratio;     /* [1.1, 10]; MOMENTS_RATIO */
};

/* Compensated sum (Kahan 1965): a slow alpha adds tens of thousands of terms, of which the last are lost in a plain
 * float. */
struct moments_sum {
    real_t value, carry;
};

struct moments {
    uint32_t outputs, alphas, samples;
    real_t h_s;
    real_t reference[CHANNEL_MAX]; /* taken off every sample, so that the sums hold deviations */
    struct {
        real_t eta;                 /* alpha h */
        real_t decay;               /* e^-eta */
        real_t weight;              /* e^(-eta k) of the next sample */
        struct moments_sum line[4]; /* of 1: what an offset and a drift have put into the others */
        struct moments_sum sum[CHANNEL_MAX][3];
    } alpha[MOMENTS_ALPHAS_MAX];
};

/* Alphas of the default bank needed to reach 1/slowest_s, at most MOMENTS_ALPHAS_MAX. */
uint32_t moments_alphas_for(real_t h_s, real_t slowest_s);

/* ERR_RANGE, ERR_NOT_FINITE. *m unchanged on error. */
MUST_CHECK enum err moments_init(struct moments *m, const struct moments_config *config);

/* Next experiment: sums empty. reference: outputs values, level of each before the step (any value near it will do: the
 * rest goes into the baseline). ERR_NOT_FINITE: *m unchanged. */
MUST_CHECK enum err moments_begin(struct moments *m, const real_t *reference);

/* One sample of every output. Cost: 3 products and sums per output and alpha. The grid must have no holes: for a
 * sample that is missing give the one before. ERR_NOT_FINITE, ERR_RANGE (more than 1e12 from reference): *m unchanged,
 * and the experiment is a sample short. */
MUST_CHECK enum err moments_step(struct moments *m, const real_t *y);

/* 1/s. i below alphas. */
real_t moments_alpha(const struct moments *m, uint32_t i);

/* Estimate at one alpha of the bank. u: what the input did; its first edge counts as sample 0. b, or NULL: what is to be
 * removed from this output, offset against reference, time from sample 0; and its noise, from which the standard
 * deviations come (white noise assumed). Flags: NO_GAIN (|G(alpha)| below 3 of its standard deviations), NEGATIVE_T,
 * NEGATIVE_RADICAND, NEGATIVE_L, SHORT. *raw_time_constant_s, or NULL: T before any fall-back, may be negative.
 * ERR_EMPTY: no samples or no edge; ERR_SINGULAR: the input has no strength at this alpha; ERR_RANGE, ERR_NOT_FINITE. */
MUST_CHECK enum err moments_at(const struct moments *m, uint32_t i, uint32_t output,
                               const struct excitation *u, const struct baseline *b,
                               struct identified *result, real_t *raw_time_constant_s);

/* Chooses alpha and estimates there. guess_s: L + T if somebody knows, else 0. Without it begins at 2 ln 20/t_i, t_i the
 * length of the first level (Johansson 1994), then goes to the alpha nearest 1/(L + T) until it stays; where it finds
 * none it falls back on the first. *chosen, or NULL: index into the bank. Errors as moments_at. */
MUST_CHECK enum err moments_element(const struct moments *m, uint32_t output,
                                    const struct excitation *u, const struct baseline *b,
                                    real_t guess_s, struct identified *result, uint32_t *chosen);

#endif
