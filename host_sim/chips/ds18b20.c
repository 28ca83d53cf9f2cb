/* DS18B20, thermometer on a wire, with a supply of its own. Sections are those of the data sheet; its table 1 was read (rev. 042208, page 4).
 * Commands, times and the values of the factory are from memory (unverified). Byte 6 of the scratchpad: github.com/cpetrich/counterfeit_DS18B20, issue 26.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "chips/chip_inside.h"

#define FAMILY    0x28u
#define ROM_BYTES 8u
#define PAD_BYTES 9u

/* Commands for the ROM, and then for the chip. */
enum {
    SEARCH_ROM = 0xF0,
    READ_ROM = 0x33,
    MATCH_ROM = 0x55,
    SKIP_ROM = 0xCC,
    ALARM_SEARCH = 0xEC,
    CONVERT_T = 0x44,
    WRITE_PAD = 0x4E,
    READ_PAD = 0xBE,
    COPY_PAD = 0x48,
    RECALL = 0xB8,
    READ_SUPPLY = 0xB4
};

/* Scratchpad. */
enum {
    TEMPERATURE_LOW,
    TEMPERATURE_HIGH,
    ALARM_HIGH,
    ALARM_LOW,
    CONFIG,
    RESERVED,
    COUNT_REMAIN = 6,
    PAD_CRC = 8
};
#define EEPROM_BYTES 3u /* from ALARM_HIGH on */

#define COPY_NS          10000000u
#define POWER_ON_CODE    0x0550 /* 85 degC */
#define POWER_ON_REMAIN  0x0Cu
#define CONVERSION_MS_12 750.0

enum state {
    IDLE,       /* no reset yet, or the command is done */
    DESELECTED, /* another chip is meant: silent until the next reset */
    ROM_COMMAND,
    ROM_MATCH,
    ROM_SEARCH,
    FUNCTION,
    SENDING,
    TAKING, /* three bytes of the scratchpad */
    BUSY    /* answers slots with 0 until it is ready */
};

/* 28-000005e2fdc3: family and 48 bits, as Linux writes addresses. */
static bool parse_rom(const char *text, double *value)
{
    if (strncmp(text, "28-", 3) != 0 || strlen(text) != 15 ||
        strspn(text + 3, "0123456789abcdefABCDEF") != 12) {
        return false;
    }
    *value = (double)strtoull(text + 3, NULL, 16);
    return true;
}

enum { ROM };
static const struct chip_property properties[] = {
    [ROM] = {.name = "rom",
             .unit = "",
             .lo = 0,
             .hi = 281474976710655.0,
             .at_first = NAN,
             .parse = parse_rom,
             .form = "28- and 12 hexadecimal digits"},
};

enum { TEMPERATURE, POWER_LOSS, CRC, SHORT };
static const struct chip_input inputs[] = {
    [TEMPERATURE] = {"temperature", "degC", -100, 200, 20, "of the chip"},
    [POWER_LOSS] = {"power_loss", "", 0, 1, 0, "it starts anew, and again in each conversion"},
    [CRC] = {"crc", "", 0, 1, 0, "one bit of each scratchpad or address is turned on the way"},
    [SHORT] = {"short", "", 0, 1, 0, "the line is shorted to ground"},
};

struct ds18b20 {
    struct chip chip;
    uint8_t rom[ROM_BYTES];
    uint8_t pad[PAD_BYTES];
    uint8_t eeprom[EEPROM_BYTES];
    bool made; /* rom and eeprom are there */
    bool lost; /* the loss of power that is there has been taken over */
    bool alarm;
    enum state state;
    uint8_t shift; /* what comes in */
    unsigned bits; /* of the byte, the address or the search */
    unsigned step; /* of a search: 0 bit, 1 complement, 2 choice */
    uint8_t out[PAD_BYTES];
    unsigned n_out;  /* bits */
    double slowness; /* part of the longest time that a conversion takes */
    bool converting;
    bool result_asked; /* and it has not been read too early */
    uint64_t asked_ns, end_ns, copied_ns;
};

static struct ds18b20 *of(struct chip *c)
{
    return (struct ds18b20 *)c;
}

/* CRC-8 with x^8 + x^5 + x^4 + 1, least significant bit first. */
static uint8_t crc8(const uint8_t *bytes, size_t n)
{
    uint8_t crc = 0;
    for (size_t i = 0; i < n * 8u; i++) {
        bool bit = (((unsigned)bytes[i / 8u] >> (i % 8u)) ^ crc) & 1u;
        crc = (uint8_t)((crc >> 1) ^ (bit ? 0x8Cu : 0u));
    }
    return crc;
}

