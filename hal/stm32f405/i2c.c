/* I2C1 on PB6 and PB7, I2C2 on PB10 and PB11 (RM0090 chapter 27), an interrupt for each byte. The clock is 88 kHz and not the 100 kHz of the
 * contract: Above 88 kHz the part may make a start again too soon behind the clock's edge, as ES0182 has it (unverified).
 *
 * The part decides by itself what it does with the byte after the one that the program looks at, so the end of a reception is told it early, as
 * RM0008 26.3.3 has it, whose part is the same: for one byte, "refuse" before the address is acknowledged and "stop" behind that; for two, "refuse
 * the next"; for more, when three are left, of which two have come. But for the first of these, all is done while the part holds the clock,
 * so that nothing depends on how late an interrupt is. The first of them has the time of a byte, 100 us.
 *
 * What a glitch or a reset of the board in a transfer leaves behind:
 *     a chip that holds the data line     it is clocked until it lets go, nine times at most, and told to stop
 *     BUSY, with both lines high          the part is reset and set up again
 *     a bus error                         nothing: the part may tell one that was none, and goes on in any case (ES0182)
 * What errors the errata sheet has of this part is from memory (unverified). A clock that a chip holds for ever cannot be helped: transfers on this bus
 * fail until it lets go.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "hal/i2c.h"

#include <stddef.h>

#include "board.h"
#include "board_pins.h"
#include "hal/clock.h"
#include "io_interrupts.h"
#include "pin_map.h"
#include "registers.h"

#define BUSES       2u
#define FUNCTION    4u
#define BUS_HZ      88000u
#define CLOCKS_MOST 9u /* of a byte and its acknowledge bit */
#define HALF_US     5u /* of the bus's clock */
#define STOP_TURNS  4u /* two periods of the bus's clock */

_Static_assert(BUS_HZ <= HAL_I2C_HZ, "faster than the contract allows");

static const struct i2c_hardware {
    uint32_t base, clock;
    uint8_t event_irq, error_irq;
    hal_pin pins[2]; /* clock, data */
} hardware[BUSES] = {
    {0x40005400u, BIT(21), I2C1_EV_IRQ, I2C1_ER_IRQ, {I2C1_PINS}},
    {0x40005800u, BIT(22), I2C2_EV_IRQ, I2C2_ER_IRQ, {I2C2_PINS}},
};

static struct i2c_run {
    struct transfer *volatile transfer; /* NULL: the bus is free */
    uint8_t address, sent, received;
    bool reads; /* the address goes out, or has gone out, to read */
    bool ready;
} runs[BUSES];

uint8_t hal_i2c_buses(void)
{
    return BUSES;
}

bool hal_i2c_pins(uint8_t bus, hal_pin pins[2])
{
    if (bus == 0 || bus > BUSES) {
        return false;
    }
    pins[0] = hardware[bus - 1u].pins[0];
    pins[1] = hardware[bus - 1u].pins[1];
    return true;
}

/* Three cycles a turn at the least. */
static void wait_half(void)
{
    for (uint32_t turns = hal_core_hz() / 1000000u * HALF_US / 3u + 1u; turns > 0; turns--) {
        __asm volatile("" ::: "memory");
    }
}

static void move_line(hal_pin pin, bool high)
{
    hal_pin_write(pin, high);
    wait_half();
}

/* By hand, as open drains. 100 us where a chip holds the data line, 15 us otherwise. */
static void free_lines(const struct i2c_hardware *h)
{
    hal_pin clock = h->pins[0], data = h->pins[1];
    pin_make_output(clock, PIN_OPEN_DRAIN, true);
    pin_make_output(data, PIN_OPEN_DRAIN, true);
    wait_half();
    if (hal_pin_read(data) || !hal_pin_read(clock)) {
        return;
    }
    for (unsigned i = 0; i < CLOCKS_MOST && !hal_pin_read(data); i++) {
        move_line(clock, false);
        move_line(clock, true);
    }
    move_line(clock, false);
    move_line(data, false);
    move_line(clock, true);
    move_line(data, true); /* a stop */
}

