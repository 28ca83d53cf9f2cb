/* Reset and clock control of the STM32F405, read in RM0090 Rev 21: 7.1 and 7.2 (resets, clocks), 7.3.1 to 7.3.4 and 7.3.21 (oscillators, PLL,
 * bus clocks, interrupts, reset flags); in DS8626: 5.3.6 (wait states). Enables and their masks: the vendor's SVD file. Bit 29 of
 * RCC_PLLCFGR is reserved and set after a reset (7.3.2).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <string.h>

#include "rcc.h"

enum {
    PLLCFGR = 0x04,
    CFGR = 0x08,
    CIR = 0x0C,
    APB1RSTR = 0x20,
    APB2RSTR = 0x24,
    AHB1ENR = 0x30,
    AHB2ENR = 0x34,
    AHB3ENR = 0x38,
    APB1ENR = 0x40,
    APB2ENR = 0x44,
    BDCR = 0x70,
    CSR = 0x74
};

#define CR_HSION    (UINT32_C(1) << 0)
#define CR_HSEON    (UINT32_C(1) << 16)
#define CR_HSEBYP   (UINT32_C(1) << 18)
#define CR_CSSON    (UINT32_C(1) << 19)
#define CR_PLLON    (UINT32_C(1) << 24)
#define PLL_HSE     (UINT32_C(1) << 22)
#define CIR_CSSF    (UINT32_C(1) << 7)
#define CIR_CSSC    (UINT32_C(1) << 23)
#define CIR_IRQS    0x3F00u
#define AHB1ENR_CCM (UINT32_C(1) << 20)
#define CSR_LSION   (UINT32_C(1) << 0)
#define CSR_LSIRDY  (UINT32_C(1) << 1)
#define CSR_RMVF    (UINT32_C(1) << 24)
#define CSR_BORRST  (UINT32_C(1) << 25)
#define CSR_PINRST  (UINT32_C(1) << 26)
#define CSR_PORRST  (UINT32_C(1) << 27)
#define CSR_SFTRST  (UINT32_C(1) << 28)
#define CSR_IWDGRST (UINT32_C(1) << 29)

/* The crystal starts within 2 ms, the PLL locks within 0.2 ms, the internal oscillator starts within 4 us, of DS8626 (unverified). */
#define CRYSTAL_START_NS 2000000u
#define PLL_LOCK_NS      200000u
#define HSI_START_NS     4000u

static const struct reg regs[] = {
    {"CR", CR, 0x00000083u, 0x0F0FFFFBu, 0x050D00F9u},
    {"PLLCFGR", PLLCFGR, 0x24003010u, 0x0F437FFFu, 0x0F437FFFu},
    {"CFGR", CFGR, 0, 0xFFFFFCFFu, 0xFFFFFCF3u},
    {"CIR", CIR, 0, 0x00BF3FBFu, 0x00003F00u},
    {"APB1RSTR", APB1RSTR, 0, 0x36FEC9FFu, 0x36FEC9FFu},
    {"APB2RSTR", APB2RSTR, 0, 0x00075933u, 0x00075933u},
    {"AHB1ENR", AHB1ENR, 0x00100000u, 0x7E7411FFu, 0x7E7411FFu},
    {"AHB2ENR", AHB2ENR, 0, 0xF1u, 0xF1u},
    {"AHB3ENR", AHB3ENR, 0, 0x1u, 0x1u},
    {"APB1ENR", APB1ENR, 0, 0x36FEC9FFu, 0x36FEC9FFu},
    {"APB2ENR", APB2ENR, 0, 0x00075F33u, 0x00075F33u},
    {"BDCR", BDCR, 0, 0x00018307u, 0x00018305u},
    {"CSR", CSR, 0x0E000000u, 0xFF000003u, 0x01000001u},
};

struct rcc {
    struct board_event crystal, pll, internal;
    uint32_t reset_flags; /* live through every reset but power's */
};

static bool pll_on_crystal(const struct part *p)
{
    return (part_get(p, PLLCFGR) & PLL_HSE) != 0;
}

