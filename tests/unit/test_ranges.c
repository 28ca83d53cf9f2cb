/* Arguments of interaction analysis and of design at the ends of their ranges. */
#include <string.h>

#include "design/detune.h"
#include "design/static_decoupler.h"
#include "design/trial.h"
#include "interact/cascade.h"
#include "interact/gains.h"
#include "interact/pairing.h"
#include "interact/structure.h"
#include "ranges.h"

void setUp(void) {}
void tearDown(void) {}

/* ---- a plant of two loops that do not disturb each other ---- */

static struct interact_plant plant;
static struct loops loops;

static void make_plant(void)
{
    memset(&plant, 0, sizeof plant);
    plant.outputs = plant.inputs = 2;
    for (unsigned k = 0; k < 2; k++)
        plant.element[k][k] = (struct fopdt){REAL_C(1.0), REAL_C(2.0), REAL_C(20.0)};
    memset(&loops, 0, sizeof loops);
    loops.pairs = (struct pairs){2, {0, 1}, {0, 1}};
    loops.interval_s = REAL_C(1.0);
    loops.derivative_filter = REAL_C(8.0);
    for (unsigned k = 0; k < 2; k++)
        loops.tuning[k] = (struct tuning){.gain = REAL_C(1.0), .ti_s = REAL_C(20.0)};
}

static enum err try_plant(void)
{
    return interact_check(&plant, NULL);
}

static void of_a_plant(void)
{
    static const struct range ranges[] = {
        RANGE(interact_plant, element[1][0].gain, -1e9, 1e9),
        RANGE(interact_plant, element[0][1].dead_time_s, 0, 1e6),
        RANGE(interact_plant, element[1][1].time_constant_s, 0, 1e6),
        RANGE(interact_plant, gain_sd[1][1], 0, 1e9),
    };
    make_plant();
    CHECK(plant, ranges, try_plant);
    for (unsigned n = 0; n <= INTERACT_MAX + 1u; n++) {
        bool good = n >= 1 && n <= INTERACT_MAX;
        plant.outputs = (uint8_t)n;
        TEST_ASSERT_EQUAL(good ? ERR_OK : ERR_RANGE, try_plant());
        plant.outputs = 2;
        plant.inputs = (uint8_t)n;
        TEST_ASSERT_EQUAL(good ? ERR_OK : ERR_RANGE, try_plant());
        plant.inputs = 2;
    }
}

static enum err try_loops(void)
{
    return loops_check(&plant, &loops, NULL);
}

static void of_loops(void)
{
    static const struct range ranges[] = {
        RANGE(loops, interval_s, 1e-3, 1e5),     RANGE(loops, derivative_filter, 1, 100),
        RANGE(loops, tuning[1].gain, 1e-9, 1e9), RANGE(loops, tuning[1].ti_s, 1e-3, 1e7),
        RANGE(loops, tuning[1].td_s, 0, 1e6),
    };
    make_plant();
    CHECK(loops, ranges, try_loops);
}

static struct nyquist nyquist;

static void of_a_stability_curve(void)
{
    static const struct {
        double times, limit_db;
        bool good;
    } cases[] = {{0.01, 6, true}, {0.00999, 6, false}, {100, 6, true},  {100.1, 6, false},
                 {1, 0, false},   {1, -1, false},      {1, 1e-6, true}, {1, INFINITY, true},
                 {1, NAN, false}, {NAN, 6, false}};
    make_plant();
    for (unsigned k = 0; k < sizeof cases / sizeof cases[0]; k++)
        TEST_ASSERT_EQUAL(cases[k].good ? ERR_OK : ERR_RANGE,
                          nyquist_begin(&nyquist, &plant, &loops, (real_t)cases[k].times,
                                        (real_t)cases[k].limit_db));
}

static struct detune detune;
static struct detune_config detune_config;
static real_t noise_sd[2];

static enum err try_detune(void)
{
    return detune_begin(&detune, &plant, &loops.pairs, REAL_C(1.0), NULL, &detune_config, NULL);
}

struct noise {
    real_t sd[2];
};

