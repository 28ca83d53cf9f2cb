/* A serial port in half duplex with an open drain, as it makes the pulses of a 1-wire bus: 9,600 baud for the reset pulse, 115,200 for a bit. What
 * the port hears is its own byte, and where the wire is pulled low meanwhile, zeros. Registers are those of usart.c.
 *
 * Pulses are judged by the times of the DS18B20: A reset pulse lasts 480 us and more, a chip waits 15 us to 60 us and then pulls for 60 us to
 * 240 us; a slot takes 60 us to 120 us, of which a 0 is low for 60 us and more and a 1 for 1 us to 15 us; a chip that sends a 0 pulls for 15 us and more
 * from the slot's beginning (unverified). The chips of this wire wait 30 us and pull for 120 us, and hold a 0 for 30 us. A port with HDSEL hears
 * its own transmitter on its TX pin (unverified). RXNE comes in the middle of the stop bit and TC at its end (unverified). The baud rate
 * is not changed within a byte (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "pins.h"

enum { SR = 0x00, DR = 0x04, BRR = 0x08, CR1 = 0x0C, CR2 = 0x10, CR3 = 0x14, GTPR = 0x18 };

#define SR_FE       (UINT32_C(1) << 1)
#define SR_ORE      (UINT32_C(1) << 3)
#define SR_RXNE     (UINT32_C(1) << 5)
#define SR_TC       (UINT32_C(1) << 6)
#define SR_TXE      (UINT32_C(1) << 7)
#define SR_ERRORS   0xFu
#define CR1_RE      (UINT32_C(1) << 2)
#define CR1_TE      (UINT32_C(1) << 3)
#define CR1_UE      (UINT32_C(1) << 13)
#define CR1_KNOWN   0x20ECu /* UE, TXEIE, TCIE, RXNEIE, TE, RE */
#define CR3_HDSEL   (UINT32_C(1) << 3)
#define FUNCTION_F4 8u /* Both ports have this alternate function on their pins (unverified). */
#define FUNCTION_F1 0u /* a pin has one at most */
#define BITS        10u
#define NS_PER_S    UINT64_C(1000000000)
#define US          UINT64_C(1000)
#define WAIT_NS     (30u * US) /* of a chip after a reset pulse */
#define PRESENCE_NS (120u * US)
#define ZERO_NS     (30u * US)

static const struct reg regs[] = {
    {"SR", SR, 0xC0u, 0x3FFu, 0},        {"DR", DR, 0, 0x1FFu, 0},
    {"BRR", BRR, 0, 0xFFFFu, 0xFFFFu},   {"CR1", CR1, 0, 0xBFFFu, 0xBFFFu},
    {"CR2", CR2, 0, 0x7F6Fu, 0x7F6Fu},   {"CR3", CR3, 0, 0x0FFFu, 0x0FFFu},
    {"GTPR", GTPR, 0, 0xFFFFu, 0xFFFFu},
};

enum pulse { PULSE_RESET, PULSE_ZERO, PULSE_ONE };

struct wire {
    struct board_event heard, sent;
    uint64_t bit_ns;
    enum pulse pulse;
    uint8_t received, shifting, waiting, low_bits;
    bool shifts, full;
    uint32_t seen; /* flags that a read of SR has shown */
};

static bool is_f1(const struct part *p)
{
    return p->row->class == &wire_f1_class;
}

/* USART6 on PC6, UART4 on PA0 (unverified). USART3 of the STM32F100 is on PB10 (unverified). */
static unsigned pin_of(const struct part *p)
{
    if (is_f1(p))
        return PIN_NUMBER('B', 10);
    return p->row->number == 1 ? PIN_NUMBER('C', 6) : PIN_NUMBER('A', 0);
}

static void update_irq(struct part *p)
{
    uint32_t sr = part_get(p, SR), cr1 = part_get(p, CR1);
    bool high = (cr1 & sr & (SR_TXE | SR_TC)) != 0 ||
                ((cr1 & SR_RXNE) != 0 && (sr & (SR_RXNE | SR_ORE)) != 0);
    interrupt_line(p->board, p->row->irq, high && (cr1 & CR1_UE) != 0);
}

