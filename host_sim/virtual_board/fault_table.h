/* Faults of the hardware that a scenario may ask a virtual board for: names, units, ranges. The bench and the board read this one table.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_FAULT_TABLE_H
#define REFLUX_VIRTUAL_BOARD_FAULT_TABLE_H

#include <stdbool.h>
#include <stddef.h>

enum fault_kind {
    FAULT_POWER_CUT,
    FAULT_SUPPLY,
    FAULT_SUPPLY_RAMP,
    FAULT_CRYSTAL,
    FAULT_SLOW_CLOCK,
    FAULT_BUTTON,
    FAULT_HANG_MAIN,
    FAULT_HANG_TICK,
    FAULT_HANG_CLOCK,
    FAULT_FLIP_RAM,
    FAULT_FLIP_CCM,
    FAULT_FLIP_FLASH,
    FAULT_FLIP_STORED,
    FAULT_FLIP_REGISTER,
    FAULT_SET_R0,
    FAULT_JUMP,
    FAULT_NOISE_CONSOLE,
    FAULT_NOISE_LINK,
    FAULT_FLASH_CUT_WORD,
    FAULT_FLASH_CUT_ERASE,
    FAULT_UNPLUG_CONSOLE,
    FAULT_UNPLUG_LINK,
    /* settings of the faults that follow */
    FAULT_AFTER_NS,
    FAULT_AFTER_INSTRUCTIONS,
    FAULT_RAMP_TIME,
    FAULT_OFF_TIME,
    FAULT_PLACE,
    FAULT_FLIP_FROM,
    FAULT_FLIP_BYTES,
    FAULT_KINDS
};

struct fault_row {
    const char *name, *unit;
    double lo, hi;
    bool whole; /* whole numbers only */
    const char *about;
};

extern const struct fault_row fault_table[FAULT_KINDS];

/* FAULT_KINDS: there is none of that name. */
enum fault_kind fault_find(const char *name);

#endif
