/* The numbers that a block of the kind `ff_tune` shows as its `stage` and its `verdict`. */
#ifndef REFLUX_FF_TUNE_TUNE_STAGE_H
#define REFLUX_FF_TUNE_TUNE_STAGE_H

enum tune_stage {
    TUNE_IDLE,
    /* waits until the feedforward is off */
    TUNE_SILENCES,
    /* identifies the loop: B, C, D */
    TUNE_LOOP,
    /* identifies the disturbance; A: both */
    TUNE_DISTURBANCE,
    TUNE_COMPUTES,
    /* the candidate runs in the shadow, on fresh data */
    TUNE_TESTS,
    TUNE_PROPOSES,
    /* watches the element; with `every` it goes on learning */
    TUNE_RUNS
};

/* The reason why it does not tune, or the fate of what it found. */
enum tune_verdict {
    TUNE_NONE,
    TUNE_ADOPTED,
    /* the disturbance does not move */
    TUNE_STILL,
    /* nothing moves the loop: no test signal, no setpoints */
    TUNE_LOOP_STILL,
    /* the responses have not settled in twice the time */
    TUNE_SLOW,
    /* there is no frequency at which a feedforward could help */
    TUNE_NO_BAND,
    /* the ratio is not known well enough in the band */
    TUNE_UNSURE,
    /* there is no first-order model, or its loop is unstable */
    TUNE_NO_MODEL,
    /* on fresh data the candidate would not do better */
    TUNE_NO_BETTER,
    /* too few samples came to test the candidate with */
    TUNE_UNTESTED,
    /* the operator rejected the proposal, or the board refused it */
    TUNE_REJECTED,
    /* the loop was worse than it would have been without its feedforward, which was switched off */
    TUNE_WORSE,
    TUNE_STOPPED,
    /* the test signal ended: its reason is added, in the order of enum excite_reason */
    TUNE_SIGNAL
};

#endif
