/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/pins/level.h"

#define INTERVAL_MS 50u
#define LOOK_MS     2u
#define STEADY      (LEVEL_STEADY_MS / LOOK_MS) /* looks that find the same */

/* Places in kept[]. */
enum { KEPT_STATE, KEPT_LAST, KEPT_ALIKE, KEPT_KNOWN };

static enum err level_open(struct device *d)
{
    if (d->settings.type > 1 || !hal_pin_is_free(d->settings.select))
        return ERR_RANGE;
    hal_pin_use(d->settings.select, HAL_PIN_INPUT_PULLED);
    return ERR_OK;
}

static uint16_t level_step(struct device *d, uint32_t now_ms)
{
    int32_t closed = hal_pin_read(d->settings.select) ? 0 : 1;
    if (closed != d->kept[KEPT_LAST])
        d->kept[KEPT_ALIKE] = 0;
    d->kept[KEPT_LAST] = closed;
    if (d->kept[KEPT_ALIKE] < (int32_t)STEADY)
        d->kept[KEPT_ALIKE]++;
    if (d->kept[KEPT_ALIKE] == (int32_t)STEADY) {
        d->kept[KEPT_STATE] = closed;
        d->kept[KEPT_KNOWN] = 1;
    }
    if (d->kept[KEPT_KNOWN] == 0 || now_ms - d->result.stamp_ms < d->interval_ms)
        return LOOK_MS;
    const int32_t code[DEVICE_CODES] = {d->kept[KEPT_STATE]};
    d->began_ms = now_ms;
    device_publish(d, code, 0);
    return LOOK_MS;
}

static bool level_value(const struct device_settings *s, const int32_t code[DEVICE_CODES],
                        float *value)
{
    *value = (code[0] != 0) == (s->type == 0) ? 1.0f : 0.0f;
    return true;
}

const struct device_kind level_kind = {.name = "level",
                                       .unit = "",
                                       .line = DEVICE_NO_LINE,
                                       .interval_ms = INTERVAL_MS,
                                       .open = level_open,
                                       .step = level_step,
                                       .value = level_value};
