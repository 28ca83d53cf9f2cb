/* A bus with its chips, as the one who masters it sees them: behind the ports of the host and behind the peripherals of the virtual board.
 * What a struct chip is stays closed here, because the virtual board calls its processors chips, too.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_CHIPS_BUS_H
#define REFLUX_CHIPS_BUS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/pin.h"

enum chip_bus { CHIP_SPI, CHIP_I2C, CHIP_ONEWIRE, CHIP_PIN /* none: a pin of the board itself */ };

struct chip;
struct chips;

#define CHIPS_MAX 16u /* on one bus */

/* What a master finds when it begins. */
enum chips_answer {
    CHIPS_SILENT,  /* nobody acknowledges; no presence pulse */
    CHIPS_ANSWER,  /* acknowledged; presence pulse */
    CHIPS_HELD_LOW /* I2C: data is low although nobody transfers; 1-wire: the line does not come up. Nothing gets through. */
};

/* An empty bus without faults. NULL: no memory. chips_free() leaves the chips to their owner. */
struct chips *chips_new(enum chip_bus kind, uint64_t seed);
void chips_free(struct chips *b);

/* Connects a chip. select: of a chip on SPI, else HAL_PIN_NONE. False, with a sentence in err: chip of another bus, select in use, bus full. */
bool chips_add(struct chips *b, struct chip *chip, hal_pin select, char *err, size_t err_size);

/* Puts another chip of the same bus in the place of one. */
void chips_replace(struct chips *b, const struct chip *chip, struct chip *by);

/* The data line is low although nobody transfers. */
bool chips_held_low(const struct chips *b);

/* Sets a fault of the bus: "noise", the probability (0..1) that a bit is wrong, each way; "stuck", the data line is low; "floats_low", a data
 * line that nobody drives reads 0 instead of 1 (SPI). False, with a sentence in err, for another name or value. */
bool chips_set(struct chips *b, const char *fault, double value, char *err, size_t err_size);

/* Before the world changes: see chip_at(). */
void chips_at(struct chips *b, uint64_t now_ns);

/* First text of a broken rule on this bus (struct chip), or "". count, where it is not NULL: broken rules of all chips. */
const char *chips_wrong(const struct chips *b, unsigned *count);

/* SPI. A select line changes; other pins than selects are ignored. */
void chips_select(struct chips *b, uint64_t now_ns, hal_pin pin, bool low);

/* A byte each way, most significant bit first, in the mode 0..3 that the master has. */
uint8_t chips_exchange(struct chips *b, uint64_t now_ns, unsigned mode, uint8_t out);

/* The clock has stopped within a byte, after 1..7 bits. */
void chips_clock_bits(struct chips *b, uint64_t now_ns, unsigned bits);

/* I2C. Start, or start again, and the address. */
enum chips_answer chips_start(struct chips *b, uint64_t now_ns, uint8_t address, bool read);

/* True: acknowledged. */
bool chips_write(struct chips *b, uint64_t now_ns, uint8_t byte);

/* acknowledge: what the master answers. */
uint8_t chips_read(struct chips *b, uint64_t now_ns, bool acknowledge);
void chips_stop(struct chips *b, uint64_t now_ns);

/* 1-wire. A reset pulse. */
enum chips_answer chips_reset(struct chips *b, uint64_t now_ns);

/* A time slot. out false: the master writes 0; true: it writes 1 or reads, which is the same on the line. The line as the master samples it. */
bool chips_slot(struct chips *b, uint64_t now_ns, bool out);

#endif
