/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/max31856/max31856.h"

#include <string.h>

#define WRITE       0x80u
#define SETTINGS    10u /* registers 00h to 09h */
#define REGISTERS   16u
#define AT_CR0      0x00u
#define AT_MASK     0x02u
#define AT_JUNCTION 0x0Au
#define AT_LINEAR   0x0Cu
#define AT_STATUS   0x0Fu
#define SPI_HZ      1000000u
#define INTERVAL_MS 300u

/* CR0; bit 2 is 0: faults follow what is there, without a latch. */
enum { ONE_SHOT = 0x40, DETECT_OPEN = 0x10, REJECT_50_HZ = 0x01 };

/* In the mask 0 lets a fault through; its upper two bits mean nothing. */
#define MASK_BITS 0x3Fu

/* Fault register. */
enum {
    JUNCTION_RANGE = 0x80,
    TYPE_RANGE = 0x40,
    JUNCTION_HIGH = 0x20,
    JUNCTION_LOW = 0x10,
    LINEAR_HIGH = 0x08,
    LINEAR_LOW = 0x04,
    BEYOND_SUPPLY = 0x02,
    OPEN = 0x01
};

/* A conversion takes 185 ms at most where it rejects 50 Hz, 155 ms for 60 Hz. The test for an open circuit takes up to 40 ms more (unverified). */
#define CONVERT_50_MS 235u
#define CONVERT_60_MS 205u
#define PAIRS_MAX     4u

enum max31856_stage { REST, SET_UP, CONVERT, STARTED, READ, COMPARE };

/* Places in kept[]. */
enum { KEPT_FIRST, KEPT_SHOWS = REGISTERS / 4 };

struct thermocouple_type {
    char letter;
    uint8_t number; /* in CR1 */
    int16_t lo,
        hi; /* degC. These ranges are those of the data sheet's table of types (unverified). */
};

static const struct thermocouple_type types[] = {
    {'B', 0, 250, 1820},  {'E', 1, -200, 1000}, {'J', 2, -210, 1200}, {'K', 3, -200, 1372},
    {'N', 4, -200, 1300}, {'R', 5, -50, 1768},  {'S', 6, -50, 1768},  {'T', 7, -200, 400}};

static const struct thermocouple_type *find_type(uint8_t letter)
{
    for (unsigned k = 0; k < sizeof types / sizeof types[0]; k++)
        if (types[k].letter == (char)letter)
            return &types[k];
    return NULL;
}

static enum err max31856_open(struct device *d)
{
    const struct device_settings *s = &d->settings;
    if (find_type(s->type) == NULL || !hal_pin_is_free(s->select))
        return ERR_RANGE;
    d->spi = (struct spi_device){.bus = s->bus, .select = s->select, .mode = 1, .hz = SPI_HZ};
    return hal_spi_open(&d->spi);
}

/* What registers 00h to 09h should be. */
static void max31856_settings(const struct device_settings *s, uint8_t to[SETTINGS])
{
    const uint8_t wanted[SETTINGS] = {
        (uint8_t)(DETECT_OPEN | (s->mains_60 ? 0 : REJECT_50_HZ)),
        find_type(s->type)->number, /* no averaging */
        0,                          /* every fault */
        85,                         /* cold junction: high and low, degC */
        (uint8_t)-20,
        0x7F,
        0xFF,
        0x80,
        0x00, /* thermocouple: high and low beyond every type */
        0     /* offset of the cold junction */
    };
    memcpy(to, wanted, SETTINGS);
}

static uint16_t max31856_send(struct device *d, uint32_t now_ms)
{
    if (d->stage == REST) {
        d->began_ms = now_ms;
        d->stage = d->ready ? CONVERT : SET_UP;
    }
    switch (d->stage) {
    case SET_UP:
        d->bytes[0] = AT_CR0 | WRITE;
        max31856_settings(&d->settings, &d->bytes[1]);
        return device_begin(d, now_ms, 1 + SETTINGS, 0, 0);
    case CONVERT:
        d->began_ms = now_ms;
        max31856_settings(&d->settings, &d->bytes[1]);
        d->bytes[0] = AT_CR0 | WRITE;
        d->bytes[1] |= ONE_SHOT;
        return device_begin(d, now_ms, 2, 0, 0);
    case STARTED:
        d->bytes[0] = AT_CR0;
        return device_begin(d, now_ms, 1, 1, 0);
    default: /* READ, COMPARE */
        d->bytes[0] = AT_CR0;
        return device_begin(d, now_ms, 1, REGISTERS, 0);
    }
}

static uint16_t max31856_faults(uint8_t status)
{
    uint16_t faults = 0;
    if ((status & OPEN) != 0)
        faults |= DEVICE_OPEN;
    if ((status & BEYOND_SUPPLY) != 0)
        faults |= DEVICE_VOLTAGE;
    /* Without a thermocouple its temperature is none. */
    if (faults == 0 && (status & (TYPE_RANGE | LINEAR_HIGH | LINEAR_LOW)) != 0)
        faults |= DEVICE_RANGE;
    if ((status & (JUNCTION_RANGE | JUNCTION_HIGH | JUNCTION_LOW)) != 0)
        faults |= DEVICE_COLD_JUNCTION;
    return faults;
}