/* Which pulse a byte makes. Ends the run where it makes none of the bus. */
static void judge(struct part *p, unsigned byte)
{
    struct wire *w = p->state;
    unsigned low = 1;
    while (low < 9u && (byte >> (low - 1u) & 1u) == 0)
        low++;
    uint64_t low_ns = low * w->bit_ns, slot_ns = BITS * w->bit_ns;
    bool again = low < 9u && (byte >> (low - 1u)) != 0xFFu >> (low - 1u);
    w->low_bits = (uint8_t)low;
    if (low_ns >= 480u * US && low_ns <= 960u * US)
        w->pulse = PULSE_RESET;
    else if (low_ns >= 60u * US && low_ns <= 120u * US)
        w->pulse = PULSE_ZERO;
    else if (low_ns >= US && low_ns <= 15u * US && slot_ns >= 61u * US)
        w->pulse = PULSE_ONE;
    else
        board_verdict(p->board, "a pulse of %llu ns in %llu ns on a 1-wire bus",
                      (unsigned long long)low_ns, (unsigned long long)slot_ns);
    if (again)
        board_verdict(p->board, "0x%02x makes two pulses in a slot of a 1-wire bus", byte);
}

static void shift(struct part *p, uint8_t byte)
{
    struct wire *w = p->state;
    uint32_t brr = part_get(p, BRR);
    uint64_t now = board_ns(p->board);
    w->bit_ns = brr * NS_PER_S / bus_clock_hz(p->board, p->row->bus);
    w->shifts = true;
    w->shifting = byte;
    judge(p, byte);
    part_set(p, SR, part_get(p, SR) | SR_TXE);
    board_schedule(p->board, &w->heard, now + (2u * BITS - 1u) * w->bit_ns / 2u);
    board_schedule(p->board, &w->sent, now + BITS * w->bit_ns);
}

/* The byte as it is heard when the wire is pulled from one time to another after the start bit began. */
static uint8_t pulled(const struct wire *w, uint64_t from_ns, uint64_t until_ns)
{
    uint8_t byte = w->shifting;
    for (unsigned bit = 0; bit < 8; bit++) {
        uint64_t sample = (2u * bit + 3u) * w->bit_ns / 2u;
        if (sample >= from_ns && sample < until_ns)
            byte &= (uint8_t) ~(1u << bit);
    }
    return byte;
}

static enum wire_answer answer_of(const struct part *p)
{
    const struct wire *w = p->state;
    const struct world *world = &p->board->world;
    uint64_t now = board_ns(p->board);
    if (w->pulse == PULSE_RESET)
        return world->wire_reset == NULL ? WIRE_SILENT
                                         : world->wire_reset(world->context, now, p->row->number);
    return world->wire_bit == NULL
               ? WIRE_SILENT
               : world->wire_bit(world->context, now, p->row->number, w->pulse == PULSE_ONE);
}

static void heard(void *context)
{
    struct part *p = context;
    struct wire *w = p->state;
    enum wire_answer answer = answer_of(p);
    uint32_t sr = part_get(p, SR), framing = answer == WIRE_SHORTED ? SR_FE : 0;
    uint64_t released = w->low_bits * w->bit_ns;
    uint8_t byte = answer == WIRE_SHORTED  ? 0
                   : answer == WIRE_SILENT ? w->shifting
                   : w->pulse == PULSE_RESET
                       ? pulled(w, released + WAIT_NS, released + WAIT_NS + PRESENCE_NS)
                       : pulled(w, 0, ZERO_NS);
    if ((part_get(p, CR1) & CR1_RE) == 0)
        return;
    if ((sr & SR_RXNE) != 0) {
        sr |= SR_ORE;
    } else {
        w->received = byte;
        sr |= SR_RXNE | framing;
    }
    part_set(p, SR, sr);
    update_irq(p);
}

