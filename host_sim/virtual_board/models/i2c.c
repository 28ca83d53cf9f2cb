/* I2C of the STM32F405 as the only master, standard mode, addresses of 7 bits. Read in RM0008 Rev 15 26.3.3 (sequence of a master that receives one
 * byte) and 26.3.4 (bus error, acknowledge failure), whose part this is, too: RM0090 has it as chapter 27. From memory are the other things,
 * as follows. The registers and their bits are those of I2C_CR1, CR2, DR, SR1, SR2, CCR and TRISE (unverified). SB goes after a read of SR1 and a write
 * of DR, ADDR after reads of SR1 and SR2, BTF after a read of SR1 and an access of DR, or with a start or stop (unverified). While SB, ADDR or BTF is
 * set the clock is held low (unverified). POS makes ACK decide of the byte after the one that comes in, and is set before the first one does (unverified). No write of CR1 while START or
 * STOP waits (unverified). A master that refuses a byte and has not been told to stop goes on receiving, which ends the run here (unverified). A
 * level that is not the one that the master sends is a lost arbitration (unverified). START waits while the bus is busy, and SWRST
 * alone frees a BUSY that a glitch has set (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "pins.h"

enum { CR1 = 0x00, CR2 = 0x04, DR = 0x10, SR1 = 0x14, SR2 = 0x18, CCR = 0x1C, TRISE = 0x20 };

#define CR1_PE      1u
#define CR1_START   (UINT32_C(1) << 8)
#define CR1_STOP    (UINT32_C(1) << 9)
#define CR1_ACK     (UINT32_C(1) << 10)
#define CR1_POS     (UINT32_C(1) << 11)
#define CR1_SWRST   (UINT32_C(1) << 15)
#define CR1_KNOWN   (CR1_PE | CR1_START | CR1_STOP | CR1_ACK | CR1_POS | CR1_SWRST)
#define CR2_FREQ    0x3Fu
#define CR2_ITERREN (UINT32_C(1) << 8)
#define CR2_ITEVTEN (UINT32_C(1) << 9)
#define CR2_ITBUFEN (UINT32_C(1) << 10)
#define SR1_SB      1u
#define SR1_ADDR    2u
#define SR1_BTF     4u
#define SR1_RXNE    (UINT32_C(1) << 6)
#define SR1_TXE     (UINT32_C(1) << 7)
#define SR1_BERR    (UINT32_C(1) << 8)
#define SR1_ARLO    (UINT32_C(1) << 9)
#define SR1_AF      (UINT32_C(1) << 10)
#define SR1_ERRORS  0xDF00u
#define SR2_MSL     1u
#define SR2_BUSY    2u
#define SR2_TRA     4u
#define FUNCTION    4u
#define LOOK_NS     10000u /* how often a master looks at a line that is held */
#define MOST_HZ     100000u
#define NS_PER_S    UINT64_C(1000000000)

static const struct reg regs[] = {
    {"CR1", CR1, 0, 0xBFFBu, 0xBFFBu},
    {"CR2", CR2, 0, 0x1F3Fu, 0x1F3Fu},
    {"DR", DR, 0, 0xFFu, 0},
    {"SR1", SR1, 0, 0xDFDFu, 0},
    {"SR2", SR2, 0, 0xFFF7u, 0},
    {"CCR", CCR, 0, 0xCFFFu, 0xCFFFu},
    {"TRISE", TRISE, 2u, 0x3Fu, 0x3Fu},
};

enum phase {
    IDLE,
    STARTING,      /* or waiting for a free bus */
    AWAIT_ADDRESS, /* SB */
    SENDS_ADDRESS,
    AWAIT_LOOK, /* ADDR */
    AWAIT_DATA, /* TXE, and BTF after a byte */
    SENDS,
    RECEIVES,
    ACKNOWLEDGES, /* the ninth bit of what came in */
    STRETCHES,    /* DR and the shift register are full */
    REFUSED,      /* a byte was not acknowledged */
    STOPPING
};

struct i2c {
    struct board_event due;
    enum phase phase;
    uint8_t shifting, waiting, received;
    bool full; /* `waiting` is to be sent, or the shift register holds what is read behind a stop */
    bool reads;       /* the address said so */
    bool acknowledge; /* the byte that comes in, with POS */
    bool locked;      /* BUSY, by a glitch */
    bool pin_low[2];  /* clock and data, moved by hand */
    uint32_t seen;    /* flags that a read of SR1 has shown */
};

