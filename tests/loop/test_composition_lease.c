/* A Kalman filter on the pilot column (host_sim/scenarios/pilot-kalman.conf) and automatic start-up, who share one workspace, on the whole
 * firmware: who asks second is told so, and neither loses anything. And what an `apply`, a link that is unplugged, another plant, a reset and
 * time that stands still make of a filter whose covariance stands there. */
#include "app/app.h"
#include "base/workspace.h"
#include "commission_board.h"

#define OTHER   "covariances"
#define TICK_MS 10000u
#define BUSY    "err BUSY workspace: composition has it; `block N free` frees it"

static char expected[SAID_MAX];

void setUp(void)
{
    children_failed = 0;
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, children_failed, "cases of this test, see above");
}

static void outputs(void)
{
    ask_ok("out Lr 4.5");
    ask_ok("out Qrb 0.8");
}

static void configured(const char *const *lines)
{
    if (plant)
        plant_power_off();
    plant_power_on("pilot", TICK_MS, 1, 0.0);
    ask_file(PILOT_KALMAN_CONF);
    for (; lines && *lines; lines++)
        ask_ok(*lines);
    plant_connect();
    plant_steps(2);
    outputs();
}

static void filtering(const char *const *lines)
{
    configured(lines);
    plant_steps(150);
    board_forget();
}

static bool has_workspace(void)
{
    return value_of(2, "workspace") > 0;
}

/* Everything that the filter tells of itself. */
static void keep_estimates(char *text)
{
    ask_ok("block 2");
    strcpy(text, board.said);
    static const char *const points[] = {
        "x3_est = ", "x8_est = ", "xB_est = ", "xD_est = ", "T3_est = ", "T8_est = "};
    ask_ok("status");
    for (unsigned i = 0; i < 6; i++) {
        const char *at = strstr(board.said, points[i]);
        TEST_ASSERT_NOT_NULL(at);
        strncat(text, at, strcspn(at, "\n"));
    }
}

static void expect_estimates(void)
{
    static char found[SAID_MAX];
    keep_estimates(found);
    TEST_ASSERT_EQUAL_STRING(expected, found);
}

static void estimates_are_good(void)
{
    ask_ok("block 2");
    plant_steps(1);
    TEST_ASSERT_FALSE(said("bad"));
    TEST_ASSERT_FLOAT_WITHIN(0.05f, 0, value_of(2, "feed_1"));
    TEST_ASSERT_FLOAT_WITHIN(0.05f, 0, value_of(2, "feed_flow"));
    TEST_ASSERT_FLOAT_WITHIN(0.2f, 0, value_of(2, "e_3"));
}

/* ---- start-up ---- */

static void start_up_is_refused_in_words_and_the_filter_goes_on(void)
{
    filtering(NULL);
    TEST_ASSERT_TRUE(has_workspace());
    plant_steps(60);
    keep_estimates(expected);
    filtering(NULL);
    TEST_ASSERT_EQUAL_STRING(BUSY, ask("commission begin"));
    plant_steps(30);
    TEST_ASSERT_EQUAL_STRING(BUSY, ask("commission begin"));
    plant_steps(30);
    TEST_ASSERT_TRUE(phase_is("idle"));
    expect_estimates();
}

/* Points are uncertain without a workspace, and start-up wants good ones. */
static const char *const untested[] = {"begin",
                                       "set meas6.test off",
                                       "set meas7.test off",
                                       "set meas8.test off",
                                       "set meas9.test off",
                                       "set meas10.test off",
                                       "set meas11.test off",
                                       "apply",
                                       NULL};

