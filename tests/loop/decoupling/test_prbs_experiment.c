/* The kind `experiment` on the whole firmware and over the link: what it finds of plants, and what becomes of it and of the plant
 * when something comes between. */
#include <math.h>

#include "plant_board.h"

/* Samples of the shipped settings: 20 at rest, two sequences of 254. */
#define REST  21u
#define MOVES 508u

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

static double shown(const char *name)
{
    char format[40];
    ask_ok("block 1");
    snprintf(format, sizeof format, " %s = %%lf", name);
    for (unsigned i = 0; i < n_reply; i++) {
        double value;
        if (sscanf(reply[i], format, &value) == 1)
            return value;
    }
    TEST_FAIL_MESSAGE(name);
    return 0;
}

static double setting(const char *name)
{
    char line[40];
    double value;
    snprintf(line, sizeof line, "get %s", name);
    ask_ok(line);
    const char *at = strstr(reply[0], "= ");
    TEST_ASSERT_NOT_NULL_MESSAGE(at, reply[0]);
    TEST_ASSERT_EQUAL_MESSAGE(1, sscanf(at, "= %lf", &value), reply[0]);
    return value;
}

static bool events_have(const char *text)
{
    ask_ok("events");
    return said(text);
}

/* Both inputs by hand at 0, at rest. */
static void begin_kotyk(double noise)
{
    plant_power_on("kotyk-column", 120000, 5, noise);
    ask_file(DECOUPLING "/kotyk.conf");
    ask_file(DECOUPLING "/experiment.conf");
    if (!(noise > 0))
        ask_ok("set meas1.frozen 0");
    plant_connect();
    plant_steps(2);
    ask_ok("out one 0");
    ask_ok("out two 0");
    plant_steps(60);
    board_forget();
}

static void run_kotyk(void)
{
    ask_ok("block 1 start");
    plant_steps(REST + MOVES + 4);
}

/* The gains of the paper's polynomials in fractions of span. */
static const double kotyk_gain[2][2] = {{0.38884, -0.14072}, {0.32945, -0.38269}};

static void assert_gains(const double gain[2][2], double part)
{
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++) {
            char name[16];
            snprintf(name, sizeof name, "gain_%u%u", i + 1, j + 1);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(part * fabs(gain[i][j]), gain[i][j], shown(name),
                                              name);
        }
}

/* ---- what it finds ---- */

static void without_noise_the_model_is_the_plant(void)
{
    begin_kotyk(0);
    run_kotyk();
    assert_gains(kotyk_gain, 2e-3); /* readings are rounded to a ten thousandth of span */
    TEST_ASSERT_TRUE(shown("fit_1") > 0.99 && shown("fit_2") > 0.99);
}

static void with_noise_gains_are_found_to_a_few_per_cent(void)
{
    begin_kotyk(1);
    run_kotyk();
    assert_gains(kotyk_gain, 0.05);
    TEST_ASSERT_TRUE(events_have("block1.found"));
    TEST_ASSERT_TRUE(events_have("BLOCK_PROPOSES"));
}

static void accepted_the_model_is_in_the_settings(void)
{
    begin_kotyk(0);
    run_kotyk();
    for (unsigned k = 0; k < 3; k++) {
        ask_ok("proposal accept");
        plant_steps(3);
    }
    TEST_ASSERT_TRUE(events_have("block1.adopted"));
    double a = 1 + setting("block1.a1_1") + setting("block1.a1_2"), b = 0;
    for (unsigned k = 1; k <= 5; k++) {
        char name[24];
        snprintf(name, sizeof name, "block1.b11_%u", k);
        b += setting(name);
    }
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, kotyk_gain[0][0], b / a);
}

static void rejected_it_changes_nothing(void)
{
    begin_kotyk(0);
    run_kotyk();
    ask_ok("proposal reject");
    plant_steps(4);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, setting("block1.a1_1"));
    TEST_ASSERT_DOUBLE_WITHIN(0, 6, shown("stage"));
    TEST_ASSERT_FALSE(events_have("block1.adopted"));
}

static void at_once_it_needs_nobody(void)
{
    begin_kotyk(0);
    ask_ok("set block1.adopt at_once");
    plant_steps(2);
    run_kotyk();
    plant_steps(10);
    TEST_ASSERT_TRUE(events_have("block1.adopted"));
    TEST_ASSERT_TRUE(setting("block1.a2_1") < -0.1);
}

