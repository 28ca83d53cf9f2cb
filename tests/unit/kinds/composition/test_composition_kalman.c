/* The kind `composition` with complete innovation (docs/methods/composition-estimation.md), whichever way its gains are found: what it finds, and
 * what becomes of it when its settings, its readings and its place in memory change. */
#include "composition_filter_bench.h"

void setUp(void) {}

void tearDown(void)
{
    workspace_share(NULL);
    bench_frees();
}

/* Where the plant is and what drives it. */
static void plant_at(float share, float feed_fraction, float feed_part)
{
    for (unsigned s = 0; s < 12; s++)
        plant.model.x[s] *= share;
    plant.model.inputs.feed_fraction[0] = feed_fraction;
    plant.model.inputs.feed_fraction[1] = 1 - feed_fraction;
    plant.model.inputs.feed_flow *= feed_part;
}

/* As the table has it. */
#define FEED_FRACTION 0.41519314f

/* ---- what it finds ---- */

static void it_comes_to_its_plant_from_far_away(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        begin_both();
        plant_at(0.8f, FEED_FRACTION, 1);
        measure();
        TEST_ASSERT_TRUE(worst() > 0.1f);
        run(180); /* half an hour */
        TEST_ASSERT_TRUE_MESSAGE(worst() < 0.01f, name);
        run(720);
        TEST_ASSERT_TRUE_MESSAGE(worst() < 0.002f, name);
        TEST_ASSERT_TRUE_MESSAGE(value_named("sd_least") > 0, name);
        TEST_ASSERT_TRUE_MESSAGE(value_named("sd_least") <= value_named("sd_most"), name);
    }
}

static float light(const struct composition_block *b, unsigned stage)
{
    return (float)(b->model.x[3 * stage - 3] + b->model.x[3 * stage - 2]);
}

static void of_four_components_it_comes_to_its_plant_too(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        put_components_twice(&record);
        all_settings.s.feed_z = 0; /* three fractions of it by two temperatures: refused */
        begin_both();
        for (unsigned k = 0; k < 36; k += 3) {
            plant.model.x[k] = plant.model.x[k + 1] *= 0.8f;
            plant.model.x[k + 2] = (1 - 2 * plant.model.x[k]) / 2;
        }
        measure();
        run(180); /* half an hour */
        for (unsigned stage = 1; stage <= 12; stage++)
            TEST_ASSERT_FLOAT_WITHIN_MESSAGE(0.01f, light(&plant, stage), light(filter.b, stage),
                                             name);
    }
}

/* A linear model is one of small deviations. */
static void it_finds_a_feed_that_the_table_does_not_have(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        float more = filter_ways[i].method == METHOD_EKF ? 0.05f : 0.01f;
        begin_both();
        run(180);
        plant_at(1, FEED_FRACTION + more, 1);
        run(1080);
        float within = filter_ways[i].method == METHOD_EKF ? 0.1f : 0.35f;
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(within * more, more, value_named("feed_1"), name);
        TEST_ASSERT_TRUE_MESSAGE(worst() < within * more, name);
    }
}

static void without_it_a_feed_that_the_table_does_not_have_is_a_bias(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        all_settings.s.feed_z = 0;
        begin_both();
        run(180);
        plant_at(1, FEED_FRACTION + 0.05f, 1);
        run(1080);
        TEST_ASSERT_TRUE_MESSAGE(worst() > 0.003f, name);
    }
}

static void it_finds_a_feed_flow_that_nobody_measures(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        float more = filter_ways[i].method == METHOD_EKF ? 0.08f : 0.02f;
        all_settings.s.feed_z = 0;
        all_settings.s.feed_f = 0.1f;
        begin_both();
        run(180);
        plant_at(1, FEED_FRACTION, 1 + more);
        run(1440);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(0.4f * more, more, value_named("feed_flow"), name);
        TEST_ASSERT_TRUE_MESSAGE(worst() < 0.003f, name);
    }
}

/* True: the state has numbers behind its struct. */
static bool has_numbers(void)
{
    return kind->bytes(&setup) >= sizeof(struct composition_block) + sizeof(real_t[4]);
}

