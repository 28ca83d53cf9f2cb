/* 1-wire over serial ports in half duplex with an open drain (bus_hardware.h says which). A byte of the port is a pulse of the wire, and what the
 * port hears meanwhile is the answer:
 *     9,600 baud, F0h    low for 520 us, then 520 us in which a chip pulls: other than F0h
 *     115,200 baud, 00h  low for 78 us: a 0
 *     115,200 baud, FFh  low for 9 us: a 1, or a bit asked for. Its first bit is looked at 13 us after the slot began, before a chip may let go.
 * An interrupt for each bit. A wire that is still low at the end of a slot, when no chip pulls any more, is shorted.
 *
 * Noise flags mean nothing here, because a chip may pull and let go in the middle of a sample.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "hal/onewire.h"

#include <stddef.h>

#include "board.h"
#include "bus_hardware.h"
#include "io_interrupts.h"
#include "pin_map.h"
#include "registers.h"

#define FUNCTION    WIRE_FUNCTION
#define RESET_BAUD  9600u
#define BIT_BAUD    115200u
#define RESET_BYTE  0xF0u
#define SEARCH_ROM  0xF0u
#define SEARCH_BITS 64u
#define PORT_ON     (USART_CR1_UE | USART_CR1_TE | USART_CR1_RE)

static const struct wire_hardware {
    uint32_t base, clock;
    uint8_t irq, fast; /* fast: on APB2 */
    hal_pin pin;
} hardware[WIRES] = {WIRE_HARDWARE};

enum wire_stage {
    WIRE_PRESENCE, /* the reset pulse is under way */
    WIRE_BYTES,
    WIRE_COMMAND, /* of a search */
    WIRE_FIRST,   /* a bit of the addresses, then its complement, then the choice */
    WIRE_SECOND,
    WIRE_CHOICE
};

static struct wire_run {
    struct transfer *volatile transfer; /* NULL: the wire is free */
    volatile uint8_t *branch;           /* of a search; NULL: none */
    uint16_t slot, slots;               /* number of the next bit, and how many there are */
    uint8_t stage;
    uint8_t first;    /* bit of the addresses that has been read */
    uint8_t last_way; /* place of the last choice that was 0 */
    bool sent, ready; /* sent: the bit under way */
} runs[WIRES];

uint8_t hal_onewire_buses(void)
{
    return WIRES;
}

bool hal_onewire_pin(uint8_t bus, hal_pin *pin)
{
    if (bus == 0 || bus > WIRES) {
        return false;
    }
    *pin = hardware[bus - 1u].pin;
    return true;
}

static void set_baud(const struct wire_hardware *h, uint32_t baud)
{
    uint32_t from = h->fast ? clock_apb2_hz() : clock_apb1_hz();
    USART_BRR(h->base) = (from + baud / 2u) / baud;
}

enum err hal_onewire_open(uint8_t bus)
{
    if (bus == 0 || bus > WIRES) {
        return ERR_RANGE;
    }
    const struct wire_hardware *h = &hardware[bus - 1u];
    struct wire_run *r = &runs[bus - 1u];
    if (r->ready) {
        return ERR_OK;
    }
    volatile uint32_t *enable = h->fast ? &RCC_APB2ENR : &RCC_APB1ENR;
    uint32_t before = io_hold();
    *enable |= h->clock;
    (void)*enable;
    io_release(before);
    USART_CR3(h->base) = USART_CR3_HDSEL;
    set_baud(h, RESET_BAUD);
    USART_CR1(h->base) = PORT_ON;
    pin_give(h->pin, FUNCTION, PIN_OPEN_DRAIN, true);
    io_interrupt_on(h->irq);
    r->ready = true;
    return ERR_OK;
}

static enum err begin(uint8_t bus, struct transfer *transfer, volatile uint8_t *branch)
{
    if (bus == 0 || bus > WIRES) {
        return ERR_RANGE;
    }
    const struct wire_hardware *h = &hardware[bus - 1u];
    struct wire_run *r = &runs[bus - 1u];
    if (!r->ready || r->transfer != NULL) {
        return ERR_STATE;
    }
    r->branch = branch;
    r->stage = WIRE_PRESENCE;
    transfer->state = TRANSFER_RUNS;
    r->transfer = transfer;
    set_baud(h, RESET_BAUD);
    (void)USART_SR(h->base);
    (void)USART_DR(h->base);
    (void)USART_SR(
        h->base); /* this read and the write clear the flag that the next interrupt is for */
    USART_DR(h->base) = RESET_BYTE;
    USART_CR1(h->base) = PORT_ON | USART_CR1_TCIE;
    return ERR_OK;
}

enum err hal_onewire_start(uint8_t bus, struct transfer *transfer)
{
    return begin(bus, transfer, NULL);
}

enum err hal_onewire_search(uint8_t bus, struct transfer *transfer, volatile uint8_t *branch)
{
    return begin(bus, transfer, branch);
}

static void end(const struct wire_hardware *h, struct wire_run *r, enum transfer_state state)
{
    struct transfer *t = r->transfer;
    USART_CR1(h->base) = PORT_ON;
    r->transfer = NULL;
    t->state = (uint8_t)state;
}

static void send(const struct wire_hardware *h, struct wire_run *r, bool bit)
{
    r->sent = bit;
    USART_DR(h->base) = bit ? 0xFFu : 0u;
}

/* Sends the next bit of the bytes: those of `out`, then ones for those that come in. */
static void send_bytes(const struct wire_hardware *h, struct wire_run *r)
{
    const struct transfer *t = r->transfer;
    unsigned k = r->slot / 8u;
    send(h, r, k >= t->n_out || (t->out[k] >> r->slot % 8u & 1u) != 0);
}

