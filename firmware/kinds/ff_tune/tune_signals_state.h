/* The state behind tune_signals.h, for its file and for whoever gives it its place. */
#ifndef REFLUX_FF_TUNE_TUNE_SIGNALS_STATE_H
#define REFLUX_FF_TUNE_TUNE_SIGNALS_STATE_H

#include <stdbool.h>
#include <stdint.h>

struct tune_signals {
    /* Samples since the stage began. */
    uint32_t samples;
    /* Wanted in the last step; bit 0: on the setpoint, bit 1: on the disturbance. */
    uint8_t wanted;
    bool asked, paused;
};

#endif