/* check() refuses it; but its memory is asked for first. */
static void a_table_that_cannot_be_asks_for_no_memory(void)
{
    static const struct {
        unsigned place;
        float value;
    } wrong[] = {{COLUMN_TABLE_N_STAGES, 0.5f},
                 {COLUMN_TABLE_N_STAGES, COLUMN_STAGES_MAX + 1},
                 {COLUMN_TABLE_N_STAGES, NAN},
                 {COLUMN_TABLE_N_COMPONENTS, 1},
                 {COLUMN_TABLE_N_COMPONENTS, COLUMN_COMPONENTS_MAX + 1},
                 {COLUMN_TABLE_N_COMPONENTS, NAN}};
    bench_pilot();
    all_settings.s.method = METHOD_EKF;
    TEST_ASSERT_TRUE(has_numbers());
    for (unsigned i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        PUT_RECORD(&record, pilot_values);
        change_record(&record, wrong[i].place, wrong[i].value);
        TEST_ASSERT_FALSE(has_numbers());
    }
}

/* A feed by mass: another composition is another number of moles. */
static void what_is_found_of_the_feed_moves_every_fraction_as_rates_have_it(void)
{
    enum { FRACTIONS = 12 };
    static struct column_table table;
    static struct column column;
    struct column_fault wrong;
    bench_pilot();
    change_record(&record, COLUMN_TABLE_FEED_BASIS, COLUMN_FLOW_MASS);
    change_record(&record, COLUMN_TABLE_FEED, 0.0022f); /* kg/s */
    TEST_ASSERT_EQUAL(ERR_OK, column_record_open(&record, &table, &column));
    TEST_ASSERT_EQUAL(FRACTIONS, column.n_fractions);
    for (uint8_t extras = 1; extras <= 2; extras++) {
        static struct composition_model model;
        model.has_feed = true;
        model.has_flow = extras > 1;
        model.feed = model.extras = extras;
        real_t push[2 * FRACTIONS], flow[FRACTIONS], work[FRACTIONS], rates[2][FRACTIONS];
        TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &table.nominal, &wrong));
        TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, table.profile, rates[0]));
        composition_model_push(&model, &column, table.profile, push, flow, work);
        for (unsigned e = 0; e < extras; e++) {
            double by = e ? (double)COLUMN_FLOW_PART : 0.02, most = 0;
            for (int side = 0; side < 2; side++) {
                struct column_inputs in = table.nominal;
                real_t move = (real_t)(side ? by : -by);
                in.feed_fraction[0] += e ? 0 : move;
                in.feed_fraction[1] -= e ? 0 : move;
                in.feed_flow *= e ? 1 + move : 1;
                TEST_ASSERT_EQUAL(ERR_OK, column_set_inputs(&column, &in, &wrong));
                TEST_ASSERT_EQUAL(ERR_OK, column_rates(&column, table.profile, rates[side]));
            }
            for (unsigned i = 0; i < FRACTIONS; i++)
                most = fmax(most, fabs((double)push[e * FRACTIONS + i]));
            for (unsigned i = 0; i < FRACTIONS; i++) {
                double seen = (double)(rates[1][i] - rates[0][i]) / (2 * by);
                double of_own = 0.05 * fabs(seen) + 1e-6 * most; /* the reboiler's is small */
                TEST_ASSERT_DOUBLE_WITHIN(fmin(2e-3 * most, of_own), seen,
                                          (double)push[e * FRACTIONS + i]);
            }
        }
    }
}

static void points_of_the_feed_give_what_is_found_and_how_sure_it_is(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        all_settings.s.feed_f = 0.1f;
        all_settings.s.quantity[TOP_FRACTION] = OF_FEED_FRACTION;
        point_of(TOP_FRACTION, 0, 1);
        all_settings.s.quantity[INNER_TEMPERATURE] = OF_FEED_FLOW;
        point_of(INNER_TEMPERATURE, 0, 0);
        all_settings.s.show[INNER_TEMPERATURE][UNIT_FACTOR] = 3.6e6f;
        setup.point[INNER_TEMPERATURE] = (struct block_signal){0, 20, false};
        begin_both();
        run(180);
        plant_at(1, FEED_FRACTION + 0.01f, 1);
        run(720);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(1e-5f, FEED_FRACTION + value_named("feed_1"),
                                         given(TOP_FRACTION), name);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(1e-4f, 5 * (1 + value_named("feed_flow")),
                                         given(INNER_TEMPERATURE), name);
        TEST_ASSERT_TRUE_MESSAGE(value_named("sd_1") > 0 && value_named("sd_1") < 0.1f, name);
        TEST_ASSERT_TRUE_MESSAGE(value_named("sd_3") > 0 && value_named("sd_3") < 0.1f, name);
        TEST_ASSERT_EQUAL_MESSAGE(QUALITY_GOOD, point_quality[TOP_FRACTION], name);
    }
}

