/* A column some of whose temperatures are interpolated (model/column_implicit.h, Frau chapter 6). Built twice. */
#include "dense_step.h"

#ifdef REFLUX_REAL_DOUBLE
#define ROUNDING       1e-9
#define SLOPE_ROUNDING 1e-5
#else
#define ROUNDING       2e-4
#define SLOPE_ROUNDING 1e-3
#endif

void setUp(void)
{
    make_column(3, 0.8, COLUMN_HOLDUP_VOLUMETRIC);
}

void tearDown(void) {}

static void region(size_t first, size_t last)
{
    for (size_t s = first; s <= last; s++)
        truncated[s] = true;
}

static void evaluate(enum column_between between)
{
    TEST_ASSERT_EQUAL(ERR_OK, column_truncated_rates(&column, truncated, between, x, rates));
}

static double own_temperature(size_t s)
{
    double at[N_MOST];
    for (size_t i = 0; i < states(); i++)
        at[i] = (double)x[i];
    return own_bubble_point(at, s);
}

static void temperature_is(double wanted, size_t s)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e6 * ROUNDING * 1e-5, wanted, (double)column.temperature[s]);
}

/* ---- temperatures ---- */

static void without_truncated_stages_it_is_the_column_itself(void)
{
    for (int form = COLUMN_HOLDUP_MOLAR; form <= COLUMN_HOLDUP_CONSERVATIVE; form++) {
        real_t kept[N_MOST], whole[N_MOST];
        make_column(3, 0.8, (enum column_holdup)form);
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, x, whole));
        memcpy(kept, x, sizeof kept);
        evaluate(COLUMN_BETWEEN_LINE);
        for (size_t i = 0; i < states(); i++) {
            TEST_ASSERT_TRUE(kept[i] == x[i]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-4 * ROUNDING + fabs((double)whole[i]) * ROUNDING,
                                      (double)whole[i], (double)rates[i]);
        }
    }
}

/* Regions in the middle, right above the reboiler, right below the condenser, and both at once. */
static void on_a_line_temperatures_go_from_end_to_end_of_a_region(void)
{
    static const size_t first[] = {5, 1, 6, 1}, last[] = {7, 2, 8, 1};
    for (unsigned k = 0; k < 4; k++) {
        setUp();
        region(first[k], last[k]);
        if (k == 3)
            region(4, 8);
        evaluate(COLUMN_BETWEEN_LINE);
        size_t low = first[k] - 1, high = last[k] + 1;
        double from = own_temperature(low), to = own_temperature(high);
        for (size_t s = low; s <= high; s++)
            temperature_is(from + (to - from) * (double)(s - low) / (double)(high - low), s);
        if (k == 3)
            temperature_is(own_temperature(3) + (own_temperature(9) - own_temperature(3)) / 3, 5);
    }
}

static void their_mean_is_that_of_the_ends_on_all_stages_of_a_region(void)
{
    region(1, 2);
    region(5, 8);
    evaluate(COLUMN_BETWEEN_MEAN);
    for (size_t s = 0; s < STAGES; s++) {
        size_t low = s < 3 ? 0 : 4, high = s < 3 ? 3 : 9;
        temperature_is(truncated[s] ? (own_temperature(low) + own_temperature(high)) / 2
                                    : own_temperature(s),
                       s);
    }
}

static void vapour_pressures_are_those_of_the_temperature_at_the_stage_s_own_pressure(void)
{
    for (int between = COLUMN_BETWEEN_LINE; between <= COLUMN_BETWEEN_MEAN; between++) {
        setUp();
        region(1, 2);
        region(5, 8);
        evaluate((enum column_between)between);
        for (size_t s = 0; s < STAGES; s++)
            for (size_t j = 0; j < 3; j++) {
                double slope, p = (double)column.pressure[s];
                double k = own_pressure(j, (double)column.temperature[s], &slope) / p;
                TEST_ASSERT_DOUBLE_WITHIN(ROUNDING * k, k, (double)column.k[3 * s + j]);
                TEST_ASSERT_DOUBLE_WITHIN(SLOPE_ROUNDING * slope / p, slope / p,
                                          (double)column.dk[3 * s + j]);
            }
    }
}

