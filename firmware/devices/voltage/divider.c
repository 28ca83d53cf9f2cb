/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/voltage/divider.h"

#include "base/channel.h"
#include "devices/device.h"

#define LEAST_PART 0.01f

float divider_source(float volt, float upper, float lower)
{
    return volt * (upper + lower) / lower;
}

uint16_t divider_sensor(float volt, float supply, float fixed, bool grounded, float *resistance)
{
    if (!float_is_finite(volt) || !(supply > 0.0f))
        return DEVICE_RANGE;
    float part = grounded ? volt / supply : 1.0f - volt / supply; /* of the supply, at the sensor */
    if (part < LEAST_PART)
        return DEVICE_SHORT;
    if (part > 1.0f - LEAST_PART)
        return DEVICE_OPEN;
    *resistance = fixed * part / (1.0f - part);
    return 0;
}