static void a_feed_that_nobody_looks_for_is_that_of_the_table(void)
{
    bench_pilot();
    all_settings.s.quantity[TOP_FRACTION] = OF_FEED_FRACTION;
    all_settings.s.basis = BASIS_MASS;
    point_of(TOP_FRACTION, 0, 1);
    begin();
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.36f, given(TOP_FRACTION));
}

static void of_what_the_model_knows_nothing_is_found(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        all_settings.s.feed_f = 0.1f;
        begin_both();
        run(720);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(1e-3f, 0, value_named("feed_1"), name);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(1e-3f, 0, value_named("feed_flow"), name);
        TEST_ASSERT_TRUE_MESSAGE(worst() < 5e-4f, name);
        TEST_ASSERT_EQUAL(0, io.requests.raised);
    }
}

static void what_is_found_stays_what_a_feed_can_be(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        way_begins(i);
        all_settings.s.feed_f = 1;
        all_settings.s.feed_z = 1;
        all_settings.gate = 0;
        begin_both();
        for (unsigned n = 0; n < 400; n++) {
            put(T_LOW, n % 200 < 100 ? 399 : 301);
            put(T_HIGH, n % 160 < 80 ? 301 : 399);
            ticks(1);
            float z = value_named("feed_1"), f = value_named("feed_flow");
            TEST_ASSERT_TRUE(z >= -FEED_FRACTION - 1e-6f && z <= 1 - FEED_FRACTION + 1e-6f);
            TEST_ASSERT_TRUE(f >= -0.75f && f <= 1);
            for (unsigned s = 1; s <= 12; s++)
                TEST_ASSERT_TRUE(fraction(s) >= 0 && fraction(s) <= 1);
        }
    }
}

/* ---- gains come when they are there ---- */

static void until_there_are_gains_the_reduced_filter_acts(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        static real_t reduced[12];
        bench_filter(METHOD_REKF, COVARIANCE_FULL);
        begin_both();
        put(T_HIGH, truth(10) + 3);
        ticks(20);
        for (unsigned s = 0; s < 12; s++)
            reduced[s] = filter.b->model.x[s];
        const char *name = way_begins(i);
        all_settings.s.feed_z = 0;
        filter.idle = true;
        begin_both();
        put(T_HIGH, truth(10) + 3);
        ticks(20);
        TEST_ASSERT_FALSE(has_gains());
        TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[0]);
        if (filter_ways[i].method == METHOD_EKF)
            TEST_ASSERT_EQUAL_MEMORY_MESSAGE(reduced, filter.b->model.x, sizeof reduced, name);
        else
            TEST_ASSERT_FLOAT_WITHIN_MESSAGE(0.02f, reduced[9], fraction(10), name);
    }
}

static void without_gains_nothing_is_good(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        all_settings.s.sure = 0;
        filter.idle = true;
        begin_both();
        run(3 * LOCKED);
        TEST_ASSERT_EQUAL_MESSAGE(QUALITY_UNCERTAIN, point_quality[0], name);
        TEST_ASSERT_EQUAL(0, io.requests.raised);
        filter.idle = false;
        run(10);
        TEST_ASSERT_EQUAL_MESSAGE(QUALITY_GOOD, point_quality[0], name);
    }
}

static void gains_are_taken_in_the_declared_step_only(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        all_settings.s.cycle_s = 200;
        begin_both();
        ticks(2); /* it has the workspace */
        while (!io.requests.ask_work)
            ticks(1);
        uint32_t before = filter.b->filter.count;
        unsigned declared = io.requests.ask_work;
        TEST_ASSERT_EQUAL_MESSAGE(filter_ways[i].covariance == COVARIANCE_STEADY ? 2 : 20, declared,
                                  name);
        for (unsigned n = 1; n < declared; n++) {
            ticks(1);
            TEST_ASSERT_EQUAL_MESSAGE(before, filter.b->filter.count, name);
        }
        ticks(1);
        TEST_ASSERT_EQUAL_MESSAGE(before + 1, filter.b->filter.count, name);
    }
}

static void the_estimates_are_the_same_however_soon_the_work_is_done(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        static real_t at_once[12];
        const char *name = way_begins(i);
        for (unsigned slow = 0; slow < 2; slow++) {
            way_begins(i);
            all_settings.s.cycle_s = 100;
            begin_both();
            plant_at(0.95f, FEED_FRACTION, 1);
            filter.idle = slow;
            for (unsigned n = 0; n < 200; n++) {
                if (slow && filter.asked && filter.ticks + 1 == filter.due)
                    work_all(&filter); /* in the last moment */
                run(1);
            }
            if (!slow)
                memcpy(at_once, filter.b->model.x, sizeof at_once);
        }
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(at_once, filter.b->model.x, sizeof at_once, name);
    }
}

