/* From the kind `experiment` to a polynomial decoupler, at base ticks shorter than the control interval. */
#include "design/polynomial_decoupler.h"
#include "experiment_plant.h"
#include "sample.h"

/* Control every 120 s, at any base tick. */
static struct experiment_case unlike_lags = {DECOUPLING "/unlike-lags.json",
                                             120000,
                                             2,
                                             {"y1", "y2"},
                                             {"u1", "u2"},
                                             {"period 120", "adopt at_once", "bits 7", "clock 4",
                                              "amplitude.1 1", "amplitude.2 1", "band.1 0.8",
                                              "band.2 1.2"}};

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

int main(int argc, char **argv)
{
    sample_arguments(argc, argv);
    UNITY_BEGIN();
    RUN_TEST(a_decoupler_comes_of_every_base_tick_as_of_the_control_interval);
    return UNITY_END();
}