static void given_free_start_up_runs_and_the_filter_takes_it_again_when_it_is_told(void)
{
    filtering(untested);
    ask_ok("block 2 free");
    plant_steps(2);
    TEST_ASSERT_TRUE(said("block2.lost"));
    TEST_ASSERT_FALSE(has_workspace());
    uint32_t cycles = (uint32_t)value_of(2, "cycles");
    ask_ok("commission begin");
    plant_steps(3);
    TEST_ASSERT_TRUE(phase_is("testing"));
    board_forget();
    type("block 2 take\n");
    plant_step();
    TEST_ASSERT_TRUE_MESSAGE(said("BLOCK_REFUSED") && said("start-up"), board.said);
    plant_steps(60);
    TEST_ASSERT_TRUE(phase_is("testing"));
    TEST_ASSERT_EQUAL(cycles, (uint32_t)value_of(2, "cycles"));
    TEST_ASSERT_FLOAT_WITHIN(0.2f, 0, value_of(2, "e_3")); /* the last gains */
    ask_ok("commission abort");
    plant_steps(3);
    TEST_ASSERT_FALSE(has_workspace());
    ask_ok("block 2 take");
    outputs();
    plant_steps(120);
    TEST_ASSERT_TRUE(has_workspace());
    TEST_ASSERT_TRUE((uint32_t)value_of(2, "cycles") > cycles + 100);
    estimates_are_good();
}

/* ---- somebody else ---- */

static void a_filter_that_finds_it_taken_says_so_and_takes_it_when_it_is_free(void)
{
    configured(NULL);
    struct workspace *w = app_workspace(app_instance());
    ask_ok("block 2 free");
    plant_steps(3);
    void *memory;
    TEST_ASSERT_EQUAL(ERR_OK, workspace_lease(w, OTHER, "covariances free", w->bytes, &memory));
    memset(memory, 0x5A, w->bytes);
    ask_ok("set block2.covariance band"); /* begins anew, and nothing is declined any more */
    board_forget();
    plant_steps(100);
    TEST_ASSERT_TRUE_MESSAGE(said("block2.lost 0"), board.said);
    TEST_ASSERT_EQUAL_FLOAT(0, value_of(2, "workspace"));
    TEST_ASSERT_EQUAL_FLOAT(0, value_of(2, "cycles"));
    for (uint32_t i = 0; i < w->bytes; i++)
        TEST_ASSERT_EQUAL(0x5A, ((uint8_t *)memory)[i]);
    workspace_frees(w, OTHER, NULL);
    plant_steps(150);
    TEST_ASSERT_TRUE(has_workspace());
    estimates_are_good();
}

static void the_block_taken_out_its_lease_ends_and_start_up_may_begin(void)
{
    filtering(NULL);
    static const char *const lines[] = {"begin", "set block2.kind -", NULL};
    for (unsigned i = 0; lines[i]; i++)
        ask_ok(lines[i]);
    for (unsigned i = 6; i <= 11; i++) {
        char line[40];
        snprintf(line, sizeof line, "set meas%u.name -", i);
        ask_ok(line);
    }
    ask_ok("apply");
    plant_steps(WORKSPACE_TICKS + 1);
    ask_ok("commission begin");
    plant_steps(3);
    TEST_ASSERT_TRUE(phase_is("testing"));
}

/* ---- apply ---- */

/* Loops and measurements have their states before those of blocks: all of them move. */
static const char *const more[] = {"begin",
                                   "set meas12.name more",
                                   "set meas12.unit %w",
                                   "set meas12.lo 0",
                                   "set meas12.hi 100",
                                   "set loop1.name top",
                                   "set loop1.pv T1",
                                   "set loop1.out Lr",
                                   "set loop1.ti 300",
                                   "apply",
                                   NULL};

static const char *const methods[] = {"geometric", "rekf", "ekf", "kalman"};
static const char *const covariances[] = {"full", "band", "steady"};

