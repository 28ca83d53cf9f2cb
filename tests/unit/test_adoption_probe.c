/* commission/adoption.[ch] with supervise/: the margin probe of a trial, on one loop of a first order with dead time. The gain that the
 * loop can bear is known: a proportional and integral controller that cancels the lag leaves an integrator with dead time. */
#include <math.h>
#include <string.h>

#include "commission/adoption.h"
#include "commission/adoption_state.h"
#include "commission/origin_state.h"
#include "fopdt_plant.h"
#include "supervise/raise_gain.h"
#include "supervisor_bench.h"

#define REST   0.45
#define STEP   0.04
#define LASTS  260 /* samples of a step */
#define BACK   400 /* samples until a response is over */
#define LAG_S  60.0
#define DEAD_S 10
#define GAIN   2.5 /* of the controller */
#define BEARS                                                                                      \
    9.04 /* plant gain times controller gain at which the loop is no longer stable: 2 sin(pi / 42) times LAG_S */
#define RAISE 1.5f

static struct adoption a;
static struct steady rest;
static struct origin operating;
static struct fopdt_plant plant;
static struct trial_probe probe;
static enum adoption_result result;
static double before; /* output of the sample before */

static void loops(void)
{
    static const char *const pairs[] = {"loop1.action", "reverse", "loop1.gain", "2.5",
                                        "loop1.ti",     "60",      NULL};
    put_all(pairs);
}

static void sample(void)
{
    reading(0, 60.0 + 100.0 * (REST + plant.y));
    reading(1, 100.0);
    reading(T5, 110.0);
    validate();
}

static void go_on(void)
{
    before = sent(TOP);
    supervisor_control(&bench.s);
    fopdt_plant_step(&plant, sent(TOP));
}

/* margin: factor on the controller's gain at which the loop would be unstable. */
static void begin(double margin)
{
    bench_start_with(loops);
    fopdt_plant_init(&plant, BEARS / margin / GAIN, LAG_S, DEAD_S, 1.0, 0.5, 0.0);
    out(TOP, 5);
    for (int n = 0; n < 5; n++) {
        sample();
        go_on();
    }
    memset(&a, 0, sizeof a);
    operating = (struct origin){0};
    a.n = a.channels = 1;
    a.window = 48;
    a.back = BACK;
    a.loop[0] = (struct adoption_loop){
        .loop = TOP, .step = (real_t)STEP, .duration_s = LASTS, .size = (real_t)STEP};
    a.loop[0].predicted.iae = 100; /* the probe alone is to judge here */
    a.loop[0].predicted.peak = 2;
    a.channel[0] = (struct adoption_channel){.limit = REAL_C(0.2)};
    probe = (struct trial_probe){.planned = true};
    adoption_probe_with(&a, &probe);
    adoption_hold(&a, &bench.s);
    TEST_ASSERT_EQUAL_INT(ERR_OK, adoption_begin(&a, &bench.s, &operating, &rest));
    result = ADOPTION_RUNNING;
}

/* As commission_tick() does it. */
static void one_tick(void)
{
    sample();
    result = adoption_tick(&a, &bench.s);
    bool goes_on = result == ADOPTION_RUNNING;
    supervisor_raise_gain(&bench.s, goes_on ? adoption_raised(&a) : PLAN_NONE, RAISE);
    go_on();
}

static enum adoption_result run(void)
{
    for (unsigned n = 0; result == ADOPTION_RUNNING && n < 5000; n++)
        one_tick();
    return result;
}

/* Goes on until the setpoint is away, or is back. */
static void go_to(bool away)
{
    for (unsigned n = 0; (setpoint_of(TOP) > REST + 0.5 * STEP) != away; n++) {
        TEST_ASSERT_TRUE(n < 2000);
        one_tick();
        TEST_ASSERT_EQUAL_INT(ADOPTION_RUNNING, result);
    }
}

/* Change of the output for a change of the setpoint: the gain of the controller. */
static double gain_of_this_step(void)
{
    return (sent(TOP) - before) / STEP;
}

void setUp(void) {}
void tearDown(void) {}

static void the_way_back_is_made_with_the_raised_gain_and_the_rest_is_not(void)
{
    begin(4.0);
    go_to(true);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, GAIN, gain_of_this_step());
    go_to(false);
    TEST_ASSERT_DOUBLE_WITHIN(0.15, -(double)RAISE * GAIN, gain_of_this_step());
    TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
    for (int n = 0; n < 3; n++) {
        sample();
        go_on();
    }
    setpoint(TOP, 60.0 + 100.0 * (REST + STEP));
    sample();
    go_on();
    TEST_ASSERT_DOUBLE_WITHIN(0.15, GAIN, gain_of_this_step());
}

