/* The core: code is run by the Unicorn library; memory, exceptions, sleep and time are here.
 *
 * Interrupts are taken between blocks of code, never within one. The library does not enforce the protection unit: regions that
 * nobody may reach are taken from the address space. Not modelled: the process stack, unprivileged code, traps of unaligned
 * access, imprecise bus faults (a write that fails is told at once here).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unicorn/unicorn.h>

#include "faults.h"
#include "interrupts.h"
#include "replay.h"
#include "thumb.h"

#define EXC_RETURNS  0xFFFFFF00u
#define EXC_HANDLER  0xFFFFFFF1u
#define EXC_THREAD   0xFFFFFFF9u
#define EXC_NO_FP    0x10u
#define BASIC_WORDS  8u
#define EXTENDED     26u
#define XPSR_THUMB   (UINT32_C(1) << 24)
#define XPSR_IT      0x0600FC00u
#define XPSR_ALIGNED 0x200u
#define WFI          0xBF30u
#define CONTROL_FPCA 4u

#define WINDOWS 4

/* Addresses that go to models. */
struct window {
    struct board *board;
    uint32_t base, size;
    bool stored;
};

struct processor {
    struct board *board;
    struct interrupts *interrupts;
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
    bool divided_by_zero, division_by_step;

    /* of the access that the library could not do */
    bool failed;
    uc_mem_type failed_type;
    uint32_t failed_address, failed_pc;
};

static const struct chip_memory *flash_of(const struct chip *chip)
{
    return &chip->memory[0];
}

static uint32_t get(const struct processor *p, int reg)
{
    uint32_t value = 0;
    (void)uc_reg_read(p->uc, reg, &value);
    return value;
}

static void set(const struct processor *p, int reg, uint32_t value)
{
    (void)uc_reg_write(p->uc, reg, &value);
}

static struct masks masks_of(const struct processor *p)
{
    return (struct masks){.primask = (get(p, UC_ARM_REG_PRIMASK) & 1u) != 0,
                          .faultmask = (get(p, UC_ARM_REG_FAULTMASK) & 1u) != 0,
                          .basepri = (uint8_t)get(p, UC_ARM_REG_BASEPRI)};
}

/* Of the access that is under way within the library. */
static uint32_t access_pc(struct processor *p)
{
    struct board *b = p->board;
    if (p->exact) {
        b->found = p->exact_from != BOARD_NEVER;
        b->found_pc = p->pc;
        if (b->found)
            board_pause(b);
        return p->pc;
    }
    if (p->looked_for != b->cycles) {
        p->looked_for = b->cycles;
        p->looked_pc = p->block;
        p->looked_known = replay_find_pc(b, p->block_began, &p->looked_pc);
    }
    p->pc_known = p->looked_known;
    return p->looked_known ? p->looked_pc : p->block;
}

uint32_t processor_pc(struct board *b)
{
    struct processor *p = b->processor;
    if (p->failed_pc != 0)
        return p->failed_pc;
    return p->running ? access_pc(p) : get(p, UC_ARM_REG_PC) & ~1u;
}

bool processor_pc_is_exact(struct board *b)
{
    (void)processor_pc(b);
    return b->processor->pc_known;
}

uint32_t processor_image_bytes(const struct board *b)
{
    return b->processor->image_bytes;
}

struct interrupts *processor_interrupts(struct board *b)
{
    return b->processor->interrupts;
}

void processor_attend(struct board *b)
{
    b->processor->attend = true;
}

void processor_break(struct board *b)
{
    b->processor->slice_end = 0;
}

/* In the chip's memories from this one on; the flash is the first. */
static uint8_t *memory_from(struct board *b, size_t first, uint32_t address, uint32_t bytes)
{
    for (size_t i = first; i < b->chip->n_memory; i++) {
        const struct chip_memory *m = &b->chip->memory[i];
        if (address >= m->base && bytes <= m->size && address - m->base <= m->size - bytes)
            return b->processor->memory[i] + (address - m->base);
    }
    return NULL;
}

uint8_t *processor_memory(struct board *b, uint32_t address, uint32_t bytes)
{
    return memory_from(b, 0, address, bytes);
}

/* No flash: a stack there is none. */
static uint8_t *data_at(struct board *b, uint32_t address, uint32_t bytes)
{
    return memory_from(b, 1, address, bytes);
}

