/* commission/proposal_structure.c and trial_plan.c: inner loops and feedforwards in a proposal, and their part in a trial. What is
 * proposed when: test_analysis_structure.c; whatever is proposed is a configuration: test_proposal.c. */
#include <math.h>
#include <string.h>

#include "commission/proposal_structure.h"
#include "commission_space.h"
#include "plan/plan_build.h"
#include "supervise/arena.h"
#include "supervisor_bench.h"

static struct commission c;
static struct supervisor supervisor;
static struct config config;
static struct plan plan;
static struct config_fault fault;

static void element(unsigned i, unsigned j, double gain, double lag_s, double dead_s)
{
    struct fopdt *e = &c.work->analysis.plant.element[i][j];
    *e = (struct fopdt){
        .gain = (real_t)gain, .time_constant_s = (real_t)lag_s, .dead_time_s = (real_t)dead_s};
    c.work->element[i][j].found.shape.gain = e->gain;
    c.work->analysis.plant.gain_sd[i][j] = REAL_C(0.002);
}

static void channels(unsigned outputs, unsigned inputs)
{
    static const char *const all[] = {"meas1.name", "steam",  "meas1.lo", "-20", "meas1.hi", "180",
                                      "meas2.name", "heated", "meas2.lo", "20",  "meas2.hi", "120",
                                      "mv1.name",   "u1",     "mv1.hi",   "4",   "mv1.max",  "4",
                                      "mv2.name",   "u2",     "mv2.hi",   "4",   "mv2.max",  "4",
                                      NULL};
    memset(&bench, 0, sizeof bench);
    memset(&c, 0, sizeof c);
    commission_lease(&c);
    parameters_defaults(&bench.config);
    put_all(all);
    c.outputs.n = (uint8_t)outputs;
    c.inputs.n = (uint8_t)inputs;
    for (uint8_t i = 0; i < 2; i++) {
        c.outputs.measurement[i] = c.inputs.input[i].output = c.analysis_job.column[i] = i;
        c.inputs.input[i].rounds = 1;
        c.inputs.input[i].test_base = REAL_C(0.25);
    }
    c.work->analysis.plant.outputs = c.outputs.n;
    c.work->analysis.plant.inputs = c.inputs.n;
}

static void analyse(void)
{
    struct analysis_config settings = {.h_s = 2,
                                       .confidence = REAL_C(0.95),
                                       .floor = REAL_C(0.01),
                                       .step = REAL_C(0.05),
                                       .loops_max = CONFIG_LOOPS};
    c.outputs.channels = commission_channels(&bench.config);
    TEST_ASSERT_EQUAL_INT(ERR_OK, analysis_begin(&c.work->analysis, &settings));
    enum err err;
    while ((err = analysis_step(&c.work->analysis)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    c.status.phase = COMMISSION_READY;
    c.status.analysed = true;
    TEST_ASSERT_TRUE(commission_has_proposal(&c));
    config = bench.config;
}

static void writes(void)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_write(&c, &config));
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, plan_build(&plan, &config, 2.0f, &fault), fault.wanted);
}

static void cascade(void)
{
    channels(2, 1);
    element(0, 0, 1.5, 12, 3);
    element(1, 0, 0.9, 150, 20);
}

static void triangle(void)
{
    channels(2, 2);
    element(0, 0, 1.2, 80, 8);
    element(1, 0, 0.8, 100, 24);
    element(1, 1, -1.0, 70, 14);
    element(0, 1, 0, 0, 0);
}

void setUp(void) {}
void tearDown(void) {}

