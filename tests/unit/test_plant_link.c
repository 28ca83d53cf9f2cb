/* io/plant_link.[ch] behind hal/io.h, on the rings of the board in memory: frames are given by hand. */
#include <string.h>

#include "io/plant_link.h"
#include "memory_port.h"
#include "unity.h"

static struct plant_link link;
static struct event_queue events;
static uint64_t plant_time, now_ms;
static struct io_port port;
static struct io_sample sample;
static uint16_t sequence;

void setUp(void)
{
    memory_port_start();
    memset(&events, 0, sizeof events);
    plant_link_init(&link, &events, &plant_time);
    port = plant_link_port(&link);
    now_ms = 1000;
}

void tearDown(void)
{
    memory_port_count_looks(0);
}

static void give(struct frame *f)
{
    uint8_t wire[FRAME_WIRE_MAX];
    f->sequence = sequence++;
    size_t n = frame_encode(f, wire);
    TEST_ASSERT_EQUAL_size_t(n, memory_port_give(HAL_UART_LINK, wire, n));
}

static bool polled(void)
{
    uint8_t sent[256];
    bool there = port.poll(port.context, now_ms, &sample);
    while (memory_port_take(HAL_UART_LINK, sent, sizeof sent))
        ;
    return there;
}

/* A plant with one measurement and one output. */
static void says_hello(uint32_t session)
{
    struct link_hello hello = {.version = LINK_VERSION,
                               .role = LINK_ROLE_PLANT,
                               .session = session,
                               .n_measurements = 1,
                               .n_outputs = 1,
                               .tick_ms = 1000,
                               .name = "still"};
    struct frame f;
    pack_hello(&hello, &f);
    give(&f);
    TEST_ASSERT_FALSE(polled());
}

static void announces(uint8_t index)
{
    struct link_page page = {.index = index, .manipulated = index == 1, .hi = 10, .safe = 2};
    struct frame f;
    strcpy(page.name, index == 1 ? "heat" : "T1");
    strcpy(page.unit, "-");
    pack_page(&page, &f);
    give(&f);
    TEST_ASSERT_FALSE(polled());
}

static void measures(uint32_t number)
{
    struct link_sample m = {.number = number, .time_ms = number * 1000u, .n_measurements = 1};
    struct frame f;
    m.measurement[0].value = 5.0f;
    pack_sample(&m, &f);
    give(&f);
}

static void connected(uint32_t session)
{
    says_hello(session);
    announces(0);
    announces(1);
    TEST_ASSERT_EQUAL_INT(IO_READY, port.state(port.context));
}

static void whoever_has_bound_a_channel_table_learns_of_every_other_one(void)
{
    uint32_t before = port.generation(port.context);
    connected(1);
    uint32_t first = port.generation(port.context);
    TEST_ASSERT_EQUAL_UINT32(before + 1, first);
    says_hello(1); /* our answer was lost: the same table */
    measures(1);
    TEST_ASSERT_TRUE(polled());
    TEST_ASSERT_EQUAL_UINT32(first, port.generation(port.context));
    says_hello(2); /* started again: what was bound is void, and then there is another one */
    TEST_ASSERT_EQUAL_UINT32(first + 1, port.generation(port.context));
    announces(0);
    TEST_ASSERT_EQUAL_UINT32(first + 1, port.generation(port.context));
    announces(1);
    TEST_ASSERT_EQUAL_UINT32(first + 2, port.generation(port.context));
    now_ms += LINK_SILENCE_MS + 1;
    TEST_ASSERT_FALSE(polled());
    TEST_ASSERT_EQUAL_INT(IO_DOWN, port.state(port.context));
    TEST_ASSERT_EQUAL_UINT32(first + 3, port.generation(port.context));
}

/* Each sample costs what it costs itself, and not what came before it. */
static void a_sample_bears_the_cost_of_its_own_reception_and_no_other(void)
{
    connected(1);
    memory_port_count_looks(1);
    measures(1);
    TEST_ASSERT_TRUE(polled());
    uint32_t one = sample.reception;
    TEST_ASSERT_TRUE(one > 0);
    for (uint32_t n = 2; n < 5; n++) {
        measures(n);
        TEST_ASSERT_TRUE(polled());
        TEST_ASSERT_EQUAL_UINT32(one, sample.reception);
    }
    struct frame f;
    pack_keep_alive(&f);
    give(&f);
    TEST_ASSERT_FALSE(polled());
    for (unsigned n = 0; n < 3; n++) /* in vain */
        TEST_ASSERT_FALSE(polled());
    measures(5);
    TEST_ASSERT_TRUE(polled());
    TEST_ASSERT_UINT32_WITHIN(2, one, sample.reception);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(whoever_has_bound_a_channel_table_learns_of_every_other_one);
    RUN_TEST(a_sample_bears_the_cost_of_its_own_reception_and_no_other);
    return UNITY_END();
}