static void work_that_is_never_done_leaves_the_last_gains(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        begin_both();
        run(60);
        uint32_t before = filter.b->filter.count;
        filter.idle = true;
        plant_at(0.97f, FEED_FRACTION + 0.01f, 1);
        run(1000);
        TEST_ASSERT_TRUE(filter.b->filter.count <= before + 1);
        TEST_ASSERT_TRUE_MESSAGE(has_gains(), name);
        TEST_ASSERT_TRUE_MESSAGE(worst() < 0.005f, name);
        filter.idle = false;
        run(60);
        if (filter_ways[i].covariance != COVARIANCE_STEADY)
            TEST_ASSERT_TRUE_MESSAGE(filter.b->filter.count > before + 20, name);
    }
}

/* ---- other settings ---- */

static void other_numbers_keep_covariance_and_estimate_and_do_not_bump(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        begin_both();
        run(200);
        float sd = value_named("sd_2"), given_before = given(BOTTOM_FRACTION);
        uint32_t count = filter.b->filter.count, steps = filter.b->judge.steps;
        all_settings.noise = 0.3f;
        all_settings.s.feed_z = 0.2f;
        all_settings.s.feed_s = 7200;
        all_settings.s.sure = 0.5f;
        retune_filter();
        TEST_ASSERT_TRUE(has_gains());
        TEST_ASSERT_EQUAL(steps, filter.b->judge.steps);
        run(1);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(1e-4f, given_before, given(BOTTOM_FRACTION), name);
        run(4);
        TEST_ASSERT_TRUE_MESSAGE(filter.b->filter.count > count, name);
        if (filter_ways[i].covariance == COVARIANCE_STEADY)
            TEST_ASSERT_TRUE_MESSAGE(value_named("sd_2") > 1.03f * sd, name);
        else
            TEST_ASSERT_FLOAT_WITHIN_MESSAGE(0.1f * sd, sd, value_named("sd_2"), name);
        TEST_ASSERT_EQUAL_MESSAGE(QUALITY_GOOD, point_quality[0], name);
    }
}

static void gains_of_a_steady_state_are_those_of_the_settings_in_force(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        if (filter_ways[i].covariance != COVARIANCE_STEADY)
            continue;
        all_settings.s.feed_z = 0.2f;
        all_settings.s.feed_s = 7200;
        begin_both();
        run(20);
        float sd = value_named("sd_2");
        way_begins(i);
        begin_both();
        to_a_job();
        for (unsigned n = 0; n < 100; n++) /* half-way */
            TEST_ASSERT_TRUE(kind->work(filter.b));
        all_settings.s.feed_z = 0.2f;
        all_settings.s.feed_s = 7200;
        retune_filter();
        filter.idle = false;
        run(20);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(1e-3f * sd, sd, value_named("sd_2"), name);
        TEST_ASSERT_EQUAL_FLOAT(0, value_named("workspace"));
    }
}

static void begun_anew(const char *why)
{
    retune_filter();
    TEST_ASSERT_FALSE_MESSAGE(has_gains(), why);
    TEST_ASSERT_EQUAL_MESSAGE(0, filter.b->judge.steps, why);
    for (unsigned s = 0; s < 12; s++)
        TEST_ASSERT_EQUAL_FLOAT(filter.b->model.table.profile[s], filter.b->model.x[s]);
    for (unsigned k = 0; k < COVARIANCE_EXTRAS_MAX; k++)
        TEST_ASSERT_EQUAL_FLOAT_MESSAGE(0, filter.b->model.extra[k], why);
    unsigned said = 0;
    for (unsigned n = 0; n < 20; n++) {
        run(1);
        said |= io.requests.raised;
        if (n == 1)
            TEST_ASSERT_NOT_NULL_MESSAGE(filter.b->filter.job, why);
    }
    TEST_ASSERT_EQUAL_MESSAGE(0, said, why); /* it has not lost what is its own */
    TEST_ASSERT_TRUE_MESSAGE(has_gains(), why);
}

