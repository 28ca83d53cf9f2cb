/* The kind `composition` and the board's workspace: who has it, who gives it back, what acts meanwhile, and what of analyses is lost with it. */
#include "composition_filter_bench.h"
#include "kinds/composition/composition_job_state.h"

void setUp(void) {}

static struct filter_bench other;

void tearDown(void)
{
    workspace_share(NULL);
    free(other.b);
    other.b = NULL;
    bench_frees();
}

/* Somebody with a command: start-up. */
static enum err start_up_leases(void)
{
    void *memory;
    enum err err = workspace_lease(&workspace, "start-up", "commission abort", 1000, &memory);
    if (!err)
        memset(memory, 0xFF, workspace.bytes);
    return err;
}

static void start_up_ends(void)
{
    workspace_frees(&workspace, "start-up", NULL);
}

/* ---- where there is none ---- */

static void says_that_it_lacks_it(void)
{
    TEST_ASSERT_TRUE(raised(EVENT_LOST));
    TEST_ASSERT_EQUAL_FLOAT(0, event_value[EVENT_LOST]);
    TEST_ASSERT_EQUAL(QUALITY_UNCERTAIN, point_quality[0]);
    TEST_ASSERT_EQUAL_FLOAT(0, value_named("workspace"));
}

static void without_a_workspace_the_reduced_filter_acts_and_says_so(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        workspace_share(NULL);
        begin_both();
        for (unsigned s = 0; s < 12; s++)
            plant.model.x[s] *= 0.9f;
        run(400);
        says_that_it_lacks_it();
        TEST_ASSERT_FALSE(has_gains());
        if (filter_ways[i].method == METHOD_EKF)
            TEST_ASSERT_TRUE_MESSAGE(worst() < 0.01f, name);
        TEST_ASSERT_NULL(tell("free"));
        TEST_ASSERT_NULL(tell("take"));
        run(10);
    }
}

static void one_that_is_too_small_is_left_to_others(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        way_begins(i);
        workspace_of(composition_job_bytes(all_settings.s.covariance, 12, 1, 1) - 1u);
        begin_both();
        run(30);
        says_that_it_lacks_it();
        TEST_ASSERT_EQUAL(ERR_OK, start_up_leases());
        way_begins(i);
        workspace_of(composition_job_bytes(all_settings.s.covariance, 12, 1, 1));
        begin_both(); /* and one that is just large enough is used to its end */
        run(200);
        TEST_ASSERT_TRUE(has_gains());
    }
}

static void of_two_filters_one_gets_it_and_the_other_when_it_is_free(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        if (filter_ways[i].covariance == COVARIANCE_STEADY)
            continue; /* gives it back by itself */
        begin_both();
        other = (struct filter_bench){.b = state_of()};
        TEST_ASSERT_EQUAL(ERR_OK, kind->configure(other.b, &setup, false));
        kind->follow(other.b, &io);
        for (unsigned n = 0; n < 50; n++) {
            plant_runs(1);
            step_alone(&filter);
            step_alone(&other);
            workspace_tick(&workspace);
            work_all(&filter);
            work_all(&other);
        }
        TEST_ASSERT_TRUE(raised(EVENT_LOST));
        TEST_ASSERT_EQUAL_FLOAT(0, event_value[EVENT_LOST]);
        TEST_ASSERT_TRUE(has_gains());
        TEST_ASSERT_NULL(other.b->filter.gain);
        TEST_ASSERT_EQUAL_STRING("composition", verb_named("take")->run(other.b, NULL));
        TEST_ASSERT_NULL(tell("free"));
        for (unsigned n = 0; n < 10; n++) {
            plant_runs(1);
            step_alone(&filter);
            step_alone(&other);
            workspace_tick(&workspace);
            work_all(&filter);
            work_all(&other);
        }
        TEST_ASSERT_NOT_NULL_MESSAGE(other.b->filter.gain, name);
        TEST_ASSERT_FALSE(raised(EVENT_LOST));
        TEST_ASSERT_EQUAL_STRING("composition", tell("take"));
        free(other.b);
        other.b = NULL;
    }
}

/* ---- given back and taken again ---- */

