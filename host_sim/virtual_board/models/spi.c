/* Serial peripheral interface as master with frames of 8 bits, both ways. Read in RM0090 Rev 11: 28.3.5 (data transmission and reception: when TXE
 * and RXNE come and go) and 28.3.7 (status flags: BSY). The other sides of it are from memory: Registers and their bits are those of SPI_CR1, SPI_CR2,
 * SPI_SR and SPI_DR (unverified). RXNE comes with the last sampling edge, which is the seventh and a half period with CPHA 0 and the eighth with
 * CPHA 1, and BSY goes half a period later (unverified). Baud rate, polarity and phase stay while the part is on (unverified). With SSM and SSI a
 * master needs no NSS pin; without them a low NSS is a mode fault (unverified). A read of DR and then of SR clears OVR (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "pins.h"

enum { CR1 = 0x00, CR2 = 0x04, SR = 0x08, DR = 0x0C };

#define CR1_CPHA      1u
#define CR1_MSTR      4u
#define CR1_SPE       (UINT32_C(1) << 6)
#define CR1_SSI       (UINT32_C(1) << 8)
#define CR1_SSM       (UINT32_C(1) << 9)
#define CR1_KNOWN     0x37Fu /* CPHA, CPOL, MSTR, BR, SPE, SSI, SSM */
#define CR1_FIXED     0x3Fu  /* while it is on */
#define CR2_ERRIE     (UINT32_C(1) << 5)
#define CR2_RXNEIE    (UINT32_C(1) << 6)
#define CR2_TXEIE     (UINT32_C(1) << 7)
#define SR_RXNE       1u
#define SR_TXE        2u
#define SR_OVR        (UINT32_C(1) << 6)
#define SR_BSY        (UINT32_C(1) << 7)
#define NS_PER_S      UINT64_C(1000000000)
#define SLOW_EDGES_HZ 4000000u

static const struct reg regs[] = {
    {"CR1", CR1, 0, 0xFFFFu, 0xFFFFu},
    {"CR2", CR2, 0, 0xF7u, 0xF7u},
    {"SR", SR, SR_TXE, 0x1FFu, 0},
    {"DR", DR, 0, 0xFFFFu, 0},
};

struct spi {
    struct board_event sampled, ended;
    uint64_t began_ns;
    uint8_t received, shifting, waiting;
    bool shifts, full;
    bool overrun_seen; /* DR has been read since the overrun */
};

/* Clock, in, out, and the alternate functions, of those packages with 64 pins. Pins and functions are from memory (unverified). */
static const struct spi_pins {
    uint8_t function, pins[2][3];
} pins_f4_of[] = {
    {5,
     {{PIN_NUMBER('A', 5), PIN_NUMBER('A', 6), PIN_NUMBER('A', 7)},
      {PIN_NUMBER('B', 3), PIN_NUMBER('B', 4), PIN_NUMBER('B', 5)}}},
    {5,
     {{PIN_NUMBER('B', 13), PIN_NUMBER('B', 14), PIN_NUMBER('B', 15)},
      {PIN_NUMBER('B', 10), PIN_NUMBER('C', 2), PIN_NUMBER('C', 3)}}},
    {6,
     {{PIN_NUMBER('C', 10), PIN_NUMBER('C', 11), PIN_NUMBER('C', 12)},
      {PIN_NUMBER('B', 3), PIN_NUMBER('B', 4), PIN_NUMBER('B', 5)}}},
};

/* Not remapped. SPI1 of the STM32F100 is on PA5 to PA7, and SPI2 on PB13 to PB15 (unverified). */
static const uint8_t pins_f1_of[2][3] = {
    {PIN_NUMBER('A', 5), PIN_NUMBER('A', 6), PIN_NUMBER('A', 7)},
    {PIN_NUMBER('B', 13), PIN_NUMBER('B', 14), PIN_NUMBER('B', 15)}};

static bool is_f1(const struct part *p)
{
    return p->row->class == &spi_f1_class;
}

