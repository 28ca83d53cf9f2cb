/* Messages: every one makes the round trip through a frame, every wrong shape is refused. */
#include <math.h>
#include <string.h>

#include "link/messages.h"
#include "unity.h"

void setUp(void) {}

void tearDown(void) {}

static struct link_hello some_hello(void)
{
    return (struct link_hello){.version = LINK_VERSION,
                               .role = LINK_ROLE_PLANT,
                               .session = 0xDEADBEEFu,
                               .n_measurements = 5,
                               .n_outputs = 2,
                               .tick_ms = 30000,
                               .name = "pilot"};
}

static struct link_page some_page(void)
{
    return (struct link_page){.index = 6,
                              .manipulated = true,
                              .lo = 0.7f,
                              .hi = 1.25f,
                              .safe = 0.7f,
                              .name = "Qr",
                              .unit = "kW"};
}

static struct link_sample full_sample(void)
{
    struct link_sample m = {.number = 0xFFFFFFFEu,
                            .time_ms = 0x0123456789ABCDEFu,
                            .n_measurements = LINK_CHANNELS_MAX,
                            .n_readback = LINK_CHANNELS_MAX};
    for (unsigned i = 0; i < LINK_CHANNELS_MAX; i++) {
        m.measurement[i] = (struct link_reading){.value = 1.5f * (float)i - 7.0f, .quality = i % 4};
        m.readback[i] = (struct link_reading){.value = -0.1f * (float)i, .quality = 0};
    }
    return m;
}

static struct link_command some_command(void)
{
    struct link_command m = {
        .number = 17, .time_ms = 510000, .safe = true, .n_outputs = LINK_CHANNELS_MAX};
    for (unsigned i = 0; i < LINK_CHANNELS_MAX; i++) {
        m.output[i].drive = i % 3 != 0;
        m.output[i].value = m.output[i].drive ? 0.25f * (float)i : 0.0f;
    }
    return m;
}

static void hello_makes_the_round_trip(void)
{
    struct link_hello sent = some_hello();
    struct link_hello got;
    memset(&got, 0xAA, sizeof(got));
    struct frame f;
    pack_hello(&sent, &f);
    TEST_ASSERT_EQUAL_UINT8(36, f.n);
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_hello(&f, &got));
    TEST_ASSERT_EQUAL_UINT32(sent.session, got.session);
    TEST_ASSERT_EQUAL_UINT8(sent.role, got.role);
    TEST_ASSERT_EQUAL_UINT8(5, got.n_measurements);
    TEST_ASSERT_EQUAL_UINT8(2, got.n_outputs);
    TEST_ASSERT_EQUAL_UINT32(30000, got.tick_ms);
    TEST_ASSERT_EQUAL_STRING("pilot", got.name);
}

static void numbers_are_little_endian_on_the_wire(void)
{
    struct frame f;
    struct link_hello m = some_hello();
    pack_hello(&m, &f);
    const uint8_t head[] = {1, 1, 0xEF, 0xBE, 0xAD, 0xDE, 5, 2, 0x30, 0x75, 0, 0, 'p', 'i'};
    TEST_ASSERT_EQUAL_HEX8_ARRAY(head, f.payload, sizeof(head));
    struct link_page page = {.lo = 1.0f, .hi = 2.0f, .safe = -2.0f, .name = "x", .unit = "-"};
    pack_page(&page, &f);
    const uint8_t body[] = {0, 0, 0, 0, 0x80, 0x3F, 0, 0, 0, 0x40, 0, 0, 0, 0xC0, 'x', 0};
    TEST_ASSERT_EQUAL_HEX8_ARRAY(body, f.payload, sizeof(body));
}

static void page_request_ready_and_keep_alive_make_the_round_trip(void)
{
    struct frame f;
    struct link_page_request request = {.index = 200};
    struct link_page_request request_got = {0};
    pack_page_request(&request, &f);
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_page_request(&f, &request_got));
    TEST_ASSERT_EQUAL_UINT8(200, request_got.index);
    struct link_ready ready = {.session = 0x80000001u};
    struct link_ready ready_got = {0};
    pack_ready(&ready, &f);
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_ready(&f, &ready_got));
    TEST_ASSERT_EQUAL_UINT32(0x80000001u, ready_got.session);
    pack_keep_alive(&f);
    TEST_ASSERT_EQUAL_UINT8(LINK_KEEP_ALIVE, f.type);
    TEST_ASSERT_EQUAL_UINT8(0, f.n);
}

