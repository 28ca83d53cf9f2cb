/* The cold pilot column: that at rest it is the pilot, that Folami's start-up and shut-down work on it, its faults, and that
 * no sequence of inputs brings it out of its spans. */
#include "plant_bench.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static double now;

void setUp(void)
{
    bench_open("pilot-cold");
    now = 0;
}

void tearDown(void)
{
    bench_close();
}

static void step(void)
{
    now += 10;
    run_to(now);
}

static void wait(double seconds)
{
    for (double end = now + seconds - 1e-6; now < end;)
        step();
}

static void running_inputs(void)
{
    set("Qrb", 0.823);
    set("vLr", 37.5);
    set("vD", 40);
    set("vB", 39.6);
    set("vF", 50);
    set("vCW", 100);
}

/* Waits until name is above value; the time it took, minutes. */
static double minutes_until_above(const char *name, double value, double limit)
{
    double start = now;
    while (get(name) <= value) {
        TEST_ASSERT_TRUE_MESSAGE(now - start < limit * 60, name);
        step();
    }
    return (now - start) / 60;
}

static void running(void)
{
    running_inputs();
    settle();
}

static double other(struct plant *p, const struct plant_class *k, const char *name)
{
    for (size_t i = 0; i < k->n_channels; i++)
        if (strcmp(k->channels[i].name, name) == 0)
            return k->value(p, i);
    TEST_FAIL_MESSAGE(name);
    return 0;
}

static const char *const trays[11] = {"T1", "T2", "T3", "T4",  "T5", "T6",
                                      "T7", "T8", "T9", "T10", "TB"};

static void at_rest_it_is_the_pilot_within_a_tenth_of_a_kelvin(void)
{
    const struct plant_class *k = plant_open("pilot", err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(k, err);
    struct plant *pilot = plant_create(k, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(pilot, err);
    running();
    double worst = 0;
    for (int i = 0; i < 11; i++)
        worst = fmax(worst, fabs(get(trays[i]) - other(pilot, k, trays[i])));
    printf("furthest from the pilot: %.3f K; D %.4f for %.4f l/h, B %.4f for %.4f l/h\n", worst,
           get("D"), other(pilot, k, "D"), get("B"), other(pilot, k, "B"));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0, worst);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * other(pilot, k, "D"), other(pilot, k, "D"), get("D"));
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * other(pilot, k, "B"), other(pilot, k, "B"), get("B"));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, other(pilot, k, "xD"), get("xD"));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, other(pilot, k, "xB"), get("xB"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.5, get("Lr"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 5.0, get("F"));
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 86.82 - 5.0,
                              get("TD")); /* as the pilot: 5 K below its bubble point */
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 15.0, get("LB_true"));
    k->destroy(pilot);
}

static double gain(const char *input, const char *output, double h)
{
    double at = get(input), y[2];
    for (int i = 0; i < 2; i++) {
        set(input, i == 0 ? at - h : at + h);
        settle();
        y[i] = get(output);
    }
    set(input, at);
    settle();
    return (y[1] - y[0]) / (2 * h);
}

static void its_gains_are_within_a_factor_of_one_and_a_half_of_folamis(void)
{
    running();
    double g[2][2] = {{gain("vLr", "T1", 0.1) / 0.12, gain("Qrb", "T1", 0.001)},
                      {gain("vLr", "T10", 0.1) / 0.12, gain("Qrb", "T10", 0.001)}};
    static const double folami[2][2] = {{-0.5, 3.56}, {-9.53, 80.77}};
    printf("gains %.3f %.3f %.3f %.3f\n", g[0][0], g[0][1], g[1][0], g[1][1]);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++)
            TEST_ASSERT_TRUE(g[i][j] / folami[i][j] > 1 / 1.5 && g[i][j] / folami[i][j] < 1.5);
}

