/* Resistance to temperature: within 0.005 K of the equation of IEC 60751 from -40 to 250 degC (tests/reference/rtd_reference.py, in double),
 * 0.001 K all over, as the header says.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include <math.h>

#include "csv.h"
#include "devices/max31865/max31865.h"
#include "devices/max31865/rtd.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static bool temperature(double nominal, double reference, int32_t code, float *t)
{
    struct device_settings s = {.nominal = (float)nominal, .reference = (float)reference};
    return max31865_kind.value(&s, (const int32_t[DEVICE_CODES]){code}, t);
}

/* The equation itself, the way the standard writes it. */
static double ratio_at(double t)
{
    double r = 1 + 3.9083e-3 * t - 5.775e-7 * t * t;
    return t < 0 ? r - 4.183e-12 * (t - 100) * t * t * t : r;
}

static void codes_give_the_temperatures_of_the_reference(void)
{
    FILE *f = csv_open("reference/rtd.csv");
    double row[4], worst = 0, worst_wide = 0;
    int n = 0;
    while (csv_row(f, row, 4)) {
        float t;
        TEST_ASSERT_TRUE(temperature(row[0], row[1], (int32_t)row[2], &t));
        double error = fabs((double)t - row[3]);
        if (row[3] >= -40 && row[3] <= 250)
            worst = fmax(worst, error);
        worst_wide = fmax(worst_wide, error);
        n++;
    }
    fclose(f);
    printf("%d codes: worst error %.5f K from -40 to 250 degC, %.5f K from -200 to 850\n", n, worst,
           worst_wide);
    TEST_ASSERT_GREATER_THAN(1000, n);
    TEST_ASSERT_TRUE(worst < 0.005);
    TEST_ASSERT_TRUE(worst_wide < 0.001);
}

static void every_code_fulfils_the_equation(void)
{
    double worst = 0;
    for (int32_t code = 0; code < 32768; code++) {
        float t;
        if (!temperature(100, 400, code, &t) || t < -40 || t > 250)
            continue;
        worst = fmax(worst, fabs(ratio_at((double)t) - code / 8192.0) / 3.6e-3);
    }
    TEST_ASSERT_TRUE(worst < 0.005);
}

/* Table of tests for a PT100 with 400 ohm: the code that the temperature has. */
static void known_codes_are_within_one_code(void)
{
    static const struct {
        double t;
        int32_t code;
    } known[] = {{-40, 6903},  {0, 8192},    {25, 8989},  {78.3, 10670},
                 {100, 11346}, {120, 11966}, {250, 15901}};
    for (unsigned k = 0; k < sizeof known / sizeof known[0]; k++) {
        float below, above;
        TEST_ASSERT_TRUE(temperature(100, 400, known[k].code - 1, &below));
        TEST_ASSERT_TRUE(temperature(100, 400, known[k].code + 1, &above));
        TEST_ASSERT_TRUE((double)below <= known[k].t && known[k].t <= (double)above);
    }
}

static void temperature_rises_with_each_code(void)
{
    float before = -1000, t;
    for (int32_t code = 0; code < 32768; code++)
        if (temperature(100, 400, code, &t)) {
            TEST_ASSERT_TRUE(t > before);
            before = t;
        }
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 850, before);
}

static void ratios_beyond_the_equation_are_no_temperature(void)
{
    float t = 7;
    TEST_ASSERT_FALSE(rtd_temperature(0.185f, &t));
    TEST_ASSERT_FALSE(rtd_temperature(3.905f, &t));
    TEST_ASSERT_FALSE(rtd_temperature(NAN, &t));
    TEST_ASSERT_EQUAL_FLOAT(7, t);
    TEST_ASSERT_TRUE(rtd_temperature(RTD_RATIO_LO, &t));
    TEST_ASSERT_FLOAT_WITHIN(0.02f, RTD_LO, t);
    TEST_ASSERT_TRUE(rtd_temperature(RTD_RATIO_HI, &t));
    TEST_ASSERT_FLOAT_WITHIN(0.02f, RTD_HI, t);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(codes_give_the_temperatures_of_the_reference);
    RUN_TEST(every_code_fulfils_the_equation);
    RUN_TEST(known_codes_are_within_one_code);
    RUN_TEST(temperature_rises_with_each_code);
    RUN_TEST(ratios_beyond_the_equation_are_no_temperature);
    return UNITY_END();
}
