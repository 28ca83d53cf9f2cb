/* The plant's side of the link against a controller built from the same codec, in memory, on a clock of its own. */
#include <string.h>

#include "link_server.h"
#include "test_controller.h"
#include "two_by_two.h"
#include "unity.h"

static uint64_t now;
static struct test_controller controller;
static struct link_server server;
static struct transport transport;
static bool cut_off;        /* nothing passes either way */
static unsigned flip_every; /* every n-th byte from the controller is damaged; 0 = none */
static unsigned bytes_passed;
static unsigned samples_seen; /* SAMPLE frames on the wire */

static long memory_read(struct transport *t, void *buffer, size_t size)
{
    (void)t;
    unsigned n = controller.n_link_out;
    TEST_ASSERT_LESS_OR_EQUAL_size_t(size, n);
    uint8_t *bytes = buffer;
    memcpy(bytes, controller.link_out, n);
    controller.n_link_out = 0;
    for (unsigned i = 0; i < n; i++) {
        bytes_passed++;
        if (flip_every != 0 && bytes_passed % flip_every == 0) {
            bytes[i] ^= 0x04;
        }
    }
    return cut_off ? 0 : (long)n;
}

static long memory_write(struct transport *t, const void *data, size_t n)
{
    (void)t;
    if (!cut_off) {
        samples_seen += n > 2 && ((const uint8_t *)data)[1] == LINK_SAMPLE ? 1u : 0u;
        test_controller_link(&controller, data, (unsigned)n);
    }
    return (long)n;
}

static uint64_t memory_now(struct transport *t)
{
    (void)t;
    return now;
}

static void memory_close(struct transport *t)
{
    (void)t;
}

static const struct transport_ops memory_ops = {
    .read = memory_read, .write = memory_write, .now_ms = memory_now, .close = memory_close};

void setUp(void)
{
    char err[200];
    now = 1000000;
    cut_off = false;
    flip_every = 0;
    bytes_passed = 0;
    samples_seen = 0;
    transport = (struct transport){.ops = &memory_ops, .fd = -1, .where = "memory"};
    test_controller_init(&controller, 77, now);
    TEST_ASSERT_TRUE(
        link_server_init(&server, &transport, &two_by_two, 10000, 4711, err, sizeof(err)));
}

void tearDown(void) {}

/* Lets both sides run for ms milliseconds. */
static bool run(unsigned ms)
{
    bool good = true;
    for (unsigned i = 0; i < ms && good; i++) {
        now++;
        test_controller_turn(&controller, now);
        transport.ready = true;
        good = link_server_turn(&server);
    }
    return good;
}

static struct link_sample sample_of(uint32_t number)
{
    struct link_sample s = {
        .number = number, .time_ms = number * 10000u, .n_measurements = 2, .n_readback = 2};
    s.measurement[0].value = 50.0f;
    return s;
}

static void the_greeting_ends_with_the_channel_table_at_the_controller(void)
{
    TEST_ASSERT_TRUE(run(50));
    TEST_ASSERT_EQUAL_INT(LINK_SAMPLING, server.state);
    TEST_ASSERT_EQUAL_INT(TEST_READY, controller.state);
    TEST_ASSERT_EQUAL_UINT32(1, server.greetings);
    TEST_ASSERT_EQUAL_UINT32(77, server.controller_session);
    TEST_ASSERT_EQUAL_UINT8(2, controller.n_measurements);
    TEST_ASSERT_EQUAL_UINT8(2, controller.n_outputs);
    TEST_ASSERT_EQUAL_STRING("y1", controller.page[0].name);
    TEST_ASSERT_EQUAL_STRING("degC", controller.page[0].unit);
    TEST_ASSERT_EQUAL_STRING("u2", controller.page[3].name);
    TEST_ASSERT_TRUE(controller.page[3].manipulated);
    TEST_ASSERT_EQUAL_FLOAT(5.0f, controller.page[3].safe);
    TEST_ASSERT_EQUAL_FLOAT(100.0f, controller.page[3].hi);
}

static void a_sample_is_answered_by_its_command(void)
{
    TEST_ASSERT_TRUE(run(50));
    struct link_sample s = sample_of(3);
    TEST_ASSERT_TRUE(link_server_sample(&server, &s));
    TEST_ASSERT_TRUE(run(5));
    TEST_ASSERT_TRUE(server.answered);
    TEST_ASSERT_EQUAL_UINT32(3, server.command.number);
    TEST_ASSERT_EQUAL_FLOAT(30.0f, server.command.output[0].value);
    TEST_ASSERT_EQUAL_UINT32(1, controller.ticks);
}

