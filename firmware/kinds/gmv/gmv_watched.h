/* Values that supervision works on: its settings, and the measurements and results of a step. */
#ifndef REFLUX_GMV_GMV_WATCHED_H
#define REFLUX_GMV_GMV_WATCHED_H

#include <stdint.h>

#include "kinds/gmv/gmv_outcome.h"
#include "kinds/gmv/gmv_shape.h"

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

/* Why self-tuning went back to the PI: bits of gmv_status.alarms. */
enum gmv_alarm {
    GMV_NO_ALARM = 0,
    GMV_ALARM_SIGN = 1,
    GMV_ALARM_POLES = 2,
    GMV_ALARM_WORSE = 4,
    GMV_ALARM_BURST = 8,
    /* The PI has done better. */
    GMV_ALARM_RECORD = 16
};

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
struct gmv_observation {
    /* A bit for each loop: it acts; all of its readings are good. */
    uint8_t acting, good;
    /* w; the last move of the applied MV. */
    float setpoint[GMV_LOOPS], move[GMV_LOOPS];
    /* w - y */
    float control_error[GMV_LOOPS];
    /* Move that the law asked for last and the MV did not make. */
    float shortfall[GMV_LOOPS];
};

/* Results of the regressions of a step. */
struct gmv_result {
    /* A bit for each loop: it has errors of this step. */
    uint8_t complete;
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
    bool trial_done;
    struct gmv_outcome outcome;
};

#endif
