/* One loop of composition control from tray temperatures: a primary temperature T1, a secondary one T2, one output u.
 *
 *     dT1/dt = a1 u + b1      dT2/dt = a2 u + b2          loads b estimated by observers of what took effect of u
 *     u = u* + u~             u* the primary action, u~ the secondary one (cascade and CLF)
 *
 * Source: A. Frau, thesis, Cagliari, chapter 4, (4.10), (4.26) to (4.30), (4.59) to (4.61), with the signs of the observers
 * repaired; the joint form, the setpoint that passes the observers by, and what u* may be at a limit are ours. All of it is
 * derived in docs/methods/inferential.md.
 *
 * Signals are fractions of span. The states are kept in fractions of the output's span: x_i = chi_i/a_i. Order of calls: init,
 * follow, then step and back_calculate in turn; follow again whenever the loop does not act. */
#ifndef REFLUX_INFERENTIAL_INFERENTIAL_H
#define REFLUX_INFERENTIAL_INFERENTIAL_H

#include "kinds/inferential/inferential_gains.h"

#if CONFIG_BLOCKS

struct inferential;

/* Settings that are not wrong. State is cleared: call follow before step. */
void inferential_init(struct inferential *s, const struct inferential_config *c);

/* New settings wait for the next step: its output is what the old ones give for its inputs, whatever moves meanwhile.
 * same_second: T2 is what it was; else T2* begins anew. */
void inferential_retune(struct inferential *s, const struct inferential_config *c,
                        bool same_second);

/* The next step with the same inputs gives u. second: T2 is good; without it the loop is conventional. */
void inferential_follow(struct inferential *s, num_t setpoint, num_t t1, num_t t2, bool second,
                        num_t u);

/* Output for these inputs. */
num_t inferential_step(struct inferential *s, num_t setpoint, num_t t1, num_t t2, bool second);

/* applied: the output that took effect. clamp: enum integral_clamp, directions in which it may not move on. */
void inferential_back_calculate(struct inferential *s, num_t applied, uint8_t clamp);

/* Estimated load of temperature i (PRIMARY, SECONDARY), EU/h, with u counted from the lower end of its span. */
float inferential_load(const struct inferential *s, unsigned i);

/* T2 - T2*, fraction of T2's span; 0 where there is no secondary. */
num_t inferential_away(const struct inferential *s);

/* Settings in force. */
const struct inferential_config *inferential_config(const struct inferential *s);
/* Returns the enum inferential_law that computes: without the secondary the conventional one. */
uint8_t inferential_acts(const struct inferential *s);
/* Returns the output that took effect. */
num_t inferential_applied(const struct inferential *s);

/* The last step, for the console. */
struct inferential_inner {
    num_t y1;                 /* T1 less its setpoint */
    num_t primary, secondary; /* u*, u~ */
    int8_t cut;               /* the output was cut from above (1), from below (-1) */
};
struct inferential_inner inferential_inner(const struct inferential *s);

#endif
#endif
