/* Temperatures that draw the model: geometric estimator, reduced and complete EKF. For this folder alone. */
#ifndef REFLUX_COMPOSITION_COMPOSITION_SENSORS_H
#define REFLUX_COMPOSITION_COMPOSITION_SENSORS_H

#include "kinds/composition/composition_model.h"

#if CONFIG_BLOCKS

struct composition_sensors;

/* Takes the settings; integrals and variances stay. */
void composition_sensors_set(struct composition_sensors *all, const struct block_setup *setup);
void composition_sensors_begin(struct composition_sensors *all);
/* present: sensor k has a good reading. */
void composition_sensors_put(struct composition_sensors *all, unsigned k, bool present);

/* Takes a step of the model to the readings t[sensors], K; those that are not present count for nothing. The inputs are those of the
 * time between. gain: of complete innovation, [sensors][composition_model_length()]; NULL: none yet. watched_s: time that the monitor
 * has had. ERR_OK, or why there is no estimate. */
MUST_CHECK enum err composition_sensors_step(struct composition_sensors *all,
                                             struct composition_model *model, const real_t *gain,
                                             const real_t *t, real_t watched_s);

/* ---- each of them ---- */

unsigned composition_sensors_count(const struct composition_sensors *all);
/* Returns the number of the input, from 1. */
unsigned composition_sensors_input(const struct composition_sensors *all, unsigned k);
size_t composition_sensors_stage(const struct composition_sensors *all, unsigned k);
real_t composition_sensors_noise2(const struct composition_sensors *all, unsigned k);
/* 1/s, variance that a mole fraction gathers in a second */
real_t composition_sensors_model2(const struct composition_sensors *all);
/* True: the sensor moves the model in this step. */
bool composition_sensors_draws(const struct composition_sensors *all, unsigned k);
/* True: it does, and is above the feed, or below. */
bool composition_sensors_draws_in(const struct composition_sensors *all, unsigned k,
                                  size_t feed_stage, bool above);

/* The innovation of a sensor in a step, for the monitor. */
struct composition_innovation {
    real_t e;          /* K */
    real_t expected;   /* K2, variance of e */
    real_t correction; /* K/s */
};

/* False: it had no reading in this step. */
bool composition_sensors_innovation(const struct composition_sensors *all, unsigned k,
                                    struct composition_innovation *innovation);
/* noise2: K2, as the monitor finds it; counts where no noise is given. */
void composition_sensors_find_noise(struct composition_sensors *all, unsigned k, real_t noise2);
bool composition_sensors_finds_noise(const struct composition_sensors *all);

/* ---- all of them ---- */

/* s, 1/lambda of the slowest that moves the model */
real_t composition_sensors_slowest(const struct composition_sensors *all);
/* Returns the number of the input of the first that is lost, or 0. */
unsigned composition_sensors_lost(const struct composition_sensors *all);
/* True: one moves the model in this step. */
bool composition_sensors_any_draws(const struct composition_sensors *all);
/* True: one draws although it is outside the gate, since that was for long or is the beginning. */
bool composition_sensors_use_outside(const struct composition_sensors *all);
/* True: a section that has temperatures has lost all of them. */
bool composition_sensors_lost_section(const struct composition_sensors *all, size_t feed_stage);
/* True: one above the feed, or below, moves the model. */
bool composition_sensors_in_section(const struct composition_sensors *all, size_t feed_stage,
                                    bool above);
/* Returns a bit for each that moves the model; else only where it is present. */
uint16_t composition_sensors_present(const struct composition_sensors *all, bool always);
/* spread[sensors]: expected variances, K2 */
void composition_sensors_take_spread(struct composition_sensors *all, const real_t *spread);
/* For the console. */
real_t composition_sensors_e(const struct composition_sensors *all, unsigned k);
real_t composition_sensors_slope(const struct composition_sensors *all, unsigned k);

#endif
#endif
