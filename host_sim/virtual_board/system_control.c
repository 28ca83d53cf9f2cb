/* Registers of the interrupt controller, system control block, SysTick, protection unit and floating-point unit, read in PM0214 Rev 10: 4.2.6
 * to 4.6. The core's debug registers keep what they hold through a reset that is no power-on (RM0090 Rev 21 38.10). The Cortex-M3 has the same
 * system control space but for protection unit and floating-point unit (unverified). MMFAR and BFAR read 0 before the first fault; those of a
 * chip are undefined (4.4.15).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "system_control.h"
#include "models/models.h"

#define AIRCR_KEY   0x05FAu
#define AIRCR_RESET 4u
#define AIRCR_DEBUG 3u /* VECTCLRACTIVE, VECTRESET */
#define CCR_UNALIGN 8u

#define ALL UINT32_MAX
#define NVIC_WORDS(name, at)                                                                       \
    {name "0", at, 0, ALL, 0}, {name "1", (at) + 4, 0, ALL, 0},                                    \
    {                                                                                              \
        name "2", (at) + 8, 0, ALL, 0                                                              \
    }
#define IPR_WORDS(k)                                                                               \
    {"IPR", IPR + 16 * (k), 0, ALL, 0xF0F0F0F0u},                                                  \
        {"IPR", IPR + 16 * (k) + 4, 0, ALL, 0xF0F0F0F0u},                                          \
        {"IPR", IPR + 16 * (k) + 8, 0, ALL, 0xF0F0F0F0u},                                          \
    {                                                                                              \
        "IPR", IPR + 16 * (k) + 12, 0, ALL, 0xF0F0F0F0u                                            \
    }

static const struct reg control_regs[] = {
    {"SYST_CSR", SYST_CSR, 0, 0x00010007u, 0x7u},
    {"SYST_RVR", SYST_RVR, 0, 0x00FFFFFFu, 0x00FFFFFFu},
    {"SYST_CVR", SYST_CVR, 0, ALL, 0},
    NVIC_WORDS("ISER", ISER),
    NVIC_WORDS("ICER", ICER),
    NVIC_WORDS("ISPR", ISPR),
    NVIC_WORDS("ICPR", ICPR),
    IPR_WORDS(0),
    IPR_WORDS(1),
    IPR_WORDS(2),
    IPR_WORDS(3),
    IPR_WORDS(4),
    IPR_WORDS(5),
    {"CPUID", CPUID, 0, ALL, 0},
    {"ICSR", ICSR, 0, 0x9E000000u, 0},
    {"VTOR", VTOR, 0, 0x3FFFFE00u, 0x3FFFFE00u},
    {"AIRCR", AIRCR, 0xFA050000u, 0xFFFF0707u, 0x00000700u},
    {"SCR", SCR, 0, 0x16u, 0x16u},
    {"CCR", CCR, 0, 0x31Bu, 0x31Bu},
    {"SHPR1", SHPR1, 0, 0x00FFFFFFu, 0x00F0F0F0u},
    {"SHPR2", SHPR1 + 4, 0, 0xFF000000u, 0xF0000000u},
    {"SHPR3", SHPR3, 0, 0xFFFF00FFu, 0xF0F000F0u},
    {"SHCSR", SHCSR, 0, 0x0007FD8Bu, 0x00070000u},
    {"CFSR", CFSR, 0, ALL, 0},
    {"HFSR", HFSR, 0, 0xC0000002u, 0},
    {"DFSR", DFSR, 0, 0x1Fu, 0},
    {"MMFAR", MMFAR, 0, ALL, ALL},
    {"BFAR", BFAR, 0, ALL, ALL},
    {"AFSR", AFSR, 0, ALL, 0},
    {"CPACR", CPACR, 0, 0x00F00000u, 0x00F00000u},
    {"MPU_TYPE", MPU_TYPE, 0, ALL, 0},
    {"MPU_CTRL", MPU_CTRL, 0, 0x7u, 0x7u},
    {"MPU_RNR", MPU_RNR, 0, 0xFFu, 0xFFu},
    {"MPU_RBAR", MPU_RBAR, 0, ALL, ALL},
    {"MPU_RASR", MPU_RASR, 0, 0x173FFF3Fu, 0x173FFF3Fu},
    {"DHCSR", DHCSR, 0, ALL, 0},
    {"DEMCR", DEMCR, 0, 0x010F07F1u, 0x010F07F1u},
    {"FPCCR", FPCCR, 0xC0000000u, 0xC000017Bu, 0xC000017Bu},
    {"FPCAR", FPCAR, 0, 0xFFFFFFF8u, 0xFFFFFFF8u},
    {"FPDSCR", FPDSCR, 0, 0x07C00000u, 0x07C00000u},
};

static struct interrupts *of(const struct part *p)
{
    return processor_interrupts(p->board);
}

static void control_start(struct part *p)
{
    of(p)->control = p;
}

static void control_reset(struct part *p, enum board_reset kind)
{
    const struct chip *chip = p->board->chip;
    uint32_t demcr = part_get(p, DEMCR);
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    part_set(p, DEMCR, kind == RESET_POWER ? 0 : demcr);
    part_set(p, CPUID, chip->cpuid);
    part_set(p, CCR, chip->ccr_reset);
    part_set(p, MPU_TYPE, chip->mpu_regions << 8);
}

static uint32_t flags_from(const bool *flags, uint32_t first)
{
    uint32_t word = 0;
    for (uint32_t k = 0; k < 32u && EXCEPTION_IRQ0 + first + k < EXCEPTIONS; k++)
        word |= (flags[EXCEPTION_IRQ0 + first + k] ? UINT32_C(1) : 0) << k;
    return word;
}

