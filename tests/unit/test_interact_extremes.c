/* interact/ and design/ on plants that only just pass the checks: gains from 1e-9 to 1e9, times from nothing to 1e6 s,
 * deviations larger than the gains, intervals from a millisecond to a day. Built in float and in double.
 *
 * Contract: every computation ends within its bound of steps with ERR_OK or a refusal, and what it then calls a result is
 * a number (or the infinity its header allows). 400 seeds.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "design/detune.h"
#include "design/static_decoupler.h"
#include "design/trial.h"
#include "interact/cascade.h"
#include "interact/gains.h"
#include "interact/measure.h"
#include "interact/pairing.h"
#include "interact/structure.h"
#include "random_matrix.h"
#include "unity.h"

#define SEEDS 400

static struct interact_plant plant;
static struct gains gains;
static struct pairing pairing;
static struct structure structure;
static struct structure_work structure_work;
static struct cascade cascades[INTERACT_MAX];
static struct measure measure;
static struct measure_work measure_work;
static struct static_decoupler_result decoupler;
static struct static_decoupler_work decoupler_work;
static struct detune detune;
static struct trial trial;
static struct rga_at_work at_work;
static struct matrix modulus;
static char where[32];

void setUp(void) {}
void tearDown(void) {}

static double spread(struct random_source *r, double lo, double hi)
{
    return lo * pow(hi / lo, 0.5 * (1.0 + random_fraction(r)));
}

static void random_plant(uint64_t seed, struct random_source *r)
{
    snprintf(where, sizeof where, "seed %u", (unsigned)seed);
    memset(&plant, 0, sizeof plant);
    plant.outputs = (uint8_t)(1 + random_below(r, 6));
    plant.inputs = (uint8_t)(1 + random_below(r, 6));
    bool wild = seed % 2 == 0; /* else moderate, so that more of it gets to the end */
    for (unsigned i = 0; i < plant.outputs; i++)
        for (unsigned j = 0; j < plant.inputs; j++) {
            double gain = wild ? spread(r, 1e-9, 1e9) : spread(r, 0.05, 5.0);
            double T = wild ? spread(r, 1e-3, 1e6) : spread(r, 10.0, 1e3);
            struct fopdt *e = &plant.element[i][j];
            e->gain = (real_t)(random_below(r, 2) ? gain : -gain);
            e->time_constant_s = random_below(r, 5) ? (real_t)T : 0;
            e->dead_time_s =
                random_below(r, 3) ? (real_t)(T * random_fraction(r) * random_fraction(r)) : 0;
            plant.gain_sd[i][j] = random_below(r, 2) ? (real_t)(gain * spread(r, 1e-4, 3.0)) : 0;
            if (e->dead_time_s < 0)
                e->dead_time_s = -e->dead_time_s;
            if (random_below(r, 6) == 0)
                e->gain = 0;
        }
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, interact_check(&plant, NULL), where);
}

static void a_number(real_t x)
{
    TEST_ASSERT_FALSE_MESSAGE(isnan((double)x), where);
}

static void a_finite(real_t x)
{
    TEST_ASSERT_TRUE_MESSAGE(isfinite((double)x), where);
}

static void analyse(void)
{
    unsigned steps = 0;
    enum err err;
    TEST_ASSERT_EQUAL_INT(ERR_OK, gains_begin(&gains, &plant, REAL_C(0.005)));
    while ((err = gains_step(&gains)) == ERR_BUSY)
        TEST_ASSERT_LESS_THAN_UINT_MESSAGE(3 * SVD_SWEEPS, ++steps, where);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, err, where);
    a_number(gains.condition);
    a_number(gains.condition_scaled);
    a_finite(gains.smallest_in_sd);
    TEST_ASSERT_LESS_OR_EQUAL_UINT8_MESSAGE(gains.rank_exact, gains.rank, where);
    real_t x[INTERACT_MAX];
    for (unsigned k = 0; gains_null_input(&gains, k, x) == ERR_OK; k++)
        for (unsigned j = 0; j < plant.inputs; j++)
            a_finite(x[j]);
    for (unsigned k = 0; gains_null_output(&gains, k, x) == ERR_OK; k++)
        for (unsigned i = 0; i < plant.outputs; i++)
            a_finite(x[i]);
    if (rga_at(&plant, NULL, REAL_C(1e-3), &at_work, &modulus, NULL) == ERR_OK)
        for (unsigned i = 0; i < plant.outputs; i++)
            for (unsigned j = 0; j < plant.inputs; j++)
                a_finite(modulus.value[i][j]);
}

static bool pair(uint64_t seed)
{
    struct pairing_config c;
    unsigned steps = 0;
    enum err err;
    pairing_config_default(&c);
    c.draws = 20;
    c.seed = seed;
    TEST_ASSERT_EQUAL_INT(ERR_OK, pairing_begin(&pairing, &plant, &c, NULL));
    while ((err = pairing_step(&pairing)) == ERR_BUSY)
        TEST_ASSERT_LESS_THAN_UINT_MESSAGE(21u * (3u + PAIRING_TRIES * 18u), ++steps, where);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, err, where);
    a_finite(pairing.probability);
    for (unsigned k = 0; k < pairing.pairs.n; k++) {
        a_finite(pairing.lambda[k]);
        TEST_ASSERT_TRUE_MESSAGE(pairing.lambda[k] >= c.smallest_lambda, where);
    }
    for (unsigned i = 0; i < plant.outputs; i++)
        a_finite(pairing.share[i]);
    return pairing.pairs.n > 0;
}

