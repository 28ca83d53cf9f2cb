/* commission/adoption.[ch]: every bound of the trial, just inside of it and just outside. The measurement does what is written
 * here, whatever the output does. In the number format of the preset. */
#include <math.h>
#include <string.h>

#include "commission/adoption.h"
#include "commission/adoption_state.h"
#include "commission/origin_state.h"
#include "supervisor_bench.h"

#define REST     0.45
#define STEP     0.05 /* of the setpoint, fraction of span */
#define LASTS    200  /* samples of a step */
#define RISE     20   /* predicted: as long nothing happens, then it is at the setpoint */
#define LIMIT    0.2
#define RUN_MOST 2000

static struct adoption a;
static struct steady rest;
static struct origin operating;
static double noise_sd;

/* Error in units of the step, of samples from..to since the step, or since its way back. */
static struct {
    unsigned from, to;
    double error;
} part[4];
static bool on_the_way_back;
static unsigned blocked; /* samples of the step at the limit of the output */
static double foreseen;  /* error predicted for the last quarter, in units of the step */

void setUp(void)
{
    memset(part, 0, sizeof part);
    part[0].to = RISE;
    part[0].error = 1.0;
    on_the_way_back = false;
    blocked = 0;
    foreseen = 0.0;
    noise_sd = 0.0;
}
void tearDown(void) {}

static void loops(void)
{
    static const char *const pairs[] = {"loop1.action", "reverse", "loop1.gain", "0.0001",
                                        "loop1.ti",     "10000",   NULL};
    put_all(pairs);
}

static void begin(void)
{
    bench_start_with(loops);
    out(TOP, 5);
    for (int n = 0; n < 5; n++) {
        reading(0, 60.0 + 100.0 * REST);
        reading(1, 100.0);
        reading(T5, 110.0);
        validate();
        supervisor_control(&bench.s);
    }
    memset(&a, 0, sizeof a);
    operating = (struct origin){0};
    a.n = a.channels = 1;
    a.window = 48;
    a.back = 50;
    a.loop[0] =
        (struct adoption_loop){.step = (real_t)STEP, .duration_s = LASTS, .size = (real_t)STEP};
    a.loop[0].predicted.iae = (real_t)(STEP * RISE);
    a.loop[0].left = (real_t)(STEP * foreseen);
    a.channel[0] = (struct adoption_channel){.noise_sd = (real_t)noise_sd, .limit = (real_t)LIMIT};
    adoption_hold(&a, &bench.s);
    TEST_ASSERT_EQUAL_INT(ERR_OK, adoption_begin(&a, &bench.s, &operating, &rest));
}

/* Value of the measurement so many samples after the setpoint has gone away, or back. */
static double measured(bool away, unsigned since)
{
    double step = away ? STEP : -STEP, y = away ? REST + STEP : REST;
    for (unsigned k = 0; k < 4; k++)
        if ((k == 0 || away != on_the_way_back) && since >= part[k].from && since < part[k].to)
            y -= step * part[k].error;
    return y;
}

static enum adoption_result run(void)
{
    enum adoption_result r = ADOPTION_RUNNING;
    unsigned since = 0, left = blocked;
    bool away = false, back = false;
    begin();
    for (unsigned n = 0; r == ADOPTION_RUNNING && n < RUN_MOST; n++) {
        bool acts = bench.s.loop[TOP].mode == LOOP_AUTO;
        bool now = acts && setpoint_of(TOP) > REST + 0.5 * STEP;
        back = acts && (back || (away && !now));
        since = now != away ? 0 : since + 1;
        away = now;
        reading(0, 60.0 + 100.0 * (away || back ? measured(away, since) : REST));
        reading(1, 100.0);
        reading(T5, 110.0);
        validate();
        struct mv_config *o = &bench.plan[bench.current].config.mv[0];
        float max = o->max;
        if (away && left > 0) {
            o->max = 1.0f; /* below where it is held */
            left--;
        }
        r = adoption_tick(&a, &bench.s);
        o->max = max;
        supervisor_control(&bench.s);
    }
    return r;
}

static void as_predicted_it_passes(void)
{
    TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
    TEST_ASSERT_DOUBLE_WITHIN(0.06, 1.0, (double)a.loop[0].iae / (STEP * RISE));
}

static void an_overshoot_of_035_of_the_step_more_than_predicted_is_the_most(void)
{
    for (unsigned noisy = 0; noisy < 2; noisy++)
        for (unsigned predicted = 0; predicted < 2; predicted++)
            for (int side = -1; side <= 1; side += 2) {
                setUp();
                noise_sd = noisy ? 0.001 : 0.0;
                double most = 0.35 + 4.0 * noise_sd / STEP + 0.02 * side;
                part[1].from = 40;
                part[1].to = 43;
                part[1].error = -most;
                TEST_ASSERT_EQUAL_INT(side < 0 ? ADOPTION_PASSED : ADOPTION_OVERSHOOT, run());
                TEST_ASSERT_DOUBLE_WITHIN(0.005, most, (double)a.loop[0].peak);
            }
}