static const unsigned pins_of[][2][2] = {
    {{PIN_NUMBER('B', 6), PIN_NUMBER('B', 7)}, {PIN_NUMBER('B', 8), PIN_NUMBER('B', 9)}},
    {{PIN_NUMBER('B', 10), PIN_NUMBER('B', 11)}, {PIN_NUMBER('B', 10), PIN_NUMBER('B', 11)}},
};

/* One of the two places of its pins is given to it, as open drains. */
static bool is_wired(const struct part *p)
{
    for (unsigned place = 0; place < 2; place++) {
        const unsigned *pins = pins_of[p->row->number - 1u][place];
        if (pin_has_function(p->board, pins[0], FUNCTION) &&
            pin_has_function(p->board, pins[1], FUNCTION) && pin_is_open_drain(p->board, pins[0]) &&
            pin_is_open_drain(p->board, pins[1]))
            return true;
    }
    return false;
}

static unsigned held(const struct part *p)
{
    const struct world *w = &p->board->world;
    return w->i2c_held == NULL ? 0 : w->i2c_held(w->context, board_ns(p->board), p->row->number);
}

static void set(struct part *p, uint32_t offset, uint32_t on, uint32_t off)
{
    part_set(p, offset, (part_get(p, offset) & ~off) | on);
}

static void update_irq(struct part *p)
{
    uint32_t sr1 = part_get(p, SR1), cr2 = part_get(p, CR2);
    bool buffer = (cr2 & CR2_ITBUFEN) != 0 && (sr1 & (SR1_RXNE | SR1_TXE)) != 0;
    bool event = (sr1 & (SR1_SB | SR1_ADDR | SR1_BTF)) != 0 || buffer;
    interrupt_line(p->board, p->row->irq, (cr2 & CR2_ITEVTEN) != 0 && event);
    interrupt_line(p->board, p->row->irq + 1u, (cr2 & CR2_ITERREN) != 0 && (sr1 & SR1_ERRORS) != 0);
}

/* In half periods of the clock. */
static void after(struct part *p, enum phase phase, unsigned halves)
{
    struct i2c *i = p->state;
    uint64_t half = part_get(p, CCR) * NS_PER_S / bus_clock_hz(p->board, p->row->bus);
    i->phase = phase;
    board_schedule(p->board, &i->due, board_ns(p->board) + halves * half);
}

static void receive_next(struct part *p)
{
    after(p, RECEIVES, 16);
}

/* Between two bytes: a stop or a start that waits comes now. Returns false: none does. */
static bool turn(struct part *p)
{
    uint32_t cr1 = part_get(p, CR1);
    if ((cr1 & CR1_STOP) != 0)
        after(p, STOPPING, 1);
    else if ((cr1 & CR1_START) != 0)
        after(p, STARTING, 2);
    return (cr1 & (CR1_STOP | CR1_START)) != 0;
}

static void started(struct part *p)
{
    struct i2c *i = p->state;
    bool again = (part_get(p, SR2) & SR2_MSL) != 0;
    if ((part_get(p, CR1) & CR1_START) == 0) {
        i->phase = IDLE;
        return;
    }
    if (held(p) != 0 || (!again && i->locked)) { /* it waits for a free bus */
        board_schedule(p->board, &i->due, board_ns(p->board) + LOOK_NS);
        return;
    }
    set(p, CR1, 0, CR1_START);
    set(p, SR1, SR1_SB, SR1_BTF | SR1_TXE);
    set(p, SR2, SR2_MSL | SR2_BUSY, SR2_TRA);
    i->full = false;
    i->phase = AWAIT_ADDRESS;
}

static void lose(struct part *p)
{
    struct i2c *i = p->state;
    set(p, SR1, SR1_ARLO, SR1_BTF | SR1_TXE);
    set(p, SR2, 0, SR2_MSL | SR2_BUSY | SR2_TRA);
    i->phase = IDLE;
    i->full = false;
}

