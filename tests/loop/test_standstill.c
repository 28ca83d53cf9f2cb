/* A plant that is there and sends samples, but whose time does not move on as it announced: without a tick nobody
 * looks at the readings, so that must not last. And what is no such thing stays allowed. */
#include "board_bench.h"
#include "random_source.h"

/* T10 in automatic, with an interlock that the reading of `standing` is over. */
void setUp(void)
{
    running();
    ask_ok("begin");
    ask_ok("set lock1.meas T10");
    ask_ok("set lock1.mv heat");
    ask_ok("set lock1.limit 130");
    ask_ok("set lock1.value 0.1");
    ask_ok("apply");
    ask_ok("mode bottom auto");
    samples(3);
    TEST_ASSERT_FALSE(board.command.safe);
    board_forget();
}
void tearDown(void) {}

/* For so many ms of the board's clock the sample that is there comes again every `every` ms. */
static void sent_again(uint64_t ms, uint64_t every, bool renumbered)
{
    for (uint64_t end = board.clock_ms + ms; board.clock_ms < end;) {
        pass(every);
        board.number += renumbered;
        send_sample_again();
    }
}

static void is_safe_and_says_so(void)
{
    TEST_ASSERT_EQUAL(1, times_said(" alarm SAMPLE_STALLED "));
    TEST_ASSERT_EQUAL(1, times_said(" alarm SAFE_STATE plant_time "));
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_EQUAL(board.number, board.command.number);
    ask_ok("status");
    TEST_ASSERT_TRUE(said("state safe"));
    TEST_ASSERT_TRUE(said("stands still"));
    ask_ok("alarm");
    TEST_ASSERT_TRUE(
        said("SAFE_STATE loops in manual, outputs at safe values because of: plant_time"));
    TEST_ASSERT_TRUE(said("SAMPLE_STALLED samples arrive, but plant time does not advance"));
}

static void an_hour_of_samples_between_two_ticks_is_the_safe_state_after_six(void)
{
    board.values[1] = 150;
    sample_after(400);
    sent_again(4000, 1000, true);
    TEST_ASSERT_FALSE(board.command.safe);
    sent_again(1000, 1000, true);
    is_safe_and_says_so();
    TEST_ASSERT_EQUAL_FLOAT(0.1f, board.command.output[1].value); /* the interlock, not mv2.safe */
    board_forget();
    sent_again(3600000, 10000, true);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_FALSE(said("SAMPLE_")); /* once is enough */
    TEST_ASSERT_FALSE(said("SAFE_STATE"));
}

static void one_sample_sent_again_and_again_is_limited_by_the_clock(void)
{
    board.values[1] = 150;
    sample_after(400);
    sent_again(5500, 500, false);
    TEST_ASSERT_FALSE(board.command.safe);
    sent_again(500, 500, false);
    is_safe_and_says_so();
}

static void the_sample_of_the_last_tick_is_limited_likewise(void)
{
    sent_again(5500, 500, false);
    TEST_ASSERT_FALSE(board.command.safe);
    sent_again(500, 500, false);
    is_safe_and_says_so();
}

static void samples_far_apart_are_noticed_as_well(void)
{
    sample_after(400);
    sent_again(3600000, 60000, false);
    is_safe_and_says_so();
}

static void a_fast_base_tick_gets_two_seconds(void)
{
    board.session++;
    board.tick_ms = 100;
    board.time_ms = 0;
    plant_hello();
    board_run();
    samples(3);
    ask_ok("mode bottom auto");
    samples(3);
    board_forget();
    sent_again(1900, 100, false);
    TEST_ASSERT_FALSE(board.command.safe);
    sent_again(100, 100, false);
    is_safe_and_says_so();
}

static void as_many_early_samples_in_a_row_need_no_clock(void)
{
    ask_ok("set tick.miss_limit 3");
    samples(2);
    board_forget();
    for (unsigned n = 0; n < 3; n++)
        sample_after(100);
    TEST_ASSERT_FALSE(board.command.safe);
    sample_after(100);
    is_safe_and_says_so();
}