static void every_method_and_criterion_finds_the_gains(void)
{
    static const char *const methods[] = {"ls", "iv", "els"}, *const criteria[] = {"bic", "aicc"};
    for (unsigned m = 0; m < 3; m++)
        for (unsigned c = 0; c < 2; c++) {
            char line[60];
            begin_kotyk(0.3);
            snprintf(line, sizeof line, "set block1.method %s", methods[m]);
            ask_ok(line);
            snprintf(line, sizeof line, "set block1.criterion %s", criteria[c]);
            ask_ok(line);
            plant_steps(2);
            run_kotyk();
            assert_gains(kotyk_gain, 0.05);
            plant_power_off();
        }
}

static void with_loops_in_automatic_it_finds_them_too(void)
{
    begin_kotyk(0.3);
    ask_ok("set loop1.gain 0.3");
    ask_ok("set loop2.gain 0.3");
    plant_steps(1);
    ask_ok("mode one auto");
    ask_ok("mode two auto");
    ask_ok("set block1.move.1 0.5,0.5,0,0");
    plant_steps(30);
    run_kotyk();
    assert_gains(kotyk_gain, 0.15);
}

static void dead_times_and_faster_measurements_are_no_obstacle(void)
{
    static const double gain[2][2] = {{12.8 * 4 / 32, -18.9 * 4 / 32},
                                      {6.6 * 4 / 40, -19.4 * 4 / 40}};
    plant_power_on("wood-berry", 60000, 5, 1);
    ask_file(DECOUPLING "/experiment-wood-berry.conf");
    plant_connect();
    plant_steps(2);
    ask_ok("out R 1.95");
    ask_ok("out S 1.71");
    plant_steps(300);
    ask_ok("block 1 start");
    plant_steps(2 * (REST + 567) + 6);
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++) {
            char name[16];
            snprintf(name, sizeof name, "gain_%u%u", i + 1, j + 1);
            printf("%s: %.4f, truly %.4f\n", name, shown(name), gain[i][j]);
        }
    assert_gains(gain, 0.1);
}

/* ---- what it does not find ---- */

static void a_plant_that_hardly_moves_above_its_noise_is_doubted_not_modelled(void)
{
    begin_kotyk(1);
    ask_ok("set block1.amplitude.1 0.001,0.001,0,0");
    plant_steps(2);
    run_kotyk();
    TEST_ASSERT_TRUE(events_have("block1.doubt"));
    ask_ok("proposal");
    TEST_ASSERT_TRUE(said("no block has proposed anything"));
}

static void a_measurement_that_none_of_the_mvs_moves_is_doubted(void)
{
    begin_kotyk(1);
    plant_event("y2.stuck=0.5");
    ask_ok("set meas2.frozen 0");
    plant_steps(2);
    run_kotyk();
    TEST_ASSERT_TRUE(events_have("block1.doubt"));
}

/* ---- what comes between ---- */

static void leave_range(void)
{
    plant_event("y1.bias=1.4");
}

static void lose_reading(void)
{
    plant_event("y2.quality=3");
}

static void no_number(void)
{
    plant_event("y2.nan=1");
}

static void move_by_hand(void)
{
    ask_ok("out one 1");
}

static void close_a_loop(void)
{
    ask_ok("mode one auto");
}

static void stop_it(void)
{
    ask_ok("block 1 stop");
}

static void other_settings(void)
{
    ask_ok("set block1.nb 4");
}

static void narrow_limits(void)
{
    ask_ok("set mv1.max 0.5");
}

static void silence(void)
{
    board.mute = true;
    pass(400000);
}

static const struct between {
    const char *name;
    void (*act)(void);
    int end;        /* enum experiment_end; 0: it goes on */
    bool elsewhere; /* the MVs do not return to 0 */
} between[] = {
    {"nothing", NULL, 0, true},
    {"a measurement leaves its range", leave_range, 2, false},
    {"a reading is lost", lose_reading, 3, false},
    {"a reading is no number", no_number, 3, false},
    {"a hand moves an MV", move_by_hand, 4, true},
    {"a loop is closed", close_a_loop, 4, true},
    {"stopped", stop_it, 1, false},
    {"its settings change", other_settings, 6, false},
    {"an MV has less room", narrow_limits, 4, false},
    {"the link is silent", silence, 6, true},
};

