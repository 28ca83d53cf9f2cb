/* kinds/pid/pid.[ch]: closed loop on a first-order-plus-dead-time plant.
 *
 * Contract                                              float32       Q7.24
 *   output and measurement against the trajectory of
 *     the same loop in double (5 cases, reference/)     2e-6          2e-6
 *   at rest: peak to peak of the output                 4 steps of num_t, in both
 *   inhibitor, plant of gain 1, dead time 20 s, time
 *     constant 60 s, K = 1.5, Ti = 40 s, Tp = 30 s:
 *     overshoot of a setpoint step                      at most half of that without it, settled sooner
 */
#include <math.h>

#include "csv.h"
#include "fopdt_plant.h"
#include "pid_bench.h"

void setUp(void) {}
void tearDown(void) {}

/* Columns of reference/pid_cases.csv. */
enum {
    ID,
    GAIN,
    TI,
    TD,
    FILTER,
    B,
    C,
    TT,
    LO,
    HI,
    DIRECT,
    VELOCITY,
    H,
    STEPS,
    STRIDE,
    KP,
    TP,
    DELAY,
    R0,
    R1,
    U0,
    LOAD,
    COLUMNS
};

static struct pid_config case_config(const double *v)
{
    return (struct pid_config){
        .gain = (float)v[GAIN],
        .ti_s = (float)v[TI],
        .td_s = (float)v[TD],
        .n = (float)v[FILTER],
        .b = (float)v[B],
        .c = (float)v[C],
        .tt_s = (float)v[TT],
        .out_lo = (float)v[LO],
        .out_hi = (float)v[HI],
        .action = v[DIRECT] > 0 ? PID_DIRECT : PID_REVERSE,
        .form = v[VELOCITY] > 0 ? PID_VELOCITY : PID_POSITIONAL,
    };
}

static double worst_deviation(const double *v, FILE *trajectories)
{
    static struct fopdt_plant plant;
    struct pid pid = make_pid(case_config(v), (float)v[H]);
    fopdt_plant_init(&plant, v[KP], v[TP], (int)v[DELAY], v[H], v[U0], v[R0]);
    pid_follow(&pid, N(v[R0]), N(v[R0]), N(v[U0]));
    double worst = 0.0;
    int steps = (int)v[STEPS];
    for (int k = 0; k < steps; k++) {
        double r = k >= steps / 10 ? v[R1] : v[R0], load = k >= steps / 2 ? v[LOAD] : 0.0;
        double y = plant.y, u = tick(&pid, r, y);
        if (k % (int)v[STRIDE] == 0) {
            double want[4];
            TEST_ASSERT_EQUAL_INT(1, csv_row(trajectories, want, 4));
            TEST_ASSERT_TRUE((int)want[0] == (int)v[ID] && (int)want[1] == k);
            worst = fmax(worst, fmax(fabs(y - want[2]), fabs(u - want[3])));
        }
        fopdt_plant_step(&plant, u + load);
    }
    return worst;
}

static void the_loop_follows_the_trajectory_computed_in_double(void)
{
    FILE *cases = csv_open("reference/pid_cases.csv");
    FILE *trajectories = csv_open("reference/pid_trajectories.csv");
    double v[COLUMNS];
    int n = 0;
    for (; csv_row(cases, v, COLUMNS); n++) {
        double worst = worst_deviation(v, trajectories);
        printf("case %d: worst deviation %.2g\n", n, worst);
        TEST_ASSERT_TRUE(worst < 2e-6);
    }
    fclose(cases);
    fclose(trajectories);
    TEST_ASSERT_EQUAL_INT(5, n);
}

static void a_loop_at_rest_stays_at_rest(void)
{
    static struct fopdt_plant plant;
    for (int form = 0; form < 2; form++) {
        struct pid_config c = pid_default_config();
        c.gain = 1.2f;
        c.ti_s = 50.0f;
        c.td_s = 4.0f;
        c.form = (enum pid_form)form;
        struct pid pid = make_pid(c, 0.5f);
        fopdt_plant_init(&plant, 0.9, 60.0, 20, 0.5, 0.4, 0.5);
        pid_follow(&pid, N(0.5), N(0.5), N(0.4));
        double lowest = 2.0, highest = -2.0;
        for (int k = 0; k < 40000; k++) {
            double u = tick(&pid, 0.6180339, plant.y);
            fopdt_plant_step(&plant, u);
            if (k >= 20000) {
                lowest = fmin(lowest, u);
                highest = fmax(highest, u);
            }
        }
        printf("at rest: output moves %.2g steps of num_t\n", (highest - lowest) / NUM_STEP);
        TEST_ASSERT_TRUE(highest - lowest <= 4.0 * NUM_STEP);
        TEST_ASSERT_DOUBLE_WITHIN(3 * NUM_STEP, 0.6180339, plant.y);
    }
}

