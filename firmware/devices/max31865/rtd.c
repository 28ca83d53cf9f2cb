/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/max31865/rtd.h"

#include "num/real.h"

#define CVD_A 3.9083e-3f
#define CVD_B (-5.775e-7f)
#define CVD_C (-4.183e-12f)

/* Newton's method starts 2.4 K off at -200 degC. After one step this is 0.003 K, after two the rest is rounding. */
#define NEWTON_STEPS 2

bool rtd_temperature(float ratio, float *temperature)
{
    if (!(ratio >= RTD_RATIO_LO && ratio <= RTD_RATIO_HI))
        return false;
    float x = ratio - 1.0f;
    /* The root of the quadratic equation, in the form that subtracts no equal numbers near 0 degC. */
    float t = 2.0f * x / (CVD_A + sqrtf(CVD_A * CVD_A + 4.0f * CVD_B * x));
    if (x < 0.0f)
        for (int k = 0; k < NEWTON_STEPS; k++) {
            float cubic = CVD_C * t * t;
            float error = t * (CVD_A + t * CVD_B + cubic * (t - 100.0f)) - x;
            float slope = CVD_A + 2.0f * CVD_B * t + cubic * (4.0f * t - 300.0f);
            t -= error / slope;
        }
    *temperature = t;
    return true;
}