/* After the reset pulse. A chip that is there has pulled within it, and let go. */
static void after_reset(const struct wire_hardware *h, struct wire_run *r, uint8_t byte)
{
    const struct transfer *t = r->transfer;
    if (byte == RESET_BYTE) {
        end(h, r, TRANSFER_NO_ANSWER);
        return;
    }
    r->slot = 0;
    r->slots = (uint16_t)(8u * (r->branch != NULL ? 1u : (unsigned)t->n_out + t->n_in));
    r->stage = r->branch != NULL ? WIRE_COMMAND : WIRE_BYTES;
    if (r->slots == 0) {
        end(h, r, TRANSFER_DONE);
        return;
    }
    set_baud(h, BIT_BAUD);
    USART_CR1(h->base) = PORT_ON | USART_CR1_RXNEIE;
    if (r->branch != NULL) {
        send(h, r, (SEARCH_ROM & 1u) != 0);
    } else {
        send_bytes(h, r);
    }
}

/* Returns false: a 1 has gone out, and the wire was low. */
static bool take_bit(struct wire_run *r, bool bit)
{
    const struct transfer *t = r->transfer;
    unsigned k = r->slot / 8u, place = r->slot % 8u;
    if (k < t->n_out) {
        return bit == r->sent;
    }
    uint8_t *in = &t->in[k - t->n_out];
    *in = (uint8_t)((place == 0 ? 0 : *in) | (bit ? 1u : 0u) << place);
    return true;
}

static void byte_bit(const struct wire_hardware *h, struct wire_run *r, bool bit)
{
    if (!take_bit(r, bit)) {
        end(h, r, TRANSFER_FAILED);
    } else if (++r->slot == r->slots) {
        end(h, r, TRANSFER_DONE);
    } else {
        send_bytes(h, r);
    }
}

static void command_bit(const struct wire_hardware *h, struct wire_run *r, bool bit)
{
    if (bit != r->sent) {
        end(h, r, TRANSFER_FAILED);
    } else if (++r->slot < 8u) {
        send(h, r, (SEARCH_ROM >> r->slot & 1u) != 0);
    } else {
        r->slot = r->last_way = 0;
        r->stage = WIRE_FIRST;
        send(h, r, true);
    }
}

/* The way on at a place where chips differ: as the pass before went, at its last choice the other one, and behind that 0 first. */
static bool way_at(const struct wire_run *r, unsigned place, bool before)
{
    return place < *r->branch ? before : place == *r->branch;
}

static void second_bit(const struct wire_hardware *h, struct wire_run *r, bool second)
{
    uint8_t *in = &r->transfer->in[r->slot / 8u], mask = (uint8_t)(1u << r->slot % 8u);
    bool first = r->first != 0, way = first;
    if (first && second) {
        end(h, r, TRANSFER_NO_ANSWER); /* no chip goes on here */
        return;
    }
    if (!first && !second) {
        way = way_at(r, r->slot + 1u, (*in & mask) != 0);
        if (!way) {
            r->last_way = (uint8_t)(r->slot + 1u);
        }
    }
    *in = (uint8_t)(way ? *in | mask : *in & ~mask);
    r->stage = WIRE_CHOICE;
    send(h, r, way);
}

static void choice_bit(const struct wire_hardware *h, struct wire_run *r, bool bit)
{
    if (bit != r->sent) {
        end(h, r, TRANSFER_FAILED);
    } else if (++r->slot == SEARCH_BITS) {
        *r->branch = r->last_way;
        end(h, r, TRANSFER_DONE);
    } else {
        r->stage = WIRE_FIRST;
        send(h, r, true);
    }
}

static void serve_wire(unsigned bus)
{
    const struct wire_hardware *h = &hardware[bus];
    struct wire_run *r = &runs[bus];
    uint32_t status = USART_SR(h->base);
    if (r->transfer == NULL || (status & USART_SR_RXNE) == 0) {
        return; /* it was pending when hal_onewire_stop() ended the transfer */
    }
    uint8_t byte = (uint8_t)USART_DR(h->base);
    bool bit = (byte & 1u) != 0;
    if ((status & (USART_SR_FE | USART_SR_ORE)) != 0) {
        end(h, r, TRANSFER_FAILED);
        return;
    }
    switch (r->stage) {
    case WIRE_PRESENCE:
        after_reset(h, r, byte);
        break;
    case WIRE_BYTES:
        byte_bit(h, r, bit);
        break;
    case WIRE_COMMAND:
        command_bit(h, r, bit);
        break;
    case WIRE_FIRST:
        r->first = bit ? 1u : 0u;
        r->stage = WIRE_SECOND;
        send(h, r, true);
        break;
    case WIRE_SECOND:
        second_bit(h, r, bit);
        break;
    default:
        choice_bit(h, r, bit);
        break;
    }
}

void WIRE1_INTERRUPT(void)
{
    serve_wire(0);
}

#if WIRES > 1
void WIRE2_INTERRUPT(void)
{
    serve_wire(1);
}
#endif

/* A reset of the port ends a pulse on its way. */
void hal_onewire_stop(uint8_t bus)
{
    if (bus == 0 || bus > WIRES) {
        return;
    }
    const struct wire_hardware *h = &hardware[bus - 1u];
    struct wire_run *r = &runs[bus - 1u];
    uint32_t before = io_hold();
    struct transfer *t = r->transfer;
    if (t != NULL) {
        io_reset_bus(h->fast, h->clock);
        USART_CR3(h->base) = USART_CR3_HDSEL;
        set_baud(h, RESET_BAUD);
        USART_CR1(h->base) = PORT_ON;
        r->transfer = NULL;
        t->state = TRANSFER_FAILED;
    }
    io_release(before);
}
