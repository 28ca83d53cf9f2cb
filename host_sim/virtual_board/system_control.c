/* Interrupt controller, system control block, SysTick, protection unit: PM0214 4, PM0056 4 and the ARMv7-M manual (DDI 0403), from
 * memory of those documents where docs/inside/boards.md says "unverified". Cycle counter: DDI 0403 C1.8.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdlib.h>
#include <string.h>

#include "interrupts.h"
#include "models/models.h"

#define EXCEPTIONS 128u
#define DEPTH      16u
#define LOWEST     256

#define SYST_ENABLE    1u
#define SYST_INTERRUPT 2u
#define SYST_CORE      4u
#define SYST_COUNTED   (UINT32_C(1) << 16)
#define AIRCR_KEY      0x05FAu
#define AIRCR_RESET    4u
#define HFSR_FORCED    (UINT32_C(1) << 30)
#define SHCSR_ENABLED(exception)                                                                   \
    (UINT32_C(1) << (12u + (exception))) /* MemManage 16, BusFault 17, UsageFault 18 */
#define CCR_DIVIDE    (UINT32_C(1) << 4)
#define CCR_ALIGN     (UINT32_C(1) << 9)
#define MPU_ON        1u
#define MPU_REGION_ON 1u

enum {
    SYST_CSR = 0x010,
    SYST_RVR = 0x014,
    SYST_CVR = 0x018,
    SYST_CALIB = 0x01C,
    ISER = 0x100,
    ICER = 0x180,
    ISPR = 0x200,
    ICPR = 0x280,
    IABR = 0x300,
    IPR = 0x400,
    CPUID = 0xD00,
    ICSR = 0xD04,
    VTOR = 0xD08,
    AIRCR = 0xD0C,
    SCR = 0xD10,
    CCR = 0xD14,
    SHPR1 = 0xD18,
    SHPR3 = 0xD20,
    SHCSR = 0xD24,
    CFSR = 0xD28,
    HFSR = 0xD2C,
    DFSR = 0xD30,
    MMFAR = 0xD34,
    BFAR = 0xD38,
    AFSR = 0xD3C,
    CPACR = 0xD88,
    MPU_TYPE = 0xD90,
    MPU_CTRL = 0xD94,
    MPU_RNR = 0xD98,
    MPU_RBAR = 0xD9C,
    MPU_RASR = 0xDA0,
    DHCSR = 0xDF0,
    DEMCR = 0xDFC,
    FPCCR = 0xF34,
    FPCAR = 0xF38,
    FPDSCR = 0xF3C
};

struct interrupts {
    struct board *board;
    struct part *control; /* registers */
    bool pending[EXCEPTIONS], line[EXCEPTIONS], enabled[EXCEPTIONS];
    uint64_t asking[EXCEPTIONS / 64]; /* pending or high, and enabled: a bit each */
    unsigned active[DEPTH], depth;
    uint64_t tick_next; /* cycles at which SysTick comes to 0 */
    struct {
        uint32_t base, attributes;
    } region[16];
};

struct interrupts *interrupts_new(struct board *b)
{
    struct interrupts *i = calloc(1, sizeof(*i));
    i->board = b;
    i->tick_next = BOARD_NEVER;
    return i;
}

void interrupts_free(struct interrupts *i)
{
    free(i);
}

void interrupts_reset(struct interrupts *i)
{
    (void)memset(i->pending, 0, sizeof(i->pending));
    (void)memset(i->line, 0, sizeof(i->line));
    (void)memset(i->asking, 0, sizeof(i->asking));
    (void)memset(i->enabled, 0, sizeof(i->enabled));
    (void)memset(i->region, 0, sizeof(i->region));
    i->depth = 0;
    i->tick_next = BOARD_NEVER;
}

static uint32_t reg(const struct interrupts *i, uint32_t offset)
{
    return part_get(i->control, offset);
}

/* ---- priorities (DDI 0403 B1.5.4) ---- */

static int priority(const struct interrupts *i, unsigned exception)
{
    static const int fixed[] = {0, -3, -2, -1};
    if (exception < 4)
        return fixed[exception];
    uint32_t word = exception < EXCEPTION_IRQ0 ? reg(i, SHPR1 + ((exception - 4u) & ~3u))
                                               : reg(i, IPR + ((exception - 16u) & ~3u));
    return (int)(word >> 8u * (exception & 3u) & 0xFFu);
}

