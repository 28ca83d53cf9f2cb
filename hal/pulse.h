/* Counts of pulses at a pin, by interrupt.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_HAL_PULSE_H
#define REFLUX_HAL_PULSE_H

#include "base/error.h"
#include "hal/pin.h"

#define HAL_PULSE_HZ_MAX 2000u

/* Counts falling edges at this pin from now on; a pull-up is on. ERR_RANGE: the pin cannot. ERR_FULL: another pin uses the same interrupt. */
enum err hal_pulse_open(hal_pin pin);

/* Edges since hal_pulse_open(), modulo 2^32. An edge within dead_ms of the one before is contact bounce and not counted; 0: all count. */
uint32_t hal_pulse_count(hal_pin pin);

void hal_pulse_set_dead_time(hal_pin pin, uint8_t dead_ms);

#endif
