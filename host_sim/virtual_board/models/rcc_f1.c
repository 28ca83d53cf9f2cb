/* Reset and clock control of the STM32F100, read in RM0041 Rev 6: 6.1 and 6.2 (resets, clocks), 6.3.1 to 6.3.3 and 6.3.8 to 6.3.12
 * (oscillators, PLL, bus clocks, interrupts, enables, backup domain, reset flags). Masks of 6.3.4 to 6.3.7: table 15.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <string.h>

#include "rcc.h"

enum {
    CFGR = 0x04,
    CIR = 0x08,
    APB2RSTR = 0x0C,
    APB1RSTR = 0x10,
    AHBENR = 0x14,
    APB2ENR = 0x18,
    APB1ENR = 0x1C,
    BDCR = 0x20,
    CSR = 0x24,
    CFGR2 = 0x2C
};

#define CR_HSION     (UINT32_C(1) << 0)
#define CR_HSEON     (UINT32_C(1) << 16)
#define CR_HSEBYP    (UINT32_C(1) << 18)
#define CR_CSSON     (UINT32_C(1) << 19)
#define CR_PLLON     (UINT32_C(1) << 24)
#define CFGR_PLLSRC  (UINT32_C(1) << 16)
#define CFGR_PREDIV  (UINT32_C(1) << 17) /* bit 0 of CFGR2 once more */
#define CFGR_PLL     (CFGR_PLLSRC | CFGR_PREDIV | UINT32_C(15) << 18)
#define CIR_CSSF     (UINT32_C(1) << 7)
#define CIR_CSSC     (UINT32_C(1) << 23)
#define BDCR_LSE     0x7u
#define BDCR_RTCSEL  0x300u
#define BDCR_RTCEN   (UINT32_C(1) << 15)
#define BDCR_BDRST   (UINT32_C(1) << 16)
#define CSR_LSION    (UINT32_C(1) << 0)
#define CSR_LSIRDY   (UINT32_C(1) << 1)
#define CSR_RMVF     (UINT32_C(1) << 24)
#define CSR_PINRST   (UINT32_C(1) << 26)
#define CSR_PORRST   (UINT32_C(1) << 27)
#define CSR_SFTRST   (UINT32_C(1) << 28)
#define CSR_IWDGRST  (UINT32_C(1) << 29)
#define PWR_CR_DBP   (UINT32_C(1) << 8)
#define CORE_MOST_HZ 24000000u
#define SLACK                                                                                      \
    20u /* 1 / 20: the internal oscillator may be fast, and a crystal is taken for its neighbour */

/* The crystal starts within 2 ms, the PLL locks within 0.2 ms, the internal oscillator starts within 2 us, of DS5944 (unverified). */
#define CRYSTAL_START_NS 2000000u
#define PLL_LOCK_NS      200000u
#define HSI_START_NS     2000u

static const struct reg regs[] = {
    {"CR", CR, 0x00000083u, 0x030FFFFBu, 0x010D00F9u},
    {"CFGR", CFGR, 0, 0x073FFFFFu, 0x073FFFF3u},
    {"CIR", CIR, 0, 0x009F1F9Fu, 0x00001F00u},
    {"APB2RSTR", APB2RSTR, 0, 0x00075BFDu, 0x00075BFDu},
    {"APB1RSTR", APB1RSTR, 0, 0x787EC9FFu, 0x787EC9FFu},
    {"AHBENR", AHBENR, 0x14u, 0x157u, 0x157u},
    {"APB2ENR", APB2ENR, 0, 0x00075BFDu, 0x00075BFDu},
    {"APB1ENR", APB1ENR, 0, 0x787EC9FFu, 0x787EC9FFu},
    {"BDCR", BDCR, 0, 0x00018307u, 0x00018305u},
    {"CSR", CSR, 0x0C000000u, 0xFD000003u, 0x01000001u},
    {"CFGR2", CFGR2, 0, 0xFu, 0xFu},
};

