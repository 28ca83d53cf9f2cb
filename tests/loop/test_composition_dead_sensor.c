/* An estimator with three thermometers, of which one is dead when the board starts. The settings are those kept in
 * tests/reference/stored/splitter-estimate.bin. */
#include "plant_board.h"

void setUp(void)
{
    plant_flash_from(STORED_IMAGES "/splitter-estimate.bin");
    plant_power_on("splitter", 10000, 1, 0.0);
    pass(3000); /* without a plant the settings are read after 2 s */
}

void tearDown(void)
{
    plant_power_off();
}

/* The plant of this bench does not announce the feed's instruments. */
static void without_feed(void)
{
    static const char *const lines[] = {"begin",
                                        "set block3.inputs T30,T31,T33,R,Q",
                                        "set block3.is.4 reflux",
                                        "set block3.is.5 heat",
                                        "set block3.si.5 1162.22222,0",
                                        "set block3.is.6 pressure",
                                        "set block3.is.7 pressure",
                                        "apply"};
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++)
        ask_ok(lines[i]);
}

static float estimated(const char *name)
{
    char start[40];
    snprintf(start, sizeof start, "%s = ", name);
    ask_ok("status");
    const char *at = strstr(board.said, start);
    TEST_ASSERT_NOT_NULL(at);
    return strtof(at + strlen(start), NULL);
}

static void the_others_give_an_estimate(void)
{
    static const char *const dead[] = {"T31.dropout=1", "T31.nan=1", "T31.quality=2"};
    for (unsigned k = 0; k < 3; k++) {
        if (k) {
            tearDown();
            setUp();
        }
        without_feed();
        plant_event(dead[k]);
        plant_connect();
        plant_steps(2);
        ask_ok("out R 61.62");
        ask_ok("out bottom 4143.046");
        plant_steps(400);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(0.02f, (float)truly("iC4_D"), estimated("est_iC4"),
                                         dead[k]);
        ask_ok("alarm");
        TEST_ASSERT_TRUE_MESSAGE(said("MEASUREMENT_BAD T31"), board.said);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_others_give_an_estimate);
    return UNITY_END();
}
