/* Faults of instruments: each does what docs/inside/faults.md says, at the time it is asked for, the same every run. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/events.h"
#include "instruments.h"
#include "two_by_two.h"
#include "unity.h"

enum { U1, U2, D, Y1, Y2 };
#define DT 10.0

static struct plant *plant;
static struct instruments in;
static struct events events;
static struct link_sample sample;
static char err[512];
static unsigned samples_taken;

void setUp(void)
{
    plant = two_by_two.create(err, sizeof(err));
    TEST_ASSERT_NOT_NULL(plant);
    TEST_ASSERT_TRUE(instruments_init(&in, &two_by_two, 11, 0.0, err, sizeof(err)));
    memset(&events, 0, sizeof(events));
    samples_taken = 0;
}

void tearDown(void)
{
    two_by_two.destroy(plant);
}

static void at(const char *event)
{
    TEST_ASSERT_TRUE_MESSAGE(events_add(&events, &two_by_two, event, err, sizeof(err)), err);
}

/* Samples every 10 s from time 0; the plant stands at its steady state (y1 = 45, y2 = 51). */
static float reading(void)
{
    double time_s = DT * samples_taken;
    TEST_ASSERT_TRUE(events_apply(&events, time_s, plant, &in, err, sizeof(err)));
    instruments_measure(&in, plant, samples_taken == 0 ? 0.0 : DT, &sample);
    samples_taken++;
    return sample.measurement[0].value;
}

static double moved_to(double command)
{
    struct link_command c = {.n_outputs = 2};
    c.output[0].value = (float)command;
    c.output[0].drive = true;
    instruments_command(&in, &c);
    TEST_ASSERT_TRUE_MESSAGE(instruments_drive(&in, plant, DT, err, sizeof(err)), err);
    return two_by_two.value(plant, U1);
}

static void drift_goes_on_by_the_hour_and_is_gone_when_repaired(void)
{
    at("10:y1.drift=36");
    at("100:y1.drift=0");
    TEST_ASSERT_EQUAL_FLOAT(45.0f, reading());
    for (unsigned k = 1; k < 10; k++)
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 45.0f + 0.1f * (float)k, reading());
    TEST_ASSERT_EQUAL_FLOAT(45.0f, reading());
}

static void hum_is_a_sine_of_its_amplitude_and_period(void)
{
    at("0:y1.hum=2");
    at("0:y1.hum_period=40"); /* a quarter a sample */
    const float expected[] = {45, 47, 45, 43, 45, 47};
    for (unsigned k = 0; k < 6; k++)
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, expected[k], reading());
}

static void a_stuck_sensor_reads_what_it_is_stuck_at_until_it_is_free(void)
{
    at("10:y1.stuck=77");
    at("30:y1.free=1");
    const float expected[] = {45, 77, 77, 45};
    for (unsigned k = 0; k < 4; k++)
        TEST_ASSERT_EQUAL_FLOAT(expected[k], reading());
}

static void a_sensor_may_be_stuck_outside_its_span_and_call_that_good(void)
{
    at("10:y1.stuck=200");
    (void)reading();
    TEST_ASSERT_EQUAL_FLOAT(200.0f, reading());
    TEST_ASSERT_EQUAL(QUALITY_GOOD, sample.measurement[0].quality);
}

static void a_frozen_sensor_keeps_its_reading_to_the_last_bit(void)
{
    at("0:y1.noise=1");
    at("50:y1.frozen=1");
    for (unsigned k = 0; k < 5; k++)
        (void)reading();
    float last = sample.measurement[0].value;
    for (unsigned k = 0; k < 20; k++)
        TEST_ASSERT_EQUAL_FLOAT(last, reading());
    at("240:y1.free=1");
    (void)reading(); /* at 250 s */
    TEST_ASSERT_TRUE(last != sample.measurement[0].value);
}

static void a_dead_sensor_reads_the_end_of_its_span_and_calls_it_good(void)
{
    at("0:y1.dead=1");
    TEST_ASSERT_EQUAL_FLOAT((float)two_by_two.channels[Y1].lo, reading());
    TEST_ASSERT_EQUAL(QUALITY_GOOD, sample.measurement[0].quality);
}

static void spikes_come_at_their_rate_both_ways_and_last_one_sample(void)
{
    unsigned up = 0, down = 0;
    at("0:y1.spike=20");
    at("0:y1.spike_rate=36"); /* one sample in ten */
    for (unsigned k = 0; k < 4000; k++) {
        float y = reading();
        TEST_ASSERT_TRUE(y == 45.0f || y == 65.0f || y == 25.0f);
        up += y > 50.0f;
        down += y < 40.0f;
    }
    TEST_ASSERT_UINT32_WITHIN(76, 400,
                              up + down); /* four standard errors; at time 0 there is none */
    TEST_ASSERT_UINT32_WITHIN(56, 200, up);
}

