/* An analogue input of the board's own chip. What is behind the voltage: devices/voltage/.
 *
 * Settings: select: the pin; reference: V, for a board that does not know its own.
 * Codes: the mean of 16 conversions, 65535 at the reference.
 *
 * What a reading can say: bus: there is no conversion; range: the code is at its upper end. A wire that is broken is a voltage like any other
 * here. Only what is behind it can tell.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_PINS_ANALOG_INPUT_H
#define REFLUX_DEVICES_PINS_ANALOG_INPUT_H

#include "devices/device.h"

extern const struct device_kind analog_input_kind; /* V */

#endif