static void given_back_the_last_gains_go_on_and_taken_again_it_finds_others(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        begin_both();
        run(200);
        TEST_ASSERT_EQUAL(filter_ways[i].covariance == COVARIANCE_STEADY ? ERR_OK : ERR_BUSY,
                          start_up_leases());
        start_up_ends();
        TEST_ASSERT_NULL(tell("free"));
        run(2);
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, start_up_leases(), name);
        TEST_ASSERT_EQUAL(0, io.requests.ask_work);
        plant.model.inputs.heat += 5;
        run(300);
        TEST_ASSERT_TRUE(has_gains());
        if (filter_ways[i].covariance != COVARIANCE_STEADY) {
            says_that_it_lacks_it();
            TEST_ASSERT_EQUAL_STRING("start-up", tell("take"));
        } else {
            TEST_ASSERT_EQUAL(0, io.requests.raised); /* it needs it no more */
        }
        TEST_ASSERT_TRUE_MESSAGE(worst() < 0.01f, name);
        start_up_ends();
        uint32_t count = filter.b->filter.count;
        run(10);
        TEST_ASSERT_EQUAL(count, filter.b->filter.count); /* nobody said `take` */
        TEST_ASSERT_NULL(tell("take"));
        run(10);
        if (filter_ways[i].covariance != COVARIANCE_STEADY)
            TEST_ASSERT_TRUE_MESSAGE(filter.b->filter.count > count, name);
        TEST_ASSERT_EQUAL(0, io.requests.raised);
        TEST_ASSERT_EQUAL(QUALITY_GOOD, point_quality[0]);
    }
}

static void given_back_before_it_was_had_nothing_is_leased(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        way_begins(i);
        filter.idle = true;
        begin_both();
        run(2);
        TEST_ASSERT_TRUE(filter.asked);
        TEST_ASSERT_NULL(tell("free"));
        work_all(&filter);
        TEST_ASSERT_EQUAL(ERR_OK, start_up_leases());
        filter.idle = false;
        run(20);
        TEST_ASSERT_FALSE(has_gains());
    }
}

static void given_back_in_the_midst_of_a_job_it_is_free_when_the_job_is_over(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        all_settings.s.cycle_s = 100;
        begin_both();
        run(40);
        if (filter_ways[i].covariance == COVARIANCE_STEADY) { /* has given it back by itself */
            all_settings.noise = 0.3f;
            retune_filter();
        }
        to_a_job();
        for (unsigned n = 0; n < 5; n++)
            TEST_ASSERT_TRUE(kind->work(filter.b));
        uint32_t count = filter.b->filter.count;
        TEST_ASSERT_NULL(tell("free"));
        run(1);
        TEST_ASSERT_EQUAL(ERR_BUSY, start_up_leases()); /* a piece may be under way */
        TEST_ASSERT_FALSE(kind->work(filter.b));
        filter.done = true;
        run(30);
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, start_up_leases(), name);
        TEST_ASSERT_EQUAL_MESSAGE(count, filter.b->filter.count, name);
        start_up_ends();
        TEST_ASSERT_NULL(tell("take"));
        filter.idle = false;
        run(200);
        TEST_ASSERT_TRUE_MESSAGE(filter.b->filter.count > count, name);
        TEST_ASSERT_TRUE_MESSAGE(worst() < 1e-3f, name);
    }
}

/* A covariance that is half-way is only good for the other half. */
static void an_order_that_was_given_up_half_way_goes_on(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        if (filter_ways[i].covariance == COVARIANCE_STEADY)
            continue;
        all_settings.s.cycle_s = 100;
        static real_t gains[16];
        for (unsigned given_up = 0; given_up < 2; given_up++) {
            way_begins(i);
            all_settings.s.cycle_s = 100;
            begin_both();
            ticks(30);
            to_a_job();
            for (unsigned n = 0; n < 6; n++)
                TEST_ASSERT_TRUE(kind->work(filter.b));
            if (given_up)
                filter.asked = false;
            uint32_t count = filter.b->filter.count;
            ticks(1);
            TEST_ASSERT_TRUE(filter.asked);
            work_all(&filter);
            while (filter.b->filter.count == count)
                ticks(1);
            if (!given_up)
                memcpy(gains, whole_gains(filter.b), sizeof gains);
        }
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(gains, whole_gains(filter.b), sizeof gains, name);
    }
}

