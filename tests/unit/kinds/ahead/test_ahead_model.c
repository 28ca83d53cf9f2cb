/* Where the controller `ahead` takes its column to be (kinds/ahead/column_ahead_model.h): corrections at places that something is said of, between
 * them and beyond; another order of inputs; the end of what a mole fraction can be. */
#include "ahead_bench.h"

static struct ahead_model m;
static real_t numbers[400];

void setUp(void)
{
    bench_pilot();
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_begin(&m, &record, numbers));
    m.h = 10;
    m.parts = 3;
}
void tearDown(void) {}

/* ln(x/(1 - x)) */
static double shift_of(double x)
{
    return log(x / (1 - x));
}

static double profile(unsigned stage)
{
    return (double)m.table.profile[stage - 1];
}

static void said_fraction(struct ahead_reading *said, unsigned stage, double x)
{
    *said = (struct ahead_reading){
        .stage = (uint8_t)(stage - 1), .component = 0, .is_fraction = true, .value = (real_t)x};
}

static void fractions_that_are_said_are_taken_and_stages_between_go_along(void)
{
    struct ahead_reading said[2];
    double first = profile(4) + 0.05, second = profile(9) - 0.04;
    said_fraction(&said[0], 4, first);
    said_fraction(&said[1], 9, second);
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_correct(&m, said, 2, 1));
    double low = shift_of(first) - shift_of(profile(4));
    double high = shift_of(second) - shift_of(profile(9));
    for (unsigned s = 1; s <= 12; s++) {
        double part = s < 4 ? 0 : s > 9 ? 1 : (s - 4) / 5.0;
        double wanted = low + part * (high - low);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, wanted,
                                  shift_of((double)m.x[s - 1]) - shift_of(profile(s)));
    }
}

static void three_places_bend_the_correction_at_the_middle_one(void)
{
    struct ahead_reading said[3];
    said_fraction(&said[0], 2, profile(2));
    said_fraction(&said[1], 6, profile(6) + 0.1);
    said_fraction(&said[2], 10, profile(10));
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_correct(&m, said, 3, 1));
    double middle = shift_of(profile(6) + 0.1) - shift_of(profile(6));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, shift_of((double)m.x[1]) - shift_of(profile(2)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, middle / 2, shift_of((double)m.x[3]) - shift_of(profile(4)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, middle, shift_of((double)m.x[5]) - shift_of(profile(6)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, middle / 2, shift_of((double)m.x[7]) - shift_of(profile(8)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, shift_of((double)m.x[11]) - shift_of(profile(12)));
}

static void a_part_of_what_is_said_is_taken_in_a_step(void)
{
    struct ahead_reading said;
    said_fraction(&said, 6, profile(6) + 0.1);
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_correct(&m, &said, 1, REAL_C(0.25)));
    double whole = shift_of(profile(6) + 0.1) - shift_of(profile(6));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, whole / 4, shift_of((double)m.x[5]) - shift_of(profile(6)));
}

static void temperature_is_met(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_look(&m, m.x));
    struct ahead_reading said = {.stage = 5, .component = 0};
    said.value = m.column.temperature[5] + 3;
    for (unsigned k = 0; k < 4; k++)
        TEST_ASSERT_EQUAL(ERR_OK, ahead_model_correct(&m, &said, 1, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, (double)said.value, (double)m.column.temperature[5]);
}

static void a_temperature_is_met_after_a_few_corrections(void)
{
    temperature_is_met();
}

static void a_temperature_of_four_components_is_met_too(void)
{
    static real_t many[4000];
    put_components_twice(&record);
    TEST_ASSERT_TRUE(ahead_model_numbers(12, 4) <= sizeof many / sizeof many[0]);
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_begin(&m, &record, many));
    temperature_is_met();
}

static void at_rest_again_it_is_to_the_bit_what_it_was_at_first(void)
{
    real_t first[12];
    struct ahead_reading said;
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_look(&m, m.x));
    memcpy(first, m.column.temperature, sizeof first);
    said_fraction(&said, 6, profile(6) + 0.1);
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_correct(&m, &said, 1, 1));
    ahead_model_rest(&m);
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_look(&m, m.x));
    TEST_ASSERT_EQUAL_MEMORY(first, m.column.temperature, sizeof first);
}

/* In one correction a mole fraction goes by 0.2 at most. */
static void what_is_far_away_is_met_in_pieces(void)
{
    struct ahead_reading said;
    said_fraction(&said, 6, 0.95);
    double before = profile(6);
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_correct(&m, &said, 1, 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, before + 0.2, (double)m.x[5]);
}

static void no_mole_fraction_leaves_its_ends(void)
{
    struct ahead_reading said;
    for (unsigned k = 0; k < 20; k++) {
        said_fraction(&said, 6, k < 10 ? -0.5 : 1.5);
        TEST_ASSERT_EQUAL(ERR_OK, ahead_model_correct(&m, &said, 1, 1));
        for (unsigned s = 0; s < 12; s++)
            TEST_ASSERT_TRUE(m.x[s] >= 0 && m.x[s] <= 1);
    }
}