static void the_output_does_not_move_where_the_gain_changes(void)
{
    begin(4.0);
    go_to(true);
    double largest = 0.0;
    for (unsigned n = 0; n < LASTS / 2; n++)
        one_tick();
    while (setpoint_of(TOP) > REST + 0.5 * STEP) {
        double move = fabs(sent(TOP) - before);
        largest = move > largest ? move : largest;
        one_tick();
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * GAIN * STEP, 0.0, largest);
}

static void a_loop_with_more_margin_than_the_probe_passes(void)
{
    static const double margins[] = {1.8, 2.0, 4.0};
    for (unsigned n = 0; n < sizeof margins / sizeof margins[0]; n++) {
        begin(margins[n]);
        TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
    }
}

static void a_loop_with_less_margin_than_the_probe_is_found_by_it_alone(void)
{
    begin(1.45);
    probe.planned = false;
    TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
    begin(1.45);
    TEST_ASSERT_EQUAL_INT(ADOPTION_MARGIN, run());
    TEST_ASSERT_EQUAL_UINT8(0, a.culprit);
    TEST_ASSERT_TRUE(!(bench.s.raised.factor > 0.0f));
}

static void the_probe_ends_at_the_first_sign(void)
{
    begin(1.2);
    a.loop[0].predicted.peak = 9;
    go_to(true);
    probe.planned = true;
    while (bench.s.loop[TOP].mode == LOOP_AUTO && result == ADOPTION_RUNNING)
        one_tick();
    TEST_ASSERT_TRUE(!(bench.s.raised.factor > 0.0f));
    TEST_ASSERT_TRUE(a.stage_ticks > a.ticks);
}

static void an_error_that_stays_with_the_raised_gain_fails_the_probe(void)
{
    for (int side = -1; side <= 1; side += 2) {
        begin(4.0);
        go_to(true);
        go_to(false);
        while (a.ticks < a.stage_ticks - a.stage_ticks / 4u)
            one_tick();
        double y = plant.y, error = (0.5 + 0.02 * side) * STEP;
        while (result == ADOPTION_RUNNING && margin_probe_is_raised(&a.probe)) {
            plant.y = error; /* held there */
            one_tick();
        }
        plant.y = y;
        TEST_ASSERT_EQUAL_INT(side < 0 ? ADOPTION_PASSED : ADOPTION_MARGIN, run());
    }
}

static void a_plant_that_has_moved_by_itself_is_probed_again_by_a_step_away(void)
{
    begin(1.45);
    go_to(true);
    go_to(false);
    while (bench.s.loop[TOP].mode == LOOP_AUTO)
        one_tick();
    TEST_ASSERT_TRUE(!(bench.s.raised.factor > 0.0f));
    plant.offset_y += 0.02; /* it rests elsewhere */
    double peak = (double)a.loop[0].peak;
    while (bench.s.loop[TOP].mode != LOOP_AUTO)
        one_tick();
    while (setpoint_of(TOP) < REST + 0.02 + 0.5 * STEP)
        one_tick();
    TEST_ASSERT_DOUBLE_WITHIN(0.15, (double)RAISE * GAIN, gain_of_this_step());
    TEST_ASSERT_EQUAL_INT(ADOPTION_MARGIN, run());
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, peak, (double)a.loop[0].peak); /* of the accepted gain */
}

static void a_plant_that_drifts_is_not_probed(void)
{
    begin(4.0);
    a.drifting = true;
    for (unsigned n = 0; result == ADOPTION_RUNNING && n < 5000; n++) {
        one_tick();
        TEST_ASSERT_TRUE(!(bench.s.raised.factor > 0.0f));
    }
    TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, result);
}

static void other_settings_end_a_raised_gain(void)
{
    begin(4.0);
    go_to(true);
    go_to(false);
    TEST_ASSERT_TRUE(bench.s.raised.factor > 0.0f);
    supervisor_take_plan(&bench.s, bench.s.plan);
    TEST_ASSERT_TRUE(!(bench.s.raised.factor > 0.0f));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_way_back_is_made_with_the_raised_gain_and_the_rest_is_not);
    RUN_TEST(the_output_does_not_move_where_the_gain_changes);
    RUN_TEST(a_loop_with_more_margin_than_the_probe_passes);
    RUN_TEST(a_loop_with_less_margin_than_the_probe_is_found_by_it_alone);
    RUN_TEST(the_probe_ends_at_the_first_sign);
    RUN_TEST(an_error_that_stays_with_the_raised_gain_fails_the_probe);
    RUN_TEST(a_plant_that_has_moved_by_itself_is_probed_again_by_a_step_away);
    RUN_TEST(a_plant_that_drifts_is_not_probed);
    RUN_TEST(other_settings_end_a_raised_gain);
    return UNITY_END();
}
