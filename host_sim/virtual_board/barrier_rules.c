/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "barrier_rules.h"

#include "core.h"
#include "system_control.h"
#include "thumb.h"

#define AT_ONCE     (NEED_PROTECTION | NEED_FPU | NEED_VECTORS) /* before the next jump */
#define ORDER       (NEED_STORED | NEED_FLASH_CR | NEED_CACHE_OFF)
#define CORE        0xE0000000u /* from here on: the core's own registers */
#define CONTROL     0xE000E000u /* those of the system control space */
#define CACHE_ON    (UINT32_C(1) << 10)
#define AIRCR_ASKS  0x05FA0004u
#define AIRCR_KEYED 0xFFFF0004u

enum barrier { BARRIER_NONE, BARRIER_DSB, BARRIER_DMB, BARRIER_ISB, BARRIER_WFI };

/* DDI 0403 A7.7: DSB F3BF 8F4x, DMB F3BF 8F5x, ISB F3BF 8F6x, WFI BF30. */
static enum barrier barrier_of(const uint8_t *code)
{
    if (code[1] == 0xBFu && code[0] == 0x30u)
        return BARRIER_WFI;
    if (code[1] != 0xF3u || code[0] != 0xBFu || code[3] != 0x8Fu)
        return BARRIER_NONE;
    switch (code[2] >> 4) {
    case 4:
        return BARRIER_DSB;
    case 5:
        return BARRIER_DMB;
    case 6:
        return BARRIER_ISB;
    default:
        return BARRIER_NONE;
    }
}

static const char *lacking(uint32_t needs)
{
    return (needs & NEED_PROTECTION) != 0 ? "the protection unit"
           : (needs & NEED_FPU) != 0      ? "CPACR"
                                          : "VTOR";
}

static void jumped(struct board *b, struct barrier_rules *r)
{
    uint32_t needs = (r->dsb | r->isb) & AT_ONCE;
    if (needs != 0)
        board_verdict(b, "jump after a write of %s without %s between", lacking(needs),
                      (r->dsb & needs) != 0 ? "DSB" : "ISB");
    r->dsb &= ~(uint32_t)AT_ONCE;
    r->isb = 0;
    r->synchronised = false;
}

void barrier_rules_instruction(struct board *b, uint32_t address, const uint8_t *code)
{
    struct barrier_rules *r = &b->processor->rules;
    enum barrier what = code == NULL ? BARRIER_NONE : barrier_of(code);
    if (address != r->next)
        jumped(b, r);
    if (what == BARRIER_DSB) {
        r->dsb = 0;
        r->fresh = 0;
        r->synchronised = true;
    } else if (what == BARRIER_DMB) {
        r->dsb &= ~(uint32_t)ORDER;
    } else if (what == BARRIER_ISB) {
        r->isb &= r->dsb; /* one before the DSB does not count */
    } else if (what == BARRIER_WFI && !r->after_dsb) {
        board_verdict(b, "WFI without DSB before it");
    }
    if ((r->dsb & NEED_AFTER_RESET) != 0)
        board_verdict(b, "no DSB after a reset by AIRCR");
    r->dsb &= ~(uint32_t)NEED_AFTER_RESET;
    r->after_dsb = what == BARRIER_DSB;
    r->next = address + (code == NULL ? 2u : thumb_length(code));
}

static void core_written(struct board *b, struct barrier_rules *r, uint32_t offset,
                         uint32_t written)
{
    uint32_t both = offset == CPACR ? NEED_FPU
                    : offset == MPU_CTRL || offset == MPU_RBAR || offset == MPU_RASR
                        ? NEED_PROTECTION
                        : 0;
    r->isb |= both;
    r->dsb |= both | (offset == VTOR ? NEED_VECTORS : 0);
    if (offset != AIRCR || (written & AIRCR_KEYED) != AIRCR_ASKS)
        return;
    if (!r->synchronised)
        board_verdict(b, "reset by AIRCR without DSB before it");
    r->dsb |= NEED_AFTER_RESET;
}

static bool is_rcc(struct board *b, uint32_t address)
{
    const struct chip_part *rcc = bus_part(b, "RCC")->row;
    return address - rcc->base < rcc->size;
}

/* A write of the RCC turns clocks on; it has not arrived yet. */
static void turns_on(struct board *b, struct barrier_rules *r, uint32_t address, uint32_t written)
{
    const struct part *rcc = bus_part(b, "RCC");
    uint32_t offset = address - rcc->row->base;
    for (size_t i = 0; i < b->chip->n_parts; i++) {
        const struct chip_part *row = &b->chip->parts[i];
        uint32_t bit = UINT32_C(1) << row->enable_bit;
        if (row->enable_offset == offset && offset != 0 && (written & bit) != 0 &&
            (part_get(rcc, offset) & bit) == 0)
            r->fresh |= UINT64_C(1) << i;
    }
}

static void check_clock(struct board *b, const struct barrier_rules *r, uint32_t address)
{
    for (size_t i = 0; r->fresh != 0 && i < b->chip->n_parts; i++) {
        const struct chip_part *row = &b->chip->parts[i];
        if ((r->fresh >> i & 1u) != 0 && address - row->base < row->size)
            board_verdict(b, "access to %s right after its clock was turned on", row->name);
    }
}

void barrier_rules_access(struct board *b, uint32_t address, bool stored, bool write,
                          uint32_t written)
{
    struct barrier_rules *r = &b->processor->rules;
    if (!r->on)
        return;
    if (address >= CORE) {
        if (write)
            core_written(b, r, address - CONTROL, written);
    } else if (stored && write) {
        if ((r->dsb & NEED_FLASH_CR) != 0)
            board_verdict(b, "store into the flash after a write of FLASH_CR without DSB between");
        r->dsb |= NEED_STORED;
    } else if (stored) {
        if ((r->dsb & NEED_CACHE_OFF) != 0)
            board_verdict(b,
                          "read of the flash after its cache was turned off without DSB between");
    } else if (is_rcc(b, address)) {
        if (write)
            turns_on(b, r, address, written);
        else
            r->fresh = 0;
    } else if (write) {
        const struct chip *chip = b->chip;
        check_clock(b, r, address);
        if (address == chip->flash_control)
            r->dsb |= NEED_FLASH_CR;
        else if (address == chip->flash_cache && (written & CACHE_ON) == 0)
            r->dsb |= NEED_CACHE_OFF;
    } else {
        check_clock(b, r, address);
        if ((r->dsb & NEED_STORED) != 0)
            board_verdict(b, "read of a register after a store into the flash without DSB between");
    }
    if (b->verdict[0] != '\0')
        r->dsb = 0;
}
