/* Events and the queue they travel in. */
#include <string.h>

#include "base/event.h"
#include "base/spsc.h"
#include "unity.h"

static struct event_queue queue;

void setUp(void)
{
    event_queue_init(&queue);
}
void tearDown(void) {}

static void a_queue_gives_back_what_was_put_in_order(void)
{
    struct spsc q;
    unsigned slot[8], next = 0, expected = 0;
    spsc_init(&q, 8);
    for (unsigned round = 0; round < 100; round++) {
        while (spsc_can_write(&q)) {
            slot[spsc_write_index(&q)] = next++;
            spsc_write_done(&q);
        }
        for (unsigned n = 0; n < round % 9; n++) {
            if (!spsc_can_read(&q))
                break;
            TEST_ASSERT_EQUAL(expected++, slot[spsc_read_index(&q)]);
            spsc_read_done(&q);
        }
    }
}

static void a_queue_holds_as_many_as_its_size_and_no_more(void)
{
    struct spsc q;
    spsc_init(&q, 4);
    TEST_ASSERT_FALSE(spsc_can_read(&q));
    for (unsigned n = 0; n < 4; n++) {
        TEST_ASSERT_TRUE(spsc_can_write(&q));
        spsc_write_done(&q);
    }
    TEST_ASSERT_FALSE(spsc_can_write(&q));
    TEST_ASSERT_EQUAL(4, spsc_count(&q));
}

static void the_counters_of_a_queue_wrap_without_harm(void)
{
    struct spsc q;
    spsc_init(&q, 4);
    atomic_store(&q.written, 0xFFFFFFFEu);
    atomic_store(&q.read, 0xFFFFFFFEu);
    for (unsigned n = 0; n < 4; n++)
        spsc_write_done(&q);
    TEST_ASSERT_EQUAL(4, spsc_count(&q));
    TEST_ASSERT_FALSE(spsc_can_write(&q));
    TEST_ASSERT_EQUAL(2, spsc_read_index(&q));
    spsc_read_done(&q);
    TEST_ASSERT_TRUE(spsc_can_write(&q));
}

static void an_event_carries_its_subject_cut_to_its_size(void)
{
    event_put(&queue, 5000, EVENT_MODE, "a_name_that_is_far_too_long", 1.5f, 3);
    const struct event *e = &queue.slot[0];
    TEST_ASSERT_EQUAL_UINT64(5000, e->time_ms);
    TEST_ASSERT_EQUAL(EVENT_MODE, e->code);
    TEST_ASSERT_EQUAL_STRING("a_name_that_is_", e->subject);
    TEST_ASSERT_EQUAL(3, e->detail);
    TEST_ASSERT_EQUAL_FLOAT(1.5f, e->value);
    event_put(&queue, 0, EVENT_STARTED, NULL, 0, 0);
    TEST_ASSERT_EQUAL_STRING("", queue.slot[1].subject);
}

static void events_that_find_no_room_are_counted(void)
{
    for (unsigned n = 0; n < EVENT_QUEUE_SIZE + 5; n++)
        event_put(&queue, n, EVENT_MODE, NULL, 0, 0);
    TEST_ASSERT_EQUAL(5, queue.lost);
    TEST_ASSERT_EQUAL_UINT64(0, queue.slot[0].time_ms); /* the first are kept */
}

static void every_event_has_a_name_of_its_own_and_words(void)
{
    for (unsigned i = 0; i < EVENT_COUNT; i++) {
        TEST_ASSERT_TRUE(strlen(event_name((uint8_t)i)) > 2);
        TEST_ASSERT_TRUE(strlen(event_text((uint8_t)i)) > 5);
        TEST_ASSERT_NULL(strchr(event_name((uint8_t)i), ' '));
        for (unsigned k = 0; k < i; k++)
            TEST_ASSERT_TRUE(strcmp(event_name((uint8_t)i), event_name((uint8_t)k)) != 0);
    }
    TEST_ASSERT_EQUAL_STRING("?", event_name(EVENT_COUNT));
    TEST_ASSERT_EQUAL_STRING("?", event_text(255));
    TEST_ASSERT_EQUAL(EVENT_ALARM, event_level(255));
    TEST_ASSERT_EQUAL_STRING("?", event_text(EVENT_COUNT));
    TEST_ASSERT_EQUAL(EVENT_ALARM, event_level(EVENT_COUNT));
    TEST_ASSERT_EQUAL_STRING("action", event_level_name(EVENT_ACTION));
    TEST_ASSERT_EQUAL_STRING("?", event_level_name((enum event_level)(EVENT_ACTION + 1)));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_queue_gives_back_what_was_put_in_order);
    RUN_TEST(a_queue_holds_as_many_as_its_size_and_no_more);
    RUN_TEST(the_counters_of_a_queue_wrap_without_harm);
    RUN_TEST(an_event_carries_its_subject_cut_to_its_size);
    RUN_TEST(events_that_find_no_room_are_counted);
    RUN_TEST(every_event_has_a_name_of_its_own_and_words);
    return UNITY_END();
}