static void the_outer_loop_drives_the_inner_one_and_that_the_input(void)
{
    cascade();
    put("decouple1.d2", "0.5");
    analyse();
    writes();
    uint8_t outer = proposal_loop(&c, &config, 0), inner = proposal_inner_loop(&c, &config, 0);
    TEST_ASSERT_NOT_EQUAL(PLAN_NONE, outer);
    TEST_ASSERT_NOT_EQUAL(PLAN_NONE, inner);
    TEST_ASSERT_EQUAL_UINT8(inner, plan.loop[outer].inner);
    TEST_ASSERT_EQUAL_UINT8(0, plan.loop[inner].mv);
    TEST_ASSERT_EQUAL_STRING("heated", config.loop[outer].pv);
    TEST_ASSERT_EQUAL_STRING("steam", config.loop[inner].pv);
    TEST_ASSERT_EQUAL_FLOAT((float)c.work->analysis.layout.inner_tuning[0].gain,
                            config.loop[inner].own.gain);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, config.decoupler[0][1]);
    for (uint8_t i = 0; i < CONFIG_LOOPS; i++)
        TEST_ASSERT_TRUE(i == outer || i == inner || !config.loop[i].name[0]);
}

static void a_name_that_is_taken_gives_the_inner_loop_another(void)
{
    static const char *const pairs[] = {"loop1.name", "steam",    "loop1.pv", "heated", "loop1.out",
                                        "u2",         "loop1.ti", "50",       NULL};
    cascade();
    put_all(pairs);
    analyse();
    writes();
    uint8_t outer = proposal_loop(&c, &config, 0), inner = proposal_inner_loop(&c, &config, 0);
    TEST_ASSERT_EQUAL_STRING("A_u1", config.loop[inner].name);
    TEST_ASSERT_EQUAL_STRING("A_u1", config.loop[outer].out);
}

static void no_place_for_the_inner_loop_is_no_place_for_the_proposal(void)
{
    char name[24], value[24];
    cascade();
    for (unsigned i = 1; i < CONFIG_LOOPS; i++) {
        snprintf(name, sizeof name, "loop%u.name", i);
        snprintf(value, sizeof value, "l%u", i);
        put(name, value);
        snprintf(name, sizeof name, "loop%u.pv", i);
        put(name, "heated");
        snprintf(name, sizeof name, "loop%u.out", i);
        put(name, "u2");
    }
    analyse();
    TEST_ASSERT_EQUAL_INT(ERR_FULL, proposal_write(&c, &config));
}

static void a_trial_steps_the_outer_loop_no_farther_than_the_inner_one_may_go(void)
{
    for (double held = 0.02; held < 1; held += 0.16)
        for (double y = 0.05; y < 1; y += 0.15)
            for (double limit = 0.01; limit < 0.4; limit *= 3) {
                char text[24];
                cascade();
                snprintf(text, sizeof text, "%g", 200 * limit);
                put("meas1.test_limit", text);
                analyse();
                writes();
                memset(&supervisor, 0, sizeof supervisor);
                supervisor.plan = &plan;
                arena_place(&supervisor, &plan);
                supervisor.mv[0].manual = N(held);
                supervisor.measurement[0].value = N(y);
                supervisor.measurement[1].value = N(0.4);
                TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_prepare_trial(&c, &supervisor, &config));
                const struct adoption *t = &c.adoption;
                TEST_ASSERT_EQUAL_UINT8(1, t->n);
                TEST_ASSERT_EQUAL_UINT8(1, t->n_inner);
                TEST_ASSERT_EQUAL_UINT8(proposal_inner_loop(&c, &config, 0), t->loop[1].loop);
                double moved = (double)(t->loop[0].predicted.moved / t->loop[0].size) *
                               fabs((double)t->loop[0].step);
                TEST_ASSERT_TRUE((double)t->loop[0].step > 0);
                TEST_ASSERT_TRUE(moved <= 0.81 * fmin(limit, fmin(y, 1 - y)));
                double gain = fmax((double)c.work->analysis.layout.inner_tuning[0].gain, 1 / 1.5);
                TEST_ASSERT_TRUE(moved * gain <= 0.81 * fmin(held, 1 - held));
            }
}