static void page_makes_the_round_trip(void)
{
    struct frame f;
    struct link_page sent = some_page();
    struct link_page got;
    pack_page(&sent, &f);
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_page(&f, &got));
    TEST_ASSERT_EQUAL_UINT8(6, got.index);
    TEST_ASSERT_TRUE(got.manipulated);
    TEST_ASSERT_EQUAL_FLOAT(0.7f, got.lo);
    TEST_ASSERT_EQUAL_FLOAT(1.25f, got.hi);
    TEST_ASSERT_EQUAL_FLOAT(0.7f, got.safe);
    TEST_ASSERT_EQUAL_STRING("Qr", got.name);
    TEST_ASSERT_EQUAL_STRING("kW", got.unit);
}

static void the_largest_sample_makes_the_round_trip(void)
{
    struct frame f;
    struct link_sample sent = full_sample();
    struct link_sample got;
    pack_sample(&sent, &f);
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_sample(&f, &got));
    TEST_ASSERT_EQUAL_UINT32(sent.number, got.number);
    TEST_ASSERT_EQUAL_UINT64(sent.time_ms, got.time_ms);
    for (unsigned i = 0; i < LINK_CHANNELS_MAX; i++) {
        TEST_ASSERT_EQUAL_FLOAT(sent.measurement[i].value, got.measurement[i].value);
        TEST_ASSERT_EQUAL_UINT8(sent.measurement[i].quality, got.measurement[i].quality);
        TEST_ASSERT_EQUAL_FLOAT(sent.readback[i].value, got.readback[i].value);
    }
}

static void a_sample_without_readback_and_one_without_anything_make_the_round_trip(void)
{
    struct frame f;
    struct link_sample sent = full_sample();
    struct link_sample got;
    sent.n_readback = 0;
    pack_sample(&sent, &f);
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_sample(&f, &got));
    TEST_ASSERT_EQUAL_UINT8(0, got.n_readback);
    sent.n_measurements = 0;
    pack_sample(&sent, &f);
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_sample(&f, &got));
    TEST_ASSERT_EQUAL_UINT8(14, f.n);
}

static void command_makes_the_round_trip(void)
{
    struct frame f;
    struct link_command sent = some_command();
    struct link_command got;
    pack_command(&sent, &f);
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_command(&f, &got));
    TEST_ASSERT_EQUAL_UINT32(17, got.number);
    TEST_ASSERT_EQUAL_UINT64(510000, got.time_ms);
    TEST_ASSERT_TRUE(got.safe);
    for (unsigned i = 0; i < LINK_CHANNELS_MAX; i++) {
        TEST_ASSERT_EQUAL(sent.output[i].drive, got.output[i].drive);
        TEST_ASSERT_EQUAL_FLOAT(sent.output[i].value, got.output[i].value);
    }
}

/* Every message, for tests that go over all of them. */
static unsigned all_messages(struct frame *f)
{
    struct link_hello hello = some_hello();
    struct link_page_request request = {.index = 3};
    struct link_page page = some_page();
    struct link_ready ready = {.session = 5};
    struct link_sample sample = full_sample();
    struct link_command command = some_command();
    pack_hello(&hello, &f[0]);
    pack_page_request(&request, &f[1]);
    pack_page(&page, &f[2]);
    pack_ready(&ready, &f[3]);
    pack_sample(&sample, &f[4]);
    pack_command(&command, &f[5]);
    return 6;
}

static enum err unpack_as(unsigned kind, const struct frame *f)
{
    static struct link_hello hello;
    static struct link_page_request request;
    static struct link_page page;
    static struct link_ready ready;
    static struct link_sample sample;
    static struct link_command command;
    switch (kind) {
    case 0:
        return unpack_hello(f, &hello);
    case 1:
        return unpack_page_request(f, &request);
    case 2:
        return unpack_page(f, &page);
    case 3:
        return unpack_ready(f, &ready);
    case 4:
        return unpack_sample(f, &sample);
    default:
        return unpack_command(f, &command);
    }
}

static void every_wrong_length_is_refused(void)
{
    struct frame all[6];
    unsigned n = all_messages(all);
    for (unsigned k = 0; k < n; k++) {
        uint8_t right = all[k].n;
        TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_as(k, &all[k]));
        for (unsigned length = 0; length <= FRAME_PAYLOAD_MAX; length++) {
            all[k].n = (uint8_t)length;
            TEST_ASSERT_EQUAL_INT(length == right ? ERR_OK : ERR_FRAME, unpack_as(k, &all[k]));
        }
        all[k].n = right;
    }
}