/* The address or a byte has gone out, with its ninth bit. */
static void byte_sent(struct part *p)
{
    struct i2c *i = p->state;
    const struct world *w = &p->board->world;
    uint64_t now = board_ns(p->board);
    bool address = i->phase == SENDS_ADDRESS, acknowledged = false;
    if ((held(p) & I2C_DATA_HELD) != 0 && i->shifting != 0) {
        lose(p);
        return;
    }
    if (address && w->i2c_address != NULL)
        acknowledged = w->i2c_address(w->context, now, p->row->number, i->shifting >> 1, i->reads);
    else if (!address && w->i2c_write != NULL)
        acknowledged = w->i2c_write(w->context, now, p->row->number, i->shifting);
    if (!acknowledged) {
        set(p, SR1, SR1_AF, 0);
        i->phase = REFUSED;
        (void)turn(p);
    } else if (address) {
        set(p, SR1, SR1_ADDR, 0);
        set(p, SR2, i->reads ? 0 : SR2_TRA, 0);
        i->phase = AWAIT_LOOK;
    } else if (i->full) {
        i->full = false;
        i->shifting = i->waiting;
        set(p, SR1, SR1_TXE, 0);
        after(p, SENDS, 18);
    } else if (!turn(p)) {
        set(p, SR1, SR1_TXE | SR1_BTF, 0);
        i->phase = AWAIT_DATA;
    }
}

/* The eight bits are there: which acknowledge bit follows is decided now. */
static void byte_received(struct part *p)
{
    struct i2c *i = p->state;
    bool ack = (part_get(p, CR1) & CR1_ACK) != 0, with_pos = (part_get(p, CR1) & CR1_POS) != 0;
    bool now = with_pos ? i->acknowledge : ack;
    i->shifting = now ? 1u : 0;
    i->acknowledge = ack;
    after(p, ACKNOWLEDGES, 2);
}

static void acknowledged(struct part *p)
{
    struct i2c *i = p->state;
    const struct world *w = &p->board->world;
    bool ack = i->shifting != 0;
    uint8_t byte = w->i2c_read == NULL
                       ? 0xFF
                       : w->i2c_read(w->context, board_ns(p->board), p->row->number, ack);
    if ((held(p) & I2C_DATA_HELD) != 0)
        byte = 0;
    if ((part_get(p, SR1) & SR1_RXNE) != 0) {
        i->shifting = byte;
        set(p, SR1, SR1_BTF, 0);
        i->phase = STRETCHES;
        i->full = turn(p); /* what the shift register holds is read behind the stop */
        return;
    }
    i->received = byte;
    set(p, SR1, SR1_RXNE, 0);
    if (turn(p))
        return;
    if (!ack)
        board_verdict(p->board, "%s receives behind a byte that it has refused", p->row->name);
    receive_next(p);
}

static void stopped(struct part *p)
{
    struct i2c *i = p->state;
    const struct world *w = &p->board->world;
    if ((held(p) & I2C_DATA_HELD) != 0) { /* no edge can be made */
        board_schedule(p->board, &i->due, board_ns(p->board) + LOOK_NS);
        return;
    }
    if (w->i2c_stop != NULL)
        w->i2c_stop(w->context, board_ns(p->board), p->row->number);
    set(p, CR1, 0, CR1_STOP);
    set(p, SR1, 0, SR1_TXE | ((part_get(p, SR1) & SR1_RXNE) != 0 ? 0 : SR1_BTF));
    set(p, SR2, 0, SR2_MSL | SR2_BUSY | SR2_TRA);
    i->phase = IDLE;
    if ((part_get(p, CR1) & CR1_START) != 0)
        after(p, STARTING, 2);
}

static void due(void *context)
{
    struct part *p = context;
    struct i2c *i = p->state;
    if ((held(p) & I2C_CLOCK_HELD) != 0) { /* somebody stretches the clock */
        board_schedule(p->board, &i->due, board_ns(p->board) + LOOK_NS);
        return;
    }
    switch (i->phase) {
    case STARTING:
        started(p);
        break;
    case SENDS_ADDRESS:
    case SENDS:
        byte_sent(p);
        break;
    case RECEIVES:
        byte_received(p);
        break;
    case ACKNOWLEDGES:
        acknowledged(p);
        break;
    case STOPPING:
        stopped(p);
        break;
    default:
        break;
    }
    update_irq(p);
}

static void start(struct part *p)
{
    struct i2c *i = p->state;
    i->due = (struct board_event){.due = due, .context = p};
    board_add_event(p->board, &i->due);
}

static void clear(struct part *p)
{
    struct i2c *i = p->state;
    i->phase = IDLE;
    i->full = false;
    i->seen = 0;
    part_set(p, SR1, 0);
    part_set(p, SR2, 0);
    board_schedule(p->board, &i->due, BOARD_NEVER);
}