static void it_starts_cold_switched_off_and_filled(void)
{
    for (size_t i = 0; i < kind->n_channels; i++)
        if (kind->channels[i].kind == PLANT_MV)
            TEST_ASSERT_TRUE(kind->value(plant, i) == 0.0);
    for (int i = 0; i < 11; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 20.0, get(trays[i]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 18.0, get("LB"));
    TEST_ASSERT_TRUE(get("LD") < 0.2);
    wait(3600);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 20.0, get("TB"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 18.0, get("LB"));
}

static void
in_folamis_heater_range_it_boils_within_ten_to_twenty_five_minutes_and_not_before_its_bubble_point(
    void)
{
    static const double kilowatts[3] = {0.7, 1.0, 1.25};
    double took[3];
    for (int k = 0; k < 3; k++) {
        tearDown();
        setUp();
        set("vCW", 100);
        set("Qrb", kilowatts[k]);
        while (get("TB") < 100.0) {
            TEST_ASSERT_TRUE(get("V") == 0.0);
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, get("LB_true"), get("LB"));
            step();
        }
        minutes_until_above("V", 10.0, 60);
        took[k] = now / 60;
        TEST_ASSERT_TRUE(took[k] > 10 && took[k] < 25);
        wait(60);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, get("LB_true") + 8.0, get("LB"));
    }
    printf("boils after %.1f, %.1f, %.1f min\n", took[0], took[1], took[2]);
}

static void the_front_of_vapour_climbs_tray_by_tray(void)
{
    double before = 0;
    set("vCW", 100);
    set("Qrb", 0.8);
    for (int i = 10; i > 0; i--) {
        minutes_until_above(trays[i - 1], 60.0, 60);
        TEST_ASSERT_TRUE(now > before);
        before = now;
    }
    TEST_ASSERT_TRUE(get("vent") == 0.0);
    minutes_until_above("LD", 3.0, 10);
}

/* Folami A1.3.1, by the clock and with two-position control of the reboiler's level as read. */
static void his_start_up_brings_it_to_the_running_state(void)
{
    double lowest = 50, highest = 0, valve = 10;
    set("vCW", 100);
    set("Qrb", 1.0);
    minutes_until_above("LD", 1.0, 40);
    set("vLr", 100); /* total reflux */
    wait(12 * 60);
    TEST_ASSERT_TRUE(get("Lr") > 4 && get("D") == 0.0 && get("xD") > 99);
    running_inputs();
    for (int k = 0; k < 4 * 360; k++) {
        double level = get("LB") - 8.0;
        valve = level > 15.5 ? 60 : level < 14.5 ? 10 : valve;
        set("vB", valve);
        step();
        if (k > 360) {
            lowest = fmin(lowest, get("LB_true"));
            highest = fmax(highest, get("LB_true"));
        }
    }
    printf("after %.0f min: T1 %.2f, T10 %.2f degC; level between %.2f and %.2f cm\n", now / 60,
           get("T1"), get("T10"), lowest, highest);
    TEST_ASSERT_TRUE(lowest > 14.4 && highest < 15.6);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 87.15, get("T1"));
    TEST_ASSERT_DOUBLE_WITHIN(1.0, 106.3, get("T10"));
}

static void shut_down_it_cools_to_thirty_degrees_in_about_three_hours(void)
{
    running();
    set("Qrb", 0);
    set("vF", 0);
    set("vD", 0);
    set("vB", 0);
    set("vLr", 100);
    while (get("TB") > 30) {
        TEST_ASSERT_TRUE(now < 4 * 3600);
        step();
        if (now == 1800)
            set("vCW", 0);
    }
    printf("cools to 30 degC in %.2f h\n", now / 3600);
    TEST_ASSERT_TRUE(now > 2.5 * 3600);
    wait(40 * 3600.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 20.0, get("TB"));
    TEST_ASSERT_TRUE(get("V") == 0.0);
}

/* Moles in the whole column, from the states --linearise shows. */
static double moles(double *light)
{
    double x[64], sum = 0;
    size_t n = kind->states->count(plant);
    TEST_ASSERT_TRUE(n < 64);
    kind->states->get(plant, x);
    *light = 0;
    for (size_t i = 0; i + 3 < n; i += 3) {
        *light += x[i] * x[i + 1];
        sum += x[i + 1];
    }
    return sum;
}

static void with_every_outlet_shut_nothing_is_lost(void)
{
    double light, light_before, before = moles(&light_before);
    set("vCW", 100);
    set("Qrb", 0.8);
    set("vLr", 100);
    wait(6 * 3600);
    TEST_ASSERT_TRUE(get("V") > 50);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * before, before, moles(&light));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * before, light_before, light);
}