static int execution_priority(const struct interrupts *i, struct masks masks)
{
    int now = LOWEST;
    for (unsigned k = 0; k < i->depth; k++) {
        int p = priority(i, i->active[k]);
        now = p < now ? p : now;
    }
    if (masks.basepri != 0 && masks.basepri < now)
        now = masks.basepri;
    if (masks.primask && now > 0)
        now = 0;
    if (masks.faultmask && now > -1)
        now = -1;
    return now;
}

/* After a change of what makes it ask. */
static void look_at(struct interrupts *i, unsigned n)
{
    uint64_t bit = UINT64_C(1) << (n & 63u);
    if ((i->pending[n] || i->line[n]) && (n < EXCEPTION_IRQ0 || i->enabled[n]))
        i->asking[n / 64u] |= bit;
    else
        i->asking[n / 64u] &= ~bit;
}

static void set_pending(struct interrupts *i, unsigned n, bool to)
{
    i->pending[n] = to;
    look_at(i, n);
}

static bool is_active(const struct interrupts *i, unsigned n)
{
    for (unsigned k = 0; k < i->depth; k++)
        if (i->active[k] == n)
            return true;
    return false;
}

bool interrupts_any(const struct interrupts *i)
{
    return (i->asking[0] | i->asking[1]) != 0;
}

unsigned interrupts_pick(const struct interrupts *i, struct masks masks, bool asleep)
{
    if (!interrupts_any(i))
        return 0;
    if (asleep)
        masks.primask = false;
    int best = execution_priority(i, masks);
    unsigned found = 0;
    for (unsigned word = 0; word < EXCEPTIONS / 64u; word++) {
        for (uint64_t left = i->asking[word]; left != 0; left &= left - 1u) {
            unsigned n = 64u * word + (unsigned)__builtin_ctzll(left);
            if (priority(i, n) < best && !is_active(i, n)) {
                best = priority(i, n);
                found = n;
            }
        }
    }
    return found;
}

void interrupts_enter(struct interrupts *i, unsigned exception)
{
    set_pending(i, exception, false);
    if (i->depth == DEPTH)
        board_verdict(i->board, "exceptions are nested %u deep", DEPTH);
    else
        i->active[i->depth++] = exception;
}

bool interrupts_leave(struct interrupts *i, unsigned exception)
{
    if (i->depth == 0 || i->active[i->depth - 1u] != exception)
        return false;
    i->depth--;
    return true;
}

unsigned interrupts_active(const struct interrupts *i)
{
    return i->depth > 0 ? i->active[i->depth - 1u] : 0;
}

unsigned interrupts_depth(const struct interrupts *i)
{
    return i->depth;
}

/* DDI 0403 B1.5.6 and B1.5.14: a fault that may not interrupt becomes a hard fault; one within a hard fault locks up. */
unsigned interrupts_fault(struct interrupts *i, struct masks masks, unsigned exception,
                          uint32_t status, uint32_t address)
{
    part_set(i->control, CFSR, reg(i, CFSR) | status);
    if ((status & CFSR_MMARVALID) != 0)
        part_set(i->control, MMFAR, address);
    if ((status & CFSR_BFARVALID) != 0)
        part_set(i->control, BFAR, address);
    int now = execution_priority(i, masks);
    if ((reg(i, SHCSR) & SHCSR_ENABLED(exception)) != 0 && priority(i, exception) < now)
        return exception;
    if (now <= -1)
        return 0;
    part_set(i->control, HFSR, reg(i, HFSR) | HFSR_FORCED);
    return EXCEPTION_HARD_FAULT;
}

uint32_t interrupts_vectors(const struct interrupts *i)
{
    uint32_t at = reg(i, VTOR);
    return at != 0 ? at : i->board->chip->memory[0].base; /* address 0 is the flash once more */
}

bool interrupts_align_stack(const struct interrupts *i)
{
    return (reg(i, CCR) & CCR_ALIGN) != 0;
}

bool interrupts_divide_traps(const struct interrupts *i)
{
    return (reg(i, CCR) & CCR_DIVIDE) != 0;
}

bool interrupts_fpu_on(const struct interrupts *i)
{
    return (reg(i, CPACR) >> 20 & 0xFu) == 0xFu;
}

