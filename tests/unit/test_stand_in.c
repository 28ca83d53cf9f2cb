/* An estimate as fall-back of a measurement: an observer, of this test alone, that follows its input while that is measured,
 * goes on alone without it, and can be made to say that it does not know. */
#include "block/block.h"
#include "exchange/block_settings.h"
#include "kinds/pid/pid.h"
#include "plan/plan_build.h"
#include "settings/block_pool.h"
#include "supervisor_bench.h"

struct coast_settings {
    float drift; /* of span, a step, while it goes on alone */
    uint16_t which;
};

struct coast {
    num_t value, drift;
    uint16_t which;
};

/* Inputs of each in its last step, and the answers it is to give. */
static struct {
    uint8_t quality;
    float age_s;
    num_t input;
    bool ignorant;
} told[2];

static const struct block_parameter coast_parameters[] = {
    {.id = 1,
     .type = BLOCK_FLOAT,
     .name = "drift",
     .unit = "-",
     .help = "alone",
     .lo = -1,
     .hi = 1},
    {.id = 2,
     .type = BLOCK_U16,
     .offset = 4,
     .name = "which",
     .unit = "-",
     .help = "of two",
     .hi = 1},
};

static uint32_t coast_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct coast);
}

static enum err coast_check(const struct block_setup *setup, struct block_fault *fault)
{
    fault->field = "inputs";
    fault->wanted = "needs an input and a point";
    return setup->inputs == 1 && setup->points == 1 ? ERR_OK : ERR_RANGE;
}

static enum err coast_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct coast *c = state;
    const struct coast_settings *settings = setup->settings;
    if (!retune)
        *c = (struct coast){0};
    c->drift = num_from_float(settings->drift);
    c->which = settings->which;
    return ERR_OK;
}

static void coast_step(void *state, struct block_io *io)
{
    struct coast *c = state;
    bool measured = quality_usable((enum quality)io->inputs.quality[0]);
    told[c->which].quality = io->inputs.quality[0];
    told[c->which].age_s = io->inputs.age_s[0];
    told[c->which].input = io->inputs.value[0];
    c->value = measured ? io->inputs.value[0] : num_add(c->value, c->drift);
    io->points.value[0] = c->value;
    io->points.quality[0] = told[c->which].ignorant ? QUALITY_BAD
                            : measured              ? QUALITY_GOOD
                                                    : QUALITY_UNCERTAIN;
}

static const struct block_kind coast_kind = {
    .name = "coast",
    .stage = STAGE_ESTIMATE,
    .parameter = coast_parameters,
    .parameters = 2,
    .settings_bytes = sizeof(struct coast_settings),
    .inputs_most = 1,
    .points_most = 1,
    .bytes = coast_bytes,
    .check = coast_check,
    .configure = coast_configure,
    .step = coast_step,
};

const struct block_kind *const block_kinds[] = {&pid_kind, &coast_kind};
const uint8_t block_kind_count = 2;

enum { GUESS = 4, OTHER = 5 };

static void put_observer(unsigned n, const char *input, const char *point, float drift)
{
    struct block_config *b = &bench.config.block[n];
    uint32_t needed, room;
    struct coast_settings settings = {.drift = drift, .which = (uint16_t)n};
    TEST_ASSERT_EQUAL(ERR_OK, record_make(&bench.config, (uint8_t)n, "coast", &needed, &room));
    strcpy(b->inputs, input);
    strcpy(b->points, point);
    memcpy(bench.config.pool + b->offset, &settings, sizeof settings);
}

/* T1 (60 to 160 degC) is observed as guess (0 to 200 degC), which moves 2 degC of T1 a tick when it is alone, and stands in
 * for T1. */
static void observed(void)
{
    put_all((const char *const[]){"meas5.name", "guess", "meas5.unit", "degC", "meas5.lo", "0",
                                  "meas5.hi", "200", "meas5.hold", "3", "meas1.infer", "guess",
                                  "meas1.infer_gain", "0.5", "meas1.infer_offset", "60", NULL});
    put_observer(0, "T1", "guess", 0.02f);
}

void setUp(void)
{
    memset(told, 0, sizeof told);
    bench_start_with(observed);
    bench_forget_events();
}
void tearDown(void) {}

