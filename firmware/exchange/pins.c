/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "exchange/pins.h"

#include <stddef.h>
#include <string.h>

#define PORT_LAST  'I'
#define DIGIT_NONE 16u

enum bus_family pins_device_family(enum device_word device)
{
    switch (device) {
    case DEVICE_MAX31865:
    case DEVICE_MAX31856:
        return BUS_FAMILY_SPI;
    case DEVICE_ADS1115:
    case DEVICE_BME280:
    case DEVICE_BME280_TEMPERATURE:
    case DEVICE_XGZP6897:
        return BUS_FAMILY_I2C;
    case DEVICE_DS18B20:
        return BUS_FAMILY_WIRE;
    default:
        return BUS_FAMILY_PINS;
    }
}

enum bus_family pins_bus_family(enum bus_word bus, uint8_t *number)
{
    static const struct {
        uint8_t first, last;
    } of[] = {[BUS_FAMILY_SPI] = {BUS_SPI1, BUS_SPI3},
              [BUS_FAMILY_I2C] = {BUS_I2C1, BUS_I2C2},
              [BUS_FAMILY_WIRE] = {BUS_WIRE1, BUS_WIRE2}};
    for (unsigned f = BUS_FAMILY_SPI; f <= BUS_FAMILY_WIRE; f++)
        if (bus >= of[f].first && bus <= of[f].last) {
            *number = (uint8_t)(bus - of[f].first + 1u);
            return (enum bus_family)f;
        }
    *number = 0;
    return BUS_FAMILY_PINS;
}

struct output_settings pins_output(const struct pins_config *pins, unsigned i)
{
    const struct output_config *o = &pins->output[i];
    struct output_settings s = o->settings;
    if (o->name[0] == '\0')
        s.type = OUTPUT_NONE;
    s.mains_60 = pins->mains_60 != 0;
    for (unsigned k = 0; k < OUTPUT_PINS; k++)
        s.pin[k] = pins_of_word(o->settings.pin[k]);
    return s;
}

enum err pins_parse_pin(const char *text, uint8_t *pin)
{
    unsigned number = 0, digits = 0;
    if (text[0] != 'P' || text[1] < 'A' || text[1] > PORT_LAST)
        return ERR_PARSE;
    for (const char *s = text + 2; *s != '\0'; s++, digits++) {
        if (*s < '0' || *s > '9' || digits == 2)
            return ERR_PARSE;
        number = number * 10u + (unsigned)(*s - '0');
    }
    if (digits == 0 || number > 15u || (digits == 2 && text[2] == '0'))
        return ERR_PARSE;
    *pin = (uint8_t)((unsigned)(text[1] - 'A') * 16u + number);
    return ERR_OK;
}

static unsigned hex_digit(char c)
{
    if (c >= '0' && c <= '9')
        return (unsigned)(c - '0');
    if (c >= 'a' && c <= 'f')
        return (unsigned)(c - 'a') + 10u;
    return c >= 'A' && c <= 'F' ? (unsigned)(c - 'A') + 10u : DIGIT_NONE;
}

/* Two digits; false: they are none. */
static bool hex_byte(const char *text, uint8_t *byte)
{
    unsigned high = hex_digit(text[0]), low = high == DIGIT_NONE ? DIGIT_NONE : hex_digit(text[1]);
    *byte = (uint8_t)(high * 16u + low);
    return low != DIGIT_NONE;
}

enum err pins_parse_address(const char *text, uint8_t *address)
{
    uint8_t byte;
    if (text[0] != '0' || text[1] != 'x' || strlen(text) != 4 || !hex_byte(text + 2, &byte))
        return ERR_PARSE;
    /* The others are reserved (UM10204 3.1.12) (unverified). */
    if (byte < 0x08u || byte > 0x77u)
        return ERR_RANGE;
    *address = byte;
    return ERR_OK;
}

/* CRC-8 of a ROM: x^8 + x^5 + x^4 + 1, least significant bit first. */
static uint8_t rom_crc(const uint8_t *bytes, size_t n)
{
    uint8_t crc = 0;
    for (size_t i = 0; i < n; i++) {
        crc ^= bytes[i];
        for (unsigned bit = 0; bit < 8; bit++)
            crc = (uint8_t)((crc >> 1) ^ ((crc & 1u) != 0 ? 0x8Cu : 0u));
    }
    return crc;
}

enum err pins_parse_rom(const char *text, uint8_t rom[PINS_ROM_BYTES])
{
    if (strlen(text) != (size_t)2 * (PINS_ROM_BYTES - 1u))
        return ERR_PARSE;
    for (unsigned i = 0; i < PINS_ROM_BYTES - 1u; i++) {
        unsigned place = i == 0 ? 0
                                : PINS_ROM_BYTES - 1u -
                                      i; /* the family first, then the serial number backwards */
        if (!hex_byte(text + (size_t)2 * i, &rom[place]))
            return ERR_PARSE;
    }
    rom[PINS_ROM_BYTES - 1u] = rom_crc(rom, PINS_ROM_BYTES - 1u);
    return ERR_OK;
}
