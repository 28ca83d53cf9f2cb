/* The state behind tune_stages.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_STAGES_STATE_H
#define REFLUX_FF_TUNE_TUNE_STAGES_STATE_H

#include <stdbool.h>
#include <stdint.h>

struct tune_stages {
    /* Samples since the stage began; since an element was found, while it acts. */
    uint32_t samples, since_tuned;
    /* enum tune_stage, enum tune_verdict */
    uint8_t stage, verdict;
    /* Times that the element was switched off. */
    uint8_t tried;
    /* The element has a gain. */
    bool acts;
    /* The estimator is to begin anew with the next sample for which the work is over. */
    bool anew;
    /* The shadows have a model; the loop's responses are known. */
    bool has_model, has_loop;
    /* It identifies anew once the feedforward is off. */
    bool again;
    /* The disturbance has moved in this stage. */
    bool moved;
    /* Nobody has asked for what it identifies. */
    bool unasked;
};

#endif
