/* XGZP6897D and its relatives XGZP68xxD: differential pressure. Facts: CFSensor's data sheet V2.7 as public drivers quote it (fanfanlatulipe26/
 * XGZP6897D; esphome, component xgzp68xx); the data sheet itself has not been seen.
 *
 * Settings: bus; address: 6Dh, the only one there is; reference: full scale to the positive side as printed on the part, kPa, up to 1000. The
 * chip's unit follows from it.
 * Codes: pressure, in 1/K Pa; temperature, 1/256 degC.
 *
 * What a reading can say: no chip: no acknowledgement; power on: registers of zeros; wrong chip: a conversion does not end; checksum: two
 * reads differ; bus: only ones; range: a temperature that the chip cannot have, an end of its 24 bits, or a fifth beyond full scale.
 * The chip has no number of its own, so another chip at its address cannot be told as such. Blocked or swapped hoses cannot be told at all.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_XGZP6897_H
#define REFLUX_DEVICES_XGZP6897_H

#include "devices/device.h"

extern const struct device_kind xgzp6897_kind; /* Pa */

#endif