static void flags_set(const struct part *p, bool *flags, uint32_t first, uint32_t bits, bool to)
{
    for (uint32_t k = 0; k < 32u; k++) {
        if ((bits >> k & 1u) == 0)
            continue;
        if (first + k >= p->board->chip->interrupts)
            board_verdict(p->board, "the %s has no interrupt %u", p->board->chip->name, first + k);
        else
            flags[EXCEPTION_IRQ0 + first + k] = to;
        interrupts_look_at(of(p), EXCEPTION_IRQ0 + first + k);
    }
    processor_break(p->board);
}

/* Registers of a floating-point unit, on a core that has none. */
static void check_is_there(const struct part *p, uint32_t offset)
{
    if (!p->board->chip->fpu && (offset == CPACR || offset >= FPCCR))
        board_verdict(p->board, "register 0x%03x of the floating-point unit, which the %s has not",
                      offset, p->board->chip->name);
}

static uint32_t control_read(struct part *p, uint32_t offset, uint32_t stored)
{
    struct interrupts *i = of(p);
    uint32_t first = 8u * (offset & 0x7Cu);
    check_is_there(p, offset);
    if (offset >= ISER && offset < ISER + 0x100u)
        return flags_from(i->enabled, first);
    if (offset >= ISPR && offset < ISPR + 0x100u)
        return flags_from(i->pending, first) | flags_from(i->line, first);
    switch (offset) {
    case SYST_CSR:
        part_set(p, offset, stored & ~SYST_COUNTED);
        return stored;
    case SYST_CVR:
        return systick_count(i);
    case ICSR:
        return interrupts_active(i) | (i->depth <= 1 ? UINT32_C(1) << 11 : 0) |
               (i->pending[EXCEPTION_SYSTICK] ? UINT32_C(1) << 26 : 0) |
               (i->pending[EXCEPTION_PENDSV] ? UINT32_C(1) << 28 : 0);
    case MPU_RBAR:
        return (i->region[part_get(p, MPU_RNR) & 15u].base & ~0x1Fu) | part_get(p, MPU_RNR);
    case MPU_RASR:
        return i->region[part_get(p, MPU_RNR) & 15u].attributes;
    default:
        return stored;
    }
}

static void write_icsr(struct interrupts *i, uint32_t word)
{
    if ((word >> 31 & 1u) != 0)
        interrupts_set_pending(i, EXCEPTION_NMI, true);
    if ((word >> 28 & 1u) != 0)
        interrupts_set_pending(i, EXCEPTION_PENDSV, true);
    if ((word >> 27 & 1u) != 0)
        interrupts_set_pending(i, EXCEPTION_PENDSV, false);
    if ((word >> 26 & 1u) != 0)
        interrupts_set_pending(i, EXCEPTION_SYSTICK, true);
    if ((word >> 25 & 1u) != 0)
        interrupts_set_pending(i, EXCEPTION_SYSTICK, false);
    processor_attend(i->board);
}

static void control_write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    struct interrupts *i = of(p);
    uint32_t first = 8u * (offset & 0x7Cu);
    check_is_there(p, offset);
    if (offset >= ISER && offset < ISER + 0x100u) {
        flags_set(p, i->enabled, first, written, offset < ICER);
    } else if (offset >= ISPR && offset < ISPR + 0x100u) {
        flags_set(p, i->pending, first, written, offset < ICPR);
    } else if (offset == SYST_CVR) {
        part_set(p, SYST_CSR, part_get(p, SYST_CSR) & ~SYST_COUNTED);
        i->tick_cleared = true;
        systick_restart(i);
    } else if (offset == SYST_CSR) {
        if (((before ^ written) & (SYST_ENABLE | SYST_CORE)) != 0)
            systick_restart(i);
    } else if (offset == ICSR) {
        write_icsr(i, written);
    } else if (offset == AIRCR) {
        if (written >> 16 != AIRCR_KEY)
            part_set(p, offset, before); /* without the key nothing is written (4.4.5) */
        else if ((written & AIRCR_DEBUG) != 0 || (written >> 8 & 7u) > 3u)
            board_verdict(p->board,
                          "AIRCR of 0x%08x: groups of priorities are not modelled, and "
                          "the debugger's bits stay 0",
                          written);
        else if ((written & AIRCR_RESET) != 0)
            board_ask_reset(p->board, RESET_SOFTWARE);
        part_set(p, offset, (part_get(p, offset) & 0x700u) | 0xFA050000u);
    } else if (offset == CFSR || offset == HFSR || offset == DFSR) {
        part_set(p, offset, before & ~written); /* cleared by ones */
    } else if (offset == MPU_CTRL || offset == MPU_RBAR || offset == MPU_RASR) {
        protection_write(p, offset, written);
    } else if (offset == CPACR) {
        processor_set_fpu(p->board, interrupts_fpu_on(i));
    } else if (offset == CCR && (written & CCR_UNALIGN) != 0) {
        board_verdict(p->board, "traps of unaligned access are not modelled");
    } else if (offset == SCR && written != 0) {
        board_verdict(p->board, "SCR of 0x%x: deep sleep and its like are not modelled", written);
    }
}

/* 4.4.18, 4.5.5 */
static bool only_words(uint32_t offset)
{
    return offset < ISER || (offset >= CPUID && !(offset >= SHPR1 && offset <= SHPR3) &&
                             offset != CFSR && offset != MPU_RASR);
}

const struct part_class system_control_class = {.name = "system control",
                                                .regs = control_regs,
                                                .n_regs =
                                                    sizeof(control_regs) / sizeof(control_regs[0]),
                                                .widths = WIDTH_BYTE | WIDTH_HALF | WIDTH_WORD,
                                                .only_words = only_words,
                                                .start = control_start,
                                                .reset = control_reset,
                                                .read = control_read,
                                                .write = control_write};