static void dropouts_come_at_their_rate_as_missing_readings(void)
{
    unsigned missing = 0;
    at("0:y1.dropout=0.25");
    for (unsigned k = 0; k < 4000; k++) {
        (void)reading();
        missing += sample.measurement[0].quality == QUALITY_MISSING;
    }
    TEST_ASSERT_UINT32_WITHIN(110, 1000, missing);
}

static void not_a_number_is_sent_as_it_is_and_called_good(void)
{
    at("10:y1.nan=1");
    at("20:y1.nan=0");
    TEST_ASSERT_EQUAL_FLOAT(45.0f, reading());
    TEST_ASSERT_TRUE(isnan(reading()));
    TEST_ASSERT_EQUAL(QUALITY_GOOD, sample.measurement[0].quality);
    TEST_ASSERT_EQUAL_FLOAT(45.0f, reading());
}

/* The plant stands still and the sensor drifts by 1 a sample from the first on: a reading tells when it was taken. */
static void an_analyser_shows_what_it_took_so_many_samples_ago_until_it_has_more(void)
{
    at("0:y1.every=5");
    at("0:y1.phase=2");
    at("0:y1.delay=3");
    at("0:y1.drift=360");
    TEST_ASSERT_EQUAL_FLOAT(45, reading());
    for (unsigned n = 1; n < 40; n++) {
        unsigned turn =
            n < 7 ? 3 : n - (n - 2) % 5; /* the first took none: before it all was at rest */
        TEST_ASSERT_EQUAL_FLOAT(45 + (turn - 3), reading());
        TEST_ASSERT_EQUAL_UINT8(QUALITY_GOOD, sample.measurement[0].quality);
    }
}

static void an_analyser_that_stops_repeats_its_last_number(void)
{
    at("0:y1.every=5");
    at("0:y1.drift=360");
    at("120:y1.frozen=1");
    for (unsigned n = 0; n < 40; n++)
        TEST_ASSERT_EQUAL_FLOAT(45 + (n < 10 ? n - n % 5 : 10), reading());
}

static void faults_leave_the_noise_of_every_sensor_as_it_was(void)
{
    float first[2][50];
    for (unsigned round = 0; round < 2; round++) {
        TEST_ASSERT_TRUE(instruments_init(&in, &two_by_two, 11, 1.0, err, sizeof(err)));
        for (unsigned k = 0; k < 50; k++) {
            if (round == 1 && k == 10) {
                instruments_set(&in, Y1, OPTION_SPIKE, 5.0);
                instruments_set(&in, Y1, OPTION_SPIKE_RATE, 100.0);
                instruments_set(&in, Y1, OPTION_DROPOUT, 0.3);
                instruments_set(&in, Y1, OPTION_STUCK, 30.0);
            }
            if (round == 1 && k == 30) {
                instruments_set(&in, Y1, OPTION_SPIKE_RATE, 0.0);
                instruments_set(&in, Y1, OPTION_DROPOUT, 0.0);
                instruments_set(&in, Y1, OPTION_FREE, 1.0);
            }
            instruments_measure(&in, plant, DT, &sample);
            first[round][k] = sample.measurement[k < 10 || k >= 30 ? 0 : 1].value;
        }
        /* while the first sensor is ill, the second is compared */
        for (unsigned k = 0; round == 1 && k < 50; k++)
            TEST_ASSERT_EQUAL_FLOAT(first[0][k], first[1][k]);
    }
}

static void a_sticking_valve_stays_and_then_goes_all_the_way(void)
{
    instruments_set(&in, U1, OPTION_STICTION, 3.0);
    TEST_ASSERT_EQUAL_DOUBLE(20.0, moved_to(22.0));
    TEST_ASSERT_EQUAL_DOUBLE(20.0, moved_to(23.0));
    TEST_ASSERT_EQUAL_DOUBLE(23.5, moved_to(23.5));
    TEST_ASSERT_EQUAL_DOUBLE(23.5, moved_to(21.0));
    TEST_ASSERT_EQUAL_DOUBLE(20.0, moved_to(20.0));
}

static void a_valve_with_play_follows_only_beyond_it(void)
{
    instruments_set(&in, U1, OPTION_BACKLASH, 2.0);
    TEST_ASSERT_EQUAL_DOUBLE(20.0, moved_to(21.0));
    TEST_ASSERT_EQUAL_DOUBLE(23.0, moved_to(24.0));
    TEST_ASSERT_EQUAL_DOUBLE(23.0, moved_to(22.0));
    TEST_ASSERT_EQUAL_DOUBLE(21.0, moved_to(20.0));
    instruments_set(&in, U1, OPTION_BACKLASH, 0.0);
    TEST_ASSERT_EQUAL_DOUBLE(20.5, moved_to(20.5));
}

