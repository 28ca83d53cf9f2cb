/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/pins/flow.h"

#include "hal/pulse.h"

#define INTERVAL_MS 100u

/* Places in kept[]. The count goes there bit by bit: both are 32 bits. */
enum { KEPT_COUNT, KEPT_TIME, KEPT_SUM, KEPT_BEGUN };

static enum err flow_open(struct device *d)
{
    if (!hal_pin_is_free(d->settings.select))
        return ERR_RANGE;
    enum err err = hal_pulse_open(d->settings.select);
    if (err == ERR_OK)
        hal_pulse_set_dead_time(d->settings.select, d->settings.type);
    return err;
}

static uint16_t flow_step(struct device *d, uint32_t now_ms)
{
    uint32_t count = hal_pulse_count(d->settings.select);
    uint32_t pulses = count - (uint32_t)d->kept[KEPT_COUNT];
    uint32_t passed_ms = now_ms - (uint32_t)d->kept[KEPT_TIME];
    bool first = d->kept[KEPT_BEGUN] == 0;
    d->kept[KEPT_BEGUN] = 1;
    d->kept[KEPT_COUNT] = (int32_t)count;
    d->kept[KEPT_TIME] = (int32_t)now_ms;
    if (first)
        return d->interval_ms;
    uint32_t sum = ((uint32_t)d->kept[KEPT_SUM] + pulses) & INT32_MAX;
    d->kept[KEPT_SUM] = (int32_t)sum;
    bool too_many = pulses > HAL_PULSE_HZ_MAX * passed_ms / 1000u + 1u;
    const int32_t code[DEVICE_CODES] = {too_many ? 0 : (int32_t)pulses, (int32_t)passed_ms,
                                        (int32_t)sum};
    d->began_ms = now_ms;
    device_publish(d, code, too_many ? DEVICE_RANGE : 0);
    return d->interval_ms;
}

static bool flow_value(const struct device_settings *s, const int32_t code[DEVICE_CODES],
                       float *value)
{
    (void)s;
    if (code[1] <= 0)
        return false;
    *value = (float)code[0] * 1000.0f / (float)code[1];
    return true;
}

static bool pulses_value(const struct device_settings *s, const int32_t code[DEVICE_CODES],
                         float *value)
{
    (void)s;
    *value = (float)((uint32_t)code[2] % PULSES_WRAP);
    return true;
}

const struct device_kind pulses_kind = {.name = "pulses",
                                        .unit = "-",
                                        .line = DEVICE_NO_LINE,
                                        .interval_ms = INTERVAL_MS,
                                        .open = flow_open,
                                        .step = flow_step,
                                        .value = pulses_value};

const struct device_kind flow_kind = {.name = "flow",
                                      .unit = "1/s",
                                      .line = DEVICE_NO_LINE,
                                      .interval_ms = INTERVAL_MS,
                                      .open = flow_open,
                                      .step = flow_step,
                                      .value = flow_value};
