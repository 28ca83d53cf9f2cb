/* The state behind tune_samples.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_SAMPLES_STATE_H
#define REFLUX_FF_TUNE_TUNE_SAMPLES_STATE_H

#include "kinds/ff_tune/tune_results.h"
#include "num/num.h"
#include "signal/washout.h"

struct tune_samples {
    struct washout high_pass[TUNE_SIGNALS];
    /* The sample that is under way. */
    struct {
        real_t y, r, d, u, added;
        uint16_t ticks;
        bool good;
    } sum;
    /* The step before, whose u is known in this one. */
    struct {
        num_t y, r, d, u_fb;
        bool kept, good;
    } last;
    num_t held_y, held_d;
    /* The last sample behind the high-pass, and behind two lags more. */
    num_t passed[TUNE_SIGNALS];
    real_t smooth[TUNE_SIGNALS][2];
    /* Means of the last sample, not filtered. */
    real_t last_d, last_r;
    uint16_t setpoint_rests, disturbance_rests, bad_rests;
    /* The filters have had a first sample. */
    bool begun;
    bool good;
};

#endif
