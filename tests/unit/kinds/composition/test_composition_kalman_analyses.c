/* The kind `composition` with a covariance and analyses that come now and then, late: the model is off where they are taken, and that is found;
 * what is wrong, late, silent or too old is told and moves nothing. */
#include "composition_filter_bench.h"

#define FIRST  FURTHER
#define SECOND (FURTHER + 1)
#define EVERY  180u /* ticks: half an hour */
#define DELAY  120u /* 20 minutes */
#define PAST   4096u

static struct column_record of_plant;
static float past[2][PAST]; /* what the plant had */
static unsigned now;
static float wrong[2]; /* added to an analysis */
static float older;    /* s, added to its age */

static void analysis_at(unsigned k, unsigned stage)
{
    setup.inputs = (uint8_t)(k + 1);
    all_settings.s.role[k] = IS_ANALYSIS;
    all_settings.s.place[k][AT_STAGE] = (uint16_t)stage;
    all_settings.s.place[k][OF_COMPONENT] = 1;
    setup.input[k] = (struct block_signal){0, 1, false};
}

void setUp(void)
{
    memset(past, 0, sizeof past);
    memset(wrong, 0, sizeof wrong);
    now = 0;
    older = 0;
}

void tearDown(void)
{
    workspace_share(NULL);
    bench_frees();
}

/* The plant goes on and its analysers show what they have. */
static void analysed(unsigned n)
{
    while (n-- > 0) {
        plant_runs(1);
        now++;
        for (unsigned i = 0; FIRST + i < setup.inputs; i++) {
            unsigned k = FIRST + i, taken = (now - DELAY) / EVERY * EVERY;
            past[i][now] = true_fraction(all_settings.s.place[k][AT_STAGE]);
            bool shown = now >= EVERY + DELAY;
            age[k] = shown ? (float)((now - taken) * 10) + older : 1e4f;
            if (quality[k] == QUALITY_GOOD || quality[k] == QUALITY_MISSING)
                quality[k] = shown ? QUALITY_GOOD : QUALITY_MISSING;
            put(k, shown ? past[i][taken] + wrong[i] : 0);
        }
        tick_of(&filter);
    }
}

/* A plant whose stages are worse than the model has them, but with the temperatures: the model is off at its ends. */
static void begin_off(unsigned way)
{
    way_begins(way);
    analysis_at(FIRST, 1);
    all_settings.s.feed_z = 0;
    all_settings.model = 0.02f; /* what is off stays off */
    all_settings.s.late_s = 4000;
    quality[FIRST] = QUALITY_MISSING;
    plant_begins();
    PUT_RECORD(&of_plant, pilot_values);
    change_record(&of_plant, COLUMN_TABLE_EFFICIENCY, 0.84f);
    struct composition_settings of_filter = all_settings.s;
    all_settings.s.method = METHOD_GEOMETRIC;
    setup.named = &of_plant;
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(&plant, &setup, false));
    all_settings.s = of_filter;
    setup.named = &record;
    for (unsigned n = 0; n < 20; n++) {
        plant.model.h = 3600;
        TEST_ASSERT_EQUAL(ERR_OK, composition_model_predict(&plant.model));
    }
    plant.model.h = 10;
    measure();
    filter_begins();
}

static float error_of(unsigned k)
{
    return given(k) - true_fraction(all_settings.s.point[k][AT_STAGE]);
}

static void an_offset_of_the_model_is_gone_after_three_samples(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        setUp();
        begin_off(i);
        analysed(EVERY + DELAY - 1);
        float off = fabsf(error_of(BOTTOM_FRACTION));
        analysed(2 * EVERY + 20);
        TEST_ASSERT_TRUE_MESSAGE(off > 0.002f, filter_ways[i].name);
        TEST_ASSERT_TRUE_MESSAGE(fabsf(error_of(BOTTOM_FRACTION)) < 0.2f * off,
                                 filter_ways[i].name);
        TEST_ASSERT_EQUAL(0, io.requests.raised);
        analysed(4 * EVERY);
        TEST_ASSERT_TRUE(fabsf(error_of(BOTTOM_FRACTION)) < 0.2f * off);
    }
}

static void without_an_offset_analyses_move_the_model_itself(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        setUp();
        begin_off(i);
        all_settings.s.offset = 0;
        filter_begins();
        analysed(EVERY + DELAY - 1);
        float off = fabsf(error_of(BOTTOM_FRACTION));
        analysed(5);
        if (filter_ways[i].covariance != COVARIANCE_STEADY) /* which works no analyses in */
            TEST_ASSERT_EQUAL_FLOAT_MESSAGE(0, value_named("correction_1"), filter_ways[i].name);
        TEST_ASSERT_TRUE_MESSAGE(fabsf(error_of(BOTTOM_FRACTION)) < off, filter_ways[i].name);
    }
}