/* ---- the fraction that follows ---- */

/* (6.4): with it the liquid boils at the temperature that is given. */
static void the_last_but_one_fraction_follows_from_the_bubble_point(void)
{
    for (size_t c = 2; c <= MOST; c++) {
        real_t kept[N_MOST];
        make_column(c, 0.8, COLUMN_HOLDUP_MOLAR);
        region(5, 7);
        for (size_t s = 5; s <= 7; s++)
            x[s * (c - 1) + c - 2] = REAL_C(0.5); /* whatever it was */
        memcpy(kept, x, sizeof kept);
        evaluate(COLUMN_BETWEEN_LINE);
        for (size_t s = 0; s < STAGES; s++) {
            temperature_is(own_temperature(s), s);
            for (size_t j = 0; j + 1 < c; j++)
                if (!truncated[s] || j + 2 < c)
                    TEST_ASSERT_TRUE(kept[s * (c - 1) + j] == x[s * (c - 1) + j]);
        }
    }
}

static void it_stays_within_what_the_others_leave(void)
{
    region(5, 7);
    x[10] = REAL_C(0.95); /* boils below the temperature that is given, whatever follows */
    x[12] = REAL_C(0.0);
    x[14] = REAL_C(0.0);
    evaluate(COLUMN_BETWEEN_LINE);
    TEST_ASSERT_TRUE(x[11] == REAL_C(0.0));
    make_column(3, 0.8, COLUMN_HOLDUP_VOLUMETRIC);
    region(8, 8);
    x[16] = REAL_C(0.0); /* would have to be lighter than the second component */
    for (size_t s = 7; s <= 9; s += 2) {
        x[2 * s] = REAL_C(0.98);
        x[2 * s + 1] = REAL_C(0.01);
    }
    evaluate(COLUMN_BETWEEN_LINE);
    TEST_ASSERT_TRUE(x[17] == REAL_C(1.0));
    x[16] = REAL_C(0.25);
    evaluate(COLUMN_BETWEEN_LINE);
    TEST_ASSERT_TRUE(x[17] == REAL_C(0.75));
}

/* ---- vapours and holdups ---- */

static void a_vapour_remembers_those_below_and_is_whole(void)
{
    region(1, 2);
    region(5, 8);
    x[10] = REAL_C(0.95); /* where the fraction is kept within its limits too */
    evaluate(COLUMN_BETWEEN_LINE);
    for (size_t s = 0; s < STAGES; s++) {
        double y[3], total = 0, sum = 0;
        for (size_t j = 0; j < 3; j++) {
            y[j] = (double)(column_fraction(&column, x, s, j) * column.k[3 * s + j]);
            total += y[j];
            sum += (double)column.vapour[3 * s + j];
        }
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING, 1, sum);
        for (size_t j = 0; j < 3; j++) {
            double wanted = y[j] / total;
            if (s > 0 && s < TOP) /* of the drum the bubble */
                wanted = 0.8 * wanted + 0.2 * (double)column.vapour[3 * s - 3 + j];
            TEST_ASSERT_DOUBLE_WITHIN(ROUNDING, wanted, (double)column.vapour[3 * s + j]);
        }
    }
}

static void a_volume_holds_what_the_liquid_that_follows_takes(void)
{
    region(5, 8);
    evaluate(COLUMN_BETWEEN_LINE);
    for (size_t s = 0; s < STAGES; s++) {
        double volume = 0, nominal = s == 0 ? 1e-3 : s == TOP ? 1.5e-4 : 3e-5;
        for (size_t j = 0; j < 3; j++)
            volume += (double)(column_fraction(&column, x, s, j) * column.molar_volume[3 * s + j]);
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING * nominal / volume, nominal / volume,
                                  (double)column.holdup[s]);
    }
}

static void rates_are_the_balances_at_these_vapours(void)
{
    double at[N_MOST], own[N_MOST], most = 0;
    make_column(3, 0.8, COLUMN_HOLDUP_MOLAR);
    region(5, 8);
    evaluate(COLUMN_BETWEEN_LINE);
    for (size_t i = 0; i < states(); i++)
        at[i] = (double)x[i];
    own_rates(at, own);
    for (size_t i = 0; i < states(); i++)
        most = fmax(most, fabs(own[i]));
    for (size_t i = 0; i < states(); i++)
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING * most, own[i], (double)rates[i]);
}

