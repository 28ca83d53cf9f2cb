/* Work of start-up that a tick waits for: with a plant that waits too, as in lockstep, and with one that does not. */
#include "commission_wood_berry.h"
#include "turn_bench.h"

static char expected[40000];

void setUp(void) {}
void tearDown(void) {}

static void keep_results(char *text)
{
    static const char *const listings[] = {"commission model", "commission pairing",
                                           "commission proposal"};
    text[0] = '\0';
    for (unsigned k = 0; k < 3; k++) {
        ask_ok(listings[k]);
        for (unsigned i = 0; i < n_reply; i++)
            strcat(text, reply[i]);
    }
}

/* As hardware does: n samples in their time, whether the board gets to answer or not. */
static void goes_on(unsigned n)
{
    unsigned before = board.commands;
    for (unsigned k = 0; k < n; k++) {
        struct frame f = measured();
        link_give(&f);
        advance();
    }
    board_run();
    TEST_ASSERT_EQUAL_MESSAGE(before + n, board.commands, "a sample was not answered");
}

static void a_plant_that_waits_notices_nothing_of_the_work(void)
{
    static char found[sizeof expected];
    unsigned waited = 0;
    wood_berry(NULL);
    proposal();
    keep_results(expected);
    wood_berry(NULL);
    ask_ok("commission begin");
    board_forget();
    for (unsigned n = 0; n < 3000 && !said("PROPOSAL"); n++)
        waited += waits_for_its_answer();
    TEST_ASSERT_TRUE(said("PROPOSAL"));
    TEST_ASSERT_TRUE_MESSAGE(waited > 2, "no sample ever met work under way");
    TEST_ASSERT_FALSE(said("JOB_LATE"));
    TEST_ASSERT_FALSE(said("SAMPLE_"));
    keep_results(found);
    TEST_ASSERT_EQUAL_STRING(expected, found);
}

static void one_that_goes_on_is_not_kept_waiting_and_the_work_is_late(void)
{
    wood_berry(NULL);
    ask_ok("commission begin");
    until("TEST_STEP R", 300);
    board_forget();
    for (unsigned n = 0; n < 500 && !said("TEST_DONE R"); n++)
        goes_on(6);
    TEST_ASSERT_TRUE(said("warning JOB_LATE start-up "));
    TEST_ASSERT_FALSE(said("SAMPLE_"));
    TEST_ASSERT_FALSE(said("COMMISSION_ENDED"));
    until("PROPOSAL", 3000);
    ask_ok("commission accept");
    until("TRIAL_KEPT", 4000);
}

/* To the first sample that waits; which one. */
static struct frame first_that_waits(void)
{
    ask_ok("commission begin");
    until("TEST_STEP R", 300);
    board_forget();
    struct frame f;
    unsigned before;
    do {
        f = measured();
        before = board.commands;
        link_give(&f);
        memory_port_turn();
        hear();
        if (board.commands != before)
            advance();
    } while (board.commands != before && board.number < 3000);
    TEST_ASSERT_EQUAL(before, board.commands);
    return f;
}

static void time_that_a_sample_waits_is_not_that_of_a_plant_that_sends_none(void)
{
    wood_berry(NULL);
    ask_ok("set tick.timeout 50");
    struct frame f = first_that_waits();
    unsigned before = board.commands, turns = 0;
    for (; board.commands == before && turns < 100000; turns++) {
        memory_port_set_clock(board.clock_ms += 2500);
        link_give(&f);
        memory_port_turn();
        hear();
    }
    TEST_ASSERT_TRUE(board.commands > before);
    TEST_ASSERT_TRUE(turns > 25); /* of 2.5 s */
    TEST_ASSERT_FALSE(said("SAMPLE_OVERDUE"));
    TEST_ASSERT_FALSE(said("SAFE_STATE"));
}

static void the_sample_that_waits_goes_with_a_plant_that_goes(void)
{
    wood_berry(NULL);
    (void)first_that_waits();
    unsigned before = board.commands;
    board.session++; /* another plant: the sample was not its own */
    plant_hello();
    memory_port_turn();
    plant_connect();
    TEST_ASSERT_EQUAL(before, board.commands);
    TEST_ASSERT_TRUE(said("SAFE_STATE"));
    plant_steps(2);
    TEST_ASSERT_TRUE(phase_is("ended"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_plant_that_waits_notices_nothing_of_the_work);
    RUN_TEST(one_that_goes_on_is_not_kept_waiting_and_the_work_is_late);
    RUN_TEST(time_that_a_sample_waits_is_not_that_of_a_plant_that_sends_none);
    RUN_TEST(the_sample_that_waits_goes_with_a_plant_that_goes);
    return UNITY_END();
}
