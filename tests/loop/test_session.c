/* The plant link from the firmware's side: greeting, samples, silence, and everything that goes wrong. */
#include "board_bench.h"
#include "random_source.h"

void setUp(void)
{
    running();
}
void tearDown(void) {}

/* ---- greeting ---- */

static void without_a_plant_it_greets_four_times_a_second(void)
{
    power_on();
    board.hellos = 0;
    pass(5000);
    TEST_ASSERT_UINT32_WITHIN(1, 20, board.hellos);
    TEST_ASSERT_EQUAL(0, board.commands);
}

static void it_asks_for_every_page_and_says_ready_once(void)
{
    power_on();
    connect_plant();
    TEST_ASSERT_EQUAL(6, board.page_requests);
    TEST_ASSERT_EQUAL(1, board.readies);
}

static void a_page_that_is_lost_is_asked_for_again(void)
{
    power_on();
    board.deaf_to_pages = true;
    board.mute = false;
    pass(1000);
    TEST_ASSERT_FALSE(board.ready);
    TEST_ASSERT_TRUE(board.page_requests >= 3);
    board.deaf_to_pages = false;
    pass(500);
    TEST_ASSERT_TRUE(board.ready);
}

static void a_page_answered_twice_does_no_harm(void)
{
    power_on();
    board.mute = false;
    plant_hello();
    plant_page(0);
    plant_page(0);
    board_run();
    pass(500);
    TEST_ASSERT_TRUE(board.ready);
    configure();
    samples(2);
    ask_ok("mode bottom auto");
}

static void a_page_that_was_not_asked_for_is_not_taken_in_place_of_the_one_that_was(void)
{
    power_on();
    board.mute = false;
    board.deaf_to_pages = true;
    pass(300);
    for (uint8_t asked = 0; asked < 6; asked++) {
        for (uint8_t other = 0; other < 6; other++)
            if (other != asked)
                plant_page(other);
        board_run();
        TEST_ASSERT_FALSE(board.ready);
        plant_page(asked);
        board_run();
    }
    TEST_ASSERT_TRUE(board.ready);
    configure();
    samples(2);
    ask_ok("status");
    TEST_ASSERT_TRUE(said("T1 = 85") && said("T10 = 115"));
    ask_ok("out bottom 1.5");
    ask_ok("out top 4");
    samples(1);
    TEST_ASSERT_EQUAL_FLOAT(4.0f, board.command.output[0].value);
    TEST_ASSERT_EQUAL_FLOAT(1.5f, board.command.output[1].value);
}

static void a_plant_that_did_not_get_ready_is_told_again(void)
{
    unsigned before = board.readies;
    plant_hello();
    board_run();
    TEST_ASSERT_EQUAL(before + 1, board.readies);
    samples(1);
    TEST_ASSERT_EQUAL(6, tick_count());
}

static void a_restarted_plant_is_met_anew_in_the_safe_state(void)
{
    ask_ok("mode bottom auto");
    samples(2);
    TEST_ASSERT_FALSE(board.command.safe);
    board.session++;
    board.time_ms = 0;
    board.number = 0;
    board_forget();
    plant_hello();
    board_run();
    TEST_ASSERT_TRUE(said("SAFE_STATE"));
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, board.command.output[1].value);
}

static void a_plant_of_another_version_gets_no_further_and_is_reported_once(void)
{
    power_on();
    board.version = LINK_VERSION + 1;
    board.mute = false;
    board_forget();
    pass(3000);
    TEST_ASSERT_EQUAL(1, times_said("LINK_VERSION"));
    TEST_ASSERT_EQUAL(0, board.page_requests);
    TEST_ASSERT_UINT32_WITHIN(3, 12, board.hellos); /* no storm of greetings */
    board.version = LINK_VERSION;
    pass(1000);
    TEST_ASSERT_TRUE(board.ready);
}

static void a_plant_replaced_by_one_of_another_version_leaves_the_board_safe(void)
{
    ask_ok("mode bottom auto");
    samples(2);
    board_forget();
    board.version = LINK_VERSION + 1;
    board.session++;
    for (unsigned n = 0; n < 20; n++) {
        plant_hello();
        pass(250);
    }
    TEST_ASSERT_TRUE(said("SAFE_STATE"));
    ask_refused("mode bottom auto", "STATE");
}

