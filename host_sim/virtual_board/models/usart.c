/* Serial ports, read in RM0041 Rev 6: 23.3.2, 23.3.3, 23.4, 23.6. 8 data bits, no parity, one stop bit; baud rate, overrun, framing errors, the
 * order in which flags are cleared. Masks of the STM32F405: the vendor's SVD file. Serial ports of the STM32F405 behave like those of the
 * STM32F100 (unverified). USART_SR is 0xC0 after a reset, where RM0041 prints 0x00C00000 (unverified). A bit lasts as many periods of the
 * bus as USART_BRR says (unverified). The far end of the line speaks at its own rate. A port does not understand a rate that is off by 5 %
 * (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "models.h"
#include "replay.h"

enum { SR = 0x00, DR = 0x04, BRR = 0x08, CR1 = 0x0C, CR2 = 0x10, CR3 = 0x14, GTPR = 0x18 };

#define SR_FE     (UINT32_C(1) << 1)
#define SR_NE     (UINT32_C(1) << 2)
#define SR_ORE    (UINT32_C(1) << 3)
#define SR_IDLE   (UINT32_C(1) << 4)
#define SR_RXNE   (UINT32_C(1) << 5)
#define SR_TC     (UINT32_C(1) << 6)
#define SR_TXE    (UINT32_C(1) << 7)
#define SR_ERRORS 0xFu
#define CR1_RE    (UINT32_C(1) << 2)
#define CR1_TE    (UINT32_C(1) << 3)
#define CR1_KNOWN 0x20FCu /* UE, TXEIE, TCIE, RXNEIE, IDLEIE, TE, RE */
#define CR1_UE    (UINT32_C(1) << 13)
#define XON       0x11u
#define XOFF      0x13u
#define BITS      10u
#define NS_PER_S  UINT64_C(1000000000)
#define MISMATCH  20u /* 1 / 20: a rate that far off is not understood; half a bit in ten */

static const struct reg regs[] = {
    {"SR", SR, 0xC0u, 0x3FFu, 0},        {"DR", DR, 0, 0x1FFu, 0},
    {"BRR", BRR, 0, 0xFFFFu, 0xFFFFu},   {"CR1", CR1, 0, 0xBFFFu, 0xBFFFu},
    {"CR2", CR2, 0, 0x7F6Fu, 0x7F6Fu},   {"CR3", CR3, 0, 0x0FFFu, 0x0FFFu},
    {"GTPR", GTPR, 0, 0xFFFFu, 0xFFFFu},
};

struct usart {
    struct board_event arrives, sent;
    uint8_t received, shifting, waiting;
    bool shifts, full; /* the shift register; the data register in front of it */
    uint32_t seen;     /* flags that a read of SR has shown: a read of DR then clears them */
};

/* USART1 is on PA9 and PA10, USART2 on PA2 and PA3 (unverified). */
static const struct pins {
    uint8_t tx, rx;
} pins_of[] = {{9, 10}, {2, 3}};

static bool drives(const struct part *p)
{
    return pin_function(p->board, 'A', pins_of[p->row->number].tx) ==
           p->board->chip->usart_function;
}

static bool listens(const struct part *p)
{
    uint8_t function = pin_function(p->board, 'A', pins_of[p->row->number].rx);
    return function == PIN_INPUT || function == p->board->chip->usart_function;
}

static struct line *line_of(const struct part *p)
{
    return &p->board->lines[p->row->number];
}

static uint64_t own_baud(const struct part *p)
{
    uint32_t brr = part_get(p, BRR);
    return brr == 0 ? 0 : bus_clock_hz(p->board, p->row->bus) / brr;
}

static bool understood(const struct part *p)
{
    uint64_t own = own_baud(p), far = p->board->around.baud,
             off = own > far ? own - far : far - own;
    return own != 0 && off * MISMATCH < far;
}

static void update_irq(struct part *p)
{
    uint32_t sr = part_get(p, SR), cr1 = part_get(p, CR1);
    bool high = (cr1 & sr & (SR_TXE | SR_TC | SR_IDLE)) != 0 ||
                ((cr1 & SR_RXNE) != 0 && (sr & (SR_RXNE | SR_ORE)) != 0);
    interrupt_line(p->board, p->row->irq, high && (cr1 & CR1_UE) != 0);
}

static void await_byte(struct part *p)
{
    struct usart *u = p->state;
    const struct line *l = line_of(p);
    if (l->to_head != l->to_tail && !l->asked_to_wait && u->arrives.at_ns == BOARD_NEVER)
        board_schedule(p->board, &u->arrives,
                       board_ns(p->board) + BITS * NS_PER_S / p->board->around.baud);
}

static bool noisy(struct board *b, const struct line *l)
{
    return l->corrupt_per_million != 0 && board_random(b) % 1000000u < l->corrupt_per_million;
}

/* A byte has come over the line. */
static void arrives(void *context)
{
    struct part *p = context;
    struct usart *u = p->state;
    struct line *l = line_of(p);
    uint32_t cr1 = part_get(p, CR1), sr = part_get(p, SR);
    if (l->to_head == l->to_tail)
        return;
    uint8_t byte = l->to_board[l->to_head++ % BOARD_LINE_ROOM];
    uint32_t framing = 0;
    if (noisy(p->board, l)) {
        byte ^= (uint8_t)(1u << (board_random(p->board) & 7u));
        framing = board_random(p->board) % 4u == 0 ? SR_FE : 0;
    }
    if ((cr1 & (CR1_UE | CR1_RE)) == (CR1_UE | CR1_RE) && listens(p)) {
        if (!understood(p)) {
            byte = (uint8_t)board_random(p->board);
            framing = SR_FE;
        }
        if ((sr & SR_RXNE) != 0) {
            sr |= SR_ORE; /* the byte is lost, and of its errors this one alone is told (23.6.1) */
        } else {
            u->received = byte;
            sr |= SR_RXNE | framing;
        }
        part_set(p, SR, sr);
        update_irq(p);
    }
    await_byte(p);
}