static void restart(struct part *p)
{
    struct i2c *i = p->state;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    i->locked = false;
    clear(p);
    update_irq(p);
}

static void reset(struct part *p, enum board_reset kind)
{
    (void)kind;
    restart(p);
}

/* After reads of SR1 and SR2: the byte begins that comes in, or the first one is awaited. */
static void looked(struct part *p)
{
    struct i2c *i = p->state;
    set(p, SR1, 0, SR1_ADDR);
    if (i->reads) {
        i->acknowledge = (part_get(p, CR1) & CR1_ACK) != 0;
        receive_next(p);
    } else if (!turn(p)) {
        set(p, SR1, SR1_TXE, 0);
        i->phase = AWAIT_DATA;
    }
}

static uint32_t read_data(struct part *p)
{
    struct i2c *i = p->state;
    uint8_t byte = i->received;
    if ((i->seen & SR1_BTF) != 0)
        set(p, SR1, 0, SR1_BTF);
    if ((part_get(p, SR1) & SR1_RXNE) == 0)
        return byte;
    if (i->phase == STRETCHES || ((i->phase == STOPPING || i->phase == IDLE) && i->full)) {
        i->received = i->shifting;
        i->full = false;
        if (i->phase == STRETCHES)
            receive_next(p);
    } else {
        set(p, SR1, 0, SR1_RXNE);
    }
    return byte;
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    struct i2c *i = p->state;
    uint32_t word = stored;
    if (offset == SR1) {
        i->seen = stored;
    } else if (offset == SR2) {
        if (i->phase == AWAIT_LOOK && (i->seen & SR1_ADDR) != 0)
            looked(p);
        word = stored | (held(p) != 0 || i->locked ? SR2_BUSY : 0);
    } else if (offset == DR) {
        word = read_data(p);
    }
    update_irq(p);
    return word;
}

static void write_data(struct part *p, uint8_t byte)
{
    struct i2c *i = p->state;
    if (i->phase == AWAIT_ADDRESS && (i->seen & SR1_SB) != 0) {
        i->reads = (byte & 1u) != 0;
        i->shifting = byte;
        set(p, SR1, 0, SR1_SB);
        after(p, SENDS_ADDRESS, 18);
    } else if (i->phase == AWAIT_DATA) {
        if ((i->seen & SR1_BTF) != 0)
            set(p, SR1, 0, SR1_BTF);
        i->shifting = byte;
        after(p, SENDS, 18);
    } else if (i->phase == SENDS && !i->full) {
        i->full = true;
        i->waiting = byte;
        set(p, SR1, 0, SR1_TXE);
    } else {
        board_verdict(p->board, "a byte written to %s_DR when none is awaited", p->row->name);
    }
}

/* The clock that the settings give, and whether they fit the bus that feeds the part. */
static void check_rate(struct part *p)
{
    uint64_t from = bus_clock_hz(p->board, p->row->bus);
    uint32_t freq = part_get(p, CR2) & CR2_FREQ, ccr = part_get(p, CCR);
    if ((ccr & 0xF000u) != 0 || ccr < 4u || from / (UINT64_C(2) * ccr) > MOST_HZ)
        board_verdict(p->board, "%s_CCR of 0x%x: at most 100 kHz are modelled", p->row->name, ccr);
    else if (freq != from / 1000000u || part_get(p, TRISE) != freq + 1u)
        board_verdict(p->board, "%s_CR2 and _TRISE of %u and %u do not fit a bus of %llu Hz",
                      p->row->name, freq, part_get(p, TRISE), (unsigned long long)from);
}

static void ask_stop(struct part *p)
{
    struct i2c *i = p->state;
    if (i->phase == STRETCHES)
        i->full = true; /* the byte in the shift register is read behind the stop */
    if (i->phase == STRETCHES || i->phase == AWAIT_DATA || i->phase == REFUSED)
        after(p, STOPPING, 1);
    else if (i->phase == IDLE || i->phase == STARTING)
        board_verdict(p->board, "%s is told to stop when nothing runs", p->row->name);
}

static void ask_start(struct part *p)
{
    struct i2c *i = p->state;
    if (!is_wired(p))
        board_verdict(p->board, "%s starts while its pins are no open drains of its own",
                      p->row->name);
    check_rate(p);
    if (i->phase == IDLE || i->phase == AWAIT_DATA || i->phase == REFUSED || i->phase == STRETCHES)
        after(p, STARTING, 2);
}