/* ---- samples ---- */

static void each_sample_is_answered_with_its_number_and_time(void)
{
    for (unsigned n = 0; n < 20; n++) {
        samples(1);
        TEST_ASSERT_EQUAL(board.number, board.command.number);
        TEST_ASSERT_EQUAL_UINT64(board.time_ms, board.command.time_ms);
        TEST_ASSERT_EQUAL(2, board.command.n_outputs);
    }
}

static void a_repeated_sample_makes_no_tick_and_gets_the_same_answer(void)
{
    ask_ok("mode bottom auto");
    board.values[1] = 113;
    samples(1);
    struct link_command first = board.command;
    uint32_t ticks = tick_count();
    board_forget();
    for (unsigned n = 0; n < 20; n++) { /* more often than the limit for missing samples */
        unsigned before = board.commands;
        send_sample_again();
        TEST_ASSERT_EQUAL(before + 1, board.commands);
        TEST_ASSERT_EQUAL_MEMORY(&first, &board.command, sizeof first);
    }
    TEST_ASSERT_EQUAL(20, times_said("SAMPLE_TWICE"));
    TEST_ASSERT_EQUAL(ticks, tick_count());
}

static void an_early_sample_is_answered_but_makes_no_tick(void)
{
    uint32_t ticks = tick_count();
    board_forget();
    sample_after(400);
    TEST_ASSERT_TRUE(said("SAMPLE_EARLY"));
    TEST_ASSERT_EQUAL(board.number, board.command.number);
    sample_after(600);
    TEST_ASSERT_EQUAL(ticks + 1, tick_count());
}

static void a_late_sample_is_told_and_makes_a_tick(void)
{
    uint32_t ticks = tick_count();
    board_forget();
    sample_after(1300);
    TEST_ASSERT_TRUE(said("SAMPLE_LATE"));
    TEST_ASSERT_EQUAL(ticks + 1, tick_count());
}

static void a_few_missing_samples_are_told_and_control_goes_on(void)
{
    ask_ok("mode bottom auto");
    samples(1);
    board_forget();
    sample_after(4000);
    TEST_ASSERT_TRUE(said("SAMPLE_MISSING"));
    TEST_ASSERT_FALSE(board.command.safe);
}

static void too_many_missing_samples_take_the_safe_state(void)
{
    ask_ok("mode bottom auto");
    samples(1);
    board_forget();
    sample_after(7000); /* six are missing, five are allowed */
    TEST_ASSERT_TRUE(said("SAFE_STATE"));
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, board.command.output[1].value);
}

static void plant_time_set_back_does_not_freeze_the_outputs_for_ever(void)
{
    samples(100);
    ask_ok("mode bottom auto");
    samples(2);
    board.time_ms = 0;
    samples(10);
    TEST_ASSERT_TRUE(board.command.safe);
    uint32_t ticks = tick_count();
    samples(3);
    TEST_ASSERT_EQUAL(ticks + 3, tick_count());
}

static void the_plants_base_tick_is_taken_where_none_is_configured(void)
{
    board.session++;
    board.tick_ms = 30000;
    board.time_ms = 0;
    plant_hello();
    board_run();
    samples(3);
    ask_ok("status");
    TEST_ASSERT_TRUE(said("base tick 30 s"));
    TEST_ASSERT_FALSE(said("SAMPLE_"));
}

/* ---- silence ---- */

static void silence_is_the_safe_state_after_two_seconds_and_greeting_again(void)
{
    ask_ok("mode bottom auto");
    samples(2);
    board_forget();
    board.mute = true;
    pass(1900);
    TEST_ASSERT_FALSE(said("LINK_DOWN"));
    pass(300);
    TEST_ASSERT_TRUE(said("LINK_DOWN"));
    TEST_ASSERT_TRUE(said("SAFE_STATE"));
    board.hellos = 0;
    pass(1000);
    TEST_ASSERT_UINT32_WITHIN(1, 4, board.hellos);
    ask_refused("mode bottom auto", "STATE");
    board.mute = false;
    pass(500);
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
    ask_ok("mode bottom auto");
    samples(1);
    TEST_ASSERT_FALSE(board.command.safe);
}