static void mass_fractions_are_those_of_the_components_masses(void)
{
    /* 36 per cent by weight of TCE in PCE is the table's feed. */
    TEST_ASSERT_EQUAL(ERR_OK, ahead_model_look(&m, m.x));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.41519314,
                              (double)ahead_model_mole_fraction(&m, 5, 0, REAL_C(0.36)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, (double)ahead_model_mole_fraction(&m, 5, 0, REAL_C(1.2)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, (double)ahead_model_mole_fraction(&m, 5, 0, REAL_C(-0.2)));
}

static void the_feed_s_fractions_add_up(void)
{
    ahead_model_take_fraction(&m.inputs, 2, 0, REAL_C(0.3));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, (double)m.inputs.feed_fraction[1]);
    ahead_model_take_fraction(&m.inputs, 2, 0, REAL_C(1.3));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, (double)m.inputs.feed_fraction[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, (double)m.inputs.feed_fraction[1]);
    struct column_inputs three = {.feed_fraction = {REAL_C(0.5), REAL_C(0.4), REAL_C(0.1)}};
    ahead_model_take_fraction(&three, 3, 0, REAL_C(0.8));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.8 / 1.2, (double)three.feed_fraction[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.4 / 1.2, (double)three.feed_fraction[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, (double)three.feed_fraction[2]);
}

/* ---- the kind ---- */

/* The same places in whatever order they are named. */
static void the_order_of_inputs_does_not_matter(void)
{
    double outputs[2][2];
    for (unsigned turned = 0; turned < 2; turned++) {
        static const unsigned other[IN_FRACTION] = {4, 0, 5, 2, 1, 3};
        bench_pilot();
        for (unsigned k = 0; k < IN_FRACTION && turned; k++)
            settings.place[k][AHEAD_STAGE] = (uint16_t)stage_seen[other[k]];
        begin();
        ask_for(at_top() + 0.3, at_bottom() - 1);
        for (unsigned n = 0; n < 5; n++) {
            measure();
            for (unsigned k = 0; k < IN_FRACTION && turned; k++)
                input[k] = N(fraction_of(&setup.input[k], plant_temperature(stage_seen[other[k]])));
            if (n == 0) {
                outputs_in_effect();
                kind->follow(state, &io);
            }
            kind->step(state, &io);
            apply();
            plant_runs((double)INTERVAL_S);
        }
        outputs[turned][0] = mv[TOP];
        outputs[turned][1] = mv[BOTTOM];
    }
    /* Where the model was before it begins differs a little. */
    TEST_ASSERT_DOUBLE_WITHIN(2e-3, outputs[0][0], outputs[1][0]);
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, outputs[0][1], outputs[1][1]);
}

static void another_place_of_an_input_begins_anew(void)
{
    begin();
    ticks(3);
    block()->missed[TOP] = 5;
    settings.tau_s[TOP] = 90; /* the same places: goes on */
    configure(true);
    TEST_ASSERT_TRUE(block()->missed[TOP] > 4);
    settings.place[2][AHEAD_STAGE] = 5;
    configure(true);
    TEST_ASSERT_TRUE(block()->missed[TOP] < 1);
}

static void a_limit_that_has_been_passed_is_none(void)
{
    begin();
    tick();
    block()->law.lo[TOP] = REAL_C(0.5); /* above where the MV is */
    tick();
    TEST_ASSERT_TRUE(block()->law.lo[TOP] < REAL_C(1e-6));
    mv_lo[TOP] = 2.55;
    ask_for(at_top() + 1, at_bottom());
    ticks(3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 2.55 / 12, (double)block()->law.lo[TOP]);
    ticks(3); /* at the limit it stays known */
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 2.55 / 12, (double)block()->law.lo[TOP]);
}

static void where_it_begins_without_a_solution_it_says_so_and_then_begins_anew(void)
{
    begin();
    block()->m.x[3] = (real_t)NAN;
    io.requests.gives_up = NULL;
    follow();
    TEST_ASSERT_NOT_NULL(io.requests.gives_up);
    io.requests.gives_up = NULL;
    follow();
    TEST_ASSERT_NULL(io.requests.gives_up);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(fractions_that_are_said_are_taken_and_stages_between_go_along);
    RUN_TEST(three_places_bend_the_correction_at_the_middle_one);
    RUN_TEST(a_part_of_what_is_said_is_taken_in_a_step);
    RUN_TEST(a_temperature_is_met_after_a_few_corrections);
    RUN_TEST(a_temperature_of_four_components_is_met_too);
    RUN_TEST(at_rest_again_it_is_to_the_bit_what_it_was_at_first);
    RUN_TEST(what_is_far_away_is_met_in_pieces);
    RUN_TEST(no_mole_fraction_leaves_its_ends);
    RUN_TEST(mass_fractions_are_those_of_the_components_masses);
    RUN_TEST(the_feed_s_fractions_add_up);
    RUN_TEST(the_order_of_inputs_does_not_matter);
    RUN_TEST(another_place_of_an_input_begins_anew);
    RUN_TEST(a_limit_that_has_been_passed_is_none);
    RUN_TEST(where_it_begins_without_a_solution_it_says_so_and_then_begins_anew);
    return UNITY_END();
}
