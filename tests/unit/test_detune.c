/* design/detune.[ch], design/static_decoupler.[ch]; built in float and in double. What the settings do on the plants
 * themselves, by eigenvalues: test_detuned_loops.py.
 *
 * Contract, on every plant
 *   detuning                    keeps the log modulus and the gain margin asked for, with the least F to 5 %
 *   independent parts           settings each would get alone to 1e-4; what acts together after all, one factor
 *   decoupler                   K D diagonal to 64 eps kappa of its diagonal; diagonal of D exactly 1
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "design/detune.h"
#include "design/static_decoupler.h"
#include "design/trial.h"
#include "interact_plants.h"
#include "num/random.h"
#include "unity.h"

#define EPS ((double)REAL_EPSILON)

static struct known_plant known;
static struct detune detune;
static struct detune_config config;
static struct nyquist nyquist;
static struct static_decoupler_config decoupler_config;
static struct static_decoupler_work work;
static struct static_decoupler_result result;
static struct interact_refusal reason;

void setUp(void)
{
    detune_config_default(&config);
    static_decoupler_config_default(&decoupler_config);
}
void tearDown(void) {}

/* A twentieth of the slowest residence time of the pairs. */
static double interval(void)
{
    double slowest = 0.0;
    for (unsigned k = 0; k < known.pairs.n; k++) {
        const struct fopdt *e = &known.plant.element[known.pairs.output[k]][known.pairs.input[k]];
        slowest = fmax(slowest, (double)(e->dead_time_s + e->time_constant_s));
    }
    return slowest / 200.0;
}

static enum err design(const struct matrix *d)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, detune_begin(&detune, &known.plant, &known.pairs,
                                               (real_t)interval(), d, &config, &reason));
    enum err err;
    while ((err = detune_step(&detune)) == ERR_BUSY)
        ;
    return err;
}

static bool keeps_distance(const struct loops *loops)
{
    enum err err;
    TEST_ASSERT_EQUAL_INT(ERR_OK,
                          nyquist_begin(&nyquist, &known.plant, loops, 1, (real_t)INFINITY));
    while ((err = nyquist_step(&nyquist)) == ERR_BUSY)
        ;
    double limit = fmin(2.0 * known.pairs.n, 6.0);
    if (err || !nyquist.stable || (double)nyquist.log_modulus_db > limit + 0.01)
        return false;
    TEST_ASSERT_EQUAL_INT(
        ERR_OK, nyquist_begin(&nyquist, &known.plant, loops, config.gain_margin, (real_t)INFINITY));
    while ((err = nyquist_step(&nyquist)) == ERR_BUSY)
        ;
    return !err && nyquist.stable;
}

static void detuned_loops_of_every_plant_keep_their_distance(void)
{
    for (unsigned number = 1; number <= PLANTS; number++) {
        known_plant(number, &known);
        if (known.pairs.n == 0)
            continue;
        TEST_ASSERT_EQUAL_INT(ERR_OK, design(NULL));
        TEST_ASSERT_TRUE(keeps_distance(&detune.loops));
        TEST_ASSERT_TRUE((double)detune.log_modulus_db <= fmin(2.0 * known.pairs.n, 6.0) + 0.01);
        TEST_ASSERT_TRUE(detune.factor >= 1);
        printf("plant %2u: F %.2f, log modulus %.2f dB, %u factors tried\n", number,
               (double)detune.factor, (double)detune.log_modulus_db, detune.tried);
        for (unsigned k = 0; k < known.pairs.n; k++) {
            const struct tuning *t = &detune.loops.tuning[k];
            double gain = known.gain[known.pairs.output[k]][known.pairs.input[k]];
            TEST_ASSERT_EQUAL_INT(gain < 0 ? TUNING_DIRECT : TUNING_REVERSE, t->action);
            TEST_ASSERT_TRUE(t->gain > 0 && t->gain <= REAL_C(100.0));
        }
    }
}

