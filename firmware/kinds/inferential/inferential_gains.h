/* The equations of docs/methods/inferential.md in steps and fractions of span. For this folder alone. */
#ifndef REFLUX_INFERENTIAL_INFERENTIAL_GAINS_H
#define REFLUX_INFERENTIAL_INFERENTIAL_GAINS_H

#include "kinds/inferential/inferential_settings.h"
#include "num/accumulator.h"

#if CONFIG_BLOCKS

struct inferential_config {
    uint8_t law, form; /* enum inferential_law, inferential_form */
    /* EU/h per EU of the output; a[SECONDARY] is read where there is a secondary */
    float a[2];
    float kc, kc2, ko;     /* 1/h */
    float interval_h;      /* of the steps */
    float span[2], u_span; /* EU */
};

/* Factors of the equations, for steps and fractions of span. */
struct inferential_coefficients {
    struct coefficient p1, p2; /* u*: of y1, of e2 */
    struct coefficient q1, q2; /* u~ */
    struct coefficient o1, o2; /* the observers' share of T1 and T2 */
    struct coefficient k;      /* part by which x goes in a step, negative */
    struct coefficient g2;     /* a2 over a step */
};

/* The equations in steps and fractions; conventional where `pair` is false. */
void inferential_coefficients_of(const struct inferential_config *c, bool pair,
                                 struct inferential_coefficients *out);

/* Frequency, 1/h, and damping of deviations under the law that computes, Frau (4.42), (4.63). */
void inferential_predicted(const struct inferential_config *c, uint8_t law, float *frequency,
                           float *damping);

/* Returns why the settings are refused, in words, and the name of the parameter; NULL: they are accepted. */
const char *inferential_wrong(const struct inferential_config *c, const char **field);

#endif
#endif
