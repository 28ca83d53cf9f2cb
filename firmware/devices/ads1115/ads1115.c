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
#define TRIES_MAX  4u
/* From the start of a conversion to the first read, and some more. Each transfer renews it. */
#define CHIP_MS 100u

enum ads1115_stage { REST, CONVERT, STARTED, READ, COMPARE, CHECK, FAILED };

/* Places in kept[]. */
enum { KEPT_FIRST, KEPT_DIFFERENT, KEPT_FAULTS };

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
    uint16_t config = ads1115_config(&d->settings);
    switch (d->stage) {
    case CONVERT:
        d->began_ms = now_ms;
        d->bytes[0] = AT_CONFIG;
        d->bytes[1] = (uint8_t)(config >> 8);
        d->bytes[2] = (uint8_t)config;
        return device_begin(d, now_ms, 3, 0, 0);
    case STARTED:
    case CHECK:
        d->bytes[0] = AT_CONFIG;
        return device_begin(d, now_ms, 1, 2, 0);
    default: /* READ, COMPARE */
        d->bytes[0] = AT_CONVERSION;
        return device_begin(d, now_ms, 1, 2, 0);
    }
}

/* Compares what the configuration should be with what it is. */
static uint16_t ads1115_differs(uint16_t wanted, uint16_t config)
{
    if (config == wanted)
        return 0;
    return config == POWER_ON ? DEVICE_POWER_ON : DEVICE_WRONG_CHIP;
}

/* Judges a conversion when all has been read. */
static uint16_t ads1115_check(const struct device *d, uint16_t config)
{
    if (d->kept[KEPT_DIFFERENT] != 0)
        return DEVICE_CHECKSUM;
    uint16_t faults = ads1115_differs(ads1115_config(&d->settings), config);
    if (faults == 0 && (d->kept[KEPT_FIRST] == INT16_MAX || d->kept[KEPT_FIRST] == INT16_MIN))
        faults = DEVICE_RANGE;
    return faults;
}

/* Takes what came. True: the cycle is over. */
static bool ads1115_took(struct device *d, int32_t code[DEVICE_CODES], uint16_t *faults)
{
    uint16_t word = (uint16_t)(d->bytes[1] << 8 | d->bytes[2]);
    switch (d->stage) {
    case STARTED:
        /* A write that was disturbed may have begun nothing: then the chip still has the voltage of another input. */
        *faults = ads1115_differs(ads1115_config(&d->settings) ^ START_OR_IDLE, word);
        if (*faults == 0) {
            d->tries = 0;
            break;
        }
        d->stage = CONVERT;
        return ++d->tries == TRIES_MAX;
    case READ:
        d->kept[KEPT_FIRST] = (int16_t)word;
        break;
    case COMPARE:
        d->kept[KEPT_DIFFERENT] = d->kept[KEPT_FIRST] != (int16_t)word;
        break;
    case CHECK:
        if (((word & START_OR_IDLE) != 0 && d->kept[KEPT_DIFFERENT] == 0) ||
            ++d->tries == TRIES_MAX) {
            code[0] = d->kept[KEPT_FIRST];
            code[1] = word;
            *faults = ads1115_check(d, word);
            return true;
        }
        d->stage = READ;
        return false;
    default: /* CONVERT */
        break;
    }
    d->stage++;
    return false;
}

/* Time for which a conversion may still run that this device has begun, ms. A chip that converts takes a new configuration but goes on with
 * the input that it had, which no read shows: until it is idle nobody may begin another. */
static uint16_t conversion_left(const struct device *d, uint32_t now_ms)
{
    uint32_t passed = now_ms - d->began_ms;
    return passed < ADS1115_MS ? (uint16_t)(ADS1115_MS - passed) : 0;
}

static uint16_t ads1115_step(struct device *d, uint32_t now_ms)
{
    int32_t code[DEVICE_CODES] = {0};
    if (d->stage == FAILED)
        return device_finish(d, now_ms, code, (uint16_t)d->kept[KEPT_FAULTS]);
    if (device_has_begun(d)) {
        uint16_t faults = device_ended(d);
        bool started = d->stage == STARTED;
        bool heard = d->stage != CONVERT || faults != DEVICE_NO_CHIP;
        bool over = faults != 0 || ads1115_took(d, code, &faults);
        uint16_t left_ms = heard ? conversion_left(d, now_ms) : 0;
        if (over && faults != 0 && left_ms != 0) {
            d->kept[KEPT_FAULTS] = faults;
            d->stage = FAILED;
            return left_ms;
        }
        if (over)
            return device_finish(d, now_ms, code, faults);
        if (started && d->stage == READ)
            return ADS1115_MS;
        if (started && left_ms != 0)
            return left_ms; /* then it is begun again */
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
