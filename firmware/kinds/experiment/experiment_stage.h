/* The numbers that a block of the kind `experiment` shows as its `stage`, `reason` and `verdict`. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_STAGE_H
#define REFLUX_EXPERIMENT_EXPERIMENT_STAGE_H

/* In the order in which they come. */
enum experiment_stage {
    EXPERIMENT_IDLE,
    /* waits for the workspace */
    EXPERIMENT_ASKED,
    /* nothing moves: finds the operating point */
    EXPERIMENT_SETTLES,
    EXPERIMENT_EXCITES,
    EXPERIMENT_COMPUTES,
    EXPERIMENT_DONE,
    EXPERIMENT_ABORTED
};

/* The reason why it was aborted. Those of the test signal come behind, in the order of enum excite_reason. */
enum experiment_reason {
    REASON_NONE,
    REASON_STOPPED,
    /* a measurement has left its band */
    REASON_BAND,
    /* a measurement is missing */
    REASON_MEASUREMENT,
    /* something moved before the signal began */
    REASON_UNSTEADY,
    REASON_WORKSPACE,
    REASON_SETTINGS,
    /* the plant was away */
    REASON_PLANT,
    REASON_EXCITE = 10
};

/* Verdicts of the model are those of its outputs, enum plant_verdict. This one comes behind them: loops have moved the MVs. */
#define VERDICT_LOOPS 10

#endif