void interrupt_line(struct board *b, unsigned irq, bool high)
{
    struct interrupts *i = processor_interrupts(b);
    i->line[EXCEPTION_IRQ0 + irq] = high;
    look_at(i, EXCEPTION_IRQ0 + irq);
    if (high)
        processor_attend(b);
}

void interrupt_nmi(struct board *b)
{
    set_pending(processor_interrupts(b), EXCEPTION_NMI, true);
    processor_attend(b);
}

/* ---- protection unit ---- */

/* PM0214 4.2: a region is 2^(SIZE + 1) bytes; access permission 0 is none at all. */
size_t interrupts_forbidden(const struct interrupts *i, struct forbidden *list, size_t n)
{
    size_t found = 0;
    if ((reg(i, MPU_CTRL) & MPU_ON) == 0)
        return 0;
    for (uint32_t k = 0; k < i->board->chip->mpu_regions && found < n; k++) {
        uint32_t a = i->region[k].attributes;
        if ((a & MPU_REGION_ON) == 0)
            continue;
        if ((a >> 24 & 7u) != 0 || (a >> 8 & 0xFFu) != 0) {
            board_verdict(
                i->board,
                "region %u of the protection unit is of a form that is not modelled (0x%08x)", k,
                a);
            return 0;
        }
        list[found++] = (struct forbidden){.base = i->region[k].base & ~0x1Fu,
                                           .size = UINT32_C(2) << (a >> 1 & 0x1Fu)};
    }
    return found;
}

/* ---- SysTick ---- */

static uint64_t tick_period(const struct interrupts *i)
{
    return ((uint64_t)reg(i, SYST_RVR) + 1u) * ((reg(i, SYST_CSR) & SYST_CORE) != 0 ? 1u : 8u);
}

uint64_t systick_next(const struct interrupts *i)
{
    return i->tick_next;
}

void systick_run(struct interrupts *i)
{
    while (i->tick_next <= i->board->cycles) {
        i->tick_next += tick_period(i);
        part_set(i->control, SYST_CSR, reg(i, SYST_CSR) | SYST_COUNTED);
        if ((reg(i, SYST_CSR) & SYST_INTERRUPT) != 0)
            set_pending(i, EXCEPTION_SYSTICK, true);
    }
}

static uint32_t tick_count(const struct interrupts *i)
{
    if (i->tick_next == BOARD_NEVER)
        return 0;
    uint64_t left = i->tick_next - i->board->cycles;
    return i->tick_next < i->board->cycles
               ? 0
               : (uint32_t)(left / ((reg(i, SYST_CSR) & SYST_CORE) != 0 ? 1u : 8u));
}

static void tick_restart(struct interrupts *i)
{
    bool on = (reg(i, SYST_CSR) & SYST_ENABLE) != 0 && reg(i, SYST_RVR) != 0;
    i->tick_next = on ? i->board->cycles + tick_period(i) : BOARD_NEVER;
    processor_break(i->board);
}

/* ---- registers ---- */

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
    {"SYST_CALIB", SYST_CALIB, 0x40000000u, ALL, 0},
    NVIC_WORDS("ISER", ISER),
    NVIC_WORDS("ICER", ICER),
    NVIC_WORDS("ISPR", ISPR),
    NVIC_WORDS("ICPR", ICPR),
    NVIC_WORDS("IABR", IABR),
    IPR_WORDS(0),
    IPR_WORDS(1),
    IPR_WORDS(2),
    IPR_WORDS(3),
    IPR_WORDS(4),
    IPR_WORDS(5),
    {"CPUID", CPUID, 0, ALL, 0},
    {"ICSR", ICSR, 0, 0x9E000000u, 0},
    {"VTOR", VTOR, 0, 0xFFFFFF80u, 0x3FFFFF80u},
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
    (void)kind;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
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
        look_at(of(p), EXCEPTION_IRQ0 + first + k);
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
        return tick_count(i);
    case ICSR:
        return interrupts_active(i) | (i->depth == 1 ? UINT32_C(1) << 11 : 0) |
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
        set_pending(i, EXCEPTION_NMI, true);
    if ((word >> 28 & 1u) != 0)
        set_pending(i, EXCEPTION_PENDSV, true);
    if ((word >> 27 & 1u) != 0)
        set_pending(i, EXCEPTION_PENDSV, false);
    if ((word >> 26 & 1u) != 0)
        set_pending(i, EXCEPTION_SYSTICK, true);
    if ((word >> 25 & 1u) != 0)
        set_pending(i, EXCEPTION_SYSTICK, false);
    processor_attend(i->board);
}

