/* Channels computed from others: values and qualities, against double precision (tests/reference/derived_reference.py).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "csv.h"
#include "derived_bench.h"

/* Rounding, of the sizes of what is added (derived.h). */
#define ROUNDING 0x1p-19

static struct derived_bench b;

void setUp(void) {}
void tearDown(void) {}

enum {
    FORM,
    LO,
    HI = LO + 3,
    WEIGHT = HI + 3,
    FRACTION = WEIGHT + 3,
    QUALITY = FRACTION + 3,
    ZERO = QUALITY + 3,
    BY,
    AT,
    POWER,
    LEAST,
    SLOPE,
    VALUE,
    VALUE_QUALITY,
    SIZE,
    COLUMNS
};

static void put_row(const double *row)
{
    struct derived_settings *s = &b.settings;
    derived_wire(&b, 3, 1);
    for (unsigned i = 0; i < 3; i++) {
        b.setup.input[i] = (struct block_signal){(float)row[LO + i], (float)row[HI + i], false};
        s->weight[0][i] = (float)row[WEIGHT + i];
        b.input[i] = N(row[FRACTION + i]);
        b.quality[i] = (uint8_t)row[QUALITY + i];
    }
    s->form[0] = (uint8_t)row[FORM];
    s->zero[0] = (float)row[ZERO];
    s->by[0] = (uint16_t)row[BY];
    s->reference[0] = (float)row[AT];
    s->power[0] = (uint16_t)row[POWER];
    s->least[0] = (uint16_t)row[LEAST];
    s->slope[0] = (float)row[SLOPE];
    /* A span that holds the value with room, so that it is not clipped in either format. */
    b.setup.point[0].lo = -(float)(2 * row[SIZE] + 1);
    b.setup.point[0].hi = (float)(2 * row[SIZE] + 1);
}

static void values_and_qualities_are_those_of_the_equations(void)
{
    FILE *f = csv_open("reference/derived_forms.csv");
    double row[COLUMNS], worst = 0;
    unsigned n = 0, usable = 0;
    while (csv_row(f, row, COLUMNS)) {
        char message[40];
        snprintf(message, sizeof message, "row %u, form %g", ++n, row[FORM]);
        put_row(row);
        derived_take(&b, false);
        derived_run(&b, 1);
        TEST_ASSERT_EQUAL_MESSAGE((int)row[VALUE_QUALITY], b.point_quality[0], message);
        if (!quality_usable((enum quality)row[VALUE_QUALITY]))
            continue;
        double error = fabs(derived_reads(&b, 0) - row[VALUE]);
        double bound = ROUNDING * row[SIZE] + derived_steps(&b, 0, 2);
        TEST_ASSERT_TRUE_MESSAGE(error <= bound, message);
        worst = fmax(worst, error / (row[SIZE] + derived_steps(&b, 0, 2)));
        usable++;
    }
    fclose(f);
    printf("%u rows, %u with a value: worst error 2^%.1f of the sizes\n", n, usable, log2(worst));
    TEST_ASSERT_EQUAL_UINT(360, n);
    TEST_ASSERT_GREATER_THAN(150, usable);
}

/* ---- boiling ---- */

/* A reading of 0 to 100 K, a pressure of 0 to 4e6 Pa. */
static void one_liquid(double at, double slope, double bend)
{
    derived_wire(&b, 2, 1);
    b.settings.form[0] = DERIVED_BOIL;
    b.settings.weight[0][0] = 1;
    b.settings.by[0] = 2;
    b.settings.reference[0] = (float)at;
    b.settings.slope[0] = (float)slope;
    b.settings.bend[0] = (float)bend;
    b.setup.input[1] = (struct block_signal){0, 4e6f, false};
    derived_take(&b, false);
}

/* The shift of a reading of 50 K at this pressure. */
static double shift_at(double pressure)
{
    derived_put(&b, 0, 50);
    derived_put(&b, 1, pressure);
    derived_run(&b, 1);
    return 50 - derived_reads(&b, 0);
}

/* 0.01 K within +-10 %, which is more than the weather does, and 0.05 K from two thirds to one and a half times the pressure. */
static void the_shift_is_that_of_the_bubble_point(void)
{
    enum { COLUMN, STAGE, REFERENCE, RISE, BEND, PRESSURE, SHIFT, BOIL_COLUMNS };
    FILE *f = csv_open("reference/derived_boil.csv");
    double row[BOIL_COLUMNS], near = 0, far = 0;
    unsigned n = 0;
    while (csv_row(f, row, BOIL_COLUMNS)) {
        char message[60];
        snprintf(message, sizeof message, "column %g stage %g at %g Pa", row[COLUMN], row[STAGE],
                 row[PRESSURE]);
        one_liquid(row[REFERENCE], row[RISE], row[BEND]);
        double error = fabs(shift_at(row[PRESSURE]) - row[SHIFT]);
        bool is_near = fabs(row[PRESSURE] / row[REFERENCE] - 1) < 0.11;
        TEST_ASSERT_TRUE_MESSAGE(error <= (is_near ? 0.01 : 0.05), message);
        TEST_ASSERT_EQUAL_MESSAGE(QUALITY_GOOD, b.point_quality[0], message);
        near = is_near ? fmax(near, error) : near;
        far = fmax(far, error);
        n++;
    }
    fclose(f);
    printf("%u shifts: worst error %.5f K within 10 %%, %.4f K from 2/3 to 3/2\n", n, near, far);
    TEST_ASSERT_EQUAL_UINT(110, n);
}