static void another_covariance_and_other_extras_are_a_fresh_beginning(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        way_begins(i);
        begin_both();
        plant_at(1, FEED_FRACTION + 0.02f, 1);
        run(300);
        all_settings.s.feed_z = 0; /* as many extras, of another meaning */
        all_settings.s.feed_f = 0.1f;
        begun_anew("extras");
        all_settings.s.covariance =
            (uint8_t)(all_settings.s.covariance == COVARIANCE_FULL ? COVARIANCE_BAND
                                                                   : COVARIANCE_FULL);
        begun_anew("covariance");
    }
}

static void another_method_begins_anew_in_other_memory(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        begin_both();
        plant_at(0.9f, FEED_FRACTION, 1);
        run(300);
        all_settings.s.method = METHOD_GEOMETRIC;
        uint32_t bytes = kind->bytes(&setup);
        all_settings.s.method =
            (uint8_t)(filter_ways[i].method == METHOD_EKF ? METHOD_KALMAN : METHOD_EKF);
        TEST_ASSERT_TRUE_MESSAGE(kind->bytes(&setup) > bytes, name);
        filter.asked = false; /* the supervisor gives its job up */
        filter_begins();
        TEST_ASSERT_FALSE(has_gains());
        unsigned said = 0;
        for (unsigned n = 0; n < 60; n++) {
            run(1);
            said |= io.requests.raised;
        }
        TEST_ASSERT_EQUAL_MESSAGE(0, said, name); /* its own lease of before has ended */
        TEST_ASSERT_TRUE(has_gains());
        TEST_ASSERT_TRUE(worst() < 0.02f);
    }
}

/* ---- settle and begin ---- */

static void verb_begin_takes_the_profile_and_goes_on_with_gains(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        begin_both();
        plant_at(0.9f, FEED_FRACTION + 0.03f, 1);
        run(400);
        float found = value_named("feed_1");
        TEST_ASSERT_TRUE(fabsf(found) > 0.01f);
        TEST_ASSERT_NULL(tell("begin"));
        TEST_ASSERT_EQUAL_FLOAT(0, value_named("feed_1"));
        TEST_ASSERT_EQUAL_FLOAT(filter.b->model.table.profile[0], fraction(1));
        TEST_ASSERT_TRUE(has_gains());
        run(1);
        TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[0]);
        run(400);
        TEST_ASSERT_TRUE_MESSAGE(worst() < 0.01f, name);
    }
}

static void it_settles_and_then_finds_gains_again(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        begin_both();
        run(30);
        TEST_ASSERT_NULL(tell("settle"));
        TEST_ASSERT_EQUAL_STRING("settles", tell("begin"));
        for (unsigned n = 0; n < 10 && filter.b->settle; n++)
            run(1);
        TEST_ASSERT_FALSE(filter.b->settle);
        TEST_ASSERT_EQUAL_FLOAT(10, (float)filter.b->model.h);
        uint32_t count = filter.b->filter.count;
        run(400);
        TEST_ASSERT_TRUE_MESSAGE(worst() < 0.005f, name);
        if (filter_ways[i].covariance != COVARIANCE_STEADY)
            TEST_ASSERT_TRUE_MESSAGE(filter.b->filter.count > count + 100, name);
    }
}

static void where_it_settles_its_model_stays(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        float there[12];
        const char *name = way_begins(i);
        begin_both();
        run(30);
        memset(quality, QUALITY_MISSING, 3);
        put(REFLUX, 4.6f);
        ticks(2);
        TEST_ASSERT_NULL(tell("settle"));
        unsigned works = filter.works;
        for (unsigned n = 0; n < 10 && filter.b->settle; n++)
            ticks(1);
        TEST_ASSERT_FALSE(filter.b->settle);
        TEST_ASSERT_TRUE_MESSAGE(filter.works - works < 100, name);
        for (unsigned s = 1; s <= 12; s++)
            there[s - 1] = fraction(s);
        TEST_ASSERT_TRUE(fabsf(there[0] - (float)filter.b->model.table.profile[0]) > 0.003f);
        ticks(500);
        for (unsigned s = 1; s <= 12; s++)
            TEST_ASSERT_FLOAT_WITHIN_MESSAGE(4e-4f, there[s - 1], fraction(s), name);
    }
}

/* Where the plant is after an absence it knows as little as at first, unless its gains are found once and kept. */
static void after_an_absence_of_its_plant_it_is_as_unsure_as_at_first(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        if (filter_ways[i].covariance == COVARIANCE_STEADY)
            continue;
        begin_both();
        run(5);
        float first = value_named("sd_1");
        run(720);
        TEST_ASSERT_TRUE_MESSAGE(value_named("sd_1") < 0.5f * first, name);
        kind->follow(filter.b, &io);
        run(5);
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(0.1f * first, first, value_named("sd_1"), name);
    }
}

