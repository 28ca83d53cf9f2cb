/* Reasons why start-up ended, a trial failed or nothing may begin, and their texts. Tick and main loop. */
#ifndef REFLUX_COMMISSION_REASONS_H
#define REFLUX_COMMISSION_REASONS_H

/* The numbers are the details of events. */
enum commission_reason {
    REASON_NOT,
    REASON_ASKED,
    REASON_SAFE,
    REASON_LOST,
    REASON_INTERLOCK,
    REASON_ACTUATOR,
    REASON_HAND,
    REASON_CONFIG,
    REASON_RESTLESS,
    REASON_LIMIT,
    REASON_AWAY,
    REASON_INTEGRATES,
    REASON_NO_INPUT,
    REASON_NUMBERS, /* the analysis refused the model: a fault of the firmware */
    REASON_SAMPLES,
    REASON_RESET,
    REASON_TRIAL_LIMIT,
    REASON_TRIAL_SLOW,
    REASON_TRIAL_PEAK,
    REASON_TRIAL_REST,
    REASON_SEQUENCE,
    REASON_NO_ANSWER,
    REASON_NO_CYCLE,
    REASON_TRIAL_ROOM,
    REASON_LEFT,
    REASON_SPAN,
    REASON_REVERSAL,
    REASON_TOO_SLOW,
    REASON_TRIAL_SWINGS,
    REASON_EXCITED,
    REASON_ACTION,
    REASON_TRIAL_MARGIN,
    REASON_WATCH_LIMIT,
    REASON_WATCH_SWINGS,
    REASON_WATCH_STUCK,
    REASON_WATCH_MANUAL,
    REASON_COUNT
};

const char *commission_reason_text(enum commission_reason reason);

#endif
