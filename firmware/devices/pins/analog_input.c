/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/pins/analog_input.h"

#include "hal/analog.h"

#define INTERVAL_MS    20u
#define CONVERSIONS_MS 40u /* the first mean is there by then */

static enum err analog_input_open(struct device *d)
{
    if (!hal_pin_is_free(d->settings.select))
        return ERR_RANGE;
    return hal_analog_open(d->settings.select);
}

static uint16_t analog_input_step(struct device *d, uint32_t now_ms)
{
    int32_t code[DEVICE_CODES] = {0};
    uint16_t mean = 0, faults = 0;
    d->began_ms = now_ms;
    if (!hal_analog_read(d->settings.select, &mean)) {
        if (++d->tries < CONVERSIONS_MS)
            return 1;
        faults = DEVICE_BUS;
    } else if (mean == HAL_ANALOG_FULL) {
        faults = DEVICE_RANGE;
    }
    code[0] = mean;
    return device_finish(d, now_ms, code, faults);
}

static bool analog_input_value(const struct device_settings *s, const int32_t code[DEVICE_CODES],
                               float *value)
{
    float reference = hal_analog_reference();
    if (!(reference > 0.0f))
        reference = s->reference;
    if (!(reference > 0.0f))
        return false;
    *value = (float)code[0] * reference / (float)HAL_ANALOG_FULL;
    return true;
}

const struct device_kind analog_input_kind = {.name = "analog",
                                              .unit = "V",
                                              .line = DEVICE_NO_LINE,
                                              .interval_ms = INTERVAL_MS,
                                              .open = analog_input_open,
                                              .step = analog_input_step,
                                              .value = analog_input_value};