static double value_of(unsigned i)
{
    const struct measurement_config *m = &bench.config.measurement[i];
    return (double)span_to_eu(bench.s.measurement[i].value, m->lo, m->hi);
}

static void is(unsigned i, double value, enum quality quality)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, value, value_of(i));
    TEST_ASSERT_EQUAL(quality, bench.s.measurement[i].quality);
}

static void lose(unsigned i)
{
    bad_reading(i, QUALITY_BAD, 0);
}

/* ---- standing in ---- */

static void the_estimate_of_the_tick_before_stands_in_converted_and_uncertain(void)
{
    is(T1, 85, QUALITY_GOOD);
    is(GUESS, 50, QUALITY_GOOD); /* a quarter of its span */
    lose(T1);
    tick();
    is(T1, 60 + 0.5 * 50, QUALITY_UNCERTAIN);
    is(GUESS, 54, QUALITY_UNCERTAIN);
    tick();
    is(T1, 87, QUALITY_UNCERTAIN); /* 54 of the tick before; 58 by now */
    is(GUESS, 58, QUALITY_UNCERTAIN);
    reading(T1, 90);
    tick();
    is(T1, 90, QUALITY_GOOD);
    is(GUESS, 60, QUALITY_GOOD);
}

static void a_loop_goes_on_with_it_beyond_the_hold(void)
{
    mode(TOP, LOOP_AUTO);
    tick();
    lose(T1);
    ticks(20); /* the hold is 10 s */
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
    is(T1, 85 + 19 * 2, QUALITY_UNCERTAIN);
    TEST_ASSERT_TRUE(bench.s.measurement[T1].lost); /* and an interlock with on_bad knows */
    TEST_ASSERT_EQUAL_UINT(1, happened(EVENT_MEASUREMENT_BAD, "T1"));
}

static void the_estimator_reads_what_stands_in_as_bad_and_knows_how_old_the_last_reading_is(void)
{
    TEST_ASSERT_EQUAL(QUALITY_GOOD, told[0].quality);
    TEST_ASSERT_EQUAL_FLOAT(0, told[0].age_s);
    lose(T1);
    for (int k = 1; k <= 4; k++) {
        tick();
        TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[T1].quality);
        TEST_ASSERT_EQUAL(QUALITY_BAD, told[0].quality);
        TEST_ASSERT_EQUAL_FLOAT(k, told[0].age_s);
    }
    reading(T1, 90);
    tick();
    TEST_ASSERT_EQUAL(QUALITY_GOOD, told[0].quality);
    TEST_ASSERT_EQUAL_FLOAT(0, told[0].age_s);
}

static void the_age_of_an_analysis_is_counted_from_its_sampling(void)
{
    static const float ages[] = {3, 4, 5, 6, 7, 3};
    put_all(
        (const char *const[]){"meas1.every", "5", "meas1.phase", "2", "meas1.delay", "3", NULL});
    apply();
    ticks(2); /* 6 s; the next comes at 7 s */
    for (unsigned k = 0; k < sizeof ages / sizeof ages[0]; k++) {
        tick();
        TEST_ASSERT_EQUAL_FLOAT(ages[k], told[0].age_s);
        TEST_ASSERT_EQUAL(QUALITY_GOOD, told[0].quality);
    }
}

static void an_applied_output_has_no_age(void)
{
    strcpy(bench.config.block[0].inputs, "reflux");
    apply();
    ticks(3);
    TEST_ASSERT_EQUAL_FLOAT(0, told[0].age_s);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, told[0].quality);
}

/* ---- an estimate that is bad itself ---- */

static void without_a_valid_estimate_it_is_as_if_none_were_named(void)
{
    told[0].ignorant = true;
    mode(TOP, LOOP_AUTO);
    tick(); /* the estimate is held: that is no estimate */
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[GUESS].quality);
    lose(T1);
    ticks(10);
    is(T1, 85, QUALITY_UNCERTAIN); /* held */
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
    tick();
    TEST_ASSERT_EQUAL(QUALITY_BAD, bench.s.measurement[T1].quality);
    TEST_ASSERT_EQUAL(LOOP_MANUAL, bench.s.loop[TOP].mode);
    told[0].ignorant = false; /* what it says in this tick counts in the next */
    tick();
    TEST_ASSERT_EQUAL(QUALITY_BAD, bench.s.measurement[T1].quality);
    tick();
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, bench.s.measurement[T1].quality);
}

