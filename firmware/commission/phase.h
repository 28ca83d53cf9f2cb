/* Phases of start-up, requests to it, and its tasks for the main loop. */
#ifndef REFLUX_COMMISSION_PHASE_H
#define REFLUX_COMMISSION_PHASE_H

enum commission_phase {
    COMMISSION_IDLE,
    COMMISSION_TESTING,
    COMMISSION_RELAY, /* a relay test of one loop: by_relay.h */
    COMMISSION_FITTING,
    COMMISSION_ANALYSING,
    COMMISSION_PAUSED,
    COMMISSION_READY, /* analysed: there is a proposal, or a reason why there is none */
    COMMISSION_TRIAL, /* the accepted settings are in force, and the trial runs */
    COMMISSION_KEPT,
    COMMISSION_RETURNED, /* the old settings are, or soon will be, back in force */
    COMMISSION_ENDED,    /* before its end, for a reason */
    COMMISSION_WATCHING  /* kept, and the loops are watched */
};

enum commission_ask {
    COMMISSION_ASK_NONE,
    COMMISSION_ASK_BEGIN,
    COMMISSION_ASK_RELAY,
    COMMISSION_ASK_PAUSE,
    COMMISSION_ASK_RESUME,
    COMMISSION_ASK_SKIP,
    COMMISSION_ASK_REPEAT,
    COMMISSION_ASK_ABORT,
    COMMISSION_ASK_TRIAL, /* a plan with the proposal is on its way */
    COMMISSION_ASK_REJECT,
    COMMISSION_ASK_WATCH
};

enum background_task { TASK_INTERIM_FIT, TASK_FIT, TASK_ANALYSIS };

#endif
