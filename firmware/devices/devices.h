/* All kinds of devices.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_DEVICES_H
#define REFLUX_DEVICES_DEVICES_H

#include "devices/device.h"

#define DEVICE_KINDS 11u

/* The kind with this place, from 0, or NULL from DEVICE_KINDS on. Names are in the order of the alphabet. */
const struct device_kind *device_kind_at(unsigned place);

/* The kind with this name, or NULL. */
const struct device_kind *device_kind_find(const char *name);

/* Word for the lowest fault of these, for people: "sensor or wire open"; "" for none. */
const char *device_fault_text(uint16_t faults);

#endif
