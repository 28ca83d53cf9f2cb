/* design/tuning.[ch], lti/fopdt.h.
 *
 * Contract
 *   every rule                2e-6 relative of the same rule in double (float32 in both builds), over gains
 *                             0.3, -2, 25, time constants 2 s to 1 h, dead time 0.05 to 3 of it
 *   published examples        to the digits printed
 *   refusals                  name the field and the range wanted, and leave the result alone
 */
#include <math.h>
#include <string.h>

#include "csv.h"
#include "design/tuning.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void near(double want, real_t got)
{
    TEST_ASSERT_DOUBLE_WITHIN(2e-6 * fabs(want), want, (double)got);
}

static void every_rule_agrees_with_double(void)
{
    FILE *f = csv_open("reference/tuning.csv");
    double v[15];
    int rows = 0;
    while (csv_row(f, v, 15)) {
        struct fopdt m = {(real_t)v[0], (real_t)v[1], (real_t)v[2]};
        struct tuning t;
        enum tuning_action action = v[0] > 0 ? TUNING_REVERSE : TUNING_DIRECT;
        TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_cohen_coon_pi(&m, &t, NULL));
        near(v[5], t.gain);
        near(v[6], t.ti_s);
        near(0.0, t.td_s);
        TEST_ASSERT_EQUAL_INT(action, t.action);
        TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_cohen_coon_pid(&m, &t, NULL));
        near(v[7], t.gain);
        near(v[8], t.ti_s);
        near(v[9], t.td_s);
        TEST_ASSERT_EQUAL_INT(action, t.action);
        TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_simc_pi(&m, (real_t)v[3], &t, NULL));
        near(v[10], t.gain);
        near(v[11], t.ti_s);
        near(0.0, t.td_s);
        TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_simc_pid(&m, (real_t)v[4], (real_t)v[3], &t, NULL));
        near(v[12], t.gain);
        near(v[13], t.ti_s);
        near(v[14], t.td_s);
        TEST_ASSERT_EQUAL_INT(action, t.action);
        rows++;
    }
    fclose(f);
    TEST_ASSERT_EQUAL_INT(36, rows);
}

/* Skogestad (2003), example E1: 1/((s+1)(0.2s+1)), half rule T = 1.1, theta = 0.1, tau_c = theta. */
static void the_simc_pi_settings_of_example_e1_are_reproduced(void)
{
    struct fopdt m = {1.0f, 0.1f, 1.1f};
    struct tuning t;
    TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_simc_pi(&m, 0.1f, &t, NULL));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 5.5f, t.gain);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.8f, t.ti_s);
}

/* Skogestad (2003), example E2: PI from T = 2.5, theta = 1.47; series PID from T = 2, T2 = 1.2, theta = 0.77,
 * printed as K = 1.30, Ti = 2, Td = 1.2; tau_c = theta. The ideal form is that series form multiplied out. */
static void the_simc_settings_of_example_e2_are_reproduced(void)
{
    struct fopdt pi_model = {1.0f, 1.47f, 2.5f}, pid_model = {1.0f, 0.77f, 2.0f};
    struct tuning t;
    TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_simc_pi(&pi_model, 1.47f, &t, NULL));
    TEST_ASSERT_FLOAT_WITHIN(0.005f, 0.85f, t.gain);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 2.5f, t.ti_s);
    TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_simc_pid(&pid_model, 1.2f, 0.77f, &t, NULL));
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 1.30f * 1.6f, t.gain);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 3.2f, t.ti_s);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.75f, t.td_s);
}

/* Dead time equal to the time constant: the fractions of the rule can be worked by hand. */
static void cohen_coon_at_equal_times_gives_the_fractions_of_the_rule(void)
{
    struct fopdt m = {-2.0f, 10.0f, 10.0f};
    struct tuning t;
    TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_cohen_coon_pi(&m, &t, NULL));
    near(59.0 / 120.0, t.gain); /* (9/10 + 1/12)/2 */
    near(10.0 * 33.0 / 29.0, t.ti_s);
    TEST_ASSERT_EQUAL_INT(TUNING_DIRECT, t.action);
    TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_cohen_coon_pid(&m, &t, NULL));
    near(19.0 / 24.0, t.gain); /* (4/3 + 1/4)/2 */
    near(10.0 * 38.0 / 21.0, t.ti_s);
    near(40.0 / 13.0, t.td_s);
}

static void simc_takes_a_model_without_dead_time_and_cohen_coon_says_why_not(void)
{
    struct fopdt m = {1.0f, 0.0f, 20.0f};
    struct tuning t = {7.0f, 7.0f, 7.0f, TUNING_DIRECT}, was = t;
    struct tuning_refusal reason;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, tuning_cohen_coon_pi(&m, &t, &reason));
    TEST_ASSERT_EQUAL_STRING("dead_time_s", reason.field);
    TEST_ASSERT_NOT_NULL(strstr(reason.wanted, "above 0"));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, tuning_cohen_coon_pid(&m, &t, &reason));
    TEST_ASSERT_EQUAL_STRING("dead_time_s", reason.field);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, tuning_simc_pi(&m, 0.0f, &t, &reason));
    TEST_ASSERT_EQUAL_STRING("tau_c_s", reason.field);
    TEST_ASSERT_EQUAL_MEMORY(&was, &t, sizeof t);
    TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_simc_pi(&m, 5.0f, &t, &reason));
    near(4.0, t.gain);
}

