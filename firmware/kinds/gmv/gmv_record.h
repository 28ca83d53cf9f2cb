/* The record of the PI that a self-tuner replaces: its squared control errors and squared moves of the MV at rest, its errors after
 * setpoints, and whether the law does worse. Ours: every other monitor compares the law with its own past, so a cycle that has always
 * been there passes.
 *
 * A sample is at rest when the setpoint has not moved for `settled` steps and nobody else has begun to compute in that time. */
#ifndef REFLUX_GMV_GMV_RECORD_H
#define REFLUX_GMV_GMV_RECORD_H

#include <stdbool.h>
#include <stdint.h>

/* An MV that moves by less in a step stands still: at a limit, or a stuck valve. Fraction of span. */
#define GMV_STANDS_STILL 1e-5f

/* Answers to setpoints: means over steps until the setpoint has settled. */
struct gmv_answers {
    float error, moved; /* |setpoint - PV|, |change of the setpoint| */
    float cut;          /* how often the setpoint moved on before the PV had come near it */
    uint16_t samples;
};

struct gmv_record {
    bool has_setpoint,
        answers; /* the latter: a setpoint has moved since somebody has begun to compute */
    float setpoint;
    uint32_t rests; /* steps since the setpoint has moved, or somebody else computes */
    float error,
        moves; /* mean squares of the PI at rest, of all its samples until there are enough of these */
    uint16_t samples; /* of these at rest; 0: not enough yet */
    uint16_t of_all;  /* samples while there were not enough */
    /* The window of the law, or of the PI until there are enough. */
    uint8_t seen, beyond; /* samples at rest; windows beyond, one after the other */
    float error_sum, moves_sum;
    /* Sensor noise at rest: the two control errors before, and the mean size of second differences. */
    float before[2], jitter;
    uint16_t jitters;
    struct gmv_answers of_pi, of_law;
};

/* Somebody else computes from now on. The PI's record goes on. */
void gmv_record_begin(struct gmv_record *r);
/* A step of the PI. away: setpoint - PV; moved: of the MV; fractions of span. */
void gmv_record_pi(struct gmv_record *r, float setpoint, float away, float moved, uint32_t settled);
/* A step of the law. How many times as much it moves the MV as the PI (r.m.s.) where it has done worse at rest for two windows of 64
 * steps, or how many times as large its errors after setpoints are where these are worse; 0: it is no worse. */
float gmv_record_law(struct gmv_record *r, float setpoint, float away, float moved,
                     uint32_t settled);
/* The sum of the PI's |setpoint - PV| after a setpoint step of 1, steps. 0: there are not enough of them yet, or some were cut short. */
float gmv_record_answer(const struct gmv_record *r);
/* Mean square of what the PV's sensor adds by itself, spans squared: as second differences show it, and no more than the PI's
 * control error. 0: nothing has been at rest yet. */
float gmv_record_noise(const struct gmv_record *r);
/* Whether a law with these mean squares at rest would be worse. False without a record of the PI at rest. */
bool gmv_record_would(const struct gmv_record *r, float error, float moves);

#endif