/* On the STM32F100 clock and out are alternate functions, and what comes in is an input (unverified). */
static bool is_wired_f1(const struct part *p)
{
    const uint8_t *of = pins_f1_of[p->row->number - 1u];
    return pin_has_function(p->board, of[0], 0) && pin_has_function(p->board, of[1], PIN_INPUT) &&
           pin_has_function(p->board, of[2], 0);
}

static bool is_wired(const struct part *p)
{
    if (is_f1(p))
        return is_wired_f1(p);
    const struct spi_pins *of = &pins_f4_of[p->row->number - 1u];
    for (unsigned line = 0; line < 3; line++)
        if (!pin_has_function(p->board, of->pins[0][line], of->function) &&
            !pin_has_function(p->board, of->pins[1][line], of->function))
            return false;
    return true;
}

static uint64_t clock_hz(const struct part *p)
{
    return bus_clock_hz(p->board, p->row->bus) / (UINT64_C(2) << (part_get(p, CR1) >> 3 & 7u));
}

/* A clock of more than 4 MHz wants faster edges than a pin has after a reset, DS8626 (unverified). An output of the STM32F100 is for the frequency
 * in its name (RM0041 Rev 6, 7.2.1). */
static bool has_edges(const struct part *p)
{
    static const uint32_t f1_hz[] = {2000000u, 10000000u, 50000000u};
    if (is_f1(p))
        return clock_hz(p) <= f1_hz[pin_speed(p->board, pins_f1_of[p->row->number - 1u][0])];
    const struct spi_pins *of = &pins_f4_of[p->row->number - 1u];
    for (unsigned place = 0; place < 2; place++)
        if (pin_has_function(p->board, of->pins[place][0], of->function) &&
            clock_hz(p) > SLOW_EDGES_HZ && pin_speed(p->board, of->pins[place][0]) == 0)
            return false;
    return true;
}

static uint64_t halves_ns(const struct part *p, unsigned halves)
{
    uint64_t hz = clock_hz(p);
    return (halves * NS_PER_S + hz) / (2u * hz);
}

static void update_irq(struct part *p)
{
    uint32_t sr = part_get(p, SR), cr2 = part_get(p, CR2);
    interrupt_line(p->board, p->row->irq,
                   ((cr2 & CR2_RXNEIE) != 0 && (sr & SR_RXNE) != 0) ||
                       ((cr2 & CR2_TXEIE) != 0 && (sr & SR_TXE) != 0) ||
                       ((cr2 & CR2_ERRIE) != 0 && (sr & SR_OVR) != 0));
}

static void shift(struct part *p, uint8_t byte, uint64_t from_ns)
{
    struct spi *s = p->state;
    unsigned phase = part_get(p, CR1) & CR1_CPHA;
    s->shifts = true;
    s->shifting = byte;
    s->began_ns = from_ns;
    part_set(p, SR, part_get(p, SR) | SR_TXE | SR_BSY);
    board_schedule(p->board, &s->sampled, from_ns + halves_ns(p, 15u + phase));
    board_schedule(p->board, &s->ended, from_ns + halves_ns(p, 16u + phase));
}

static void sampled(void *context)
{
    struct part *p = context;
    struct spi *s = p->state;
    struct board *b = p->board;
    uint32_t sr = part_get(p, SR);
    uint8_t in = b->world.spi_exchange == NULL
                     ? 0xFF
                     : b->world.spi_exchange(b->world.context, board_ns(b), p->row->number,
                                             part_get(p, CR1) & 3u, s->shifting);
    if ((sr & SR_RXNE) != 0) {
        part_set(p, SR, sr | SR_OVR); /* what came is lost */
        s->overrun_seen = false;
    } else {
        s->received = in;
        part_set(p, SR, sr | SR_RXNE);
    }
    update_irq(p);
}

static void ended(void *context)
{
    struct part *p = context;
    struct spi *s = p->state;
    s->shifts = false;
    if (s->full) {
        s->full = false;
        shift(p, s->waiting, board_ns(p->board));
    } else {
        part_set(p, SR, part_get(p, SR) & ~SR_BSY);
    }
    update_irq(p);
}