static void make_ready(const struct i2c_hardware *h)
{
    uint32_t mhz = clock_apb1_hz() / 1000000u;
    I2C_CR1(h->base) = I2C_CR1_SWRST;
    free_lines(h);
    I2C_CR1(h->base) = 0;
    pin_give(h->pins[0], FUNCTION, PIN_OPEN_DRAIN, true);
    pin_give(h->pins[1], FUNCTION, PIN_OPEN_DRAIN, true);
    I2C_CR2(h->base) = mhz;
    I2C_CCR(h->base) = (clock_apb1_hz() + 2u * BUS_HZ - 1u) / (2u * BUS_HZ);
    I2C_TRISE(h->base) = mhz + 1u; /* edges of 1 us at most */
    I2C_CR1(h->base) = I2C_CR1_PE;
}

enum err hal_i2c_open(uint8_t bus)
{
    if (bus == 0 || bus > BUSES) {
        return ERR_RANGE;
    }
    const struct i2c_hardware *h = &hardware[bus - 1u];
    struct i2c_run *r = &runs[bus - 1u];
    if (r->ready) {
        return ERR_OK;
    }
    uint32_t before = io_hold();
    RCC_APB1ENR |= h->clock;
    (void)RCC_APB1ENR;
    io_release(before);
    make_ready(h);
    io_interrupt_on(h->event_irq);
    io_interrupt_on(h->error_irq);
    r->ready = true;
    return ERR_OK;
}

/* The stop of the transfer before takes 10 us, and nothing tells that it is over. Returns false: the bus is not free. */
static bool is_free(const struct i2c_hardware *h)
{
    for (unsigned i = 0; i < STOP_TURNS && (I2C_CR1(h->base) & I2C_CR1_STOP) != 0; i++) {
        wait_half();
    }
    return (I2C_CR1(h->base) & (I2C_CR1_STOP | I2C_CR1_START)) == 0 &&
           (I2C_SR2(h->base) & I2C_SR2_BUSY) == 0;
}

static void send_start(const struct i2c_hardware *h, const struct i2c_run *r)
{
    bool two = r->reads && r->transfer->n_in == 2u;
    I2C_CR1(h->base) = I2C_CR1_PE | I2C_CR1_START | I2C_CR1_ACK | (two ? I2C_CR1_POS : 0);
}

enum err hal_i2c_start(uint8_t bus, uint8_t address, struct transfer *transfer)
{
    if (bus == 0 || bus > BUSES || address > 127u) {
        return ERR_RANGE;
    }
    const struct i2c_hardware *h = &hardware[bus - 1u];
    struct i2c_run *r = &runs[bus - 1u];
    if (!r->ready || r->transfer != NULL) {
        return ERR_STATE;
    }
    if (!is_free(h)) {
        make_ready(h);
        if (!is_free(h)) {
            transfer->state = TRANSFER_FAILED;
            return ERR_OK;
        }
    }
    r->address = address;
    r->sent = r->received = 0;
    r->reads = transfer->n_out == 0 && transfer->n_in > 0;
    transfer->state = TRANSFER_RUNS;
    r->transfer = transfer;
    I2C_CR2(h->base) = clock_apb1_hz() / 1000000u | I2C_CR2_ITERREN | I2C_CR2_ITEVTEN;
    send_start(h, r);
    return ERR_OK;
}

static void end_i2c(const struct i2c_hardware *h, struct i2c_run *r, enum transfer_state state)
{
    struct transfer *t = r->transfer;
    I2C_CR2(h->base) = clock_apb1_hz() / 1000000u;
    r->transfer = NULL;
    t->state = (uint8_t)state;
}

static void send_stop(const struct i2c_hardware *h)
{
    I2C_CR1(h->base) = I2C_CR1_PE | I2C_CR1_STOP;
}

static void take_byte(const struct i2c_hardware *h, struct i2c_run *r)
{
    r->transfer->in[r->received++] = (uint8_t)I2C_DR(h->base);
}

