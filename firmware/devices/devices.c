/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/devices.h"

#include <stddef.h>
#include <string.h>

#include "devices/ads1115/ads1115.h"
#include "devices/bme280/bme280.h"
#include "devices/ds18b20/ds18b20.h"
#include "devices/max31856/max31856.h"
#include "devices/max31865/max31865.h"
#include "devices/pins/analog_input.h"
#include "devices/pins/flow.h"
#include "devices/pins/level.h"
#include "devices/xgzp6897/xgzp6897.h"

/* clang-format off */
static const struct device_kind *const kinds_by_name[DEVICE_KINDS] = {
    DEVICE_FURTHER(&ads1115_kind, &analog_input_kind, &bme280_kind, &bme280_temperature_kind,)
    &ds18b20_kind,
    DEVICE_FURTHER(&flow_kind,)
    &level_kind,
    DEVICE_FURTHER(&max31856_kind,)
    &max31865_kind,
    DEVICE_FURTHER(&pulses_kind, &xgzp6897_kind)
};
/* clang-format on */

/* In the order of the bits of enum device_fault. */
static const char *const fault_texts[] = {"no chip answers",
                                          "another chip, or it does not take its settings",
                                          "checksum wrong, or two reads differ",
                                          "sensor or wire open",
                                          "sensor shorted",
                                          "voltage outside the supply, or a wire at a rail",
                                          "out of range",
                                          "cold junction out of range",
                                          "chip has lost power",
                                          "bus failed"};

const struct device_kind *device_kind_at(unsigned place)
{
    return place < DEVICE_KINDS ? kinds_by_name[place] : NULL;
}

const struct device_kind *device_kind_find(const char *name)
{
    for (unsigned k = 0; k < DEVICE_KINDS; k++)
        if (strcmp(kinds_by_name[k]->name, name) == 0)
            return kinds_by_name[k];
    return NULL;
}

const char *device_fault_text(uint16_t faults)
{
    for (unsigned k = 0; k < sizeof fault_texts / sizeof fault_texts[0]; k++)
        if ((faults & 1u << k) != 0)
            return fault_texts[k];
    return "";
}