static void of_detuning(void)
{
    static const struct range ranges[] = {
        RANGE(detune_config, db_per_loop, 0.1, 20), RANGE(detune_config, db_most, 0.1, 40),
        RANGE(detune_config, gain_margin, 1, 10),   RANGE(detune_config, factor_hi, 1, 1e4),
        RANGE(detune_config, gain_hi, 1e-6, 1e6),   RANGE(detune_config, noise_times, 0.01, 1e6),
        RANGE(detune_config, noise_least, 0, 1),
    };
    static const struct range noises[] = {RANGE(noise, sd[1], 0, 1e3)};
    make_plant();
    detune_config_default(&detune_config);
    CHECK(detune_config, ranges, try_detune);
    detune_config.noise_sd = noise_sd;
    CHECK(noise_sd, noises, try_detune);
}

static struct trial trial;
static struct trial_config trial_config;

static enum err try_trial(void)
{
    return trial_begin(&trial, &plant, &loops, &trial_config);
}

static void of_a_predicted_step(void)
{
    static const struct range ranges[] = {
        RANGE(trial_config, size, 1e-6, 1e6),
        RANGE(trial_config, duration_s, 1e-2, 1e7),
        RANGE(trial_config, setpoint_weight, 0, 1),
        RANGE(trial_config, mark_s, 0, 1e7),
    };
    make_plant();
    trial_config = (struct trial_config){.size = REAL_C(0.05), .setpoint_weight = REAL_C(1.0)};
    CHECK(trial_config, ranges, try_trial);
    trial_config.size = REAL_C(-1e6);
    TEST_ASSERT_EQUAL(ERR_OK, try_trial());
    trial_config.loop = 1;
    TEST_ASSERT_EQUAL(ERR_OK, try_trial());
    trial_config.loop = 2;
    TEST_ASSERT_EQUAL(ERR_RANGE, try_trial());
    trial_config.loop = 0;
    loops.tuning[1].td_s = REAL_C(1e-3); /* it knows PI alone */
    TEST_ASSERT_EQUAL(ERR_RANGE, try_trial());
}

static struct static_decoupler_config decoupler_config;
static struct static_decoupler_work decoupler_work;
static struct static_decoupler_result decoupler_result;

static enum err try_decoupler(void)
{
    return static_decoupler(&plant, &loops.pairs, &decoupler_config, &decoupler_work,
                            &decoupler_result, NULL);
}

static void of_a_decoupler(void)
{
    static const struct range ranges[] = {
        RANGE(static_decoupler_config, element_hi, 1, 1000),
        RANGE(static_decoupler_config, lambda_hi, 1, 1000),
        RANGE(static_decoupler_config, significance, 0, 20),
        RANGE(static_decoupler_config, floor, 0, 0.5),
        RANGE(static_decoupler_config, left_hi, 0.01, 10),
    };
    make_plant();
    static_decoupler_config_default(&decoupler_config);
    CHECK(decoupler_config, ranges, try_decoupler);
}

/* ---- interaction ---- */

static struct pairing pairing;
static struct pairing_config pairing_config;

static enum err try_pairing(void)
{
    return pairing_begin(&pairing, &plant, &pairing_config, NULL);
}

static void of_pairing(void)
{
    static const struct range ranges[] = {
        RANGE(pairing_config, smallest_lambda, 0.001, 1),
        RANGE(pairing_config, floor, 1e-4, 0.5),
        RANGE(pairing_config, confidence, 0.5, 0.9999),
    };
    static const struct {
        unsigned draws;
        bool good;
    } cases[] = {{19, false}, {20, true}, {10000, true}, {10001, false}};
    make_plant();
    pairing_config_default(&pairing_config);
    CHECK(pairing_config, ranges, try_pairing);
    for (unsigned k = 0; k < 4; k++) {
        pairing_config.draws = (uint16_t)cases[k].draws;
        TEST_ASSERT_EQUAL(cases[k].good ? ERR_OK : ERR_RANGE, try_pairing());
    }
}

static struct structure_config structure_config;
static struct structure_work structure_work;
static struct structure structure;

static enum err try_structure(void)
{
    return structure_detect(&plant, &loops.pairs, &structure_config, &structure_work, &structure);
}

static void of_structure(void)
{
    static const struct range ranges[] = {
        RANGE(structure_config, significance, 0, 20), RANGE(structure_config, negligible, 0, 0.5),
        RANGE(structure_config, lambda_lo, 0, 1),     RANGE(structure_config, lambda_hi, 1, 100),
        RANGE(structure_config, grouped, 0.01, 1),
    };
    make_plant();
    structure_config_default(&structure_config);
    CHECK(structure_config, ranges, try_structure);
}

