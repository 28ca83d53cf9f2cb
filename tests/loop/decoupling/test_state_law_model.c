/* From an experiment to a law of state feedback on the whole firmware: a plant of two lags is identified, the law found for its model is accepted, and
 * the loops are decoupled. What no law is found for says why. */
#include <math.h>

#include "plant_board.h"

#define TICK_MS 60000u

void setUp(void)
{
    memory_port_erase_all();
}
void tearDown(void)
{
    plant_power_off();
}

static void pasted(void)
{
    plant_power_on(DECOUPLING "/two-lags.json", TICK_MS, 3, 1);
    ask_file(DECOUPLING "/two-lags.conf");
    plant_connect();
    plant_steps(2);
    ask_ok("out one 0");
    ask_ok("out two 0");
    plant_steps(30);
    board_forget();
}

static void identified(void)
{
    pasted();
    ask_ok("block 3 start");
    for (unsigned k = 0; k < 800 && !(k % 50 == 49 && events_say("block3.model")); k++)
        plant_step();
    for (unsigned k = 0; k < 5; k++) {
        plant_step();
        pass(100);
    }
    ask_ok("get block3.known");
    TEST_ASSERT_TRUE_MESSAGE(said("block3.known = on"), board.said);
    board_forget();
}

static void adopted(void)
{
    ask_ok("block 3 design");
    plant_steps(6);
    ask_ok("proposal accept");
    for (unsigned k = 0; k < 4; k++) {
        plant_step();
        pass(100);
    }
    TEST_ASSERT_EQUAL_DOUBLE(60, setting_of("block1.made"));
}

/* F = B^-1 (M0 - A), G = B^-1 (1 - M0), of the plant itself; spans of 8 and 2. */
static void the_law_is_that_of_the_plant_as_far_as_its_model_is_the_plant(void)
{
    const double a[2] = {0.9, 0.85}, b[2][2] = {{0.08, 0.03}, {-0.02, 0.06}};
    const double pole[2] = {exp(-60.0 / 180), exp(-60.0 / 240)};
    double det = b[0][0] * b[1][1] - b[0][1] * b[1][0], off = 0, most = 0;
    const double inverse[2][2] = {{b[1][1] / det, -b[0][1] / det}, {-b[1][0] / det, b[0][0] / det}};
    identified();
    adopted();
    for (unsigned i = 1; i <= 2; i++)
        for (unsigned j = 1; j <= 2; j++) {
            char name[20];
            double unit = inverse[i - 1][j - 1] * 2 / 8, g = unit * (1 - pole[j - 1]);
            snprintf(name, sizeof name, "block1.g%u_%u", i, j);
            off = fmax(off, fabs(setting_of(name) - g));
            snprintf(name, sizeof name, "block1.f%u_%u", i, j);
            off = fmax(off, fabs(setting_of(name) - unit * (pole[j - 1] - a[j - 1])));
            most = fmax(most, fabs(g));
        }
    printf("law of the model: weights within %.2g of %.2g\n", off, most);
    TEST_ASSERT_TRUE(off < 0.05 * most);
}

static void the_loops_are_decoupled_by_it(void)
{
    identified();
    adopted();
    ask_ok("mode one auto");
    ask_ok("mode two auto");
    plant_steps(60);
    ask_ok("sp one 0.2");
    double most = 0;
    for (unsigned k = 0; k < 60; k++) {
        plant_step();
        most = fmax(most, fabs(truly("y2")));
    }
    printf("one steps by 0.2: two moves by %.4f at most\n", most);
    ask_ok("block 2");
    TEST_ASSERT_TRUE(said("block2 state on"));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.2, truly("y1"));
    TEST_ASSERT_TRUE(most < 0.02);
}

static void refused_with(const char *words)
{
    ask_ok("block 3 design");
    plant_steps(6);
    ask_ok("block 3");
    TEST_ASSERT_TRUE_MESSAGE(said(words), board.said);
    TEST_ASSERT_TRUE(events_say("block3.no_law"));
}

static void refused_for(unsigned loop, const char *words)
{
    char end[20];
    refused_with(words);
    ask_ok("block 3");
    snprintf(end, sizeof end, "; loop = %u\n", loop);
    TEST_ASSERT_TRUE_MESSAGE(said(end), board.said);
}

static void model_by_hand(void)
{
    static const char *const lines[] = {"begin",
                                        "set block3.a1_1 -0.9",
                                        "set block3.a2_1 -0.85",
                                        "set block3.b11_1 0.08",
                                        "set block3.b12_1 0.03",
                                        "set block3.b21_1 -0.02",
                                        "set block3.b22_1 0.06",
                                        "set block3.known on",
                                        "apply"};
    pasted();
    for (unsigned k = 0; k < sizeof lines / sizeof lines[0]; k++)
        ask_ok(lines[k]);
    plant_step();
}

static void a_model_of_higher_order_or_with_dead_time_is_refused_for_its_loop(void)
{
    model_by_hand();
    ask_ok("set block3.a2_2 0.1");
    refused_for(2, "no law: the model must be of first order without dead time");
    ask_ok("set block3.a2_2 0");
    ask_ok("set block3.b12_2 0.01");
    board_forget();
    refused_for(1, "no law: the model must be of first order without dead time");
}

static void inputs_that_do_the_same_are_refused(void)
{
    model_by_hand();
    ask_ok("set block3.b21_1 0.08");
    ask_ok("set block3.b22_1 0.03");
    refused_with("no law: b_star must be regular");
}

static void another_period_is_refused(void)
{
    model_by_hand();
    ask_ok("set block1.period 120");
    refused_with("no law: period must be that of the experiment");
}

static void without_a_model_or_a_block_for_the_law_the_verb_is_refused(void)
{
    pasted();
    ask_ok("block 3 design");
    plant_steps(2);
    TEST_ASSERT_TRUE_MESSAGE(events_say("BLOCK_REFUSED"), board.said);
    TEST_ASSERT_TRUE(said("no_model"));
    ask_ok("set block3.law 0");
    ask_ok("block 3 design");
    plant_steps(2);
    TEST_ASSERT_TRUE_MESSAGE(events_say("BLOCK_REFUSED law"), board.said);
}

static void another_goal_ends_it_and_other_applies_do_not(void)
{
    model_by_hand();
    ask_ok("block 3 design");
    plant_steps(5);
    ask_ok("set block1.tau.1 300,300");
    plant_steps(6);
    ask_ok("block 3");
    TEST_ASSERT_TRUE_MESSAGE(said("no law: settings must be left as they are"), board.said);
    ask_ok("block 3 design");
    plant_steps(2);
    ask_ok("set loop1.gain 0.4");
    plant_steps(6);
    ask_ok("proposal");
    TEST_ASSERT_TRUE_MESSAGE(said("block1.g1_1"), board.said);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_law_is_that_of_the_plant_as_far_as_its_model_is_the_plant);
    RUN_TEST(the_loops_are_decoupled_by_it);
    RUN_TEST(a_model_of_higher_order_or_with_dead_time_is_refused_for_its_loop);
    RUN_TEST(inputs_that_do_the_same_are_refused);
    RUN_TEST(another_period_is_refused);
    RUN_TEST(without_a_model_or_a_block_for_the_law_the_verb_is_refused);
    RUN_TEST(another_goal_ends_it_and_other_applies_do_not);
    return UNITY_END();
}