static void a_plant_whose_time_stands_still_is_no_silence(void)
{
    ask_ok("mode bottom auto");
    samples(1);
    board_forget();
    pass(60000); /* keep-alives, no sample */
    TEST_ASSERT_FALSE(said("LINK_DOWN"));
    samples(1);
    TEST_ASSERT_FALSE(board.command.safe);
}

static void it_keeps_the_line_alive_twice_a_second(void)
{
    board.keep_alives = 0;
    pass(10000);
    TEST_ASSERT_UINT32_WITHIN(2, 19, board.keep_alives);
}

/* ---- channels ---- */

static void channels_nobody_configured_are_ignored(void)
{
    board.values[2] = 1e30;
    board.values[3] = -1e30;
    ask_ok("mode bottom auto");
    samples(3);
    TEST_ASSERT_FALSE(board.command.safe);
    ask_ok("alarm");
    TEST_ASSERT_EQUAL(1, n_reply); /* nothing is wrong */
}

static void outputs_nobody_configured_are_not_driven(void)
{
    power_on();
    connect_plant();
    samples(2);
    TEST_ASSERT_FALSE(board.command.output[0].drive);
    TEST_ASSERT_FALSE(board.command.output[1].drive);
}

static void an_output_given_up_goes_to_the_plants_own_safe_value(void)
{
    ask_ok("out bottom 1.9");
    samples(1);
    TEST_ASSERT_EQUAL_FLOAT(1.9f, board.command.output[1].value);
    ask_ok("begin");
    ask_ok("set loop2.name -");
    ask_ok("set mv2.name -");
    ask_ok("apply");
    samples(2);
    TEST_ASSERT_TRUE(board.command.output[1].drive);
    TEST_ASSERT_EQUAL_FLOAT(0.25f, board.command.output[1].value);
}

static void a_measurement_the_plant_does_not_have_refuses_automatic(void)
{
    power_on();
    board.names[1] = "T11";
    configure();
    connect_plant();
    samples(2);
    ask_refused("mode bottom auto", "UNKNOWN");
    TEST_ASSERT_TRUE(said("T10"));
    ask_ok("mode top auto");
}

static void an_output_can_be_moved_by_hand_without_the_measurement_of_its_loop(void)
{
    power_on();
    board.names[1] = "T11";
    configure();
    connect_plant();
    samples(2);
    ask_ok("out bottom 1.5");
    samples(1);
    TEST_ASSERT_EQUAL_FLOAT(1.5f, board.command.output[1].value);
}

static void a_measurement_in_another_unit_refuses_automatic(void)
{
    power_on();
    board.units[1] = "K";
    configure();
    connect_plant();
    board_forget();
    samples(2);
    ask_refused("mode bottom auto", "UNIT");
}

static void a_channel_without_a_unit_can_be_bound(void)
{
    ask_ok("begin");
    ask_ok("set meas3.name extra");
    ask_ok("set meas3.unit -");
    ask_ok("apply");
    board.values[3] = 42;
    samples(2);
    ask_ok("status");
    TEST_ASSERT_TRUE(said("extra = 42"));
}

static void a_read_back_that_differs_is_told(void)
{
    board.with_readback = true;
    board.readback[0] = 0;
    board.readback[1] = 0.5;
    ask_ok("out bottom 1.5");
    samples(1);
    board_forget();
    samples(1); /* still the old value at the actuator */
    TEST_ASSERT_TRUE(said("NOT_FOLLOWING heat"));
    board.readback[1] = 1.5;
    samples(1);
    TEST_ASSERT_TRUE(said("! 8.000 info FOLLOWING heat"));
}

/* ---- broken frames ---- */

