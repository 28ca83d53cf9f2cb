/* What the kind `derived` refuses, with the parameter that is wrong, and what it takes.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "derived_bench.h"

static struct derived_bench b;

void setUp(void)
{
    derived_wire(&b, 3, 1);
    b.settings.weight[0][0] = 1;
    b.settings.weight[0][1] = -1;
}
void tearDown(void) {}

static void expect_refused(const char *field)
{
    struct block_fault fault = {0};
    TEST_ASSERT_EQUAL(ERR_RANGE, derived_kind.check(&b.setup, &fault));
    TEST_ASSERT_EQUAL_STRING(field, fault.field);
    TEST_ASSERT_NOT_NULL(fault.wanted);
}

static void expect_taken(void)
{
    struct block_fault fault = {0};
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, derived_kind.check(&b.setup, &fault), fault.wanted);
}

static void a_difference_needs_no_more_than_its_weights(void)
{
    expect_taken();
}

static void a_block_without_inputs_or_points_is_refused(void)
{
    b.setup.inputs = 0;
    expect_refused("weight");
    b.setup.inputs = 3;
    b.setup.points = 0;
    expect_refused("points");
}

static void a_point_without_an_input_or_with_one_that_is_not_there_is_refused(void)
{
    b.settings.weight[0][3] = 1;
    expect_refused("weight");
    b.settings.weight[0][3] = 0;
    b.settings.weight[0][0] = b.settings.weight[0][1] = 0;
    expect_refused("weight");
    b.settings.weight[0][2] = 1e-6f;
    expect_taken();
    b.setup.points = 2;
    expect_refused("weight");
}

static void a_mean_needs_positive_weights_and_no_more_inputs_than_it_has(void)
{
    b.settings.form[0] = DERIVED_MEAN;
    expect_refused("weight");
    b.settings.weight[0][1] = 1;
    b.settings.least[0] = 2;
    expect_taken();
    b.settings.least[0] = 3;
    expect_refused("least");
}

static void only_sum_and_boil_have_a_second_input_and_it_must_be_there(void)
{
    b.settings.by[0] = 4;
    b.settings.reference[0] = 1;
    expect_refused("by");
    b.settings.by[0] = 3;
    expect_taken();
    b.settings.reference[0] = 0;
    expect_refused("at");
    b.settings.reference[0] = 1;
    static const uint8_t forms[] = {DERIVED_RATE, DERIVED_TOTAL};
    for (unsigned i = 0; i < sizeof forms; i++) {
        b.settings.form[0] = forms[i];
        expect_refused("by");
    }
}

static void a_counter_needs_a_rate_or_a_total_of_one_input(void)
{
    b.settings.wrap[0] = 65536;
    expect_refused("wrap");
    b.settings.form[0] = DERIVED_TOTAL;
    expect_refused("wrap");
    b.settings.weight[0][0] = 0;
    expect_taken();
}

static void looking_ahead_needs_a_sum_and_a_lag(void)
{
    b.settings.ahead_s[0] = 10;
    expect_taken();
    b.settings.lag_s[0] = 0;
    expect_refused("ahead");
    b.settings.lag_s[0] = 10;
    b.settings.form[0] = DERIVED_TOTAL;
    expect_refused("ahead");
}

static void boil_needs_a_pressure_and_its_reference(void)
{
    b.settings.form[0] = DERIVED_BOIL;
    expect_refused("by");
    b.settings.by[0] = 3;
    expect_refused("at");
    b.settings.reference[0] = 1013.25f;
    expect_taken();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_difference_needs_no_more_than_its_weights);
    RUN_TEST(a_block_without_inputs_or_points_is_refused);
    RUN_TEST(a_point_without_an_input_or_with_one_that_is_not_there_is_refused);
    RUN_TEST(a_mean_needs_positive_weights_and_no_more_inputs_than_it_has);
    RUN_TEST(only_sum_and_boil_have_a_second_input_and_it_must_be_there);
    RUN_TEST(a_counter_needs_a_rate_or_a_total_of_one_input);
    RUN_TEST(looking_ahead_needs_a_sum_and_a_lag);
    RUN_TEST(boil_needs_a_pressure_and_its_reference);
    return UNITY_END();
}