struct response {
    double overshoot; /* fraction of the setpoint step */
    double settled_s; /* last time outside 2 % of the step */
};

static struct response setpoint_step(float gain, float ti_s, float inhibit_s, double kp)
{
    static struct fopdt_plant plant;
    struct pid_config c = pid_default_config();
    c.gain = gain;
    c.ti_s = ti_s;
    c.inhibit_s = inhibit_s;
    c.action = kp < 0.0 ? PID_DIRECT : PID_REVERSE;
    c.out_lo = -1.0f;
    c.out_hi = 2.0f;
    struct pid pid = make_pid(c, 1.0f);
    fopdt_plant_init(&plant, kp, 60.0, 20, 1.0, 0.4, 0.5);
    pid_follow(&pid, N(0.5), N(0.5), N(0.4));
    struct response got = {0};
    for (int k = 0; k < 1500; k++) {
        double beyond = (plant.y - 0.6) / 0.1;
        got.overshoot = fmax(got.overshoot, beyond);
        if (fabs(beyond) > 0.02)
            got.settled_s = k;
        fopdt_plant_step(&plant, tick(&pid, 0.6, plant.y));
    }
    return got;
}

static void the_inhibitor_lessens_overshoot_and_still_settles_without_offset(void)
{
    const double signs[] = {1.0, -1.0};
    for (int i = 0; i < 2; i++) { /* the SIMC gain, with an integral time set too short */
        struct response without = setpoint_step(1.5f, 40.0f, 0.0f, signs[i]);
        struct response with = setpoint_step(1.5f, 40.0f, 30.0f, signs[i]);
        printf("overshoot %.3f -> %.3f, settled %g s -> %g s\n", without.overshoot, with.overshoot,
               without.settled_s, with.settled_s);
        TEST_ASSERT_TRUE(with.overshoot < 0.5 * without.overshoot);
        TEST_ASSERT_TRUE(with.settled_s <= without.settled_s);
    }
}

static void the_inhibitor_never_touches_the_proportional_part(void)
{
    struct pid_config c = pid_default_config();
    c.gain = 2.0f;
    c.inhibit_s = 50.0f;
    struct pid with = make_pid(c, 1.0f);
    c.inhibit_s = 0.0f;
    struct pid without = make_pid(c, 1.0f);
    pid_follow(&with, N(0.5), N(0.4), N(0.4));
    pid_follow(&without, N(0.5), N(0.4), N(0.4));
    for (int k = 0; k < 30; k++) {
        double y = 0.4 + 0.004 * k;
        TEST_ASSERT_TRUE(tick(&with, 0.5, y) == tick(&without, 0.5, y));
    }
}

static void the_inhibitor_holds_only_integration_towards_the_crossing(void)
{
    struct pid_config c = pid_default_config();
    c.ti_s = 10.0f;
    c.inhibit_s = 20.0f;
    const double directions[] = {1.0, -1.0};
    for (int i = 0; i < 2; i++) {
        double s = directions[i];
        struct pid pid = make_pid(c, 1.0f);
        pid_follow(&pid, N(0.5), N(0.5 - 0.1 * s), N(0.5));
        for (int k = 0; k < 20;
             k++) /* approaches by 0.004 a second: 0.08 within the prediction time */
            tick(&pid, 0.5, 0.5 + s * (-0.1 + 0.004 * k));
        TEST_ASSERT_TRUE(pid.inhibited); /* 0.02 before it, crossing ahead */
        tick(&pid, 0.5, 0.5 + s * 0.004);
        TEST_ASSERT_FALSE(pid.inhibited); /* beyond it: integration pulls back */
        pid_follow(&pid, N(0.5), N(0.5 - 0.1 * s), N(0.5));
        for (int k = 0; k < 20; k++)
            tick(&pid, 0.5, 0.5 - s * (0.1 + 0.004 * k));
        TEST_ASSERT_FALSE(pid.inhibited); /* moving away */
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_loop_follows_the_trajectory_computed_in_double);
    RUN_TEST(a_loop_at_rest_stays_at_rest);
    RUN_TEST(the_inhibitor_lessens_overshoot_and_still_settles_without_offset);
    RUN_TEST(the_inhibitor_never_touches_the_proportional_part);
    RUN_TEST(the_inhibitor_holds_only_integration_towards_the_crossing);
    return UNITY_END();
}
