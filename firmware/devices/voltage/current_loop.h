/* A transmitter with 4 to 20 mA behind a measured voltage, and what its current says by NAMUR NE 43: 3.8 to 20.5 mA is a measurement, 3.6 mA
 * and less or 21 mA and more is the transmitter's own failure, or a broken or shorted wire.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_VOLTAGE_CURRENT_LOOP_H
#define REFLUX_DEVICES_VOLTAGE_CURRENT_LOOP_H

#include "base/channel.h"

/* mA */
#define LOOP_FAILURE_LO 3.6f
#define LOOP_GOOD_LO    3.8f
#define LOOP_GOOD_HI    20.5f
#define LOOP_FAILURE_HI 21.0f

struct current_loop {
    float failing_s; /* the current has been a failure for so long, s */
};

/* Current in mA through a shunt (ohm, above 0) from the voltage over it. */
float loop_current(float volt, float shunt);

/* Fraction of the span: 0 at 4 mA, 1 at 20 mA. */
float loop_fraction(float milliampere);

/* Quality of this current, passed_s after the last one. Between measurement and failure it is uncertain; a failure is uncertain for delay_s (a
 * transmitter that starts), then bad. No number is bad. Zeros are the state at first. */
enum quality loop_quality(struct current_loop *c, float milliampere, float passed_s, float delay_s);

#endif