static void told_to_settle_before_its_first_step_it_gives_numbers(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        way_begins(i);
        plant_begins();
        accepted();
        free(filter.b);
        filter.b = state_of();
        TEST_ASSERT_EQUAL(ERR_OK, kind->configure(filter.b, &setup, false));
        kind->follow(filter.b, &io);
        TEST_ASSERT_NULL(tell("settle"));
        for (unsigned n = 0; n < 5; n++) {
            run(1);
            for (unsigned k = 0; k < 3; k++)
                TEST_ASSERT_TRUE_MESSAGE(isfinite(num_to_float(point[k])), filter_ways[i].name);
        }
    }
}

static void what_is_told_while_the_job_is_under_way_waits_for_it(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        all_settings.s.cycle_s = 100;
        begin_both();
        to_a_job();
        TEST_ASSERT_TRUE(kind->work(filter.b));
        TEST_ASSERT_NULL(tell("settle"));
        run(5);
        TEST_ASSERT_TRUE_MESSAGE(filter.b->work == WORK_GAINS, name);
        TEST_ASSERT_TRUE(filter.b->settle);
        work_all(&filter);
        for (unsigned n = 0; n < 20 && filter.b->settle; n++) {
            run(1);
            work_all(&filter);
        }
        TEST_ASSERT_FALSE_MESSAGE(filter.b->settle, name);
    }
}

/* ---- memory ---- */

static void a_state_that_is_moved_goes_on_to_the_bit(void)
{
    for (unsigned i = 0; i < FILTER_WAYS + 2; i++) {
        static struct composition_block stayed;
        static real_t gains[16];
        for (unsigned moved = 0; moved < 2; moved++) {
            if (i < FILTER_WAYS)
                way_begins(i);
            else
                bench_filter(i == FILTER_WAYS ? METHOD_GEOMETRIC : METHOD_REKF, COVARIANCE_FULL);
            all_settings.s.feed_f = 0.1f;
            all_settings.s.cycle_s = 30;
            begin_both();
            plant_at(0.97f, FEED_FRACTION + 0.01f, 1);
            filter.idle = true;
            for (unsigned n = 0; n < 120; n++) {
                if (moved)
                    move_state();
                for (unsigned k = 0; k < 400 && filter.asked && !filter.done; k++) {
                    if (moved && k % 3 == 0)
                        move_state(); /* between two pieces */
                    filter.done = !kind->work(filter.b);
                }
                if (moved)
                    move_state();
                if (n == 50)
                    TEST_ASSERT_NULL(tell("begin"));
                if (moved)
                    move_state();
                (void)value_named("bounced");
                run(1);
            }
            if (!moved) {
                stayed = *filter.b;
                memcpy(gains, whole_gains(filter.b), i < FILTER_WAYS ? sizeof gains : 0);
            }
        }
        TEST_ASSERT_EQUAL_MEMORY(stayed.model.x, filter.b->model.x, sizeof stayed.model.x);
        TEST_ASSERT_EQUAL_MEMORY(stayed.model.extra, filter.b->model.extra,
                                 sizeof stayed.model.extra);
        TEST_ASSERT_EQUAL_MEMORY(stayed.sensors.sensor, filter.b->sensors.sensor,
                                 sizeof stayed.sensors.sensor);
        TEST_ASSERT_EQUAL_MEMORY(stayed.filter.certainty.sd, filter.b->filter.certainty.sd,
                                 sizeof stayed.filter.certainty.sd);
        if (i < FILTER_WAYS)
            TEST_ASSERT_EQUAL_MEMORY(gains, whole_gains(filter.b), sizeof gains);
    }
}

static void a_state_that_is_moved_settles_and_changes_its_settings(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        begin_both();
        run(60);
        TEST_ASSERT_NULL(tell("settle"));
        filter.idle = true;
        run(2);
        for (unsigned n = 0; n < 400 && filter.b->settle; n++) {
            move_state();
            filter.done = !kind->work(filter.b);
            move_state();
            if (filter.done)
                run(1);
        }
        TEST_ASSERT_FALSE_MESSAGE(filter.b->settle, name);
        move_state();
        all_settings.noise = 0.4f;
        retune_filter();
        filter.idle = false;
        run(300);
        TEST_ASSERT_TRUE_MESSAGE(worst() < 0.005f, name);
    }
}

