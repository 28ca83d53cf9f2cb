/* Rules about memory barriers, checked where a board runs by single instructions from its start. The models do everything at once, so
 * code that lacks a barrier works on them; on a chip it works by luck. The rules are from memory of PM0214 2.2.2, 2.2.4, 4.2 and 4.6, of
 * the ARMv7-M manual (DDI 0403 A3.7.3, B3.2.6) and of ARM's application note 321 (unverified). They are:
 *
 * - Between a write of the protection unit or of CPACR and the next jump stand a DSB and after it an ISB; after one of VTOR a DSB.
 * - A DSB comes right before WFI.
 * - Between the last jump and a reset by AIRCR stands a DSB, and the next one comes right after it.
 * - Accesses to flash and to registers are not in order: a DSB or DMB stands between a store into the flash and the next read of a
 *   register, between a write of FLASH_CR and the next store into the flash, and after a write of FLASH_ACR with the cache of data off
 *   before the next read of what is stored.
 * - The first access to a part comes after the write that turns on its clock, and a read of the RCC or a DSB between (errata sheet
 *   ES0182: two clocks of its bus, which a part may need).
 *
 * "The next jump" is stricter than the manuals, which say "before it is needed".
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_BARRIER_RULES_H
#define REFLUX_VIRTUAL_BOARD_BARRIER_RULES_H

#include <stdbool.h>
#include <stdint.h>

struct board;

/* Writes that wait for a barrier; a bit each. */
enum barrier_need {
    NEED_PROTECTION = 1,
    NEED_FPU = 2,
    NEED_VECTORS = 4,
    NEED_AFTER_RESET = 8,
    NEED_STORED = 16, /* a store into the flash */
    NEED_FLASH_CR = 32,
    NEED_CACHE_OFF = 64
};

struct barrier_rules {
    bool on;
    bool synchronised; /* by a DSB since the last jump */
    bool after_dsb;    /* the instruction before was one */
    uint32_t next;     /* address behind the instruction before */
    uint64_t fresh;    /* parts whose clock has just been turned on: a bit each */
    uint32_t dsb, isb; /* sums of enum barrier_need that lack it */
};

/* Before each instruction, where the rules are on. code: its bytes; NULL: not known. */
void barrier_rules_instruction(struct board *b, uint32_t address, const uint8_t *code);
/* Before each access of the code to what the models hold. stored: flash that the firmware writes. */
void barrier_rules_access(struct board *b, uint32_t address, bool stored, bool write,
                          uint32_t written);

#endif
