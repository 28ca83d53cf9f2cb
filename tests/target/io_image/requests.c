/* Requests of the mailbox, each one call of the port's contracts.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "requests.h"

#include <stddef.h>

#include "board.h"
#include "hal/analog.h"
#include "hal/clock.h"
#include "hal/i2c.h"
#include "hal/onewire.h"
#include "hal/output.h"
#include "hal/pulse.h"
#include "hal/spi.h"
#include "mailbox.h"

static volatile struct mailbox box __attribute__((section(".mailbox")));

static struct transfer transfer, others[2]; /* others: on I2C and 1-wire at the same time */
static struct spi_device spi;
static uint8_t out[256], in[256];
static uint32_t waited_ms;
static volatile uint8_t branch;
static bool runs;

static void finish(enum err err)
{
    runs = false;
    box.err = err;
    box.state = transfer.state | (uint32_t)others[0].state << 8 | (uint32_t)others[1].state << 16;
    box.took_ms = waited_ms;
    if (box.command == IO_WIRE_SEARCH) {
        box.result = branch;
    }
    for (unsigned i = 0; i < sizeof(in); i++) {
        box.in[i] = in[i];
    }
    box.done = box.request;
}

static void stop_bus(void)
{
    bool all = box.command == IO_TOGETHER;
    if (all || box.command == IO_SPI) {
        hal_spi_stop((uint8_t)box.bus);
    }
    if (all || box.command == IO_I2C) {
        hal_i2c_stop((uint8_t)box.bus);
    }
    if (all || box.command == IO_WIRE || box.command == IO_WIRE_SEARCH) {
        hal_onewire_stop((uint8_t)box.bus);
    }
}

static void prepare(void)
{
    for (unsigned i = 0; i < sizeof(out); i++) {
        out[i] = box.out[i];
        in[i] = 0xEE;
    }
    transfer = (struct transfer){
        .out = out, .in = in, .n_out = (uint8_t)box.n_out, .n_in = (uint8_t)box.n_in};
    spi = (struct spi_device){.bus = (uint8_t)box.bus,
                              .select = (hal_pin)box.pin,
                              .mode = (uint8_t)box.mode,
                              .hz = box.hz};
    others[0].state = others[1].state = TRANSFER_IDLE;
    waited_ms = 0;
}

static enum err start_together(void)
{
    for (unsigned i = 0; i < 2; i++) {
        others[i] = transfer;
        others[i].out = out + (i + 1u) * IO_THIRD;
        others[i].in = in + (i + 1u) * IO_THIRD;
    }
    others[1].n_out = (uint8_t)(others[1].n_out + 2u);
    enum err err = hal_spi_start(&spi, &transfer);
    if (err == ERR_OK) {
        err = hal_i2c_start((uint8_t)box.bus, (uint8_t)box.value, &others[0]);
    }
    return err == ERR_OK ? hal_onewire_start((uint8_t)box.bus, &others[1]) : err;
}

static enum err search(void)
{
    branch = (uint8_t)box.value;
    for (unsigned i = 0; i < ONEWIRE_ROM_BYTES; i++) {
        in[i] = out[i];
    }
    return hal_onewire_search((uint8_t)box.bus, &transfer, &branch);
}

static void begin(enum err err)
{
    runs = err == ERR_OK;
    if (!runs) {
        finish(err);
    }
}

/* Returns whether the command is one of an input or output of the chip itself. */
static bool obey_own(hal_pin pin, enum err *err)
{
    uint16_t code = 0;
    switch (box.command) {
    case IO_PWM_OPEN:
        *err = hal_pwm_open(pin, box.hz, box.mode != 0);
        return true;
    case IO_PWM_SET:
        hal_pwm_set(pin, (uint16_t)box.value);
        return true;
    case IO_PULSE_OPEN:
        *err = hal_pulse_open(pin);
        return true;
    case IO_PULSE_DEAD:
        hal_pulse_set_dead_time(pin, (uint8_t)box.value);
        return true;
    case IO_PULSE_COUNT:
        box.result = hal_pulse_count(pin);
        return true;
    case IO_ANALOG_HAS:
        box.result = hal_analog_has(pin);
        return true;
    case IO_ANALOG_OPEN:
        *err = hal_analog_open(pin);
        return true;
    case IO_ANALOG_READ:
        *err = hal_analog_read(pin, &code) ? ERR_OK : ERR_EMPTY;
        box.result = code;
        return true;
    case IO_ANALOG_REFERENCE:
        box.result = (uint32_t)(hal_analog_reference() * 1000.0f + 0.5f);
        return true;
    default:
        return false;
    }
}

static void obey(void)
{
    hal_pin pin = (hal_pin)box.pin;
    enum err err = ERR_OK;
    prepare();
    switch (box.command) {
    case IO_SPI_OPEN:
        err = hal_spi_open(&spi);
        break;
    case IO_SPI:
        begin(hal_spi_start(&spi, &transfer));
        return;
    case IO_PIN_FREE:
        box.result = hal_pin_is_free(pin);
        break;
    case IO_PIN_USE:
        hal_pin_use(pin, (enum hal_pin_use)box.mode);
        break;
    case IO_PIN_READ:
        box.result = hal_pin_read(pin);
        break;
    case IO_PIN_WRITE:
        hal_pin_write(pin, box.value != 0);
        break;
    case IO_OUTPUT_OPEN:
        err = hal_output_open(pin, box.mode != 0);
        break;
    case IO_OUTPUT_SET:
        hal_output_set(pin, box.value != 0);
        break;
    case IO_OUTPUT_SAFE:
        hal_output_safe();
        break;
    case IO_WIRE_OPEN:
        err = hal_onewire_open((uint8_t)box.bus);
        break;
    case IO_WIRE:
        begin(hal_onewire_start((uint8_t)box.bus, &transfer));
        return;
    case IO_WIRE_SEARCH:
        begin(search());
        return;
    case IO_TOGETHER:
        begin(start_together());
        return;
    case IO_I2C_OPEN:
        err = hal_i2c_open((uint8_t)box.bus);
        break;
    case IO_I2C:
        begin(hal_i2c_start((uint8_t)box.bus, (uint8_t)box.mode, &transfer));
        return;
    default:
        if (!obey_own(pin, &err)) {
            err = ERR_UNKNOWN;
        }
        break;
    }
    finish(err);
}

void requests_start(void)
{
    box.request = box.done = 0;
    box.ready = MAILBOX_READY;
}

/* As an erase of the flash does. */
static void hold_interrupts(uint32_t ms)
{
    uint32_t before = mask_raise(PRIORITY_UART), from = hal_cycles();
    while (hal_cycles() - from < ms * (hal_core_hz() / 1000u)) {
    }
    mask_restore(before);
}

void requests_clock(void)
{
    if (!runs) {
        if (box.request != box.done) {
            obey();
        }
        return;
    }
    waited_ms++;
    if (box.hold_ms != 0 && waited_ms == 1u) {
        hold_interrupts(box.hold_ms);
    }
    if (transfer.state != TRANSFER_RUNS && others[0].state != TRANSFER_RUNS &&
        others[1].state != TRANSFER_RUNS) {
        finish(ERR_OK);
    } else if (box.limit_ms != 0 && waited_ms >= box.limit_ms) {
        stop_bus();
        finish(ERR_TIMEOUT);
    }
}
