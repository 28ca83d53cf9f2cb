/* commission/analysis.[ch]: from the elements of a plant to a set of loops.
 *
 * Contract
 *   every plant           the committed pairing (tests/reference/interact_plants.csv) with gains known to 0.5 %, settings that
 *                         stay bounded on the model, every predicted step settled
 *   paper machine         exact gains or not: rank 4, its null vectors, not determined, nothing designed
 *   a piece of work       for plants of 16 x 16 no piece takes the whole; the number of pieces is bounded
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "commission/analysis.h"
#include "interact_plants.h"
#include "random_source.h"
#include "unity.h"

#define SEED 4711u

static struct known_plant known;
static struct analysis a;
static struct analysis_config config;
static unsigned pieces;

void setUp(void)
{
    config = (struct analysis_config){.h_s = 60,
                                      .confidence = REAL_C(0.95),
                                      .floor = REAL_C(0.01),
                                      .step = REAL_C(0.05),
                                      .loops_max = 8};
}
void tearDown(void) {}

/* The reference tells no unit of time: its seconds are the plant's own unit. */
static void take_plant(unsigned number, double sd, double unit_s)
{
    known_plant(number, &known);
    memset(&a, 0xA5, sizeof a);
    memset(a.flags, 0, sizeof a.flags);
    memset(a.given, 0, sizeof a.given);
    a.plant = known.plant;
    for (unsigned j = 0; j < known.plant.outputs; j++)
        for (unsigned i = 0; i < known.plant.inputs; i++) {
            struct fopdt *e = &a.plant.element[j][i];
            e->time_constant_s *= (real_t)unit_s;
            e->dead_time_s *= (real_t)unit_s;
            a.plant.gain_sd[j][i] = (real_t)sd * real_abs(e->gain);
        }
}

static enum err run(void)
{
    enum err err = analysis_begin(&a, &config);
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    for (pieces = 0; pieces < 2000000; pieces++) {
        err = analysis_step(&a);
        if (err != ERR_BUSY)
            return err;
    }
    TEST_FAIL_MESSAGE("it never ends");
    return err;
}

static void same_pairs(void)
{
    TEST_ASSERT_EQUAL_UINT8(known.pairs.n, a.pairs.n);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(known.pairs.output, a.pairs.output, known.pairs.n);
    TEST_ASSERT_EQUAL_UINT8_ARRAY(known.pairs.input, a.pairs.input, known.pairs.n);
}

static void every_plant_gets_its_pairing_and_settings_that_settle(void)
{
    /* Seconds in the plant's unit of time, and its tick. */
    static const struct {
        unsigned number;
        double unit_s, h_s;
    } plants[] = {{PLANT_AIR_COMPRESSOR, 1, 0.1}, {PLANT_FOLAMI, 60, 30},
                  {PLANT_FURNACE, 60, 10},        {PLANT_KOTYK, 60, 60},
                  {PLANT_LIME_KILN, 60, 30},      {PLANT_LUYBEN_4X4, 60, 30},
                  {PLANT_LUYBEN_VINANTE, 60, 15}, {PLANT_PACKED_BED, 60, 3},
                  {PLANT_SHELL, 1, 10},           {PLANT_WOOD_BERRY, 60, 60}};
    for (unsigned k = 0; k < sizeof plants / sizeof plants[0]; k++) {
        char where[80];
        snprintf(where, sizeof where, "plant %u", plants[k].number);
        take_plant(plants[k].number, 0.005, plants[k].unit_s);
        config.h_s = (real_t)plants[k].h_s;
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, run(), where);
        TEST_ASSERT_EQUAL_INT_MESSAGE(PAIRING_DETERMINED, a.verdict, where);
        same_pairs();
        TEST_ASSERT_EQUAL_UINT8_MESSAGE(known.rank, a.rank, where);
        TEST_ASSERT_TRUE_MESSAGE(a.designed, where);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, a.design_error, where);
        TEST_ASSERT_TRUE_MESSAGE(a.sensitivity.s_nominal <= REAL_C(2.0), where);
        TEST_ASSERT_TRUE_MESSAGE(a.sensitivity.factor <= REAL_C(1.0), where);
        for (unsigned n = 0; n < a.pairs.n; n++) {
            const struct tuning *t = &a.loops.tuning[n];
            const struct trial_loop *p = &a.predicted[n];
            TEST_ASSERT_TRUE_MESSAGE(t->gain > 0 && t->ti_s > 0 && t->td_s == 0, where);
            TEST_ASSERT_TRUE_MESSAGE(p->iae > 0 && p->peak >= 0 && p->peak < REAL_C(0.6), where);
            TEST_ASSERT_TRUE_MESSAGE(p->settled_s > 0 && p->moved > 0, where);
        }
    }
}

