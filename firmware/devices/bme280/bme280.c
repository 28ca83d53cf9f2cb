/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/bme280/bme280.h"

#include <string.h>

#include "devices/bme280/compensation.h"

#define AT_ID          0xD0u
#define AT_CALIBRATION 0x88u
#define AT_RESET       0xE0u
#define AT_STATUS      0xF3u
#define AT_CONTROL     0xF4u
#define ID_BME280      0x60u
#define ID_BMP280      0x58u
#define INTERVAL_MS    200u /* two devices of a chip, 75 ms each */

/* Written to the reset register; the chip is as at power-on within 2 ms (BME280, 5.4.2 and table 1). */
#define RESETS   0xB6u
#define RESET_MS 3u

/* Status register. */
enum { MEASURING = 0x08, COPYING_CALIBRATION = 0x01 };

/* Control register: two samples of temperature, sixteen of pressure; asleep, or one conversion. */
#define ASLEEP         0x54u
#define ONE_CONVERSION 0x55u

/* From the status to the last byte of temperature. The third of them is the filter's register, which is 0 since power-on. */
#define REPLY      10u
#define AT_FILTER  2u
#define AT_RAW_P   4u
#define AT_RAW_T   7u
#define NO_READING 0x80000 /* of a quantity that is left out, and of one at power-on */

/* 1.25 + 2.3 x 2 + 2.3 x 16 + 0.575 ms at most (BME280, 9.1). */
#define BME280_MS 45u
#define PAIRS_MAX 4u
#define CHIP_MS   80u /* from a transfer to the next; each one renews it */

enum bme280_stage { REST, IDENTIFY, CALIBRATION, CALIBRATION_AGAIN, CONVERT, READ, COMPARE, RESET };

/* Places in kept[]: 24 bytes of calibration; status, control and raw numbers of the first of two reads. */
enum { KEPT_CALIBRATION, KEPT_FIRST = BME280_CALIBRATION / 4 };
#define FIRST_READ 8u

static enum err bme280_open(struct device *d)
{
    if (d->settings.address != 0x76 && d->settings.address != 0x77)
        return ERR_RANGE;
    return hal_i2c_open(d->settings.bus);
}

static uint16_t bme280_send(struct device *d, uint32_t now_ms)
{
    if (!device_claim_chip(d, now_ms, d->settings.address, CHIP_MS)) {
        d->stage = REST; /* the other device of this chip measures */
        return 1;
    }
    if (d->stage == REST) {
        d->began_ms = now_ms;
        d->stage = d->ready ? CONVERT : IDENTIFY;
    }
    switch (d->stage) {
    case IDENTIFY:
        d->bytes[0] = AT_ID;
        return device_begin(d, now_ms, 1, 1, 0);
    case CALIBRATION:
    case CALIBRATION_AGAIN:
        d->bytes[0] = AT_CALIBRATION;
        return device_begin(d, now_ms, 1, BME280_CALIBRATION, 0);
    case CONVERT:
        d->began_ms = now_ms;
        d->bytes[0] = AT_CONTROL;
        d->bytes[1] = ONE_CONVERSION;
        return device_begin(d, now_ms, 2, 0, BME280_MS);
    case RESET:
        d->bytes[0] = AT_RESET;
        d->bytes[1] = RESETS;
        return device_begin(d, now_ms, 2, 0, RESET_MS);
    default: /* READ, COMPARE */
        d->bytes[0] = AT_STATUS;
        return device_begin(d, now_ms, 1, REPLY, 0);
    }
}

static int32_t raw_20_bits(const uint8_t *from)
{
    return from[0] << 12 | from[1] << 4 | from[2] >> 4;
}

static uint16_t bme280_check(const struct device *d, const uint8_t in[REPLY],
                             int32_t code[DEVICE_CODES])
{
    if (in[1] != ASLEEP || in[AT_FILTER] != 0)
        return in[1] == 0 ? DEVICE_POWER_ON : DEVICE_WRONG_CHIP;
    int32_t raw_p = raw_20_bits(&in[AT_RAW_P]), raw_t = raw_20_bits(&in[AT_RAW_T]);
    if (raw_p == NO_READING || raw_t == NO_READING)
        return DEVICE_RANGE;
    uint8_t calibration[BME280_CALIBRATION];
    memcpy(calibration, &d->kept[KEPT_CALIBRATION], sizeof calibration);
    return bme280_compensate(calibration, raw_t, raw_p, &code[1], &code[0]) ? 0 : DEVICE_RANGE;
}