static void one_that_is_far_off_is_told_and_not_believed(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        setUp();
        begin_off(i);
        analysed(4 * EVERY + DELAY + 30);
        float before = value_named("correction_1");
        wrong[0] = 0.2f;
        analysed(EVERY);
        TEST_ASSERT_TRUE_MESSAGE(raised(EVENT_NO_INPUT), filter_ways[i].name);
        TEST_ASSERT_EQUAL_FLOAT(FIRST + 1, event_value[EVENT_NO_INPUT]);
        TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[TOP_FRACTION]);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(3e-4f, before, value_named("correction_1"),
                                         filter_ways[i].name);
        wrong[0] = 0;
        analysed(EVERY);
        TEST_ASSERT_FALSE(raised(EVENT_NO_INPUT));
        TEST_ASSERT_EQUAL(QUALITY_GOOD, point_quality[TOP_FRACTION]);
    }
}

static void one_that_is_silent_is_missed_and_the_correction_stays(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        setUp();
        begin_off(i);
        analysed(4 * EVERY + DELAY + 30);
        float before = value_named("correction_1");
        for (unsigned n = 0; n < 400; n++) { /* the last sample stands */
            float y = num_to_float(input[FIRST]), old = age[FIRST] + 10;
            plant_runs(1);
            put(FIRST, y);
            age[FIRST] = old;
            tick_of(&filter);
        }
        TEST_ASSERT_TRUE_MESSAGE(raised(EVENT_NO_INPUT), filter_ways[i].name);
        TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[TOP_FRACTION]);
        TEST_ASSERT_FLOAT_WITHIN(3e-4f, before, value_named("correction_1"));
    }
}

static void one_that_is_not_good_counts_for_nothing(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++)
        for (uint8_t q = QUALITY_UNCERTAIN; q <= QUALITY_BAD; q++) {
            setUp();
            begin_off(i);
            analysed(2 * EVERY + DELAY + 30);
            float before = value_named("correction_1");
            quality[FIRST] = q;
            wrong[0] = 0.02f;
            analysed(2 * EVERY);
            TEST_ASSERT_TRUE_MESSAGE(raised(EVENT_NO_INPUT), filter_ways[i].name);
            TEST_ASSERT_FLOAT_WITHIN_MESSAGE(3e-4f, before, value_named("correction_1"),
                                             filter_ways[i].name);
        }
}

static void one_that_is_older_than_its_reach_is_told_and_left(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        setUp();
        begin_off(i);
        older = 3000;
        unsigned told = 0;
        for (unsigned n = 0; n < 3 * EVERY + DELAY; n++) {
            analysed(1);
            told += now > EVERY + DELAY && raised(EVENT_NO_INPUT);
        }
        TEST_ASSERT_TRUE_MESSAGE(told > 0, filter_ways[i].name);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(1e-6f, 0, value_named("correction_1"),
                                         filter_ways[i].name);
    }
}

static void two_analyses_have_an_offset_each(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        setUp();
        begin_off(i);
        analysis_at(SECOND, 12);
        quality[SECOND] = QUALITY_MISSING;
        filter_begins();
        wrong[1] = -0.002f; /* what the second says is its own affair */
        analysed(6 * EVERY + DELAY + 30);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(1e-3f, 0, error_of(BOTTOM_FRACTION), filter_ways[i].name);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(5e-4f, -0.002f, error_of(TOP_FRACTION),
                                         filter_ways[i].name);
        TEST_ASSERT_EQUAL(0, io.requests.raised);
    }
}

/* Each sample once, by whoever is there to take it in. */
static void a_sample_from_the_time_without_a_workspace_is_not_taken_twice(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        if (filter_ways[i].covariance == COVARIANCE_STEADY)
            continue;
        setUp();
        begin_off(i);
        analysed(2 * EVERY + 40);
        TEST_ASSERT_NULL(tell("free"));
        analysed(DELAY); /* the next is there */
        float before = value_named("correction_1");
        TEST_ASSERT_TRUE(fabsf(filter.b->analyses.analysis[0].surprise) > 1e-5f);
        TEST_ASSERT_NULL(tell("take"));
        analysed(10);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(1e-5f, before, value_named("correction_1"),
                                         filter_ways[i].name);
    }
}

static void a_sample_that_comes_while_the_workspace_is_given_back_counts(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        if (filter_ways[i].covariance == COVARIANCE_STEADY)
            continue;
        setUp();
        begin_off(i);
        analysed(EVERY + DELAY - 2);
        filter.idle = true; /* the job that is under way does not end */
        analysed(1);
        TEST_ASSERT_NULL(tell("free"));
        analysed(1);
        TEST_ASSERT_NOT_NULL(filter.b->filter.job);
        TEST_ASSERT_TRUE_MESSAGE(fabsf(value_named("correction_1")) > 1e-3f, filter_ways[i].name);
    }
}

