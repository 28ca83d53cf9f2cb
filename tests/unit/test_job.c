/* Jobs: pieces in the main loop, results in the tick. */
#include "base/job.h"

#include <string.h>

#include "unity.h"

#define OTHERS (JOBS_MAX - 2u)

struct sums {
    unsigned pieces, wanted;
};

static struct event_queue events;
static struct jobs jobs;
static struct job first, second, more[OTHERS];
static struct sums of_first, of_second;

static bool add(void *context)
{
    struct sums *s = context;
    s->pieces++;
    return s->pieces < s->wanted;
}

void setUp(void)
{
    event_queue_init(&events);
    memset(&jobs, 0, sizeof jobs);
    of_first = (struct sums){.wanted = 3};
    of_second = (struct sums){.wanted = 3};
    job_init(&first, "first", add, &of_first);
    job_init(&second, "second", add, &of_second);
    TEST_ASSERT_EQUAL(ERR_OK, jobs_add(&jobs, &first));
    TEST_ASSERT_EQUAL(ERR_OK, jobs_add(&jobs, &second));
}
void tearDown(void) {}

static bool taken(struct job *j)
{
    return job_take(j, &events, 1000);
}

static void what_nobody_has_asked_for_is_not_worked_on(void)
{
    TEST_ASSERT_FALSE(jobs_work(&jobs));
    TEST_ASSERT_FALSE(jobs_wait(&jobs));
    TEST_ASSERT_FALSE(taken(&first));
    TEST_ASSERT_EQUAL(0, of_first.pieces);
}

static void a_result_is_taken_at_its_tick_and_not_before(void)
{
    job_ask(&first, 4);
    while (jobs_work(&jobs))
        TEST_ASSERT_TRUE(of_first.pieces <= 3);
    TEST_ASSERT_EQUAL(3, of_first.pieces);
    for (unsigned tick = 1; tick < 4; tick++)
        TEST_ASSERT_FALSE(taken(&first));
    TEST_ASSERT_TRUE(taken(&first));
    TEST_ASSERT_FALSE(job_is_asked(&first));
    TEST_ASSERT_FALSE(taken(&first));
    TEST_ASSERT_EQUAL(0, spsc_count(&events.index));
}

static void only_the_sample_of_that_tick_waits_and_only_for_what_is_not_done(void)
{
    job_ask(&first, 3);
    TEST_ASSERT_FALSE(jobs_wait(&jobs));
    TEST_ASSERT_FALSE(taken(&first));
    TEST_ASSERT_FALSE(jobs_wait(&jobs));
    TEST_ASSERT_FALSE(taken(&first));
    TEST_ASSERT_TRUE(jobs_wait(&jobs));
    TEST_ASSERT_TRUE(jobs_work(&jobs));
    TEST_ASSERT_TRUE(jobs_work(&jobs));
    TEST_ASSERT_TRUE(jobs_wait(&jobs));
    TEST_ASSERT_TRUE(jobs_work(&jobs));
    TEST_ASSERT_FALSE(jobs_wait(&jobs));
    TEST_ASSERT_TRUE(taken(&first));
}

static void a_late_one_is_told_of_once_waited_for_no_more_and_taken_when_it_is_there(void)
{
    job_ask(&first, 2);
    for (unsigned tick = 0; tick < 5; tick++)
        TEST_ASSERT_FALSE(taken(&first));
    TEST_ASSERT_FALSE(jobs_wait(&jobs));
    TEST_ASSERT_EQUAL(1, spsc_count(&events.index));
    const struct event *e = &events.slot[spsc_read_index(&events.index)];
    TEST_ASSERT_EQUAL(EVENT_JOB_LATE, e->code);
    TEST_ASSERT_EQUAL_STRING("first", e->subject);
    TEST_ASSERT_EQUAL_FLOAT(2.0f, e->value);
    TEST_ASSERT_EQUAL_UINT64(1000, e->time_ms);
    while (jobs_work(&jobs)) {
    }
    TEST_ASSERT_TRUE(taken(&first));
    TEST_ASSERT_EQUAL(1, spsc_count(&events.index));
    job_ask(&first, 1); /* and the next is not late for that */
    TEST_ASSERT_TRUE(jobs_wait(&jobs));
}

