/* Real-time clock of the STM32F100 as a counter, read in RM0041 Rev 6: 17.2 to 17.4. It counts down from its prescaler at the clock that
 * RCC_BDCR chooses, lies in the backup domain, and is read through copies that are old until RSF is set (17.3.3).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "models.h"

enum {
    CRH = 0x00,
    CRL = 0x04,
    PRLH = 0x08,
    PRLL = 0x0C,
    DIVH = 0x10,
    DIVL = 0x14,
    CNTH = 0x18,
    CNTL = 0x1C,
    ALRH = 0x20,
    ALRL = 0x24
};

#define CRL_RSF    (UINT32_C(1) << 3)
#define CRL_CNF    (UINT32_C(1) << 4)
#define CRL_RTOFF  (UINT32_C(1) << 5)
#define PWR_CR_DBP (UINT32_C(1) << 8)
#define PRESCALER  0x8000u /* after a reset of the domain */
#define NS_PER_S   UINT64_C(1000000000)

static const struct reg regs[] = {
    {"CRH", CRH, 0, 0x7u, 0x7u},         {"CRL", CRL, CRL_RTOFF, 0x3Fu, 0},
    {"PRLH", PRLH, 0, 0xFu, 0},          {"PRLL", PRLL, PRESCALER, 0xFFFFu, 0},
    {"DIVH", DIVH, 0, 0xFu, 0},          {"DIVL", DIVL, PRESCALER, 0xFFFFu, 0},
    {"CNTH", CNTH, 0, 0xFFFFu, 0},       {"CNTL", CNTL, 0, 0xFFFFu, 0},
    {"ALRH", ALRH, 0xFFFFu, 0xFFFFu, 0}, {"ALRL", ALRL, 0xFFFFu, 0xFFFFu, 0},
};

struct rtc {
    uint64_t counts; /* of its clock until from_ns */
    uint64_t from_ns, hz;
    uint64_t synchronised_before; /* counts: one more, and what is read is of now */
    bool reads_old;               /* RSF is awaited */
};

/* Counts of its clock since the last reset of the domain. */
static uint64_t counts_now(const struct part *p)
{
    const struct rtc *r = p->state;
    unsigned __int128 spent = board_ns(p->board) - r->from_ns;
    return r->counts + (uint64_t)(spent * r->hz / NS_PER_S);
}

void rtc_f1_clock_changed(struct board *b)
{
    struct part *p = bus_part(b, "RTC");
    struct rtc *r = p->state;
    uint64_t hz = rtc_clock_hz(b);
    if (hz == r->hz)
        return;
    r->counts = counts_now(p);
    r->from_ns = board_ns(b);
    r->hz = hz;
}

void rtc_f1_backup_reset(struct board *b)
{
    struct part *p = bus_part(b, "RTC");
    *(struct rtc *)p->state = (struct rtc){.from_ns = board_ns(b), .reads_old = true};
}

static void reset(struct part *p, enum board_reset kind)
{
    struct rtc *r = p->state;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    if (kind == RESET_POWER || kind == RESET_BROWN_OUT)
        rtc_f1_backup_reset(p->board);
    rtc_f1_clock_changed(p->board);
    r->synchronised_before = counts_now(p);
    r->reads_old = true;
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    struct rtc *r = p->state;
    if (offset == CRH)
        return stored;
    if (r->reads_old && counts_now(p) > r->synchronised_before)
        r->reads_old = false;
    if (offset == CRL)
        return CRL_RTOFF | (r->reads_old ? 0 : CRL_RSF);
    if (r->reads_old)
        board_verdict(p->board, "read of RTC registers before RTC_CRL_RSF is set");
    uint64_t counts = counts_now(p), seconds = counts / (PRESCALER + 1u);
    switch (offset) {
    case DIVL:
        return PRESCALER - (uint32_t)(counts % (PRESCALER + 1u));
    case CNTH:
        return (uint32_t)(seconds >> 16) & 0xFFFFu;
    case CNTL:
        return (uint32_t)seconds & 0xFFFFu;
    case DIVH:
        return 0;
    default:
        board_verdict(p->board, "read of RTC_PRL or RTC_ALR, which can only be written");
        return stored;
    }
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    struct rtc *r = p->state;
    (void)before;
    bool sets = (offset != CRL && offset != CRH) || (offset == CRL && (written & CRL_CNF) != 0);
    if (sets) {
        board_verdict(p->board, "setting the RTC is not modelled");
    } else if (offset == CRH && written != 0) {
        board_verdict(p->board, "interrupts of the RTC are not modelled");
    } else if ((part_get(bus_part(p->board, "PWR"), 0) & PWR_CR_DBP) == 0) {
        board_verdict(p->board, "write of the RTC while PWR_CR_DBP is off");
    } else if (offset == CRL && (written & CRL_RSF) == 0) {
        r->synchronised_before = counts_now(p);
        r->reads_old = true;
    }
}

const struct part_class rtc_f1_class = {.name = "RTC of the STM32F1",
                                        .regs = regs,
                                        .n_regs = sizeof(regs) / sizeof(regs[0]),
                                        .state_bytes = sizeof(struct rtc),
                                        .widths = WIDTH_HALF | WIDTH_WORD,
                                        .reset = reset,
                                        .read = read,
                                        .write = write};