static void look_for_structure(void)
{
    struct structure_config c;
    struct cascade_config cc;
    uint8_t found;
    structure_config_default(&c);
    cascade_config_default(&cc);
    TEST_ASSERT_EQUAL_INT(
        ERR_OK, structure_detect(&plant, &pairing.pairs, &c, &structure_work, &structure));
    unsigned pairs = 0;
    for (unsigned b = 0; b < structure.blocks; b++) {
        pairs += structure.block[b].size;
        a_finite(structure.block[b].worst_lambda);
        TEST_ASSERT_EQUAL_HEX16(0, structure.block[b].driven_by >> b);
    }
    TEST_ASSERT_EQUAL_UINT_MESSAGE(pairing.pairs.n, pairs, where);
    for (uint8_t k = 0; k < pairing.pairs.n; k++)
        for (uint8_t l = 0; l < pairing.pairs.n; l++) {
            struct cross_way way;
            if (structure_cross_way(&plant, &pairing.pairs, &structure, k, l, &way) == ERR_OK)
                a_finite(way.gain);
        }
    TEST_ASSERT_EQUAL_INT(ERR_OK, cascade_detect(&plant, &cc, cascades, &found));
    for (unsigned k = 0; k < found; k++) {
        a_finite(cascades[k].between.gain);
        a_finite(cascades[k].misfit_sd);
        a_finite(cascades[k].between.time_constant_s);
    }
    if (measure_compute(&plant, &pairing.pairs, 1, &measure_work, &measure) == ERR_OK)
        for (unsigned k = 0; k < pairing.pairs.n; k++)
            a_finite(measure.gamma.value[k][k]);
}

/* parts: they are said to be of so many, which these plants seldom are. */
static unsigned try_loops(const struct matrix *d, real_t interval, unsigned parts)
{
    struct detune_config c;
    unsigned steps = 0; /* of every part, of all together, and once more with one factor */
    unsigned most = 40u * NYQUIST_POINTS * (parts > 1 ? parts + 2u : 1u);
    enum err err;
    detune_config_default(&c);
    for (unsigned k = 0; k < pairing.pairs.n; k++)
        c.part[k] = (uint8_t)(k % parts);
    err = detune_begin(&detune, &plant, &pairing.pairs, interval, d, &c, NULL);
    if (err)
        return 0;
    while ((err = detune_step(&detune)) == ERR_BUSY)
        TEST_ASSERT_LESS_THAN_UINT_MESSAGE(most, ++steps, where);
    for (unsigned k = 0; k < pairing.pairs.n; k++) {
        a_finite(detune.loops.tuning[k].gain);
        a_finite(detune.loops.tuning[k].ti_s);
    }
    if (err)
        return 0;
    a_finite(detune.log_modulus_db);
    TEST_ASSERT_TRUE_MESSAGE(detune.factor_least >= 1 && detune.factor >= detune.factor_least,
                             where);
    struct trial_config tc = {.size = REAL_C(0.01), .load = true, .setpoint_weight = 1};
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, trial_begin(&trial, &plant, &detune.loops, &tc), where);
    while ((err = trial_step(&trial)) == ERR_BUSY)
        ;
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    for (unsigned k = 0; k < pairing.pairs.n && trial.bounded; k++)
        a_finite(trial.loop[k].iae);
    return 1;
}

static void nothing_that_passes_the_checks_runs_away(void)
{
    unsigned paired = 0, tried = 0, apart = 0, decoupled = 0;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        struct random_source r = {seed};
        random_plant(seed, &r);
        analyse();
        if (!pair(seed))
            continue;
        paired++;
        look_for_structure();
        real_t interval =
            (real_t)(seed % 2 == 0 ? spread(&r, 1e-3, 86400.0) : spread(&r, 0.1, 20.0));
        tried += try_loops(NULL, interval, 1);
        apart += try_loops(NULL, interval, 2u + (unsigned)(seed % 5u));
        struct static_decoupler_config c;
        static_decoupler_config_default(&c);
        if (static_decoupler(&plant, &pairing.pairs, &c, &decoupler_work, &decoupler, NULL) ==
            ERR_OK)
            decoupled += try_loops(&decoupler.d, interval, 1u + (unsigned)(seed % 3u));
    }
    printf("extremes: of %u plants %u paired, %u tuned, %u in parts, %u with a decoupler\n", SEEDS,
           paired, tried, apart, decoupled);
    TEST_ASSERT_GREATER_THAN_UINT(SEEDS / 2, paired);
    TEST_ASSERT_GREATER_THAN_UINT(SEEDS / 4, tried);
    TEST_ASSERT_GREATER_THAN_UINT(SEEDS / 4, apart);
    TEST_ASSERT_GREATER_THAN_UINT(SEEDS / 20, decoupled);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(nothing_that_passes_the_checks_runs_away);
    return UNITY_END();
}
