/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "service/pins_check.h"

#include <string.h>

#include "devices/devices.h"
#include "hal/analog.h"
#include "hal/i2c.h"
#include "hal/onewire.h"
#include "hal/spi.h"
#include "io/board_devices.h"
#include "outputs/output_check.h"
#include "outputs/output_kind.h"

/* Select or address, three pins of a bus, of each device; and the pins of each output. */
#define CLAIMS_MAX (4u * CONFIG_DEVICES + OUTPUT_PINS * CONFIG_OUTPUTS)

/* Pins that are taken so far. */
struct claims {
    hal_pin pin[CLAIMS_MAX];
    uint8_t bus
        [CLAIMS_MAX]; /* enum bus_word: a pin of that bus, which its devices share; BUS_NONE: of one device alone */
    unsigned n;
};

static enum err refuse_pins(struct config_fault *fault, enum err code, const char *group,
                            unsigned index, const char *field, const char *subject,
                            const char *wanted)
{
    *fault = (struct config_fault){
        .code = code, .group = group, .index = (uint8_t)index, .field = field, .wanted = wanted};
    strncpy(fault->subject, subject, sizeof fault->subject - 1);
    return code;
}

static bool claim(struct claims *c, hal_pin pin, uint8_t bus)
{
    for (unsigned i = 0; i < c->n; i++)
        if (c->pin[i] == pin)
            return bus != BUS_NONE && c->bus[i] == bus;
    c->pin[c->n] = pin;
    c->bus[c->n++] = bus;
    return true;
}

#define PIN_WANTED                                                                                 \
    "must be a free pin, PA4 say; the console, the debugger and the boot loader keep theirs"
#define PIN_TWICE   "is taken by another device, output or bus"
#define BUS_WANTED  "must be a bus that the device speaks: spi, i2c or wire; - for one at a pin"
#define BUS_LACKING "is none of this board's"
#define BUS_TAKEN   "needs a pin that is taken by another device or output"

static enum err claim_pin(struct claims *claims, const char *group, unsigned index,
                          const char *field, const char *text, struct config_fault *fault)
{
    hal_pin pin;
    if (pins_parse_pin(text, &pin) != ERR_OK || !hal_pin_is_free(pin))
        return refuse_pins(fault, ERR_RANGE, group, index, field, text, PIN_WANTED);
    if (!claim(claims, pin, BUS_NONE))
        return refuse_pins(fault, ERR_CONFLICT, group, index, field, text, PIN_TWICE);
    return ERR_OK;
}

/* Pins of the bus of a device; how many. 0: the board has no such bus. */
static unsigned bus_pins(enum bus_word bus, hal_pin pins[3])
{
    uint8_t number;
    switch (pins_bus_family(bus, &number)) {
    case BUS_FAMILY_SPI:
        return hal_spi_pins(number, pins) ? 3u : 0u;
    case BUS_FAMILY_I2C:
        return hal_i2c_pins(number, pins) ? 2u : 0u;
    case BUS_FAMILY_WIRE:
        return hal_onewire_pin(number, pins) ? 1u : 0u;
    default:
        return 0;
    }
}

/* Whether two rows are on the same bus and there the same chip. Letters among the digits are of either case. */
static bool is_same_chip(const struct device_config *a, const struct device_config *b)
{
    uint8_t address[2], rom[2][PINS_ROM_BYTES];
    if (a->name[0] == '\0' || a->bus != b->bus)
        return false;
    if (pins_device_family((enum device_word)b->device) == BUS_FAMILY_I2C)
        return pins_parse_address(a->select, &address[0]) == ERR_OK &&
               pins_parse_address(b->select, &address[1]) == ERR_OK && address[0] == address[1];
    return pins_parse_rom(a->select, rom[0]) == ERR_OK &&
           pins_parse_rom(b->select, rom[1]) == ERR_OK &&
           memcmp(rom[0], rom[1], sizeof rom[0]) == 0;
}

/* Pressure and temperature of one barometer are two devices of one chip. */
static bool is_barometer(const struct device_config *d)
{
    return d->device == DEVICE_BME280 || d->device == DEVICE_BME280_TEMPERATURE;
}