/* Compares what the chip should have with what it has, and looks at its faults. */
static uint16_t max31856_check(const struct device *d, const uint8_t in[REGISTERS])
{
    static const uint8_t power_on[] = {0x7F, 0xC0}; /* thresholds of the cold junction */
    if (device_all(in, REGISTERS, 0x00) || device_all(in, REGISTERS, 0xFF))
        return DEVICE_NO_CHIP;
    uint8_t wanted[SETTINGS], found[SETTINGS];
    max31856_settings(&d->settings, wanted);
    memcpy(found, in, SETTINGS);
    found[AT_CR0] &= (uint8_t)~ONE_SHOT;
    found[AT_MASK] &= MASK_BITS;
    if (memcmp(wanted, found, SETTINGS) != 0)
        return found[AT_MASK] == MASK_BITS &&
                       memcmp(&found[AT_MASK + 1], power_on, sizeof power_on) == 0
                   ? DEVICE_POWER_ON
                   : DEVICE_WRONG_CHIP;
    return max31856_faults(in[AT_STATUS]);
}

/* Judges the second of two reads; the first is in kept[]. True: the cycle is over. */
static bool max31856_compare(struct device *d, const uint8_t in[REGISTERS], uint16_t *faults)
{
    *faults = DEVICE_CHECKSUM;
    bool again = memcmp(&d->kept[KEPT_FIRST], in, REGISTERS) != 0;
    if (!again) {
        *faults = max31856_check(d, in);
        /* A voltage beyond the supply holds conversions up, and is itself what must be told. */
        again = (*faults & DEVICE_LOST) == 0 && (in[AT_CR0] & ONE_SHOT) != 0 &&
                (in[AT_STATUS] & BEYOND_SUPPLY) == 0;
        if (again)
            *faults = DEVICE_WRONG_CHIP; /* if its conversion does not end */
    }
    return !again || ++d->tries == PAIRS_MAX;
}

/* A write that was disturbed may have begun nothing, and the temperature of the conversion before would be read. The bit of the one-shot clears
 * itself, and where a chip has shown it once while it converts (KEPT_SHOWS), it must show it each time. True: it converts. */
static bool max31856_started(struct device *d, uint8_t cr0)
{
    bool shows = (cr0 & ONE_SHOT) != 0;
    if (!shows && d->kept[KEPT_SHOWS] != 0)
        return false;
    d->kept[KEPT_SHOWS] = shows;
    return true;
}

/* The upper bits of big-endian bytes, with a sign. */
static int32_t signed_bits(const uint8_t *from, unsigned bytes, unsigned bits)
{
    uint32_t x = 0;
    for (unsigned k = 0; k < bytes; k++)
        x = x << 8 | from[k];
    x >>= 8u * bytes - bits;
    uint32_t sign = 1u << (bits - 1u);
    return (int32_t)(x ^ sign) - (int32_t)sign;
}

static uint16_t max31856_step(struct device *d, uint32_t now_ms)
{
    int32_t code[DEVICE_CODES] = {0};
    if (!device_has_begun(d))
        return max31856_send(d, now_ms);
    uint16_t faults = device_ended(d);
    if (faults != 0)
        return device_finish(d, now_ms, code, faults);
    const uint8_t *in = &d->bytes[1];
    switch (d->stage) {
    case STARTED:
        if (max31856_started(d, in[0])) {
            d->tries = 0;
            d->stage = READ;
            return d->settings.mains_60 ? CONVERT_60_MS : CONVERT_50_MS;
        }
        if (++d->tries == PAIRS_MAX) {
            d->kept[KEPT_SHOWS] = 0;
            return device_finish(d, now_ms, code, DEVICE_WRONG_CHIP);
        }
        d->stage = CONVERT;
        break;
    case READ:
        memcpy(&d->kept[KEPT_FIRST], in, REGISTERS);
        d->stage = COMPARE;
        break;
    case COMPARE:
        if (max31856_compare(d, in, &faults)) {
            code[0] = signed_bits(&in[AT_LINEAR], 3, 19);
            code[1] = signed_bits(&in[AT_JUNCTION], 2, 14);
            code[2] = in[AT_STATUS];
            d->ready = true;
            return device_finish(d, now_ms, code, faults);
        }
        d->stage = READ;
        break;
    default: /* SET_UP, CONVERT */
        d->stage++;
        break;
    }
    return max31856_send(d, now_ms);
}

static bool max31856_value(const struct device_settings *s, const int32_t code[DEVICE_CODES],
                           float *value)
{
    const struct thermocouple_type *type = find_type(s->type);
    if (type == NULL || code[0] < type->lo * 128 || code[0] > type->hi * 128)
        return false;
    *value = (float)code[0] / 128.0f;
    return true;
}

const struct device_kind max31856_kind = {.name = "max31856",
                                          .unit = "degC",
                                          .line = DEVICE_SPI,
                                          .interval_ms = INTERVAL_MS,
                                          .open = max31856_open,
                                          .step = max31856_step,
                                          .value = max31856_value};