struct rcc {
    struct board_event crystal, pll, internal;
    uint32_t reset_flags; /* live through every reset but power's */
};

/* ---- clocks ---- */

/* What the PLL gets; 0: its crystal does not run. */
static uint64_t pll_fed_hz(const struct part *p)
{
    if ((part_get(p, CFGR) & CFGR_PLLSRC) == 0)
        return board_internal_hz(p->board) / 2u;
    return p->board->around.crystal_hz / ((part_get(p, CFGR2) & 15u) + 1u);
}

static uint64_t pll_hz(const struct part *p)
{
    uint32_t code = part_get(p, CFGR) >> 18 & 15u;
    return pll_fed_hz(p) * (code < 15u ? code + 2u : 16u);
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
    return source == 1 || (source == 2 && (part_get(p, CFGR) & CFGR_PLLSRC) != 0);
}

static uint64_t core_hz(const struct part *p)
{
    return system_hz(p) / ahb_divider(part_get(p, CFGR) >> 4 & 15u);
}

static void clocks_changed(struct part *p)
{
    uint64_t hz = core_hz(p);
    if (hz != 0)
        board_set_core_hz(p->board, hz);
}

/* Buses take what the core takes. */
static void check_clocks(struct part *p)
{
    uint64_t core = core_hz(p);
    if (core == 0 || core > CORE_MOST_HZ + CORE_MOST_HZ / SLACK)
        board_verdict(p->board, "core clock of %llu Hz; at most 24 MHz", (unsigned long long)core);
}

static uint64_t bus_hz(struct board *b, const char *bus)
{
    uint32_t cfgr = part_get(bus_part(b, "RCC"), CFGR);
    if (strcmp(bus, "ahb") == 0)
        return b->core_hz;
    return b->core_hz / apb_divider(strcmp(bus, "apb1") == 0 ? cfgr >> 8 & 7u : cfgr >> 11 & 7u);
}

static bool crystal_ready(struct board *b)
{
    return (part_get(bus_part(b, "RCC"), CR) & CR_HSERDY) != 0;
}

/* 6.3.9, RTCSEL: 2 is the watchdog's slow clock, 3 the crystal's 128th. No crystal of 32 kHz is fitted. */
static uint64_t rtc_hz(struct board *b)
{
    const struct part *p = bus_part(b, "RCC");
    uint32_t bdcr = part_get(p, BDCR), source = bdcr >> 8 & 3u;
    if ((bdcr & BDCR_RTCEN) == 0 || (bdcr & BDCR_BDRST) != 0)
        return 0;
    if (source == 3)
        return crystal_ready(b) ? b->around.crystal_hz / 128u : 0;
    return source == 2 && (part_get(p, CSR) & CSR_LSIRDY) != 0 ? b->around.slow_clock_hz : 0;
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
    rtc_f1_clock_changed(p->board);
    switch_over(p);
}

