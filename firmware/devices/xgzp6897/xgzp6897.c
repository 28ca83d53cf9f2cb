/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/xgzp6897/xgzp6897.h"

#include <string.h>

#define ADDRESS    0x6Du
#define AT_DATA    0x06u
#define AT_COMMAND 0x30u
#define AT_SYSTEM  0xA5u
#define REPLY      5u /* three bytes of pressure, two of temperature */

#define MEASURE_BOTH 0x0Au
#define MEASURES     0x08u /* in the command register while a conversion runs */
#define RAW_OUTPUT   0x02u /* in the system register; 0: calibrated */

/* The data sheet says 20 ms. Conversions that follow each other within 30 ms drift (fanfanlatulipe26/XGZP6897D, issue 4). */
#define XGZP6897_MS 25u
#define INTERVAL_MS 100u
#define POLLS_MAX   8u
#define PAIRS_MAX   4u

#define T_LO        (-45 * 256)
#define T_HI        (125 * 256)
#define CODE_MOST   0x7FFFFF
#define OVER_RANGE  1.2f
#define KILO_PASCAL 1000.0f

enum xgzp6897_stage { REST, GET_SYSTEM, SET_SYSTEM, CONVERT, POLL, READ, COMPARE };

/* Counts to a pascal by full scale. */
struct pressure_unit {
    float full_scale; /* kPa; up to here */
    bool with_end;    /* ... and here as well */
    float counts;
};

static const struct pressure_unit units[] = {{1, false, 8192}, {2, false, 4096}, {4, true, 2048},
                                             {8, true, 1024},  {16, true, 512},  {32, true, 256},
                                             {65, true, 128},  {131, true, 64},  {260, true, 32},
                                             {500, true, 16},  {1000, true, 8}};

/* Counts to a pascal; 0: no such full scale. */
static float xgzp6897_counts(float full_scale)
{
    if (!(full_scale > 0.0f))
        return 0.0f;
    for (unsigned k = 0; k < sizeof units / sizeof units[0]; k++)
        if (full_scale < units[k].full_scale ||
            (units[k].with_end && full_scale == units[k].full_scale))
            return units[k].counts;
    return 0.0f;
}

static enum err xgzp6897_open(struct device *d)
{
    if (d->settings.address != ADDRESS || xgzp6897_counts(d->settings.reference) == 0.0f)
        return ERR_RANGE;
    return hal_i2c_open(d->settings.bus);
}

static uint16_t xgzp6897_send(struct device *d, uint32_t now_ms)
{
    if (d->stage == REST) {
        d->began_ms = now_ms;
        d->stage = d->ready ? CONVERT : GET_SYSTEM;
    }
    switch (d->stage) {
    case GET_SYSTEM:
        d->bytes[0] = AT_SYSTEM;
        return device_begin(d, now_ms, 1, 1, 0);
    case SET_SYSTEM:
        d->bytes[0] = AT_SYSTEM;
        d->bytes[1] = (uint8_t)d->kept[0];
        return device_begin(d, now_ms, 2, 0, 0);
    case CONVERT:
        d->began_ms = now_ms;
        d->bytes[0] = AT_COMMAND;
        d->bytes[1] = MEASURE_BOTH;
        return device_begin(d, now_ms, 2, 0, XGZP6897_MS);
    case POLL:
        d->bytes[0] = AT_COMMAND;
        return device_begin(d, now_ms, 1, 1, 0);
    default: /* READ, COMPARE */
        d->bytes[0] = AT_DATA;
        return device_begin(d, now_ms, 1, REPLY, 0);
    }
}

static uint16_t xgzp6897_check(const uint8_t in[REPLY], int32_t code[DEVICE_CODES])
{
    if (device_all(in, REPLY, 0x00))
        return DEVICE_POWER_ON;
    if (device_all(in, REPLY, 0xFF))
        return DEVICE_BUS;
    int32_t p = in[0] << 16 | in[1] << 8 | in[2];
    code[0] = p > CODE_MOST ? p - 0x1000000 : p;
    code[1] = (int16_t)(in[3] << 8 | in[4]);
    bool at_end = code[0] == CODE_MOST || code[0] == -CODE_MOST - 1;
    return at_end || code[1] < T_LO || code[1] > T_HI ? DEVICE_RANGE : 0;
}

/* Takes what came. True: the cycle is over. */
static bool xgzp6897_took(struct device *d, int32_t code[DEVICE_CODES], uint16_t *faults)
{
    const uint8_t *in = d->transfer.in;
    switch (d->stage) {
    case GET_SYSTEM:
        d->kept[0] = in[0] & (uint8_t)~RAW_OUTPUT;
        d->stage = SET_SYSTEM;
        return false;
    case POLL:
        if ((in[0] & MEASURES) == 0) {
            d->tries = 0;
            d->stage = READ;
            return false;
        }
        *faults = DEVICE_WRONG_CHIP; /* if it does not end */
        return ++d->tries == POLLS_MAX;
    case READ:
        memcpy(d->kept, in, REPLY);
        d->stage = COMPARE;
        return false;
    case COMPARE:
        if (memcmp(d->kept, in, REPLY) == 0) {
            d->ready = true;
            *faults = xgzp6897_check(in, code);
            return true;
        }
        *faults = DEVICE_CHECKSUM;
        d->stage = READ;
        return ++d->tries == PAIRS_MAX;
    default: /* SET_SYSTEM, CONVERT */
        d->stage++;
        return false;
    }
}

static uint16_t xgzp6897_step(struct device *d, uint32_t now_ms)
{
    int32_t code[DEVICE_CODES] = {0};
    if (device_has_begun(d)) {
        uint16_t faults = device_ended(d);
        if (faults != 0 || xgzp6897_took(d, code, &faults))
            return device_finish(d, now_ms, code, faults);
    }
    return xgzp6897_send(d, now_ms);
}

static bool xgzp6897_value(const struct device_settings *s, const int32_t code[DEVICE_CODES],
                           float *value)
{
    float counts = xgzp6897_counts(s->reference);
    if (counts == 0.0f)
        return false;
    float p = (float)code[0] / counts, most = OVER_RANGE * KILO_PASCAL * s->reference;
    if (p > most || p < -most)
        return false;
    *value = p;
    return true;
}

const struct device_kind xgzp6897_kind = {.name = "xgzp6897",
                                          .unit = "Pa",
                                          .line = DEVICE_I2C,
                                          .interval_ms = INTERVAL_MS,
                                          .open = xgzp6897_open,
                                          .step = xgzp6897_step,
                                          .value = xgzp6897_value};
