/* What a device on a bus is: a sensor chip, read step by step by the board clock, whose codes the tick turns into numbers.
 *
 * Board clock, once a millisecond (nothing here waits or computes with float):
 *     kind->step(d) does the next thing: it looks at the transfer that it began the last time, and may begin another. It returns the
 *     milliseconds until its next turn, at least 1. In that time the transfer must have ended; step() stops one that has not, which counts as
 *     a failure of the bus. Times do not depend on how fast a bus is, so that host and chip read alike.
 * Tick:
 *     device_read() takes the newest result; kind->value() turns it into a number.
 *
 * A reading that does not come, or that the chip or its checksum calls wrong, has a fault and no value. Chips without a checksum are read
 * twice in a row, and believed when both agree.
 *
 * The helpers for kinds below carry a cycle: from rest through transfers, one at a time, to one result. d->stage is 0 at rest.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_DEVICE_H
#define REFLUX_DEVICES_DEVICE_H

#include "base/channel.h"
#include "base/error.h"
#include "hal/i2c.h"
#include "hal/onewire.h"
#include "hal/spi.h"

/* What is wrong with a reading, as bits. */
enum device_fault {
    DEVICE_NO_CHIP = 1u << 0, /* nothing answers */
    DEVICE_WRONG_CHIP =
        1u
        << 1, /* what answers is another chip, or one that has lost its settings and does not take them */
    DEVICE_CHECKSUM = 1u << 2,      /* or two reads that differ */
    DEVICE_OPEN = 1u << 3,          /* sensor or its wire broken */
    DEVICE_SHORT = 1u << 4,         /* sensor shorted */
    DEVICE_VOLTAGE = 1u << 5,       /* over- or undervoltage at an input, short to a rail */
    DEVICE_RANGE = 1u << 6,         /* beyond what the chip or the sensor can have */
    DEVICE_COLD_JUNCTION = 1u << 7, /* its temperature is out of range */
    DEVICE_POWER_ON = 1u << 8,      /* the value of power-on, which is no measurement */
    DEVICE_BUS = 1u << 9            /* the transfer failed or did not end */
};

/* Faults after which the chip is set up anew. */
#define DEVICE_LOST (DEVICE_NO_CHIP | DEVICE_WRONG_CHIP | DEVICE_POWER_ON | DEVICE_BUS)

/* Numbers of a result, bytes of a transfer, and numbers that a kind keeps: the largest of all kinds. A board that has few kinds has its own. */
#ifndef DEVICE_CODES
#define DEVICE_CODES  3u
#define DEVICE_BUFFER 32u
#define DEVICE_KEPT   8u
#endif

/* What settings.bus counts. */
enum device_line { DEVICE_NO_LINE, DEVICE_SPI, DEVICE_I2C, DEVICE_ONEWIRE };

struct device_settings {
    uint8_t bus;
    hal_pin select;  /* SPI; of a kind without a bus its pin */
    uint8_t address; /* I2C */
    uint8_t input;   /* of a chip with several */
    uint8_t type;    /* of a sensor, as its kind says: wires, letter of a thermocouple, range */
    bool mains_60;   /* rejects 60 Hz instead of 50 */
    uint8_t rom[ONEWIRE_ROM_BYTES];
    float reference; /* as its kind says: ohm, V */
    float nominal;   /* as its kind says: ohm at 0 degC */
};

struct device_result {
    int32_t code[DEVICE_CODES]; /* as the kind says */
    uint16_t faults;            /* enum device_fault */
    uint32_t stamp_ms;          /* when the conversion was begun */
    uint32_t number;            /* of the result, from 1; 0: none yet */
};

struct device;

struct device_kind {
    const char *name;     /* at the console */
    const char *unit;     /* of value(): "degC", "Pa", "V" */
    uint8_t line;         /* enum device_line */
    uint16_t interval_ms; /* shortest one between two results */
    /* ERR_RANGE where a setting is none of this chip's. Makes the bus ready. */
    enum err (*open)(struct device *d);
    uint16_t (*step)(struct device *d, uint32_t now_ms);
    /* From the codes of a result without a fault. False: the value is none that this sensor can have. */
    bool (*value)(const struct device_settings *s, const int32_t code[DEVICE_CODES], float *value);
};

/* Stays where it is while it is open: transfers point into it. */
struct device {
    const struct device_kind *kind;
    struct device_settings settings;
    uint16_t interval_ms;
    /* The kind's own, in the board clock: */
    struct transfer transfer;
    struct spi_device spi;
    uint8_t bytes[DEVICE_BUFFER];
    uint8_t stage, tries;
    bool ready;                /* the chip has its settings */
    int32_t kept[DEVICE_KEPT]; /* calibration of the chip, or the read before */
    uint32_t began_ms;         /* the conversion */
    /* Of device.c: */
    bool running;
    uint8_t refusals; /* turns in a row in which the bus was somebody else's */
    uint32_t cycle_ms, due_ms;
    /* Written by the board clock, read by the tick: */
    struct device_result result;
};

/* Makes a device ready, at rest and without a result. interval_ms is raised to the kind's shortest. ERR_RANGE: a setting that the kind
 * cannot have, or no such bus. Called while the board clock does not step this device. */
enum err device_open(struct device *d, const struct device_kind *kind,
                     const struct device_settings *settings, uint16_t interval_ms);

/* Ends the transfer that runs, which points into the device: before its memory becomes another one's. Of a device that was opened, while the board
 * clock does not step it. */
void device_close(struct device *d);

/* Board clock. Runs the steps that are due. Cycles begin at whole multiples of the interval of this clock. */
void device_clock(struct device *d, uint32_t now_ms);

/* For kinds: publishes a result with these codes, or with faults. */
void device_publish(struct device *d, const int32_t code[DEVICE_CODES], uint16_t faults);

/* Tick. The newest result; the board clock may interrupt it. */
void device_read(const struct device *d, struct device_result *result);

/* ---- for kinds: the transfers of a cycle ---- */

/* Begins a transfer: n_out bytes of d->bytes go out, n_in come in behind them. Returns ms until the next turn: the time that such a transfer
 * may take and wait_ms more, or 1 if the bus is somebody else's now. After 255 such turns the transfer counts as failed. */
uint16_t device_begin(struct device *d, uint32_t now_ms, uint8_t n_out, uint8_t n_in,
                      uint16_t wait_ms);

/* Whether a transfer has been begun that nobody has looked at. */
bool device_has_begun(const struct device *d);

/* Looks at this transfer: 0, DEVICE_NO_CHIP or DEVICE_BUS. Stops it if it has not ended. */
uint16_t device_ended(struct device *d);

/* Ends the cycle with a result and returns ms until the next one. */
uint16_t device_finish(struct device *d, uint32_t now_ms, const int32_t code[DEVICE_CODES],
                       uint16_t faults);

/* For conversions that take long: another device keeps off this chip (unit: address on its bus) for this time, or until device_finish().
 * False: another device has it. */
bool device_claim_chip(struct device *d, uint32_t now_ms, uint8_t unit, uint16_t for_ms);

/* Whether n bytes are all this one: a line that nobody drives, or a short. */
bool device_all(const uint8_t *bytes, unsigned n, uint8_t byte);

#endif