/* With every tau_c ten per cent shorter the distance is gone: gains as SIMC would then give them. */
static void no_smaller_factor_would_do(void)
{
    unsigned slowed = 0;
    for (unsigned number = 1; number <= PLANTS; number++) {
        known_plant(number, &known);
        if (known.pairs.n == 0)
            continue;
        TEST_ASSERT_EQUAL_INT(ERR_OK, design(NULL));
        if (detune.factor <= 1)
            continue;
        slowed++;
        struct loops faster = detune.loops;
        for (unsigned k = 0; k < known.pairs.n; k++) {
            const struct fopdt *m = &detune.model[k];
            real_t eighth = m->time_constant_s / 8;
            real_t tau_c =
                detune.factor / REAL_C(1.1) * (m->dead_time_s > eighth ? m->dead_time_s : eighth);
            TEST_ASSERT_EQUAL_INT(ERR_OK, tuning_simc_pi(m, tau_c, &faster.tuning[k], NULL));
        }
        TEST_ASSERT_FALSE(keeps_distance(&faster));
    }
    TEST_ASSERT_GREATER_THAN_UINT(2, slowed);
}

static void a_single_loop_is_simc_with_tau_c_theta(void)
{
    memset(&known, 0, sizeof known);
    known.plant.outputs = known.plant.inputs = known.pairs.n = 1;
    known.plant.element[0][0] = (struct fopdt){REAL_C(-2.0), REAL_C(19.5), REAL_C(60.0)};
    config.db_per_loop = 3; /* SIMC alone has 1.6 dB or so */
    TEST_ASSERT_EQUAL_INT(ERR_OK, detune_begin(&detune, &known.plant, &known.pairs, REAL_C(1.0),
                                               NULL, &config, NULL));
    enum err err;
    while ((err = detune_step(&detune)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    TEST_ASSERT_TRUE(detune.factor <= 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.75, (double)detune.loops.tuning[0].gain); /* theta 20 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 60.0, (double)detune.loops.tuning[0].ti_s);
    TEST_ASSERT_EQUAL_INT(TUNING_DIRECT, detune.loops.tuning[0].action);
}

/* A relative gain of 0.8: the gain with the other loop closed is larger than the own one. */
static void a_gain_that_rises_when_other_loops_close_is_designed_for(void)
{
    known_plant(PLANT_LIME_KILN, &known);
    TEST_ASSERT_EQUAL_INT(ERR_OK, design(NULL));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, known.gain[0][0] / known.pair_lambda[0],
                              (double)detune.model[0].gain);
    known_plant(PLANT_WOOD_BERRY, &known); /* 2.0: it falls, and the own gain counts */
    TEST_ASSERT_EQUAL_INT(ERR_OK, design(NULL));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, known.gain[0][0], (double)detune.model[0].gain);
}

static void loops_that_no_slowness_makes_stable_are_given_up(void)
{
    known_plant(PLANT_WOOD_BERRY, &known);
    known.pairs = (struct pairs){2, {0, 1}, {1, 0}};
    TEST_ASSERT_EQUAL_INT(ERR_TIMEOUT, design(NULL));
    TEST_ASSERT_EQUAL_FLOAT(200.0f, (float)detune.factor);
}

static void a_gain_at_its_limit_gets_the_integral_time_that_goes_with_it(void)
{
    memset(&known, 0, sizeof known);
    known.plant.outputs = known.plant.inputs = known.pairs.n = 1;
    known.plant.element[0][0] = (struct fopdt){REAL_C(0.01), REAL_C(9.0), REAL_C(1000.0)};
    config.gain_hi = 50;
    TEST_ASSERT_EQUAL_INT(ERR_OK, detune_begin(&detune, &known.plant, &known.pairs, REAL_C(2.0),
                                               NULL, &config, NULL));
    enum err err;
    while ((err = detune_step(&detune)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    TEST_ASSERT_EQUAL_FLOAT(50.0f, (float)detune.loops.tuning[0].gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-2, 1000.0, (double)detune.loops.tuning[0].ti_s); /* min(T, 8000) */
}

static enum err design_every(double interval_s)
{
    TEST_ASSERT_EQUAL_INT(ERR_OK, detune_begin(&detune, &known.plant, &known.pairs,
                                               (real_t)interval_s, NULL, &config, NULL));
    enum err err;
    while ((err = detune_step(&detune)) == ERR_BUSY)
        ;
    return err;
}

static enum err design_one(void)
{
    return design_every(2.0);
}

/* 0.5 exp(-9 s)/(1000 s + 1), theta 10, every 2 s; tau_c T/8: gain 1000/(0.5 135). */
static void one_slow_element(void)
{
    memset(&known, 0, sizeof known);
    known.plant.outputs = known.plant.inputs = known.pairs.n = 1;
    known.plant.element[0][0] = (struct fopdt){REAL_C(0.5), REAL_C(9.0), REAL_C(1000.0)};
}

static void noise_of_a_loop_moves_no_output_more_than_twice_its_own_noise(void)
{
    static real_t noise[INTERACT_MAX];
    one_slow_element();
    TEST_ASSERT_EQUAL_INT(ERR_OK, design_one());
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1000.0 / (0.5 * 135.0), (double)detune.loops.tuning[0].gain);
    config.noise_sd = noise; /* 0: not known */
    TEST_ASSERT_EQUAL_INT(ERR_OK, design_one());
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1000.0 / (0.5 * 135.0), (double)detune.loops.tuning[0].gain);
    /* Alone it is bound by its own gain only: 2/(0.5 sqrt((1 - a)/(1 + a))) = 126, whatever the noise. */
    noise[0] = REAL_C(0.03);
    TEST_ASSERT_EQUAL_INT(ERR_OK, design_one());
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1000.0 / (0.5 * 135.0), (double)detune.loops.tuning[0].gain);
    config.noise_times = REAL_C(0.1);
    TEST_ASSERT_EQUAL_INT(ERR_OK, design_one());
    double a = exp(-2.0 / 1000.0), most = 0.1 / (0.5 * sqrt((1.0 - a) / (1.0 + a)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * most, most, (double)detune.loops.tuning[0].gain);
    TEST_ASSERT_TRUE(detune.loops.tuning[0].ti_s > REAL_C(540.0)); /* 4 135 */
    /* The same of an element whose lag is shorter than a second, under ticks of a tenth of it. */
    const struct fopdt slow = known.plant.element[0][0];
    for (real_t lag = REAL_C(0.04); lag < 2; lag *= 4) {
        known.plant.element[0][0] = (struct fopdt){
            .gain = slow.gain, .dead_time_s = REAL_C(0.1) * lag, .time_constant_s = lag};
        TEST_ASSERT_EQUAL_INT(ERR_OK, design_every(0.1 * (double)lag));
        double b = exp(-0.1), least = 0.1 / (0.5 * sqrt((1.0 - b) / (1.0 + b)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3 * least, least, (double)detune.loops.tuning[0].gain);
    }
    known.plant.element[0][0] = slow;
    /* Another output, quieter by ten and moved as much, has it smaller by ten. */
    known.plant.outputs = 2;
    known.plant.element[1][0] = known.plant.element[0][0];
    noise[1] = REAL_C(0.003);
    TEST_ASSERT_EQUAL_INT(ERR_OK, design_one());
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * most, most / 10.0, (double)detune.loops.tuning[0].gain);
    noise[1] = NAN;
    TEST_ASSERT_NOT_EQUAL_INT(ERR_OK, detune_begin(&detune, &known.plant, &known.pairs, REAL_C(2.0),
                                                   NULL, &config, &reason));
    TEST_ASSERT_EQUAL_STRING("noise_sd", reason.field);
    TEST_ASSERT_EQUAL_UINT8(1, reason.output);
}

static void an_effect_without_lag_is_controlled_by_integral_action(void)
{
    memset(&known, 0, sizeof known);
    known.plant.outputs = known.plant.inputs = known.pairs.n = 1;
    known.plant.element[0][0] = (struct fopdt){1, 0, 0};
    TEST_ASSERT_EQUAL_INT(ERR_OK, detune_begin(&detune, &known.plant, &known.pairs, REAL_C(2.0),
                                               NULL, &config, NULL));
    enum err err;
    while ((err = detune_step(&detune)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.0, (double)detune.loops.tuning[0].ti_s);
    TEST_ASSERT_TRUE(detune.loops.tuning[0].gain < 1);
    static struct trial trial;
    struct trial_config c = {.size = 1, .duration_s = 60, .setpoint_weight = 1};
    TEST_ASSERT_EQUAL_INT(ERR_OK, trial_begin(&trial, &known.plant, &detune.loops, &c));
    while ((err = trial_step(&trial)) == ERR_BUSY)
        ;
    TEST_ASSERT_TRUE(trial.bounded);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.0, (double)trial.y[0]);
}

/* ---- parts of a plant that do not act on each other ---- */

/* Plants side by side, pair by pair of each in turn: first pair of the first, first of the second, ..., second of the
 * first. part tells them apart. */
static struct known_plant whole;
static struct loops alone[4];
static double factor_alone[4], largest_alone, least_alone, db_alone;
static uint8_t which[INTERACT_MAX],
    nth[INTERACT_MAX]; /* loop k of the whole is this one of that plant */

static void put_side_by_side(const unsigned *numbers, unsigned n, double h)
{
    memset(&whole, 0, sizeof whole);
    memset(config.part, 0, sizeof config.part);
    uint8_t first_output[4], first_input[4];
    static struct known_plant each[4];
    largest_alone = db_alone = 0.0;
    least_alone = 1e9;
    for (unsigned p = 0; p < n; p++) {
        known_plant(numbers[p], &each[p]);
        TEST_ASSERT_EQUAL_INT(ERR_OK, detune_begin(&detune, &each[p].plant, &each[p].pairs,
                                                   (real_t)h, NULL, &config, &reason));
        enum err err;
        while ((err = detune_step(&detune)) == ERR_BUSY)
            ;
        TEST_ASSERT_EQUAL_INT(ERR_OK, err);
        TEST_ASSERT_TRUE(detune.factor_least >= detune.factor);
        alone[p] = detune.loops;
        factor_alone[p] = (double)detune.factor;
        largest_alone = fmax(largest_alone, factor_alone[p]);
        least_alone = fmin(least_alone, factor_alone[p]);
        db_alone = fmax(db_alone, (double)detune.log_modulus_db);
        first_output[p] = whole.plant.outputs;
        first_input[p] = whole.plant.inputs;
        whole.plant.outputs = (uint8_t)(whole.plant.outputs + each[p].plant.outputs);
        whole.plant.inputs = (uint8_t)(whole.plant.inputs + each[p].plant.inputs);
        TEST_ASSERT_TRUE(whole.plant.outputs <= INTERACT_MAX && whole.plant.inputs <= INTERACT_MAX);
        for (unsigned j = 0; j < each[p].plant.outputs; j++)
            for (unsigned i = 0; i < each[p].plant.inputs; i++)
                whole.plant.element[first_output[p] + j][first_input[p] + i] =
                    each[p].plant.element[j][i];
    }
    for (unsigned k = 0; k < INTERACT_MAX; k++)
        for (unsigned p = 0; p < n; p++)
            if (k < each[p].pairs.n) {
                uint8_t at = whole.pairs.n++;
                whole.pairs.output[at] = (uint8_t)(first_output[p] + each[p].pairs.output[k]);
                whole.pairs.input[at] = (uint8_t)(first_input[p] + each[p].pairs.input[k]);
                which[at] = (uint8_t)p;
                nth[at] = (uint8_t)k;
                config.part[at] = (uint8_t)(7u * p);
            }
}

static enum err design_whole(double h, const struct matrix *d)
{
    TEST_ASSERT_EQUAL_INT(
        ERR_OK, detune_begin(&detune, &whole.plant, &whole.pairs, (real_t)h, d, &config, &reason));
    enum err err;
    while ((err = detune_step(&detune)) == ERR_BUSY)
        ;
    return err;
}

static void as_alone(uint8_t k)
{
    const struct tuning *want = &alone[which[k]].tuning[nth[k]], *have = &detune.loops.tuning[k];
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * (double)want->gain, (double)want->gain, (double)have->gain);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * (double)want->ti_s, (double)want->ti_s, (double)have->ti_s);
    TEST_ASSERT_EQUAL_INT(want->action, have->action);
}