static void a_heater_that_fails_stays_at_its_value_and_the_readback_says_so(void)
{
    instruments_set(&in, U1, OPTION_STUCK, 0.0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, moved_to(80.0));
    (void)reading();
    TEST_ASSERT_EQUAL_FLOAT(0.0f, sample.readback[0].value);
}

static void a_failed_flowmeter_sends_no_readback_and_a_blind_one_echoes_the_command(void)
{
    instruments_set(&in, U1, OPTION_STUCK, 10.0);
    instruments_set(&in, U1, OPTION_READBACK, 0.0);
    (void)moved_to(80.0);
    (void)reading();
    TEST_ASSERT_EQUAL(QUALITY_MISSING, sample.readback[0].quality);
    instruments_set(&in, U1, OPTION_READBACK, 2.0);
    (void)reading();
    TEST_ASSERT_EQUAL_FLOAT(80.0f, sample.readback[0].value);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, sample.readback[0].quality);
}

static void
another_trim_makes_moves_larger_from_where_it_stands_and_the_readback_does_not_show_it(void)
{
    (void)moved_to(30.0);
    instruments_set(&in, U1, OPTION_GAIN, 2.0);
    TEST_ASSERT_EQUAL_DOUBLE(30.0, moved_to(30.0));
    TEST_ASSERT_EQUAL_DOUBLE(34.0, moved_to(32.0));
    (void)reading();
    TEST_ASSERT_EQUAL_FLOAT(32.0f, sample.readback[0].value);
    TEST_ASSERT_EQUAL_DOUBLE(100.0, moved_to(90.0)); /* the end of its span */
    (void)moved_to(32.0);
    instruments_set(&in, U1, OPTION_GAIN, 1.0);
    TEST_ASSERT_EQUAL_DOUBLE(33.0, moved_to(31.0));
}

/* ---- disturbances that swing ---- */

/* After one sample more. */
static double disturbance(void)
{
    (void)reading();
    return two_by_two.value(plant, D);
}

static void a_disturbance_swings_about_its_value_and_ends_there(void)
{
    at("10:d=2");
    at("10:d.swing=0.5");
    at("10:d.period=80");
    at("50:d.swing=0");
    TEST_ASSERT_TRUE(events_finish(&events, &two_by_two, err, sizeof(err)));
    double begin = disturbance(), expected[] = {2.0, 2.0 + 0.5 * sin(0.25 * 3.14159265358979323846),
                                                2.5, 2.0 + 0.5 * sin(0.75 * 3.14159265358979323846),
                                                2.0, 2.0};
    TEST_ASSERT_EQUAL_DOUBLE(two_by_two.channels[D].nominal, begin);
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, expected[i], disturbance());
}

static void a_new_value_moves_the_middle_of_a_swing(void)
{
    at("0:d.swing=1");
    at("0:d.period=40");
    at("10:d=3");
    (void)disturbance();
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 4.0, disturbance());
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3.0, disturbance());
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2.0, disturbance());
}

static void a_swing_that_would_leave_the_span_is_refused(void)
{
    char text[64];
    (void)snprintf(text, sizeof text, "20:d=%g", two_by_two.channels[D].hi);
    at("10:d.swing=0.5");
    at(text);
    TEST_ASSERT_FALSE(events_finish(&events, &two_by_two, err, sizeof(err)));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err, "from 20 s d swings from"), err);
    TEST_ASSERT_FALSE(events_add(&events, &two_by_two, "0:d.period=0", err, sizeof(err)));
    TEST_ASSERT_FALSE(events_add(&events, &two_by_two, "0:d.bias=1", err, sizeof(err)));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err, "it has swing, period"), err);
}

static void options_for_the_other_kind_and_broken_choices_are_refused(void)
{
    const char *wrong[] = {"0:y1.stiction=1", "0:u1.drift=1",    "0:u1.nan=1",     "0:y1.nan=0.5",
                           "0:y1.dropout=2",  "0:u1.readback=3", "0:u1.stuck=1e6", "0:y1.spike=-1"};
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
        TEST_ASSERT_FALSE_MESSAGE(events_add(&events, &two_by_two, wrong[i], err, sizeof(err)),
                                  wrong[i]);
}