static bool is_receiving(const struct i2c *i)
{
    return i->phase == RECEIVES || i->phase == ACKNOWLEDGES || i->phase == STRETCHES;
}

static void write_cr1(struct part *p, uint32_t before, uint32_t written)
{
    struct board *b = p->board;
    if ((written & ~CR1_KNOWN) != 0) {
        board_verdict(b, "%s_CR1 of 0x%x is not modelled", p->row->name, written);
    } else if ((written & CR1_SWRST) != 0) {
        restart(p);
        part_set(p, CR1, written & CR1_SWRST);
    } else if ((before & (CR1_START | CR1_STOP)) != 0) {
        board_verdict(b, "write of %s_CR1 while a start or a stop waits", p->row->name);
    } else if ((written & ~before & CR1_POS) != 0 && is_receiving(p->state)) {
        board_verdict(b, "POS of %s is set when a byte comes in already", p->row->name);
    } else if ((written & CR1_PE) == 0) {
        clear(p);
    } else if ((written & CR1_STOP) != 0) {
        ask_stop(p);
    } else if ((written & CR1_START) != 0) {
        ask_start(p);
    }
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    if (offset == CR1)
        write_cr1(p, before, written);
    else if (offset == SR1)
        part_set(p, SR1, before & (written | ~SR1_ERRORS));
    else if (offset == DR)
        write_data(p, (uint8_t)written);
    else if (offset == CR2 && (written & 0x1800u) != 0)
        board_verdict(p->board, "%s by DMA is not modelled", p->row->name);
    else if ((offset == CCR || offset == TRISE) && (part_get(p, CR1) & CR1_PE) != 0 &&
             written != before)
        board_verdict(p->board, "the clock of %s changes while the part is on", p->row->name);
    update_irq(p);
}

/* ---- the lines as pins ---- */

static const char *const names[] = {"I2C1", "I2C2"};

/* The bus that has this pin; NULL: none. line: 0 clock, 1 data. */
static struct part *bus_of_pin(struct board *b, unsigned pin, unsigned *line)
{
    for (unsigned k = 0; k < 2; k++)
        for (unsigned place = 0; place < 2; place++)
            for (*line = 0; *line < 2; (*line)++)
                if (pins_of[k][place][*line] == pin)
                    return bus_part(b, names[k]);
    return NULL;
}

bool i2c_holds_pin(struct board *b, unsigned pin)
{
    unsigned line;
    const struct part *p = bus_of_pin(b, pin, &line);
    return p != NULL && (held(p) >> line & 1u) != 0;
}

/* A rising clock is a pulse; rising data while the clock is high is a stop. */
void i2c_pin_moved(struct board *b, unsigned pin, enum pin_drive drive)
{
    unsigned line;
    const struct part *p = bus_of_pin(b, pin, &line);
    if (p == NULL)
        return;
    struct i2c *i = p->state;
    const struct world *w = &b->world;
    bool was_low = i->pin_low[line];
    i->pin_low[line] = drive == PIN_LOW;
    if (!was_low || i->pin_low[line])
        return;
    if (line == 0 && w->i2c_clock != NULL && (held(p) & I2C_CLOCK_HELD) == 0)
        w->i2c_clock(w->context, board_ns(b), p->row->number);
    if (line == 1 && w->i2c_stop != NULL && !i->pin_low[0] && held(p) == 0)
        w->i2c_stop(w->context, board_ns(b), p->row->number);
}

void i2c_lock_busy(struct board *b, unsigned bus)
{
    struct i2c *i = bus_part(b, names[bus - 1u])->state;
    i->locked = true;
}

void i2c_tell_bus_error(struct board *b, unsigned bus)
{
    struct part *p = bus_part(b, names[bus - 1u]);
    set(p, SR1, SR1_BERR, 0);
    update_irq(p);
}

const struct part_class i2c_class = {.name = "I2C",
                                     .regs = regs,
                                     .n_regs = sizeof(regs) / sizeof(regs[0]),
                                     .state_bytes = sizeof(struct i2c),
                                     .widths = WIDTH_HALF | WIDTH_WORD,
                                     .start = start,
                                     .reset = reset,
                                     .restart = restart,
                                     .read = read,
                                     .write = write};