static void independent_parts_get_the_settings_they_would_get_alone(void)
{
    static const unsigned sets[][4] = {
        {PLANT_WOOD_BERRY, PLANT_WOOD_BERRY, PLANT_WOOD_BERRY, PLANT_WOOD_BERRY},
        {PLANT_WOOD_BERRY, PLANT_LIME_KILN, PLANT_LUYBEN_VINANTE, PLANT_LUYBEN_4X4},
        {PLANT_SHELL, PLANT_FURNACE, PLANT_WOOD_BERRY, PLANT_LIME_KILN}};
    for (unsigned s = 0; s < sizeof sets / sizeof sets[0]; s++) {
        put_side_by_side(sets[s], 4, 0.5);
        TEST_ASSERT_EQUAL_INT(ERR_OK, design_whole(0.5, NULL));
        for (uint8_t k = 0; k < whole.pairs.n; k++)
            as_alone(k);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * largest_alone, largest_alone, (double)detune.factor);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * least_alone, least_alone, (double)detune.factor_least);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, db_alone, (double)detune.log_modulus_db);
        unsigned tried = detune.tried;
        memset(config.part, 0, sizeof config.part);
        enum err err = design_whole(0.5, NULL);
        printf(
            "side by side, %u loops: F %.2f to %.2f, %u factors tried; with one for all %.2f%s\n",
            whole.pairs.n, least_alone, largest_alone, tried, (double)detune.factor,
            err ? ", and not kept" : "");
        if (s == 0) /* all fastest at one frequency */
            TEST_ASSERT_TRUE((double)detune.factor > 5.0 * largest_alone);
    }
}

