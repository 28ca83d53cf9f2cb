/* Facts: data sheet of the DS18B20, memory map (scratchpad) and command set (table 4). Byte 6: see cpetrich/counterfeit_DS18B20, issue 26.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/ds18b20/ds18b20.h"

#include <string.h>

#include "devices/ds18b20/crc8.h"

#define MATCH_ROM        0x55u
#define CONVERT_T        0x44u
#define WRITE_SCRATCHPAD 0x4Eu
#define READ_SCRATCHPAD  0xBEu
#define SCRATCHPAD       9u
#define TWELVE_BITS      0x7Fu
/* Alarm bytes as a mark; the chips come with 4Bh and 46h. */
#define MARK_HIGH       0x7Du
#define MARK_LOW        0xC9u
#define POWER_ON_VALUE  0x0550
#define POWER_ON_BYTE_6 0x0Cu
/* 12 bits take 750 ms at most. */
#define DS18B20_MS  760u
#define READS_MAX   2u
#define INTERVAL_MS 1000u

enum ds18b20_stage { REST, SET_UP, CONVERT, READ };

bool ds18b20_is_address(const uint8_t rom[ONEWIRE_ROM_BYTES])
{
    return rom[0] == DS18B20_FAMILY && crc8_onewire(rom, ONEWIRE_ROM_BYTES) == 0;
}

static enum err ds18b20_open(struct device *d)
{
    if (!ds18b20_is_address(d->settings.rom))
        return ERR_RANGE;
    return hal_onewire_open(d->settings.bus);
}

static uint16_t ds18b20_send(struct device *d, uint32_t now_ms)
{
    if (d->stage == REST) {
        d->began_ms = now_ms;
        d->stage = d->ready ? CONVERT : SET_UP;
    }
    uint8_t *command = &d->bytes[1 + ONEWIRE_ROM_BYTES];
    d->bytes[0] = MATCH_ROM;
    memcpy(&d->bytes[1], d->settings.rom, ONEWIRE_ROM_BYTES);
    switch (d->stage) {
    case SET_UP:
        command[0] = WRITE_SCRATCHPAD;
        command[1] = MARK_HIGH;
        command[2] = MARK_LOW;
        command[3] = TWELVE_BITS;
        return device_begin(d, now_ms, 1 + ONEWIRE_ROM_BYTES + 4, 0, 0);
    case CONVERT:
        d->began_ms = now_ms;
        command[0] = CONVERT_T;
        return device_begin(d, now_ms, 1 + ONEWIRE_ROM_BYTES + 1, 0, DS18B20_MS);
    default: /* READ */
        command[0] = READ_SCRATCHPAD;
        return device_begin(d, now_ms, 1 + ONEWIRE_ROM_BYTES + 1, SCRATCHPAD, 0);
    }
}

/* Judges a scratchpad whose checksum is right. */
static uint16_t ds18b20_check(const uint8_t in[SCRATCHPAD], int32_t code)
{
    if (in[2] != MARK_HIGH || in[3] != MARK_LOW ||
        (code == POWER_ON_VALUE && in[6] == POWER_ON_BYTE_6))
        return DEVICE_POWER_ON;
    return in[4] == TWELVE_BITS ? 0 : DEVICE_WRONG_CHIP;
}

static uint16_t ds18b20_step(struct device *d, uint32_t now_ms)
{
    int32_t code[DEVICE_CODES] = {0};
    if (!device_has_begun(d))
        return ds18b20_send(d, now_ms);
    uint16_t faults = device_ended(d);
    if (faults != 0)
        return device_finish(d, now_ms, code, faults);
    if (d->stage != READ) {
        d->ready = true;
        d->stage++;
        return ds18b20_send(d, now_ms);
    }
    const uint8_t *in = d->transfer.in;
    if (device_all(in, SCRATCHPAD, 0xFF)) {
        faults = DEVICE_NO_CHIP;
    } else if (device_all(in, SCRATCHPAD, 0x00)) {
        faults = DEVICE_BUS;
    } else if (crc8_onewire(in, SCRATCHPAD) != 0) {
        if (++d->tries < READS_MAX)
            return ds18b20_send(d, now_ms);
        faults = DEVICE_CHECKSUM;
    } else {
        code[0] = (int16_t)(in[0] | in[1] << 8);
        faults = ds18b20_check(in, code[0]);
    }
    return device_finish(d, now_ms, code, faults);
}

/* The range of the chip is -55 to 125 degC. */
static bool ds18b20_value(const struct device_settings *s, const int32_t code[DEVICE_CODES],
                          float *value)
{
    (void)s;
    if (code[0] < -55 * 16 || code[0] > 125 * 16)
        return false;
    *value = (float)code[0] / 16.0f;
    return true;
}

const struct device_kind ds18b20_kind = {.name = "ds18b20",
                                         .unit = "degC",
                                         .line = DEVICE_ONEWIRE,
                                         .interval_ms = INTERVAL_MS,
                                         .open = ds18b20_open,
                                         .step = ds18b20_step,
                                         .value = ds18b20_value};
