/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/max31865/max31865.h"

#include <string.h>

#include "devices/max31865/rtd.h"

/* Registers, p. 12. */
#define AT_CONFIG   0x00u
#define AT_HIGH     0x03u
#define WRITE       0x80u
#define REGISTERS   8u
#define FULL_SCALE  32768.0f
#define RATIO_MOST  16.0f /* reference to nominal: below it a code is less than 0.15 K */
#define SPI_HZ      1000000u
#define INTERVAL_MS 100u

/* Configuration Register (00h), p. 12 and following. */
enum {
    BIAS = 0x80,
    ONE_SHOT = 0x20,
    THREE_WIRES = 0x10,
    DETECT_FAULTS = 0x04, /* with automatic delays; clears itself */
    CLEAR_FAULTS = 0x02,  /* clears itself */
    REJECT_50_HZ = 0x01
};

/* Fault register, p. 15 and tables 10 to 12. */
enum {
    RATIO_HIGH = 0x80,
    RATIO_LOW = 0x40,
    REFIN_HIGH = 0x20,
    REFIN_LOW = 0x10,
    RTDIN_LOW = 0x08,
    BEYOND_SUPPLY = 0x04
};

/* 10.5 time constants of 430 + 390 ohm and 100 nF, or tenfold and a tenth, are 0.9 ms, and 1 ms more (p. 12). Long wires have some more. */
#define BIAS_MS 8u
/* The cycle with automatic delays waits a few times 100 us, and afterwards the input settles as above. */
#define DETECT_MS 8u
/* A conversion takes up to 66 ms where it rejects 50 Hz, 55 ms for 60 Hz (unverified). */
#define CONVERT_50_MS 70u
#define CONVERT_60_MS 60u
/* Pairs of reads, 2 ms each, where they differ or the conversion is not complete yet. */
#define PAIRS_MAX 4u

enum max31865_stage {
    REST,
    THRESHOLDS, /* written where the chip may have lost them */
    BIAS_ON,
    DETECT,
    CONVERT,
    STARTED,
    READ,
    COMPARE,
    BIAS_OFF
};

/* Places in kept[]. */
enum {
    KEPT_HIGH,
    KEPT_LOW,
    KEPT_FIRST,
    KEPT_CODE = KEPT_FIRST + 2,
    KEPT_REGISTER,
    KEPT_FAULTS,
    KEPT_SHOWS
};

static uint8_t max31865_config(const struct device *d)
{
    return (uint8_t)((d->settings.type == 3 ? THREE_WIRES : 0) |
                     (d->settings.mains_60 ? 0 : REJECT_50_HZ));
}

static enum err max31865_open(struct device *d)
{
    const struct device_settings *s = &d->settings;
    if (s->type < 2 || s->type > 4 || !(s->nominal >= 10.0f && s->nominal <= 2000.0f) ||
        !(s->reference > RTD_RATIO_HI * s->nominal && s->reference <= RATIO_MOST * s->nominal) ||
        !hal_pin_is_free(s->select))
        return ERR_RANGE;
    float unit = FULL_SCALE * s->nominal / s->reference;
    d->kept[KEPT_HIGH] = (int32_t)(RTD_RATIO_HI * unit);
    d->kept[KEPT_LOW] = (int32_t)(RTD_RATIO_LO * unit);
    d->spi = (struct spi_device){.bus = s->bus, .select = s->select, .mode = 1, .hz = SPI_HZ};
    return hal_spi_open(&d->spi);
}

static void max31865_put(uint8_t *to, int32_t code)
{
    to[0] = (uint8_t)(code >> 7);
    to[1] = (uint8_t)(code << 1);
}

static uint16_t max31865_send(struct device *d, uint32_t now_ms)
{
    if (d->stage == REST) {
        d->began_ms = now_ms;
        d->stage = d->ready ? BIAS_ON : THRESHOLDS;
    }
    uint8_t config = max31865_config(d);
    d->bytes[0] = AT_CONFIG | WRITE;
    switch (d->stage) {
    case THRESHOLDS:
        d->bytes[0] = AT_HIGH | WRITE;
        max31865_put(&d->bytes[1], d->kept[KEPT_HIGH]);
        max31865_put(&d->bytes[3], d->kept[KEPT_LOW]);
        return device_begin(d, now_ms, 5, 0, 0);
    case BIAS_ON:
        d->bytes[1] = config | BIAS | CLEAR_FAULTS;
        return device_begin(d, now_ms, 2, 0, BIAS_MS);
    case DETECT:
        d->bytes[1] = config | BIAS | DETECT_FAULTS;
        return device_begin(d, now_ms, 2, 0, DETECT_MS);
    case CONVERT:
        d->began_ms = now_ms;
        d->bytes[1] = config | BIAS | ONE_SHOT;
        return device_begin(d, now_ms, 2, 0, 0);
    case STARTED:
        d->bytes[0] = AT_CONFIG;
        return device_begin(d, now_ms, 1, 1, 0);
    case BIAS_OFF:
        d->bytes[1] = config | CLEAR_FAULTS;
        return device_begin(d, now_ms, 2, 0, 0);
    default: /* READ, COMPARE */
        d->bytes[0] = AT_CONFIG;
        return device_begin(d, now_ms, 1, REGISTERS, 0);
    }
}