static void the_refusal_of_an_unknown_option_names_every_option(void)
{
    for (unsigned k = 0; k < 2; k++) {
        const char *name;
        TEST_ASSERT_FALSE(
            events_add(&events, &two_by_two, k == 0 ? "0:y1.x=1" : "0:u1.x=1", err, sizeof(err)));
        const char *list = strstr(err, "it has ");
        TEST_ASSERT_NOT_NULL_MESSAGE(list, err);
        for (size_t n = 0; (name = events_option(k == 0 ? PLANT_MEASUREMENT : PLANT_MV, n)); n++) {
            TEST_ASSERT_NOT_NULL_MESSAGE(strstr(list, name), name);
        }
    }
}

static bool is_option(enum plant_kind kind, const char *name)
{
    const char *option;
    for (size_t n = 0; (option = events_option(kind, n)) != NULL; n++)
        if (strcmp(option, name) == 0)
            return true;
    return false;
}

/* The table of docs/inside/faults.md under `head` has a row for each option of that kind, and no other row. */
static void compare_table(const char *page, const char *head, enum plant_kind kind)
{
    char row[60], message[240];
    const char *option, *table = strstr(page, head);
    TEST_ASSERT_NOT_NULL_MESSAGE(table, head);
    const char *end = strstr(table, "\n\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(end, head);
    for (size_t n = 0; (option = events_option(kind, n)) != NULL; n++) {
        (void)snprintf(row, sizeof(row), "\n| `%s` |", option);
        (void)snprintf(
            message, sizeof(message),
            "%s has no row in docs/inside/faults.md: write \"| `%s` | unit | what it does |\" "
            "under \"%s\"",
            option, option, head);
        const char *found = strstr(table, row);
        TEST_ASSERT_TRUE_MESSAGE(found && found < end, message);
    }
    for (const char *at = strstr(table, "\n| `"); at && at < end; at = strstr(at + 1, "\n| `")) {
        (void)snprintf(row, sizeof(row), "%.*s", (int)strcspn(at + 4, "`"), at + 4);
        (void)snprintf(message, sizeof(message),
                       "docs/inside/faults.md, under \"%s\": options[] of host_sim/bench/events.c "
                       "has no `%s`: delete its row",
                       head, row);
        TEST_ASSERT_TRUE_MESSAGE(is_option(kind, row), message);
    }
}

static void the_document_has_a_row_for_every_option_and_no_other(void)
{
    static char page[60000];
    FILE *file = fopen("../docs/inside/faults.md", "r");
    TEST_ASSERT_NOT_NULL(file);
    page[fread(page, 1, sizeof(page) - 1, file)] = '\0';
    (void)fclose(file);
    compare_table(page, "| option of a measurement |", PLANT_MEASUREMENT);
    compare_table(page, "| option of a manipulated variable |", PLANT_MV);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_disturbance_swings_about_its_value_and_ends_there);
    RUN_TEST(a_new_value_moves_the_middle_of_a_swing);
    RUN_TEST(a_swing_that_would_leave_the_span_is_refused);
    RUN_TEST(drift_goes_on_by_the_hour_and_is_gone_when_repaired);
    RUN_TEST(hum_is_a_sine_of_its_amplitude_and_period);
    RUN_TEST(a_stuck_sensor_reads_what_it_is_stuck_at_until_it_is_free);
    RUN_TEST(a_sensor_may_be_stuck_outside_its_span_and_call_that_good);
    RUN_TEST(a_frozen_sensor_keeps_its_reading_to_the_last_bit);
    RUN_TEST(a_dead_sensor_reads_the_end_of_its_span_and_calls_it_good);
    RUN_TEST(spikes_come_at_their_rate_both_ways_and_last_one_sample);
    RUN_TEST(dropouts_come_at_their_rate_as_missing_readings);
    RUN_TEST(not_a_number_is_sent_as_it_is_and_called_good);
    RUN_TEST(an_analyser_shows_what_it_took_so_many_samples_ago_until_it_has_more);
    RUN_TEST(an_analyser_that_stops_repeats_its_last_number);
    RUN_TEST(faults_leave_the_noise_of_every_sensor_as_it_was);
    RUN_TEST(a_sticking_valve_stays_and_then_goes_all_the_way);
    RUN_TEST(a_valve_with_play_follows_only_beyond_it);
    RUN_TEST(
        another_trim_makes_moves_larger_from_where_it_stands_and_the_readback_does_not_show_it);
    RUN_TEST(a_heater_that_fails_stays_at_its_value_and_the_readback_says_so);
    RUN_TEST(a_failed_flowmeter_sends_no_readback_and_a_blind_one_echoes_the_command);
    RUN_TEST(options_for_the_other_kind_and_broken_choices_are_refused);
    RUN_TEST(the_refusal_of_an_unknown_option_names_every_option);
    RUN_TEST(the_document_has_a_row_for_every_option_and_no_other);
    return UNITY_END();
}
