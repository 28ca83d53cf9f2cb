/* The pilot column against its committed, independent reference and against Folami's figures. */
#include "csv.h"
#include "plant_bench.h"
#include "unity.h"

#include <math.h>
#include <string.h>

static double tray(int k) /* 11: reboiler */
{
    char name[8];
    if (k == 11)
        return get("TB");
    snprintf(name, sizeof name, "T%d", k);
    return get(name);
}

void setUp(void)
{
    bench_open("pilot");
}

void tearDown(void)
{
    bench_close();
}

static const char *const inputs[4] = {"Lr", "Qrb", "F", "xF"};

static void the_nominal_profile_is_that_of_the_reference(void)
{
    double row[15];
    FILE *f = csv_open("reference/pilot_steady.csv");
    TEST_ASSERT_TRUE(csv_row(f, row, 15));
    fclose(f);
    for (int k = 1; k <= 11; k++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, row[k - 1], tray(k));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, row[11], get("xD"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, row[12], get("xB"));
}

static double gain(const char *input, int k, double h)
{
    double nominal = get(input), hi, lo;
    set(input, nominal + h);
    settle();
    hi = tray(k);
    set(input, nominal - h);
    settle();
    lo = tray(k);
    set(input, nominal);
    settle();
    return (hi - lo) / (2 * h);
}

static void steady_state_gains_of_every_tray_are_those_of_the_reference(void)
{
    static const double h[4] = {0.002, 0.0002, 0.002, 0.01};
    double row[12];
    FILE *f = csv_open("reference/pilot_gains.csv");
    int rows = 0;
    while (csv_row(f, row, 12)) {
        int i = (int)row[0];
        for (int k = 1; k <= 11; k++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-3 * fabs(row[k]), row[k], gain(inputs[i], k, h[i]));
        rows++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL(4, rows);
}

/* Aim: 0.01 K. Reached: see the bound. */
static void step_responses_of_every_tray_are_those_of_the_reference(void)
{
    double row[14], worst = 0, now = 0;
    FILE *f = csv_open("reference/pilot_steps.csv");
    int rows = 0;
    while (csv_row(f, row, 14)) {
        if (row[2] < now || rows == 0) { /* next step: start afresh */
            bench_close();
            bench_open("pilot");
            set(inputs[(int)row[0]], get(inputs[(int)row[0]]) + row[1]);
            now = 0;
        }
        while (now < row[2]) { /* tick by tick, as the bench does */
            now += 30;
            run_to(now);
        }
        for (int k = 1; k <= 11; k++)
            worst = fmax(worst, fabs(tray(k) - row[2 + k]));
        rows++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL(64, rows);
    printf("worst deviation of a step response: %.2g K\n", worst);
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0, worst);
}

static void a_day_of_changes_runs_as_that_of_the_reference(void)
{
    double row[16], worst = 0, now = 0;
    FILE *f = csv_open("reference/pilot_day.csv");
    int rows = 0;
    for (; csv_row(f, row, 16); rows++) {
        for (int i = 0; i < 4; i++)
            set(inputs[i], row[1 + i]);
        for (; now < row[0]; now += 30)
            run_to(now + 30);
        for (int k = 1; k <= 11; k++)
            worst = fmax(worst, fabs(tray(k) - row[4 + k]));
    }
    fclose(f);
    TEST_ASSERT_EQUAL(24, rows);
    TEST_ASSERT_TRUE(now == 86400);
    printf("worst deviation in a day: %.2g K\n", worst);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, worst);
}

static void gains_are_within_a_factor_of_one_and_a_half_of_folamis(void)
{
    double g[2][2] = {{gain("Lr", 1, 0.002), gain("Qrb", 1, 0.0002)},
                      {gain("Lr", 10, 0.002), gain("Qrb", 10, 0.0002)}};
    static const double folami[2][2] = {{-0.5, 3.56}, {-9.53, 80.77}};
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            double ratio = g[i][j] / folami[i][j];
            TEST_ASSERT_TRUE(ratio > 1 / 1.5 && ratio < 1.5);
        }
    double rga = 1 / (1 - g[0][1] * g[1][0] / (g[0][0] * g[1][1]));
    printf("gains %.3f %.3f %.3f %.3f, RGA11 %.2f\n", g[0][0], g[0][1], g[1][0], g[1][1], rga);
    TEST_ASSERT_TRUE(rga > 3 && rga < 12);
}

