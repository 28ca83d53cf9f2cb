/* Assertions: what does not hold is reported, then the program ends. */
#include <setjmp.h>
#include <string.h>

#include "base/assertion.h"
#include "base/spsc.h"
#include "unity.h"

static jmp_buf back;
static char reported[200];
static unsigned reported_line;

static void report(const char *text, const char *file, unsigned line)
{
    (void)file;
    strncpy(reported, text, sizeof reported - 1);
    reported_line = line;
    longjmp(back, 1); /* in place of the end of the program */
}

void setUp(void)
{
    assertion_report = report;
    memset(reported, 0, sizeof reported);
}

void tearDown(void)
{
    assertion_report = NULL;
}

static void test_what_holds_is_not_reported(void)
{
    if (setjmp(back) == 0)
        REFLUX_ASSERT(1 + 1 == 2);
    TEST_ASSERT_EQUAL_STRING("", reported);
}

static void test_what_does_not_hold_is_reported_with_its_place(void)
{
    if (setjmp(back) == 0)
        REFLUX_ASSERT(1 + 1 == 3);
    TEST_ASSERT_EQUAL_STRING("1 + 1 == 3", reported);
    TEST_ASSERT_EQUAL_UINT(__LINE__ - 2, reported_line);
}

static void test_a_queue_that_is_written_while_it_is_full_is_found(void)
{
    struct spsc q;
    spsc_init(&q, 2);
    spsc_write_done(&q);
    spsc_write_done(&q);
    if (setjmp(back) == 0)
        spsc_write_done(&q);
    TEST_ASSERT_EQUAL_STRING("spsc_can_write(q)", reported);
}

static void test_a_queue_that_is_read_while_it_is_empty_is_found(void)
{
    struct spsc q;
    spsc_init(&q, 2);
    if (setjmp(back) == 0)
        spsc_read_done(&q);
    TEST_ASSERT_EQUAL_STRING("spsc_can_read(q)", reported);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_what_holds_is_not_reported);
    RUN_TEST(test_what_does_not_hold_is_reported_with_its_place);
    RUN_TEST(test_a_queue_that_is_written_while_it_is_full_is_found);
    RUN_TEST(test_a_queue_that_is_read_while_it_is_empty_is_found);
    return UNITY_END();
}
