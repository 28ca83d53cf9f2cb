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
 * Source: Astrom and Hagglund, "Advanced PID Control" (2006), ch. 3; the inhibitor is ours (docs/pid.md).
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

/* The widest output limits: for a block whose output something downstream limits. */
#define PID_OUTPUT_MAX 127.0f

enum pid_action { PID_REVERSE = 0, PID_DIRECT = 1 };
enum pid_form { PID_POSITIONAL = 0, PID_VELOCITY = 1 };

struct pid_config {
    float gain; /* K, fraction of output span per fraction of measurement span, [1e-6, 100] */
    float ti_s; /* integral time, s; 0 = no integral action; else [0.01, 1e6] */
    float td_s; /* derivative time, s, [0, 1e5]; 0 = none */
    float n;    /* derivative filter ratio N, [1, 100]: filter time Td/N */
    float b;    /* setpoint weight of the proportional part, [0, 1] */
    float c;    /* setpoint weight of the derivative part, [0, 1] */
    float tt_s; /* tracking time constant, s, [0.01, 1e6]; 0 = automatic: Ti without derivative,
                 * sqrt(Ti Td) with; unused without integral action: there is nothing to wind up */
    float out_lo,
        out_hi;       /* output limits, fraction, -PID_OUTPUT_MAX <= lo < hi <= PID_OUTPUT_MAX */
    float rate_per_s; /* fastest change of the output, 1/s, [1e-9, 1e6]; 0 = no limit */
    float inhibit_s;  /* overshoot inhibitor: prediction time, s, [0, 1e5]; 0 = off */
    enum pid_action action;
    enum pid_form form;
};

/* The settings most people want: gain 1, no integral, b = 1, c = 0, N = 8, output 0..1. */
struct pid_config pid_default_config(void);

/* First field that is wrong, or ERR_OK. *field gets its name, *wanted the range in words (either may be
 * NULL). NaN and infinity anywhere are ERR_NOT_FINITE, all else is ERR_RANGE. */
MUST_CHECK enum err pid_validate(const struct pid_config *config, const char **field,
                                 const char **wanted);

/* Contents are the controller's own; listed here so that it can be placed statically. */
struct pid {
    enum pid_action action;
    enum pid_form form;
    bool derives, inhibits;    /* td_s, inhibit_s above 0 */
    float derivative_filter_s; /* Td/N, of the last derivative there was */
    num_t b, c, lo, hi;
    struct coefficient gain;     /* s K */
    struct coefficient integral; /* s K h / Ti, 0 without integral action */
    struct coefficient tracking; /* h / Tt, at most 1 */
    struct accumulator sum;      /* integral part or bias (positional), whole output (velocity) */
    struct washout derivative;   /* s K Td s/(Td/N s + 1) on c r - y */
    struct washout prediction;   /* Tp s/(Tp/8 s + 1) on y: the change expected within Tp */
    struct ramp rate;            /* last output, and the rate limit */
    num_t proportional_in;       /* b r - y of the last step */
    num_t last_r, last_y;        /* inputs of the last step */
    num_t error, raw, output; /* of the last step: error, output before limits, output in effect */
    bool primed;              /* a step or follow has filled the fields above */
    bool inhibited;           /* the inhibitor held the integral in the last step */
};

/* Places a controller with step interval h_s (s, [0.001, 1e5]). State is cleared: call follow before step.
 * Errors as pid_validate, and for h_s likewise. On error *pid is unchanged. */
MUST_CHECK enum err pid_init(struct pid *pid, const struct pid_config *config, float h_s);

/* New settings without a bump. Between a step and its back-calculation: the output of that step is the old settings', all after it
 * the new ones'. Between a back-calculation and the next step: that step gives, for unchanged inputs, what the old settings would
 * have given, but for what the derivative's transient dies away differently. Integration under way is kept, so retuning
 * every tick does not stop it. A transient of the derivative is kept as it is and dies away with the new filter, with
 * the old one where the new settings have no derivative; never does it become part of the integral. Errors as pid_init;
 * on error *pid is unchanged. */
MUST_CHECK enum err pid_retune(struct pid *pid, const struct pid_config *config, float h_s);

/* Output for this setpoint and measurement, within the output and rate limits. */
num_t pid_step(struct pid *pid, num_t setpoint, num_t measurement);

/* applied: the output that took effect. clamp: enum integral_clamp, directions of the output in which
 * the integral may not move. */
void pid_back_calculate(struct pid *pid, num_t applied, uint8_t clamp);

/* Sets the state so that the next step with the same inputs gives applied. The derivative starts from
 * rest. */
void pid_follow(struct pid *pid, num_t setpoint, num_t measurement, num_t applied);

/* For a block that acts and whose output gets another meaning (another decoupler, another feedforward): the next step
 * gives `applied` and what has changed since the last one. Derivative and integration under way go on; what the output
 * was beyond a limit is forgotten. Call before a step. */
void pid_shift(struct pid *pid, num_t applied);

#endif