static void make(struct ds18b20 *d)
{
    static const uint8_t factory[EEPROM_BYTES] = {0x4B, 0x46, 0x7F}; /* 75, 70 degC, 12 bits */
    uint64_t own = d->chip.seed ^ 0x18B20u;
    uint64_t serial =
        isnan(d->chip.property[ROM]) ? chip_random(&own) >> 16 : (uint64_t)d->chip.property[ROM];
    d->chip.property[ROM] = (double)serial;
    d->rom[0] = FAMILY;
    for (unsigned i = 0; i < 6; i++) {
        d->rom[1 + i] = (uint8_t)(serial >> (8u * i));
    }
    d->rom[7] = crc8(d->rom, 7);
    memcpy(d->eeprom, factory, sizeof(factory));
    d->slowness = 0.7 + 0.3 * chip_uniform(&own);
    d->made = true;
}

static void put_code(struct ds18b20 *d, int32_t code, uint8_t remain)
{
    d->pad[TEMPERATURE_LOW] = (uint8_t)code;
    d->pad[TEMPERATURE_HIGH] = (uint8_t)((uint32_t)code >> 8);
    d->pad[COUNT_REMAIN] = remain;
}

static void power_on(struct chip *c, uint64_t now_ns)
{
    struct ds18b20 *d = of(c);
    (void)now_ns;
    if (!d->made) {
        make(d);
    }
    put_code(d, POWER_ON_CODE, POWER_ON_REMAIN);
    memcpy(&d->pad[ALARM_HIGH], d->eeprom, EEPROM_BYTES);
    d->pad[RESERVED] = 0xFF;
    d->pad[7] = 0x10;
    d->state = IDLE;
    d->converting = d->result_asked = d->alarm = false;
}

/* Bits that the resolution leaves undefined: 3 of 9 bits, 0 of 12. */
static unsigned undefined_bits(const struct ds18b20 *d)
{
    return 3u - ((d->pad[CONFIG] >> 5) & 3u);
}

static double longest_ms(const struct ds18b20 *d)
{
    return CONVERSION_MS_12 / (double)(1u << undefined_bits(d));
}

static void end_conversion(struct ds18b20 *d)
{
    int32_t code = chip_code(d->chip.input[TEMPERATURE] * 16.0, -55 * 16, 125 * 16);
    code &= ~(int32_t)((1u << undefined_bits(d)) - 1u);
    put_code(d, code, (uint8_t)(0x10u - ((uint32_t)code & 0x0Fu)));
    int degc = code >> 4; /* bits 11 to 4 take part in the comparison */
    d->alarm = degc <= (int8_t)d->pad[ALARM_LOW] || degc >= (int8_t)d->pad[ALARM_HIGH];
    d->converting = false;
}

static void catch_up(struct chip *c, uint64_t now_ns)
{
    struct ds18b20 *d = of(c);
    bool lost = c->input[POWER_LOSS] != 0.0;
    bool ends = d->converting && d->end_ns <= now_ns;
    if (lost && (!d->lost || ends)) {
        power_on(c, now_ns);
        d->state = DESELECTED;
    } else if (ends) {
        end_conversion(d);
    }
    d->lost = lost;
}

/* A reset pulse. */
static bool presence(struct chip *c, uint64_t now_ns)
{
    struct ds18b20 *d = of(c);
    catch_up(c, now_ns);
    d->state = ROM_COMMAND;
    d->bits = 0;
    return true;
}

/* Sends bytes; behind them the line stays high. */
static void send(struct ds18b20 *d, const uint8_t *bytes, size_t n)
{
    memcpy(d->out, bytes, n);
    d->n_out = (unsigned)n * 8u;
    if (d->chip.input[CRC] != 0.0) {
        unsigned bit = (unsigned)(chip_random(&d->chip.random) % d->n_out);
        d->out[bit / 8u] ^= (uint8_t)(1u << (bit % 8u));
    }
    d->state = SENDING;
}

static void rom_command(struct ds18b20 *d, uint8_t command)
{
    d->step = 0;
    switch (command) {
    case READ_ROM:
        send(d, d->rom, ROM_BYTES);
        break;
    case MATCH_ROM:
        d->state = ROM_MATCH;
        break;
    case SKIP_ROM:
        d->state = FUNCTION;
        break;
    case SEARCH_ROM:
        d->state = ROM_SEARCH;
        break;
    case ALARM_SEARCH:
        d->state = d->alarm ? ROM_SEARCH : DESELECTED;
        break;
    default:
        chip_wrong(&d->chip, "%02Xh is no command for the address", command);
        d->state = DESELECTED;
    }
}

static void send_scratchpad(struct ds18b20 *d, uint64_t now_ns)
{
    uint64_t since_ns = now_ns - d->asked_ns;
    if (d->result_asked && (d->converting || since_ns < CHIP_MS(longest_ms(d)))) {
        chip_wrong(&d->chip, "scratchpad read %.1f ms after Convert T, which takes up to %g ms",
                   (double)since_ns * 1e-6, longest_ms(d));
    }
    d->result_asked = false;
    d->pad[PAD_CRC] = crc8(d->pad, PAD_CRC);
    send(d, d->pad, PAD_BYTES);
}