static void every_rule_refuses_a_model_that_cannot_be_tuned(void)
{
    const struct {
        struct fopdt model;
        enum err err;
        const char *field;
    } bad[] = {
        {{0.0f, 1.0f, 1.0f}, ERR_RANGE, "gain"},
        {{nanf(""), 1.0f, 1.0f}, ERR_NOT_FINITE, "gain"},
        {{HUGE_VALF, 1.0f, 1.0f}, ERR_NOT_FINITE, "gain"},
        {{1.0f, nanf(""), 1.0f}, ERR_NOT_FINITE, "dead_time_s"},
        {{1.0f, -1.0f, 1.0f}, ERR_RANGE, "dead_time_s"},
        {{1.0f, 2e6f, 1.0f}, ERR_RANGE, "dead_time_s"},
        {{1.0f, 1.0f, nanf("")}, ERR_NOT_FINITE, "time_constant_s"},
        {{1.0f, 1.0f, 0.0f}, ERR_RANGE, "time_constant_s"},
        {{1.0f, 1.0f, -3.0f}, ERR_RANGE, "time_constant_s"},
        {{1e-39f, 1e-3f, 1e6f}, ERR_RANGE, "gain"}, /* settings overflow */
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct tuning t = {7.0f, 7.0f, 7.0f, TUNING_DIRECT}, was = t;
        for (int rule = 0; rule < 4; rule++) {
            struct tuning_refusal reason = {"", ""};
            enum err err = ERR_OK;
            if (rule == 0)
                err = tuning_cohen_coon_pi(&bad[i].model, &t, &reason);
            else if (rule == 1)
                err = tuning_cohen_coon_pid(&bad[i].model, &t, &reason);
            else if (rule == 2)
                err = tuning_simc_pi(&bad[i].model, 1e-3f, &t, &reason);
            else
                err = tuning_simc_pid(&bad[i].model, 0.0f, 1e-3f, &t, &reason);
            TEST_ASSERT_EQUAL_INT(bad[i].err, err);
            TEST_ASSERT_EQUAL_STRING(bad[i].field, reason.field);
            TEST_ASSERT_TRUE(strlen(reason.wanted) > 3);
            TEST_ASSERT_EQUAL_MEMORY(&was, &t, sizeof t);
        }
    }
}

static void simc_refuses_bad_tuning_constants(void)
{
    struct fopdt m = {1.0f, 1.0f, 10.0f};
    struct tuning t;
    struct tuning_refusal reason;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, tuning_simc_pi(&m, nanf(""), &t, &reason));
    TEST_ASSERT_EQUAL_STRING("tau_c_s", reason.field);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, tuning_simc_pi(&m, -1.0f, &t, &reason));
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, tuning_simc_pid(&m, 11.0f, 1.0f, &t, &reason));
    TEST_ASSERT_EQUAL_STRING("tau2_s", reason.field);
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, tuning_simc_pid(&m, nanf(""), 1.0f, &t, &reason));
}

/* For k exp(-L s)/s, of which Ku = pi/(2 k L) and Pu = 4 L, the rule is quoted as K = 0.487/(k L), Ti = 8.75 L. */
static void tyreus_and_luyben_on_an_integrator_with_dead_time_agrees_with_its_other_form(void)
{
    double k = 0.05, dead = 7.0;
    struct tuning t;
    TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_tyreus_luyben_pi((real_t)(3.14159265 / 2.0 / k / dead),
                                                          (real_t)(4.0 * dead), &t, NULL));
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * 0.487 / k / dead, 0.487 / k / dead, (double)t.gain);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * 8.75 * dead, 8.75 * dead, (double)t.ti_s);
    TEST_ASSERT_EQUAL_INT(TUNING_REVERSE, t.action);
    TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_tyreus_luyben_pi(-3.2f, 10.0f, &t, NULL));
    near(1.0, t.gain);
    near(22.0, t.ti_s);
    near(0.0, t.td_s);
    TEST_ASSERT_EQUAL_INT(TUNING_DIRECT, t.action);
}

static void an_ultimate_point_that_is_none_is_refused(void)
{
    static const struct {
        real_t gain, period_s;
        enum err err;
        const char *field;
    } cases[] = {{(real_t)NAN, 1.0f, ERR_NOT_FINITE, "gain"},
                 {(real_t)INFINITY, 1.0f, ERR_NOT_FINITE, "gain"},
                 {0.0f, 1.0f, ERR_RANGE, "gain"},
                 {-1e7f, 1.0f, ERR_RANGE, "gain"},
                 {1.0f, (real_t)NAN, ERR_NOT_FINITE, "period_s"},
                 {1.0f, 0.0f, ERR_RANGE, "period_s"},
                 {1.0f, -1.0f, ERR_RANGE, "period_s"},
                 {1.0f, 1e7f, ERR_RANGE, "period_s"}};
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct tuning t = {.gain = 7.0f};
        struct tuning_refusal reason;
        TEST_ASSERT_EQUAL_INT(
            cases[i].err, tuning_tyreus_luyben_pi(cases[i].gain, cases[i].period_s, &t, &reason));
        TEST_ASSERT_EQUAL_STRING(cases[i].field, reason.field);
        TEST_ASSERT_EQUAL_FLOAT(7.0f, t.gain);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_rule_agrees_with_double);
    RUN_TEST(the_simc_pi_settings_of_example_e1_are_reproduced);
    RUN_TEST(the_simc_settings_of_example_e2_are_reproduced);
    RUN_TEST(cohen_coon_at_equal_times_gives_the_fractions_of_the_rule);
    RUN_TEST(simc_takes_a_model_without_dead_time_and_cohen_coon_says_why_not);
    RUN_TEST(every_rule_refuses_a_model_that_cannot_be_tuned);
    RUN_TEST(simc_refuses_bad_tuning_constants);
    RUN_TEST(tyreus_and_luyben_on_an_integrator_with_dead_time_agrees_with_its_other_form);
    RUN_TEST(an_ultimate_point_that_is_none_is_refused);
    return UNITY_END();
}