static void lost_cooling_heats_the_water_vents_vapour_and_starves_the_reflux(void)
{
    running();
    set("supply", 0);
    step();
    TEST_ASSERT_TRUE(get("Fcw") == 0.0);
    double vented = minutes_until_above("vent", 10.0, 5);
    TEST_ASSERT_TRUE(get("Tcw") > 70);
    wait(240);
    printf("cooling lost: vapour leaves the vent after %.1f min\n", vented);
    TEST_ASSERT_TRUE(get("Lr") < 2.0);
    set("supply", 1);
    wait(60);
    TEST_ASSERT_TRUE(get("vent") == 0.0);
    TEST_ASSERT_TRUE(get("Tcw") < 50);
}

static void
a_leaking_reboiler_runs_dry_and_the_bare_heater_overheats_until_its_thermostat_holds_it(void)
{
    double hottest = 0, fastest = 0, was;
    running();
    set("leak", 60);
    minutes_until_above("Theater", 160.0, 3);
    TEST_ASSERT_TRUE(get("LB_true") < 5.0);
    while (now < 900) {
        was = get("Theater");
        step();
        hottest = fmax(hottest, get("Theater"));
        fastest = fmax(fastest, (get("Theater") - was) / 10);
    }
    printf("dry: heater up to %.0f degC, %.1f K/s at the fastest\n", hottest, fastest);
    TEST_ASSERT_TRUE(hottest > 285 && hottest < 300);
    TEST_ASSERT_TRUE(fastest > 1.0);
    set("leak", 0);
    set("vB", 0);
    wait(1800);
    TEST_ASSERT_TRUE(get("Theater") < 160); /* covered again by the feed */
}

static void without_feed_it_boils_itself_dry(void)
{
    running();
    set("vF", 0);
    minutes_until_above("Theater", 250.0, 240);
    TEST_ASSERT_TRUE(get("LB_true") < 5.0);
}

static void a_reboiler_that_is_fed_and_not_drawn_runs_over_and_no_higher(void)
{
    set("vF", 100);
    wait(3600 * 3);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 35.0, get("LB_true"));
    TEST_ASSERT_TRUE(get("B") > 8);
}

static void a_valve_under_two_and_a_half_percent_is_shut(void)
{
    set("vF", 2.4);
    TEST_ASSERT_TRUE(get("F") == 0.0);
    set("vF", 2.5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.25, get("F"));
}

static void sane(unsigned number)
{
    for (size_t i = 0; i < kind->n_channels; i++) {
        const struct plant_channel *c = &kind->channels[i];
        double v = kind->value(plant, i), slack = 1e-9 * (c->hi - c->lo);
        char text[120];
        snprintf(text, sizeof text, "seed %u at %.0f s: %s = %.17g", number, now, c->name, v);
        TEST_ASSERT_TRUE_MESSAGE(isfinite(v) && v >= c->lo - slack && v <= c->hi + slack, text);
    }
}

static double uniform(unsigned *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) / 16777216.0;
}

/* Inputs jump over their whole ranges, rarely in some campaigns and all the time in others. */
static void no_sequence_of_inputs_brings_it_out_of_its_spans(void)
{
    static const struct {
        double busy, tick; /* chance that an input jumps in a tick; s */
        int ticks;
    } way[4] = {{0.3, 30, 400}, {0.02, 10, 1500}, {0.002, 60, 1500}, {0.05, 600, 600}};
    int total = 0;
    for (unsigned number = 1; number <= 12; number++) {
        unsigned seed = number * 2654435761u;
        double busy = way[number % 4].busy, tick = way[number % 4].tick;
        int ticks = way[number % 4].ticks;
        tearDown();
        setUp();
        total += ticks;
        for (int k = 0; k < ticks; k++) {
            for (size_t i = 0; i < kind->n_channels; i++) {
                const struct plant_channel *c = &kind->channels[i];
                if ((c->kind != PLANT_MV && c->kind != PLANT_DISTURBANCE) || uniform(&seed) > busy)
                    continue;
                double which = uniform(&seed);
                set(c->name, which < 0.2   ? c->lo
                             : which < 0.4 ? c->hi
                             : which < 0.5 ? c->nominal
                                           : c->lo + uniform(&seed) * (c->hi - c->lo));
            }
            now += tick;
            run_to(now);
            sane(number);
        }
    }
    printf("seeds 1 to 12, %d ticks\n", total);
}

static void the_same_calls_give_the_same_bits(void)
{
    double first[40], second[40];
    for (int pass = 0; pass < 2; pass++) {
        tearDown();
        setUp();
        running_inputs();
        wait(3000);
        kind->states->get(plant, pass == 0 ? first : second);
    }
    TEST_ASSERT_EQUAL_MEMORY(first, second, 38 * sizeof(double));
}