/* ---- hooks of the library ---- */

/* Instructions of a block: a halfword of 0xE800 and above begins one of two halfwords (PM0214 3, ARMv7-M A5.1). */
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

/* The flash, or its alias at 0. */
static bool in_flash(const struct processor *p, uint32_t address)
{
    const struct chip_memory *flash = flash_of(p->board->chip);
    return address < flash->size || address - flash->base < flash->size;
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
               (p->attend && interrupts_pick(p->interrupts, masks_of(p), false) != 0)) {
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

/* At each division: the library's gives 0 where the core traps (PM0214 4.4.7, DIV_0_TRP). */
static void on_division(uc_engine *uc, uint64_t address, uint32_t bytes, void *context)
{
    struct processor *p = context;
    const uint8_t *code = processor_memory(p->board, (uint32_t)address, 4);
    (void)bytes;
    if (code == NULL || !thumb_divides(code) || !interrupts_divide_traps(p->interrupts))
        return;
    unsigned divisor = code[2] & 15u;
    if (divisor > 12 || get(p, UC_ARM_REG_R0 + (int)divisor) != 0)
        return;
    p->divided_by_zero = true;
    (void)uc_emu_stop(uc);
}

static void on_instruction(uc_engine *uc, uint64_t address, uint32_t bytes, void *context)
{
    struct processor *p = context;
    uint32_t at = (uint32_t)address - flash_of(p->board->chip)->base;
    p->pc = (uint32_t)address;
    if (p->division_by_step && at < p->image_bytes && thumb_divides(p->memory[0] + at))
        on_division(uc, address, bytes, context);
}

static void on_step_end(uc_engine *uc, uint64_t address, uint32_t bytes, void *context)
{
    (void)address;
    (void)bytes;
    (void)context;
    (void)uc_emu_stop(uc);
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

static void on_exception(uc_engine *uc, uint32_t number, void *context)
{
    struct processor *p = context;
    if (number == 8) /* the library's number for a jump to an EXC_RETURN value */
        p->left = true;
    else
        board_verdict(p->board, "the processor library raised its exception %u", number);
    (void)uc_emu_stop(uc);
}

static uint64_t on_read(uc_engine *uc, uint64_t offset, unsigned bytes, void *context)
{
    const struct window *w = context;
    (void)uc;
    return w->stored ? stored_flash_read(w->board, (uint32_t)offset, bytes)
                     : bus_read(w->board, w->base + (uint32_t)offset, bytes);
}

static void on_write(uc_engine *uc, uint64_t offset, unsigned bytes, uint64_t value, void *context)
{
    const struct window *w = context;
    (void)uc;
    if (w->stored)
        w->board->chip->store(w->board, (uint32_t)offset, bytes, (uint32_t)value);
    else
        bus_write(w->board, w->base + (uint32_t)offset, bytes, (uint32_t)value);
}

/* ---- exceptions ---- */

static const int frame_regs[BASIC_WORDS] = {UC_ARM_REG_R0, UC_ARM_REG_R1,  UC_ARM_REG_R2,
                                            UC_ARM_REG_R3, UC_ARM_REG_R12, UC_ARM_REG_LR,
                                            UC_ARM_REG_PC, UC_ARM_REG_XPSR};

static void enter(struct processor *p, unsigned exception, uint32_t return_to);

static void fault(struct processor *p, unsigned exception, uint32_t status, uint32_t address,
                  uint32_t pc)
{
    unsigned n = interrupts_fault(p->interrupts, masks_of(p), exception, status, address);
    if (n == 0) {
        p->locked_up = true; /* until a reset */
        return;
    }
    enter(p, n, pc);
}

static void enter(struct processor *p, unsigned exception, uint32_t return_to)
{
    uint32_t f[EXTENDED], sp = get(p, UC_ARM_REG_SP), control = get(p, UC_ARM_REG_CONTROL);
    bool fp = p->board->chip->fpu && (control & CONTROL_FPCA) != 0;
    bool aligned = interrupts_align_stack(p->interrupts) && (sp & 4u) != 0;
    for (unsigned i = 0; i < BASIC_WORDS; i++)
        f[i] = get(p, frame_regs[i]);
    f[6] = return_to & ~1u;
    f[7] = (f[7] & ~(XPSR_ALIGNED | 0x1FFu)) | (aligned ? XPSR_ALIGNED : 0) |
           interrupts_active(p->interrupts) | XPSR_THUMB;
    for (unsigned i = 0; fp && i < 16; i++)
        f[BASIC_WORDS + i] = get(p, UC_ARM_REG_S0 + (int)i);
    if (fp) {
        f[24] = get(p, UC_ARM_REG_FPSCR);
        f[25] = 0;
    }
    uint32_t bytes = 4u * (fp ? EXTENDED : BASIC_WORDS);
    sp -= bytes + (aligned ? 4u : 0);
    set(p, UC_ARM_REG_SP, sp);
    uint8_t *stack = data_at(p->board, sp, bytes);
    if (stack != NULL)
        (void)memcpy(stack, f, bytes);
    set(p, UC_ARM_REG_LR,
        (interrupts_depth(p->interrupts) > 0 ? EXC_HANDLER : EXC_THREAD) & ~(fp ? EXC_NO_FP : 0));
    set(p, UC_ARM_REG_CONTROL, control & 3u);
    unsigned running = exception;
    if (stack ==
        NULL) { /* the derived fault goes first; what was to be entered stays pending or is lost with it */
        running = interrupts_fault(p->interrupts, masks_of(p), EXCEPTION_BUS_FAULT, CFSR_STKERR, 0);
        if (running == 0) {
            p->locked_up = true;
            return;
        }
    }
    interrupts_enter(p->interrupts, running);
    uint32_t handler = 0, at = interrupts_vectors(p->interrupts) + 4u * running;
    const uint8_t *vector = processor_memory(p->board, at, 4);
    if (vector != NULL)
        (void)memcpy(&handler, vector, 4);
    if ((handler & 1u) == 0) {
        board_verdict(p->board, "exception %u has no handler at 0x%08x", running, at);
        return;
    }
    set(p, UC_ARM_REG_XPSR, XPSR_THUMB | running);
    set(p, UC_ARM_REG_PC, handler);
    p->pc = p->block = handler & ~1u;
}

static void leave(struct processor *p)
{
    uint32_t code = (get(p, UC_ARM_REG_PC) | 1u), f[EXTENDED], sp = get(p, UC_ARM_REG_SP);
    bool fp = (code & EXC_NO_FP) == 0;
    unsigned active = interrupts_active(p->interrupts);
    uint32_t form =
        (code | EXC_NO_FP) & 0xFFFFFFFDu; /* bit 1 may have been lost in the program counter */
    if (active == 0 ||
        (form != (EXC_THREAD & 0xFFFFFFFDu) && form != (EXC_HANDLER & 0xFFFFFFFDu))) {
        board_verdict(p->board, "return from an exception by 0x%08x, which is not modelled", code);
        return;
    }
    const uint8_t *stack = data_at(p->board, sp, 4u * (fp ? EXTENDED : BASIC_WORDS));
    if (stack == NULL) {
        board_verdict(p->board, "return from exception %u with its frame outside memory, at 0x%08x",
                      active, sp);
        return;
    }
    (void)memcpy(f, stack, sizeof(uint32_t) * (fp ? EXTENDED : BASIC_WORDS));
    (void)interrupts_leave(p->interrupts, active);
    if (active != EXCEPTION_NMI)
        set(p, UC_ARM_REG_FAULTMASK, 0);
    for (unsigned i = 0; fp && i < 16; i++)
        set(p, UC_ARM_REG_S0 + (int)i, f[BASIC_WORDS + i]);
    if (fp)
        set(p, UC_ARM_REG_FPSCR, f[24]);
    set(p, UC_ARM_REG_CONTROL, (get(p, UC_ARM_REG_CONTROL) & 3u) | (fp ? CONTROL_FPCA : 0));
    for (unsigned i = 0; i < 6; i++)
        set(p, frame_regs[i], f[i]);
    sp += 4u * (fp ? EXTENDED : BASIC_WORDS) + ((f[7] & XPSR_ALIGNED) != 0 ? 4u : 0);
    set(p, UC_ARM_REG_SP, sp);
    set(p, UC_ARM_REG_XPSR, f[7] & ~XPSR_ALIGNED);
    set(p, UC_ARM_REG_PC, f[6] | 1u);
    p->block = p->pc = f[6];
}

static bool forbidden(const struct processor *p, uint32_t address)
{
    for (size_t i = 0; i < p->n_forbidden; i++)
        if (address - p->forbidden[i].base < p->forbidden[i].size)
            return true;
    return false;
}

static void access_failed(struct processor *p)
{
    struct board *b = p->board;
    uint32_t at = p->failed_address, pc = access_pc(p);
    p->failed_pc = pc;
    bool fetch = p->failed_type == UC_MEM_FETCH_UNMAPPED || p->failed_type == UC_MEM_FETCH_PROT;
    p->failed = false;
    if (forbidden(p, at)) {
        fault(p, EXCEPTION_MEM_MANAGE, fetch ? CFSR_IACCVIOL : CFSR_DACCVIOL | CFSR_MMARVALID, at,
              fetch ? at : pc);
    } else if (p->failed_type == UC_MEM_WRITE_PROT) {
        board_verdict(b, "write to 0x%08x, which is flash that holds the program", at);
    } else if (p->failed_type == UC_MEM_FETCH_PROT) {
        board_verdict(b, "jump to 0x%08x, which is memory for data", at);
    } else {
        fault(p, EXCEPTION_BUS_FAULT, fetch ? CFSR_IBUSERR : CFSR_PRECISERR | CFSR_BFARVALID, at,
              fetch ? at : pc);
    }
    p->failed_pc = 0;
}

/* The protection unit has been set: what is forbidden leaves the address space. Only whole regions of memory, and the alias. */
static void protect(struct processor *p)
{
    struct board *b = p->board;
    p->protection_changed = false;
    const struct chip_memory *flash = flash_of(b->chip);
    uint32_t mapped =
        flash->size - b->chip->stored_size; /* the library refuses a range of which some is not */
    bool ok = uc_mem_protect(p->uc, 0, mapped, UC_PROT_READ | UC_PROT_EXEC) == UC_ERR_OK;
    p->n_forbidden = interrupts_forbidden(p->interrupts, p->forbidden,
                                          sizeof(p->forbidden) / sizeof(p->forbidden[0]));
    for (size_t i = 0; i < p->n_forbidden; i++) {
        const struct forbidden *f = &p->forbidden[i];
        if (f->base != 0 || f->size < flash->size)
            board_verdict(b, "a protected region of %u bytes at 0x%08x is not modelled", f->size,
                          f->base);
        else
            ok = uc_mem_protect(p->uc, 0, mapped, UC_PROT_NONE) == UC_ERR_OK && ok;
    }
    if (!ok)
        board_verdict(b, "the processor library did not protect the first %u bytes", mapped);
}

void processor_protection_changed(struct board *b)
{
    b->processor->protection_changed = true;
    processor_break(b);
}

/* ---- running ---- */

static bool takes_interrupts(const struct processor *p)
{
    return (get(p, UC_ARM_REG_XPSR) & XPSR_IT) ==
           0; /* the library cannot give back a half-done IT block */
}

/* While the flash answers no fetch: code in RAM runs on until an interrupt is taken, whose vector is in the flash. (That a read of data
 * from the flash stops the core as well is not modelled.) */
static bool runs_from_ram(const struct processor *p)
{
    return !p->locked_up && !in_flash(p, get(p, UC_ARM_REG_PC)) &&
           (!takes_interrupts(p) || interrupts_pick(p->interrupts, masks_of(p), false) == 0);
}

/* Nothing runs: time goes on to what comes next. */
static void pass_time(struct board *b, uint64_t until)
{
    struct processor *p = b->processor;
    uint64_t next = board_cycles_at(b, b->next_ns), tick = systick_next(p->interrupts);
    if (tick < next)
        next = tick;
    if (b->stalled_until_ns != 0) {
        uint64_t stalled = board_cycles_at(b, b->stalled_until_ns);
        if (stalled < next)
            next = stalled;
    }
    uint64_t fault_at = faults_next(b, true);
    if (fault_at < next)
        next = fault_at;
    if (until < next)
        next = until;
    if (next > b->cycles)
        b->cycles = next;
}

/* Of the flash and of its alias at 0. */
static void forget_translations(struct processor *p)
{
    const struct chip_memory *flash = flash_of(p->board->chip);
    (void)uc_ctl_remove_cache(p->uc, flash->base, flash->base + flash->size);
    (void)uc_ctl_remove_cache(p->uc, 0, flash->size);
}

static void turn_exact(struct processor *p)
{
    uc_hook hook;
    (void)uc_hook_add(p->uc, &hook, UC_HOOK_CODE, (void *)on_instruction, p, 1, 0);
    forget_translations(p);
    p->exact = true;
}

void processor_exact_from(struct board *b, uint64_t cycle)
{
    b->processor->exact_from = cycle;
}

static uc_err start_library(struct processor *p)
{
    p->running = true;
    p->pc_known = p->exact;
    uc_err e = uc_emu_start(p->uc, get(p, UC_ARM_REG_PC) | 1u, UINT32_MAX - 1u, 0, 0);
    p->running = false;
    p->pc_known = true;
    return e;
}

/* Runs a block up to an instruction. Its translation is made anew with a hook there, and once more without. */
static uc_err step_to(struct processor *p, uint32_t block, uint32_t bytes, uint32_t to)
{
    uc_hook hook;
    if (uc_hook_add(p->uc, &hook, UC_HOOK_CODE, (void *)on_step_end, p, to, to) != UC_ERR_OK)
        return UC_ERR_HOOK;
    (void)uc_ctl_remove_cache(p->uc, block, block + bytes);
    p->stepping = true;
    uc_err e = start_library(p);
    p->stepping = false;
    (void)uc_hook_del(p->uc, hook);
    (void)uc_ctl_remove_cache(p->uc, block, block + bytes);
    return e;
}

/* Runs a block as far as the next fault of the hardware, or as far as an instruction for the unit for numbers while that is off. An
 * IT instruction and those that it governs are one place: where the fault falls among them, it comes before. */
static uc_err run_partly(struct processor *p, uint32_t block, uint32_t bytes)
{
    struct board *b = p->board;
    const uint8_t *code = processor_memory(b, block, bytes);
    uint32_t fpu = p->fpu_on || code == NULL ? bytes : thumb_first_fpu(code, bytes);
    uint32_t room = p->fault_at - b->cycles < bytes ? (uint32_t)(p->fault_at - b->cycles) : bytes;
    uint32_t to = code == NULL ? 0 : thumb_offset(code, bytes, room);
    bool no_fpu = fpu < to || (fpu < bytes && fpu <= to);
    uint32_t place = no_fpu ? fpu : to, governed = code == NULL ? 0 : thumb_it_start(code, place);
    uc_err e = UC_ERR_OK;
    if (governed != 0) {
        uint32_t n = thumb_count(code, governed);
        e = step_to(p, block, bytes, block + governed);
        b->cycles += n;
        b->instructions += n;
    }
    if (e != UC_ERR_OK || p->left || p->failed || p->divided_by_zero)
        return e;
    if (no_fpu) {
        fault(p, EXCEPTION_USAGE_FAULT, CFSR_NOCP, 0, block + place);
        return e;
    }
    faults_run_at_stop(b);
    return e;
}

static void run_code(struct board *b, uint64_t until)
{
    struct processor *p = b->processor;
    uint64_t end = board_cycles_at(b, b->next_ns), tick = systick_next(p->interrupts);
    if (tick < end)
        end = tick;
    if (until < end)
        end = until;
    p->slice_end = end;
    p->first = true;
    p->cut = p->left = p->failed = false;
    p->attend = interrupts_any(p->interrupts);
    p->fault_at = faults_next(b, false);
    if (b->cycles >= p->exact_from && !p->exact)
        turn_exact(p);
    p->partly = 0;
    p->divided_by_zero = false;
    uc_err e = start_library(p);
    if (p->cut)
        set(p, UC_ARM_REG_PC, p->resume | 1u);
    if (p->partly != 0) {
        uint32_t bytes = p->partly;
        p->cut = false;
        e = run_partly(p, p->resume, bytes);
        if (e == UC_ERR_OK && !p->left && !p->failed && !p->divided_by_zero)
            return;
    }
    if (p->left) {
        leave(p);
    } else if (p->divided_by_zero) {
        fault(p, EXCEPTION_USAGE_FAULT, CFSR_DIVBYZERO, 0, get(p, UC_ARM_REG_PC));
    } else if (p->failed) {
        access_failed(p);
    } else if (e == UC_ERR_INSN_INVALID) {
        fault(p, EXCEPTION_USAGE_FAULT, CFSR_UNDEFINSTR, 0, get(p, UC_ARM_REG_PC));
    } else if (e != UC_ERR_OK) {
        board_verdict(b, "the processor library: %s", uc_strerror(e));
    } else if (!p->cut) {
        uint32_t pc = get(p, UC_ARM_REG_PC) & ~1u;
        const uint8_t *before = processor_memory(b, pc - 2u, 2);
        p->sleeping = before != NULL && (before[0] | before[1] << 8) == WFI;
        if (!p->sleeping)
            board_verdict(b, "the processor library came back at 0x%08x for no reason", pc);
    }
}

void processor_run(struct board *b, uint64_t until)
{
    struct processor *p = b->processor;
    while (b->verdict[0] == '\0' && !b->paused && !b->reset_asked && b->cycles < until) {
        board_run_events(b);
        faults_run(b);
        if (b->held) {
            pass_time(b, until);
            continue;
        }
        systick_run(p->interrupts);
        if (b->reset_asked || b->paused)
            break;
        if (b->stalled_until_ns != 0 && board_ns(b) >= b->stalled_until_ns)
            b->stalled_until_ns = 0;
        if (b->stalled_until_ns != 0 && !runs_from_ram(p)) {
            pass_time(b, until);
            continue;
        }
        if (p->protection_changed)
            protect(p);
        if (p->locked_up) {
            pass_time(b, until);
            continue;
        }
        if (p->sleeping) {
            if (interrupts_pick(p->interrupts, masks_of(p), true) == 0) {
                pass_time(b, until);
                continue;
            }
            p->sleeping = false;
        }
        unsigned n = takes_interrupts(p) ? interrupts_pick(p->interrupts, masks_of(p), false) : 0;
        unsigned active = interrupts_active(p->interrupts);
        bool hangs = (b->hang_main && active == 0) || (b->hang_tick && active == EXCEPTION_PENDSV);
        if (n == 0 && hangs)
            pass_time(b, until);
        else if (n != 0)
            enter(p, n, get(p, UC_ARM_REG_PC));
        else
            run_code(b, until);
    }
}

void processor_reset(struct board *b)
{
    struct processor *p = b->processor;
    static const int cleared[] = {UC_ARM_REG_BASEPRI, UC_ARM_REG_PRIMASK, UC_ARM_REG_FAULTMASK,
                                  UC_ARM_REG_CONTROL, UC_ARM_REG_LR};
    uint32_t vector[2];
    (void)memcpy(vector, p->memory[0], sizeof(vector));
    p->fpu_on = false;
    interrupts_reset(p->interrupts);
    p->sleeping = p->locked_up = p->left = p->failed = false;
    p->protection_changed = true;
    for (size_t i = 0; i < sizeof(cleared) / sizeof(cleared[0]); i++)
        set(p, cleared[i], 0);
    set(p, UC_ARM_REG_XPSR, XPSR_THUMB);
    set(p, UC_ARM_REG_SP, vector[0] & ~3u);
    set(p, UC_ARM_REG_PC, vector[1]);
    p->pc = p->block = vector[1] & ~1u;
}

void processor_set_fpu(struct board *b, bool on)
{
    b->processor->fpu_on = on;
}

void processor_flip_register(struct board *b, uint32_t number, uint32_t bit)
{
    static const int names[] = {UC_ARM_REG_R13, UC_ARM_REG_R14, UC_ARM_REG_R15};
    int name = number < 13   ? UC_ARM_REG_R0 + (int)number
               : number < 16 ? names[number - 13u]
                             : UC_ARM_REG_S0 + (int)number - 16;
    struct processor *p = b->processor;
    uint32_t word = get(p, name) ^ UINT32_C(1) << bit;
    set(p, name, name == UC_ARM_REG_R15 ? word | 1u : word);
}

void processor_forget_code(struct board *b)
{
    struct processor *p = b->processor;
    (void)memset(p->counted, 0, flash_of(b->chip)->size / 2u * sizeof(*p->counted));
    forget_translations(p);
}

void processor_scramble(struct board *b)
{
    for (size_t i = 0; i < b->chip->n_memory; i++)
        for (uint32_t k = 0; b->chip->memory[i].kind != MEMORY_FLASH && k < b->chip->memory[i].size;
             k += 4u) {
            uint32_t word = board_random(b);
            (void)memcpy(b->processor->memory[i] + k, &word, 4);
        }
}

/* ---- life ---- */

static bool map_memory(struct board *b, struct processor *p)
{
    for (size_t i = 0; i < b->chip->n_memory; i++) {
        const struct chip_memory *m = &b->chip->memory[i];
        p->memory[i] = aligned_alloc(0x1000, m->size);
        if (p->memory[i] == NULL)
            return false;
        uint32_t size = m->size;
        if (m->kind == MEMORY_FLASH) {
            (void)memset(p->memory[i], 0xFF, size);
            size -=
                b->chip
                    ->stored_size; /* what the firmware writes lies at the end and goes through the flash's model */
            if (uc_mem_map_ptr(p->uc, 0, size, UC_PROT_READ | UC_PROT_EXEC, p->memory[i]) !=
                UC_ERR_OK)
                return false;
        }
        /* The chip fetches from the SRAM as well, and not from the memory next to the core (RM0090 2.1). */
        uint32_t rights = m->kind == MEMORY_FLASH ? UC_PROT_READ | UC_PROT_EXEC
                          : m->kind == MEMORY_RAM ? UC_PROT_ALL
                                                  : UC_PROT_READ | UC_PROT_WRITE;
        if (uc_mem_map_ptr(p->uc, m->base, size, rights, p->memory[i]) != UC_ERR_OK)
            return false;
    }
    return true;
}

static bool map_windows(struct board *b, struct processor *p)
{
    p->windows[0] = (struct window){b, 0x40000000u, 0x00080000u, false};
    p->windows[1] = (struct window){b, 0x50000000u, 0x00061000u, false};
    p->windows[2] = (struct window){b, 0xE0000000u, 0x00100000u, false};
    p->windows[3] = (struct window){b, b->chip->stored_base, b->chip->stored_size, true};
    for (size_t i = 0; i < WINDOWS; i++) {
        struct window *w = &p->windows[i];
        if (uc_mmio_map(p->uc, w->base, w->size, on_read, w, on_write, w) != UC_ERR_OK)
            return false;
    }
    return true;
}

static bool add_hooks(struct processor *p)
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

bool processor_start(struct board *b, const uint8_t *image, size_t image_bytes, bool exact,
                     char *err, size_t err_size)
{
    const struct chip_memory *flash = flash_of(b->chip);
    struct processor *p = calloc(1, sizeof(*p));
    b->processor = p;
    p->board = b;
    p->exact = exact;
    p->counted = calloc(flash->size / 2u, sizeof(*p->counted));
    p->interrupts = interrupts_new(b);
    if (image_bytes > flash->size || image_bytes < 8) {
        (void)snprintf(err, err_size, "an image of %zu bytes; the %s has %u of flash", image_bytes,
                       b->chip->name, flash->size);
        return false;
    }
    if (uc_open(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS, &p->uc) != UC_ERR_OK ||
        uc_ctl_set_cpu_model(p->uc, b->chip->cpu_model) != UC_ERR_OK || !map_memory(b, p) ||
        !map_windows(b, p)) {
        (void)snprintf(err, err_size, "the processor library could not be set up");
        return false;
    }
    (void)memcpy(p->memory[0], image, image_bytes);
    p->image_bytes = (uint32_t)image_bytes;
    p->fault_at = p->exact_from = BOARD_NEVER;
    if (!add_hooks(p)) {
        (void)snprintf(err, err_size, "the processor library took no hooks");
        return false;
    }
    if (b->chip->fpu) { /* the library looks at registers that this core does not have */
        set(p, UC_ARM_REG_C1_C0_2, 0xFu << 20);
        set(p, UC_ARM_REG_FPEXC, 0x40000000u);
    }
    return true;
}

void processor_stop(struct board *b)
{
    struct processor *p = b->processor;
    (void)uc_close(p->uc);
    for (size_t i = 0; i < b->chip->n_memory; i++)
        free(p->memory[i]);
    free(p->counted);
    interrupts_free(p->interrupts);
    free(p);
}
