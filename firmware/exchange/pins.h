/* Settings of devices and outputs at the board's own pins (docs/reference/parameters.md: chan, out, io).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_EXCHANGE_PINS_H
#define REFLUX_EXCHANGE_PINS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/channel.h"
#include "base/error.h"
#include "outputs/output_settings.h"

/* Devices that a board may have. 0: it takes its plant from the link only; such a board says so in its limits, because its port looks there
 * (hal/tick.h). */
#ifndef CONFIG_DEVICES
#define CONFIG_DEVICES 12
#endif
/* Whether the plant may be at the plant link. 0: at the board's own pins only. Such a board says so in its limits, because its port looks there
 * (hal/uart.h). */
#ifndef CONFIG_LINK
#define CONFIG_LINK 1
#endif

/* Words of chan.device and chan.bus in settings/parameter_table.c, in their order. */
enum device_word {
    DEVICE_NONE,
    DEVICE_MAX31865,
    DEVICE_MAX31856,
    DEVICE_DS18B20,
    DEVICE_ADS1115,
    DEVICE_BME280,
    DEVICE_BME280_TEMPERATURE,
    DEVICE_XGZP6897,
    DEVICE_ANALOG,
    DEVICE_FLOW,
    DEVICE_LEVEL,
    DEVICE_PULSES,
    DEVICE_WORDS
};
enum bus_word {
    BUS_NONE,
    BUS_SPI1,
    BUS_SPI2,
    BUS_SPI3,
    BUS_I2C1,
    BUS_I2C2,
    BUS_WIRE1,
    BUS_WIRE2,
    BUS_WORDS
};
enum bus_family { BUS_FAMILY_PINS, BUS_FAMILY_SPI, BUS_FAMILY_I2C, BUS_FAMILY_WIRE };

enum io_source { IO_SOURCE_LINK, IO_SOURCE_BOARD, IO_SOURCE_BOTH };

struct device_config {
    char name[CHANNEL_NAME_SIZE];   /* of the measurement that it gives; empty: unused */
    char select[CHANNEL_NAME_SIZE]; /* pin, address or ROM, as its bus has it */
    char unit[CHANNEL_UNIT_SIZE];
    float lo, hi;    /* EU at the ends of its signal, or span that is announced */
    float reference; /* ohm or V; 0: what its board usually has */
    float nominal;   /* ohm; 0: usual */
    uint16_t input;  /* of a chip with several */
    uint8_t device;  /* word of the table */
    uint8_t bus;     /* word of the table */
    uint8_t type;    /* of the sensor: word of the table */
};

enum proof_kind { PROOF_KIND_NONE, PROOF_KIND_WARMS, PROOF_KIND_FLOWS };

/* How an output is proved (io/output_proof.h). EU: of its channel. */
struct proof_config {
    float change;   /* EU: heater: least rise and fall; pump or valve: least flow */
    uint16_t on_s;  /* 0: not judged */
    uint16_t off_s; /* 0: not judged */
    uint16_t limit; /* EU: heater: below every temperature at which its liquid may boil */
    uint8_t kind;   /* enum proof_kind */
    uint8_t device; /* row of chan, from 1; 0: none */
};

struct output_config {
    char name[CHANNEL_NAME_SIZE]; /* of the manipulated variable; empty: unused */
    char unit[CHANNEL_UNIT_SIZE];
    float lo, hi; /* EU at command 0 and 1 */
    /* Its pins are words of the table here: 0 none, 1 PA0 (pins_of_word()). Not used: mains_60, which holds for all. */
    struct output_settings settings;
    struct proof_config proof;
};

#if CONFIG_DEVICES
#define CONFIG_OUTPUTS OUTPUTS_MAX
struct pins_config {
    struct device_config device[CONFIG_DEVICES];
    struct output_config output[CONFIG_OUTPUTS];
    char enable
        [CHANNEL_NAME_SIZE]; /* pin of the contactor in series with all heaters; empty: none */
    uint8_t source;          /* enum io_source */
    uint8_t mains_60;        /* 1: 60 Hz */
};
#else
struct pins_config {
};
#endif

/* Where the plant is. */
#if CONFIG_DEVICES
static inline enum io_source pins_source(const struct pins_config *pins)
{
    return (enum io_source)pins->source;
}
#else
static inline enum io_source pins_source(const struct pins_config *pins)
{
    (void)pins;
    return IO_SOURCE_LINK;
}
#endif

/* Whether the plant, or a part of it, is at the board's pins; then its clock samples. */
static inline bool pins_are_source(const struct pins_config *pins)
{
    return pins_source(pins) != IO_SOURCE_LINK;
}
/* Whether the plant, or a part of it, is at the link. */
static inline bool pins_leave_link(const struct pins_config *pins)
{
    return pins_source(pins) != IO_SOURCE_BOARD;
}

#if CONFIG_DEVICES
/* The settings of output i as firmware/outputs wants them. */
struct output_settings pins_output(const struct pins_config *pins, unsigned i);
#endif

/* The family of buses that a device needs, and that a bus belongs to with its number in the family, from 1. */
enum bus_family pins_device_family(enum device_word device);
enum bus_family pins_bus_family(enum bus_word bus, uint8_t *number);

#define PINS_ROM_BYTES 8u

/* The pin of a word of out.pin; HAL_PIN_NONE for 0. */
static inline hal_pin pins_of_word(uint8_t word)
{
    return word == 0 ? HAL_PIN_NONE : (hal_pin)(word - 1u);
}

/* Read what chan.select and the pins of out have: "PA4" (16 x port + number, hal/pin.h), "0x48", and "28000005e2fdc3": the family of a 1-wire
 * device and its serial number, most significant byte first, as Linux names it; the checksum at the end of the ROM is computed. ERR_PARSE. */
MUST_CHECK enum err pins_parse_pin(const char *text, uint8_t *pin);
MUST_CHECK enum err pins_parse_address(const char *text, uint8_t *address);
MUST_CHECK enum err pins_parse_rom(const char *text, uint8_t rom[PINS_ROM_BYTES]);

#endif
