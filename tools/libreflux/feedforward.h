/* Identification for a feedforward and its tuning (firmware/identify/high_order.h, signal/lag.h, kinds/ff_tune/feedforward_search.h) in the
 * arithmetic of a board: real_t is float, num_t float or, in the build host-fixed, Q7.24. Library libreflux_board; rules as in libreflux.h. */
#ifndef REFLUX_LIBREFLUX_FEEDFORWARD_H
#define REFLUX_LIBREFLUX_FEEDFORWARD_H

#include <stdint.h>

/* shape: na, inputs, then nb and delay of each input. settings: factor by which signals are taken (they have to stay within 2), time
 * constant of the two lags in series that filter all of them (s, 0: none), sampling period (s), forgetting factor, p0. y [samples], u
 * [samples x inputs]. Nothing is learnt before sample `first`. what: input whose response is wanted, -1: that of input 1 over input 0.
 * omega_h [points], rad per sample. out: real part, imaginary part and standard deviation, point by point, at the end. */
int32_t reflux_high_order(const int32_t *shape, const double *settings, int32_t samples,
                          const double *y, const double *u, int32_t first, int32_t what,
                          int32_t points, const double *omega_h, double *out, char *reason);

/* settings: h (s), most of the first jump, largest lag and largest dead time (s). omega (rad/s), weight [points], ratio [2 points].
 * found: K, lead, lag, dead time (s), J, J of K = 0, pieces of work. */
int32_t reflux_feedforward_search(int32_t points, const double *omega, const double *weight,
                                  const double *ratio, const double *settings, double *found);

/* First-order models with dead time of both paths, fitted to their responses [2 points] (rad/s), and F. G. Shinskey's settings from them
 * (firmware/design/feedforward_rules.h). settings: largest dead time (s), difference below which dead times and time constants are the
 * same. models: gain, dead time, time constant (s) and error of the process, then of the disturbance. rule: K, lead, lag. */
int32_t reflux_shinskey(int32_t points, const double *omega, const double *process,
                        const double *disturbance, const double *settings, double *models,
                        double *rule);

/* Largest error and root of the sum of squares: out has dB, degrees, dB, degrees. */
int32_t reflux_feedforward_misses(int32_t points, const double *db, const double *degrees,
                                  double *out);

#endif
