/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/voltage/thermistor.h"

#include "num/real_math.h"

#define ZERO_CELSIUS 273.15f
#define T_25         298.15f
#define T_LO         (-55.0f)
#define T_HI         200.0f

bool thermistor_temperature(float resistance, float at_25, float beta, float *temperature)
{
    if (!(resistance > 0.0f) || !(at_25 > 0.0f) || !(beta > 0.0f))
        return false;
    float t = 1.0f / (1.0f / T_25 + float_log(resistance / at_25) / beta) - ZERO_CELSIUS;
    if (!(t >= T_LO && t <= T_HI))
        return false;
    *temperature = t;
    return true;
}