/* Not a step of zero, or the other way: the trial divides by it, and then says what is wrong. */
static void without_room_a_step_is_the_smallest(void)
{
    static const double places[][2] = {
        {0.0, 0.5}, {-0.1, 0.5}, {1.0, 0.5}, {0.5, 0.0}, {0.5, -0.2}};
    for (unsigned i = 0; i < sizeof places / sizeof places[0]; i++) {
        cascade();
        analyse();
        writes();
        memset(&supervisor, 0, sizeof supervisor);
        supervisor.plan = &plan;
        arena_place(&supervisor, &plan);
        supervisor.mv[0].manual = N(places[i][0]);
        supervisor.measurement[0].value = N(places[i][1]);
        supervisor.measurement[1].value = N(0.4);
        TEST_ASSERT_EQUAL_INT(ERR_OK, proposal_prepare_trial(&c, &supervisor, &config));
        TEST_ASSERT_TRUE(c.adoption.loop[0].step > REAL_C(0.0));
        TEST_ASSERT_TRUE(c.adoption.loop[0].step < REAL_C(0.001));
    }
}

static void a_cascade_that_was_edited_away_has_no_trial(void)
{
    cascade();
    analyse();
    writes();
    supervisor.plan = &plan;
    strcpy(config.loop[proposal_loop(&c, &config, 0)].out, "u1");
    TEST_ASSERT_EQUAL_INT(ERR_UNKNOWN, proposal_prepare_trial(&c, &supervisor, &config));
}

static void a_feedforward_calls_for_nothing_where_the_input_was_held(void)
{
    triangle();
    put_all((const char *const[]){"ff1.from", "steam", "ff1.to", "u2", "ff1.gain", "0.3",
                                  "loop1.name", "old", "loop1.pv", "heated", "loop1.out", "u2",
                                  NULL});
    analyse();
    writes();
    const struct ff_config *f = &config.feedforward[0]; /* in place of the old one */
    TEST_ASSERT_EQUAL_STRING("u1", f->from);
    TEST_ASSERT_EQUAL_STRING("u2", f->to);
    TEST_ASSERT_TRUE(plan.feedforward[0].input & INPUT_IS_MV);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, f->reference);
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 0.8f, f->gain);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 8.0f, f->dead_s);
    TEST_ASSERT_EQUAL_STRING("", config.feedforward[1].from);
}

static void without_a_place_left_it_is_left_out(void)
{
    char name[24];
    triangle();
    put_all((const char *const[]){"mv3.name", "u3", "loop1.name", "side", "loop1.pv", "steam",
                                  "loop1.out", "u3", NULL});
    for (unsigned i = 1; i <= CONFIG_FEEDFORWARDS; i++) {
        snprintf(name, sizeof name, "ff%u.from", i);
        put(name, "heated");
        snprintf(name, sizeof name, "ff%u.to", i);
        put(name, "u3");
    }
    analyse();
    writes();
    for (unsigned i = 0; i < CONFIG_FEEDFORWARDS; i++)
        TEST_ASSERT_EQUAL_STRING("u3", config.feedforward[i].to);
}

static void an_input_with_the_name_of_a_measurement_is_not_fed_forward(void)
{
    triangle();
    put("meas3.name", "u1");
    analyse();
    writes();
    TEST_ASSERT_EQUAL_STRING("", config.feedforward[0].from);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_outer_loop_drives_the_inner_one_and_that_the_input);
    RUN_TEST(a_name_that_is_taken_gives_the_inner_loop_another);
    RUN_TEST(no_place_for_the_inner_loop_is_no_place_for_the_proposal);
    RUN_TEST(a_trial_steps_the_outer_loop_no_farther_than_the_inner_one_may_go);
    RUN_TEST(without_room_a_step_is_the_smallest);
    RUN_TEST(a_cascade_that_was_edited_away_has_no_trial);
    RUN_TEST(a_feedforward_calls_for_nothing_where_the_input_was_held);
    RUN_TEST(without_a_place_left_it_is_left_out);
    RUN_TEST(an_input_with_the_name_of_a_measurement_is_not_fed_forward);
    return UNITY_END();
}