static void a_lost_command_is_repaired_by_the_same_sample_and_makes_no_second_tick(void)
{
    TEST_ASSERT_TRUE(run(50));
    controller.drop_command_every = 1;
    struct link_sample s = sample_of(0);
    TEST_ASSERT_TRUE(link_server_sample(&server, &s));
    TEST_ASSERT_TRUE(run(LINK_REPEAT_MS - 10));
    TEST_ASSERT_FALSE(server.answered);
    TEST_ASSERT_EQUAL_UINT(1, samples_seen);
    TEST_ASSERT_TRUE(run(20));
    TEST_ASSERT_TRUE(server.answered);
    TEST_ASSERT_EQUAL_UINT32(1, controller.ticks);
    TEST_ASSERT_EQUAL_UINT32(1, controller.duplicates);
    TEST_ASSERT_EQUAL_UINT32(1, server.count.repeats);
}

static void keep_alives_hold_the_link_while_nothing_is_sampled(void)
{
    TEST_ASSERT_TRUE(run(10000));
    TEST_ASSERT_EQUAL_INT(LINK_SAMPLING, server.state);
    TEST_ASSERT_EQUAL_INT(TEST_READY, controller.state);
    TEST_ASSERT_EQUAL_UINT32(1, server.greetings);
    TEST_ASSERT_EQUAL_UINT32(0, server.silences);
}

static void silence_brings_the_greeting_back_and_the_sample_is_held_until_resent(void)
{
    TEST_ASSERT_TRUE(run(50));
    cut_off = true;
    struct link_sample s = sample_of(5);
    TEST_ASSERT_TRUE(link_server_sample(&server, &s));
    TEST_ASSERT_TRUE(run(LINK_SILENCE_MS + LINK_KEEP_ALIVE_MS));
    TEST_ASSERT_EQUAL_INT(LINK_GREETING, server.state);
    TEST_ASSERT_EQUAL_UINT32(1, server.silences);
    cut_off = false;
    TEST_ASSERT_TRUE(run(1000));
    TEST_ASSERT_EQUAL_INT(LINK_SAMPLING, server.state);
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(2, server.greetings);
    TEST_ASSERT_FALSE(server.answered);
    TEST_ASSERT_EQUAL_UINT(0, samples_seen);
    TEST_ASSERT_TRUE(link_server_resend(&server));
    TEST_ASSERT_TRUE(run(5));
    TEST_ASSERT_TRUE(server.answered);
}

static void a_restarted_controller_is_told_by_its_session(void)
{
    TEST_ASSERT_TRUE(run(50));
    test_controller_init(&controller, 78, now);
    TEST_ASSERT_TRUE(run(50));
    TEST_ASSERT_EQUAL_INT(LINK_SAMPLING, server.state);
    TEST_ASSERT_EQUAL_UINT32(2, server.greetings);
    TEST_ASSERT_EQUAL_UINT32(78, server.controller_session);
}

/* After a silence the plant's HELLO may come before the controller's own, and no frame has its session then. */
static void a_controller_that_restarts_in_a_silence_is_told_by_its_asking_for_pages(void)
{
    TEST_ASSERT_TRUE(run(50));
    cut_off = true;
    TEST_ASSERT_TRUE(run(LINK_SILENCE_MS + LINK_KEEP_ALIVE_MS));
    cut_off = false;
    TEST_ASSERT_TRUE(run(1000));
    TEST_ASSERT_EQUAL_UINT32(1, server.introductions); /* the same controller, after a silence */
    cut_off = true;
    TEST_ASSERT_TRUE(run(LINK_SILENCE_MS + LINK_KEEP_ALIVE_MS));
    test_controller_init(&controller, 77, now);
    cut_off = false;
    TEST_ASSERT_TRUE(run(1000));
    TEST_ASSERT_EQUAL_INT(LINK_SAMPLING, server.state);
    TEST_ASSERT_EQUAL_UINT32(2, server.introductions);
}

