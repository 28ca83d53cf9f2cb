/* The record of the PI that a self-tuner replaces: its squared control errors and squared moves of the MV at rest, and its errors after
 * setpoints. The law is judged by it. Ours: every other monitor compares the law with its own past, so a cycle that has always
 * existed passes.
 *
 * A sample is at rest when the setpoint has not moved for `settled` steps and the controller has not changed in that time. */
#ifndef REFLUX_GMV_GMV_RECORD_H
#define REFLUX_GMV_GMV_RECORD_H

#include <stdbool.h>
#include <stdint.h>

/* An MV that moves by less in a step stands still: at a limit, or a stuck valve. Fraction of span. */
#define GMV_STANDS_STILL 1e-5f

struct gmv_record;

/* The controller changes: PI to law or back. The PI's record goes on. */
void gmv_record_begin(struct gmv_record *r);
/* Takes a step of the PI. away: setpoint - PV; moved: of the MV; fractions of span. */
void gmv_record_pi(struct gmv_record *r, float setpoint, float away, float moved, uint32_t settled);
/* Takes a step of the law. Returns its moves as a multiple of the PI's (r.m.s.) where it has done worse at rest for two windows of 64
 * steps, or its errors after setpoints as a multiple of the PI's where these are worse; 0: it is no worse. */
float gmv_record_law(struct gmv_record *r, float setpoint, float away, float moved,
                     uint32_t settled);
/* Steps since the setpoint moved or the controller changed. */
uint32_t gmv_record_rests(const struct gmv_record *r);
/* Mean square of the PI's control error at rest, spans squared. */
float gmv_record_error(const struct gmv_record *r);
/* The sum of the PI's |setpoint - PV| after a setpoint step of 1, steps. 0: too few answers yet, or some were cut short. */
float gmv_record_answer(const struct gmv_record *r);
/* Mean square of the noise of the PV's sensor, spans squared: from second differences, and at most the PI's squared control error.
 * 0: nothing has been at rest yet. */
float gmv_record_noise(const struct gmv_record *r);
/* Returns whether a law with these mean squares at rest would be worse. False without a record of the PI at rest. */
bool gmv_record_would(const struct gmv_record *r, float error, float moves);

#endif