static struct cascade_config cascade_config;
static struct cascade cascades[INTERACT_MAX];

static enum err try_cascade(void)
{
    uint8_t found;
    return cascade_detect(&plant, &cascade_config, cascades, &found);
}

static void of_cascades(void)
{
    static const struct range ranges[] = {
        RANGE(cascade_config, significance, 0, 20),
        RANGE(cascade_config, floor, 1e-4, 0.5),
        RANGE(cascade_config, faster, 0.05, 1),
    };
    make_plant();
    cascade_config_default(&cascade_config);
    CHECK(cascade_config, ranges, try_cascade);
}

static struct only only;
static struct gains gains;

static enum err try_gains(void)
{
    return gains_begin(&gains, &plant, only.x);
}

static void of_the_gains(void)
{
    static const struct range ranges[] = {RANGE(only, x, 0, 0.5)};
    make_plant();
    only.x = REAL_C(0.01);
    CHECK(only, ranges, try_gains);
}

/* ---- tuning ---- */

static enum err try_tyreus_luyben(void)
{
    struct tuning t;
    return tuning_tyreus_luyben_pi(only.x, only.y, &t, NULL);
}

static struct fopdt element;

static enum err try_simc(void)
{
    struct tuning t;
    return tuning_simc_pi(&element, only.x, &t, NULL);
}

static void of_tuning_rules(void)
{
    static const struct range ultimate[] = {RANGE(only, x, 1e-6, 1e6), RANGE(only, y, 1e-6, 1e6)};
    static const struct range wanted[] = {RANGE(only, x, 0, 1e6)};
    only = (struct only){REAL_C(2.0), REAL_C(30.0)};
    CHECK(only, ultimate, try_tyreus_luyben);
    element = (struct fopdt){REAL_C(1.0), REAL_C(2.0), REAL_C(20.0)};
    CHECK(only, wanted, try_simc);
    only.x = REAL_C(-1e6);
    TEST_ASSERT_EQUAL(ERR_OK, try_tyreus_luyben());
}

/* As their headers say. */
static void defaults_are_those_the_headers_state(void)
{
    struct pairing_config p;
    struct structure_config s;
    struct cascade_config c;
    struct detune_config d;
    struct static_decoupler_config x;
    pairing_config_default(&p);
    structure_config_default(&s);
    cascade_config_default(&c);
    detune_config_default(&d);
    static_decoupler_config_default(&x);
    const struct {
        real_t value;
        double stated;
    } all[] = {
        {p.smallest_lambda, 0.02}, {p.floor, 0.005},    {p.confidence, 0.95},
        {(real_t)p.draws, 400},    {(real_t)p.seed, 1}, {s.significance, 3},
        {s.negligible, 0.03},      {s.lambda_lo, 0.5},  {s.lambda_hi, 5},
        {s.grouped, 0.15},         {c.significance, 3}, {c.floor, 0.02},
        {c.faster, 0.6},           {d.db_per_loop, 2},  {d.db_most, 6},
        {d.gain_margin, 1.7},      {d.factor_hi, 200},  {d.gain_hi, 100},
        {d.noise_times, 2},        {d.noise_least, 0},  {x.element_hi, 100},
        {x.lambda_hi, 10},         {x.significance, 3}, {x.floor, 0.005},
        {x.left_hi, 0.3},
    };
    for (unsigned k = 0; k < sizeof all / sizeof all[0]; k++)
        TEST_ASSERT_EQUAL_FLOAT((float)all[k].stated, (float)all[k].value);
    TEST_ASSERT_TRUE(d.noise_sd == NULL && p.outputs_out == 0 && p.inputs_out == 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(of_a_plant);
    RUN_TEST(of_loops);
    RUN_TEST(of_a_stability_curve);
    RUN_TEST(of_detuning);
    RUN_TEST(of_a_predicted_step);
    RUN_TEST(of_a_decoupler);
    RUN_TEST(of_pairing);
    RUN_TEST(of_structure);
    RUN_TEST(of_cascades);
    RUN_TEST(of_the_gains);
    RUN_TEST(of_tuning_rules);
    RUN_TEST(defaults_are_those_the_headers_state);
    return UNITY_END();
}
