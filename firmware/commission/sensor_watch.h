/* Watches the samples of the tests for faults of a sensor: it reads in coarse steps, or it is renewed only every few ticks. Tick writes,
 * main loop reads. All 0 before the first sample. */
#ifndef REFLUX_COMMISSION_SENSOR_WATCH_H
#define REFLUX_COMMISSION_SENSOR_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "identify/steady.h"
#include "num/real.h"

struct sensor_watch {
    real_t last; /* sample, fraction of span */
    real_t least,
        most; /* smallest and largest change between two samples, fraction of span; 0: none yet */
    uint16_t samples;    /* changes and repeats together, at most SENSOR_SAMPLES */
    uint16_t equal;      /* changes equal to the smallest */
    uint16_t repeats;    /* samples equal to the one before */
    uint8_t run;         /* samples since the latest change */
    uint8_t shortest;    /* ticks between two changes, at least; 0: none yet */
    uint8_t runs_beyond; /* runs longer than the shortest, at most 255 */
    uint8_t noted;       /* ticks of sensor_watch_note(); 0: none */
    bool seen;           /* there has been a sample */
};

/* Takes the next sample, fraction of span. */
void sensor_watch_step(struct sensor_watch *w, real_t y);
/* A test is over, and samples are left out until the next one: what is known of the renewal is kept, because shorter runs
 * across such a gap hide it from then on. */
void sensor_watch_note(struct sensor_watch *w);
/* Ticks after which the sensor gave a new value in some test; 1: every tick. */
unsigned sensor_watch_noted(const struct sensor_watch *w);
/* Size of the steps in which the sensor reads, fraction of span, where they are coarse enough to matter; 0: they are not. */
real_t sensor_watch_coarse(const struct sensor_watch *w);
/* Ticks after which the sensor gives a new value; 1: every tick. */
unsigned sensor_watch_renewal(const struct sensor_watch *w);

/* Corrects what was found at rest. Successive differences see little noise where most of them are 0. With a sensor that gives a new
 * value every `renewal` samples they show 1/renewal of the variance, and less with coarse steps, whose deviation is coarse_sd (0: fine
 * steps). variance_limit: of the ratio, as in steady_config. */
void sensor_allow(struct steady_result *at, unsigned renewal, real_t coarse_sd,
                  real_t variance_limit);

#endif