static void a_pressure_out_of_range_is_clamped_and_uncertain_and_none_is_bad(void)
{
    one_liquid(101325, 3.3e-4, 0.1);
    double most = shift_at(101325 * 1.52);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, b.point_quality[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, most, shift_at(101325 * 5.0));
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, b.point_quality[0]);
    (void)shift_at(-1000);
    TEST_ASSERT_EQUAL(QUALITY_BAD, b.point_quality[0]);
    b.quality[1] = QUALITY_MISSING;
    (void)shift_at(101325);
    TEST_ASSERT_EQUAL(QUALITY_MISSING, b.point_quality[0]);
}

/* ---- flooding ---- */

/* The pressure drop goes with the square of the boil-up: dp/(Q/Q0)^2 stays, and rises when the column floods. */
static void a_drop_over_the_square_of_the_boil_up_shows_flooding_at_any_load(void)
{
    derived_wire(&b, 3, 1);
    struct derived_settings *s = &b.settings;
    s->weight[0][0] = 1;
    s->weight[0][1] = -1;
    s->by[0] = 3;
    s->reference[0] = 50;
    s->power[0] = 2;
    derived_take(&b, false);
    for (double q = 20; q <= 80; q += 20) {
        derived_put(&b, 2, q);
        derived_put(&b, 0, 10 + 8 * q * q / 2500);
        derived_put(&b, 1, 10);
        derived_run(&b, 1);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 8, derived_reads(&b, 0));
        TEST_ASSERT_EQUAL(QUALITY_GOOD, b.point_quality[0]);
    }
    derived_put(&b, 0, 10 + 16 * 80.0 * 80 / 2500);
    derived_run(&b, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 16, derived_reads(&b, 0));
    derived_put(&b, 2, 1);
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, b.point_quality[0]);
}

static void a_guard_sees_a_rise_as_many_seconds_ahead_as_it_says(void)
{
    derived_wire(&b, 1, 1);
    b.settings.weight[0][0] = 1;
    b.settings.ahead_s[0] = 30;
    b.settings.lag_s[0] = 5;
    derived_take(&b, false);
    derived_put(&b, 0, 10);
    derived_run(&b, 10);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 10, derived_reads(&b, 0));
    for (unsigned t = 1; t <= 100; t++) {
        derived_put(&b, 0, 10 + 0.25 * t);
        derived_run(&b, 1);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 35 + 30 * 0.25, derived_reads(&b, 0));
}

static void a_rise_is_not_seen_where_readings_were_bad(void)
{
    derived_wire(&b, 1, 1);
    b.settings.weight[0][0] = 1;
    b.settings.ahead_s[0] = 30;
    derived_take(&b, false);
    derived_put(&b, 0, 10);
    derived_run(&b, 10);
    b.quality[0] = QUALITY_BAD;
    derived_run(&b, 1);
    TEST_ASSERT_EQUAL(QUALITY_BAD, b.point_quality[0]);
    derived_put(&b, 0, 30);
    b.quality[0] = QUALITY_GOOD;
    derived_run(&b, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 30, derived_reads(&b, 0));
}

/* The longest lag at the shortest tick: the increments are below one step of a float. */
static void a_slow_lag_does_not_stall(void)
{
    derived_wire(&b, 1, 1);
    b.setup.interval_s = 0.05f;
    b.step_ms = 50;
    b.settings.weight[0][0] = 1;
    b.settings.ahead_s[0] = 3600;
    b.settings.lag_s[0] = 36000;
    derived_take(&b, false);
    derived_put(&b, 0, 50);
    derived_run(&b, 1);
    derived_put(&b, 0, 50.01);
    double at_once = 0.01 * (1 + 3600.0 / 36000.0), later = 0.01 * (1 + 0.1 * exp(-1));
    derived_run(&b, 1);
    TEST_ASSERT_DOUBLE_WITHIN(derived_steps(&b, 0, 4), 50 + at_once, derived_reads(&b, 0));
    derived_run(&b, 720000);
    TEST_ASSERT_DOUBLE_WITHIN(derived_steps(&b, 0, 4), 50 + later, derived_reads(&b, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(values_and_qualities_are_those_of_the_equations);
    RUN_TEST(the_shift_is_that_of_the_bubble_point);
    RUN_TEST(a_pressure_out_of_range_is_clamped_and_uncertain_and_none_is_bad);
    RUN_TEST(a_drop_over_the_square_of_the_boil_up_shows_flooding_at_any_load);
    RUN_TEST(a_guard_sees_a_rise_as_many_seconds_ahead_as_it_says);
    RUN_TEST(a_rise_is_not_seen_where_readings_were_bad);
    RUN_TEST(a_slow_lag_does_not_stall);
    return UNITY_END();
}
