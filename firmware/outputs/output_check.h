/* What is wrong with the settings of an output, in words for people.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_OUTPUTS_OUTPUT_CHECK_H
#define REFLUX_OUTPUTS_OUTPUT_CHECK_H

#include "outputs/output_settings.h"

#define OUTPUT_NO_OTHER 0xFFu

struct output_problem {
    const char *words;                  /* "the pin is used twice", never NULL */
    const struct output_number *number; /* that is outside its range, or NULL */
    uint8_t pin;                        /* enum output_pin; OUTPUT_PINS: none */
    uint8_t other; /* index of an output that it conflicts with, or OUTPUT_NO_OTHER */
};

/* Checks output `index` of these, alone and against those before it, so that checking all in turn finds each conflict once.
 * True: nothing is wrong. Otherwise *problem says what is wrong first. Pins of other devices and of buses are not known here. */
bool output_check(const struct output_settings *outputs, uint8_t n, uint8_t index,
                  struct output_problem *problem);

#endif