static void whatever_comes_between_ends_it_and_the_mvs_are_where_they_were(void)
{
    for (size_t k = 0; k < sizeof between / sizeof between[0]; k++) {
        const struct between *b = &between[k];
        begin_kotyk(0.2);
        ask_ok("block 1 start");
        plant_steps(REST + 40);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0, 3, shown("stage"), b->name);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-5, 1, fabs(commanded("u1")), b->name);
        if (b->act)
            b->act();
        if (b->act == silence)
            plant_connect();
        plant_steps(16);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0, b->end, shown("end"), b->name);
        if (!b->elsewhere) {
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-6, 0, commanded("u1"), b->name);
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-6, 0, commanded("u2"), b->name);
        }
        plant_power_off();
    }
}

static void a_reading_that_is_missing_now_and_then_does_not_end_it(void)
{
    begin_kotyk(0.2);
    plant_event("y1.dropout=0.02");
    run_kotyk();
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, shown("end"));
    TEST_ASSERT_TRUE(shown("lost") > 0);
    assert_gains(kotyk_gain, 0.05);
}

static void after_a_power_cut_nothing_moves_until_it_is_told_to(void)
{
    begin_kotyk(0.2);
    ask_ok("save");
    ask_ok("block 1 start");
    plant_steps(REST + 40);
    plant_power_off();
    plant_power_on("kotyk-column", 120000, 5, 0.2);
    plant_connect();
    plant_steps(5);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, shown("stage"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -5, commanded("u1")); /* its safe value */
}

static void start_up_and_it_do_not_have_the_plant_at_the_same_time(void)
{
    begin_kotyk(0.2);
    ask_ok("block 1 start");
    plant_steps(REST + 10);
    TEST_ASSERT_TRUE(ask("commission y1,y2 by u1,u2")[0] == 'e');
    plant_steps(5);
    TEST_ASSERT_DOUBLE_WITHIN(0, 3, shown("stage"));
}

static void the_safe_state_is_left_by_hand_first(void)
{
    plant_power_on("kotyk-column", 120000, 5, 0.2);
    ask_file(DECOUPLING "/kotyk.conf");
    ask_file(DECOUPLING "/experiment.conf");
    plant_connect();
    plant_steps(3);
    ask_ok("block 1 start");
    plant_steps(REST + 10);
    TEST_ASSERT_DOUBLE_WITHIN(0, 4, shown("end"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -5, commanded("u1"));
}

static void settings_that_cannot_be_are_refused_with_what_would_be_right(void)
{
    static const char *const lines[][2] = {
        {"set block1.inputs u1,u2,y1,y2", "measurements, then"},
        {"set block1.inputs y1,y2", "measurements, then"},
        {"set block1.amplitude.1 0.1,0,0,0", "above 0"},
        {"set block1.move.1 0.05,0.05,0,0", "above the amplitude"},
        {"set block1.period 130", "whole number"},
        {"set block1.bits 3", "fewer samples"},
        {"set block1.clock 1000", "no room"},
    };
    begin_kotyk(0.2);
    for (size_t k = 0; k < sizeof lines / sizeof lines[0]; k++) {
        TEST_ASSERT_TRUE_MESSAGE(ask(lines[k][0])[0] == 'e', lines[k][0]);
        TEST_ASSERT_TRUE_MESSAGE(said(lines[k][1]), lines[k][0]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_noise_the_model_is_the_plant);
    RUN_TEST(with_noise_gains_are_found_to_a_few_per_cent);
    RUN_TEST(accepted_the_model_is_in_the_settings);
    RUN_TEST(rejected_it_changes_nothing);
    RUN_TEST(at_once_it_needs_nobody);
    RUN_TEST(every_method_and_criterion_finds_the_gains);
    RUN_TEST(with_loops_in_automatic_it_finds_them_too);
    RUN_TEST(dead_times_and_faster_measurements_are_no_obstacle);
    RUN_TEST(a_plant_that_hardly_moves_above_its_noise_is_doubted_not_modelled);
    RUN_TEST(a_measurement_that_none_of_the_mvs_moves_is_doubted);
    RUN_TEST(whatever_comes_between_ends_it_and_the_mvs_are_where_they_were);
    RUN_TEST(a_reading_that_is_missing_now_and_then_does_not_end_it);
    RUN_TEST(after_a_power_cut_nothing_moves_until_it_is_told_to);
    RUN_TEST(start_up_and_it_do_not_have_the_plant_at_the_same_time);
    RUN_TEST(the_safe_state_is_left_by_hand_first);
    RUN_TEST(settings_that_cannot_be_are_refused_with_what_would_be_right);
    return UNITY_END();
}