/* 6.2.3: 16 to 24 MHz out. The PLL takes 1 MHz at least, of DS5944 (unverified). */
static void pll_locked(void *context)
{
    struct part *p = context;
    uint64_t fed = pll_fed_hz(p), made = pll_hz(p);
    bool on_crystal = (part_get(p, CFGR) & CFGR_PLLSRC) != 0;
    if ((part_get(p, CR) & CR_PLLON) == 0 || fed == 0 || (on_crystal && !crystal_ready(p->board)))
        return;
    if (fed < 1000000u || made < 16000000u - 16000000u / SLACK ||
        made > CORE_MOST_HZ + CORE_MOST_HZ / SLACK)
        board_verdict(p->board, "PLL fed with %llu Hz gives %llu Hz; 16 to 24 MHz are allowed",
                      (unsigned long long)fed, (unsigned long long)made);
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

/* 6.2.7, 6.3.1, 6.3.2: with the security system on, the chip falls back to its own oscillator and raises the NMI, which stays until CSSC clears
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
        rtc_f1_clock_changed(b);
        clocks_changed(p);
        return;
    }
    bool was_running = (cr & CR_HSERDY) != 0;
    part_set(p, CR, cr & ~CR_HSERDY);
    rtc_f1_clock_changed(b);
    if (!was_running)
        return;
    if ((cr & CR_CSSON) == 0) {
        if (runs_from_crystal(p))
            b->stalled_until_ns = BOARD_NEVER - 1u; /* until the watchdog */
        return;
    }
    bool pll_fails = (part_get(p, CFGR) & CFGR_PLLSRC) != 0;
    uint32_t on = 0, off = CR_HSEON | (pll_fails ? CR_PLLRDY : 0);
    if (runs_from_crystal(p)) {
        off |= pll_fails ? CR_PLLON : 0;
        on = CR_HSION | CR_HSIRDY;
        part_set(p, CFGR, part_get(p, CFGR) & ~15u);
    }
    part_set(p, CR, (part_get(p, CR) & ~off) | on);
    part_set(p, CIR, part_get(p, CIR) | CIR_CSSF);
    clocks_changed(p);
    interrupt_nmi(b, true);
}

const struct clocks clocks_f1 = {.bus_hz = bus_hz,
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

/* 6.1, 6.3.10: a power-on clears the flags of before. There is no brown-out flag: the chip's own supervisor resets as at power-on. The chip
 * pulls its reset pin at every reset (6.1.2), so the pin's flag comes as well (unverified). The backup domain's supply is taken to be the
 * chip's (6.1.3). */
static void reset(struct part *p, enum board_reset kind)
{
    struct rcc *r = p->state;
    static const uint32_t flags[] = {[RESET_POWER] = CSR_PORRST | CSR_PINRST,
                                     [RESET_BROWN_OUT] = CSR_PORRST | CSR_PINRST,
                                     [RESET_PIN] = CSR_PINRST,
                                     [RESET_SOFTWARE] = CSR_SFTRST | CSR_PINRST,
                                     [RESET_WATCHDOG] = CSR_IWDGRST | CSR_PINRST};
    uint32_t bdcr = part_get(p, BDCR);
    bool power = kind == RESET_POWER || kind == RESET_BROWN_OUT;
    r->reset_flags = power ? flags[kind] : r->reset_flags | flags[kind];
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    if (!power)
        part_set(p, BDCR, bdcr);
    part_set(p, CSR, r->reset_flags);
}

/* ---- registers ---- */

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
    uint32_t on = written & ~before, off = before & ~written, wanted = part_get(p, CFGR) & 3u;
    bool on_internal =
        source == 0 || (source == 2 && (part_get(p, CFGR) & CFGR_PLLSRC) == 0) || wanted == 0;
    if ((before & CR_HSEON) != 0 && ((written ^ before) & CR_HSEBYP) != 0)
        board_verdict(b, "RCC_CR_HSEBYP changed while the crystal is on");
    /* 6.3.1: what is used, or will be, cannot be switched off */
    if ((off & CR_HSEON) != 0)
        word = runs_from_crystal(p) ? word | CR_HSEON : word & ~CR_HSERDY;
    if ((off & CR_PLLON) != 0)
        word = source == 2 || wanted == 2 ? word | CR_PLLON : word & ~CR_PLLRDY;
    if ((off & CR_HSION) != 0)
        word = on_internal ? word | CR_HSION : word & ~CR_HSIRDY;
    if ((on & CR_HSEON) != 0)
        board_schedule(b, &r->crystal, now + CRYSTAL_START_NS);
    if ((on & CR_PLLON) != 0)
        board_schedule(b, &r->pll, now + PLL_LOCK_NS);
    if ((on & CR_HSION) != 0)
        board_schedule(b, &r->internal, now + HSI_START_NS);
    part_set(p, CR, word);
    rtc_f1_clock_changed(b);
}