static void first_read(const uint8_t in[REPLY], uint8_t to[FIRST_READ])
{
    memcpy(to, in, 2);
    memcpy(to + 2, &in[AT_RAW_P], 6);
}

/* Judges the second of two reads. True: the cycle is over. */
static bool bme280_compare(struct device *d, const uint8_t in[REPLY], int32_t code[DEVICE_CODES],
                           uint16_t *faults)
{
    uint8_t second[FIRST_READ];
    first_read(in, second);
    bool again = true;
    if (memcmp(&d->kept[KEPT_FIRST], second, sizeof second) != 0) {
        *faults = DEVICE_CHECKSUM;
    } else if ((in[0] & (MEASURING | COPYING_CALIBRATION)) != 0 || in[1] == ONE_CONVERSION) {
        *faults = DEVICE_WRONG_CHIP; /* if its conversion does not end */
    } else {
        *faults = bme280_check(d, in, code);
        again = false;
    }
    return !again || ++d->tries == PAIRS_MAX;
}

/* Takes what came. True: the cycle is over. */
static bool bme280_took(struct device *d, int32_t code[DEVICE_CODES], uint16_t *faults)
{
    const uint8_t *in = d->transfer.in;
    switch (d->stage) {
    case IDENTIFY:
        if (in[0] != ID_BME280 && in[0] != ID_BMP280) {
            *faults = DEVICE_WRONG_CHIP;
            return true;
        }
        break;
    case CALIBRATION:
        memcpy(&d->kept[KEPT_CALIBRATION], in, BME280_CALIBRATION);
        break;
    case CALIBRATION_AGAIN:
        if (memcmp(&d->kept[KEPT_CALIBRATION], in, BME280_CALIBRATION) != 0) {
            *faults = DEVICE_CHECKSUM;
            return true;
        }
        d->ready = true;
        break;
    case READ: {
        uint8_t first[FIRST_READ];
        first_read(in, first);
        memcpy(&d->kept[KEPT_FIRST], first, sizeof first);
        break;
    }
    case COMPARE:
        if (bme280_compare(d, in, code, faults))
            return true;
        d->stage = READ;
        return false;
    default: /* CONVERT */
        break;
    }
    d->stage++;
    return false;
}

static uint16_t bme280_step(struct device *d, uint32_t now_ms)
{
    int32_t code[DEVICE_CODES] = {0};
    if (device_has_begun(d)) {
        uint16_t faults = device_ended(d);
        if (d->stage == RESET)
            return device_finish(d, now_ms, code, DEVICE_WRONG_CHIP);
        if (faults != 0 || bme280_took(d, code, &faults)) {
            if (faults != 0)
                d->ready = false; /* another chip may be there: identify it again */
            if (faults != DEVICE_WRONG_CHIP || d->stage != COMPARE)
                return device_finish(d, now_ms, code, faults);
            /* A write that was disturbed may have set a register that nothing here writes, the filter's or the mode. */
            d->stage = RESET;
        }
    }
    return bme280_send(d, now_ms);
}

/* The range of both chips is 300 to 1100 hPa. */
static bool bme280_pressure(const struct device_settings *s, const int32_t code[DEVICE_CODES],
                            float *value)
{
    (void)s;
    if (code[0] < 30000 * 256 || code[0] > 110000 * 256)
        return false;
    *value = (float)code[0] / 256.0f;
    return true;
}

/* ... and -40 to 85 degC. */
static bool bme280_temperature(const struct device_settings *s, const int32_t code[DEVICE_CODES],
                               float *value)
{
    (void)s;
    if (code[1] < -4000 || code[1] > 8500)
        return false;
    *value = (float)code[1] / 100.0f;
    return true;
}

const struct device_kind bme280_kind = {.name = "bme280",
                                        .unit = "Pa",
                                        .line = DEVICE_I2C,
                                        .interval_ms = INTERVAL_MS,
                                        .open = bme280_open,
                                        .step = bme280_step,
                                        .value = bme280_pressure};

const struct device_kind bme280_temperature_kind = {.name = "bme280_temperature",
                                                    .unit = "degC",
                                                    .line = DEVICE_I2C,
                                                    .interval_ms = INTERVAL_MS,
                                                    .open = bme280_open,
                                                    .step = bme280_step,
                                                    .value = bme280_temperature};
