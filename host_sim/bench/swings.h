/* Disturbances that swing: middle + amplitude sin(2 pi (t - begun)/period), one value a sample, held until the next. */
#ifndef REFLUX_HOST_SIM_SWINGS_H
#define REFLUX_HOST_SIM_SWINGS_H

#include "plants/plant_inputs.h"

#define SWINGS_MAX       32
#define SWING_PERIOD_S   1200.0 /* where none is given */
#define SWING_PERIOD_MIN 0.001
#define SWING_PERIOD_MAX 1e9

struct sim_swing {
    size_t channel; /* of the class, a disturbance */
    double middle, amplitude, period_s, begun_s;
    bool ends; /* to its middle, once */
};

struct swings {
    struct sim_swing list[SWINGS_MAX];
    size_t n;
};

/* The swing of a channel, begun at rest at `middle` where there was none; NULL when there are SWINGS_MAX others. */
struct sim_swing *swings_of(struct swings *s, size_t channel, double middle);

/* From now on it swings so far about its middle; 0 ends it there. */
void swing_set_amplitude(struct sim_swing *s, double amplitude, double time_s);

/* A disturbance was set: where it swings, that is its new middle. False where it does not swing. */
bool swings_moved(struct swings *s, size_t channel, double value);

/* Adds what they are at this time; returns how many changes there are now. */
size_t swings_add(struct swings *s, double time_s, struct plant_change *change, size_t n);

#endif
