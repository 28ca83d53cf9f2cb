/* What the io image and the program around the virtual board tell each other: a place in the memory of the board. The program writes a request and
 * then its number; the image does it in its board clock, and writes the number into `done`.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef IO_IMAGE_MAILBOX_H
#define IO_IMAGE_MAILBOX_H

#include <stdint.h>

#define MAILBOX_ADDRESS 0x2001F000u /* image.ld */
#define MAILBOX_READY   0x494F4F4Bu

enum io_command {
    IO_SPI_OPEN = 1, /* bus, pin, mode, hz */
    IO_SPI,          /* the same, n_out, n_in, limit_ms */
    IO_PIN_FREE,     /* pin */
    IO_PIN_USE,      /* pin, mode: enum hal_pin_use */
    IO_PIN_READ,     /* pin */
    IO_PIN_WRITE,    /* pin, value */
    IO_OUTPUT_OPEN,  /* pin, mode: low */
    IO_OUTPUT_SET,   /* pin, value */
    IO_OUTPUT_SAFE,
    IO_WIRE_OPEN, /* bus */
    IO_WIRE,      /* bus, n_out, n_in, limit_ms */
    IO_WIRE_SEARCH, /* bus, limit_ms, out: the address before, value: the branch; result: the next one */
    IO_I2C_OPEN,         /* bus */
    IO_I2C,              /* bus, mode: address, n_out, n_in, limit_ms */
    IO_PWM_OPEN,         /* pin, hz, mode: low */
    IO_PWM_SET,          /* pin, value */
    IO_PULSE_OPEN,       /* pin */
    IO_PULSE_DEAD,       /* pin, value: ms */
    IO_PULSE_COUNT,      /* pin; result */
    IO_ANALOG_HAS,       /* pin; result */
    IO_ANALOG_OPEN,      /* pin */
    IO_ANALOG_READ,      /* pin; result, ERR_EMPTY: there is none yet */
    IO_ANALOG_REFERENCE, /* result: mV */
    IO_TOGETHER /* bus, pin, mode and hz as of IO_SPI, value: an address on I2C, n_out, n_in: SPI, I2C and 1-wire at once on buses of this
                 * number, each with a third of `out` and `in`; n_out + 2 bytes on the wire. state: each has a byte, SPI the lowest */
};

#define IO_THIRD 64u /* bytes of `out` and `in` for each bus of IO_TOGETHER */

struct mailbox {
    uint32_t ready;
    uint32_t request, done; /* numbers */
    uint32_t command, bus, pin, mode, hz, value;
    uint32_t n_out, n_in, limit_ms; /* 0: no limit */
    uint32_t
        hold_ms;    /* a millisecond after a transfer began, its interrupts are held off so long */
    int32_t err;    /* enum err */
    uint32_t state; /* enum transfer_state */
    uint32_t result, took_ms;
    uint8_t out[256], in[256];
};

#endif