/* The address has been acknowledged. A read of SR2, behind one of SR1, lets the part go on. */
static void address_taken(const struct i2c_hardware *h, struct i2c_run *r)
{
    const struct transfer *t = r->transfer;
    if (!r->reads) {
        (void)I2C_SR2(h->base);
        if (t->n_out == 0) { /* nothing but an address */
            send_stop(h);
            end_i2c(h, r, TRANSFER_DONE);
        } else {
            I2C_DR(h->base) = t->out[r->sent++];
        }
    } else if (t->n_in == 1u) {
        I2C_CR1(h->base) = I2C_CR1_PE;
        (void)I2C_SR2(h->base);
        send_stop(h);
        I2C_CR2(h->base) |= I2C_CR2_ITBUFEN;
    } else {
        (void)I2C_SR2(h->base);
        if (t->n_in == 2u) {
            I2C_CR1(h->base) = I2C_CR1_PE | I2C_CR1_POS;
        }
    }
}

/* Two bytes have come, one in DR, the other behind it. */
static void two_received(const struct i2c_hardware *h, struct i2c_run *r)
{
    unsigned left = (unsigned)r->transfer->n_in - r->received;
    if (left > 2u) {
        if (left == 3u) {
            I2C_CR1(h->base) = I2C_CR1_PE; /* the last one is refused */
        }
        take_byte(h, r);
        return;
    }
    send_stop(h);
    take_byte(h, r);
    take_byte(h, r);
    end_i2c(h, r, TRANSFER_DONE);
}

/* A byte has gone out, and the part holds the clock. */
static void byte_sent(const struct i2c_hardware *h, struct i2c_run *r)
{
    const struct transfer *t = r->transfer;
    if (r->sent < t->n_out) {
        I2C_DR(h->base) = t->out[r->sent++];
    } else if (t->n_in > 0) {
        r->reads = true;
        send_start(h, r);
        (void)I2C_DR(h->base); /* BTF goes: no more interrupts until the start is there */
    } else {
        send_stop(h);
        end_i2c(h, r, TRANSFER_DONE);
    }
}

static void serve_event(unsigned bus)
{
    const struct i2c_hardware *h = &hardware[bus];
    struct i2c_run *r = &runs[bus];
    uint32_t sr1 = I2C_SR1(h->base);
    if (r->transfer == NULL) {
        return; /* it was pending when hal_i2c_stop() ended the transfer */
    }
    if ((sr1 & I2C_SR1_SB) != 0) {
        I2C_DR(h->base) = (uint32_t)r->address << 1 | (r->reads ? 1u : 0);
    } else if ((sr1 & I2C_SR1_ADDR) != 0) {
        address_taken(h, r);
    } else if ((sr1 & I2C_SR1_BTF) != 0) {
        if (r->reads) {
            two_received(h, r);
        } else {
            byte_sent(h, r);
        }
    } else if ((sr1 & I2C_SR1_RXNE) != 0 && r->reads && r->transfer->n_in == 1u) {
        take_byte(h, r);
        end_i2c(h, r, TRANSFER_DONE);
    }
}

static void serve_error(unsigned bus)
{
    const struct i2c_hardware *h = &hardware[bus];
    struct i2c_run *r = &runs[bus];
    uint32_t errors = I2C_SR1(h->base) & I2C_SR1_ERRORS;
    I2C_SR1(h->base) = I2C_SR1_ERRORS & ~errors; /* cleared by zeros */
    if (r->transfer == NULL || (errors & ~I2C_SR1_BERR) == 0) {
        return;
    }
    bool refused = (errors & I2C_SR1_AF) != 0;
    if (refused) {
        send_stop(h);
    }
    end_i2c(h, r, refused && (r->sent == 0 || r->reads) ? TRANSFER_NO_ANSWER : TRANSFER_FAILED);
}

void interrupt_i2c1_event(void)
{
    serve_event(0);
}

void interrupt_i2c1_error(void)
{
    serve_error(0);
}

void interrupt_i2c2_event(void)
{
    serve_event(1);
}

void interrupt_i2c2_error(void)
{
    serve_error(1);
}

void hal_i2c_stop(uint8_t bus)
{
    if (bus == 0 || bus > BUSES || !runs[bus - 1u].ready) {
        return;
    }
    const struct i2c_hardware *h = &hardware[bus - 1u];
    struct i2c_run *r = &runs[bus - 1u];
    uint32_t before = io_hold();
    struct transfer *t = r->transfer;
    I2C_CR1(h->base) = I2C_CR1_SWRST; /* no interrupts from here on */
    r->transfer = NULL;
    io_release(before);
    make_ready(h);
    if (t != NULL) {
        t->state = TRANSFER_FAILED;
    }
}
