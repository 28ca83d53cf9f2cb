/* Entry to exceptions and return from them: the frame on the stack, with the floating-point registers where they are in use, faults, lock-up.
 * Read in PM0214 Rev 10: 2.3.7, 2.4, 4.4.10 to 4.4.13. The registers of a floating-point frame are stored at entry, not when they are needed.
 * Not modelled: the process stack, unprivileged code, imprecise bus faults (a write that fails is told at once here).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <string.h>

#include "core.h"

#define NS_PER_MS UINT64_C(1000000)

#define EXC_HANDLER  0xFFFFFFF1u
#define EXC_THREAD   0xFFFFFFF9u
#define EXC_NO_FP    0x10u
#define BASIC_WORDS  8u
#define EXTENDED     26u
#define XPSR_ALIGNED 0x200u
#define CONTROL_FPCA 4u
/* The library has it although an Armv7-M core lacks it (SFPA of Armv8-M): with it off, the next instruction for numbers makes FPSCR anew, and
 * the result of a comparison is gone that had been made before the exception. */
#define CONTROL_LIBRARY_FP 8u

static const int frame_regs[BASIC_WORDS] = {UC_ARM_REG_R0, UC_ARM_REG_R1,  UC_ARM_REG_R2,
                                            UC_ARM_REG_R3, UC_ARM_REG_R12, UC_ARM_REG_LR,
                                            UC_ARM_REG_PC, UC_ARM_REG_XPSR};

void exception_fault(struct processor *p, unsigned exception, uint32_t status, uint32_t address,
                     uint32_t pc)
{
    unsigned n = interrupts_fault(p->interrupts, core_masks(p), exception, status, address);
    if (n == 0) {
        p->locked_up = true; /* until a reset or an NMI (2.4.4) */
        return;
    }
    exception_enter(p, n, pc);
}

/* Where the firmware's clock was 0: not a moment later because this interrupt had to wait, but later where milliseconds were lost. */
static void clock_ticks(struct board *b)
{
    uint64_t began_ns = board_ns(b) - ++b->clock_ms * NS_PER_MS;
    bool waited =
        began_ns > b->clock_began_ns && began_ns - b->clock_began_ns < NS_PER_MS / 10u * 9u;
    if (!waited || b->clock_ms == 1u)
        b->clock_began_ns = began_ns;
}