/* ---- lost ---- */

static void a_filter_that_did_not_step_for_a_while_leaves_alone_what_is_anothers_now(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        all_settings.s.cycle_s = 100;
        begin_both();
        run(35);
        struct composition_job *job = workspace.memory;
        uint8_t *memory = workspace.memory;
        for (unsigned n = 0; n <= WORKSPACE_TICKS; n++)
            workspace_tick(&workspace);
        TEST_ASSERT_EQUAL(ERR_OK, start_up_leases());
        memset(memory, 0, workspace.bytes);
        job->phase = PHASE_DONE; /* as if it were one that is done */
        uint32_t count = filter.b->filter.count;
        if (filter.asked)
            filter.done = true;
        for (unsigned n = 0; n < 40; n++) {
            run(1);
            TEST_ASSERT_TRUE(isfinite(fraction(1)));
        }
        TEST_ASSERT_EQUAL_MESSAGE(count, filter.b->filter.count, name);
        job->phase = 0;
        for (uint32_t n = 0; n < workspace.bytes; n++)
            TEST_ASSERT_EQUAL(0, memory[n]);
        start_up_ends();
        run(200);
        TEST_ASSERT_TRUE_MESSAGE(worst() < 1e-3f, name);
    }
}

static void a_table_that_becomes_another_in_the_midst_of_a_job_begins_anew(void)
{
    for (unsigned i = 0; i < FILTER_WAYS; i++) {
        const char *name = way_begins(i);
        begin_both();
        to_a_job();
        TEST_ASSERT_TRUE(kind->work(filter.b));
        change_record(&record, COLUMN_TABLE_EFFICIENCY, 0.8f);
        retune_filter();
        plant_begins();
        TEST_ASSERT_FALSE(has_gains());
        TEST_ASSERT_FALSE(kind->work(filter.b)); /* of what it was asked there is nothing left */
        filter.done = true;
        filter.idle = false;
        run(1000);
        TEST_ASSERT_TRUE_MESSAGE(worst() < 2e-3f, name);
        TEST_ASSERT_EQUAL(0, io.requests.raised);
        change_record(&record, COLUMN_TABLE_EFFICIENCY, 0.9f);
    }
}

static void other_methods_lease_nothing(void)
{
    for (unsigned method = METHOD_GEOMETRIC; method <= METHOD_REKF; method++) {
        bench_filter(method, COVARIANCE_FULL);
        begin_both();
        run(20);
        TEST_ASSERT_EQUAL_STRING("method", tell("free"));
        TEST_ASSERT_EQUAL_STRING("method", tell("take"));
        TEST_ASSERT_NULL(tell("settle"));
        filter.idle = true;
        run(2);
        change_record(&record, COLUMN_TABLE_EFFICIENCY, 0.8f);
        retune_filter(); /* settling is off */
        work_all(&filter);
        TEST_ASSERT_EQUAL(ERR_OK, start_up_leases());
        change_record(&record, COLUMN_TABLE_EFFICIENCY, 0.9f);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(without_a_workspace_the_reduced_filter_acts_and_says_so);
    RUN_TEST(one_that_is_too_small_is_left_to_others);
    RUN_TEST(of_two_filters_one_gets_it_and_the_other_when_it_is_free);
    RUN_TEST(given_back_the_last_gains_go_on_and_taken_again_it_finds_others);
    RUN_TEST(given_back_before_it_was_had_nothing_is_leased);
    RUN_TEST(given_back_in_the_midst_of_a_job_it_is_free_when_the_job_is_over);
    RUN_TEST(an_order_that_was_given_up_half_way_goes_on);
    RUN_TEST(a_filter_that_did_not_step_for_a_while_leaves_alone_what_is_anothers_now);
    RUN_TEST(a_table_that_becomes_another_in_the_midst_of_a_job_begins_anew);
    RUN_TEST(other_methods_lease_nothing);
    return UNITY_END();
}
