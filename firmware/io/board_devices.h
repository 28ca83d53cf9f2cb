/* Which device a row of chan is, and what its kind is given.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_IO_BOARD_DEVICES_H
#define REFLUX_IO_BOARD_DEVICES_H

#include "devices/device.h"
#include "devices/voltage/current_loop.h"
#include "exchange/config.h"
#include "hal/io.h"

/* NULL: none. */
const struct device_kind *board_device_kind(const struct device_config *row);

/* Whether chan.type is one that the device of the row can have. */
bool board_device_takes_type(const struct device_config *row);

/* The settings of a row that service/pins_check.c has accepted. */
struct device_settings board_device_settings(const struct pins_config *pins,
                                             const struct device_config *row);

/* The reading of a row from a result without a fault: what its sensor says of what is behind it, in EU. loop: the state of a current loop,
 * passed_s after the reading before. False: the number is none that it can have. */
bool board_device_value(const struct device_config *row, const struct device *d,
                        const struct device_result *result, float passed_s,
                        struct current_loop *loop, struct io_reading *reading);

#endif
