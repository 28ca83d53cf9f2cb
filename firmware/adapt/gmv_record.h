/* The record of the PI that a self-tuner replaces: its squared control errors and squared moves of the MV at rest, and whether the
 * law does worse. Ours: every other monitor compares the law with its own past, so a cycle that has always been there passes.
 *
 * A sample is at rest when the setpoint has not moved for `settled` steps and nobody else has begun to compute in that time. */
#ifndef REFLUX_ADAPT_GMV_RECORD_H
#define REFLUX_ADAPT_GMV_RECORD_H

#include <stdbool.h>
#include <stdint.h>

struct gmv_record {
    float setpoint;
    uint32_t rests; /* steps since the setpoint has moved, or somebody else computes */
    float error,
        moves; /* mean squares of the PI at rest, of all its samples until there are enough of these */
    uint16_t samples; /* of these at rest; 0: not enough yet */
    uint16_t of_all;  /* samples while there were not enough */
    /* The window of the law, or of the PI until there are enough. */
    uint8_t seen, beyond; /* samples at rest; windows beyond, one after the other */
    float error_sum, moves_sum;
};

/* Somebody else computes from now on. The PI's record goes on. */
void gmv_record_begin(struct gmv_record *r);
/* A step of the PI. away: setpoint - PV; moved: of the MV; fractions of span. */
void gmv_record_pi(struct gmv_record *r, float setpoint, float away, float moved, uint32_t settled);
/* A step of the law: whether it has done worse than the PI for two windows of 64 steps. */
bool gmv_record_law(struct gmv_record *r, float setpoint, float away, float moved,
                    uint32_t settled);
/* Whether the law would do worse at rest if it had so many times the PI's mean squares. */
bool gmv_record_would(const struct gmv_record *r, float error_times, float moves_times);
/* How much the law moves the MV, times the PI; r.m.s., of the last window. */
float gmv_record_times(const struct gmv_record *r);

#endif
