/* Timers as counters: TIM2 of 32 bits, TIM11 with one capture input that may be the crystal's share for the real-time clock. Register maps and
 * masks: the vendor's SVD file. Read in RM0090: the prescaler that an update takes over (Rev 11 18.3.1), the divider of PSC + 1 and a counter
 * that stands while ARR is 0, as after a reset (Rev 4 15.4.11 and 15.4.12), TIM11 fed with the crystal's share (Rev 21 7.2.11). Code 2 of
 * TIM11_OR feeds that share to TIM11 (unverified). A read of TIM11_CCR1 clears CC1IF, and a capture before that sets CC1OF (unverified).
 * TIM11_CCMR1 captures every 1, 2, 4 or 8 edges (unverified). Flags of TIM2_SR and TIM11_SR are cleared by zeros (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "models.h"

enum {
    CR1 = 0x00,
    DIER = 0x0C,
    SR = 0x10,
    EGR = 0x14,
    CCMR1 = 0x18,
    CCER = 0x20,
    CNT = 0x24,
    PSC = 0x28,
    ARR = 0x2C,
    CCR1 = 0x34,
    OR = 0x50
};

#define CR1_CEN    1u
#define EGR_UG     1u
#define SR_UIF     1u
#define SR_CC1IF   2u
#define SR_CC1OF   (UINT32_C(1) << 9)
#define CCER_CC1E  1u
#define CCMR1_CC1S 3u
#define OR_HSE_RTC 2u
#define NS_PER_S   UINT64_C(1000000000)

static const struct reg regs32[] = {
    {"CR1", CR1, 0, 0x3FFu, 0x3FFu},
    {"DIER", DIER, 0, 0x5F5Fu, 0x5F5Fu},
    {"SR", SR, 0, 0x1E5Fu, 0},
    {"EGR", EGR, 0, 0x5Fu, 0},
    {"CNT", CNT, 0, UINT32_MAX, UINT32_MAX},
    {"PSC", PSC, 0, 0xFFFFu, 0xFFFFu},
    {"ARR", ARR, 0, UINT32_MAX, UINT32_MAX},
};

static const struct reg regs16[] = {
    {"CR1", CR1, 0, 0x387u, 0x387u},   {"DIER", DIER, 0, 0x3u, 0x3u},
    {"SR", SR, 0, 0x203u, 0},          {"EGR", EGR, 0, 0x3u, 0},
    {"CCMR1", CCMR1, 0, 0xFFu, 0xFFu}, {"CCER", CCER, 0, 0xBu, 0xBu},
    {"CNT", CNT, 0, 0xFFFFu, 0xFFFFu}, {"PSC", PSC, 0, 0xFFFFu, 0xFFFFu},
    {"ARR", ARR, 0, 0xFFFFu, 0xFFFFu}, {"CCR1", CCR1, 0, 0xFFFFu, 0xFFFFu},
    {"OR", OR, 0, 0x3u, 0x3u},
};

struct timer {
    struct board_event capture;
    uint64_t zero_cycles; /* of the core, when the counter was 0 */
    uint32_t divider;     /* in force: the prescaler is taken over at an update */
};

static uint32_t count(const struct part *p)
{
    const struct timer *t = p->state;
    if ((part_get(p, CR1) & CR1_CEN) == 0 || part_get(p, ARR) == 0)
        return part_get(p, CNT);
    uint64_t core = p->board->core_hz, own = timer_clock_hz(p->board, p->row->bus),
             spent = p->board->cycles - t->zero_cycles;
    uint64_t counts = own == core ? spent : spent / (core / own);
    return (uint32_t)(counts / (t->divider + 1u) % ((uint64_t)part_get(p, ARR) + 1u));
}

/* ---- capture of the crystal ---- */

static uint64_t capture_ns(const struct part *p)
{
    uint64_t hz = rtc_clock_hz(p->board);
    uint32_t mode = part_get(p, CCMR1);
    bool on = (part_get(p, CR1) & CR1_CEN) != 0 && (part_get(p, CCER) & CCER_CC1E) != 0 &&
              (mode & 3u) == 1u && (part_get(p, OR) & 3u) == OR_HSE_RTC;
    return !on || hz == 0 ? 0 : (UINT64_C(1) << (mode >> 2 & 3u)) * NS_PER_S / hz;
}

static void captured(void *context)
{
    struct part *p = context;
    struct timer *t = p->state;
    uint64_t again = capture_ns(p);
    if (again == 0)
        return;
    uint32_t sr = part_get(p, SR);
    part_set(p, SR, sr | SR_CC1IF | ((sr & SR_CC1IF) != 0 ? SR_CC1OF : 0));
    part_set(p, CCR1, count(p));
    board_schedule(p->board, &t->capture, board_ns(p->board) + again);
}

static void start(struct part *p)
{
    struct timer *t = p->state;
    t->capture = (struct board_event){.due = captured, .context = p};
    board_add_event(p->board, &t->capture);
}

static void reset(struct part *p, enum board_reset kind)
{
    struct timer *t = p->state;
    (void)kind;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    t->divider = 0;
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    if (offset == CNT)
        return count(p);
    if (offset == CCR1)
        part_set(p, SR, part_get(p, SR) & ~SR_CC1IF);
    return stored;
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    struct timer *t = p->state;
    if (offset == SR) {
        part_set(p, SR, before & written); /* cleared by zeros */
    } else if (offset == EGR && (written & EGR_UG) != 0) {
        t->divider = part_get(p, PSC);
        t->zero_cycles = p->board->cycles;
        part_set(p, CNT, 0);
        part_set(p, SR, part_get(p, SR) | SR_UIF);
    } else if (offset == CR1) {
        if ((written & ~before & CR1_CEN) != 0)
            t->zero_cycles = p->board->cycles;
        if ((written & 0x3FEu) != 0)
            board_verdict(p->board, "%s_CR1 of 0x%x is not modelled", p->row->name, written);
    } else if (p->row->class == &timer_capture_class && offset == CCMR1 &&
               ((written ^ before) & CCMR1_CC1S) != 0 && (part_get(p, CCER) & CCER_CC1E) != 0) {
        board_verdict(
            p->board, "%s_CCMR1 chooses an input while the channel is on",
            p->row
                ->name); /* The input of a channel that is on cannot be chosen, RM0090 19.5.5 (unverified). */
    } else if (offset == DIER && written != 0) {
        board_verdict(p->board, "interrupts of %s are not modelled", p->row->name);
    }
    uint64_t period = p->row->class == &timer_capture_class ? capture_ns(p) : 0;
    if (period != 0 && t->capture.at_ns == BOARD_NEVER)
        board_schedule(p->board, &t->capture, board_ns(p->board) + period / 2u);
}

const struct part_class timer32_class = {.name = "timer of 32 bits",
                                         .regs = regs32,
                                         .n_regs = sizeof(regs32) / sizeof(regs32[0]),
                                         .state_bytes = sizeof(struct timer),
                                         .widths = WIDTH_HALF | WIDTH_WORD,
                                         .start = start,
                                         .reset = reset,
                                         .read = read,
                                         .write = write};
const struct part_class timer_capture_class = {.name = "timer with a capture",
                                               .regs = regs16,
                                               .n_regs = sizeof(regs16) / sizeof(regs16[0]),
                                               .state_bytes = sizeof(struct timer),
                                               .widths = WIDTH_HALF | WIDTH_WORD,
                                               .start = start,
                                               .reset = reset,
                                               .read = read,
                                               .write = write};