static void early_ones_are_counted_from_the_last_tick(void)
{
    for (unsigned n = 0; n < 50; n++) {
        sample_after(200);
        sample_after(300);
        sample_after(200);
        sample_after(300);
    }
    TEST_ASSERT_FALSE(board.command.safe);
    TEST_ASSERT_EQUAL(150, times_said("SAMPLE_EARLY"));
}

static void time_that_swings_between_early_and_back_is_no_way_around_it(void)
{
    for (unsigned n = 0; n < 3; n++) {
        sample_after(400);
        board.time_ms -= 800;
        sample_after(0);
        board.time_ms += 400;
    }
    is_safe_and_says_so();
}

static void when_time_goes_on_somebody_may_act_again(void)
{
    sample_after(400);
    sent_again(6000, 500, false);
    ask_refused("mode bottom auto", "STATE");
    TEST_ASSERT_TRUE(said("plant time stands still"));
    ask_refused("out bottom 1.5", "STATE");
    samples(2);
    TEST_ASSERT_TRUE(board.command.safe);
    ask_ok("alarm");
    TEST_ASSERT_FALSE(said("SAMPLE_STALLED"));
    TEST_ASSERT_TRUE(said("SAFE_STATE"));
    ask_ok("mode bottom auto");
    samples(1);
    TEST_ASSERT_FALSE(board.command.safe);
    ask_ok("alarm");
    TEST_ASSERT_FALSE(said("SAFE_STATE"));
}

static void what_was_asked_before_it_was_noticed_does_not_act(void)
{
    sample_after(400);
    sent_again(5000, 500, false);
    ask_ok("out top 5");
    sent_again(1000, 500, false);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, board.command.output[0].value);
}

/* ---- what stays allowed ---- */

static void a_sample_withheld_for_hours_between_two_repetitions_is_none(void)
{
    send_sample_again();
    pass(500);
    send_sample_again();
    pass(3600000); /* keep-alives */
    send_sample_again();
    pass(500);
    send_sample_again();
    samples(1);
    TEST_ASSERT_FALSE(board.command.safe);
    TEST_ASSERT_FALSE(said("STALLED"));
}

static void a_firmware_held_up_finds_many_repetitions_at_once(void)
{
    board.clock_ms += 1900;
    memory_port_set_clock(board.clock_ms);
    for (unsigned n = 0; n < 200; n++)
        send_sample_again();
    samples(1);
    TEST_ASSERT_FALSE(board.command.safe);
    TEST_ASSERT_FALSE(said("STALLED"));
}

static void a_plant_faster_or_slower_than_the_clock_is_none(void)
{
    for (unsigned n = 0; n < 200; n++) /* a thousand times as fast */
        samples(1);
    for (unsigned n = 0; n < 10; n++) { /* and a hundredth */
        samples(1);
        pass(100000);
    }
    for (unsigned n = 0; n < 10; n++) { /* the same, with a line that loses some commands */
        samples(1);
        pass(500);
        send_sample_again();
        pass(500);
        send_sample_again();
        pass(100000);
    }
    TEST_ASSERT_FALSE(board.command.safe);
    TEST_ASSERT_FALSE(said("STALLED"));
    TEST_ASSERT_FALSE(said("SAFE_STATE"));
}

static void time_set_back_by_less_than_is_borne_heals(void)
{
    board.time_ms -= 3500;
    samples(8);
    TEST_ASSERT_FALSE(board.command.safe);
    TEST_ASSERT_FALSE(said("STALLED"));
}

static void each_time_no_samples_come_for_too_long_is_told(void)
{
    ask_ok("set tick.timeout 1.5");
    samples(1);
    board_forget();
    pass(5000);
    TEST_ASSERT_EQUAL(1, times_said(" SAMPLE_OVERDUE "));
    samples(1);
    pass(5000);
    TEST_ASSERT_EQUAL(2, times_said(" SAMPLE_OVERDUE "));
}

/* ---- the borders ---- */