static void write_cfgr(struct part *p, uint32_t before)
{
    uint32_t word = part_get(p, CFGR);
    if ((part_get(p, CR) & CR_PLLON) != 0 && ((word ^ before) & CFGR_PLL) != 0)
        board_verdict(p->board, "write of the PLL's settings in RCC_CFGR while the PLL is on");
    part_set(p, CFGR2, (part_get(p, CFGR2) & ~1u) | ((word & CFGR_PREDIV) != 0 ? 1u : 0));
    switch_over(p);
    check_clocks(p);
    clocks_changed(p);
}

static void write_cfgr2(struct part *p, uint32_t before)
{
    uint32_t word = part_get(p, CFGR2);
    if ((part_get(p, CR) & CR_PLLON) != 0 && word != before)
        board_verdict(p->board, "write of RCC_CFGR2 while the PLL is on");
    part_set(p, CFGR, (part_get(p, CFGR) & ~CFGR_PREDIV) | ((word & 1u) != 0 ? CFGR_PREDIV : 0));
}

/* 6.3.9, 4.4.1: closed until PWR_CR_DBP opens it; a clock of the RTC is chosen once after a reset of the domain. */
static void write_bdcr(struct part *p, uint32_t before)
{
    struct board *b = p->board;
    uint32_t word = part_get(p, BDCR);
    if (word == before)
        return;
    if ((part_get(bus_part(b, "PWR"), 0) & PWR_CR_DBP) == 0) {
        board_verdict(b, "write of RCC_BDCR while PWR_CR_DBP is off");
        return;
    }
    if ((word & BDCR_BDRST) != 0) {
        part_set(p, BDCR, BDCR_BDRST);
        rtc_f1_backup_reset(b);
        return;
    }
    if ((before & BDCR_RTCSEL) != 0 && ((word ^ before) & BDCR_RTCSEL) != 0)
        board_verdict(b, "another clock for the RTC without a reset of the backup domain");
    if ((word & BDCR_LSE) != 0)
        board_verdict(b, "the crystal of 32 kHz is not modelled");
    rtc_f1_clock_changed(b);
}

static void write_csr(struct part *p, uint32_t written)
{
    struct rcc *r = p->state;
    if ((written & CSR_RMVF) != 0)
        r->reset_flags = 0;
    part_set(p, CSR, r->reset_flags | ((written & CSR_LSION) != 0 ? CSR_LSION | CSR_LSIRDY : 0));
    rtc_f1_clock_changed(p->board);
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    switch (offset) {
    case CR:
        write_cr(p, before, written);
        break;
    case CFGR:
        write_cfgr(p, before);
        break;
    case CFGR2:
        write_cfgr2(p, before);
        break;
    case CIR:
        if ((written & CIR_CSSC) != 0) {
            part_set(p, CIR, part_get(p, CIR) & ~CIR_CSSF);
            interrupt_nmi(p->board, false);
        }
        if ((part_get(p, CIR) & 0x1F00u) != 0)
            board_verdict(p->board, "interrupts of the RCC are not modelled");
        break;
    case BDCR:
        write_bdcr(p, before);
        break;
    case CSR:
        write_csr(p, written);
        break;
    case APB1RSTR:
    case APB2RSTR:
        reset_parts(p, offset, offset + (APB1ENR - APB1RSTR));
        break;
    default:
        break;
    }
}

const struct part_class rcc_f1_class = {.name = "RCC of the STM32F1",
                                        .regs = regs,
                                        .n_regs = sizeof(regs) / sizeof(regs[0]),
                                        .state_bytes = sizeof(struct rcc),
                                        .widths = WIDTH_BYTE | WIDTH_HALF | WIDTH_WORD,
                                        .start = start,
                                        .reset = reset,
                                        .read = read,
                                        .write = write};