static void sent(void *context)
{
    struct part *p = context;
    struct wire *w = p->state;
    w->shifts = false;
    if (w->full) {
        w->full = false;
        shift(p, w->waiting);
    } else {
        part_set(p, SR, part_get(p, SR) | SR_TC);
    }
    update_irq(p);
}

static void start(struct part *p)
{
    struct wire *w = p->state;
    w->heard = (struct board_event){.due = heard, .context = p};
    w->sent = (struct board_event){.due = sent, .context = p};
    board_add_event(p->board, &w->heard);
    board_add_event(p->board, &w->sent);
}

static void restart(struct part *p)
{
    struct wire *w = p->state;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    w->shifts = w->full = false;
    w->seen = 0;
    board_schedule(p->board, &w->heard, BOARD_NEVER);
    board_schedule(p->board, &w->sent, BOARD_NEVER);
    interrupt_line(p->board, p->row->irq, false);
}

static void reset(struct part *p, enum board_reset kind)
{
    (void)kind;
    restart(p);
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    struct wire *w = p->state;
    if (offset == SR)
        w->seen = stored;
    if (offset != DR)
        return stored;
    part_set(p, SR, part_get(p, SR) & ~(SR_RXNE | (w->seen & SR_ERRORS)));
    w->seen = 0;
    update_irq(p);
    return w->received;
}

static void write_data(struct part *p, uint8_t byte)
{
    struct wire *w = p->state;
    struct board *b = p->board;
    const char *name = p->row->name;
    if ((part_get(p, CR1) & (CR1_UE | CR1_TE)) != (CR1_UE | CR1_TE) ||
        part_get(p, CR3) != CR3_HDSEL || part_get(p, BRR) == 0) {
        board_verdict(b, "a byte written to %s, which is not on in half duplex", name);
    } else if (!pin_has_function(b, pin_of(p), is_f1(p) ? FUNCTION_F1 : FUNCTION_F4) ||
               !pin_is_open_drain(b, pin_of(p))) {
        board_verdict(b, "%s sends while its pin is no open drain of its own", name);
    } else if (w->full) {
        board_verdict(b, "a byte written to %s_DR over one that was not sent", name);
    } else {
        if ((w->seen & SR_TC) != 0) /* a read of SR, and a write of DR */
            part_set(p, SR, part_get(p, SR) & ~SR_TC);
        if (!w->shifts) {
            shift(p, byte);
        } else {
            w->full = true;
            w->waiting = byte;
            part_set(p, SR, part_get(p, SR) & ~SR_TXE);
        }
    }
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    const struct wire *w = p->state;
    if (offset == SR)
        part_set(p, SR, part_get(p, SR) & (written | ~(SR_TC | SR_RXNE)));
    else if (offset == DR)
        write_data(p, (uint8_t)written);
    else if (offset == BRR && w->shifts && written != before)
        board_verdict(p->board, "%s_BRR changes within a byte", p->row->name);
    else if ((offset == CR1 && (written & ~CR1_KNOWN) != 0) ||
             (offset == CR3 && (written & ~CR3_HDSEL) != 0) ||
             ((offset == CR2 || offset == GTPR) && written != 0))
        board_verdict(p->board, "0x%x in register 0x%x of %s is not modelled", written, offset,
                      p->row->name);
    update_irq(p);
}

#define WIRE_CLASS                                                                                 \
    .regs = regs, .n_regs = sizeof(regs) / sizeof(regs[0]), .state_bytes = sizeof(struct wire),    \
    .widths = WIDTH_HALF | WIDTH_WORD, .start = start, .reset = reset, .restart = restart,         \
    .read = read, .write = write

const struct part_class wire_class = {.name = "serial port of a 1-wire bus", WIRE_CLASS};
const struct part_class wire_f1_class = {.name = "serial port of a 1-wire bus, STM32F1",
                                         WIRE_CLASS};
