/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "io/board_devices.h"

#include "devices/ads1115/ads1115.h"
#include "devices/bme280/bme280.h"
#include "devices/devices.h"
#include "devices/ds18b20/ds18b20.h"
#include "devices/max31856/max31856.h"
#include "devices/max31865/max31865.h"
#include "devices/pins/analog_input.h"
#include "devices/pins/flow.h"
#include "devices/pins/level.h"
#include "devices/voltage/divider.h"
#include "devices/xgzp6897/xgzp6897.h"

/* Words of chan.type in settings/parameter_table.c, in their order. */
enum sensor_word {
    SENSOR_NONE,
    SENSOR_2WIRE,
    SENSOR_3WIRE,
    SENSOR_4WIRE,
    SENSOR_B, /* and the other thermocouples */
    SENSOR_T = SENSOR_B + 7,
    SENSOR_4_20_MA,
    SENSOR_0_10_V,
    SENSOR_VOLT
};

#define RTD_WIRES     3u
#define RTD_NOMINAL   100.0f
#define RTD_REFERENCE 430.0f
#define SHUNT         100.0f
#define DIVIDER_UPPER 30000.0f
#define DIVIDER_LOWER 10000.0f
#define VOLTS_MOST    10.0f
#define FAILING_S     2.0f /* a transmitter that starts is below 4 mA for a moment */
#define RANGE_4_096_V 1u   /* of an ADS1115: 21 mA and more through 100 ohm are still measured */

const struct device_kind *board_device_kind(const struct device_config *row)
{
    static const struct device_kind *const kinds[DEVICE_WORDS] = {
        [DEVICE_MAX31865] = &max31865_kind,
        [DEVICE_DS18B20] = &ds18b20_kind,
        [DEVICE_LEVEL] = &level_kind,
        DEVICE_FURTHER([DEVICE_MAX31856] = &max31856_kind, [DEVICE_ADS1115] = &ads1115_kind,
                       [DEVICE_BME280] = &bme280_kind,
                       [DEVICE_BME280_TEMPERATURE] = &bme280_temperature_kind,
                       [DEVICE_XGZP6897] = &xgzp6897_kind, [DEVICE_ANALOG] = &analog_input_kind,
                       [DEVICE_FLOW] = &flow_kind, [DEVICE_PULSES] = &pulses_kind)};
    return row->device < DEVICE_WORDS ? kinds[row->device] : NULL;
}

static bool is_thermocouple(const struct device_config *row)
{
    return row->type >= SENSOR_B && row->type <= SENSOR_T;
}

bool board_device_takes_type(const struct device_config *row)
{
    if (row->device == DEVICE_MAX31856)
        return is_thermocouple(row);
    if (row->device == DEVICE_ADS1115 || row->device == DEVICE_ANALOG)
        return row->type == SENSOR_NONE || row->type >= SENSOR_4_20_MA;
    return row->type == SENSOR_NONE ||
           (row->device == DEVICE_MAX31865 && row->type <= SENSOR_4WIRE);
}

static void platinum(const struct device_config *row, struct device_settings *s)
{
    s->type = row->type >= SENSOR_2WIRE && row->type <= SENSOR_4WIRE
                  ? (uint8_t)(row->type - SENSOR_2WIRE + 2u)
                  : RTD_WIRES;
    if (s->nominal == 0.0f)
        s->nominal = RTD_NOMINAL;
    if (s->reference == 0.0f)
        s->reference = s->nominal * (RTD_REFERENCE / RTD_NOMINAL);
}

static float usual(float value, float otherwise)
{
    return value != 0.0f ? value : otherwise;
}

struct device_settings board_device_settings(const struct pins_config *pins,
                                             const struct device_config *row)
{
    struct device_settings s = {.input = (uint8_t)row->input,
                                .type = row->type,
                                .mains_60 = pins->mains_60 != 0,
                                .select = HAL_PIN_NONE,
                                .reference = row->reference,
                                .nominal = row->nominal};
    switch (pins_bus_family((enum bus_word)row->bus, &s.bus)) {
    case BUS_FAMILY_I2C:
        (void)!pins_parse_address(row->select, &s.address);
        break;
    case BUS_FAMILY_WIRE:
        (void)!pins_parse_rom(row->select, s.rom);
        break;
    default:
        (void)!pins_parse_pin(row->select, &s.select);
        break;
    }
    switch ((enum device_word)row->device) {
    case DEVICE_MAX31865:
        platinum(row, &s);
        break;
    case DEVICE_MAX31856:
        if (is_thermocouple(row))
            s.type = (uint8_t) "BEJKNRST"[row->type - SENSOR_B];
        break;
    case DEVICE_ADS1115:
        s.type = RANGE_4_096_V;
        break;
    case DEVICE_ANALOG:
        s.reference = 0.0f; /* the board knows its own */
        s.type = 0;
        break;
    default:
        s.type = 0;
        break;
    }
    return s;
}

bool board_device_value(const struct device_config *row, const struct device *d,
                        const struct device_result *result, float passed_s,
                        struct current_loop *loop, struct io_reading *reading)
{
    float value;
    *reading = (struct io_reading){.quality = QUALITY_BAD};
    if (!d->kind->value(&d->settings, result->code, &value))
        return false;
    reading->quality = QUALITY_GOOD;
    reading->value = value;
    if (!DEVICE_ALL_KINDS || (row->device != DEVICE_ADS1115 && row->device != DEVICE_ANALOG))
        return true;
    if (row->type == SENSOR_4_20_MA) {
        float milliampere = loop_current(value, usual(row->reference, SHUNT));
        reading->quality = loop_quality(loop, milliampere, passed_s, FAILING_S);
        reading->value = row->lo + (row->hi - row->lo) * loop_fraction(milliampere);
    } else if (row->type == SENSOR_0_10_V) {
        float volt = divider_source(value, usual(row->reference, DIVIDER_UPPER),
                                    usual(row->nominal, DIVIDER_LOWER));
        reading->value = row->lo + (row->hi - row->lo) * (volt / VOLTS_MOST);
    }
    return true;
}