/* The decoupler of each plant alone, and those in one. */
static void independent_parts_with_decouplers_get_the_settings_they_would_get_alone(void)
{
    static const unsigned two[] = {PLANT_WOOD_BERRY, PLANT_LIME_KILN};
    static struct matrix d;
    put_side_by_side(two, 2, 0.5);
    struct detune_config one = config;
    memset(one.part, 0, sizeof one.part);
    memset(&d, 0, sizeof d);
    d.rows = d.cols = whole.pairs.n;
    for (unsigned p = 0; p < 2; p++) {
        known_plant(two[p], &known);
        TEST_ASSERT_EQUAL_INT(ERR_OK, static_decoupler(&known.plant, &known.pairs,
                                                       &decoupler_config, &work, &result, &reason));
        TEST_ASSERT_EQUAL_INT(ERR_OK, detune_begin(&detune, &known.plant, &known.pairs, REAL_C(0.5),
                                                   &result.d, &one, &reason));
        enum err err;
        while ((err = detune_step(&detune)) == ERR_BUSY)
            ;
        TEST_ASSERT_EQUAL_INT(ERR_OK, err);
        alone[p] = detune.loops;
        for (unsigned k = 0; k < whole.pairs.n; k++)
            for (unsigned l = 0; l < whole.pairs.n; l++)
                if (which[k] == p && which[l] == p)
                    d.value[k][l] = result.d.value[nth[k]][nth[l]];
    }
    TEST_ASSERT_EQUAL_INT(ERR_OK, design_whole(0.5, &d));
    for (uint8_t k = 0; k < whole.pairs.n; k++)
        as_alone(k);
    TEST_ASSERT_TRUE(detune.loops.decoupler == &d);
}

