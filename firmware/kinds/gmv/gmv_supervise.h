/* Supervision of a self-tuner: who computes the MVs, when the estimator may learn, when its parameters may be used, and when
 * they may no longer be. Ours (docs/methods/self-tuning.md, Supervision). It works on numbers alone: it knows no block and no plant.
 *
 * In each step: gmv_supervise_look (before the regressions: which loops may learn)  ->  gmv_supervise_judge (after them: who
 * computes from then on). */
#ifndef REFLUX_GMV_GMV_SUPERVISE_H
#define REFLUX_GMV_GMV_SUPERVISE_H

#include <stdint.h>

#include "kinds/gmv/gmv_watched.h"

struct gmv_record;
struct gmv_supervise;

enum gmv_state { GMV_TUNING, GMV_WAITING, GMV_SELF_TUNING };

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

#define GMV_TRIES_MOST 8

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
uint8_t gmv_supervise_look(struct gmv_supervise *s, const struct gmv_observation *seen);
/* Returns enum gmv_wish. */
uint8_t gmv_supervise_judge(struct gmv_supervise *s, const struct gmv_observation *seen,
                            const struct gmv_result *result);
/* Takes the answer to the proposal, in waiting. Returns enum gmv_wish. */
uint8_t gmv_supervise_accepted(struct gmv_supervise *s, bool accepted);

/* The operator's verb: adopts the estimated parameters untested. */
void gmv_supervise_adopt(struct gmv_supervise *s);

#endif
