/* The SPI buses as masters (RM0090 chapter 28, RM0041 chapter 22), an interrupt for each byte. Only one byte is under way: the next one goes out
 * when the one before has come in, so that nothing can overrun, whatever holds the interrupt off.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "hal/spi.h"

#include <stddef.h>

#include "board.h"
#include "bus_hardware.h"
#include "io_interrupts.h"
#include "pin_map.h"
#include "registers.h"

#define BUSES      SPI_BUSES
#define DIVISORS   8u   /* 2, 4, ... 256 */
#define IDLE_TURNS 200u /* of a wait of half a period of the slowest clock, 1.5 us */

static const struct spi_hardware {
    uint32_t base, clock;
    uint8_t irq, function, fast; /* fast: on APB2 */
    hal_pin pins[3];             /* clock, in, out */
} hardware[BUSES] = {SPI_HARDWARE};

static struct spi_run {
    struct transfer *volatile transfer; /* NULL: the bus is free */
    uint16_t exchanged, total;          /* bytes */
    hal_pin select;
    bool ready;
} runs[BUSES];

uint8_t hal_spi_buses(void)
{
    return BUSES;
}

bool hal_spi_pins(uint8_t bus, hal_pin pins[3])
{
    if (bus == 0 || bus > BUSES) {
        return false;
    }
    for (unsigned i = 0; i < 3; i++) {
        pins[i] = hardware[bus - 1u].pins[i];
    }
    return true;
}

/* Code of the divider for a clock of this or slower; DIVISORS: the slowest is too fast. */
static uint32_t divisor_code(const struct spi_hardware *h, uint32_t hz)
{
    uint32_t from = h->fast ? clock_apb2_hz() : clock_apb1_hz(), code = 0;
    while (code < DIVISORS && from / (2u << code) > hz) {
        code++;
    }
    return code;
}

enum err hal_spi_open(const struct spi_device *device)
{
    if (device->bus == 0 || device->bus > BUSES || device->mode > 3u ||
        !hal_pin_is_free(device->select)) {
        return ERR_RANGE;
    }
    const struct spi_hardware *h = &hardware[device->bus - 1u];
    struct spi_run *r = &runs[device->bus - 1u];
    if (divisor_code(h, device->hz) == DIVISORS) {
        return ERR_RANGE;
    }
    pin_make_output(device->select, PIN_PUSH_PULL, true);
    if (r->ready) {
        return ERR_OK;
    }
    volatile uint32_t *enable = h->fast ? &RCC_APB2ENR : &RCC_APB1ENR;
    uint32_t before = io_hold();
    *enable |= h->clock;
    (void)*enable;
    io_release(before);
    for (unsigned i = 0; i < 3; i++) {
        pin_give(h->pins[i], h->function, i == 1 ? PIN_LISTENS : PIN_PUSH_PULL, i == 1);
    }
    SPI_CR2(h->base) = SPI_CR2_RXNEIE;
    io_interrupt_on(h->irq);
    r->ready = true;
    return ERR_OK;
}

static uint8_t next_out(const struct spi_run *r, const struct transfer *t)
{
    return r->exchanged < t->n_out ? t->out[r->exchanged] : 0;
}

enum err hal_spi_start(const struct spi_device *device, struct transfer *transfer)
{
    if (device->bus == 0 || device->bus > BUSES) {
        return ERR_RANGE;
    }
    const struct spi_hardware *h = &hardware[device->bus - 1u];
    struct spi_run *r = &runs[device->bus - 1u];
    uint32_t code = divisor_code(h, device->hz);
    if (code == DIVISORS) {
        return ERR_RANGE;
    }
    if (!r->ready || r->transfer != NULL) {
        return ERR_STATE;
    }
    r->exchanged = 0;
    r->total = (uint16_t)(transfer->n_out + transfer->n_in);
    r->select = device->select;
    if (r->total == 0) {
        transfer->state = TRANSFER_DONE;
        return ERR_OK;
    }
    transfer->state = TRANSFER_RUNS;
    r->transfer = transfer;
    uint32_t cr1 =
        SPI_CR1_SSM | SPI_CR1_SSI | SPI_CR1_MSTR | SPI_CR1_BR(code) | ((uint32_t)device->mode & 3u);
    SPI_CR1(h->base) = cr1;
    SPI_CR1(h->base) = cr1 | SPI_CR1_SPE; /* the clock rests at its level before select falls */
    hal_pin_write(r->select, false);
    SPI_DR(h->base) = next_out(r, transfer);
    return ERR_OK;
}

/* RM0090 28.3.5 and 28.3.7: the last byte has come in before its clock has rested for half a period. */
static void finish_spi(const struct spi_hardware *h, struct spi_run *r)
{
    struct transfer *t = r->transfer;
    for (unsigned i = 0; i < IDLE_TURNS && (SPI_SR(h->base) & SPI_SR_BSY) != 0; i++) {
    }
    hal_pin_write(r->select, true);
    SPI_CR1(h->base) &= ~SPI_CR1_SPE;
    r->transfer = NULL;
    t->state = TRANSFER_DONE;
}

static void serve_spi(unsigned bus)
{
    const struct spi_hardware *h = &hardware[bus];
    struct spi_run *r = &runs[bus];
    struct transfer *t = r->transfer;
    if (t == NULL || (SPI_SR(h->base) & SPI_SR_RXNE) == 0) {
        return; /* it was pending when hal_spi_stop() ended the transfer */
    }
    uint8_t byte = (uint8_t)SPI_DR(h->base);
    unsigned k = r->exchanged++;
    if (k >= t->n_out) {
        t->in[k - t->n_out] = byte;
    }
    if (r->exchanged < r->total) {
        SPI_DR(h->base) = next_out(r, t);
    } else {
        finish_spi(h, r);
    }
}

void interrupt_spi1(void)
{
    serve_spi(0);
}

void interrupt_spi2(void)
{
    serve_spi(1);
}

#if SPI_BUSES > 2
void interrupt_spi3(void)
{
    serve_spi(2);
}
#endif

/* A reset of the part ends a byte on its way, which the part itself would not. */
void hal_spi_stop(uint8_t bus)
{
    if (bus == 0 || bus > BUSES) {
        return;
    }
    const struct spi_hardware *h = &hardware[bus - 1u];
    struct spi_run *r = &runs[bus - 1u];
    uint32_t before = io_hold();
    struct transfer *t = r->transfer;
    if (t != NULL) {
        hal_pin_write(r->select, true);
        io_reset_bus(h->fast, h->clock);
        SPI_CR2(h->base) = SPI_CR2_RXNEIE;
        r->transfer = NULL;
        t->state = TRANSFER_FAILED;
    }
    io_release(before);
}