static uint64_t pll_hz(const struct part *p)
{
    uint32_t c = part_get(p, PLLCFGR);
    uint64_t in = pll_on_crystal(p) ? p->board->around.crystal_hz : board_internal_hz(p->board);
    uint64_t m = c & 63u, n = c >> 6 & 511u, half = (c >> 16 & 3u) + 1u;
    return m < 2 ? 0 : in / m * n / (2u * half) + in % m * n / m / (2u * half);
}

static uint64_t system_hz(const struct part *p)
{
    switch (part_get(p, CFGR) >> 2 & 3u) {
    case 0:
        return board_internal_hz(p->board);
    case 1:
        return p->board->around.crystal_hz;
    default:
        return pll_hz(p);
    }
}

static bool runs_from_crystal(const struct part *p)
{
    uint32_t source = part_get(p, CFGR) >> 2 & 3u;
    return source == 1 || (source == 2 && pll_on_crystal(p));
}

/* 7.2, DS8626 5.3.6: what the buses, the flash, and the regulator take. That a lower supply wants more wait states
 * is not modelled. The regulator takes 144 MHz in scale 2 (unverified). */
static void check_clocks(struct part *p)
{
    struct board *b = p->board;
    uint64_t core = system_hz(p) / ahb_divider(part_get(p, CFGR) >> 4 & 15u);
    uint64_t apb1 = core / apb_divider(part_get(p, CFGR) >> 10 & 7u),
             apb2 = core / apb_divider(part_get(p, CFGR) >> 13 & 7u);
    /* the internal oscillator may be fast by 4.5 %, a crystal not */
    uint64_t most = 168000000u + 168000000u / 20u;
    if (core == 0 || core > most || apb1 > most / 4u || apb2 > most / 2u)
        board_verdict(
            b, "clocks of %llu, %llu and %llu Hz (core, APB1, APB2); at most 168, 42 and 84 MHz",
            (unsigned long long)core, (unsigned long long)apb1, (unsigned long long)apb2);
    uint32_t waits = part_get(bus_part(b, "FLASH"), 0) & 7u;
    if (core > (uint64_t)31500000u * (waits + 1u))
        board_verdict(b, "%llu Hz with %u wait states of the flash; one more for each 30 MHz",
                      (unsigned long long)core, waits);
    if (core > 144000000u + 7200000u && (part_get(bus_part(b, "PWR"), 0) >> 14 & 1u) == 0)
        board_verdict(b, "%llu Hz with the regulator in scale 2; at most 144 MHz",
                      (unsigned long long)core);
}

static void clocks_changed(struct part *p)
{
    uint64_t hz = system_hz(p) / ahb_divider(part_get(p, CFGR) >> 4 & 15u);
    if (hz != 0)
        board_set_core_hz(p->board, hz);
}

static uint64_t bus_hz(struct board *b, const char *bus)
{
    uint32_t cfgr = part_get(bus_part(b, "RCC"), CFGR);
    if (strcmp(bus, "ahb1") == 0)
        return b->core_hz;
    return b->core_hz / apb_divider(strcmp(bus, "apb1") == 0 ? cfgr >> 10 & 7u : cfgr >> 13 & 7u);
}

static bool crystal_ready(struct board *b)
{
    return (part_get(bus_part(b, "RCC"), CR) & CR_HSERDY) != 0;
}

static uint64_t rtc_hz(struct board *b)
{
    uint32_t by = part_get(bus_part(b, "RCC"), CFGR) >> 16 & 31u;
    return by < 2 || !crystal_ready(b) ? 0 : b->around.crystal_hz / by;
}

/* ---- events ---- */

static void switch_over(struct part *p)
{
    if (!clock_switches(p, CFGR))
        return;
    check_clocks(p);
    clocks_changed(p);
}

static void crystal_started(void *context)
{
    struct part *p = context;
    if ((part_get(p, CR) & CR_HSEON) == 0 || p->board->around.crystal_hz == 0)
        return;
    part_set(p, CR, part_get(p, CR) | CR_HSERDY);
    switch_over(p);
}

