/* Checks of the rows of a sequence: each that makes no sense is refused by the name of its parameter. */
#include "exchange/sequence_rows.h"
#include "plan/plan_build.h"
#include "sequence_bench.h"

void setUp(void)
{
    bench_start_with(bench_rows);
}
void tearDown(void) {}

static void refused(const char *const *pairs, enum err err, const char *field)
{
    struct config_fault fault;
    char message[100];
    memset(&fault, 0xA5, sizeof fault);
    bench_config();
    bench_rows();
    put_all(pairs);
    snprintf(message, sizeof message, "%s %s", pairs[0], pairs[1]);
    TEST_ASSERT_EQUAL_MESSAGE(
        err, plan_build(&bench.plan[1 - bench.current], &bench.config, 1.0f, &fault), message);
    TEST_ASSERT_EQUAL_STRING_MESSAGE("step", fault.group, message);
    TEST_ASSERT_EQUAL_STRING_MESSAGE(field, fault.field, message);
    TEST_ASSERT_EQUAL_MESSAGE(pairs[0][4] - '0', fault.index, message);
    TEST_ASSERT_NOT_NULL(fault.wanted);
    TEST_ASSERT_FALSE_MESSAGE(fault.must_be, message);
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(0, fault.bytes, message);
}
#define REFUSED(err, field, ...) refused((const char *const[]){__VA_ARGS__, NULL}, err, field)

static void names_must_be_of_the_right_kind(void)
{
    REFUSED(ERR_UNKNOWN, "what", "step1.what", "bottom"); /* a loop is no output */
    REFUSED(ERR_UNKNOWN, "what", "step1.what", "-");
    REFUSED(ERR_UNKNOWN, "what", "step8.what", "heat");
    REFUSED(ERR_UNKNOWN, "what", "step5.what", "heat");
    REFUSED(ERR_UNKNOWN, "what", "step6.do", "drop", "step6.what", "nothing");
    REFUSED(ERR_UNKNOWN, "meas", "step3.meas", "cool");
    REFUSED(ERR_UNKNOWN, "meas", "step2.meas", "-");
    REFUSED(ERR_CONFLICT, "what", "step8.do", "cascade"); /* nobody above it */
}

static void values_must_be_possible(void)
{
    REFUSED(ERR_RANGE, "value", "step1.value", "101");
    REFUSED(ERR_RANGE, "value", "step1.value", "-1");
    REFUSED(ERR_RANGE, "value", "step9.value", "41");
    REFUSED(ERR_RANGE, "limit", "step3.limit", "40.1");
    REFUSED(ERR_RANGE, "limit", "step2.limit", "-0.1");
}

static void waiting_must_have_an_end(void)
{
    REFUSED(ERR_RANGE, "timeout", "step3.timeout", "0");
    REFUSED(ERR_RANGE, "timeout", "step1.timeout", "5"); /* not longer than its hold */
    REFUSED(ERR_RANGE, "timeout", "step6.timeout", "60");
    REFUSED(ERR_RANGE, "hold", "step6.hold", "0");
    REFUSED(ERR_RANGE, "hold", "step1.until", "steady", "step1.hold", "0");
    REFUSED(ERR_RANGE, "limit", "step1.until", "steady", "step1.limit", "0");
    REFUSED(ERR_CONFLICT, "timeout", "step5.timeout", "60");
    REFUSED(ERR_CONFLICT, "timeout", "step2.timeout", "60");
}

static void a_guard_is_a_limit_that_ends_something(void)
{
    REFUSED(ERR_CONFLICT, "until", "step2.until", "time");
    REFUSED(ERR_CONFLICT, "until", "step2.until", "at_once");
    REFUSED(ERR_CONFLICT, "else", "step2.else", "go_on");
}

static void the_safe_value_of_an_output_is_allowed_below_its_limits(void)
{
    struct config_fault fault;
    put_all((const char *const[]){"mv2.min", "0.3", "step13.value", "0", NULL});
    TEST_ASSERT_EQUAL(ERR_OK,
                      plan_build(&bench.plan[1 - bench.current], &bench.config, 1.0f, &fault));
}

static void rows_without_a_sequence_may_say_anything(void)
{
    struct config_fault fault;
    put_all((const char *const[]){"step20.do", "out", "step20.what", "nothing", NULL});
    TEST_ASSERT_EQUAL(ERR_OK,
                      plan_build(&bench.plan[1 - bench.current], &bench.config, 1.0f, &fault));
}

static void rows_follow_each_other_by_sequence(void)
{
    const struct config *c = &bench.config;
    TEST_ASSERT_EQUAL(ROW_COOL, sequence_next(c, SEQUENCE_START, -1));
    TEST_ASSERT_EQUAL(ROW_STOP_HEAT, sequence_next(c, SEQUENCE_STOP, -1));
    TEST_ASSERT_EQUAL(ROW_STOP_WAIT, sequence_next(c, SEQUENCE_STOP, ROW_STOP_HEAT));
    TEST_ASSERT_EQUAL(PLAN_NONE, sequence_next(c, SEQUENCE_START, ROW_STEADY));
    TEST_ASSERT_EQUAL(PLAN_NONE, sequence_next(c, SEQUENCE_STOP, CONFIG_STEPS - 1));
}

static void every_reason_and_state_has_a_word(void)
{
    for (uint8_t reason = 0; reason < SEQUENCE_REASONS; reason++)
        TEST_ASSERT_TRUE(strlen(sequence_reason_text(reason)) > 3);
    TEST_ASSERT_EQUAL_STRING("?", sequence_reason_text(SEQUENCE_REASONS));
    for (uint8_t state = 0; state <= SEQUENCE_ABORTED; state++)
        TEST_ASSERT_TRUE(strlen(sequence_state_text(state)) > 3);
    TEST_ASSERT_EQUAL_STRING("?", sequence_state_text(SEQUENCE_ABORTED + 1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(names_must_be_of_the_right_kind);
    RUN_TEST(values_must_be_possible);
    RUN_TEST(waiting_must_have_an_end);
    RUN_TEST(a_guard_is_a_limit_that_ends_something);
    RUN_TEST(the_safe_value_of_an_output_is_allowed_below_its_limits);
    RUN_TEST(rows_without_a_sequence_may_say_anything);
    RUN_TEST(rows_follow_each_other_by_sequence);
    RUN_TEST(every_reason_and_state_has_a_word);
    return UNITY_END();
}
