/* Right shifts of negative numbers round down here, as they do in the data sheet and with every compiler that builds this. A calibration that is
 * none could overflow 64 bits; the bounds below are far outside of what a sound one gives.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "devices/bme280/compensation.h"

/* Words of the calibration; all but T1 and P1 have a sign. */
enum { T1, T2, T3, P1, P2, P3, P4, P5, P6, P7, P8, P9 };

#define BIT(n)         (INT64_C(1) << (n))
#define NUMERATOR_MOST (INT64_MAX / 3125)
#define QUOTIENT_MOST  BIT(36)

static int64_t calibration_word(const uint8_t *calibration, unsigned word)
{
    const uint8_t *from = &calibration[(uint8_t)(2u * word)];
    int32_t w = from[0] | from[1] << 8;
    return word == T1 || word == P1 ? w : (int16_t)w;
}

/* Returns the temperature in 1/5120 degC, which the pressure needs too. */
static int64_t fine_temperature(const uint8_t *c, int32_t raw)
{
    int64_t t1 = calibration_word(c, T1);
    int64_t linear = (((raw >> 3) - 2 * t1) * calibration_word(c, T2)) >> 11;
    int64_t offset = (raw >> 4) - t1;
    int64_t square = (((offset * offset) >> 12) * calibration_word(c, T3)) >> 14;
    return linear + square;
}

bool bme280_compensate(const uint8_t calibration[BME280_CALIBRATION], int32_t raw_temperature,
                       int32_t raw_pressure, int32_t *temperature, int32_t *pressure)
{
    const uint8_t *c = calibration;
    int64_t fine = fine_temperature(c, raw_temperature);
    int64_t t = fine - 128000; /* less than 2^24, so its square times a word stays below 2^63 */
    int64_t offset = t * t * calibration_word(c, P6) + t * calibration_word(c, P5) * BIT(17) +
                     calibration_word(c, P4) * BIT(35);
    int64_t factor =
        BIT(47) + ((t * t * calibration_word(c, P3)) >> 8) + t * calibration_word(c, P2) * BIT(12);
    if (factor <= 0 || (factor >> 16) * calibration_word(c, P1) >= BIT(47) - BIT(16))
        return false;
    int64_t slope = (factor * calibration_word(c, P1)) >> 33;
    int64_t p = (1048576 - raw_pressure) * BIT(31) - offset;
    if (slope == 0 || p < -NUMERATOR_MOST || p > NUMERATOR_MOST)
        return false;
    p = p * 3125 / slope;
    if (p < 0 || p > QUOTIENT_MOST)
        return false;
    int64_t square = (calibration_word(c, P9) * (p >> 13) * (p >> 13)) >> 25;
    int64_t linear = (calibration_word(c, P8) * p) >> 19;
    p = ((p + square + linear) >> 8) + calibration_word(c, P7) * 16;
    if (p < 0 || p > INT32_MAX)
        return false;
    *temperature = (int32_t)((fine * 5 + 128) >> 8);
    *pressure = (int32_t)p;
    return true;
}