/* 7.3.2. The internal oscillator may be slow by 8 %, and a crystal is taken for its neighbour. */
static void check_pll(struct part *p, uint64_t in)
{
    uint32_t c = part_get(p, PLLCFGR), m = c & 63u, n = c >> 6 & 511u;
    uint64_t fed = m < 2u ? 0 : in / m, made = fed * n;
    if (n < 50u || n > 432u || fed < 900000u || fed > 2100000u || made < 90000000u ||
        made > 453600000u)
        board_verdict(p->board,
                      "PLL fed with %llu Hz, oscillator at %llu Hz; 1 to 2 MHz and 100 to 432 MHz "
                      "are allowed, by factors of 2 to 63 and 50 to 432",
                      (unsigned long long)fed, (unsigned long long)made);
}

static void pll_locked(void *context)
{
    struct part *p = context;
    uint64_t in = pll_on_crystal(p) ? (crystal_ready(p->board) ? p->board->around.crystal_hz : 0)
                                    : board_internal_hz(p->board);
    if ((part_get(p, CR) & CR_PLLON) == 0 || in == 0)
        return;
    check_pll(p, in);
    part_set(p, CR, part_get(p, CR) | CR_PLLRDY);
    switch_over(p);
}

static void internal_started(void *context)
{
    struct part *p = context;
    if ((part_get(p, CR) & CR_HSION) == 0)
        return;
    part_set(p, CR, part_get(p, CR) | CR_HSIRDY);
    switch_over(p);
}

/* 7.2.7, 7.3.1, 7.3.3: with the security system on, the chip falls back to its own oscillator and raises the NMI, which stays until CSSC clears
 * its flag. The clock security system sees a crystal that fails at once (unverified). Without it a core that ran from the crystal stands still
 * (unverified). */
static void crystal_changes(struct board *b)
{
    struct part *p = bus_part(b, "RCC");
    struct rcc *r = p->state;
    uint32_t cr = part_get(p, CR);
    if (b->around.crystal_hz != 0) {
        if ((cr & CR_HSEON) != 0)
            board_schedule(b, &r->crystal, board_ns(b) + CRYSTAL_START_NS);
        clocks_changed(p);
        return;
    }
    bool was_running = (cr & CR_HSERDY) != 0;
    part_set(p, CR, cr & ~CR_HSERDY);
    if (!was_running)
        return;
    if ((cr & CR_CSSON) == 0) {
        if (runs_from_crystal(p))
            b->stalled_until_ns = BOARD_NEVER - 1u; /* until the watchdog */
        return;
    }
    uint32_t on = 0, off = CR_HSEON | (pll_on_crystal(p) ? CR_PLLRDY : 0);
    if (runs_from_crystal(p)) {
        off |= pll_on_crystal(p) ? CR_PLLON : 0;
        on = CR_HSION | CR_HSIRDY;
        part_set(p, CFGR, part_get(p, CFGR) & ~15u);
    }
    part_set(p, CR, (part_get(p, CR) & ~off) | on);
    part_set(p, CIR, part_get(p, CIR) | CIR_CSSF);
    clocks_changed(p);
    interrupt_nmi(b, true);
}

const struct clocks clocks_f4 = {.bus_hz = bus_hz,
                                 .timer_hz = timer_of_bus_hz,
                                 .rtc_hz = rtc_hz,
                                 .crystal_runs = crystal_ready,
                                 .crystal_changed = crystal_changes};

static void start(struct part *p)
{
    struct rcc *r = p->state;
    r->crystal.due = crystal_started;
    r->pll.due = pll_locked;
    r->internal.due = internal_started;
    r->crystal.context = r->pll.context = r->internal.context = p;
    board_add_event(p->board, &r->crystal);
    board_add_event(p->board, &r->pll);
    board_add_event(p->board, &r->internal);
}

/* 7.1, 7.3.21: a power-on and a brown-out clear the flags of before. The chip pulls its reset pin at every reset (7.1.2), so the pin's flag comes
 * as well (unverified). RCC_BDCR is of the backup domain, whose supply is taken to be the chip's (7.1.3). */