void exception_enter(struct processor *p, unsigned exception, uint32_t return_to)
{
    uint32_t f[EXTENDED], sp = core_get(p, UC_ARM_REG_SP),
                          control = core_get(p, UC_ARM_REG_CONTROL);
    if (exception == EXCEPTION_SYSTICK)
        clock_ticks(p->board);
    bool fp = p->board->chip->fpu && (control & CONTROL_FPCA) != 0;
    bool aligned = interrupts_align_stack(p->interrupts) && (sp & 4u) != 0;
    for (unsigned i = 0; i < BASIC_WORDS; i++)
        f[i] = core_get(p, frame_regs[i]);
    f[6] = return_to & ~1u;
    f[7] = (f[7] & ~(XPSR_ALIGNED | 0x1FFu)) | (aligned ? XPSR_ALIGNED : 0) |
           interrupts_active(p->interrupts) | XPSR_THUMB;
    for (unsigned i = 0; fp && i < 16; i++)
        f[BASIC_WORDS + i] = core_get(p, UC_ARM_REG_S0 + (int)i);
    if (fp) {
        f[24] = core_get(p, UC_ARM_REG_FPSCR);
        f[25] = 0;
    }
    uint32_t bytes = 4u * (fp ? EXTENDED : BASIC_WORDS);
    sp -= bytes + (aligned ? 4u : 0);
    core_set(p, UC_ARM_REG_SP, sp);
    uint8_t *stack = address_data(p->board, sp, bytes);
    if (stack != NULL)
        (void)memcpy(stack, f, bytes);
    core_set(p, UC_ARM_REG_LR,
             (interrupts_depth(p->interrupts) > 0 ? EXC_HANDLER : EXC_THREAD) &
                 ~(fp ? EXC_NO_FP : 0));
    core_set(p, UC_ARM_REG_CONTROL, control & 3u);
    unsigned running = exception;
    if (stack ==
        NULL) { /* the derived fault goes first; what was to be entered stays pending or is lost with it */
        running =
            interrupts_fault(p->interrupts, core_masks(p), EXCEPTION_BUS_FAULT, CFSR_STKERR, 0);
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
    core_set(p, UC_ARM_REG_XPSR, XPSR_THUMB | running);
    core_set(p, UC_ARM_REG_PC, handler);
    p->pc = p->block = handler & ~1u;
}

void exception_leave(struct processor *p)
{
    uint32_t code = (core_get(p, UC_ARM_REG_PC) | 1u), f[EXTENDED], sp = core_get(p, UC_ARM_REG_SP);
    bool fp = (code & EXC_NO_FP) == 0;
    unsigned active = interrupts_active(p->interrupts);
    uint32_t form =
        (code | EXC_NO_FP) & 0xFFFFFFFDu; /* bit 1 may have been lost in the program counter */
    if (active == 0 ||
        (form != (EXC_THREAD & 0xFFFFFFFDu) && form != (EXC_HANDLER & 0xFFFFFFFDu))) {
        board_verdict(p->board, "return from an exception by 0x%08x, which is not modelled", code);
        return;
    }
    const uint8_t *stack = address_data(p->board, sp, 4u * (fp ? EXTENDED : BASIC_WORDS));
    if (stack == NULL) {
        board_verdict(p->board, "return from exception %u with its frame outside memory, at 0x%08x",
                      active, sp);
        return;
    }
    (void)memcpy(f, stack, sizeof(uint32_t) * (fp ? EXTENDED : BASIC_WORDS));
    (void)interrupts_leave(p->interrupts, active);
    if (active != EXCEPTION_NMI)
        core_set(p, UC_ARM_REG_FAULTMASK, 0);
    for (unsigned i = 0; fp && i < 16; i++)
        core_set(p, UC_ARM_REG_S0 + (int)i, f[BASIC_WORDS + i]);
    if (fp)
        core_set(p, UC_ARM_REG_FPSCR, f[24]);
    core_set(p, UC_ARM_REG_CONTROL,
             (core_get(p, UC_ARM_REG_CONTROL) & 3u) | (fp ? CONTROL_FPCA | CONTROL_LIBRARY_FP : 0));
    for (unsigned i = 0; i < 6; i++)
        core_set(p, frame_regs[i], f[i]);
    sp += 4u * (fp ? EXTENDED : BASIC_WORDS) + ((f[7] & XPSR_ALIGNED) != 0 ? 4u : 0);
    core_set(p, UC_ARM_REG_SP, sp);
    core_set(p, UC_ARM_REG_XPSR, f[7] & ~XPSR_ALIGNED);
    core_set(p, UC_ARM_REG_PC, f[6] | 1u);
    p->block = p->pc = f[6];
}

/* Peripherals, devices and the core's own space hold no code, with and without protection unit, PM0214 2.2.1 (unverified). */
static bool never_executes(uint32_t address)
{
    return address >= 0xA0000000u || (address >= 0x40000000u && address < 0x60000000u);
}

void exception_of_access(struct processor *p)
{
    struct board *b = p->board;
    uint32_t at = p->failed_address, pc = core_access_pc(p);
    p->failed_pc = pc;
    bool fetch = p->failed_type == UC_MEM_FETCH_UNMAPPED || p->failed_type == UC_MEM_FETCH_PROT;
    p->failed = false;
    if (address_forbidden(p, at) || (fetch && never_executes(at))) {
        exception_fault(p, EXCEPTION_MEM_MANAGE,
                        fetch ? CFSR_IACCVIOL : CFSR_DACCVIOL | CFSR_MMARVALID, at,
                        fetch ? at : pc);
    } else if (p->failed_type == UC_MEM_WRITE_PROT) {
        board_verdict(b, "write to 0x%08x, flash that holds the program or is locked", at);
    } else if (p->failed_type == UC_MEM_FETCH_PROT && address_code_in_ram(p, at)) {
        core_set(p, UC_ARM_REG_PC, at | 1u);
    } else if (p->failed_type == UC_MEM_FETCH_PROT) {
        board_verdict(b, "jump to 0x%08x, which is memory for data", at);
    } else {
        exception_fault(p, EXCEPTION_BUS_FAULT,
                        fetch ? CFSR_IBUSERR : CFSR_PRECISERR | CFSR_BFARVALID, at,
                        fetch ? at : pc);
    }
    p->failed_pc = 0;
}