static void the_operating_point_lies_in_folamis_ranges(void)
{
    TEST_ASSERT_TRUE(get("Qrb") >= 0.7 && get("Qrb") <= 1.25);
    TEST_ASSERT_TRUE(get("xF") >= 30 && get("xF") <= 50);
    TEST_ASSERT_TRUE(kind->tick_s == 30);
}

static void the_slow_time_constant_is_between_ten_and_forty_minutes(void)
{
    double start = get("T10"), t[3];
    set("Qrb", 0.801);
    settle();
    double end = get("T10");
    set("Qrb", 0.8);
    settle();
    set("Qrb", 0.801);
    for (int i = 0; i < 3; i++) { /* the slope of ln(rest) late in the response */
        run_to(1800.0 * (i + 1));
        t[i] = log((end - get("T10")) / (end - start));
    }
    double minutes = 1800.0 / (t[1] - t[2]) / 60;
    printf("slow time constant %.1f min\n", minutes);
    TEST_ASSERT_TRUE(minutes > 10 && minutes < 40);
}

static void signs_of_the_gains_are_physical(void)
{
    TEST_ASSERT_TRUE(gain("F", 10, 0.01) < 0);  /* more cold feed */
    TEST_ASSERT_TRUE(gain("xF", 10, 0.05) < 0); /* lighter feed */
    TEST_ASSERT_TRUE(gain("TF", 10, 0.5) > 0);  /* less vapour condensed */
    TEST_ASSERT_TRUE(gain("P", 1, 0.5) > 0);    /* bubble points rise */
    TEST_ASSERT_TRUE(gain("Qloss", 10, 0.001) < 0);
}

static void sane(void)
{
    for (size_t i = 0; i < kind->n_channels; i++) {
        const struct plant_channel *c = &kind->channels[i];
        double v = kind->value(plant, i);
        char text[80];
        snprintf(text, sizeof text, "%s = %.17g", c->name, v);
        TEST_ASSERT_TRUE_MESSAGE(isfinite(v) && v >= c->lo && v <= c->hi * (1 + 1e-12), text);
    }
}

/* Small linear congruential generator: the same inputs in every run. */
static double uniform(unsigned *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) / 16777216.0;
}

static void brutal_inputs_keep_every_channel_inside_its_span(void)
{
    unsigned seed = 7;
    for (int k = 1; k <= 4000; k++) {
        for (size_t i = 0; i < kind->n_channels; i++) {
            const struct plant_channel *c = &kind->channels[i];
            if (c->kind != PLANT_MV && c->kind != PLANT_DISTURBANCE)
                continue;
            double u = uniform(&seed);
            if (u < 0.15)
                set(c->name, c->lo);
            else if (u < 0.3)
                set(c->name, c->hi);
            else if (u < 0.6)
                set(c->name, c->lo + uniform(&seed) * (c->hi - c->lo));
        }
        run_to(30.0 * k);
        sane();
    }
}

static void with_the_heater_off_nothing_boils_and_the_feed_runs_through(void)
{
    set("Qrb", 0);
    run_to(30);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, get("D"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, get("V"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, get("Lr_eff"));
    run_to(36000);
    sane();
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 36, get("xB"));
    settle();
    sane();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 36, get("xB"));
}

static void after_a_heater_trip_the_column_comes_back_to_its_operating_point(void)
{
    double before = get("T10");
    set("Qrb", 0);
    run_to(1800);
    set("Qrb", 0.8);
    for (int k = 0; k < 1000; k++)
        run_to(1800 + 30.0 * (k + 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-2, before, get("T10"));
}

static void reflux_beyond_the_vapour_gives_total_reflux_and_no_distillate(void)
{
    set("Lr", 12);
    run_to(600);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, get("D"));
    TEST_ASSERT_TRUE(get("Lr_eff") < 12 && get("Lr_eff") > 4);
    sane();
}

static void heat_beyond_the_liquid_supply_gives_no_bottoms_and_is_not_used(void)
{
    set("Qrb", 1.5);
    set("Lr", 0);
    run_to(3600);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, get("B"));
    TEST_ASSERT_TRUE(get("V") > 0);
    sane();
    settle();
    sane();
}