static void two_and_a_half_times_the_predicted_integral_is_the_most(void)
{
    part[0].to = 48;
    TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
    part[0].to = 53;
    TEST_ASSERT_EQUAL_INT(ADOPTION_SLOW, run());
}

static void a_mean_error_of_015_of_the_step_in_the_last_quarter_is_the_most(void)
{
    for (int sign = -1; sign <= 1; sign += 2)
        for (int side = -1; side <= 1; side += 2) {
            part[1].from = LASTS - LASTS / 4 - 1;
            part[1].to = LASTS + 1;
            part[1].error = sign * (0.15 + 0.01 * side);
            TEST_ASSERT_EQUAL_INT(side < 0 ? ADOPTION_PASSED : ADOPTION_RESTLESS, run());
        }
}

static void an_error_between_the_setpoint_and_the_one_predicted_is_no_unrest(void)
{
    static const struct {
        double foreseen, error;
        bool passes;
    } cases[] = {{0.4, 0.2, true},     {0.4, 0.54, true},    {0.4, 0.56, false},
                 {0.4, -0.14, true},   {0.4, -0.16, false},  {-0.16, -0.08, true},
                 {-0.16, 0.14, true},  {-0.16, 0.16, false}, {-0.16, -0.30, true},
                 {-0.16, -0.32, false}};
    part[1].from = LASTS - LASTS / 4 - 1;
    part[1].to = LASTS + 1;
    for (unsigned n = 0; n < sizeof cases / sizeof cases[0]; n++) {
        foreseen = cases[n].foreseen;
        part[1].error = cases[n].error;
        TEST_ASSERT_EQUAL_INT(cases[n].passes ? ADOPTION_PASSED : ADOPTION_RESTLESS, run());
    }
}

static void a_quarter_of_the_time_at_a_limit_of_the_output_is_the_most(void)
{
    blocked = LASTS / 4 - 2;
    TEST_ASSERT_EQUAL_INT(ADOPTION_PASSED, run());
    blocked = LASTS / 4 + 2;
    TEST_ASSERT_EQUAL_INT(ADOPTION_BLOCKED, run());
}

static void the_limit_and_four_noise_deviations_are_the_farthest(void)
{
    for (unsigned noisy = 0; noisy < 2; noisy++)
        for (int side = -1; side <= 1; side += 2) {
            noise_sd = noisy ? 0.001 : 0.0;
            double away = LIMIT + 4.0 * noise_sd + 0.001 * side;
            part[1].from = 30;
            part[1].to = 31;
            part[1].error = (away + STEP) / STEP; /* the other way than the step */
            TEST_ASSERT_EQUAL_INT(side < 0 ? ADOPTION_PASSED : ADOPTION_PAST_LIMIT, run());
        }
}

static void half_cycles_of_07_of_those_before_are_the_largest(void)
{
    for (unsigned back = 0; back < 2; back++)
        for (int side = -1; side <= 1; side += 2) {
            on_the_way_back = back != 0;
            part[1].from = RISE;
            part[1].to = part[2].from = 2 * RISE;
            part[2].to = part[3].from = 3 * RISE;
            part[3].to = 4 * RISE;
            part[1].error = -0.3;
            double ratio = 0.7 + 0.04 * side;
            part[2].error = 0.3 * ratio;
            part[3].error = -0.3 * ratio * ratio;
            TEST_ASSERT_EQUAL_INT(side < 0 ? ADOPTION_PASSED : ADOPTION_SWINGS, run());
            TEST_ASSERT_EQUAL_UINT8(side < 0 ? 1 : 0, a.turn);
        }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(as_predicted_it_passes);
    RUN_TEST(an_overshoot_of_035_of_the_step_more_than_predicted_is_the_most);
    RUN_TEST(two_and_a_half_times_the_predicted_integral_is_the_most);
    RUN_TEST(a_mean_error_of_015_of_the_step_in_the_last_quarter_is_the_most);
    RUN_TEST(an_error_between_the_setpoint_and_the_one_predicted_is_no_unrest);
    RUN_TEST(a_quarter_of_the_time_at_a_limit_of_the_output_is_the_most);
    RUN_TEST(the_limit_and_four_noise_deviations_are_the_farthest);
    RUN_TEST(half_cycles_of_07_of_those_before_are_the_largest);
    return UNITY_END();
}