static uint16_t max31865_faults(uint8_t found)
{
    uint16_t faults = 0;
    if ((found & (RATIO_HIGH | REFIN_HIGH)) != 0)
        faults |= DEVICE_OPEN;
    if ((found & RATIO_LOW) != 0)
        faults |= DEVICE_SHORT;
    /* An open or shorted sensor lifts or lowers these two as well, and then they say nothing of the wires. */
    if (faults == 0 && (found & (REFIN_LOW | RTDIN_LOW)) != 0)
        faults |= DEVICE_VOLTAGE;
    if ((found & BEYOND_SUPPLY) != 0)
        faults |= DEVICE_VOLTAGE;
    return faults;
}

/* Compares what the chip should have with what it has. */
static uint16_t max31865_check(const struct device *d, const uint8_t in[REGISTERS])
{
    static const uint8_t power_on[4] = {0xFF, 0xFF, 0x00, 0x00}; /* p. 15 */
    if (device_all(in, REGISTERS, 0x00) || device_all(in, REGISTERS, 0xFF))
        return DEVICE_NO_CHIP;
    uint8_t set[4];
    max31865_put(&set[0], d->kept[KEPT_HIGH]);
    max31865_put(&set[2], d->kept[KEPT_LOW]);
    if (memcmp(&in[AT_HIGH], set, sizeof set) != 0)
        return memcmp(&in[AT_HIGH], power_on, sizeof power_on) == 0 ? DEVICE_POWER_ON
                                                                    : DEVICE_WRONG_CHIP;
    if ((in[AT_CONFIG] & ~ONE_SHOT) != (max31865_config(d) | BIAS))
        return DEVICE_WRONG_CHIP;
    return 0;
}

/* Judges the second of two reads; the first is in kept[]. */
static void max31865_compare(struct device *d, const uint8_t in[REGISTERS])
{
    uint16_t faults = DEVICE_CHECKSUM;
    bool again = memcmp(&d->kept[KEPT_FIRST], in, REGISTERS) != 0;
    if (!again) {
        faults = max31865_check(d, in);
        /* A voltage beyond the supply holds conversions up, and is itself what must be told. */
        again = faults == 0 && (in[AT_CONFIG] & ONE_SHOT) != 0 && (in[7] & BEYOND_SUPPLY) == 0;
        if (again)
            faults = DEVICE_WRONG_CHIP; /* if its conversion does not end */
        if (faults == 0)
            faults = max31865_faults(in[7]);
    }
    if (again && ++d->tries < PAIRS_MAX) {
        d->stage = READ;
        return;
    }
    d->kept[KEPT_CODE] = (in[1] << 7) | (in[2] >> 1);
    d->kept[KEPT_REGISTER] = in[7];
    d->kept[KEPT_FAULTS] = faults;
    d->stage = BIAS_OFF;
}

/* A write that was disturbed may have begun nothing, and the ratio of the conversion before would be read. The bit of the one-shot clears itself,
 * and where a chip has shown it once while it converts (KEPT_SHOWS), it must show it each time. Returns ms until the conversion is over, or 0. */
static uint16_t max31865_started(struct device *d, uint8_t config)
{
    bool shows = (config & ONE_SHOT) != 0;
    if (shows || d->kept[KEPT_SHOWS] == 0) {
        d->kept[KEPT_SHOWS] = shows;
        d->tries = 0;
        d->stage = READ;
        return d->settings.mains_60 ? CONVERT_60_MS : CONVERT_50_MS;
    }
    if (++d->tries < PAIRS_MAX) {
        d->stage = CONVERT;
    } else {
        d->kept[KEPT_SHOWS] = 0;
        d->kept[KEPT_FAULTS] = DEVICE_WRONG_CHIP;
        d->stage = BIAS_OFF;
    }
    return 0;
}

/* Takes what came. Returns ms to wait before the next transfer, or 0. */
static uint16_t max31865_took(struct device *d)
{
    const uint8_t *in = &d->bytes[1];
    switch (d->stage) {
    case STARTED:
        return max31865_started(d, in[0]);
    case READ:
        memcpy(&d->kept[KEPT_FIRST], in, REGISTERS);
        d->stage = COMPARE;
        break;
    case COMPARE:
        max31865_compare(d, in);
        break;
    case BIAS_OFF:
        d->ready = true;
        d->stage = REST;
        break;
    default:
        d->stage++;
        break;
    }
    return 0;
}

static uint16_t max31865_step(struct device *d, uint32_t now_ms)
{
    int32_t code[DEVICE_CODES] = {0};
    if (device_has_begun(d)) {
        uint16_t faults = device_ended(d);
        if (faults != 0)
            return device_finish(d, now_ms, code, faults);
        uint16_t wait = max31865_took(d);
        if (wait != 0)
            return wait;
        if (d->stage == REST) {
            code[0] = d->kept[KEPT_CODE];
            code[1] = d->kept[KEPT_REGISTER];
            return device_finish(d, now_ms, code, (uint16_t)d->kept[KEPT_FAULTS]);
        }
    }
    return max31865_send(d, now_ms);
}

static bool max31865_value(const struct device_settings *s, const int32_t code[DEVICE_CODES],
                           float *value)
{
    return rtd_temperature((float)code[0] * s->reference / (FULL_SCALE * s->nominal), value);
}

const struct device_kind max31865_kind = {.name = "max31865",
                                          .unit = "degC",
                                          .line = DEVICE_SPI,
                                          .interval_ms = INTERVAL_MS,
                                          .open = max31865_open,
                                          .step = max31865_step,
                                          .value = max31865_value};