static enum err check_select(const struct config *config, unsigned i, struct claims *claims,
                             enum bus_family family, struct config_fault *fault)
{
    const struct device_config *d = &config->pins.device[i];
    uint8_t address, rom[PINS_ROM_BYTES];
    hal_pin pin;
    switch (family) {
    case BUS_FAMILY_I2C:
        if (pins_parse_address(d->select, &address) != ERR_OK)
            return refuse_pins(fault, ERR_RANGE, "chan", i + 1, "select", d->select,
                               "must be its address on the bus, 0x08 to 0x77");
        break;
    case BUS_FAMILY_WIRE:
        if (pins_parse_rom(d->select, rom) != ERR_OK)
            return refuse_pins(fault, ERR_RANGE, "chan", i + 1, "select", d->select,
                               "must be family and serial number, 14 digits: 28000005e2fdc3");
        break;
    default:
        if (d->device == DEVICE_ANALOG && pins_parse_pin(d->select, &pin) == ERR_OK &&
            !hal_analog_has(pin))
            return refuse_pins(fault, ERR_RANGE, "chan", i + 1, "select", d->select,
                               "has no analogue input");
        return claim_pin(claims, "chan", i + 1, "select", d->select, fault);
    }
    /* Several inputs of one chip may be read, each once. */
    for (unsigned k = 0; k < i; k++) {
        const struct device_config *other = &config->pins.device[k];
        if (!is_same_chip(other, d))
            continue;
        if (other->device != d->device && is_barometer(other) && is_barometer(d))
            continue;
        if (other->device != d->device)
            return refuse_pins(fault, ERR_CONFLICT, "chan", i + 1, "select", d->select,
                               "is the address of another chip as well");
        if (other->input == d->input)
            return refuse_pins(fault, ERR_CONFLICT, "chan", i + 1, "input", d->name,
                               "is read by another channel already");
    }
    return ERR_OK;
}

static enum err check_device(const struct config *config, unsigned i, struct claims *claims,
                             struct config_fault *fault)
{
    const struct device_config *d = &config->pins.device[i];
    hal_pin pins[3];
    uint8_t number;
    for (unsigned k = 0; k < i; k++)
        if (strcmp(config->pins.device[k].name, d->name) == 0)
            return refuse_pins(fault, ERR_CONFLICT, "chan", i + 1, "name", d->name,
                               "is used twice");
    if (d->device == DEVICE_NONE)
        return refuse_pins(fault, ERR_EMPTY, "chan", i + 1, "device", d->name,
                           "must say what is at the pins");
    enum bus_family family = pins_device_family((enum device_word)d->device);
    if (pins_bus_family((enum bus_word)d->bus, &number) != family)
        return refuse_pins(fault, ERR_CONFLICT, "chan", i + 1, "bus", d->name, BUS_WANTED);
    unsigned n = family == BUS_FAMILY_PINS ? 0 : bus_pins((enum bus_word)d->bus, pins);
    if (family != BUS_FAMILY_PINS && n == 0)
        return refuse_pins(fault, ERR_UNKNOWN, "chan", i + 1, "bus", d->name, BUS_LACKING);
    for (unsigned k = 0; k < n; k++)
        if (!claim(claims, pins[k], d->bus))
            return refuse_pins(fault, ERR_CONFLICT, "chan", i + 1, "bus", d->name, BUS_TAKEN);
    if (!board_device_takes_type(d))
        return refuse_pins(fault, ERR_RANGE, "chan", i + 1, "type", d->name,
                           "must be one that the device can have");
    if (!(d->lo < d->hi))
        return refuse_pins(fault, ERR_RANGE, "chan", i + 1, "lo", d->name, "must be below hi");
    return check_select(config, i, claims, family, fault);
}

static const char *const pin_fields[OUTPUT_PINS] = {"pin", "pin2", "end_open", "end_closed",
                                                    "zero_cross"};

/* In place of the bus of a pin: several outputs may look at the same zero crossings. */
#define CROSSING BUS_WORDS

/* Names the field that output_check() complains about. */
static enum err refuse_output(const struct output_config *o, unsigned i,
                              const struct output_problem *problem, struct config_fault *fault)
{
    const char *field = problem->number != NULL      ? problem->number->name
                        : problem->pin < OUTPUT_PINS ? pin_fields[problem->pin]
                                                     : "kind";
    return refuse_pins(fault, problem->number != NULL ? ERR_RANGE : ERR_CONFLICT, "out", i + 1,
                       field, o->name, problem->words);
}

