/* Guards a promise to owners of stored sets: later firmware reads what earlier firmware stored. Here it is what firmware before the Kalman
 * filters stored of a `composition` block: the flash of a board with host_sim/scenarios/splitter-estimate.conf and
 * `set block3.noise 0.3`. reflux-host of revision 05e59d3 made tests/reference/stored/splitter-estimate.bin with --nvm, and what follows at
 * its end is erased. */
#include "plant_board.h"

void setUp(void)
{
    plant_flash_from(STORED_IMAGES "/splitter-estimate.bin");
    plant_power_on("splitter", 10000, 1, 0.0);
    pass(3000); /* without a plant it is read after 2 s */
}

void tearDown(void)
{
    plant_power_off();
}

static void has(const char *name, const char *value)
{
    char command[60];
    snprintf(command, sizeof command, "get block3.%s", name);
    ask_ok(command);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(reply[0], value), reply[0]);
}

static void stored_values_are_what_they_were(void)
{
    has("kind", "composition");
    has("method", "geometric");
    has("noise", "0.3");
    has("inputs", "T30,T31,T33,Fm,TFm,R,Q");
    has("place.3", "33,1");
    has("point.2", "23,0");
    has("si.7", "1162.22");
}

static void new_parameters_are_at_their_defaults(void)
{
    has("covariance", "full");
    has("cycle", "0");
    has("feed_z", "0.1");
    has("feed_f", "-1");
    has("feed_time", "3600");
    has("analyser", "0.0005");
    has("offset", "0.005");
    has("sure", "0");
    has("sure_part", "0.5");
    has("lasting", "0.25");
    has("nis_full", "4");
    has("of.1", "stage");
    TEST_ASSERT_FALSE(said("STORAGE_DAMAGED") || said("STORAGE_CLIPPED"));
}

static void and_saved_again_nothing_has_changed(void)
{
    static char before[SAID_MAX];
    ask_ok("dump");
    strcpy(before, board.said);
    ask_ok("save");
    pass(2000);
    memory_port_reset(HAL_RESET_POWER_ON);
    board_run();
    type("mode machine\n");
    pass(3000);
    ask_ok("dump");
    TEST_ASSERT_EQUAL_STRING(before, board.said);
}

static void estimates_well(void)
{
    ask_ok("status");
    const char *at = strstr(board.said, "est_iC4 = ");
    TEST_ASSERT_NOT_NULL(at);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, (float)truly("iC4_D"), strtof(at + 10, NULL));
}

static void it_estimates_and_becomes_a_filter_when_it_is_told(void)
{
    static const char *const without_feed[] = {/* which the plant of this bench does not announce */
                                               "begin",
                                               "set block3.inputs T30,T31,T33,R,Q",
                                               "set block3.is.4 reflux",
                                               "set block3.is.5 heat",
                                               "set block3.si.5 1162.22222,0",
                                               "set block3.is.6 pressure",
                                               "set block3.is.7 pressure",
                                               "apply",
                                               NULL};
    for (unsigned i = 0; without_feed[i]; i++)
        ask_ok(without_feed[i]);
    plant_connect();
    plant_steps(2);
    ask_ok("out R 61.62");
    ask_ok("out bottom 4143.046");
    plant_steps(400);
    estimates_well();
    ask_ok("begin");
    ask_ok("set block3.method ekf");
    ask_ok("set block3.covariance band");
    ask_ok("apply");
    plant_steps(400);
    ask_ok("block 3");
    TEST_ASSERT_TRUE_MESSAGE(said("  workspace = 1\n"), board.said);
    estimates_well();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(stored_values_are_what_they_were);
    RUN_TEST(new_parameters_are_at_their_defaults);
    RUN_TEST(and_saved_again_nothing_has_changed);
    RUN_TEST(it_estimates_and_becomes_a_filter_when_it_is_told);
    return UNITY_END();
}
