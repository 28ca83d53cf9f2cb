/* PID controller, ISA form with two degrees of freedom, on fractions of span.
 *
 *     error e = setpoint - measurement                  (not the other way round)
 *     u = s K [ (b r - y) + (1/Ti) integral e dt + Td d(c r - y)/dt ]
 *     s = +1 reverse acting (heating: measurement below setpoint raises the output), -1 direct acting
 *
 * The derivative acts through a first-order filter Td/N on (c r - y); filtering of the measurement itself
 * belongs to the channel. Integral: rectangular, on a wide accumulator (num/accumulator.h), so it does not
 * stall at 0.05 s ticks with hour-long integral times. Anti-windup by tracking: the integral is driven with
 * time constant Tt by (applied - computed), where applied comes back from the whole output chain.
 * Source: Astrom and Hagglund, "Advanced PID Control" (2006), ch. 3; the inhibitor is ours (docs/methods/pid.md).
 *
 * Order of calls: init, follow, then step and back_calculate in turn; follow again whenever the block does not act.
 * The integral takes the error of a step in the back-calculation that closes it, so the step after follow, with the same
 * inputs, gives exactly the output followed. An output that starts outside its limits (manual, new limits)
 * enters them at the rate limit, at once if there is none.
 */
#ifndef REFLUX_SIGNAL_PID_H
#define REFLUX_SIGNAL_PID_H

#include <stdbool.h>

#include "base/error.h"
#include "num/accumulator.h"
#include "signal/integral_clamp.h"
#include "signal/ramp.h"
#include "signal/washout.h"

/* The widest output limits: for a controller whose output is limited downstream. */
#define PID_OUTPUT_MAX 127.0f

enum pid_action { PID_REVERSE = 0, PID_DIRECT = 1 };
enum pid_form { PID_POSITIONAL = 0, PID_VELOCITY = 1 };

struct pid_config {
    /* K, fraction of output span per fraction of measurement span, [1e-6, 100] */
    float gain;
    /* Integral time, s; 0 = no integral action; else [0.01, 1e6] */
    float ti_s;
    /* Derivative time, s, [0, 1e5]; 0 = none */
    float td_s;
    /* Derivative filter ratio N, [1, 100]: filter time Td/N */
    float n;
    /* Setpoint weights of the proportional and of the derivative part, [0, 1] */
    float b, c;
    /* Tracking time constant, s, [0.01, 1e6]; 0 = automatic: Ti without derivative, sqrt(Ti Td) with; unused without integral action,
     * because nothing winds up. */
    float tt_s;
    /* Output limits, fraction, -PID_OUTPUT_MAX <= lo < hi <= PID_OUTPUT_MAX */
    float out_lo, out_hi;
    /* Fastest change of the output, 1/s, [1e-9, 1e6]; 0 = no limit */
    float rate_per_s;
    /* Overshoot inhibitor: prediction time, s, [0, 1e5]; 0 = off */
    float inhibit_s;
    enum pid_action action;
    enum pid_form form;
};

/* The settings most people want: gain 1, no integral, b = 1, c = 0, N = 8, output 0..1. */
struct pid_config pid_default_config(void);

/* Checks settings. *field gets the name of the first field that is wrong, *wanted its range in words (either may be
 * NULL). NaN and infinity anywhere are ERR_NOT_FINITE, all else is ERR_RANGE. */
MUST_CHECK enum err pid_validate(const struct pid_config *config, const char **field,
                                 const char **wanted);

/* The fields are private to the controller; the struct is defined here so that callers can hold one. */
struct pid {
    enum pid_action action;
    enum pid_form form;
    /* td_s, inhibit_s above 0 */
    bool derives, inhibits;
    /* Td/N, of the last settings with a derivative. */
    float derivative_filter_s;
    num_t b, c, lo, hi;
    /* s K */
    struct coefficient gain;
    /* s K h / Ti, 0 without integral action */
    struct coefficient integral;
    /* h / Tt, at most 1 */
    struct coefficient tracking;
    /* Integral part or bias (positional), whole output (velocity). */
    struct accumulator sum;
    /* s K Td s/(Td/N s + 1) on c r - y */
    struct washout derivative;
    /* Tp s/(Tp/8 s + 1) on y: the change expected within Tp */
    struct washout prediction;
    /* Last output, and the rate limit. */
    struct ramp rate;
    /* b r - y of the last step */
    num_t proportional_in;
    /* Inputs of the last step. */
    num_t last_r, last_y;
    /* Error, output before limits and output in effect of the last step. */
    num_t error, raw, output;
    /* A step or follow has filled the fields above. */
    bool primed;
    /* The inhibitor held the integral in the last step. */
    bool inhibited;
};

/* Places a controller with step interval h_s (s, [0.001, 1e5]). State is cleared: call follow before step.
 * Errors as pid_validate, and for h_s likewise. On error *pid is unchanged. */
MUST_CHECK enum err pid_init(struct pid *pid, const struct pid_config *config, float h_s);

/* Takes new settings without a bump. Between a step and its back-calculation: the output of that step comes from the old settings, every
 * later one from the new settings. Between a back-calculation and the next step: for unchanged inputs that step gives the output that
 * the old settings would have given, except that the derivative's transient decays differently. The integral keeps its value, so retuning
 * every tick does not stop it. A transient of the derivative is kept and decays with the new filter, with
 * the old one where the new settings have no derivative; it never becomes part of the integral. Errors as pid_init;
 * on error *pid is unchanged. */
MUST_CHECK enum err pid_retune(struct pid *pid, const struct pid_config *config, float h_s);

/* Output for this setpoint and measurement, within the output and rate limits. */
num_t pid_step(struct pid *pid, num_t setpoint, num_t measurement);

/* Takes back the output that took effect, `applied`. clamp: enum integral_clamp, directions of the output in which
 * the integral may not move. */
void pid_back_calculate(struct pid *pid, num_t applied, uint8_t clamp);

/* Sets the state so that the next step with the same inputs gives applied. The derivative starts from
 * rest. */
void pid_follow(struct pid *pid, num_t setpoint, num_t measurement, num_t applied);

/* Shifts the output of a controller that acts, because its output gets another meaning (another decoupler, another feedforward): the next
 * step gives `applied` plus the change since the last one. Derivative and integral go on; the part of the output beyond a limit is
 * forgotten. Call before a step. */
void pid_shift(struct pid *pid, num_t applied);

#endif