static void product_balances_close_at_every_steady_state(void)
{
    static const double heat[] = {0.7, 0.8, 0.9}, reflux[] = {3.5, 4.5, 5.5};
    static const double mass[2] = {0.13138834, 0.1658334};
    for (int n = 0; n < 9; n++) {
        set("Qrb", heat[n % 3]);
        set("Lr", reflux[n / 3]);
        settle();
        sane();
        /* mass flows from volumes: density of the frozen table */
        double flow[3] = {get("F"), get("D"), get("B")}, w[3] = {get("xF"), get("xD"), get("xB")};
        double t[3] = {get("TF"), 0, get("TB")}, light[3], all[3];
        for (int i = 0; i < 3; i++) {
            double x = w[i] / mass[0] / (w[i] / mass[0] + (100 - w[i]) / mass[1]);
            double kelvin = t[i] + 273.15;
            if (i == 1) { /* drum: bubble point at 760 mmHg, less 5 K */
                double lo = 350, hi = 400;
                for (int b = 0; b < 80; b++) {
                    kelvin = 0.5 * (lo + hi);
                    double p = x * exp(21.354957 - 3177.86676 / (kelvin - 36.672)) +
                               (1 - x) * exp(20.9891453 - 3211.7424 / (kelvin - 54.787));
                    *(p > 760 * 133.322 ? &hi : &lo) = kelvin;
                }
                kelvin -= 5;
            }
            double volume = x * mass[0] / (1991.141 - 1.789634 * kelvin) +
                            (1 - x) * mass[1] / (2111.059 - 1.66525 * kelvin);
            all[i] = flow[i] / volume;
            light[i] = all[i] * x;
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-7 * all[0], all[0], all[1] + all[2]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7 * light[0], light[0], light[1] + light[2]);
    }
}

static void inputs_that_are_no_numbers_or_out_of_range_are_refused_in_words(void)
{
    double before = get("Qrb");
    TEST_ASSERT_FALSE(kind->set_input(plant, channel("Qrb"), NAN, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("pilot: Qrb = nan kW is outside 0 to 1.5", err);
    TEST_ASSERT_FALSE(kind->set_input(plant, channel("Qrb"), 1.6, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("pilot: Qrb = 1.6 kW is outside 0 to 1.5", err);
    TEST_ASSERT_FALSE(kind->set_input(plant, channel("xF"), -1, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("pilot: xF = -1 %w is outside 0 to 100", err);
    TEST_ASSERT_FALSE(kind->set_input(plant, channel("T1"), 90, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("pilot: channel 8 is not an input; inputs are 0 to 7", err);
    TEST_ASSERT_TRUE(get("Qrb") == before);
    run_to(60);
    TEST_ASSERT_FALSE(kind->advance(plant, 30, err, sizeof err));
}

static void channels_are_well_formed(void)
{
    for (size_t i = 0; i < kind->n_channels; i++) {
        const struct plant_channel *c = &kind->channels[i];
        TEST_ASSERT_NOT_NULL(c->name);
        TEST_ASSERT_TRUE(strlen(c->name) <= 15 && strlen(c->unit) <= 11 && c->help);
        TEST_ASSERT_TRUE(c->lo < c->hi);
        if (c->kind == PLANT_MV || c->kind == PLANT_DISTURBANCE)
            TEST_ASSERT_TRUE(kind->value(plant, i) == c->nominal);
        for (size_t j = 0; j < i; j++)
            TEST_ASSERT_TRUE(strcmp(c->name, kind->channels[j].name) != 0);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(channels_are_well_formed);
    RUN_TEST(the_nominal_profile_is_that_of_the_reference);
    RUN_TEST(steady_state_gains_of_every_tray_are_those_of_the_reference);
    RUN_TEST(step_responses_of_every_tray_are_those_of_the_reference);
    RUN_TEST(a_day_of_changes_runs_as_that_of_the_reference);
    RUN_TEST(gains_are_within_a_factor_of_one_and_a_half_of_folamis);
    RUN_TEST(the_operating_point_lies_in_folamis_ranges);
    RUN_TEST(the_slow_time_constant_is_between_ten_and_forty_minutes);
    RUN_TEST(signs_of_the_gains_are_physical);
    RUN_TEST(brutal_inputs_keep_every_channel_inside_its_span);
    RUN_TEST(with_the_heater_off_nothing_boils_and_the_feed_runs_through);
    RUN_TEST(after_a_heater_trip_the_column_comes_back_to_its_operating_point);
    RUN_TEST(reflux_beyond_the_vapour_gives_total_reflux_and_no_distillate);
    RUN_TEST(heat_beyond_the_liquid_supply_gives_no_bottoms_and_is_not_used);
    RUN_TEST(product_balances_close_at_every_steady_state);
    RUN_TEST(inputs_that_are_no_numbers_or_out_of_range_are_refused_in_words);
    return UNITY_END();
}
