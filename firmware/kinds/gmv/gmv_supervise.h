/* Supervision of a self-tuner: who computes the MVs, when the estimator may learn, when its parameters may be used, and when
 * they may no longer be. Ours (docs/self-tuning.md, Supervision). It works on numbers alone: it knows no block and no plant.
 *
 * In each step: gmv_supervise_look (before the regressions: which loops may learn)  ->  gmv_supervise_judge (after them: who
 * computes from then on). */
#ifndef REFLUX_GMV_GMV_SUPERVISE_H
#define REFLUX_GMV_GMV_SUPERVISE_H

#include <stdint.h>

#include "kinds/gmv/gmv_outcome.h"
#include "kinds/gmv/gmv_shape.h"

struct gmv_record;
struct gmv_supervise;

enum gmv_state { GMV_TUNING, GMV_WAITING, GMV_SELF_TUNING };

/* Why a loop does not learn; the last that applies. */
enum gmv_rest {
    GMV_LEARNS,
    /* The operator has frozen it. */
    GMV_RESTS_ASKED,
    /* Samples carry no information. */
    GMV_RESTS_QUIET,
    /* Its MV has not moved for longer than the regressors reach back. */
    GMV_RESTS_STILL,
    /* A bad reading is among the regressors. */
    GMV_RESTS_READING,
    GMV_RESTS_MANUAL
};

/* Why a model was not adopted. */
enum gmv_refusal {
    GMV_ADOPTED,
    /* It predicts no better than a standstill. */
    GMV_REFUSED_PREDICTION,
    /* Sign or size of g_ii,0. */
    GMV_REFUSED_GAIN,
    GMV_REFUSED_POLES,
    /* The proposal was rejected or refused. */
    GMV_REFUSED_BY_HAND,
    /* On the model the PI does as well. */
    GMV_REFUSED_PI
};

/* Why self-tuning went back to the PI: bits of gmv_status.alarms. */
enum gmv_alarm {
    GMV_ALARM_SIGN = 1,
    GMV_ALARM_POLES = 2,
    GMV_ALARM_WORSE = 4,
    GMV_ALARM_BURST = 8,
    /* The PI has done better. */
    GMV_ALARM_RECORD = 16
};

#define GMV_TRIES_MOST 8

struct gmv_supervise_config {
    bool on, ask;
    uint8_t loops;
    /* Number of returns to the PI within a day: the last one gives up for good; 0: none does. */
    uint8_t tries;
    uint32_t tune_steps, check_steps, day_steps;
    /* Steps that the regressors reach back. */
    uint32_t reach;
    float excite, gain_least, quiet, burst, better;
    /* g_ii,0 must be negative. */
    bool negative[GMV_LOOPS];
};

/* Measurements and moves of a step, one entry for each loop. */
struct gmv_seen {
    /* A bit for each loop: it acts; all of its readings are good. */
    uint8_t acting, good;
    /* w; the last move of the applied MV. */
    float setpoint[GMV_LOOPS], moved[GMV_LOOPS];
    /* w - y */
    float away[GMV_LOOPS];
    /* Move that the law asked for last and the MV did not make. */
    float lacked[GMV_LOOPS];
};

/* Results of the regressions of a step. */
struct gmv_result {
    /* A bit for each loop: it has errors of this step. */
    uint8_t whole;
    /* Prediction errors of the parameters in use and of a standstill. */
    float error[GMV_LOOPS], standstill[GMV_LOOPS];
    /* Information of the sample, and v of its forgetting. */
    float information[GMV_LOOPS], forgetting[GMV_LOOPS];
    uint8_t parameters[GMV_LOOPS];
    /* g_ii,0 of the law, and as it is estimated. */
    float gain[GMV_LOOPS], estimated[GMV_LOOPS];
    /* A bit for each loop: its parameters are known well enough. */
    uint8_t excited;
    /* The trial that was asked for is over, with this outcome. */
    bool tried;
    struct gmv_outcome outcome;
};

/* State of supervision as others may see it. */
struct gmv_status {
    /* enum gmv_state */
    uint8_t state;
    /* In tuning: the trial of the parameters in use is running. */
    bool testing;
    /* enum gmv_refusal of the last test. */
    uint8_t refusal;
    /* enum gmv_alarm; until the law computes again. */
    uint8_t alarms;
    /* enum gmv_rest */
    uint8_t rest[GMV_LOOPS];
    /* Value that raised the alarm. */
    float alarm_value;
    /* Outcome of the last trial. */
    struct gmv_outcome outcome;
    /* Mean information of a sample. */
    float information[GMV_LOOPS];
};

/* Requests of gmv_supervise_judge: bits. */
enum gmv_wish {
    /* Put the estimated parameters in use, and begin a trial. */
    GMV_WISH_CANDIDATE = 1,
    /* Begin a trial of those in use. */
    GMV_WISH_TRIAL = 2,
    /* Propose those in use. */
    GMV_WISH_PROPOSE = 4,
    /* Start the estimator again from the parameters adopted last. */
    GMV_WISH_FORGET = 8,
    /* The law computes from this step on. */
    GMV_WISH_LAW = 16,
    /* The PI computes from this step on. */
    GMV_WISH_PI = 32,
    /* Give up for good. */
    GMV_WISH_GIVE_UP = 64,
    /* Report that a model was not adopted: gmv_status.refusal. */
    GMV_WISH_REFUSED = 128
};

/* Starts in tuning. */
void gmv_supervise_init(struct gmv_supervise *s, const struct gmv_supervise_config *c);
void gmv_supervise_retune(struct gmv_supervise *s, const struct gmv_supervise_config *c);
/* Goes back to tuning, without an alarm. */
void gmv_supervise_begin(struct gmv_supervise *s);

/* Returns the loops that may learn from this step, a bit each. */
uint8_t gmv_supervise_look(struct gmv_supervise *s, const struct gmv_seen *seen);
/* Returns whether loop i's g_ii,0 may have this value: its sign, and not too small. */
bool gmv_supervise_gain(const struct gmv_supervise *s, unsigned i, float gain);
/* Returns enum gmv_wish. */
uint8_t gmv_supervise_judge(struct gmv_supervise *s, const struct gmv_seen *seen,
                            const struct gmv_result *result);
/* Takes the answer to the proposal, in waiting. Returns enum gmv_wish. */
uint8_t gmv_supervise_accepted(struct gmv_supervise *s, bool accepted);

/* The operator's verbs: thaw learning; adopt the estimated parameters untested. */
void gmv_supervise_thaw(struct gmv_supervise *s);
void gmv_supervise_adopt(struct gmv_supervise *s);

#endif
