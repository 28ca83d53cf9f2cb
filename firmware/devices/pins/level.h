/* A level switch or another dry contact between a pin and ground: 0 or 1, debounced.
 *
 * Settings: select: the pin; type: 0: a closed contact is 1; 1: an open contact is 1. Wire a switch that must be noticed so that its wire, when
 * broken, reads as the dangerous level.
 * Codes: 1: the contact is closed.
 *
 * A change counts when the pin has been the same for LEVEL_STEADY_MS. A broken or shorted wire is an open or a closed contact, which nothing
 * here can tell.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_PINS_LEVEL_H
#define REFLUX_DEVICES_PINS_LEVEL_H

#include "devices/device.h"

#define LEVEL_STEADY_MS 20u

extern const struct device_kind level_kind; /* 0 or 1 */

#endif