static void frames_with_any_bit_wrong_are_never_acted_on(void)
{
    struct random_source r = {0xBADF00D};
    struct frame f;
    uint8_t wire[FRAME_WIRE_MAX];
    ask_ok("mode bottom auto");
    samples(2);
    uint32_t ticks = tick_count();
    board.number++;
    board.time_ms += 1000;
    for (unsigned n = 0; n < 2000; n++) {
        pack_present_sample(&f);
        f.sequence = board.sequence++;
        size_t size = frame_encode(&f, wire);
        wire[random_below(&r, (uint32_t)size - 1)] ^= (uint8_t)(1u << random_below(&r, 8));
        memory_port_give(HAL_UART_LINK, wire, size);
        memory_port_give(HAL_UART_LINK, "", 1); /* ends whatever became of it */
        board_run();
    }
    TEST_ASSERT_EQUAL(ticks, tick_count());
    send_sample_again();
    TEST_ASSERT_EQUAL(ticks + 1, tick_count());
}

static void noise_on_the_line_is_survived(void)
{
    struct random_source r = {0x5EED};
    for (unsigned n = 0; n < 500; n++) {
        uint8_t noise[64];
        for (unsigned i = 0; i < sizeof noise; i++)
            noise[i] = (uint8_t)random_next(&r);
        memory_port_give(HAL_UART_LINK, noise, sizeof noise);
        board_run();
    }
    memory_port_give(HAL_UART_LINK, "", 1);
    uint32_t ticks = tick_count();
    samples(1);
    TEST_ASSERT_EQUAL(ticks + 1, tick_count());
}

static void a_sample_with_another_number_of_channels_is_refused(void)
{
    struct link_sample m = {.number = 9, .time_ms = board.time_ms + 1000, .n_measurements = 3};
    struct frame f;
    uint32_t ticks = tick_count();
    unsigned before = board.commands;
    pack_sample(&m, &f);
    link_give(&f);
    board_run();
    TEST_ASSERT_EQUAL(ticks, tick_count());
    TEST_ASSERT_EQUAL(before, board.commands);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_a_plant_it_greets_four_times_a_second);
    RUN_TEST(it_asks_for_every_page_and_says_ready_once);
    RUN_TEST(a_page_that_is_lost_is_asked_for_again);
    RUN_TEST(a_page_answered_twice_does_no_harm);
    RUN_TEST(a_page_that_was_not_asked_for_is_not_taken_in_place_of_the_one_that_was);
    RUN_TEST(a_plant_that_did_not_get_ready_is_told_again);
    RUN_TEST(a_restarted_plant_is_met_anew_in_the_safe_state);
    RUN_TEST(a_plant_of_another_version_gets_no_further_and_is_reported_once);
    RUN_TEST(a_plant_replaced_by_one_of_another_version_leaves_the_board_safe);
    RUN_TEST(each_sample_is_answered_with_its_number_and_time);
    RUN_TEST(a_repeated_sample_makes_no_tick_and_gets_the_same_answer);
    RUN_TEST(an_early_sample_is_answered_but_makes_no_tick);
    RUN_TEST(a_late_sample_is_told_and_makes_a_tick);
    RUN_TEST(a_few_missing_samples_are_told_and_control_goes_on);
    RUN_TEST(too_many_missing_samples_take_the_safe_state);
    RUN_TEST(plant_time_set_back_does_not_freeze_the_outputs_for_ever);
    RUN_TEST(the_plants_base_tick_is_taken_where_none_is_configured);
    RUN_TEST(silence_is_the_safe_state_after_two_seconds_and_greeting_again);
    RUN_TEST(a_plant_whose_time_stands_still_is_no_silence);
    RUN_TEST(it_keeps_the_line_alive_twice_a_second);
    RUN_TEST(channels_nobody_configured_are_ignored);
    RUN_TEST(outputs_nobody_configured_are_not_driven);
    RUN_TEST(an_output_given_up_goes_to_the_plants_own_safe_value);
    RUN_TEST(a_measurement_the_plant_does_not_have_refuses_automatic);
    RUN_TEST(an_output_can_be_moved_by_hand_without_the_measurement_of_its_loop);
    RUN_TEST(a_measurement_in_another_unit_refuses_automatic);
    RUN_TEST(a_channel_without_a_unit_can_be_bound);
    RUN_TEST(a_read_back_that_differs_is_told);
    RUN_TEST(frames_with_any_bit_wrong_are_never_acted_on);
    RUN_TEST(noise_on_the_line_is_survived);
    RUN_TEST(a_sample_with_another_number_of_channels_is_refused);
    return UNITY_END();
}