static void leave_for_line(struct part *p, uint8_t byte)
{
    struct line *l = line_of(p);
    if (l->unplugged || !drives(p))
        return; /* nobody hears it */
    if (!understood(p))
        byte = (uint8_t)board_random(p->board);
    else if (noisy(p->board, l))
        byte ^= (uint8_t)(1u << (board_random(p->board) & 7u));
    if (l->far_end_obeys && (byte == XOFF || byte == XON)) {
        l->asked_to_wait = byte == XOFF;
        await_byte(p);
    }
    if (l->from_tail - l->from_head < BOARD_LINE_ROOM)
        l->from_board[l->from_tail++ % BOARD_LINE_ROOM] = byte;
    p->board->from_board_moved = true;
}

static void shift(struct part *p, uint8_t byte)
{
    struct usart *u = p->state;
    uint64_t baud = own_baud(p);
    u->shifts = true;
    u->shifting = byte;
    board_schedule(p->board, &u->sent,
                   board_ns(p->board) + BITS * NS_PER_S / (baud != 0 ? baud : 1u));
}

static void sent(void *context)
{
    struct part *p = context;
    struct usart *u = p->state;
    leave_for_line(p, u->shifting);
    u->shifts = false;
    if (u->full) {
        u->full = false;
        part_set(p, SR, part_get(p, SR) | SR_TXE);
        shift(p, u->waiting);
    } else {
        part_set(p, SR, part_get(p, SR) | SR_TC);
    }
    update_irq(p);
}

static void start(struct part *p)
{
    struct usart *u = p->state;
    u->arrives = (struct board_event){.due = arrives, .context = p};
    u->sent = (struct board_event){.due = sent, .context = p};
    board_add_event(p->board, &u->arrives);
    board_add_event(p->board, &u->sent);
    line_of(p)->port = p;
    line_of(p)->far_end_obeys = p->row->number == 0;
}

static void reset(struct part *p, enum board_reset kind)
{
    struct usart *u = p->state;
    (void)kind;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    u->shifts = u->full = false;
    u->seen = 0;
    interrupt_line(p->board, p->row->irq, false);
    await_byte(p);
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    struct usart *u = p->state;
    if (offset == SR) {
        u->seen = stored;
        return stored;
    }
    if (offset != DR)
        return stored;
    part_set(p, SR, part_get(p, SR) & ~(SR_RXNE | (u->seen & (SR_ERRORS | SR_IDLE))));
    u->seen = 0;
    update_irq(p);
    return u->received;
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    struct usart *u = p->state;
    (void)before;
    if (offset == SR) {
        part_set(p, SR, part_get(p, SR) & (written | ~(SR_TC | SR_RXNE)));
    } else if (offset == DR) {
        if ((part_get(p, CR1) & (CR1_UE | CR1_TE)) != (CR1_UE | CR1_TE)) {
            board_verdict(p->board, "a byte written to %s while its transmitter is off",
                          p->row->name);
            return;
        }
        if ((u->seen & SR_TC) != 0) /* 23.6.1: a read of SR, and a write of DR */
            part_set(p, SR, part_get(p, SR) & ~SR_TC);
        if (!u->shifts) {
            shift(p, (uint8_t)written);
        } else {
            if (u->full)
                board_verdict(p->board, "a byte written to %s_DR over one that was not sent",
                              p->row->name);
            u->full = true;
            u->waiting = (uint8_t)written;
            part_set(p, SR, part_get(p, SR) & ~SR_TXE);
        }
    } else if (offset == CR1) {
        if ((written & ~CR1_KNOWN) != 0)
            board_verdict(p->board, "%s_CR1 of 0x%x is not modelled", p->row->name, written);
    } else if (offset == CR2 || offset == CR3 || offset == GTPR) {
        if (written != 0)
            board_verdict(p->board, "%s_%s of 0x%x is not modelled", p->row->name,
                          offset == CR2   ? "CR2"
                          : offset == CR3 ? "CR3"
                                          : "GTPR",
                          written);
    }
    update_irq(p);
}

size_t line_give(struct board *b, unsigned line, const uint8_t *bytes, size_t n)
{
    struct line *l = &b->lines[line];
    size_t given = 0;
    replay_note(b, line == 0 ? REPLAY_CONSOLE : REPLAY_LINK, bytes, n);
    if (b->held || l->unplugged)
        return n; /* nobody hears it */
    while (given < n && l->to_tail - l->to_head < BOARD_LINE_ROOM)
        l->to_board[l->to_tail++ % BOARD_LINE_ROOM] = bytes[given++];
    if (l->port != NULL)
        await_byte(l->port);
    return given;
}

const struct part_class usart_class = {.name = "USART",
                                       .regs = regs,
                                       .n_regs = sizeof(regs) / sizeof(regs[0]),
                                       .state_bytes = sizeof(struct usart),
                                       .widths = WIDTH_HALF | WIDTH_WORD, /* 23.6 */
                                       .start = start,
                                       .reset = reset,
                                       .read = read,
                                       .write = write};
