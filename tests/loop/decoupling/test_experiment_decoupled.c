/* From the kind `experiment` to a polynomial decoupler and controllers by pole placement: of fast samples, and designed on the board. */
#include "decoupler_design_bench.h"
#include "design/pole_placement.h"
#include "design/polynomial_decoupler.h"
#include "sample.h"

static struct difference_model kept_model(void)
{
    struct difference_model m = {.outputs = 2, .inputs = 2, .na = 4, .nb = 8, .period_s = 120};
    char name[24];
    for (unsigned i = 0; i < 2; i++) {
        for (unsigned k = 0; k < 4; k++) {
            snprintf(name, sizeof name, "block1.a%u_%u", i + 1, k + 1);
            m.a[i][k] = (real_t)setting_of(name);
        }
        for (unsigned at = 0; at < 16; at++) {
            snprintf(name, sizeof name, "block1.b%u%u_%u", i + 1, at / 8 + 1, at % 8 + 1);
            m.b[i][at / 8][at % 8] = (real_t)setting_of(name);
        }
    }
    return m;
}

static void find_model(unsigned tick_s, uint64_t seed)
{
    unsigned ticks = 120 / tick_s;
    unlike_lags.tick_ms = 1000 * tick_s;
    begin_case(&unlike_lags, seed, 20 * ticks);
    ask_ok("block 1 start");
    plant_steps(1000 * ticks);
    (void)until_over(1, 100 * ticks);
    TEST_ASSERT_EQUAL(DONE, stage_of(1));
    plant_steps(20);
}

/* ---- fast samples ---- */

static void a_decoupler_comes_of_every_base_tick_as_of_the_control_interval(void)
{
    static const unsigned tick_s[] = {120, 60, 30, 10};
    static struct polynomial_decoupler_work work;
    static struct polynomial_decoupler found;
    struct polynomial_decoupler_config config;
    struct polynomial_decoupler_refusal why;
    polynomial_decoupler_config_default(&config);
    for (uint64_t seed = 1; seed <= (sample_every_case ? 5 : 1); seed++)
        for (unsigned k = 0; k < sizeof tick_s / sizeof tick_s[0]; k++) {
            find_model(tick_s[k], seed);
            TEST_ASSERT_EQUAL(USABLE, (int)value_of(1, "verdict"));
            struct difference_model m = kept_model();
            enum err err = polynomial_decoupler_design(&m, &config, &work, &found, &why);
            TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, err, why.field);
            TEST_ASSERT_TRUE(found.recursive);
            plant_power_off();
        }
}

/* ---- designed on the board ---- */

static void assert_row(const char *format, unsigned i, const struct polynomial *p, unsigned from)
{
    char row[20];
    snprintf(row, sizeof row, format, i);
    for (unsigned k = 0; k < 8; k++) {
        double wanted = k + from < p->n ? (double)p->value[k + from] : 0;
        TEST_ASSERT_DOUBLE_WITHIN(1e-3 * (double)polynomial_size(p), wanted, nth_of_row(row, k));
    }
}

static void the_board_designs_what_the_host_does_from_the_same_model(void)
{
    static struct polynomial_decoupler_work work;
    static struct pole_placement_work placement;
    static struct polynomial_decoupler d;
    static struct pole_placement c;
    struct polynomial_decoupler_config config;
    struct pole_placement_goal goal;
    begin_with_model("set block1.adopt at_once", no_blocks);
    design();
    struct difference_model m = kept_model();
    m.nb = 8;
    for (unsigned i = 0; i < 2; i++)
        for (unsigned k = 0; k < 16; k++)
            m.b[i][k / 8][k % 8] *= (real_t)(i ? 10.0 / 6 : 10.0 / 4); /* of spans */
    polynomial_decoupler_config_default(&config);
    TEST_ASSERT_EQUAL(ERR_OK, polynomial_decoupler_design(&m, &config, &work, &d, NULL));
    for (unsigned k = 0; k < 4; k++)
        assert_row("block2.g.%u", k + 1, &d.g.value[k / 2][k % 2], 0);
    ask_ok("get block2.limits");
    TEST_ASSERT_TRUE(said("recurse"));
    pole_placement_goal_default(&goal);
    goal.settling_s = SETTLING;
    for (unsigned i = 0; i < 2; i++) {
        struct polynomial a = {.n = 5, .value = {1}};
        memcpy(&a.value[1], m.a[i], sizeof m.a[i]);
        TEST_ASSERT_EQUAL(ERR_OK,
                          pole_placement_design(&a, &d.h[i], 120, &goal, &placement, &c, NULL));
        assert_row("block%u.p.1", FIRST_RST + i, &c.p, 1);
        assert_row("block%u.q.1", FIRST_RST + i, &c.q, 0);
        assert_row("block%u.r.1", FIRST_RST + i, &c.r, 0);
    }
}