/* Off the pairs fast, on them slow: with F = 1 and gains 1.7 times as large they are unstable together. */
static void parts_that_act_on_each_other_after_all_get_one_factor(void)
{
    memset(&known, 0, sizeof known);
    known.plant.outputs = known.plant.inputs = known.pairs.n = 2;
    known.pairs = (struct pairs){2, {0, 1}, {0, 1}};
    for (unsigned j = 0; j < 2; j++)
        for (unsigned i = 0; i < 2; i++)
            known.plant.element[j][i] =
                i == j ? (struct fopdt){REAL_C(1.0), REAL_C(10.0), REAL_C(40.0)}
                       : (struct fopdt){REAL_C(0.8), REAL_C(5.0), REAL_C(5.0)};
    TEST_ASSERT_EQUAL_INT(ERR_OK, design(NULL));
    real_t factor = detune.factor;
    unsigned tried = detune.tried;
    struct loops joint = detune.loops;
    TEST_ASSERT_TRUE(factor > REAL_C(2.0));
    config.part[1] = 1;
    TEST_ASSERT_EQUAL_INT(ERR_OK, design(NULL));
    TEST_ASSERT_TRUE(detune.tried > tried);
    TEST_ASSERT_TRUE(detune.factor >= factor && detune.factor <= factor);
    TEST_ASSERT_TRUE(detune.factor_least >= factor);
    TEST_ASSERT_EQUAL_MEMORY(joint.tuning, detune.loops.tuning, sizeof joint.tuning);
}