static void what_is_due_first_is_done_first(void)
{
    job_ask(&first, 20);
    job_ask(&second, 5);
    TEST_ASSERT_TRUE(jobs_work(&jobs));
    TEST_ASSERT_EQUAL(1, of_second.pieces);
    TEST_ASSERT_EQUAL(0, of_first.pieces);
    for (unsigned n = 0; n < 3; n++)
        TEST_ASSERT_TRUE(jobs_work(&jobs));
    TEST_ASSERT_EQUAL(3, of_second.pieces);
    TEST_ASSERT_EQUAL(1, of_first.pieces);
}

static void one_that_was_asked_for_long_ago_comes_before_one_of_the_same_patience(void)
{
    job_ask(&second, 10);
    for (unsigned tick = 0; tick < 4; tick++)
        TEST_ASSERT_FALSE(taken(&second));
    job_ask(&first, 10);
    TEST_ASSERT_TRUE(jobs_work(&jobs));
    TEST_ASSERT_EQUAL(1, of_second.pieces);
    TEST_ASSERT_EQUAL(0, of_first.pieces);
}

static void one_given_up_is_worked_on_no_more(void)
{
    job_ask(&first, 1);
    TEST_ASSERT_TRUE(jobs_work(&jobs));
    job_give_up(&first);
    TEST_ASSERT_FALSE(jobs_wait(&jobs));
    TEST_ASSERT_FALSE(jobs_work(&jobs));
    TEST_ASSERT_FALSE(taken(&first));
    TEST_ASSERT_EQUAL(0, spsc_count(&events.index));
}

/* The tick interrupts the last piece: what it ends does not end what it begins. */
static bool interrupted(void *context)
{
    struct sums *s = context;
    TEST_ASSERT_TRUE(job_is_working(&first));
    if (++s->pieces == 1) {
        job_give_up(&first);
        job_ask(&first, 1);
    }
    return false;
}

static void the_end_of_one_that_was_given_up_does_not_end_the_next(void)
{
    job_init(&first, "first", interrupted, &of_first);
    job_ask(&first, 1);
    TEST_ASSERT_TRUE(jobs_work(&jobs));
    TEST_ASSERT_FALSE(job_is_working(&first));
    TEST_ASSERT_TRUE(jobs_wait(&jobs));
    TEST_ASSERT_TRUE(jobs_work(&jobs));
    TEST_ASSERT_EQUAL(2, of_first.pieces);
    TEST_ASSERT_TRUE(taken(&first));
}

static void there_is_room_for_as_many_as_are_declared(void)
{
    for (unsigned k = 0; k < OTHERS; k++) {
        job_init(&more[k], "more", add, &of_first);
        TEST_ASSERT_EQUAL(ERR_OK, jobs_add(&jobs, &more[k]));
    }
    TEST_ASSERT_EQUAL(ERR_FULL, jobs_add(&jobs, &more[0]));
    job_ask(&more[OTHERS - 1u], 1);
    TEST_ASSERT_TRUE(jobs_wait(&jobs));
    TEST_ASSERT_TRUE(jobs_work(&jobs));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_nobody_has_asked_for_is_not_worked_on);
    RUN_TEST(a_result_is_taken_at_its_tick_and_not_before);
    RUN_TEST(only_the_sample_of_that_tick_waits_and_only_for_what_is_not_done);
    RUN_TEST(a_late_one_is_told_of_once_waited_for_no_more_and_taken_when_it_is_there);
    RUN_TEST(what_is_due_first_is_done_first);
    RUN_TEST(one_that_was_asked_for_long_ago_comes_before_one_of_the_same_patience);
    RUN_TEST(one_given_up_is_worked_on_no_more);
    RUN_TEST(the_end_of_one_that_was_given_up_does_not_end_the_next);
    RUN_TEST(there_is_room_for_as_many_as_are_declared);
    return UNITY_END();
}