/* From the experiment to a step of a setpoint, no PC between them. */
static void the_loops_follow_their_setpoints_and_leave_each_other_alone(void)
{
    double most = 0, other = 0;
    find_model(60, 1);
    add_blocks(2, no_blocks);
    design();
    for (unsigned k = 1; k <= 2; k++)
        set_line("mode l%u auto", k, 0);
    plant_steps(120);
    ask_ok("sp l1 0.3");
    for (unsigned k = 0; k < 240; k++) {
        plant_step();
        most = fmax(most, truly("y1"));
        other = fmax(other, fabs(truly("y2")));
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.3, truly("y1"));
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.33, most);
    TEST_ASSERT_TRUE(other < 0.05); /* with K alone it would move by 0.37 */
}

static void each_block_is_proposed_and_accepted_by_itself(void)
{
    begin_with_model("set block1.adopt ask", no_blocks);
    design();
    static const char *const of[] = {"block2.g.2", "block3.q.1", "block4.q.1"};
    for (unsigned k = 0; k < 3; k++) {
        ask_ok("proposal");
        TEST_ASSERT_TRUE_MESSAGE(said(of[k]), board.said);
        ask_ok("proposal accept");
        plant_steps(3);
    }
    ask_ok("proposal");
    TEST_ASSERT_FALSE(said("proposes"));
}

/* Asks the indented lines of the page behind that heading. */
static void ask_page(const char *heading)
{
    char line[200];
    bool there = false, begun = false;
    FILE *page = fopen(PAGE, "r");
    TEST_ASSERT_NOT_NULL(page);
    while (fgets(line, sizeof line, page) && !(begun && strncmp(line, "    ", 4) != 0)) {
        line[strcspn(line, "\n")] = '\0';
        begun = there && strncmp(line, "    ", 4) == 0;
        if (begun)
            ask_ok(line + 4);
        there = there || strcmp(line, heading) == 0;
    }
    fclose(page);
    TEST_ASSERT_TRUE(there);
}

static void the_pages_example_designs_for_the_papers_column(void)
{
    plant_power_on("kotyk-column", 120000, 3, 1);
    ask_file(SCENARIOS "/kotyk-experiment.conf");
    plant_connect();
    plant_steps(2);
    static const char *const model[] = {"set block1.a1_1 -0.77722", "set block1.a2_1 -0.92017",
                                        "set block1.b11_1 0.03465", "set block1.b12_1 -0.01254",
                                        "set block1.b21_1 0.01578", "set block1.b22_1 -0.01833",
                                        "set block1.known on"};
    for (unsigned k = 0; k < sizeof model / sizeof model[0]; k++)
        ask_ok(model[k]);
    plant_steps(2);
    ask_page("### From the model to control");
    plant_steps(20);
    for (unsigned k = 0; k < 3; k++) {
        ask_ok("proposal accept");
        plant_steps(3);
    }
    TEST_ASSERT_TRUE(nth_of_row("block2.g.2", 0) > 0);
    TEST_ASSERT_TRUE(nth_of_row("block3.q.1", 1) < 0);
    TEST_ASSERT_TRUE(nth_of_row("block4.q.1", 1) > 0);
}

static void with_the_decoupler_rejected_no_controller_is_proposed(void)
{
    begin_with_model("set block1.adopt ask", no_blocks);
    design();
    ask_ok("proposal reject");
    plant_steps(3);
    ask_ok("proposal");
    TEST_ASSERT_FALSE(said("proposes"));
    TEST_ASSERT_EQUAL_DOUBLE(0, nth_of_row("block2.g.2", 0));
}

static void stop_withdraws_what_was_designed(void)
{
    begin_with_model("set block1.adopt ask", no_blocks);
    design();
    ask_ok("block 1 stop");
    plant_steps(3);
    ask_refused("proposal accept", "STATE");
}