/* Wood and Berry's column paired the wrong way round, beside one that is not. */
static void a_part_that_no_slowness_makes_stable_is_not_covered_by_the_others(void)
{
    static const unsigned two[] = {PLANT_WOOD_BERRY, PLANT_WOOD_BERRY};
    put_side_by_side(two, 2, 0.5);
    for (uint8_t k = 0; k < whole.pairs.n; k++)
        if (which[k] == 0)
            whole.pairs.input[k] = (uint8_t)(1u - whole.pairs.input[k]);
    TEST_ASSERT_EQUAL_INT(ERR_TIMEOUT, design_whole(0.5, NULL));
    TEST_ASSERT_EQUAL_FLOAT(200.0f, (float)detune.factor);
    for (uint8_t k = 0; k < whole.pairs.n; k++)
        if (which[k] == 1)
            as_alone(k);
    TEST_ASSERT_EQUAL_INT(ERR_STATE, detune_step(&detune));
}

static void a_decoupler_makes_the_gains_diagonal(void)
{
    unsigned made = 0;
    for (unsigned number = 1; number <= PLANTS; number++) {
        known_plant(number, &known);
        if (known.pairs.n == 0 || number == PLANT_PACKED_BED || number == PLANT_COLUMN_9001)
            continue;
        TEST_ASSERT_EQUAL_INT(ERR_OK, static_decoupler(&known.plant, &known.pairs,
                                                       &decoupler_config, &work, &result, &reason));
        for (unsigned i = 0; i < known.pairs.n; i++)
            for (unsigned j = 0; j < known.pairs.n; j++) {
                double sum = 0.0, gain = (double)result.gain[i];
                for (unsigned k = 0; k < known.pairs.n; k++)
                    sum += known.gain[known.pairs.output[i]][known.pairs.input[k]] *
                           (double)result.d.value[k][j];
                TEST_ASSERT_DOUBLE_WITHIN(64 * EPS * known.condition * fabs(gain),
                                          i == j ? gain : 0.0, sum);
                if (i == j)
                    TEST_ASSERT_TRUE(result.d.value[i][i] >= 1 && result.d.value[i][i] <= 1);
            }
        for (unsigned k = 0; k < known.pairs.n; k++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-4 * fabs((double)result.gain[k]),
                                      known.gain[known.pairs.output[k]][known.pairs.input[k]] /
                                          known.pair_lambda[k],
                                      (double)result.gain[k]);
        made++;
    }
    TEST_ASSERT_EQUAL_UINT(9, made);
}

