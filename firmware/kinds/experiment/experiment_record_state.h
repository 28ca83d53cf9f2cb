/* The state behind experiment_record.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_EXPERIMENT_EXPERIMENT_RECORD_STATE_H
#define REFLUX_EXPERIMENT_EXPERIMENT_RECORD_STATE_H

#include "identify/arx.h"
#include "identify/decimate.h"
#include "identify/prbs.h"
#include "identify/rls.h"
#include "kinds/experiment/plant_experiment.h"

struct experiment_record {
    /* Samples of this stage; ticks of rest. */
    uint32_t samples, settled;
    /* ---- the measurements ---- */
    struct decimator filter[EXPERIMENT_MOST];
    /* Last good reading, fraction of span. */
    real_t held[EXPERIMENT_MOST];
    /* Operating point, and while it settles the sum. */
    real_t level[EXPERIMENT_MOST];
    real_t lowest[EXPERIMENT_MOST], highest[EXPERIMENT_MOST];
    /* Ticks without a good reading: in a row, all. */
    uint32_t gap[EXPERIMENT_MOST], gaps[EXPERIMENT_MOST];
    /* Readings in a row outside the band. */
    uint8_t outside[EXPERIMENT_MOST];
    /* ---- the MVs ---- */
    struct prbs prbs;
    /* The signal of this sample, fraction of span. */
    real_t signal[EXPERIMENT_MOST];
    /* Operating point, and while it settles the sum. */
    real_t rest[EXPERIMENT_MOST];
    /* Extremes while it settles. */
    real_t least[EXPERIMENT_MOST], most[EXPERIMENT_MOST];
    /* Sum over the sample. */
    real_t applied[EXPERIMENT_MOST];
    /* Sums of squares over the samples: of the MV about its operating point, and of the part that the signal has not made. */
    struct {
        real_t all, others;
    } sum[EXPERIMENT_MOST];
    /* % of the measurement's span */
    float live_error[EXPERIMENT_MOST];
};

struct experiment_rows {
    struct arx_orders live;
    struct arx_history history[EXPERIMENT_MOST];
    real_t *y, *u;
    struct rls *rls[EXPERIMENT_MOST];
};

#endif
