/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/device.h"

#include <stdatomic.h>
#include <string.h>

#include "base/assertion.h"
#include "devices/line.h"

#define READS_MAX    3u
#define REFUSALS_MAX 255u

enum err device_open(struct device *d, const struct device_kind *kind,
                     const struct device_settings *settings, uint16_t interval_ms)
{
    line_release(d);
    memset(d, 0, sizeof *d);
    d->kind = kind;
    d->settings = *settings;
    d->interval_ms = interval_ms > kind->interval_ms ? interval_ms : kind->interval_ms;
    return kind->open(d);
}

void device_clock(struct device *d, uint32_t now_ms)
{
    if (!d->running) {
        if (now_ms % d->interval_ms != 0)
            return;
        d->running = true;
        d->cycle_ms = now_ms;
        d->due_ms = now_ms;
    }
    /* No wait is longer than 16 bits. A due time further ahead than that has passed. */
    uint32_t left = d->due_ms - now_ms;
    if (left != 0 && left <= UINT16_MAX)
        return;
    uint16_t wait = d->kind->step(d, now_ms);
    d->due_ms = now_ms + (wait != 0 ? wait : 1u);
}

void device_publish(struct device *d, const int32_t code[DEVICE_CODES], uint16_t faults)
{
    memcpy(d->result.code, code, sizeof d->result.code);
    d->result.faults = faults;
    d->result.stamp_ms = d->began_ms;
    atomic_signal_fence(memory_order_seq_cst);
    uint32_t number = d->result.number + 1u;
    *(volatile uint32_t *)&d->result.number = number != 0 ? number : 1u;
}

void device_read(const struct device *d, struct device_result *result)
{
    const volatile uint32_t *number = &d->result.number;
    /* The clock interrupts the tick and not the other way round, and a device publishes once in many turns of the clock. So the second
     * copy is whole. */
    for (unsigned k = 0; k < READS_MAX; k++) {
        uint32_t before = *number;
        atomic_signal_fence(memory_order_seq_cst);
        *result = d->result;
        atomic_signal_fence(memory_order_seq_cst);
        result->number = before;
        if (*number == before)
            return;
    }
}

/* ---- transfers ---- */

/* Returns the time that a transfer of n bytes may take, ms. SPI: 33 bytes at 500 kHz are 0.53 ms. I2C: 9 bits of 10 us for a byte, two
 * addresses. 1-wire: 1.1 ms for the reset pulse, 0.7 ms for a byte. The rest is for interrupts that come between bytes. */
static uint16_t transfer_ms(uint8_t line, unsigned n)
{
    switch (line) {
    case DEVICE_I2C:
        return (uint16_t)(2u + n / 8u);
    case DEVICE_ONEWIRE:
        return (uint16_t)(3u + n);
    default:
        return 1;
    }
}

static enum err start_transfer(struct device *d)
{
    switch (d->kind->line) {
    case DEVICE_SPI:
        return hal_spi_start(&d->spi, &d->transfer);
    case DEVICE_I2C:
        return hal_i2c_start(d->settings.bus, d->settings.address, &d->transfer);
    default:
        return hal_onewire_start(d->settings.bus, &d->transfer);
    }
}

static void stop_transfer(const struct device *d)
{
    switch (d->kind->line) {
    case DEVICE_SPI:
        hal_spi_stop(d->settings.bus);
        break;
    case DEVICE_I2C:
        hal_i2c_stop(d->settings.bus);
        break;
    default:
        hal_onewire_stop(d->settings.bus);
        break;
    }
}

void device_close(struct device *d)
{
    if (d->transfer.state == TRANSFER_RUNS)
        stop_transfer(d);
}

uint16_t device_begin(struct device *d, uint32_t now_ms, uint8_t n_out, uint8_t n_in,
                      uint16_t wait_ms)
{
    REFLUX_ASSERT(n_out + n_in <= DEVICE_BUFFER);
    uint16_t takes_ms = transfer_ms(d->kind->line, (unsigned)n_out + n_in);
    d->transfer = (struct transfer){.out = d->bytes,
                                    .in = d->bytes + n_out,
                                    .n_out = n_out,
                                    .n_in = n_in,
                                    .state = TRANSFER_IDLE};
    if (line_claim(d->kind->line, d->settings.bus, LINE_WHOLE, d, now_ms, takes_ms) &&
        start_transfer(d) == ERR_OK) {
        d->refusals = 0;
        return (uint16_t)(takes_ms + wait_ms);
    }
    d->transfer.state = TRANSFER_IDLE;
    if (++d->refusals == REFUSALS_MAX) {
        d->refusals = 0;
        d->transfer.state = TRANSFER_FAILED;
    }
    return 1;
}

bool device_has_begun(const struct device *d)
{
    return d->transfer.state != TRANSFER_IDLE;
}

uint16_t device_ended(struct device *d)
{
    uint8_t state = d->transfer.state;
    if (state == TRANSFER_RUNS)
        stop_transfer(d);
    d->transfer.state = TRANSFER_IDLE;
    if (state == TRANSFER_DONE)
        return 0;
    return state == TRANSFER_NO_ANSWER ? DEVICE_NO_CHIP : DEVICE_BUS;
}

uint16_t device_finish(struct device *d, uint32_t now_ms, const int32_t code[DEVICE_CODES],
                       uint16_t faults)
{
    device_publish(d, code, faults);
    line_release(d);
    d->stage = 0;
    d->tries = 0;
    if ((faults & DEVICE_LOST) != 0)
        d->ready = false;
    d->cycle_ms += d->interval_ms;
    uint32_t wait = d->cycle_ms - now_ms;
    if (wait == 0 || wait > d->interval_ms) { /* late */
        d->cycle_ms = now_ms - now_ms % d->interval_ms + d->interval_ms;
        wait = d->cycle_ms - now_ms;
    }
    return (uint16_t)wait;
}

bool device_claim_chip(struct device *d, uint32_t now_ms, uint8_t unit, uint16_t for_ms)
{
    return line_claim(d->kind->line, d->settings.bus, unit, d, now_ms, for_ms);
}

bool device_all(const uint8_t *bytes, unsigned n, uint8_t byte)
{
    for (unsigned k = 0; k < n; k++)
        if (bytes[k] != byte)
            return false;
    return true;
}