static void every_loop_gets_a_prediction_with_its_gain_raised_where_that_is_wanted(void)
{
    take_plant(PLANT_WOOD_BERRY, 0.005, 60);
    config.probe = REAL_C(1.5);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    config.probe = 0;
    for (unsigned n = 0; n < a.pairs.n; n++) {
        TEST_ASSERT_TRUE(a.probe[n].moved >= REAL_C(1.0) && a.probe[n].moved <= REAL_C(2.0));
        TEST_ASSERT_TRUE(a.probe[n].others > 0);
        TEST_ASSERT_FALSE(a.probe[n].planned);
    }
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_FALSE(a.probe[0].moved > 0);
}

static void wood_berry_is_what_the_books_say(void)
{
    take_plant(PLANT_WOOD_BERRY, 0.005, 60);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_TRUE(a.has_lambda);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 2.009, (double)a.lambda.value[0][0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 2.009, (double)a.pair_lambda[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 1.0 / 2.009, (double)a.niederlinski);
    TEST_ASSERT_EQUAL_INT(TUNING_REVERSE, a.loops.tuning[0].action); /* reflux raises xD */
    TEST_ASSERT_EQUAL_INT(TUNING_DIRECT, a.loops.tuning[1].action);  /* steam lowers xB */
    TEST_ASSERT_EQUAL_UINT8(1, a.layout.structure.blocks);
    TEST_ASSERT_EQUAL_UINT8(0, a.n_null);
}

static void luyben_vinante_has_its_relative_gain(void)
{
    take_plant(PLANT_LUYBEN_VINANTE, 0.005, 60);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 1.60, (double)a.pair_lambda[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 1.60, (double)a.pair_lambda[1]);
}

static void the_furnace_is_one_block_of_four_on_its_diagonal(void)
{
    take_plant(PLANT_FURNACE, 0.005, 60);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_EQUAL_UINT8(1, a.layout.structure.parts);
    for (unsigned n = 0; n < 4; n++) {
        TEST_ASSERT_EQUAL_UINT8(n, a.pairs.output[n]);
        TEST_ASSERT_EQUAL_UINT8(n, a.pairs.input[n]);
    }
}

static void the_paper_machine_is_not_determined_however_well_its_gains_are_known(void)
{
    static const double sds[] = {0.0, 1e-6, 1e-3, 0.02};
    for (unsigned k = 0; k < sizeof sds / sizeof sds[0]; k++) {
        take_plant(PLANT_PAPER_MACHINE, sds[k], 1);
        config.h_s = 1;
        TEST_ASSERT_EQUAL_INT(ERR_OK, run());
        TEST_ASSERT_NOT_EQUAL_INT(PAIRING_DETERMINED, a.verdict);
        TEST_ASSERT_FALSE(a.designed);
        TEST_ASSERT_TRUE(a.rank < 5);
        if (sds[k] > 0.01)
            continue; /* a second direction is lost in that */
        TEST_ASSERT_EQUAL_UINT8(4, a.rank);
        TEST_ASSERT_EQUAL_UINT8(1, a.n_null);
        /* Inputs that do nothing together, outputs that cannot be told apart. */
        for (unsigned j = 0; j < 5; j++) {
            double sum = 0.0, most = 0.0;
            for (unsigned i = 0; i < 5; i++) {
                double part = known.gain[j][i] * (double)a.null_input[i];
                sum += part;
                most = fmax(most, fabs(part));
            }
            TEST_ASSERT_DOUBLE_WITHIN(0.01 * (most + 0.1), 0.0, sum);
        }
        for (unsigned i = 0; i < 5; i++) {
            double sum = 0.0;
            for (unsigned j = 0; j < 5; j++)
                sum += known.gain[j][i] * (double)a.null_output[j];
            TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.0, sum);
        }
        TEST_ASSERT_TRUE((a.certainty.ambiguous_outputs & 0x0Cu) != 0); /* y3, y4 */
    }
}