static void every_wrong_type_is_refused(void)
{
    struct frame all[6];
    unsigned n = all_messages(all);
    for (unsigned k = 0; k < n; k++) {
        uint8_t right = all[k].type;
        for (unsigned type = 0; type < 256; type++) {
            all[k].type = (uint8_t)type;
            TEST_ASSERT_EQUAL_INT(type == right ? ERR_OK : ERR_FRAME, unpack_as(k, &all[k]));
        }
        all[k].type = right;
    }
}

static void counts_above_sixteen_are_refused(void)
{
    struct frame all[6];
    all_messages(all);
    all[0].payload[6] = 17;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, unpack_as(0, &all[0]));
    all[0].payload[6] = 16;
    all[0].payload[7] = 255;
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, unpack_as(0, &all[0]));
    all[4].payload[12] = 17;
    all[4].payload[13] = 15; /* the length still adds up */
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_as(4, &all[4]));
    all[5].payload[13] = 17;
    all[5].n = (uint8_t)(14 + 17 * 5);
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_as(5, &all[5]));
}

static void counts_above_sixteen_are_cut_when_packing(void)
{
    struct link_sample sample = full_sample();
    sample.n_measurements = 255;
    sample.n_readback = 17;
    struct frame f;
    pack_sample(&sample, &f);
    struct link_sample got;
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_sample(&f, &got));
    TEST_ASSERT_EQUAL_UINT8(LINK_CHANNELS_MAX, got.n_measurements);
    TEST_ASSERT_EQUAL_UINT8(LINK_CHANNELS_MAX, got.n_readback);
}

static void texts_without_end_or_with_strange_bytes_are_refused(void)
{
    struct frame all[6];
    all_messages(all);
    memset(all[0].payload + 12, 'x', LINK_PLANT_NAME_SIZE);
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_as(0, &all[0]));
    all[0].payload[12 + LINK_PLANT_NAME_SIZE - 1] = 0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_as(0, &all[0]));
    all[0].payload[13] = '\n';
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_as(0, &all[0]));
    all[0].payload[13] = 0xC3;
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_as(0, &all[0]));

    struct frame page = all[2];
    memset(page.payload + 14, 'n', CHANNEL_NAME_SIZE);
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_as(2, &page));
    page = all[2];
    memset(page.payload + 30, 'u', CHANNEL_UNIT_SIZE);
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_as(2, &page));
    page = all[2];
    page.payload[14] = 0;
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_as(2, &page)); /* a channel needs a name */
}

static void bytes_behind_the_end_of_a_text_are_not_looked_at(void)
{
    struct frame f;
    struct link_page page = some_page();
    pack_page(&page, &f);
    f.payload[14 + 5] = 0xFE;
    struct link_page got;
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_page(&f, &got));
    TEST_ASSERT_EQUAL_STRING("Qr", got.name);
    TEST_ASSERT_EQUAL_CHAR('\0', got.name[5]);
}

static void a_text_too_long_for_its_field_is_cut_and_terminated(void)
{
    struct link_page page = some_page();
    memset(page.name, 'n', sizeof(page.name));
    struct frame f;
    pack_page(&page, &f);
    struct link_page got;
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_page(&f, &got));
    TEST_ASSERT_EQUAL_STRING("nnnnnnnnnnnnnnn", got.name);
}

static void spans_that_are_no_spans_are_refused(void)
{
    struct frame f;
    struct link_page got;
    struct link_page page = some_page();
    page.hi = NAN;
    pack_page(&page, &f);
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, unpack_page(&f, &got));
    page = some_page();
    page.safe = INFINITY;
    pack_page(&page, &f);
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, unpack_page(&f, &got));
    page = some_page();
    page.hi = page.lo;
    pack_page(&page, &f);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, unpack_page(&f, &got));
    page = some_page();
    page.safe = 2.0f;
    pack_page(&page, &f);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, unpack_page(&f, &got));
    page.manipulated = false; /* a measurement has no safe value: whatever stands there is fine */
    pack_page(&page, &f);
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_page(&f, &got));
    f.payload[1] = 2;
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_page(&f, &got));
}

/* Whoever judges the reading says `not a number`. */
static void a_reading_that_is_no_number_comes_through_as_it_is(void)
{
    const float strange[] = {NAN, INFINITY, -INFINITY};
    for (unsigned k = 0; k < 3; k++) {
        struct link_sample sent = full_sample(), got;
        struct frame f;
        sent.measurement[0] = (struct link_reading){.value = strange[k], .quality = QUALITY_GOOD};
        sent.readback[2] = (struct link_reading){.value = strange[k], .quality = QUALITY_UNCERTAIN};
        pack_sample(&sent, &f);
        TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_sample(&f, &got));
        TEST_ASSERT_EQUAL_UINT8(QUALITY_GOOD, got.measurement[0].quality);
        TEST_ASSERT_EQUAL_MEMORY(&strange[k], &got.measurement[0].value, sizeof strange[k]);
        TEST_ASSERT_EQUAL_UINT8(QUALITY_UNCERTAIN, got.readback[2].quality);
        TEST_ASSERT_EQUAL_FLOAT(sent.measurement[3].value, got.measurement[3].value);
    }
}

