/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/ads1115/ads1115.h"

#include <string.h>

#define AT_CONVERSION 0u
#define AT_CONFIG     1u
#define INPUTS        4u
#define RANGES        6u
#define INTERVAL_MS   400u /* four devices of a chip, 85 ms each */

/* Configuration. */
#define START_OR_IDLE 0x8000u
#define SINGLE_0      0x4000u /* input 0 against ground */
#define SINGLE_SHOT   0x0100u
#define SAMPLES_16    0x0020u
#define NO_COMPARATOR 0x0003u
#define POWER_ON      0x8583u

/* 16 a second, 10 % slow, are 69 ms. */
#define ADS1115_MS 72u
#define PAIRS_MAX  4u
/* From the start of a conversion to the first read, and some more. Each transfer renews it. */
#define CHIP_MS 100u

enum ads1115_stage { REST, CONVERT, READ, COMPARE, CHECK };

/* Places in kept[]. */
enum { KEPT_FIRST, KEPT_PAIRS_DIFFER };

static uint16_t ads1115_config(const struct device_settings *s)
{
    return (uint16_t)(START_OR_IDLE | SINGLE_0 | (unsigned)s->input << 12 | (unsigned)s->type << 9 |
                      SINGLE_SHOT | SAMPLES_16 | NO_COMPARATOR);
}

static enum err ads1115_open(struct device *d)
{
    const struct device_settings *s = &d->settings;
    if (s->address < 0x48 || s->address > 0x4B || s->input >= INPUTS || s->type >= RANGES)
        return ERR_RANGE;
    return hal_i2c_open(s->bus);
}

static uint16_t ads1115_send(struct device *d, uint32_t now_ms)
{
    if (!device_claim_chip(d, now_ms, d->settings.address, CHIP_MS)) {
        d->stage = REST; /* another input is measured now */
        return 1;
    }
    if (d->stage == REST)
        d->stage = CONVERT;
    if (d->stage != CONVERT) {
        d->bytes[0] = d->stage == CHECK ? AT_CONFIG : AT_CONVERSION;
        return device_begin(d, now_ms, 1, 2, 0);
    }
    uint16_t config = ads1115_config(&d->settings);
    d->began_ms = now_ms;
    d->bytes[0] = AT_CONFIG;
    d->bytes[1] = (uint8_t)(config >> 8);
    d->bytes[2] = (uint8_t)config;
    return device_begin(d, now_ms, 3, 0, ADS1115_MS);
}

static uint16_t ads1115_check(const struct device *d, uint16_t config)
{
    if (d->kept[KEPT_PAIRS_DIFFER] != 0)
        return DEVICE_CHECKSUM;
    if (config != ads1115_config(&d->settings))
        return config == POWER_ON ? DEVICE_POWER_ON : DEVICE_WRONG_CHIP;
    if (d->kept[KEPT_FIRST] == INT16_MAX || d->kept[KEPT_FIRST] == INT16_MIN)
        return DEVICE_RANGE;
    return 0;
}

static uint16_t ads1115_step(struct device *d, uint32_t now_ms)
{
    int32_t code[DEVICE_CODES] = {0};
    if (!device_has_begun(d))
        return ads1115_send(d, now_ms);
    uint16_t faults = device_ended(d);
    if (faults != 0)
        return device_finish(d, now_ms, code, faults);
    uint16_t word = (uint16_t)(d->bytes[1] << 8 | d->bytes[2]);
    switch (d->stage) {
    case READ:
        d->kept[KEPT_FIRST] = (int16_t)word;
        d->stage = COMPARE;
        break;
    case COMPARE:
        d->kept[KEPT_PAIRS_DIFFER] = d->kept[KEPT_FIRST] != (int16_t)word;
        d->stage = CHECK;
        break;
    case CHECK: {
        bool idle = (word & START_OR_IDLE) != 0;
        if ((!idle || d->kept[KEPT_PAIRS_DIFFER] != 0) && ++d->tries < PAIRS_MAX) {
            d->stage = READ;
            break;
        }
        code[0] = d->kept[KEPT_FIRST];
        code[1] = word;
        d->ready = true;
        return device_finish(d, now_ms, code, ads1115_check(d, word));
    }
    default: /* CONVERT */
        d->stage++;
        break;
    }
    return ads1115_send(d, now_ms);
}

static bool ads1115_value(const struct device_settings *s, const int32_t code[DEVICE_CODES],
                          float *value)
{
    static const float range[RANGES] = {6.144f, 4.096f, 2.048f, 1.024f, 0.512f, 0.256f};
    if (s->type >= RANGES || code[0] < INT16_MIN || code[0] > INT16_MAX)
        return false;
    *value = (float)code[0] * range[s->type] / 32768.0f;
    return true;
}

const struct device_kind ads1115_kind = {.name = "ads1115",
                                         .unit = "V",
                                         .line = DEVICE_I2C,
                                         .interval_ms = INTERVAL_MS,
                                         .open = ads1115_open,
                                         .step = ads1115_step,
                                         .value = ads1115_value};