static void of_more_outputs_than_inputs_as_many_are_chosen(void)
{
    take_plant(PLANT_SHELL, 0.005, 60);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_EQUAL_UINT8(3, a.pairs.n);
    same_pairs();
    TEST_ASSERT_EQUAL_UINT8(3, a.loops.pairs.n);
}

static void a_gain_of_unsure_sign_gets_no_loop(void)
{
    memset(&a, 0, sizeof a);
    a.plant.outputs = a.plant.inputs = 2;
    a.plant.element[0][0] = (struct fopdt){.gain = 1, .time_constant_s = 600};
    a.plant.element[1][1] = (struct fopdt){.gain = REAL_C(0.1), .time_constant_s = 600};
    a.plant.gain_sd[0][0] = REAL_C(0.01);
    a.plant.gain_sd[1][1] = REAL_C(0.1);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_EQUAL_INT(PAIRING_UNDETERMINED, a.verdict);
    TEST_ASSERT_EQUAL_HEX16(0x2, a.certainty.ambiguous_outputs);
    TEST_ASSERT_FALSE(a.designed);
    a.plant.gain_sd[1][1] = REAL_C(0.01);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_EQUAL_INT(PAIRING_DETERMINED, a.verdict);
}

static void gains_hardly_known_leave_the_pairing_open(void)
{
    take_plant(PLANT_PACKED_BED, 0.2, 60);
    config.h_s = 3;
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_EQUAL_INT(PAIRING_UNDETERMINED, a.verdict);
    TEST_ASSERT_TRUE(a.probability < REAL_C(0.95));
    TEST_ASSERT_FALSE(a.designed);
}

/* Plants that the true one may be: every dead time of the paired elements by so much longer, member by member. */
static double longer_most;
static uint32_t drawn;
static void draw_longer(const void *context, uint16_t member, uint8_t output,
                        struct interact_plant *plant)
{
    if (output == 0)
        *plant = *(const struct interact_plant *)context;
    drawn |= 1u << member;
    plant->element[output][output].dead_time_s *= (real_t)(1.0 + longer_most * member / 23.0);
}

static void wood_berry_drawn(double longer)
{
    take_plant(PLANT_WOOD_BERRY, 0.005, 60);
    longer_most = longer;
    drawn = 0;
    config.members = 24;
    config.draw = draw_longer;
    config.context = &a.plant;
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_TRUE(a.designed);
}

static void the_settings_bear_every_plant_that_is_drawn(void)
{
    wood_berry_drawn(0.0);
    struct loops alone = a.loops;
    TEST_ASSERT_TRUE(a.sensitivity.s_worst <= REAL_C(2.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, (double)a.sensitivity.s_nominal,
                              (double)a.sensitivity.s_worst); /* all of them are the plant */
    wood_berry_drawn(4.0);
    TEST_ASSERT_TRUE(a.sensitivity.s_worst <= REAL_C(2.0));
    TEST_ASSERT_TRUE(a.sensitivity.s_worst > a.sensitivity.s_nominal);
    TEST_ASSERT_TRUE(a.loops.tuning[0].gain < REAL_C(0.7) * alone.tuning[0].gain);
}

static void plants_that_are_drawn_are_asked_for_by_number_and_no_others(void)
{
    wood_berry_drawn(1.0);
    TEST_ASSERT_EQUAL_HEX32(0xffffff, drawn);
}

static void a_shape_that_is_unstable_or_no_number_is_refused(void)
{
    static const real_t bad[] = {REAL_C(-1.0), NAN, INFINITY};
    for (unsigned i = 0; i < 3; i++) {
        take_plant(PLANT_WOOD_BERRY, 0.01, 60);
        a.plant.shape[1][0].square_s2 = bad[i];
        TEST_ASSERT_EQUAL_INT(i == 0 ? ERR_RANGE : ERR_NOT_FINITE, analysis_begin(&a, &config));
    }
    take_plant(PLANT_WOOD_BERRY, 0.01, 60);
    a.plant.shape[1][0].zero_s = NAN;
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, analysis_begin(&a, &config));
}