static void loops_with_a_decoupler_keep_their_distance(void)
{
    for (unsigned number = 1; number <= PLANTS; number++) {
        known_plant(number, &known);
        if (known.pairs.n == 0 || static_decoupler(&known.plant, &known.pairs, &decoupler_config,
                                                   &work, &result, &reason))
            continue;
        TEST_ASSERT_EQUAL_INT(ERR_OK, design(&result.d));
        TEST_ASSERT_TRUE(keeps_distance(&detune.loops));
    }
}

/* Deviation of a decoupled gain and of what is left, against draws. */
static void the_errors_left_by_a_decoupler_are_those_of_drawn_gains(void)
{
    known_plant(PLANT_WOOD_BERRY, &known);
    decoupler_config.floor = REAL_C(0.02);
    TEST_ASSERT_EQUAL_INT(ERR_OK, static_decoupler(&known.plant, &known.pairs, &decoupler_config,
                                                   &work, &result, &reason));
    struct random r = random_from(5);
    double squares[2][2] = {{0}};
    const int draws = 20000;
    for (int n = 0; n < draws; n++) {
        double k[2][2];
        for (unsigned i = 0; i < 2; i++)
            for (unsigned j = 0; j < 2; j++)
                k[i][j] = known.gain[i][j] * (1.0 + 0.02 * (double)random_normal(&r));
        for (unsigned i = 0; i < 2; i++)
            for (unsigned j = 0; j < 2; j++) {
                double left = k[i][0] * (double)result.d.value[0][j] +
                              k[i][1] * (double)result.d.value[1][j] -
                              (i == j ? (double)result.gain[i] : 0.0);
                squares[i][j] += left * left / draws;
            }
    }
    for (unsigned i = 0; i < 2; i++)
        TEST_ASSERT_DOUBLE_WITHIN(0.03 * sqrt(squares[i][i]), sqrt(squares[i][i]),
                                  (double)result.gain_sd[i]);
    double left = fmax(sqrt(squares[0][1]) / fabs((double)result.gain[0]),
                       sqrt(squares[1][0]) / fabs((double)result.gain[1]));
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * left, left, (double)result.left_sd);
}

static void decouplers_that_would_do_harm_are_refused_with_the_reason(void)
{
    known_plant(PLANT_PACKED_BED, &known); /* lambda 13.7 */
    TEST_ASSERT_EQUAL_INT(
        ERR_SINGULAR,
        static_decoupler(&known.plant, &known.pairs, &decoupler_config, &work, &result, &reason));
    TEST_ASSERT_EQUAL_STRING("relative gain", reason.field);
    known_plant(PLANT_COLUMN_9001, &known); /* errors of one gain swamp the others of its row */
    TEST_ASSERT_EQUAL_INT(
        ERR_SINGULAR,
        static_decoupler(&known.plant, &known.pairs, &decoupler_config, &work, &result, &reason));
    TEST_ASSERT_EQUAL_STRING("gains", reason.field);
    known_plant(PLANT_FOLAMI, &known); /* lambda 6.25, gains to 10 % */
    decoupler_config.floor = REAL_C(0.1);
    decoupler_config.left_hi = 10;
    TEST_ASSERT_EQUAL_INT(
        ERR_SINGULAR,
        static_decoupler(&known.plant, &known.pairs, &decoupler_config, &work, &result, &reason));
    TEST_ASSERT_EQUAL_STRING("gain of the decoupled loop", reason.field);
    known_plant(PLANT_PAPER_MACHINE, &known);
    known.pairs = (struct pairs){5, {0, 1, 2, 3, 4}, {2, 0, 1, 3, 4}};
    static_decoupler_config_default(&decoupler_config);
    TEST_ASSERT_EQUAL_INT(
        ERR_SINGULAR,
        static_decoupler(&known.plant, &known.pairs, &decoupler_config, &work, &result, &reason));
    memset(&known, 0, sizeof known);
    known.plant.outputs = known.plant.inputs = known.pairs.n = 9;
    for (uint8_t k = 0; k < 9; k++) {
        known.pairs.output[k] = known.pairs.input[k] = k;
        known.plant.element[k][k].gain = 1;
    }
    TEST_ASSERT_EQUAL_INT(ERR_FULL, static_decoupler(&known.plant, &known.pairs, &decoupler_config,
                                                     &work, &result, &reason));
}