/* ---- readings ---- */

static void a_temperature_that_comes_and_goes_is_done_without(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        all_settings.s.place[T_COMPARED][OF_COMPONENT] = 1; /* three that move it */
        begin_both();
        run(180);
        for (unsigned n = 0; n < 400; n++) {
            quality[T_HIGH] = n / 7 % 2 ? QUALITY_BAD : QUALITY_GOOD;
            run(1);
            if (quality[T_HIGH] == QUALITY_BAD) {
                put(T_HIGH, 390);
                TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[0]);
                TEST_ASSERT_TRUE(raised(EVENT_LOST));
                TEST_ASSERT_EQUAL_FLOAT(T_HIGH + 1, event_value[EVENT_LOST]);
            }
            TEST_ASSERT_TRUE_MESSAGE(worst() < 0.005f, name);
        }
    }
}

static void without_any_temperature_it_is_less_and_less_sure_and_bad_in_the_end(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        begin_both();
        run(200);
        float sd = value_named("sd_2");
        memset(quality, QUALITY_MISSING, 3);
        run(60);
        TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[0]);
        run(2);
        TEST_ASSERT_EQUAL_MESSAGE(QUALITY_BAD, point_quality[0], name);
        if (filter_ways[i].covariance != COVARIANCE_STEADY)
            TEST_ASSERT_TRUE_MESSAGE(value_named("sd_2") > 1.2f * sd, name);
        run(3000);
        TEST_ASSERT_TRUE(isfinite(value_named("sd_most")) && value_named("sd_most") < 100);
        memset(quality, QUALITY_GOOD, 3);
        run(400);
        TEST_ASSERT_TRUE_MESSAGE(worst() < 0.005f, name);
        TEST_ASSERT_EQUAL(QUALITY_GOOD, point_quality[TOP_FRACTION]);
    }
}

/* It has to be told that they are none; then they are for nobody. */
static void what_is_no_number_and_not_good_spoils_nothing(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        begin_both();
        run(180);
        for (unsigned k = 0; k < setup.inputs; k++) {
            quality[k] = QUALITY_BAD;
            input[k] = num_from_float(NAN);
            ticks(3);
            quality[k] = QUALITY_GOOD;
            put(FEED, 5);
            put(HEAT, 800);
            put(REFLUX, 4.5f);
            measure();
            run(3);
            for (unsigned s = 1; s <= 12; s++)
                TEST_ASSERT_TRUE_MESSAGE(isfinite(fraction(s)), name);
        }
        TEST_ASSERT_TRUE_MESSAGE(worst() < 0.002f, name);
    }
}

/* ---- how sure ---- */

static void a_point_that_is_less_sure_than_wanted_is_uncertain_and_the_others_are_not(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        all_settings.s.sure = 0;
        begin_both();
        run(300);
        for (unsigned k = 0; k < 3; k++)
            TEST_ASSERT_EQUAL_MESSAGE(QUALITY_GOOD, point_quality[k], name);
        float sd = value_named("sd_2");
        TEST_ASSERT_TRUE(sd > 2 * value_named("sd_1"));
        all_settings.s.sure = 1.1f * sd;
        retune_filter();
        run(3);
        TEST_ASSERT_EQUAL_MESSAGE(QUALITY_GOOD, point_quality[BOTTOM_FRACTION], name);
        all_settings.s.sure = 0.9f * sd;
        retune_filter();
        run(1);
        TEST_ASSERT_EQUAL_MESSAGE(QUALITY_UNCERTAIN, point_quality[BOTTOM_FRACTION], name);
        TEST_ASSERT_EQUAL_MESSAGE(QUALITY_GOOD, point_quality[TOP_FRACTION], name);
        TEST_ASSERT_EQUAL_MESSAGE(QUALITY_GOOD, point_quality[INNER_TEMPERATURE], name);
        TEST_ASSERT_EQUAL(0, io.requests.raised);
    }
}

static void it_begins_as_unsure_as_its_model_is_after_an_hour(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        if (filter_ways[i].covariance == COVARIANCE_STEADY)
            continue;
        const char *name = way_begins(i);
        begin_both();
        while (!has_gains())
            run(1);
        TEST_ASSERT_TRUE_MESSAGE(value_named("sd_most") > 0.03f, name);
        TEST_ASSERT_TRUE_MESSAGE(value_named("sd_most") < 0.11f, name);
    }
}