static void an_unknown_quality_is_refused(void)
{
    struct frame all[6];
    all_messages(all);
    all[4].payload[14 + 4] = 4;
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_as(4, &all[4]));
}

static void a_command_that_is_no_number_is_refused_only_where_it_is_driven(void)
{
    struct link_command sent = some_command();
    struct link_command got;
    struct frame f;
    sent.output[0].value = NAN;
    sent.output[0].drive = false;
    pack_command(&sent, &f);
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_command(&f, &got));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, got.output[0].value);
    sent.output[0].drive = true;
    pack_command(&sent, &f);
    memset(&got, 0x5A, sizeof(got));
    TEST_ASSERT_EQUAL_INT(ERR_NOT_FINITE, unpack_command(&f, &got));
    TEST_ASSERT_EQUAL_HEX32(0x5A5A5A5Au, got.number); /* unchanged on error */
}

static void unknown_flags_and_drive_bytes_are_refused(void)
{
    struct frame all[6];
    all_messages(all);
    all[5].payload[12] = 2;
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_as(5, &all[5]));
    all[5].payload[12] = 0;
    all[5].payload[14 + 4] = 2;
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_as(5, &all[5]));
}

static void another_version_is_told_from_a_broken_frame(void)
{
    struct frame f;
    struct link_hello sent = some_hello();
    sent.version = LINK_VERSION + 1;
    pack_hello(&sent, &f);
    f.n = 40; /* a later version may say more */
    struct link_hello got;
    TEST_ASSERT_EQUAL_INT(ERR_VERSION, unpack_hello(&f, &got));
    TEST_ASSERT_EQUAL_UINT8(LINK_VERSION + 1, got.version);
    TEST_ASSERT_EQUAL_UINT8(LINK_ROLE_PLANT, got.role);
    TEST_ASSERT_EQUAL_UINT32(0, got.session);
    f.payload[1] = 3;
    TEST_ASSERT_EQUAL_INT(ERR_FRAME, unpack_hello(&f, &got));
}

static void a_plant_without_a_tick_is_refused(void)
{
    struct frame f;
    struct link_hello sent = some_hello();
    struct link_hello got;
    sent.tick_ms = 0;
    pack_hello(&sent, &f);
    TEST_ASSERT_EQUAL_INT(ERR_RANGE, unpack_hello(&f, &got));
    TEST_ASSERT_EQUAL_STRING(sent.name, got.name); /* so that it can be told which */
    sent.role = LINK_ROLE_CONTROLLER;
    pack_hello(&sent, &f);
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_hello(&f, &got));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(hello_makes_the_round_trip);
    RUN_TEST(numbers_are_little_endian_on_the_wire);
    RUN_TEST(page_request_ready_and_keep_alive_make_the_round_trip);
    RUN_TEST(page_makes_the_round_trip);
    RUN_TEST(the_largest_sample_makes_the_round_trip);
    RUN_TEST(a_sample_without_readback_and_one_without_anything_make_the_round_trip);
    RUN_TEST(command_makes_the_round_trip);
    RUN_TEST(every_wrong_length_is_refused);
    RUN_TEST(every_wrong_type_is_refused);
    RUN_TEST(counts_above_sixteen_are_refused);
    RUN_TEST(counts_above_sixteen_are_cut_when_packing);
    RUN_TEST(texts_without_end_or_with_strange_bytes_are_refused);
    RUN_TEST(bytes_behind_the_end_of_a_text_are_not_looked_at);
    RUN_TEST(a_text_too_long_for_its_field_is_cut_and_terminated);
    RUN_TEST(spans_that_are_no_spans_are_refused);
    RUN_TEST(a_reading_that_is_no_number_comes_through_as_it_is);
    RUN_TEST(an_unknown_quality_is_refused);
    RUN_TEST(a_command_that_is_no_number_is_refused_only_where_it_is_driven);
    RUN_TEST(unknown_flags_and_drive_bytes_are_refused);
    RUN_TEST(another_version_is_told_from_a_broken_frame);
    RUN_TEST(a_plant_without_a_tick_is_refused);
    return UNITY_END();
}
