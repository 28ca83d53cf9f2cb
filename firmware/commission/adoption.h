/* An accepted set of loops on trial, on the plant: every loop's setpoint is stepped once, and what it does is held against
 * what was predicted.
 *
 *     rest -> settle -> step -> return -> step (next loop) ... -> passed
 *       ^                |                                            of a plant that stays where it is
 *       |                +-> rest -> settle -> step (next loop) ... -> passed
 *       +--- not as predicted: was it the plant?                      of one that drifts
 *
 * At rest the outputs are held in manual and a line is fitted to every measurement. A drift that is significant is taken off
 * as in the tests: the setpoints go with it, and limits count from its line or from where it began, whichever is nearer; what the tests have left comes off them. No
 * controller can hold a measurement that goes on drifting for ever on the room of its output; and an ill-conditioned plant
 * needs all of it soon. */
#ifndef REFLUX_COMMISSION_ADOPTION_H
#define REFLUX_COMMISSION_ADOPTION_H

#include "commission/origin.h"
#include "commission/swing.h"
#include "design/trial.h"
#include "identify/steady.h"
#include "supervise/supervisor.h"

/* How much worse than predicted is accepted. */
#define ADOPTION_IAE      REAL_C(2.5)  /* times the predicted integral of the error */
#define ADOPTION_PEAK     REAL_C(0.35) /* of the step, past the predicted overshoot */
#define ADOPTION_DURATION REAL_C(1.5)  /* times the predicted settling time, at most */
#define ADOPTION_REPEATS  2u           /* of steps that the plant itself has spoilt */

/* A measurement; that of loop k is the k-th, and after those come the ones that no loop holds. */
struct adoption_channel {
    uint8_t measurement; /* index in the configuration */
    uint8_t output;      /* ... and in the tests */
    real_t noise_sd;     /* fraction of span */
    real_t limit;        /* farthest from the operating point, fraction of span */
    /* At rest, while the outputs were held: the line at the end of it. */
    real_t rest, rest_sd, slope_per_s, slope_sd_per_s;
    bool drifts; /* significantly, and so much that it matters */
};

struct adoption_loop {
    uint8_t loop;                /* index in the plan */
    uint8_t output;              /* that it moves, itself or through others; in the configuration */
    real_t step;                 /* of its setpoint, fraction of span, either sign */
    real_t duration_s;           /* of its step */
    struct trial_loop predicted; /* per unit of `size`; iae until duration_s */
    real_t left; /* mean error predicted for the last quarter, in the step's direction, likewise */
    real_t size; /* step of the prediction */
    real_t iae, peak; /* as found; peak in units of the step */
    real_t test_base; /* output before the trial, fraction of span */
};

enum adoption_result {
    ADOPTION_RUNNING,
    ADOPTION_PASSED,
    ADOPTION_PAST_LIMIT,
    ADOPTION_SLOW,
    ADOPTION_OVERSHOOT,
    ADOPTION_RESTLESS,
    ADOPTION_SWINGS,  /* half cycles of the error that do not decay */
    ADOPTION_BLOCKED, /* an output stood at its limit */
    ADOPTION_LEFT,    /* at rest too far from the operating point */
    ADOPTION_HAND /* a loop did not go to automatic, or somebody moved a mode, a setpoint or an output */
};

struct adoption {
    uint8_t n, at;   /* loops; the one under trial */
    uint8_t n_inner; /* behind them in loop[]: inner loops, which have no setpoint to step */
    uint8_t channels;
    uint32_t window,
        back; /* samples: over which rest is judged, and that a response takes to be over */
    struct adoption_channel channel[CHANNEL_MAX];
    struct adoption_loop loop[CONFIG_LOOPS]; /* of inner ones only `loop` and `held` */
    enum adoption_result result;
    uint8_t culprit; /* in channel[] */
    uint8_t stage, repeats, patience;
    enum adoption_result doubt;         /* what the step before the rest came to */
    bool drifting;                      /* something has drifted: rest between any two steps */
    bool placed;                        /* setpoints */
    uint32_t ticks, stage_ticks, since; /* since: the lines were fitted */
    real_t asked[CONFIG_LOOPS];         /* setpoints, as written */
    real_t error_sum;
    uint32_t error_n;
    struct swing swing;             /* of the loop under trial */
    uint32_t blocked[CONFIG_LOOPS]; /* samples of the step at a limit of the output */
    struct steady *steady;          /* work */
    struct origin *origin;          /* the operating point */
};

/* Remembers where the outputs are. n, n_inner and loop[].loop are filled in. */
void adoption_hold(struct adoption *a, const struct supervisor *s);
/* origin, n, n_inner, channels, window, back, channel[] as far as `limit` and loop[] as far as `size` are filled in; *work must live as
 * long. The loops are in manual and stay there until the lines of rest are known. ERR_RANGE: channels or window. */
MUST_CHECK enum err adoption_begin(struct adoption *a, const struct supervisor *s,
                                   struct steady *work);
/* A tick of it, after validate and before control. */
enum adoption_result adoption_tick(struct adoption *a, struct supervisor *s);
/* The loops go to manual, their outputs to where the trial found them. but_hand: those that somebody has taken to manual
 * stay as they are. */
void adoption_put_back(const struct adoption *a, struct supervisor *s, bool but_hand);

#endif
