/* One loop of composition control from tray temperatures: a primary temperature T1, a secondary one T2, one output u.
 *
 *     dT1/dt = a1 u + b1      dT2/dt = a2 u + b2          loads b estimated by observers of what took effect of u
 *     u = u* + u~             u* the primary action, u~ the secondary one (cascade and CLF)
 *
 * Source: A. Frau, thesis, Cagliari, chapter 4, (4.10), (4.26) to (4.30), (4.59) to (4.61), with the signs of the observers
 * repaired; the joint form, the setpoint that passes the observers by, and what u* may be at a limit are ours. All of it is
 * derived in docs/inferential.md.
 *
 * Signals are fractions of span. The states are kept in fractions of the output's span: x_i = chi_i/a_i. Order of calls: init,
 * follow, then step and back_calculate in turn; follow again whenever the loop does not act. */
#ifndef REFLUX_INFERENTIAL_INFERENTIAL_H
#define REFLUX_INFERENTIAL_INFERENTIAL_H

#include "kinds/inferential/inferential_settings.h"

#if CONFIG_BLOCKS

#include "num/accumulator.h"

struct inferential_config {
    uint8_t law, form; /* enum inferential_law, inferential_form */
    float a[2]; /* EU/h per EU of the output; a[SECONDARY] is read where there is a secondary */
    float kc, kc2, ko;     /* 1/h */
    float interval_h;      /* of the steps */
    float span[2], u_span; /* EU */
};

/* What the equations come to in steps and fractions of span. */
struct inferential_coefficients {
    struct coefficient p1, p2; /* u*: of y1, of e2 */
    struct coefficient q1, q2; /* u~ */
    struct coefficient o1, o2; /* the observers' share of T1 and T2 */
    struct coefficient k;      /* how far x goes in a step, negative */
    struct coefficient g2;     /* a2 over a step */
};

struct inferential {
    struct inferential_config config, next;      /* next: settings that wait */
    bool waits, same_second;                     /* same_second: T2 is what it was before them */
    struct inferential_coefficients alone, pair; /* without and with the secondary */
    uint8_t acts; /* enum inferential_law: what computes, without the secondary conventional */
    int8_t cut;   /* the last output was cut from above (1), from below (-1) */
    struct accumulator x1, x2; /* observers */
    struct accumulator wanted; /* T2* - from2 */
    num_t from1, from2;     /* where T1 and T2 were when it began: what is multiplied stays small */
    num_t setpoint, t1, t2; /* inputs of the last step */
    num_t primary;          /* u* of the last step */
    num_t given, told;      /* u of the last step; what took effect */
};

/* The words why these cannot be, with the name of the parameter; NULL: they can. */
const char *inferential_wrong(const struct inferential_config *c, const char **field);

/* Settings that are not wrong. State is cleared: call follow before step. */
void inferential_init(struct inferential *s, const struct inferential_config *c);

/* New settings wait for the next step: its output is what the old ones give for its inputs, whatever moves meanwhile.
 * same_second: T2 is what it was; else T2* begins anew. */
void inferential_retune(struct inferential *s, const struct inferential_config *c,
                        bool same_second);

/* The next step with the same inputs gives u. second: T2 is there; without it the loop is conventional. */
void inferential_follow(struct inferential *s, num_t setpoint, num_t t1, num_t t2, bool second,
                        num_t u);

/* Output for these inputs. */
num_t inferential_step(struct inferential *s, num_t setpoint, num_t t1, num_t t2, bool second);

/* told: the output that took effect. clamp: enum integral_clamp, directions in which it may not move on. */
void inferential_back_calculate(struct inferential *s, num_t told, uint8_t clamp);

/* Estimated load of temperature i (PRIMARY, SECONDARY), EU/h, with u counted from the lower end of its span. */
float inferential_load(const struct inferential *s, unsigned i);

/* T2 - T2*, fraction of T2's span; 0 where there is no secondary. */
num_t inferential_away(const struct inferential *s);

/* ---- inferential_gains.c ---- */

/* The equations in steps and fractions; conventional where `pair` is false. */
void inferential_coefficients_of(const struct inferential_config *c, bool pair,
                                 struct inferential_coefficients *out);

/* Frequency, 1/h, and damping with which deviations go, Frau (4.42), (4.63) [law: what computes]. */
void inferential_predicted(const struct inferential_config *c, uint8_t law, float *frequency,
                           float *damping);

#endif
#endif
