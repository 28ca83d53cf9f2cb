/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/voltage/current_loop.h"

float loop_current(float volt, float shunt)
{
    return 1000.0f * volt / shunt;
}

float loop_fraction(float milliampere)
{
    return (milliampere - 4.0f) / 16.0f;
}

enum quality loop_quality(struct current_loop *c, float milliampere, float passed_s, float delay_s)
{
    if (!float_is_finite(milliampere))
        return QUALITY_BAD;
    if (milliampere > LOOP_FAILURE_LO && milliampere < LOOP_FAILURE_HI) {
        c->failing_s = 0.0f;
        return milliampere >= LOOP_GOOD_LO && milliampere <= LOOP_GOOD_HI ? QUALITY_GOOD
                                                                          : QUALITY_UNCERTAIN;
    }
    if (c->failing_s >= delay_s)
        return QUALITY_BAD;
    c->failing_s += passed_s;
    return c->failing_s >= delay_s ? QUALITY_BAD : QUALITY_UNCERTAIN;
}
