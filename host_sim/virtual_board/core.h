/* The parts of the processor's model among themselves: processor.c (running), code_hooks.c (counting of code), exceptions.c
 * (frames on the stack), address_space.c (memory, registers, protection).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_CORE_H
#define REFLUX_VIRTUAL_BOARD_CORE_H

#include <unicorn/unicorn.h>

#include "barrier_rules.h"
#include "interrupts.h"

#define EXC_RETURNS 0xFFFFFF00u /* a jump to here or above returns from an exception */
#define XPSR_THUMB  (UINT32_C(1) << 24)
#define WINDOWS     5

/* Addresses that go to models. */
struct window {
    struct board *board;
    uint32_t base, size;
    bool stored;
};

struct processor {
    struct board *board;
    struct interrupts *interrupts;
    struct barrier_rules rules;
    uc_engine *uc;
    uint8_t *memory[BOARD_LAST_FLASH];
    struct counted {
        uint16_t bytes, instructions;
    } * counted; /* blocks of the flash, by address */

    uint64_t slice_end, fault_at;                 /* cycles */
    uint64_t exact_from, block_began, looked_for; /* cycles */
    struct window windows[WINDOWS];
    size_t n_forbidden;
    struct forbidden forbidden[16];
    uint32_t image_bytes;
    uint32_t looked_pc;
    uint32_t partly; /* bytes of the block that is only run up to some instruction; 0: none */
    uint32_t block, pc, resume;
    bool exact, fpu_on, stepping, looked_known, pc_known;
    bool running; /* within the library */
    bool first, cut, attend, sleeping, locked_up, left;
    bool protection_changed;
    bool stored_changed, stored_plain; /* stored_plain: it is mapped like other memory */
    bool divided_by_zero, division_by_step;

    /* of the access that the library could not do */
    bool failed;
    uc_mem_type failed_type;
    uint32_t failed_address, failed_pc;
};

static inline const struct chip_memory *flash_of(const struct chip *chip)
{
    return &chip->memory[0];
}

static inline uint32_t core_get(const struct processor *p, int reg)
{
    uint32_t value = 0;
    (void)uc_reg_read(p->uc, reg, &value);
    return value;
}

static inline void core_set(const struct processor *p, int reg, uint32_t value)
{
    (void)uc_reg_write(p->uc, reg, &value);
}

static inline struct masks core_masks(const struct processor *p)
{
    return (struct masks){.primask = (core_get(p, UC_ARM_REG_PRIMASK) & 1u) != 0,
                          .faultmask = (core_get(p, UC_ARM_REG_FAULTMASK) & 1u) != 0,
                          .basepri = (uint8_t)core_get(p, UC_ARM_REG_BASEPRI)};
}

/* The flash, or its alias at 0. */
static inline bool in_flash(const struct processor *p, uint32_t address)
{
    const struct chip_memory *flash = flash_of(p->board->chip);
    return address < flash->size || address - flash->base < flash->size;
}

/* processor.c: of the access that is under way within the library. */
uint32_t core_access_pc(struct processor *p);

/* code_hooks.c */
bool code_hooks_add(struct processor *p);
/* Instruction steps from now on. */
void code_hooks_exact(struct processor *p);
/* Translations of the flash and of its alias at 0. */
void code_hooks_forget(struct processor *p);

/* exceptions.c */
void exception_enter(struct processor *p, unsigned exception, uint32_t return_to);
/* Raises a fault of the instruction at pc. The core locks up where no handler may run. */
void exception_fault(struct processor *p, unsigned exception, uint32_t status, uint32_t address,
                     uint32_t pc);
/* After a jump to an EXC_RETURN value. */
void exception_leave(struct processor *p);
/* The library could not do the access that it was at. */
void exception_of_access(struct processor *p);

/* address_space.c */
bool address_map_memory(struct board *b, struct processor *p);
bool address_map_windows(struct board *b, struct processor *p);
void address_protect(struct processor *p);
/* Lets a page of the SRAM hold code, the first time that some is fetched from there; false: the address is not in the SRAM. */
bool address_code_in_ram(struct processor *p, uint32_t address);
/* Maps the stored flash as memory, which is fast, or as a window to its model. */
void address_map_stored(struct processor *p);
bool address_forbidden(const struct processor *p, uint32_t address);
/* Memory that is no flash: a stack; NULL: not, or not all of it. */
uint8_t *address_data(struct board *b, uint32_t address, uint32_t bytes);

#endif
