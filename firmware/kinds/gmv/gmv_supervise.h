/* Supervision of a self-tuner: who computes the MVs, when the estimator may learn, when its parameters may be used, and when
 * they may no longer be. Ours (docs/self-tuning.md, Supervision). Numbers only: it knows no block and no plant.
 *
 * In each step: gmv_supervise_look (before the regressions: which loops may learn)  ->  gmv_supervise_judge (after them: who
 * computes from now on). */
#ifndef REFLUX_GMV_GMV_SUPERVISE_H
#define REFLUX_GMV_GMV_SUPERVISE_H

#include "kinds/gmv/gmv_burst.h"
#include "kinds/gmv/gmv_cycle.h"
#include "kinds/gmv/gmv_outcome.h"
#include "kinds/gmv/gmv_record.h"

enum gmv_state { GMV_TUNING, GMV_WAITING, GMV_SELF_TUNING };

/* Why a loop does not learn; the last that applies. */
enum gmv_rest {
    GMV_LEARNS,
    GMV_RESTS_ASKED,   /* by the verb */
    GMV_RESTS_QUIET,   /* samples tell nothing */
    GMV_RESTS_STILL,   /* its MV has not moved for longer than the regressors reach */
    GMV_RESTS_READING, /* one that is not good is among the data */
    GMV_RESTS_MANUAL
};

/* Why a model was not adopted. */
enum gmv_refusal {
    GMV_ADOPTED,
    GMV_REFUSED_PREDICTION, /* it predicts no better than "as it is" */
    GMV_REFUSED_GAIN,       /* sign or size of g_ii,0 */
    GMV_REFUSED_POLES,
    GMV_REFUSED_BY_HAND, /* the proposal was rejected or refused */
    GMV_REFUSED_PI       /* on the model the PI does as well */
};

/* Why self-tuning was given up softly: bits of gmv_supervise.alarms. */
enum gmv_alarm {
    GMV_ALARM_SIGN = 1,
    GMV_ALARM_POLES = 2,
    GMV_ALARM_WORSE = 4,
    GMV_ALARM_BURST = 8,
    GMV_ALARM_RECORD = 16 /* the PI has done better */
};

#define GMV_TRIES_MOST 8

struct gmv_supervise_config {
    bool on, ask;
    uint8_t loops;
    uint8_t tries; /* within a day: the last gives up for good; 0: none does */
    uint32_t tune_steps, check_steps, day_steps;
    uint32_t reach; /* steps, of the regressors */
    float excite, gain_least, quiet, burst, better;
    bool negative[GMV_LOOPS]; /* the sign that g_ii,0 must have */
};

/* What a step has seen, one entry for each loop. */
struct gmv_seen {
    uint8_t acting;                              /* a bit for each loop */
    uint8_t good;                                /* the same: all its readings are */
    float setpoint[GMV_LOOPS], moved[GMV_LOOPS]; /* w; the last move of what was applied */
    float away[GMV_LOOPS];                       /* w - y */
    float lacked[GMV_LOOPS]; /* what the law asked for last and the MV did not do */
};

/* What the regressions of a step came to. */
struct gmv_came {
    uint8_t whole; /* bit for each loop: there are errors of this step */
    float error[GMV_LOOPS], standstill[GMV_LOOPS]; /* of the parameters in use; of "as it is" */
    float told[GMV_LOOPS], forgot[GMV_LOOPS];
    uint8_t parameters[GMV_LOOPS];
    float gain[GMV_LOOPS];      /* g_ii,0 of the law */
    float estimated[GMV_LOOPS]; /* as it is estimated */
    uint8_t excited;            /* bit for each loop: its parameters are known well enough */
    bool tried;                 /* the trial that was asked for is over */
    struct gmv_outcome outcome; /* and what it came to */
};

struct gmv_supervise {
    struct gmv_supervise_config config;
    uint8_t state;             /* enum gmv_state */
    bool testing;              /* in tuning: the parameters in use are on trial */
    bool asked_to_rest;        /* by the verb */
    bool adopt_now;            /* by the verb */
    uint8_t tested;            /* loops whose models have passed */
    uint8_t rest[GMV_LOOPS];   /* enum gmv_rest */
    uint8_t refusal;           /* enum gmv_refusal, of the last test */
    uint8_t alarms;            /* enum gmv_alarm; until the law computes again */
    float alarm_value;         /* what was looked at */
    uint32_t elapsed;          /* steps in this state */
    uint32_t wrong[GMV_LOOPS]; /* steps for which the g_ii,0 estimated has been none */
    uint32_t still[GMV_LOOPS],
        spoilt[GMV_LOOPS]; /* steps without a move; still to go until the data is good */
    /* The window of a test or a check. */
    uint32_t left,
        overtime; /* steps still to go; steps for which a test has waited for setpoints to rest */
    bool has_outcome;
    struct gmv_outcome outcome; /* of the last trial */
    uint32_t samples[GMV_LOOPS];
    float of_model[GMV_LOOPS], of_standstill[GMV_LOOPS]; /* sums of squares */
    float told[GMV_LOOPS];                               /* mean of what a sample tells */
    bool is_quiet[GMV_LOOPS];
    struct gmv_burst burst[GMV_LOOPS];
    struct gmv_cycle cycle[GMV_LOOPS];
    struct gmv_record record[GMV_LOOPS];
    uint32_t jammed
        [GMV_LOOPS]; /* steps that an MV has been pushed against a limit away from where its loop needs it */
    uint32_t steps, given_up_at[GMV_TRIES_MOST];
    uint8_t given_up; /* how many of these there are */
};

/* What gmv_supervise_judge asks for: bits. */
enum gmv_wish {
    GMV_WISH_CANDIDATE = 1, /* the parameters estimated are put in use, and a trial begins */
    GMV_WISH_TRIAL = 2,     /* a trial of those in use begins */
    GMV_WISH_PROPOSE = 4,   /* those in use are proposed */
    GMV_WISH_FORGET = 8,    /* the estimator begins anew, from the parameters adopted last */
    GMV_WISH_LAW = 16,      /* the law computes from now on */
    GMV_WISH_PI = 32,       /* the PI does */
    GMV_WISH_GIVE_UP = 64,  /* for good */
    GMV_WISH_REFUSED = 128  /* a model was not adopted: .refusal */
};

/* Anew, in tuning. */
void gmv_supervise_init(struct gmv_supervise *s, const struct gmv_supervise_config *c);
void gmv_supervise_retune(struct gmv_supervise *s, const struct gmv_supervise_config *c);
/* Back to tuning, without an alarm. */
void gmv_supervise_begin(struct gmv_supervise *s);

/* Which loops may learn from this step: bits. */
uint8_t gmv_supervise_look(struct gmv_supervise *s, const struct gmv_seen *seen);
/* Whether that may be loop i's g_ii,0: its sign, and not too small. */
bool gmv_supervise_gain(const struct gmv_supervise *s, unsigned i, float gain);
/* Returns enum gmv_wish. */
uint8_t gmv_supervise_judge(struct gmv_supervise *s, const struct gmv_seen *seen,
                            const struct gmv_came *came);
/* In waiting: what became of the proposal. Returns enum gmv_wish. */
uint8_t gmv_supervise_accepted(struct gmv_supervise *s, bool accepted);

#endif
