/* The two plans of the service, and the telemetry rows that refer to them. */
#include "storage_bench.h"

static struct telemetry *rows;

void setUp(void)
{
    struct config c;
    bench_init();
    bench_small(&c, "1");
    bench_put(&c);
    rows = &fw.service.telemetry;
    rows->every = 1;
    for (unsigned n = 1; n <= 3; n++)
        telemetry_capture(rows, &fw.supervisor, n, 0, 0);
    TEST_ASSERT_EQUAL(3, spsc_count(&rows->index));
}
void tearDown(void) {}

static const struct plan *in_force_plan(void)
{
    return &fw.service.plan[fw.service.in_force];
}

static void test_rows_that_wait_outlive_a_change_of_settings(void)
{
    struct config c = *in_force();
    bench_set(&c, "loop1.gain", "2");
    bench_put(&c);
    telemetry_capture(rows, &fw.supervisor, 4, 0, 0);
    bench_set(&c, "loop1.gain", "3");
    bench_put(&c);
    (void)service_stage(&fw.service);
    TEST_ASSERT_EQUAL(4, spsc_count(&rows->index));
    TEST_ASSERT_EQUAL(0, rows->lost);
    for (unsigned n = 0; n < 4; n++) {
        TEST_ASSERT_EQUAL_PTR(in_force_plan(), rows->slot[n].plan);
        TEST_ASSERT_EQUAL(n + 1, rows->slot[n].number);
    }
}

static void test_rows_under_other_columns_are_given_up_and_counted(void)
{
    struct config c = *in_force();
    bench_set(&c, "meas1.unit", "degC");
    bench_put(&c);
    telemetry_capture(rows, &fw.supervisor, 4, 0, 0);
    (void)service_stage(&fw.service);
    TEST_ASSERT_EQUAL(3, rows->lost);
    TEST_ASSERT_EQUAL(1, spsc_count(&rows->index));
    TEST_ASSERT_EQUAL(4, rows->slot[spsc_read_index(&rows->index)].number);
    TEST_ASSERT_EQUAL_PTR(in_force_plan(), rows->slot[spsc_read_index(&rows->index)].plan);
}

static void test_rows_of_the_plan_in_force_stay_as_they_are(void)
{
    *service_stage(&fw.service) = (struct config){0};
    TEST_ASSERT_EQUAL(3, spsc_count(&rows->index));
    TEST_ASSERT_EQUAL_PTR(in_force_plan(), rows->slot[0].plan);
}

static void test_a_waiting_plan_is_in_force_before_its_buffer_is_edited(void)
{
    struct config c = *in_force();
    struct config_fault fault;
    bench_set(&c, "loop1.gain", "2");
    TEST_ASSERT_EQUAL(ERR_OK, service_apply(&fw.service, &c, &fault));
    TEST_ASSERT_FALSE(bench_is(&c));
    struct config *staged = service_stage(&fw.service);
    TEST_ASSERT_TRUE(bench_is(&c));
    TEST_ASSERT_TRUE(staged != in_force());
    TEST_ASSERT_EQUAL_MEMORY(&c, staged, sizeof c);
    TEST_ASSERT_EQUAL_PTR(in_force_plan(), service_plan(&fw.service));
}

/* Also while that plan still waits for the tick. */
static void test_a_request_carries_the_plan_it_was_checked_with(void)
{
    struct config c = *in_force();
    struct config_fault fault;
    struct request r = {.kind = REQUEST_OUTPUT, .loop = 0, .output = PLAN_NONE};
    struct request_queue *q = &fw.service.requests;
    uint32_t before = in_force_plan()->serial;
    uint32_t at = spsc_write_index(&q->index);
    TEST_ASSERT_EQUAL(ERR_OK, service_request(&fw.service, &r));
    TEST_ASSERT_EQUAL(before, q->slot[at].plan);
    bench_set(&c, "loop1.gain", "2");
    TEST_ASSERT_EQUAL(ERR_OK, service_apply(&fw.service, &c, &fault));
    at = spsc_write_index(&q->index);
    TEST_ASSERT_EQUAL(ERR_OK, service_request(&fw.service, &r));
    TEST_ASSERT_TRUE(before != q->slot[at].plan);
    TEST_ASSERT_EQUAL(service_plan(&fw.service)->serial, q->slot[at].plan);
}

#if CONFIG_STEPS
static void test_rows_keep_the_offset_they_were_captured_with(void)
{
    struct config c = *in_force();
    bench_set(&c, "meas1.offset", "2");
    bench_put(&c);
    (void)service_stage(&fw.service); /* the columns differ */
    TEST_ASSERT_EQUAL(3, rows->lost);
    telemetry_capture(rows, &fw.supervisor, 4, 0, 0);
    bench_set(&c, "meas1.offset", "3");
    bench_put(&c);
    (void)service_stage(&fw.service); /* the columns are the same, what they mean is not */
    TEST_ASSERT_EQUAL(4, rows->lost);
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_rows_that_wait_outlive_a_change_of_settings);
    RUN_TEST(test_rows_under_other_columns_are_given_up_and_counted);
    RUN_TEST(test_rows_of_the_plan_in_force_stay_as_they_are);
    RUN_TEST(test_a_request_carries_the_plan_it_was_checked_with);
    RUN_TEST(test_a_waiting_plan_is_in_force_before_its_buffer_is_edited);
#if CONFIG_STEPS
    RUN_TEST(test_rows_keep_the_offset_they_were_captured_with);
#endif
    return UNITY_END();
}