static void states_that_an_apply_moves_go_on_to_the_bit(void)
{
    char method[60], covariance[60], points[60];
    const char *lines[] = {"begin", method, covariance, points, "apply", NULL};
    snprintf(points, sizeof points, "set block2.cycle 50");
    for (unsigned m = 0; m < 4; m++)
        for (unsigned c = 0; c < (m < 2 ? 1u : 3u); c++)
            for (unsigned when = 150; when < 155; when += 2) {
                snprintf(method, sizeof method, "set block2.method %s", methods[m]);
                snprintf(covariance, sizeof covariance, "set block2.covariance %s", covariances[c]);
                configured(lines);
                plant_steps(when);
                plant_steps(60);
                keep_estimates(expected);
                configured(lines);
                plant_steps(when);
                for (unsigned i = 0; more[i]; i++)
                    ask_ok(more[i]);
                plant_steps(60);
                expect_estimates();
            }
}

/* ---- the plant ---- */

/* Work is under way: the next sample waits for it. */
static void in_the_midst_of_a_job(void)
{
    struct frame f;
    struct link_sample sample;
    unsigned before = board.commands;
    uint8_t byte;
    instruments_measure(&instruments, plant, TICK_MS / 1000.0, &sample);
    sample.number = ++board.number;
    sample.time_ms = board.time_ms;
    pack_sample(&sample, &f);
    link_give(&f);
    for (unsigned n = 0; n < 3; n++)
        memory_port_turn();
    while (memory_port_take(HAL_UART_LINK, &byte, 1))
        if (frame_decode(&board.decoder, byte, &f))
            plant_answers(&f);
    TEST_ASSERT_EQUAL(before + 1, board.commands);
    board.time_ms += TICK_MS;
}

static void silent_for(uint64_t ms)
{
    board.mute = true;
    pass(ms);
}

static void unplugged_in_the_midst_of_a_job_it_begins_anew_and_is_good_again(void)
{
    filtering(NULL);
    in_the_midst_of_a_job();
    silent_for(90000);
    board_forget();
    plant_connect();
    plant_steps(2);
    outputs();
    plant_steps(300);
    TEST_ASSERT_TRUE(has_workspace());
    estimates_are_good();
}

static void another_plant_finds_a_filter_that_begins_anew(void)
{
    filtering(NULL);
    in_the_midst_of_a_job();
    board.mute = true;
    pass(30000);
    board.session++;
    plant_connect();
    plant_steps(2);
    outputs();
    plant_steps(300);
    TEST_ASSERT_TRUE(has_workspace());
    estimates_are_good();
}

static void while_time_stands_still_the_filter_keeps_what_it_has(void)
{
    filtering(NULL);
    plant_steps(40);
    keep_estimates(expected);
    filtering(NULL);
    plant_steps(20);
    for (unsigned n = 0; n < 3000; n++)
        memory_port_turn();
    pass(3000);
    TEST_ASSERT_TRUE(has_workspace());
    plant_steps(20);
    expect_estimates();
}

static void after_a_reset_it_leases_it_again(void)
{
    filtering(NULL);
    ask_ok("out Qrb 0");
    plant_step();
    ask_ok("save");
    plant_steps(2);
    memory_port_reset(HAL_RESET_WATCHDOG);
    board.ready = false;
    board_run();
    type("mode machine\n");
    pass(1000);
    TEST_ASSERT_TRUE(board.ready);
    plant_steps(2);
    outputs();
    plant_steps(400);
    TEST_ASSERT_TRUE(has_workspace());
    estimates_are_good();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(start_up_is_refused_in_words_and_the_filter_goes_on);
    RUN_TEST(given_free_start_up_runs_and_the_filter_takes_it_again_when_it_is_told);
    RUN_TEST(a_filter_that_finds_it_taken_says_so_and_takes_it_when_it_is_free);
    RUN_TEST(the_block_taken_out_its_lease_ends_and_start_up_may_begin);
    RUN_TEST(states_that_an_apply_moves_go_on_to_the_bit);
    RUN_TEST(unplugged_in_the_midst_of_a_job_it_begins_anew_and_is_good_again);
    RUN_TEST(another_plant_finds_a_filter_that_begins_anew);
    RUN_TEST(while_time_stands_still_the_filter_keeps_what_it_has);
    RUN_TEST(after_a_reset_it_leases_it_again);
    return UNITY_END();
}
