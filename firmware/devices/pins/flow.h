/* A flow meter with a Hall sensor, or any contact that gives pulses: pulses a second. Pulses per litre belong to the channel's calibration.
 *
 * Settings: select: the pin; type: ms within which a second edge is contact bounce, 0 for a Hall sensor.
 * Codes: pulses since the result before; ms in which they came; all pulses since the device was opened, modulo 2^31.
 *
 * What a reading can say: range: more than HAL_PULSE_HZ_MAX a second, as by a disturbed line. No pulses are no flow: a meter that is not there
 * cannot be told from it.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_PINS_FLOW_H
#define REFLUX_DEVICES_PINS_FLOW_H

#include "devices/device.h"

/* A result of flow_kind says how fast pulses came in the interval before it. A tick that looks once a second misses the intervals between. So a
 * volume is counted from pulses_kind, the number of pulses since the device was opened, modulo PULSES_WRAP. */
#define PULSES_WRAP 65536u

extern const struct device_kind flow_kind;   /* 1/s */
extern const struct device_kind pulses_kind; /* - */

#endif