static void write_mpu(struct part *p, struct interrupts *i, uint32_t offset, uint32_t word)
{
    uint32_t number = part_get(p, MPU_RNR);
    if (p->board->chip->mpu_regions == 0 || number >= p->board->chip->mpu_regions) {
        board_verdict(p->board, "the protection unit has no region %u", number);
        return;
    }
    if (offset == MPU_RBAR && (word & 0x10u) != 0)
        board_verdict(p->board, "a region number within MPU_RBAR is not modelled");
    else if (offset == MPU_RBAR)
        i->region[number].base = word;
    else if (offset == MPU_RASR)
        i->region[number].attributes = word;
    processor_protection_changed(p->board);
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
        tick_restart(i);
    } else if (offset == SYST_CSR) {
        if (((before ^ written) & (SYST_ENABLE | SYST_CORE)) != 0)
            tick_restart(i);
    } else if (offset == ICSR) {
        write_icsr(i, written);
    } else if (offset == AIRCR) {
        if (written >> 16 != AIRCR_KEY)
            part_set(p, offset, before); /* without the key nothing is written */
        else if ((written & AIRCR_RESET) != 0)
            board_ask_reset(p->board, RESET_SOFTWARE);
        part_set(p, offset, (part_get(p, offset) & 0x700u) | 0xFA050000u);
    } else if (offset == CFSR || offset == HFSR || offset == DFSR) {
        part_set(p, offset, before & ~written); /* cleared by ones */
    } else if (offset == MPU_CTRL || offset == MPU_RBAR || offset == MPU_RASR) {
        write_mpu(p, i, offset, written);
    } else if (offset == CPACR) {
        processor_set_fpu(p->board, interrupts_fpu_on(i));
    } else if (offset == SCR && (written & 0x4u) != 0) {
        board_verdict(p->board, "deep sleep is not modelled");
    }
}

const struct part_class system_control_class = {.name = "system control",
                                                .regs = control_regs,
                                                .n_regs =
                                                    sizeof(control_regs) / sizeof(control_regs[0]),
                                                .widths = WIDTH_BYTE | WIDTH_HALF | WIDTH_WORD,
                                                .start = control_start,
                                                .reset = control_reset,
                                                .read = control_read,
                                                .write = control_write};

/* ---- cycle counter: counts once the trace unit is on (DEMCR_TRCENA) ---- */

enum { DWT_CTRL = 0, DWT_CYCCNT = 4 };

static const struct reg trace_regs[] = {{"CTRL", DWT_CTRL, 0x40000000u, ALL, 0x1u},
                                        {"CYCCNT", DWT_CYCCNT, 0, ALL, ALL}};

struct trace {
    uint64_t zero; /* cycles at which the counter was 0 */
};

static uint32_t trace_read(struct part *p, uint32_t offset, uint32_t stored)
{
    const struct trace *t = p->state;
    bool counts = (part_get(p, DWT_CTRL) & 1u) != 0;
    return offset == DWT_CYCCNT && counts ? (uint32_t)(p->board->cycles - t->zero) : stored;
}

static void trace_write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    struct trace *t = p->state;
    if ((part_get(of(p)->control, DEMCR) >> 24 & 1u) == 0)
        board_verdict(p->board, "write of DWT while DEMCR_TRCENA is off");
    if (offset == DWT_CYCCNT)
        t->zero = p->board->cycles - written;
    else if ((written & ~before & 1u) != 0)
        t->zero = p->board->cycles - part_get(p, DWT_CYCCNT);
    else if ((before & ~written & 1u) != 0)
        part_set(p, DWT_CYCCNT, (uint32_t)(p->board->cycles - t->zero));
}

const struct part_class trace_class = {.name = "cycle counter",
                                       .regs = trace_regs,
                                       .n_regs = 2,
                                       .widths = WIDTH_WORD,
                                       .state_bytes = sizeof(struct trace),
                                       .read = trace_read,
                                       .write = trace_write};
