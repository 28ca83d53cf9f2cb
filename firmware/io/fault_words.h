/* The fault of a sensor that people are told: the detail of EVENT_SENSOR_FAULT.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_IO_FAULT_WORDS_H
#define REFLUX_IO_FAULT_WORDS_H

#include <stdint.h>

/* Number of the first of these bits of enum device_fault, from 1; 0: none. The first ones say more: where nothing answers, nothing else
 * is known. */
uint8_t fault_word(uint16_t faults);
const char *fault_word_text(uint8_t fault);

#endif