static void settings_out_of_range_are_refused_by_name(void)
{
    known_plant(PLANT_WOOD_BERRY, &known);
    config.gain_margin = (real_t)NAN;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, detune_begin(&detune, &known.plant, &known.pairs, 60,
                                                       NULL, &config, &reason));
    TEST_ASSERT_EQUAL_STRING("gain_margin", reason.field);
    detune_config_default(&config);
    config.factor_hi = REAL_C(0.5);
    TEST_ASSERT_EQUAL_INT(
        ERR_RANGE, detune_begin(&detune, &known.plant, &known.pairs, 60, NULL, &config, &reason));
    TEST_ASSERT_EQUAL_STRING("factor_hi", reason.field);
    detune_config_default(&config);
    TEST_ASSERT_EQUAL_INT(
        ERR_RANGE, detune_begin(&detune, &known.plant, &known.pairs, 0, NULL, &config, &reason));
    TEST_ASSERT_EQUAL_STRING("interval_s", reason.field);
    known.plant.element[0][0].gain = 0; /* lambda 0: a pair that cannot be */
    TEST_ASSERT_EQUAL_INT(
        ERR_RANGE, detune_begin(&detune, &known.plant, &known.pairs, 60, NULL, &config, &reason));
    TEST_ASSERT_EQUAL_STRING("gain", reason.field);
    known_plant(PLANT_WOOD_BERRY, &known);
    decoupler_config.left_hi = (real_t)NAN;
    TEST_ASSERT_EQUAL_INT(
        ERR_NOT_FINITE,
        static_decoupler(&known.plant, &known.pairs, &decoupler_config, &work, &result, &reason));
    TEST_ASSERT_EQUAL_STRING("left_hi", reason.field);
    static_decoupler_config_default(&decoupler_config);
    known.plant.gain_sd[0][0] = (real_t)INFINITY;
    TEST_ASSERT_EQUAL_INT(
        ERR_NOT_FINITE,
        static_decoupler(&known.plant, &known.pairs, &decoupler_config, &work, &result, &reason));
    known_plant(PLANT_WOOD_BERRY, &known);
    known.pairs.n = 0;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, static_decoupler(&known.plant, &known.pairs, &decoupler_config,
                                                      &work, &result, &reason));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(detuned_loops_of_every_plant_keep_their_distance);
    RUN_TEST(no_smaller_factor_would_do);
    RUN_TEST(a_single_loop_is_simc_with_tau_c_theta);
    RUN_TEST(a_gain_that_rises_when_other_loops_close_is_designed_for);
    RUN_TEST(loops_that_no_slowness_makes_stable_are_given_up);
    RUN_TEST(a_gain_at_its_limit_gets_the_integral_time_that_goes_with_it);
    RUN_TEST(noise_of_a_loop_moves_no_output_more_than_twice_its_own_noise);
    RUN_TEST(an_effect_without_lag_is_controlled_by_integral_action);
    RUN_TEST(independent_parts_get_the_settings_they_would_get_alone);
    RUN_TEST(independent_parts_with_decouplers_get_the_settings_they_would_get_alone);
    RUN_TEST(parts_that_act_on_each_other_after_all_get_one_factor);
    RUN_TEST(a_part_that_no_slowness_makes_stable_is_not_covered_by_the_others);
    RUN_TEST(a_decoupler_makes_the_gains_diagonal);
    RUN_TEST(loops_with_a_decoupler_keep_their_distance);
    RUN_TEST(the_errors_left_by_a_decoupler_are_those_of_drawn_gains);
    RUN_TEST(decouplers_that_would_do_harm_are_refused_with_the_reason);
    RUN_TEST(settings_out_of_range_are_refused_by_name);
    return UNITY_END();
}