static void the_efficiency_of_the_feed_is_that_of_all_trays_again_after_a_flash(void)
{
    struct column_inputs liquid = column.inputs, vapour = liquid;
    vapour.feed_basis = COLUMN_FLOW_MOLAR;
    vapour.feed_flow = REAL_C(0.015);
    vapour.feed_state = COLUMN_FEED_QUALITY;
    vapour.feed_quality = 0;
    vapour.boilup_given = true;
    vapour.boilup = REAL_C(1e-3);
    vapour.reflux_flow = REAL_C(3e-7);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, column_set_inputs(&column, &vapour, &fault), fault.field);
    evaluate(COLUMN_BETWEEN_LINE);
    TEST_ASSERT_TRUE(column.feed_efficiency > config.efficiency);
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &liquid, &fault));
    evaluate(COLUMN_BETWEEN_LINE);
    TEST_ASSERT_TRUE(column.feed_efficiency == config.efficiency);
}

/* ---- errors ---- */

static void a_state_that_is_no_number_is_an_error_wherever_it_is(void)
{
    region(5, 8);
    for (size_t i = 0; i < states(); i++) {
        real_t kept = x[i];
        x[i] = (real_t)(i % 2 ? NAN : -INFINITY);
        TEST_ASSERT_EQUAL(ERR_NOT_FINITE, column_truncated_rates(&column, truncated,
                                                                 COLUMN_BETWEEN_LINE, x, rates));
        TEST_ASSERT_FALSE(column.warm);
        x[i] = kept;
    }
}

static void where_there_is_no_bubble_point_it_is_an_error_and_the_next_is_good_again(void)
{
    struct column_inputs inputs = column.inputs, high = inputs;
    high.pressure_top = REAL_C(9e6);
    evaluate(COLUMN_BETWEEN_LINE);
    real_t kept = column.temperature[4];
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &high, &fault));
    TEST_ASSERT_EQUAL(ERR_RANGE,
                      column_truncated_rates(&column, truncated, COLUMN_BETWEEN_LINE, x, rates));
    TEST_ASSERT_FALSE(column.warm);
    TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &inputs, &fault));
    evaluate(COLUMN_BETWEEN_LINE);
    temperature_is((double)kept, 4);
}

/* An earlier answer is only the start of a search. */
static void it_is_the_same_again_from_what_it_left(void)
{
    real_t first[N_MOST];
    region(5, 7);
    evaluate(COLUMN_BETWEEN_LINE);
    memcpy(first, rates, sizeof first);
    TEST_ASSERT_TRUE(column.warm);
    for (int n = 0; n < 5; n++)
        evaluate(COLUMN_BETWEEN_LINE);
    for (size_t i = 0; i < states(); i++)
        TEST_ASSERT_DOUBLE_WITHIN(ROUNDING, (double)first[i], (double)rates[i]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_truncated_stages_it_is_the_column_itself);
    RUN_TEST(on_a_line_temperatures_go_from_end_to_end_of_a_region);
    RUN_TEST(their_mean_is_that_of_the_ends_on_all_stages_of_a_region);
    RUN_TEST(vapour_pressures_are_those_of_the_temperature_at_the_stage_s_own_pressure);
    RUN_TEST(the_last_but_one_fraction_follows_from_the_bubble_point);
    RUN_TEST(it_stays_within_what_the_others_leave);
    RUN_TEST(a_vapour_remembers_those_below_and_is_whole);
    RUN_TEST(a_volume_holds_what_the_liquid_that_follows_takes);
    RUN_TEST(rates_are_the_balances_at_these_vapours);
    RUN_TEST(the_efficiency_of_the_feed_is_that_of_all_trays_again_after_a_flash);
    RUN_TEST(a_state_that_is_no_number_is_an_error_wherever_it_is);
    RUN_TEST(where_there_is_no_bubble_point_it_is_an_error_and_the_next_is_good_again);
    RUN_TEST(it_is_the_same_again_from_what_it_left);
    return UNITY_END();
}