static void an_estimate_whose_last_tick_was_held_does_not_stand_in(void)
{
    lose(T1);
    tick();
    is(T1, 85, QUALITY_UNCERTAIN);
    told[0].ignorant = true;
    tick();
    is(T1, 87, QUALITY_UNCERTAIN); /* it was valid in the tick before */
    tick();
    is(T1, 87, QUALITY_UNCERTAIN); /* what was there last is held */
    tick();
    is(T1, 87, QUALITY_UNCERTAIN);
}

static void one_that_is_out_of_range_does_not_stand_in(void)
{
    set_and_apply("meas1.infer_offset",
                  "100"); /* 200 * 0.5 + 100 lies more than a tenth beyond 160 */
    put_all((const char *const[]){"meas1.infer_gain", "1.8", "meas1.infer_offset", "90", NULL});
    apply();
    lose(T1);
    tick();
    is(T1, 85, QUALITY_UNCERTAIN); /* 180 degC */
}

static void after_silence_nothing_old_stands_in(void)
{
    supervisor_go_safe(&bench.s, "link");
    lose(T1);
    tick();
    TEST_ASSERT_EQUAL(QUALITY_BAD, bench.s.measurement[T1].quality);
}

/* ---- rings ---- */

/* Two estimates stand in for each other, in both orders of blocks: each has the value of the tick before, and neither lives
 * on the other alone. */
static void ring(void)
{
    put_all(
        (const char *const[]){"meas5.name",  "guess",    "meas5.unit",  "degC",       "meas5.lo",
                              "60",          "meas5.hi", "160",         "meas5.hold", "3",
                              "meas5.infer", "other",    "meas6.name",  "other",      "meas6.unit",
                              "degC",        "meas6.lo", "60",          "meas6.hi",   "160",
                              "meas6.hold",  "3",        "meas6.infer", "guess",      NULL});
    put_observer(0, "T1", "guess", 0.02f);
    put_observer(1, "T10", "other", 0.01f);
}

static void a_stand_in_is_that_of_the_tick_before_whichever_block_comes_first(void)
{
    for (unsigned ignorant = 0; ignorant < 2; ignorant++) {
        unsigned silent = ignorant ? OTHER : GUESS, speaks = ignorant ? GUESS : OTHER;
        memset(told, 0, sizeof told);
        bench_start_with(ring);
        told[ignorant].ignorant = true;
        reading(ignorant ? T1 : T10, 100);
        tick();
        reading(ignorant ? T1 : T10, 101);
        tick();
        is(speaks, 101, QUALITY_GOOD);
        is(silent, 100, QUALITY_UNCERTAIN);
    }
}

static void two_that_stand_in_for_each_other_do_not_live_on_each_other(void)
{
    bench_start_with(ring);
    told[0].ignorant = told[1].ignorant = true;
    ticks(5);
    TEST_ASSERT_EQUAL(QUALITY_BAD, bench.s.measurement[GUESS].quality);
    TEST_ASSERT_EQUAL(QUALITY_BAD, bench.s.measurement[OTHER].quality);
}

/* ---- what a plan takes ---- */

static void refused(const char *name, enum err code)
{
    struct config_fault fault;
    put("meas5.infer", "-");
    put(name[0] == 'g' ? "meas5.infer" : "meas1.infer", name);
    TEST_ASSERT_EQUAL(code,
                      plan_build(&bench.plan[1 - bench.current], &bench.config, 1.0f, &fault));
    TEST_ASSERT_EQUAL_STRING("meas", fault.group);
    TEST_ASSERT_EQUAL_STRING("infer", fault.field);
    TEST_ASSERT_EQUAL_STRING(name, fault.subject);
}

static void what_stands_in_is_a_manipulated_variable_or_written_by_a_block(void)
{
    refused("guess", ERR_CYCLE); /* itself */
    refused("T10", ERR_UNKNOWN); /* the plant's */
    refused("nobody", ERR_UNKNOWN);
    put_all((const char *const[]){"meas1.infer", "heat", NULL});
    apply();
}

