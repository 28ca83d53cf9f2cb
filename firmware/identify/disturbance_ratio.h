/* Gd/Gp of one loop with a measured disturbance, at a frequency, from responses that can be identified while the loop is closed
 * (R. Siddha 2003, chapter 3), and what else follows from them:
 *
 *     y = Gp u + Gd d    u = u_fb + u_ff    u_fb = Cr r - C y    u_ff = F d
 *
 *     S = 1/(1 + Gp C)    Sd = Gd S: d to y (3.1)    T = Gp Cr S: r to y (3.2)
 *
 *     B   Gd/Gp = Sd (1 + Gp C)/Gp          (3.5)
 *     C   Gd/Gp = Sd Cr/T                   (3.6)
 *     D   Gd/Gp = - (u/d) (Cr/C)/T          (3.9, where the source has lost the minus sign: u = -C y)
 *
 * C and Cr are those of the controller, which is known; with setpoint weight 1 they are the same, as in the source. With a feedforward F
 * that runs meanwhile, d to y is (Gd + Gp F) S and d to u_fb is -C (Gd + Gp F) S, so all three give Gd/Gp + F, what is left to
 * correct, and F, which is known as well, is taken off (ours; the source switches it off). In D it has to be u_fb then, not u.
 *
 * sd of a point is the root of the mean square of its distance to the true one; those of two responses are independent here, as they
 * come from two records. */
#ifndef REFLUX_IDENTIFY_DISTURBANCE_RATIO_H
#define REFLUX_IDENTIFY_DISTURBANCE_RATIO_H

#include "identify/high_order.h"

/* The loop at a frequency. */
struct loop_response {
    struct cplx controller;  /* C: from -y to u */
    struct cplx reference;   /* Cr: from r to u */
    struct cplx feedforward; /* F; 0 where it was off */
};

/* A PI with setpoint weight b: C = gain (1 + q), Cr = gain (b + q), q = (h/ti)/(1 - z^-1), backward Euler; late: q z^-1 in its
 * place, as kinds/pid/pid.h integrates, where an error is in the integral one step behind the proportional part. ti 0: no integral action. gain: output per measurement, with its sign (above 0: a measurement below its setpoint raises the output). h, ti_s > 0
 * or ti_s = 0, s; omega_h: rad per sample, (0, pi]. */
void loop_response_of_pi(struct loop_response *l, real_t gain, real_t ti_s, real_t b, bool late,
                         real_t h_s, real_t omega_h);

/* All: ERR_SINGULAR where they would divide by 0; *ratio is not written then. */
MUST_CHECK enum err ratio_from_process(const struct high_order_point *process,
                                       const struct high_order_point *sensitivity,
                                       const struct loop_response *loop,
                                       struct high_order_point *ratio);
MUST_CHECK enum err ratio_from_tracking(const struct high_order_point *tracking,
                                        const struct high_order_point *sensitivity,
                                        const struct loop_response *loop,
                                        struct high_order_point *ratio);
MUST_CHECK enum err ratio_from_input(const struct high_order_point *tracking,
                                     const struct high_order_point *input_by_disturbance,
                                     const struct loop_response *loop,
                                     struct high_order_point *ratio);

/* Gp = T/(Cr - T C). Where T C comes near Cr (low frequencies under integral action) the difference tells little: sd says so. */
MUST_CHECK enum err process_from_tracking(const struct high_order_point *tracking,
                                          const struct loop_response *loop,
                                          struct high_order_point *process);
/* Sd without feedforward: (Gd/Gp) Gp/(1 + Gp C). sd as for independent ones. */
MUST_CHECK enum err sensitivity_from_ratio(const struct high_order_point *process,
                                           const struct high_order_point *ratio,
                                           const struct loop_response *loop,
                                           struct high_order_point *sensitivity);

#endif