static void the_borders_of_early_late_and_missing_are_where_the_page_says(void)
{
    static const struct {
        uint64_t after_ms;
        const char *event;
    } at[] = {{874, " SAMPLE_EARLY "},
              {875, NULL},
              {1000, NULL},
              {1125, NULL},
              {1126, " SAMPLE_LATE "},
              {1499, " SAMPLE_LATE "},
              {1500, " SAMPLE_MISSING - 1 "},
              {2499, " SAMPLE_MISSING - 1 "},
              {2500, " SAMPLE_MISSING - 2 "},
              {6499, " SAMPLE_MISSING - 5 "}};
    for (unsigned i = 0; i < sizeof at / sizeof at[0]; i++) {
        samples(1);
        board_forget();
        sample_after(at[i].after_ms);
        TEST_ASSERT_EQUAL_MESSAGE(at[i].event != NULL, said(" SAMPLE_"), board.said);
        TEST_ASSERT_TRUE_MESSAGE(!at[i].event || said(at[i].event), board.said);
        TEST_ASSERT_FALSE(board.command.safe);
        sample_after(2000 - at[i].after_ms % 1000);
    }
    sample_after(6500);
    TEST_ASSERT_TRUE(board.command.safe);
}

/* ---- at random ---- */

/* Whatever plant time does: samples with other numbers make a tick at the latest when miss_limit + 1 have come, and the
 * answer bears the number of what it answers. */
static void whatever_plant_time_does_there_is_a_tick_now_and_then(void)
{
    struct random_source r = {0x57A11};
    char message[80];
    uint32_t before = tick_count();
    ask_ok("log on");
    board_forget();
    unsigned without = 0;
    for (unsigned n = 0; n < 3000; n++) {
        static const int64_t steps[] = {0,    1,     -1,         400,         -400, 874,
                                        875,  1000,  1000,       1125,        1499, 1500,
                                        7000, -7000, 5000000000, -5000000000, 1000};
        int64_t step = steps[random_below(&r, sizeof steps / sizeof steps[0])];
        if (random_below(&r, 4) == 0)
            step = (int64_t)random_below(&r, 4000) - 2000;
        int64_t time = (int64_t)board.time_ms + step;
        board.time_ms = time < 0 ? 0 : (uint64_t)time;
        if (random_below(&r, 300) == 0)
            board.time_ms = random_below(&r, 2) ? UINT64_MAX - random_below(&r, 3000) : 0;
        board.number++;
        board_forget();
        send_sample_again();
        snprintf(message, sizeof message, "seed 0x57A11, sample %u, step %lld", n, (long long)step);
        TEST_ASSERT_EQUAL_MESSAGE(board.number, board.command.number, message);
        without = said("T,") ? 0 : without + 1;
        TEST_ASSERT_TRUE_MESSAGE(without <= 5, message);
    }
    TEST_ASSERT_TRUE(tick_count() - before > 500);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_hour_of_samples_between_two_ticks_is_the_safe_state_after_six);
    RUN_TEST(one_sample_sent_again_and_again_is_limited_by_the_clock);
    RUN_TEST(the_sample_of_the_last_tick_is_limited_likewise);
    RUN_TEST(samples_far_apart_are_noticed_as_well);
    RUN_TEST(a_fast_base_tick_gets_two_seconds);
    RUN_TEST(as_many_early_samples_in_a_row_need_no_clock);
    RUN_TEST(early_ones_are_counted_from_the_last_tick);
    RUN_TEST(time_that_swings_between_early_and_back_is_no_way_around_it);
    RUN_TEST(when_time_goes_on_somebody_may_act_again);
    RUN_TEST(what_was_asked_before_it_was_noticed_does_not_act);
    RUN_TEST(a_sample_withheld_for_hours_between_two_repetitions_is_none);
    RUN_TEST(a_firmware_held_up_finds_many_repetitions_at_once);
    RUN_TEST(a_plant_faster_or_slower_than_the_clock_is_none);
    RUN_TEST(time_set_back_by_less_than_is_borne_heals);
    RUN_TEST(each_time_no_samples_come_for_too_long_is_told);
    RUN_TEST(the_borders_of_early_late_and_missing_are_where_the_page_says);
    RUN_TEST(whatever_plant_time_does_there_is_a_tick_now_and_then);
    return UNITY_END();
}