static void a_value_that_stands_in_lies_in_the_span(void)
{
    struct config_fault fault;
    struct plan *next = &bench.plan[1 - bench.current];
    put_all(
        (const char *const[]){"meas2.fallback", "substitute", "meas2.substitute", "59.9", NULL});
    TEST_ASSERT_EQUAL(ERR_RANGE, plan_build(next, &bench.config, 1.0f, &fault));
    TEST_ASSERT_EQUAL_STRING("meas", fault.group);
    TEST_ASSERT_EQUAL(2, fault.index);
    TEST_ASSERT_EQUAL_STRING("substitute", fault.field);
    put("meas2.substitute", "60");
    apply();
}

static void of_one_name_the_manipulated_variable_is_meant(void)
{
    put_all((const char *const[]){"meas5.name", "heat", "meas1.infer", "heat", NULL});
    strcpy(bench.config.block[0].points, "heat");
    apply();
    lose(T1);
    tick();
    is(T1, 60 + 0.5 * 1, QUALITY_UNCERTAIN); /* 1 kW */
}

static void a_point_comes_in_every_tick(void)
{
    static const char *const wrong[][2] = {{"every", "2"}, {"delay", "1"}};
    for (unsigned k = 0; k < 2; k++) {
        struct config_fault fault;
        char name[20];
        setUp();
        snprintf(name, sizeof name, "meas5.%s", wrong[k][0]);
        put(name, wrong[k][1]);
        TEST_ASSERT_EQUAL(ERR_CONFLICT,
                          plan_build(&bench.plan[1 - bench.current], &bench.config, 1.0f, &fault));
        TEST_ASSERT_EQUAL_STRING(wrong[k][0], fault.field);
        TEST_ASSERT_EQUAL_STRING("guess", fault.subject);
    }
}

/* The whole of it: an analysis every 5 ticks that stops coming, bridged by the observer in every tick. */
static void an_analyser_that_stops_is_bridged_by_the_estimate(void)
{
    put_all((const char *const[]){"meas1.every", "5", "meas1.phase", "2", NULL});
    apply();
    mode(TOP, LOOP_AUTO);
    ticks(3); /* 7 s */
    lose(T1);
    ticks(4);
    is(T1, 85, QUALITY_GOOD);
    TEST_ASSERT_EQUAL(QUALITY_GOOD, told[0].quality);
    tick(); /* 12 s */
    is(T1, 85, QUALITY_UNCERTAIN);
    TEST_ASSERT_EQUAL(QUALITY_BAD, told[0].quality);
    ticks(3);
    is(T1, 91, QUALITY_UNCERTAIN);
    TEST_ASSERT_EQUAL(LOOP_AUTO, bench.s.loop[TOP].mode);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_estimate_of_the_tick_before_stands_in_converted_and_uncertain);
    RUN_TEST(a_loop_goes_on_with_it_beyond_the_hold);
    RUN_TEST(the_estimator_reads_what_stands_in_as_bad_and_knows_how_old_the_last_reading_is);
    RUN_TEST(the_age_of_an_analysis_is_counted_from_its_sampling);
    RUN_TEST(an_applied_output_has_no_age);
    RUN_TEST(without_a_valid_estimate_it_is_as_if_none_were_named);
    RUN_TEST(an_estimate_whose_last_tick_was_held_does_not_stand_in);
    RUN_TEST(one_that_is_out_of_range_does_not_stand_in);
    RUN_TEST(after_silence_nothing_old_stands_in);
    RUN_TEST(a_stand_in_is_that_of_the_tick_before_whichever_block_comes_first);
    RUN_TEST(two_that_stand_in_for_each_other_do_not_live_on_each_other);
    RUN_TEST(what_stands_in_is_a_manipulated_variable_or_written_by_a_block);
    RUN_TEST(a_value_that_stands_in_lies_in_the_span);
    RUN_TEST(of_one_name_the_manipulated_variable_is_meant);
    RUN_TEST(a_point_comes_in_every_tick);
    RUN_TEST(an_analyser_that_stops_is_bridged_by_the_estimate);
    return UNITY_END();
}