static void what_is_begun_anew_is_not_moved_by_what_was_said_before(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        if (filter_ways[i].covariance == COVARIANCE_STEADY)
            continue;
        setUp();
        begin_off(i);
        analysed(EVERY + DELAY - 1);
        filter.idle = true;
        while (!filter.b->filter.analysed)
            analysed(1);
        TEST_ASSERT_NULL(tell("begin"));
        work_all(&filter);
        analysed(2);
        TEST_ASSERT_EQUAL_FLOAT_MESSAGE(0, filter.b->model.extra[0], filter_ways[i].name);
        TEST_ASSERT_EQUAL_FLOAT(0, value_named("correction_1"));
    }
}

static void what_analyses_said_of_the_model_outlasts_a_beginning(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        setUp();
        begin_off(i);
        analysed(4 * EVERY + DELAY + 30);
        float before = value_named("correction_1");
        TEST_ASSERT_TRUE(fabsf(before) > 1e-3f);
        TEST_ASSERT_NULL(tell("begin"));
        TEST_ASSERT_EQUAL_FLOAT(before, value_named("correction_1"));
        analysed(2 * LOCKED);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(0.3f * fabsf(before), before, value_named("correction_1"),
                                         filter_ways[i].name);
        kind->follow(filter.b, &io); /* the plant was away */
        TEST_ASSERT_EQUAL_FLOAT(0, value_named("correction_1"));
        TEST_ASSERT_EQUAL_FLOAT(0, filter.b->model.extra[0]);
    }
}

/* It waits for the job that is under way, and then there is none any more. */
static void a_sample_that_nobody_took_in_is_not_taken_in_later(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        if (filter_ways[i].covariance == COVARIANCE_STEADY)
            continue;
        setUp();
        begin_off(i);
        analysed(EVERY + DELAY - 2);
        filter.idle = true;
        analysed(4);
        TEST_ASSERT_TRUE(filter.b->analyses.analysis[0].fresh);
        TEST_ASSERT_NULL(tell("free"));
        filter.idle = false;
        analysed(4);
        TEST_ASSERT_NULL(filter.b->filter.job);
        TEST_ASSERT_NULL(tell("take"));
        analysed(20);
        TEST_ASSERT_TRUE(filter.b->filter.job != NULL);
        TEST_ASSERT_EQUAL_FLOAT_MESSAGE(0, value_named("correction_1"), filter_ways[i].name);
    }
}

static void another_reach_begins_analyses_anew_and_other_numbers_do_not(void)
{
    bench_pilot();
    analysis_at(FIRST, 1);
    all_settings.s.place[FIRST][OF_COMPONENT] = 2;
    accepted();
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(&block, &setup, false));
    struct composition_analysis *a = &block.analyses.analysis[0];
    TEST_ASSERT_EQUAL(composition_analysis_every(block.model.h, all_settings.s.reach_s), a->every);
    a->filled = 5;
    all_settings.tune[FIRST][TUNE_LAMBDA] = 0.5f;
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(&block, &setup, true));
    TEST_ASSERT_EQUAL(1, block.analyses.n);
    TEST_ASSERT_EQUAL(1, a->component);
    TEST_ASSERT_TRUE(a->share == REAL_C(0.5));
    TEST_ASSERT_EQUAL(5, a->filled);
    all_settings.s.reach_s *= 3;
    TEST_ASSERT_EQUAL(ERR_OK, kind->configure(&block, &setup, true));
    TEST_ASSERT_EQUAL(0, a->filled);
    TEST_ASSERT_EQUAL(composition_analysis_every(block.model.h, all_settings.s.reach_s), a->every);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_offset_of_the_model_is_gone_after_three_samples);
    RUN_TEST(without_an_offset_analyses_move_the_model_itself);
    RUN_TEST(one_that_is_far_off_is_told_and_not_believed);
    RUN_TEST(one_that_is_silent_is_missed_and_the_correction_stays);
    RUN_TEST(one_that_is_not_good_counts_for_nothing);
    RUN_TEST(one_that_is_older_than_its_reach_is_told_and_left);
    RUN_TEST(two_analyses_have_an_offset_each);
    RUN_TEST(a_sample_from_the_time_without_a_workspace_is_not_taken_twice);
    RUN_TEST(a_sample_that_comes_while_the_workspace_is_given_back_counts);
    RUN_TEST(what_is_begun_anew_is_not_moved_by_what_was_said_before);
    RUN_TEST(what_analyses_said_of_the_model_outlasts_a_beginning);
    RUN_TEST(a_sample_that_nobody_took_in_is_not_taken_in_later);
    RUN_TEST(another_reach_begins_analyses_anew_and_other_numbers_do_not);
    return UNITY_END();
}