static void function_command(struct ds18b20 *d, uint64_t now_ns, uint8_t command)
{
    d->state = IDLE;
    if (now_ns < d->copied_ns) {
        chip_wrong(&d->chip, "%02Xh while the scratchpad is copied, which takes 10 ms", command);
    }
    switch (command) {
    case CONVERT_T:
        if (d->converting) {
            chip_wrong(&d->chip, "Convert T while it converts");
        }
        d->converting = d->result_asked = true;
        d->asked_ns = now_ns;
        d->end_ns = now_ns + CHIP_MS(d->slowness * longest_ms(d));
        d->state = BUSY;
        break;
    case READ_PAD:
        send_scratchpad(d, now_ns);
        break;
    case WRITE_PAD:
        if (d->converting) {
            chip_wrong(&d->chip, "scratchpad written while it converts");
        }
        d->state = TAKING;
        break;
    case COPY_PAD:
        memcpy(d->eeprom, &d->pad[ALARM_HIGH], EEPROM_BYTES);
        d->copied_ns = now_ns + COPY_NS;
        d->state = BUSY;
        break;
    case RECALL:
        memcpy(&d->pad[ALARM_HIGH], d->eeprom, EEPROM_BYTES);
        d->state = BUSY;
        break;
    case READ_SUPPLY:
        break; /* leaves the line high: it has a supply */
    default:
        chip_wrong(&d->chip, "%02Xh is no command", command);
    }
}

static void take_byte(struct ds18b20 *d, uint64_t now_ns)
{
    if (d->state == ROM_COMMAND) {
        d->bits = 0;
        rom_command(d, d->shift);
    } else if (d->state == FUNCTION) {
        d->bits = 0;
        function_command(d, now_ns, d->shift);
    } else { /* TAKING */
        unsigned i = d->bits / 8u - 1u;
        /* Only the resolution can be written in the configuration: 0 R1 R0 11111. */
        d->pad[ALARM_HIGH + i] = i == 2 ? (uint8_t)((d->shift & 0x60u) | 0x1Fu) : d->shift;
        if (i == 2) {
            d->state = IDLE;
        }
    }
}

static bool rom_bit(const struct ds18b20 *d)
{
    return ((unsigned)d->rom[d->bits / 8u] >> (d->bits % 8u)) & 1u;
}

/* The next bit of the address is chosen: another one than this chip's ends its part. */
static void choose(struct ds18b20 *d, bool bit)
{
    if (bit != rom_bit(d)) {
        d->state = DESELECTED;
    } else if (++d->bits == ROM_BYTES * 8u) {
        d->bits = 0;
        d->state = FUNCTION;
    }
}

static bool bit_in(struct chip *c, uint64_t now_ns)
{
    const struct ds18b20 *d = of(c);
    if (c->input[SHORT] != 0.0) {
        return false;
    }
    switch (d->state) {
    case SENDING:
        return d->bits >= d->n_out || (((unsigned)d->out[d->bits / 8u] >> (d->bits % 8u)) & 1u);
    case ROM_SEARCH:
        return d->step == 2 || rom_bit(d) == (d->step == 0);
    case BUSY:
        return !(d->converting && now_ns < d->end_ns) && now_ns >= d->copied_ns;
    default:
        return true;
    }
}

static void bit_out(struct chip *c, uint64_t now_ns, bool bit)
{
    struct ds18b20 *d = of(c);
    catch_up(c, now_ns);
    switch (d->state) {
    case SENDING:
        d->bits++;
        if (d->bits == d->n_out && d->n_out == ROM_BYTES * 8u) {
            d->bits = 0;
            d->state = FUNCTION;
        }
        break;
    case ROM_SEARCH:
        if (d->step == 2) {
            choose(d, bit);
        }
        d->step = (d->step + 1u) % 3u;
        break;
    case ROM_MATCH:
        choose(d, bit);
        break;
    case ROM_COMMAND:
    case FUNCTION:
    case TAKING:
        d->shift = (uint8_t)(d->shift >> 1 | (bit ? 0x80u : 0u));
        if (++d->bits % 8u == 0) {
            take_byte(d, now_ns);
        }
        break;
    case IDLE:
        if (!bit) {
            chip_wrong(c, "slot written without a reset since power-on or the last command");
        }
        break;
    default:
        break;
    }
}

const struct chip_kind chip_ds18b20 = {.name = "ds18b20",
                                       .bus = CHIP_ONEWIRE,
                                       .properties = properties,
                                       .n_properties = CHIP_COUNT(properties),
                                       .inputs = inputs,
                                       .n_inputs = CHIP_COUNT(inputs),
                                       .size = sizeof(struct ds18b20),
                                       .power_on = power_on,
                                       .catch_up = catch_up,
                                       .presence = presence,
                                       .bit_out = bit_out,
                                       .bit_in = bit_in};