static void a_noisy_measurement_gets_a_smaller_gain(void)
{
    static real_t noise[INTERACT_MAX];
    take_plant(PLANT_WOOD_BERRY, 0.01, 60);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    real_t gain = a.loops.tuning[0].gain;
    config.noise_sd = noise;
    noise[0] = REAL_C(0.01);
    noise[1] = REAL_C(0.0001);
    take_plant(PLANT_WOOD_BERRY, 0.01, 60);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_TRUE(a.designed);
    TEST_ASSERT_TRUE(a.loops.tuning[0].gain < REAL_C(0.5) * gain);
}

static void more_loops_than_the_board_runs_are_said_to_be_too_many(void)
{
    take_plant(PLANT_FURNACE, 0.005, 60);
    config.loops_max = 3;
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_EQUAL_INT(PAIRING_DETERMINED, a.verdict);
    TEST_ASSERT_FALSE(a.designed);
    TEST_ASSERT_EQUAL_INT(ERR_FULL, a.design_error);
}

/* Columns like Wood and Berry's side by side, each second one ten times as slow. */
static void take_columns(unsigned n)
{
    known_plant(PLANT_WOOD_BERRY, &known);
    memset(&a, 0, sizeof a);
    a.plant.outputs = a.plant.inputs = (uint8_t)(2u * n);
    for (unsigned j = 0; j < 2u * n; j++)
        for (unsigned i = 0; i < 2u * n; i++) {
            a.plant.gain_sd[j][i] = REAL_C(0.01);
            if (j / 2 != i / 2)
                continue;
            real_t unit_s = j / 2 % 2 != 0 ? 600 : 60;
            a.plant.element[j][i] = known.plant.element[j % 2][i % 2];
            a.plant.element[j][i].time_constant_s *= unit_s;
            a.plant.element[j][i].dead_time_s *= unit_s;
        }
    config.h_s = REAL_C(15.0);
    config.loops_max = 16;
}

static void independent_parts_are_told_apart_and_have_settings_of_their_own(void)
{
    static struct analysis two;
    take_columns(2);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_TRUE(a.layout.has_structure);
    TEST_ASSERT_EQUAL_UINT8(2, a.layout.structure.parts);
    TEST_ASSERT_TRUE(a.designed);
    TEST_ASSERT_TRUE(a.sensitivity.factor > REAL_C(0.5));
    two = a;
    take_columns(8);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_EQUAL_UINT8(8, a.layout.structure.parts);
    TEST_ASSERT_TRUE(a.designed);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, (double)two.sensitivity.s_nominal,
                              (double)a.sensitivity.s_nominal);
    for (unsigned k = 0; k < 16; k++) {
        double want = (double)two.loops.tuning[k % 4].gain;
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * want, want, (double)a.loops.tuning[k].gain);
    }
}

/* A coupling that is not seen between two columns, but is there in the estimates, parts them no less. */
static void effects_within_the_noise_join_no_parts(void)
{
    take_columns(2);
    for (unsigned j = 0; j < 4; j++)
        for (unsigned i = 0; i < 4; i++)
            if (j / 2 != i / 2)
                a.plant.element[j][i] = (struct fopdt){REAL_C(0.02), REAL_C(60.0), REAL_C(600.0)};
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_EQUAL_UINT8(2, a.layout.structure.parts);
    TEST_ASSERT_TRUE(a.designed);
    TEST_ASSERT_TRUE(a.sensitivity.factor > REAL_C(0.5));
}