static enum err check_output(const struct config *config, unsigned i, struct claims *claims,
                             struct config_fault *fault)
{
    const struct output_config *o = &config->pins.output[i];
    struct output_settings all[CONFIG_OUTPUTS];
    struct output_problem problem;
    for (unsigned k = 0; k < i; k++)
        if (strcmp(config->pins.output[k].name, o->name) == 0)
            return refuse_pins(fault, ERR_CONFLICT, "out", i + 1, "name", o->name, "is used twice");
    if (o->settings.type == OUTPUT_NONE)
        return refuse_pins(fault, ERR_EMPTY, "out", i + 1, "kind", o->name,
                           "must say what is done with the pin");
    for (unsigned k = 0; k <= i; k++)
        all[k] = pins_output(&config->pins, k);
    if (!output_check(all, (uint8_t)(i + 1u), (uint8_t)i, &problem))
        return refuse_output(o, i, &problem, fault);
    if (all[i].bus != 0 && output_has_bus(all[i].type)) {
        hal_pin pins[3];
        unsigned n = bus_pins((enum bus_word)all[i].bus, pins);
        if (n == 0)
            return refuse_pins(fault, ERR_UNKNOWN, "out", i + 1, "bus", o->name, BUS_LACKING);
        for (unsigned k = 0; k < n; k++)
            if (!claim(claims, pins[k], all[i].bus))
                return refuse_pins(fault, ERR_CONFLICT, "out", i + 1, "bus", o->name, BUS_TAKEN);
    }
    for (unsigned k = 0; k < OUTPUT_PINS; k++)
        if (all[i].pin[k] != HAL_PIN_NONE &&
            !claim(claims, all[i].pin[k], k == OUTPUT_CROSSING ? CROSSING : BUS_NONE))
            return refuse_pins(fault, ERR_CONFLICT, "out", i + 1, pin_fields[k], o->name,
                               PIN_TWICE);
    if (!(o->lo < o->hi))
        return refuse_pins(fault, ERR_RANGE, "out", i + 1, "lo", o->name, "must be below hi");
    return ERR_OK;
}

/* Refuses a proof (io/output_proof.h) that could never tell anything, or would tell wrongly. */
static enum err check_proof(const struct config *config, unsigned i, struct config_fault *fault)
{
    const struct output_config *o = &config->pins.output[i];
    const struct proof_config *p = &o->proof;
    if (p->kind == PROOF_KIND_NONE)
        return ERR_OK;
    if (o->settings.type == OUTPUT_ENABLE)
        return refuse_pins(fault, ERR_CONFLICT, "out", i + 1, "proof", o->name,
                           "must be - of an output of kind enable");
    if (p->device == 0 || p->device > CONFIG_DEVICES ||
        config->pins.device[p->device - 1u].name[0] == '\0')
        return refuse_pins(fault, ERR_EMPTY, "out", i + 1, "proof_at", o->name,
                           "must say which channel shows that it acts, chan1 say");
    if (!(p->change > 0.0f))
        return refuse_pins(fault, ERR_RANGE, "out", i + 1, "proof_change", o->name,
                           "must be above 0: what is more than noise");
    if (p->on_s == 0 && p->off_s == 0)
        return refuse_pins(fault, ERR_EMPTY, "out", i + 1, "proof_on", o->name,
                           "and proof_off are both 0: one must say how long");
    if (p->kind == PROOF_KIND_WARMS && p->limit == 0)
        return refuse_pins(fault, ERR_RANGE, "out", i + 1, "proof_below", o->name,
                           "must say below which temperature nothing boils");
    return ERR_OK;
}

/* Refuses what this board lacks, also in a row without a name yet: whoever sets it shall hear at once what there is. */
static enum err check_lacking(const struct pins_config *pins, struct config_fault *fault)
{
    if (!CONFIG_LINK && pins->source == IO_SOURCE_BOTH)
        return refuse_pins(fault, ERR_UNSUPPORTED, "io", 0, "source", "",
                           "this board has no plant link: `board`, or `link` for no plant");
    for (unsigned i = 0; !DEVICE_ALL_KINDS && i < CONFIG_DEVICES; i++)
        if (pins->device[i].device != DEVICE_NONE && board_device_kind(&pins->device[i]) == NULL)
            return refuse_pins(fault, ERR_UNSUPPORTED, "chan", i + 1, "device", "",
                               DEVICE_KINDS_HERE);
    for (unsigned i = 0; !OUTPUT_ALL_KINDS && i < CONFIG_OUTPUTS; i++) {
        uint8_t type = pins->output[i].settings.type;
        if (type != OUTPUT_NONE && output_kind(type) == NULL)
            return refuse_pins(fault, ERR_UNSUPPORTED, "out", i + 1, "kind", "", OUTPUT_KINDS_HERE);
    }
    return ERR_OK;
}

enum err pins_check(const struct config *config, struct config_fault *fault)
{
    struct claims claims = {.n = 0};
    enum err err = check_lacking(&config->pins, fault);
    for (unsigned i = 0; err == ERR_OK && i < CONFIG_DEVICES; i++)
        if (config->pins.device[i].name[0] != '\0')
            err = check_device(config, i, &claims, fault);
    for (unsigned i = 0; err == ERR_OK && i < CONFIG_OUTPUTS; i++)
        if (config->pins.output[i].name[0] != '\0')
            err = check_output(config, i, &claims, fault);
    for (unsigned i = 0; err == ERR_OK && i < CONFIG_OUTPUTS; i++)
        if (config->pins.output[i].name[0] != '\0')
            err = check_proof(config, i, fault);
    return err;
}
