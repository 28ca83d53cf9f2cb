/* XON/XOFF on one line, both ways, without a line. */
#include <string.h>

#include "hal/flow.h"
#include "unity.h"

static uint8_t rx_bytes[64], tx_bytes[64];
static struct ring rx, tx;
static struct flow flow;

void setUp(void)
{
    rx = (struct ring)RING_OVER(rx_bytes);
    tx = (struct ring)RING_OVER(tx_bytes);
    flow = (struct flow){.on = true};
}
void tearDown(void) {}

/* Returns what is sent in answer, 0 for nothing. */
static uint8_t arrives(uint8_t byte)
{
    uint8_t answer = 0;
    if (flow_received(&flow, byte))
        (void)ring_put(&rx, byte);
    flow_look(&flow, &rx);
    return flow_next(&flow, &tx, &answer) ? answer : 0;
}

static uint8_t is_read(void)
{
    uint8_t byte, answer = 0;
    TEST_ASSERT_TRUE(ring_get(&rx, &byte));
    flow_look(&flow, &rx);
    return flow_next(&flow, &tx, &answer) ? answer : 0;
}

static void xoff_goes_out_past_three_quarters_and_xon_below_one_quarter_once_each(void)
{
    for (unsigned n = 1; n <= 64; n++)
        TEST_ASSERT_EQUAL(n == 49 ? FLOW_XOFF : 0, arrives('x'));
    for (unsigned n = 63; n < 64; n--)
        TEST_ASSERT_EQUAL(n == 15 ? FLOW_XON : 0, is_read());
}

static void xoff_goes_out_ahead_of_what_waits_and_while_the_other_side_holds_us(void)
{
    TEST_ASSERT_TRUE(ring_write(&tx, "waiting", 7));
    (void)flow_received(&flow, FLOW_XOFF);
    for (unsigned n = 1; n < 49; n++)
        TEST_ASSERT_EQUAL(0, arrives('x'));
    TEST_ASSERT_EQUAL(FLOW_XOFF, arrives('x'));
    TEST_ASSERT_EQUAL(7, ring_used(&tx));
}

static void nothing_goes_out_between_xoff_and_xon_and_neither_is_input(void)
{
    uint8_t byte;
    TEST_ASSERT_TRUE(ring_write(&tx, "ab", 2));
    TEST_ASSERT_FALSE(flow_received(&flow, FLOW_XOFF));
    TEST_ASSERT_EQUAL(0, flow_ready(&flow, &tx));
    TEST_ASSERT_FALSE(flow_next(&flow, &tx, &byte));
    TEST_ASSERT_FALSE(flow_received(&flow, FLOW_XON));
    TEST_ASSERT_EQUAL(2, flow_ready(&flow, &tx));
    TEST_ASSERT_TRUE(flow_next(&flow, &tx, &byte));
    TEST_ASSERT_EQUAL('a', byte);
}

/* Output by the piece waits for the same as output by the byte. */
static void a_piece_goes_out_neither_while_the_other_side_holds_us_nor_ahead_of_xon_or_xoff(void)
{
    const uint8_t *bytes;
    uint8_t byte;
    tx.head = tx.tail = 60; /* four to the end of the ring */
    TEST_ASSERT_TRUE(ring_write(&tx, "abcdefg", 7));
    TEST_ASSERT_EQUAL(4, flow_run(&flow, &tx, &bytes));
    TEST_ASSERT_EQUAL_MEMORY("abcd", bytes, 4);
    (void)flow_received(&flow, FLOW_XOFF);
    TEST_ASSERT_EQUAL(0, flow_run(&flow, &tx, &bytes));
    (void)flow_received(&flow, FLOW_XON);
    flow.pending = FLOW_XOFF;
    TEST_ASSERT_EQUAL(0, flow_run(&flow, &tx, &bytes));
    TEST_ASSERT_TRUE(flow_next(&flow, &tx, &byte));
    TEST_ASSERT_EQUAL(FLOW_XOFF, byte);
    TEST_ASSERT_EQUAL(4, flow_run(&flow, &tx, &bytes));
    ring_skip(&tx, 4);
    TEST_ASSERT_EQUAL(3, flow_run(&flow, &tx, &bytes));
    TEST_ASSERT_EQUAL_MEMORY("efg", bytes, 3);
}

static void control_c_lets_output_go_on_and_is_input_as_well(void)
{
    (void)flow_received(&flow, FLOW_XOFF);
    TEST_ASSERT_TRUE(flow_received(&flow, FLOW_CANCEL));
    TEST_ASSERT_FALSE(flow.held);
}

static void a_binary_line_takes_every_byte_for_input(void)
{
    flow.on = false;
    for (unsigned n = 0; n < 64; n++)
        TEST_ASSERT_EQUAL(0, arrives(n % 2 ? FLOW_XOFF : FLOW_XON));
    TEST_ASSERT_EQUAL(64, ring_used(&rx));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(xoff_goes_out_past_three_quarters_and_xon_below_one_quarter_once_each);
    RUN_TEST(xoff_goes_out_ahead_of_what_waits_and_while_the_other_side_holds_us);
    RUN_TEST(nothing_goes_out_between_xoff_and_xon_and_neither_is_input);
    RUN_TEST(a_piece_goes_out_neither_while_the_other_side_holds_us_nor_ahead_of_xon_or_xoff);
    RUN_TEST(control_c_lets_output_go_on_and_is_input_as_well);
    RUN_TEST(a_binary_line_takes_every_byte_for_input);
    return UNITY_END();
}