static void start(struct part *p)
{
    struct spi *s = p->state;
    s->sampled = (struct board_event){.due = sampled, .context = p};
    s->ended = (struct board_event){.due = ended, .context = p};
    board_add_event(p->board, &s->sampled);
    board_add_event(p->board, &s->ended);
}

static void restart(struct part *p)
{
    struct spi *s = p->state;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    s->shifts = s->full = false;
    board_schedule(p->board, &s->sampled, BOARD_NEVER);
    board_schedule(p->board, &s->ended, BOARD_NEVER);
    interrupt_line(p->board, p->row->irq, false);
}

static void reset(struct part *p, enum board_reset kind)
{
    (void)kind;
    restart(p);
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    struct spi *s = p->state;
    if (offset == DR) {
        part_set(p, SR, part_get(p, SR) & ~SR_RXNE);
        s->overrun_seen = true;
        update_irq(p);
        return s->received;
    }
    if (offset == SR && s->overrun_seen) {
        s->overrun_seen = false;
        part_set(p, SR, stored & ~SR_OVR);
        update_irq(p);
    }
    return stored;
}

static void write_cr1(const struct part *p, uint32_t before, uint32_t written)
{
    struct board *b = p->board;
    const struct spi *s = p->state;
    const char *name = p->row->name;
    if ((written & ~CR1_KNOWN) != 0)
        board_verdict(b, "%s_CR1 of 0x%x is not modelled", name, written);
    else if ((written & CR1_SPE) == 0 && (before & CR1_SPE) != 0 && s->shifts)
        board_verdict(b, "%s is switched off while it is busy", name);
    else if ((before & written & CR1_SPE) != 0 && ((before ^ written) & CR1_FIXED) != 0)
        board_verdict(b, "%s_CR1 of 0x%x changes the frame while the part is on", name, written);
    else if ((written & CR1_SPE) != 0 &&
             (written & (CR1_MSTR | CR1_SSM | CR1_SSI)) != (CR1_MSTR | CR1_SSM | CR1_SSI))
        board_verdict(b, "%s_CR1 of 0x%x: only a master without an NSS pin is modelled", name,
                      written);
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    struct spi *s = p->state;
    struct board *b = p->board;
    if (offset == CR1) {
        write_cr1(p, before, written);
    } else if (offset == CR2) {
        if ((written & ~(CR2_ERRIE | CR2_RXNEIE | CR2_TXEIE)) != 0)
            board_verdict(b, "%s_CR2 of 0x%x is not modelled", p->row->name, written);
    } else if (offset == DR) {
        if ((part_get(p, CR1) & CR1_SPE) == 0)
            board_verdict(b, "a byte written to %s while it is off", p->row->name);
        else if (!is_wired(p))
            board_verdict(b, "%s sends while its pins are given to others", p->row->name);
        else if (!has_edges(p))
            board_verdict(b, "%s sends faster than the edges of its clock's pin", p->row->name);
        else if (s->full)
            board_verdict(b, "a byte written to %s_DR over one that was not sent", p->row->name);
        else if (!s->shifts)
            shift(p, (uint8_t)written, board_ns(b));
        else {
            s->full = true;
            s->waiting = (uint8_t)written;
            part_set(p, SR, part_get(p, SR) & ~SR_TXE);
        }
    }
    update_irq(p);
}

#define SPI_CLASS                                                                                  \
    .regs = regs, .n_regs = sizeof(regs) / sizeof(regs[0]), .state_bytes = sizeof(struct spi),     \
    .widths = WIDTH_HALF | WIDTH_WORD, .start = start, .reset = reset, .restart = restart,         \
    .read = read, .write = write

const struct part_class spi_class = {.name = "SPI", SPI_CLASS};
const struct part_class spi_f1_class = {.name = "SPI of the STM32F1", SPI_CLASS};