/* Work that a large plant asks of the background. */
static void a_plant_of_16_by_16_comes_to_an_end(void)
{
    struct random_source r = {SEED};
    memset(&a, 0, sizeof a);
    a.plant.outputs = a.plant.inputs = 16;
    for (unsigned j = 0; j < 16; j++)
        for (unsigned i = 0; i < 16; i++) {
            double gain = i == j ? 1.0 : 0.1 * ((double)random_below(&r, 1000) / 500.0 - 1.0);
            a.plant.element[j][i] =
                (struct fopdt){.gain = (real_t)gain,
                               .time_constant_s = (real_t)(300 + random_below(&r, 600)),
                               .dead_time_s = (real_t)random_below(&r, 120)};
            a.plant.gain_sd[j][i] = REAL_C(0.005);
        }
    config.loops_max = 16;
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_EQUAL_INT(PAIRING_DETERMINED, a.verdict);
    TEST_ASSERT_TRUE(a.designed);
    TEST_ASSERT_EQUAL_INT(DECOUPLER_TOO_MANY, a.decoupler);
    for (unsigned n = 0; n < 16; n++)
        TEST_ASSERT_EQUAL_UINT8(n, a.pairs.input[n]);
    char text[60];
    snprintf(text, sizeof text, "16 x 16: %u pieces of work", pieces);
    TEST_MESSAGE(text);
}

/* The figure of the loops that are proposed, once more; NAN where a step does not settle in the first time that is tried. */
static double figure(bool load)
{
    static struct trial t;
    double sum = 0.0;
    for (uint8_t k = 0; k < a.pairs.n; k++) {
        struct trial_config c = {
            .loop = k, .load = load, .size = config.step, .setpoint_weight = 1};
        TEST_ASSERT_EQUAL_INT(ERR_OK, trial_begin(&t, &a.plant, &a.loops, &c));
        while (trial_step(&t) == ERR_BUSY)
            ;
        if (a.predicted[k].settled_s >= REAL_C(0.95) * t.duration_s)
            return NAN;
        for (uint8_t i = 0; i < a.pairs.n; i++)
            sum += (double)(t.loop[i].iae / config.step) / a.pairs.n;
    }
    return sum;
}

/* Two outputs that two inputs move nearly alike, with times of each element or with the same ones, for which a static decoupler
 * is exact; or Folami's four by four, with other times. */
static void take_interacting(struct random_source *r, bool two, bool alike)
{
    if (!two)
        take_plant(PLANT_FOLAMI, 0.005, 60);
    else
        memset(&a, 0, sizeof a);
    for (unsigned j = 0; two && j < 2; j++)
        for (unsigned i = 0; i < 2; i++)
            a.plant.element[j][i] = (struct fopdt){
                .gain = i == j ? 1 : REAL_C(0.75) + REAL_C(0.01) * (real_t)random_below(r, 21),
                .time_constant_s = 600,
                .dead_time_s = 150};
    if (two)
        a.plant.outputs = a.plant.inputs = 2;
    for (unsigned j = 0; !alike && j < a.plant.outputs; j++)
        for (unsigned i = 0; i < a.plant.inputs; i++) {
            a.plant.element[j][i].time_constant_s *= (real_t)(500 + random_below(r, 1000)) / 1000;
            a.plant.element[j][i].dead_time_s *= (real_t)(500 + random_below(r, 1000)) / 1000;
        }
}

static void a_decoupler_is_proposed_only_where_it_is_predicted_to_be_better(void)
{
    struct random_source r = {SEED};
    unsigned with = 0, without = 0, checked = 0;
    for (unsigned n = 0; n < 60; n++) {
        take_interacting(&r, n % 3 > 0, n % 3 == 2);
        config.h_s = 10;
        TEST_ASSERT_EQUAL_INT(ERR_OK, run());
        const struct analysis_figures *f = a.figures;
        if (!a.designed || (a.decoupler != DECOUPLER_USED && a.decoupler != DECOUPLER_NO_BETTER))
            continue;
        bool used = a.decoupler == DECOUPLER_USED;
        TEST_ASSERT_TRUE(f[0].setpoints > 0 && f[0].loads > 0);
        if (f[1].setpoints > 0) {
            bool better = f[0].setpoints * f[0].loads < REAL_C(0.81) * f[1].setpoints * f[1].loads;
            TEST_ASSERT_EQUAL(better, used);
        }
        TEST_ASSERT_EQUAL(used, a.loops.decoupler == &a.d);
        TEST_ASSERT_EQUAL(used, real_abs(a.d.value[0][1]) > 0);
        double setpoints = figure(false), loads = figure(true);
        if (isfinite(setpoints)) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-4 * setpoints, setpoints, (double)f[!used].setpoints);
            TEST_ASSERT_DOUBLE_WITHIN(1e-4 * loads, loads, (double)f[!used].loads);
            checked++;
        }
        with += used;
        without += !used;
    }
    char text[60];
    snprintf(text, sizeof text, "with a decoupler %u, without %u, %u again", with, without,
             checked);
    TEST_MESSAGE(text);
    TEST_ASSERT_TRUE(with >= 3 && without >= 5 && checked >= 5);
}

