/* Settings of the kind `gmv`: the rows of its parameters, and the configurations of self-tuner and supervision made of them. */
#ifndef REFLUX_GMV_GMV_SETTINGS_H
#define REFLUX_GMV_GMV_SETTINGS_H

#include "block/block.h"

#if CONFIG_BLOCKS

#include "kinds/gmv/gmv_config.h"
#include "kinds/gmv/gmv_supervise.h"

/* `relative`: lambda times the g_ii,0 in use is the weight on the move. */
enum gmv_weight_word { GMV_WORD_DELTA, GMV_WORD_SCALAR, GMV_WORD_RELATIVE };

struct gmv_settings {
    float tau_p_s[GMV_LOOPS], tau_r_s[GMV_LOOPS], lambda[GMV_LOOPS];
    /* P(0) of PVs and the rest, of MVs. */
    float p0[2];
    float forget, forget_least, memory, trace, correct_rate, error_most, dead_zone;
    float tune_gain[GMV_LOOPS], tune_ti_s[GMV_LOOPS];
    float tune_time_s, check_time_s;
    float excite, gain_least, margin, speed, quiet, burst, better, detune;
    /* Start values. */
    float theta[GMV_LOOPS][GMV_PARAMETERS];
    float lo[GMV_PARAMETERS][GMV_LOOPS], hi[GMV_PARAMETERS][GMV_LOOPS];
    uint16_t na, nb, nc, load_delay, average, tries;
    uint16_t delay[GMV_LOOPS][GMV_LOOPS];
    uint8_t form, way, weight, bias, forgetting, correction, normalise, supervise, adopt;
};

/* The first of 24: twelve of loop 1, twelve of loop 2. */
#define GMV_ID_THETA 40u
#define GMV_ID_LAST  (GMV_ID_THETA + 2u * GMV_PARAMETERS + 1u)

#define GMV_PARAMETER_ROWS GMV_ID_LAST
extern const struct block_parameter gmv_parameter_rows[GMV_PARAMETER_ROWS];

/* Make configurations of settings, accepted or not, and check nothing. */
void gmv_config_of(const struct block_setup *setup, struct gmv_config *c);
void gmv_supervise_config_of(const struct block_setup *setup, struct gmv_supervise_config *c);
enum err gmv_settings_check(const struct block_setup *setup, struct block_fault *fault);

#endif
#endif