static void of_two_components_both_are_as_sure(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        point_of(INNER_TEMPERATURE, 12, 2);
        begin_both();
        run(60);
        TEST_ASSERT_TRUE(value_named("sd_1") > 0);
        TEST_ASSERT_EQUAL_FLOAT_MESSAGE(value_named("sd_1"), value_named("sd_3"), name);
    }
}

static void a_temperature_that_is_not_there_has_no_gain(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        if (filter_ways[i].covariance == COVARIANCE_STEADY)
            continue;
        const char *name = way_begins(i);
        begin_both();
        run(60);
        const real_t *gain = whole_gains(filter.b) + composition_model_length(&filter.b->model);
        TEST_ASSERT_TRUE(fabsf(gain[9]) > 1e-6f);
        quality[T_HIGH] = QUALITY_BAD;
        run(5);
        for (size_t k = 0; k < composition_model_length(&filter.b->model); k++)
            TEST_ASSERT_EQUAL_FLOAT_MESSAGE(0, gain[k], name);
    }
}

static void a_feed_that_is_not_to_be_expected_makes_it_uncertain(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        all_settings.s.feed_z = 0.02f;
        all_settings.s.sure = 0;
        begin_both();
        run(300);
        TEST_ASSERT_EQUAL_MESSAGE(QUALITY_GOOD, point_quality[0], name);
        filter.b->model.extra[0] = -0.1f;
        ticks(1);
        TEST_ASSERT_EQUAL_MESSAGE(QUALITY_UNCERTAIN, point_quality[0], name);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(it_comes_to_its_plant_from_far_away);
    RUN_TEST(of_four_components_it_comes_to_its_plant_too);
    RUN_TEST(it_finds_a_feed_that_the_table_does_not_have);
    RUN_TEST(without_it_a_feed_that_the_table_does_not_have_is_a_bias);
    RUN_TEST(it_finds_a_feed_flow_that_nobody_measures);
    RUN_TEST(a_table_that_cannot_be_asks_for_no_memory);
    RUN_TEST(what_is_found_of_the_feed_moves_every_fraction_as_rates_have_it);
    RUN_TEST(points_of_the_feed_give_what_is_found_and_how_sure_it_is);
    RUN_TEST(a_feed_that_nobody_looks_for_is_that_of_the_table);
    RUN_TEST(of_what_the_model_knows_nothing_is_found);
    RUN_TEST(what_is_found_stays_what_a_feed_can_be);
    RUN_TEST(until_there_are_gains_the_reduced_filter_acts);
    RUN_TEST(without_gains_nothing_is_good);
    RUN_TEST(gains_are_taken_in_the_declared_step_only);
    RUN_TEST(the_estimates_are_the_same_however_soon_the_work_is_done);
    RUN_TEST(work_that_is_never_done_leaves_the_last_gains);
    RUN_TEST(other_numbers_keep_covariance_and_estimate_and_do_not_bump);
    RUN_TEST(gains_of_a_steady_state_are_those_of_the_settings_in_force);
    RUN_TEST(another_covariance_and_other_extras_are_a_fresh_beginning);
    RUN_TEST(another_method_begins_anew_in_other_memory);
    RUN_TEST(verb_begin_takes_the_profile_and_goes_on_with_gains);
    RUN_TEST(it_settles_and_then_finds_gains_again);
    RUN_TEST(where_it_settles_its_model_stays);
    RUN_TEST(after_an_absence_of_its_plant_it_is_as_unsure_as_at_first);
    RUN_TEST(told_to_settle_before_its_first_step_it_gives_numbers);
    RUN_TEST(what_is_told_while_the_job_is_under_way_waits_for_it);
    RUN_TEST(a_state_that_is_moved_goes_on_to_the_bit);
    RUN_TEST(a_state_that_is_moved_settles_and_changes_its_settings);
    RUN_TEST(a_temperature_that_comes_and_goes_is_done_without);
    RUN_TEST(without_any_temperature_it_is_less_and_less_sure_and_bad_in_the_end);
    RUN_TEST(what_is_no_number_and_not_good_spoils_nothing);
    RUN_TEST(a_point_that_is_less_sure_than_wanted_is_uncertain_and_the_others_are_not);
    RUN_TEST(it_begins_as_unsure_as_its_model_is_after_an_hour);
    RUN_TEST(of_two_components_both_are_as_sure);
    RUN_TEST(a_temperature_that_is_not_there_has_no_gain);
    RUN_TEST(a_feed_that_is_not_to_be_expected_makes_it_uncertain);
    return UNITY_END();
}