static void what_the_outputs_are_told_is_logged_with_its_time(void)
{
    char said[400] = "";
    struct output_log log = {.file = tmpfile()};
    TEST_ASSERT_NOT_NULL(log.file);
    server.outputs = &log;
    TEST_ASSERT_TRUE(run(50));
    struct link_sample s = sample_of(3);
    TEST_ASSERT_TRUE(link_server_sample(&server, &s));
    TEST_ASSERT_TRUE(run(5));
    cut_off = true;
    TEST_ASSERT_TRUE(run(LINK_SILENCE_MS + LINK_KEEP_ALIVE_MS));
    rewind(log.file);
    TEST_ASSERT_GREATER_THAN_size_t(0, fread(said, 1, sizeof(said) - 1u, log.file));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(said, ",command,30"), said);
    TEST_ASSERT_TRUE(strstr(said, ",silence,") != NULL);
    TEST_ASSERT_TRUE(strstr(said, ",5\n") != NULL); /* safe */
    TEST_ASSERT_TRUE(output_log_close(&log));
}

static void a_damaged_line_still_gets_through(void)
{
    flip_every = 97;
    for (uint32_t k = 0; k < 20; k++) {
        TEST_ASSERT_TRUE(run(3000));
        struct link_sample s = sample_of(k);
        TEST_ASSERT_TRUE(link_server_sample(&server, &s));
        for (unsigned i = 0; i < 20 && !server.answered; i++) {
            TEST_ASSERT_TRUE(run(500));
            if (server.held && server.state == LINK_SAMPLING) {
                TEST_ASSERT_TRUE(link_server_resend(&server));
            }
        }
        TEST_ASSERT_TRUE(server.answered);
        TEST_ASSERT_EQUAL_UINT32(k, server.command.number);
    }
    TEST_ASSERT_GREATER_THAN_UINT32(3, server.decoder.count.bad_crc +
                                           server.decoder.count.malformed +
                                           server.decoder.count.overlong);
    TEST_ASSERT_GREATER_THAN_UINT32(0, server.count.lost);
}

static void another_version_is_answered_and_ends_the_session_with_a_reason(void)
{
    controller.refuse_version = true;
    TEST_ASSERT_FALSE(run(50));
    TEST_ASSERT_EQUAL_STRING("plant link: the other side speaks version 2, this side 1",
                             server.error);
    TEST_ASSERT_GREATER_THAN_UINT32(0, controller.decoder.count.good); /* our own HELLO */
}

static void frames_that_make_no_sense_change_nothing(void)
{
    TEST_ASSERT_TRUE(run(50));
    struct frame f = {.type = 99};
    struct frame strange[5];
    struct link_ready ready = {.session = 1};
    struct link_page_request request = {.index = 4};
    struct link_command command = {.number = 9, .n_outputs = 2};
    strange[0] = f;
    pack_ready(&ready, &strange[1]);
    pack_page_request(&request, &strange[2]);
    pack_command(&command, &strange[3]);
    strange[4] = strange[3];
    strange[4].n--;
    for (unsigned i = 0; i < 5; i++) {
        controller.n_link_out = (unsigned)frame_encode(&strange[i], controller.link_out);
        TEST_ASSERT_TRUE(run(1));
    }
    TEST_ASSERT_EQUAL_INT(LINK_SAMPLING, server.state);
    TEST_ASSERT_EQUAL_UINT32(1, server.greetings);
    TEST_ASSERT_FALSE(server.answered);
    TEST_ASSERT_EQUAL_UINT32(5, server.count.unexpected);
}

static void a_vanished_peer_ends_the_session_with_a_reason(void)
{
    TEST_ASSERT_TRUE(run(50));
    (void)transport_lost(&transport, "unplugged");
    TEST_ASSERT_FALSE(run(1));
    TEST_ASSERT_EQUAL_STRING("plant link memory: unplugged", server.error);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_greeting_ends_with_the_channel_table_at_the_controller);
    RUN_TEST(a_sample_is_answered_by_its_command);
    RUN_TEST(a_lost_command_is_repaired_by_the_same_sample_and_makes_no_second_tick);
    RUN_TEST(keep_alives_hold_the_link_while_nothing_is_sampled);
    RUN_TEST(silence_brings_the_greeting_back_and_the_sample_is_held_until_resent);
    RUN_TEST(a_restarted_controller_is_told_by_its_session);
    RUN_TEST(a_controller_that_restarts_in_a_silence_is_told_by_its_asking_for_pages);
    RUN_TEST(what_the_outputs_are_told_is_logged_with_its_time);
    RUN_TEST(a_damaged_line_still_gets_through);
    RUN_TEST(another_version_is_answered_and_ends_the_session_with_a_reason);
    RUN_TEST(frames_that_make_no_sense_change_nothing);
    RUN_TEST(a_vanished_peer_ends_the_session_with_a_reason);
    return UNITY_END();
}