static void settling_says_in_one_line_when_there_is_nothing_to_settle_to(void)
{
    set("Qrb", 0.8); /* no feed, no cooling */
    TEST_ASSERT_FALSE(kind->settle(plant, err, sizeof err));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err, "pilot-cold: with these inputs the reboiler runs dry"),
                                 err);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 18.0, get("LB")); /* as before */
    running_inputs();
    settle();
    double rates[40], worst = 0;
    TEST_ASSERT_TRUE(kind->states->rates(plant, rates, err, sizeof err));
    for (int i = 0; i < 38; i++)
        worst = fmax(worst, fabs(rates[i]));
    TEST_ASSERT_TRUE(worst * 3600 < 2e-3);
}

static void what_is_out_of_range_or_no_number_is_refused_in_words(void)
{
    TEST_ASSERT_FALSE(kind->set_input(plant, channel("vB"), 100.1, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("pilot-cold: vB = 100.1 % is outside 0 to 100", err);
    TEST_ASSERT_FALSE(kind->set_input(plant, channel("Qrb"), NAN, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("pilot-cold: Qrb = nan kW is outside 0 to 1.5", err);
    TEST_ASSERT_FALSE(kind->set_input(plant, channel("T1"), 90, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("pilot-cold: channel 15 is not an input; inputs are 0 to 14", err);
    run_to(60);
    TEST_ASSERT_FALSE(kind->advance(plant, 30, err, sizeof err));
    TEST_ASSERT_EQUAL_STRING("pilot-cold: advance to 30 s, which is before the present 60 s", err);
}

static void channels_are_well_formed_and_fit_the_link(void)
{
    int counts[4] = {0};
    for (size_t i = 0; i < kind->n_channels; i++) {
        const struct plant_channel *c = &kind->channels[i];
        counts[c->kind]++;
        TEST_ASSERT_NOT_NULL(c->name);
        TEST_ASSERT_TRUE(strlen(c->name) <= 15 && strlen(c->unit) <= 11 && c->help &&
                         c->lo < c->hi);
        TEST_ASSERT_TRUE(isfinite(kind->value(plant, i)));
        if (c->kind == PLANT_MV || c->kind == PLANT_DISTURBANCE)
            TEST_ASSERT_TRUE(kind->value(plant, i) == c->nominal);
        for (size_t j = 0; j < i; j++)
            TEST_ASSERT_TRUE(strcmp(c->name, kind->channels[j].name) != 0);
    }
    TEST_ASSERT_TRUE(counts[PLANT_MV] <= 16 && counts[PLANT_MEASUREMENT] <= 16);
    sane(0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(channels_are_well_formed_and_fit_the_link);
    RUN_TEST(it_starts_cold_switched_off_and_filled);
    RUN_TEST(at_rest_it_is_the_pilot_within_a_tenth_of_a_kelvin);
    RUN_TEST(its_gains_are_within_a_factor_of_one_and_a_half_of_folamis);
    RUN_TEST(
        in_folamis_heater_range_it_boils_within_ten_to_twenty_five_minutes_and_not_before_its_bubble_point);
    RUN_TEST(the_front_of_vapour_climbs_tray_by_tray);
    RUN_TEST(his_start_up_brings_it_to_the_running_state);
    RUN_TEST(shut_down_it_cools_to_thirty_degrees_in_about_three_hours);
    RUN_TEST(with_every_outlet_shut_nothing_is_lost);
    RUN_TEST(lost_cooling_heats_the_water_vents_vapour_and_starves_the_reflux);
    RUN_TEST(
        a_leaking_reboiler_runs_dry_and_the_bare_heater_overheats_until_its_thermostat_holds_it);
    RUN_TEST(without_feed_it_boils_itself_dry);
    RUN_TEST(a_reboiler_that_is_fed_and_not_drawn_runs_over_and_no_higher);
    RUN_TEST(a_valve_under_two_and_a_half_percent_is_shut);
    RUN_TEST(no_sequence_of_inputs_brings_it_out_of_its_spans);
    RUN_TEST(the_same_calls_give_the_same_bits);
    RUN_TEST(settling_says_in_one_line_when_there_is_nothing_to_settle_to);
    RUN_TEST(what_is_out_of_range_or_no_number_is_refused_in_words);
    return UNITY_END();
}
