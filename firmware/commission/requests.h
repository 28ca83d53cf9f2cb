/* Requests of operator and main loop to the tick, one at a time, and of the tick to the main loop: the old settings.
 * The main loop writes it under hal_tick_lock. */
#ifndef REFLUX_COMMISSION_REQUESTS_H
#define REFLUX_COMMISSION_REQUESTS_H

#include <stdbool.h>
#include <stdint.h>

#include "commission/phase.h"

struct startup_requests;

/* A test of the whole plant or a relay test waits: it will overwrite all results. */
bool requests_begin(const struct startup_requests *r);
/* Adds the loop of a relay test, an index in the plan of that serial. */
void requests_put_relay(struct startup_requests *r, uint8_t loop, uint32_t serial);
/* Asks for a trial of the plan of that serial. */
void requests_put_trial(struct startup_requests *r, uint32_t serial);

#endif