static void the_same_plant_gives_the_same_answer(void)
{
    static struct analysis before;
    take_plant(PLANT_SHELL, 0.02, 60);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    before = a;
    take_plant(PLANT_SHELL, 0.02, 60);
    TEST_ASSERT_EQUAL_INT(ERR_OK, run());
    TEST_ASSERT_EQUAL_MEMORY(&before.predicted, &a.predicted, sizeof a.predicted);
    TEST_ASSERT_EQUAL_FLOAT((float)before.probability, (float)a.probability);
}

static void what_is_no_plant_or_no_setting_is_refused(void)
{
#define REFUSED(what)                                                                              \
    do {                                                                                           \
        setUp();                                                                                   \
        take_plant(PLANT_WOOD_BERRY, 0.005, 60);                                                   \
        what;                                                                                      \
        TEST_ASSERT_NOT_EQUAL_INT_MESSAGE(ERR_OK, analysis_begin(&a, &config), #what);             \
    } while (0)
    REFUSED(config.h_s = 0);
    REFUSED(config.h_s = (real_t)NAN);
    REFUSED(config.confidence = REAL_C(0.5));
    REFUSED(config.confidence = 1);
    REFUSED(config.confidence = (real_t)NAN);
    REFUSED(config.step = 0);
    REFUSED(config.step = (real_t)NAN);
    REFUSED(a.plant.outputs = 0);
    REFUSED(a.plant.inputs = INTERACT_MAX + 1);
    REFUSED(a.plant.element[1][1].gain = (real_t)NAN);
    REFUSED(a.plant.element[0][1].gain = (real_t)INFINITY);
    REFUSED(a.plant.element[0][1].time_constant_s = -1);
    REFUSED(a.plant.element[0][1].dead_time_s = (real_t)NAN);
    REFUSED(a.plant.gain_sd[0][0] = -1);
    REFUSED(a.plant.gain_sd[0][0] = (real_t)NAN);
    REFUSED(a.given[1] = 3); /* of two inputs */
#undef REFUSED
}

int main(void)
{
    printf("seed %u\n", SEED);
    UNITY_BEGIN();
    RUN_TEST(every_plant_gets_its_pairing_and_settings_that_settle);
    RUN_TEST(every_loop_gets_a_prediction_with_its_gain_raised_where_that_is_wanted);
    RUN_TEST(wood_berry_is_what_the_books_say);
    RUN_TEST(luyben_vinante_has_its_relative_gain);
    RUN_TEST(the_furnace_is_one_block_of_four_on_its_diagonal);
    RUN_TEST(the_paper_machine_is_not_determined_however_well_its_gains_are_known);
    RUN_TEST(of_more_outputs_than_inputs_as_many_are_chosen);
    RUN_TEST(a_gain_of_unsure_sign_gets_no_loop);
    RUN_TEST(gains_hardly_known_leave_the_pairing_open);
    RUN_TEST(the_settings_bear_every_plant_that_is_drawn);
    RUN_TEST(plants_that_are_drawn_are_asked_for_by_number_and_no_others);
    RUN_TEST(a_shape_that_is_unstable_or_no_number_is_refused);
    RUN_TEST(a_noisy_measurement_gets_a_smaller_gain);
    RUN_TEST(more_loops_than_the_board_runs_are_said_to_be_too_many);
    RUN_TEST(independent_parts_are_told_apart_and_have_settings_of_their_own);
    RUN_TEST(effects_within_the_noise_join_no_parts);
    RUN_TEST(a_plant_of_16_by_16_comes_to_an_end);
    RUN_TEST(a_decoupler_is_proposed_only_where_it_is_predicted_to_be_better);
    RUN_TEST(the_same_plant_gives_the_same_answer);
    RUN_TEST(what_is_no_plant_or_no_setting_is_refused);
    return UNITY_END();
}
