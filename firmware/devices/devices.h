/* All kinds of devices.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_DEVICES_H
#define REFLUX_DEVICES_DEVICES_H

#include "devices/device.h"

/* 0: a board has only platinum thermometers behind a MAX31865, DS18B20 and contacts (io/board_devices.c). It refuses the others in these words. */
#ifndef DEVICE_ALL_KINDS
#define DEVICE_ALL_KINDS 1
#endif
#define DEVICE_KINDS_HERE "this board has max31865, ds18b20 and level only"

/* Rows of a table for the others. */
#if DEVICE_ALL_KINDS
#define DEVICE_FURTHER(...) __VA_ARGS__
#define DEVICE_KINDS        11u
#else
#define DEVICE_FURTHER(...)
#define DEVICE_KINDS 3u
#endif

/* The kind with this place, from 0, or NULL from DEVICE_KINDS on. Names are in the order of the alphabet. */
const struct device_kind *device_kind_at(unsigned place);

/* The kind with this name, or NULL. */
const struct device_kind *device_kind_find(const char *name);

/* Word for the lowest fault of these, for people: "sensor or wire open"; "" for none. */
const char *device_fault_text(uint16_t faults);

#endif