static void of_one_loop_only_the_controller_is_designed(void)
{
    struct experiment_case one = unlike_lags;
    one.tick_ms = 120000;
    one.n = 1;
    one.lines[5] = "a1_1 -0.85";
    one.lines[7] = "b11_1 0.024";
    begin_case(&one, 1, 20);
    ask_ok("begin");
    ask_ok("set block1.known on");
    ask_ok("set block1.place.1 2");
    ask_ok("set block1.settling.1 3600");
    ask_ok("set block2.kind rst");
    ask_ok("set block2.loops l1");
    ask_ok("set block2.period 120");
    ask_ok("set block2.q.1 1,0,0,0,0,0,0,0");
    ask_ok("set block2.r.1 1,0,0,0,0,0,0,0");
    ask_ok("apply");
    plant_steps(2);
    design();
    double q = nth_of_row("block2.q.1", 0) + nth_of_row("block2.q.1", 1);
    TEST_ASSERT_TRUE(q > 0 && q != 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * q, q, nth_of_row("block2.r.1", 0));
}

static void other_settings_withdraw_what_was_designed(void)
{
    begin_with_model("set block1.adopt ask", no_blocks);
    design();
    ask_ok("set block1.settling.1 7200");
    plant_steps(3);
    ask_ok("proposal");
    TEST_ASSERT_FALSE(said("proposes"));
}

static void a_loop_of_another_period_keeps_its_controller(void)
{
    static const char *const faster[] = {"set loop1.divisor 1", "set block3.period 60", NULL};
    begin_with_model("set block1.adopt at_once", faster);
    design();
    ask_ok("events");
    TEST_ASSERT_TRUE_MESSAGE(said("PROPOSAL_REFUSED block3.period"), board.said);
    TEST_ASSERT_EQUAL_DOUBLE(1, nth_of_row("block3.q.1", 0));
    TEST_ASSERT_TRUE(nth_of_row("block4.q.1", 0) != 1);
}

/* ---- refused ---- */

static void assert_no_law(const char *words)
{
    design();
    ask_ok("events");
    TEST_ASSERT_TRUE(said("block1.no_law"));
    ask_ok("block 1");
    TEST_ASSERT_TRUE_MESSAGE(said(words), board.said);
    ask_ok("proposal");
    TEST_ASSERT_FALSE(said("proposes"));
}

static void what_cannot_be_designed_says_why(void)
{
    static const struct {
        const char *line, *words;
    } of[] = {{"set block1.b22_2 -0.05", "zero must be inside"},
              {"set block1.cutoff 0.5", "cutoff must be 0"},
              {"set block1.settling.2 0", "settling_s must be 2 to 200 periods; loop = 2"}};
    for (unsigned k = 0; k < sizeof of / sizeof of[0]; k++) {
        const char *const more[] = {of[k].line, NULL};
        begin_with_model("set block1.adopt ask", more);
        assert_no_law(of[k].words);
        plant_power_off();
        memory_port_erase_all();
    }
}

static void without_a_model_or_a_block_to_design_for_it_is_refused(void)
{
    unlike_lags.tick_ms = 60000;
    begin_case(&unlike_lags, 1, 20);
    for (unsigned k = 0; k < 2; k++) {
        design();
        ask_ok("events");
        TEST_ASSERT_TRUE_MESSAGE(said(k ? "no_model" : "BLOCK_REFUSED"), board.said);
        if (k == 0)
            add_blocks(2, no_blocks);
    }
}

static void law_names_a_block_of_one_of_the_two_kinds(void)
{
    unlike_lags.tick_ms = 60000;
    begin_case(&unlike_lags, 1, 20);
    add_blocks(2, no_blocks);
    ask_refused("set block1.law 3", "UNKNOWN");
}

int main(int argc, char **argv)
{
    sample_arguments(argc, argv);
    UNITY_BEGIN();
    RUN_TEST(a_decoupler_comes_of_every_base_tick_as_of_the_control_interval);
    RUN_TEST(the_board_designs_what_the_host_does_from_the_same_model);
    RUN_TEST(the_loops_follow_their_setpoints_and_leave_each_other_alone);
    RUN_TEST(each_block_is_proposed_and_accepted_by_itself);
    RUN_TEST(the_pages_example_designs_for_the_papers_column);
    RUN_TEST(with_the_decoupler_rejected_no_controller_is_proposed);
    RUN_TEST(stop_withdraws_what_was_designed);
    RUN_TEST(of_one_loop_only_the_controller_is_designed);
    RUN_TEST(other_settings_withdraw_what_was_designed);
    RUN_TEST(a_loop_of_another_period_keeps_its_controller);
    RUN_TEST(what_cannot_be_designed_says_why);
    RUN_TEST(without_a_model_or_a_block_to_design_for_it_is_refused);
    RUN_TEST(law_names_a_block_of_one_of_the_two_kinds);
    return UNITY_END();
}