static void reset(struct part *p, enum board_reset kind)
{
    struct rcc *r = p->state;
    static const uint32_t flags[] = {[RESET_POWER] = CSR_PORRST | CSR_BORRST | CSR_PINRST,
                                     [RESET_BROWN_OUT] = CSR_BORRST | CSR_PINRST,
                                     [RESET_PIN] = CSR_PINRST,
                                     [RESET_SOFTWARE] = CSR_SFTRST | CSR_PINRST,
                                     [RESET_WATCHDOG] = CSR_IWDGRST | CSR_PINRST};
    uint32_t bdcr = part_get(p, BDCR);
    bool power = kind == RESET_POWER || kind == RESET_BROWN_OUT;
    r->reset_flags = power ? flags[kind] : r->reset_flags | flags[kind];
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    if (kind != RESET_POWER)
        part_set(p, BDCR, bdcr);
    part_set(p, CSR, r->reset_flags);
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    (void)p;
    return offset == CIR ? stored & ~CIR_CSSC : stored;
}

static void write_cr(struct part *p, uint32_t before, uint32_t written)
{
    struct board *b = p->board;
    struct rcc *r = p->state;
    uint64_t now = board_ns(b);
    uint32_t source = part_get(p, CFGR) >> 2 & 3u, word = part_get(p, CR);
    bool on_internal = source == 0 || (source == 2 && !pll_on_crystal(p));
    if ((before & CR_HSEON) != 0 && ((written ^ before) & CR_HSEBYP) != 0)
        board_verdict(b, "RCC_CR_HSEBYP changed while the crystal is on");
    if ((written & CR_HSEON) == 0 && (before & CR_HSEON) != 0) {
        if (runs_from_crystal(p))
            word |= CR_HSEON; /* what is used cannot be switched off, here and below (7.3.1) */
        else
            word &= ~CR_HSERDY;
    }
    if ((written & ~before & CR_HSEON) != 0)
        board_schedule(b, &r->crystal, now + CRYSTAL_START_NS);
    if ((written & CR_PLLON) == 0 && (before & CR_PLLON) != 0)
        word = source == 2 ? word | CR_PLLON : word & ~CR_PLLRDY;
    if ((written & ~before & CR_PLLON) != 0)
        board_schedule(b, &r->pll, now + PLL_LOCK_NS);
    if ((written & CR_HSION) == 0 && (before & CR_HSION) != 0)
        word = on_internal ? word | CR_HSION : word & ~CR_HSIRDY;
    if ((written & ~before & CR_HSION) != 0)
        board_schedule(b, &r->internal, now + HSI_START_NS);
    part_set(p, CR, word);
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    uint32_t word = part_get(p, offset);
    if (offset == CR) {
        write_cr(p, before, written);
    } else if (offset == PLLCFGR && (part_get(p, CR) & CR_PLLON) != 0 && word != before) {
        board_verdict(p->board, "write of RCC_PLLCFGR while the PLL is on");
    } else if (offset == CFGR) {
        switch_over(p);
        check_clocks(p);
        clocks_changed(p);
    } else if (offset == AHB1ENR && (written & AHB1ENR_CCM) == 0) {
        board_verdict(p->board, "core-coupled memory without its clock is not modelled");
    } else if (offset == CIR) {
        if ((written & CIR_CSSC) != 0) {
            part_set(p, CIR, part_get(p, CIR) & ~CIR_CSSF);
            interrupt_nmi(p->board, false);
        }
        if ((part_get(p, CIR) & CIR_IRQS) != 0)
            board_verdict(p->board, "interrupts of the RCC are not modelled");
    } else if (offset == APB1RSTR || offset == APB2RSTR) {
        /* 7.3.8, 7.3.9. Converters share one bit (unverified). */
        reset_parts(p, offset, offset + (APB1ENR - APB1RSTR));
    } else if (offset == CSR) {
        struct rcc *r = p->state;
        if ((written & CSR_RMVF) != 0)
            r->reset_flags = 0;
        part_set(p, CSR,
                 r->reset_flags | ((written & CSR_LSION) != 0 ? CSR_LSION | CSR_LSIRDY : 0));
    }
}

const struct part_class rcc_f4_class = {.name = "RCC of the STM32F4",
                                        .regs = regs,
                                        .n_regs = sizeof(regs) / sizeof(regs[0]),
                                        .state_bytes = sizeof(struct rcc),
                                        .widths = WIDTH_BYTE | WIDTH_HALF | WIDTH_WORD,
                                        .start = start,
                                        .reset = reset,
                                        .read = read,
                                        .write = write};
