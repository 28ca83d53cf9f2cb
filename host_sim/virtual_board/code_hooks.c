/* Code on its way: counts the instructions of each block, and stops between blocks where something waits.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "core.h"
#include "thumb.h"

/* Instructions of a block: a halfword of 0xE800 and above begins one of two halfwords (thumb.h). */
static uint32_t instructions_in(struct processor *p, uint32_t address, uint32_t bytes)
{
    const struct chip_memory *flash = flash_of(p->board->chip);
    uint32_t at = address - flash->base;
    bool changes = at >= flash->size; /* what lies in RAM is counted anew each time */
    struct counted *c = changes ? NULL : &p->counted[at / 2u];
    if (c != NULL && c->bytes == bytes)
        return c->instructions;
    const uint8_t *code = processor_memory(p->board, address, bytes);
    if (code == NULL)
        return bytes / 2u;
    uint32_t n = thumb_count(code, bytes);
    if (c != NULL)
        *c = (struct counted){.bytes = (uint16_t)bytes, .instructions = (uint16_t)n};
    return n;
}

static bool uses_fpu(struct processor *p, uint32_t address, uint32_t bytes)
{
    const uint8_t *code = processor_memory(p->board, address, bytes);
    return p->board->chip->fpu && code != NULL && thumb_first_fpu(code, bytes) < bytes;
}

static void on_block(uc_engine *uc, uint64_t address, uint32_t bytes, void *context)
{
    struct processor *p = context;
    struct board *b = p->board;
    if (p->stepping)
        return; /* step_to() counts */
    uint32_t n = instructions_in(p, (uint32_t)address, bytes);
    if (b->cycles + n > p->fault_at || (!p->fpu_on && uses_fpu(p, (uint32_t)address, bytes))) {
        p->partly = bytes;
        p->cut = true;
        p->resume = (uint32_t)address;
        (void)uc_emu_stop(uc);
        return;
    }
    if (p->first) {
        p->first = false;
    } else if (b->cycles >= p->slice_end || (b->cycles >= p->exact_from && !p->exact) ||
               (b->stalled_until_ns != 0 && in_flash(p, (uint32_t)address)) ||
               (p->attend && interrupts_pick(p->interrupts, core_masks(p), false) != 0)) {
        p->cut =
            true; /* a stop here comes before the block runs; the library may not have noted where that is */
        p->resume = (uint32_t)address;
        (void)uc_emu_stop(uc);
        return;
    }
    p->block = (uint32_t)address;
    p->block_began = b->cycles;
    b->cycles += n;
    b->instructions += n;
}

/* At each division: the library's gives 0 where the core traps (PM0214 Rev 10 4.4.7, DIV_0_TRP). */
static void on_division(uc_engine *uc, uint64_t address, uint32_t bytes, void *context)
{
    struct processor *p = context;
    const uint8_t *code = processor_memory(p->board, (uint32_t)address, 4);
    (void)bytes;
    if (code == NULL || !thumb_divides(code) || !interrupts_divide_traps(p->interrupts))
        return;
    unsigned divisor = code[2] & 15u;
    if (divisor > 12 || core_get(p, UC_ARM_REG_R0 + (int)divisor) != 0)
        return;
    p->divided_by_zero = true;
    (void)uc_emu_stop(uc);
}

static void on_instruction(uc_engine *uc, uint64_t address, uint32_t bytes, void *context)
{
    struct processor *p = context;
    uint32_t at = (uint32_t)address - flash_of(p->board->chip)->base;
    p->pc = (uint32_t)address;
    if (p->rules.on)
        barrier_rules_instruction(p->board, p->pc,
                                  at < p->image_bytes ? p->memory[0] + at
                                                      : processor_memory(p->board, p->pc, 4));
    if (p->division_by_step && at < p->image_bytes && thumb_divides(p->memory[0] + at))
        on_division(uc, address, bytes, context);
}

static bool on_bad_access(uc_engine *uc, uc_mem_type type, uint64_t address, int size,
                          int64_t value, void *context)
{
    struct processor *p = context;
    (void)uc;
    (void)size;
    (void)value;
    if ((type == UC_MEM_FETCH_UNMAPPED || type == UC_MEM_FETCH_PROT) && address >= EXC_RETURNS) {
        p->left = true;
        return false;
    }
    p->failed = true;
    p->failed_type = type;
    p->failed_address = (uint32_t)address;
    return false;
}

/* The library's numbers: a fetch from where code never is, a jump to an EXC_RETURN value. */
enum { LIBRARY_NO_FETCH = 3, LIBRARY_EXC_RETURN = 8 };

static void on_exception(uc_engine *uc, uint32_t number, void *context)
{
    struct processor *p = context;
    if (number == LIBRARY_EXC_RETURN) {
        p->left = true;
    } else if (number == LIBRARY_NO_FETCH) {
        p->failed = true;
        p->failed_type = UC_MEM_FETCH_UNMAPPED;
        p->failed_address = core_get(p, UC_ARM_REG_PC) & ~1u;
    } else {
        board_verdict(p->board, "the processor library raised its exception %u", number);
    }
    (void)uc_emu_stop(uc);
}

bool code_hooks_add(struct processor *p)
{
    uc_hook hook;
    bool ok = uc_hook_add(p->uc, &hook, UC_HOOK_BLOCK, (void *)on_block, p, 1, 0) == UC_ERR_OK &&
              uc_hook_add(p->uc, &hook, UC_HOOK_MEM_INVALID, (void *)on_bad_access, p, 1, 0) ==
                  UC_ERR_OK &&
              uc_hook_add(p->uc, &hook, UC_HOOK_INTR, (void *)on_exception, p, 1, 0) == UC_ERR_OK;
    const struct chip_memory *flash = flash_of(p->board->chip);
    p->division_by_step = p->exact; /* one hook for all is faster there */
    for (uint32_t at = 0; ok && !p->exact && at + 4u <= p->image_bytes; at += 2u) {
        uint32_t place = flash->base + at;
        if (thumb_divides(p->memory[0] + at))
            ok = uc_hook_add(p->uc, &hook, UC_HOOK_CODE, (void *)on_division, p, place, place) ==
                 UC_ERR_OK;
    }
    if (ok && p->exact)
        ok = uc_hook_add(p->uc, &hook, UC_HOOK_CODE, (void *)on_instruction, p, 1, 0) == UC_ERR_OK;
    return ok;
}

void code_hooks_forget(struct processor *p)
{
    const struct chip_memory *flash = flash_of(p->board->chip);
    (void)uc_ctl_remove_cache(p->uc, flash->base, flash->base + flash->size);
    (void)uc_ctl_remove_cache(p->uc, 0, flash->size);
}

void code_hooks_exact(struct processor *p)
{
    uc_hook hook;
    (void)uc_hook_add(p->uc, &hook, UC_HOOK_CODE, (void *)on_instruction, p, 1, 0);
    code_hooks_forget(p);
    p->exact = true;
}
