/* Plants that do not keep to docs/inside/plant-link.md: each is told in words, once, nothing acts, and the next good one is met. */
#include <math.h>

#include "board_bench.h"

void setUp(void)
{
    running();
}
void tearDown(void) {}

static void ends_up_refused(const char *words)
{
    char line[200];
    snprintf(line, sizeof line, " alarm PLANT_REFUSED handmade %s", words);
    TEST_ASSERT_EQUAL_MESSAGE(1, times_said(" PLANT_REFUSED "), board.said);
    TEST_ASSERT_TRUE_MESSAGE(said(line), board.said);
    TEST_ASSERT_FALSE(said("LINK_UP"));
    ask_ok("alarm");
    const char *reason = strstr(words, ": ") + 2;
    snprintf(line, sizeof line, "PLANT_REFUSED handmade %s", reason);
    TEST_ASSERT_EQUAL_STRING(line, reply[0]);
    ask_ok("status");
    TEST_ASSERT_TRUE(said("state safe, plant link down"));
    ask_refused("mode bottom auto", "STATE");
}

static void a_good_one_is_met(void)
{
    board.session++;
    board.announce = NULL;
    board.ready = false;
    plant_hello();
    board_run();
    TEST_ASSERT_TRUE(board.ready);
    samples(2);
    ask_ok("alarm");
    TEST_ASSERT_FALSE(said("PLANT_REFUSED"));
    ask_ok("mode bottom auto");
    samples(1);
    TEST_ASSERT_FALSE(board.command.safe);
}

/* ---- samples ---- */

static void odd_sample(uint8_t n_measurements, uint8_t n_readback, uint8_t quality)
{
    struct link_sample m = {.number = ++board.number,
                            .time_ms = board.time_ms += 1000,
                            .n_measurements = n_measurements,
                            .n_readback = n_readback};
    struct frame f;
    m.measurement[0].quality = quality;
    pack_sample(&m, &f);
    link_give(&f);
    board_run();
}

static void one_sample_of_another_shape_is_dropped_and_told(void)
{
    ask_ok("mode bottom auto");
    samples(1);
    uint32_t ticks = tick_count();
    unsigned before = board.commands;
    board_forget();
    odd_sample(3, 0, QUALITY_GOOD);
    odd_sample(4, 1, QUALITY_GOOD);
    odd_sample(4, 0, 4);
    TEST_ASSERT_EQUAL(1, times_said(" warning SAMPLE_REFUSED handmade 3 "));
    TEST_ASSERT_EQUAL(1, times_said("SAMPLE_REFUSED"));
    TEST_ASSERT_EQUAL(before, board.commands);
    TEST_ASSERT_EQUAL(ticks, tick_count());
    samples(1);
    TEST_ASSERT_EQUAL(ticks + 1, tick_count());
    TEST_ASSERT_FALSE(board.command.safe);
}

static void a_plant_that_goes_on_with_another_shape_is_refused(void)
{
    ask_ok("mode bottom auto");
    samples(1);
    board_forget();
    board.hellos = 0;
    board.ready = false;
    for (unsigned n = 0; n < 120; n++) { /* for a minute; it hears HELLO and greets */
        odd_sample(4, 1, QUALITY_GOOD);
        pass(500);
        if (n == 3)
            TEST_ASSERT_EQUAL(0, board.hellos);
        if (n == 5) /* 2 s after the first, and no later */
            TEST_ASSERT_TRUE(board.hellos > 0);
    }
    TEST_ASSERT_EQUAL(1, times_said("SAMPLE_REFUSED"));
    TEST_ASSERT_EQUAL(1, times_said("SAFE_STATE"));
    TEST_ASSERT_TRUE(board.hellos > 200);
    ends_up_refused(
        "4 plant refused: samples of another shape than announced; measurements in them");
    a_good_one_is_met();
}

static void a_good_sample_between_odd_ones_keeps_the_plant(void)
{
    for (unsigned n = 0; n < 20; n++) {
        odd_sample(3, 0, QUALITY_GOOD);
        pass(1500);
        samples(1);
        pass(1500);
    }
    TEST_ASSERT_FALSE(said("PLANT_REFUSED"));
    TEST_ASSERT_EQUAL(1, times_said("SAMPLE_REFUSED"));
}

/* ---- HELLO ---- */

static struct frame good_hello(void)
{
    struct link_hello m = {.version = LINK_VERSION,
                           .role = LINK_ROLE_PLANT,
                           .session = 4711,
                           .n_measurements = 4,
                           .n_outputs = 2,
                           .tick_ms = 1000,
                           .name = "handmade"};
    struct frame f;
    pack_hello(&m, &f);
    return f;
}

static void greets_with(const struct frame *hello, unsigned n)
{
    board.mute = true; /* but for this */
    board_forget();
    board.page_requests = 0;
    for (unsigned i = 0; i < n; i++) {
        struct frame f = *hello;
        link_give(&f);
        board_run();
        pass(250);
    }
    TEST_ASSERT_EQUAL(0, board.page_requests);
    board.mute = false;
}

static void a_tick_of_zero_is_told(void)
{
    struct frame f = good_hello();
    memset(f.payload + 8, 0, 4);
    ask_ok("mode bottom auto");
    samples(1);
    greets_with(&f, 240);
    TEST_ASSERT_TRUE(said("SAFE_STATE")); /* the plant that was there is no more */
    ends_up_refused("0 plant refused: tick_ms is 0");
    a_good_one_is_met();
}

static void seventeen_channels_are_told(void)
{
    struct frame f = good_hello();
    f.payload[7] = 17;
    greets_with(&f, 240);
    ends_up_refused("17 plant refused: more channels of a kind than this board takes");
    a_good_one_is_met();
}

static void a_hello_that_cannot_be_read_is_told(void)
{
    struct frame f = good_hello();
    f.n = 35;
    greets_with(&f, 100);
    TEST_ASSERT_EQUAL(1, times_said(" alarm PLANT_REFUSED - 35 plant refused: HELLO of another "
                                    "length, or with a text that is none"));
    TEST_ASSERT_EQUAL(1, times_said("PLANT_REFUSED"));
    f = good_hello();
    f.payload[12] = '\n';
    greets_with(&f, 100);
    TEST_ASSERT_EQUAL(1, times_said(" alarm PLANT_REFUSED - 36 "));
    TEST_ASSERT_EQUAL(1, times_said("PLANT_REFUSED"));
    ask_ok("alarm");
    TEST_ASSERT_TRUE(said("PLANT_REFUSED - HELLO of another length"));
    a_good_one_is_met();
}

static void a_flood_of_bad_greetings_is_not_a_flood_of_events(void)
{
    board.mute = true;
    board_forget();
    for (uint32_t n = 0; n < 1000; n++) {
        struct frame f = good_hello();
        memset(f.payload + 8, 0, 4);
        memcpy(f.payload + 2, &n, 4);
        link_give(&f);
        board_run();
        if (n % 10 == 9)
            pass(50);
    }
    TEST_ASSERT_LESS_OR_EQUAL(6, times_said("PLANT_REFUSED"));
    board_forget();
    struct frame f = good_hello(); /* the one that stays is told, if not at once */
    f.payload[6] = 200;
    greets_with(&f, 40);
    TEST_ASSERT_EQUAL(1, times_said("PLANT_REFUSED handmade 200 "));
    a_good_one_is_met();
}

static void a_bad_plant_right_after_another_is_told_when_there_is_time(void)
{
    struct frame f = good_hello(), g = good_hello();
    memset(f.payload + 8, 0, 4);
    g.payload[6] = 200;
    board_forget();
    link_give(&f);
    board_run();
    TEST_ASSERT_EQUAL(1, times_said("PLANT_REFUSED handmade 0 "));
    board.mute = true;
    for (unsigned n = 0; n < 20; n++) {
        struct frame again = g;
        link_give(&again);
        board_run();
        pass(50);
    }
    TEST_ASSERT_EQUAL(0, times_said("PLANT_REFUSED handmade 200 "));
    for (unsigned n = 0; n < 20; n++) {
        struct frame again = g;
        link_give(&again);
        board_run();
        pass(50);
    }
    TEST_ASSERT_EQUAL(1, times_said("PLANT_REFUSED handmade 200 "));
}

static void the_same_session_with_another_shape_is_another_plant(void)
{
    ask_ok("mode bottom auto");
    samples(2);
    board_forget();
    struct frame f = good_hello();
    uint32_t session = board.session;
    memcpy(f.payload + 2, &session, 4);
    f.payload[7] = 1; /* without its second output */
    board.page_requests = 0;
    board.ready = false;
    link_give(&f);
    board_run();
    TEST_ASSERT_EQUAL(5, board.page_requests);
    TEST_ASSERT_TRUE(board.ready);
    TEST_ASSERT_TRUE(said("SAFE_STATE plant") || said("SAFE_STATE link"));
    TEST_ASSERT_TRUE(said("CHANNEL_MISSING heat"));
    ask_refused("mode bottom auto", "UNKNOWN");
    samples(1);
    TEST_ASSERT_EQUAL(1, board.command.n_outputs);
}

/* ---- pages ---- */

static struct link_page spoilt;
static uint8_t spoilt_at;

static void announce_one_spoilt(uint8_t index, struct link_page *m)
{
    *m = (struct link_page){.index = index, .manipulated = index >= 3, .lo = 0, .hi = 200};
    snprintf(m->name, sizeof m->name, "c%u", (unsigned)index);
    snprintf(m->unit, sizeof m->unit, "%%");
    if (index == spoilt_at)
        *m = spoilt;
}

/* A plant of three measurements and two outputs whose page number `at` is this one. */
static void page_is_refused(uint8_t at, struct link_page page, const char *words)
{
    board.session++;
    board.announce = announce_one_spoilt;
    board.n_measurements = 3;
    board.n_outputs = 2;
    spoilt = page;
    spoilt_at = at;
    board_forget();
    board.page_requests = 0;
    plant_hello();
    for (unsigned n = 0; n < 100; n++) {
        pass(250);
        plant_hello();
    }
    TEST_ASSERT_EQUAL(at + 1u, board.page_requests);
    ends_up_refused(words);
}

static void a_page_that_makes_no_sense_is_told(void)
{
    static const char span[] =
        "1 plant refused: PAGE with a span that is empty or no number, or safe outside it";
    static const char safe[] =
        "4 plant refused: PAGE with a span that is empty or no number, or safe outside it";
    static const char page[] = "1 plant refused: PAGE malformed, or of the other kind";
    struct link_page m = {.index = 1, .lo = 0, .hi = 200, .name = "c1", .unit = "%"};
    struct link_page spoil = m;
    spoil.hi = -5;
    page_is_refused(1, spoil, span);
    spoil.hi = 0;
    page_is_refused(1, spoil, span);
    spoil.hi = NAN;
    page_is_refused(1, spoil, span);
    spoil.hi = INFINITY;
    page_is_refused(1, spoil, span);
    spoil = m;
    spoil.manipulated = true;
    page_is_refused(1, spoil, page);
    spoil = m;
    spoil.name[0] = 0;
    page_is_refused(1, spoil, page);
    spoil = m;
    spoil.index = 4;
    spoil.manipulated = true;
    spoil.safe = 201;
    page_is_refused(4, spoil, safe);
    a_good_one_is_met();
}

static void two_channels_of_one_name_are_told(void)
{
    struct link_page m = {.index = 2, .lo = 0, .hi = 200, .name = "c0", .unit = "%"};
    page_is_refused(2, m, "2 plant refused: PAGE with the name of another of its kind");
    m.index = 4;
    m.manipulated = true;
    strcpy(m.name, "c3");
    page_is_refused(4, m, "4 plant refused: PAGE with the name of another of its kind");
    a_good_one_is_met();
}

static void a_measurement_may_have_the_name_of_an_output(void)
{
    board.session++;
    board.announce = announce_one_spoilt;
    board.n_measurements = 3;
    board.n_outputs = 2;
    spoilt = (struct link_page){
        .index = 4, .manipulated = true, .lo = 0, .hi = 200, .name = "c0", .unit = "%"};
    spoilt_at = 4;
    board.ready = false;
    plant_hello();
    board_run();
    TEST_ASSERT_TRUE(board.ready);
}

static void pages_that_never_come_are_told_once_and_asked_for_all_the_same(void)
{
    board.session++;
    board.deaf_to_pages = true;
    board.page_requests = 0;
    board.ready = false;
    board_forget();
    plant_hello();
    pass(60000);
    TEST_ASSERT_EQUAL(1, times_said("PLANT_REFUSED handmade 0 plant refused: PAGE does not come"));
    TEST_ASSERT_EQUAL(1, times_said("PLANT_REFUSED"));
    TEST_ASSERT_TRUE(board.page_requests > 200);
    board.deaf_to_pages = false;
    pass(500);
    TEST_ASSERT_TRUE(board.ready);
}

static void pages_that_come_slowly_are_no_fault(void)
{
    board.session++;
    board.deaf_to_pages = true;
    board_forget();
    plant_hello();
    for (uint8_t index = 0; index < 6; index++) {
        pass(1500);
        plant_page(index);
    }
    board_run();
    TEST_ASSERT_TRUE(said("LINK_UP"));
    TEST_ASSERT_FALSE(said("PLANT_REFUSED"));
}

static void a_plant_that_counts_its_pages_from_one_is_told(void)
{
    board.session++;
    board.announce = announce_one_spoilt;
    board.n_measurements = 3;
    board.n_outputs = 2;
    spoilt_at = 0;
    spoilt = (struct link_page){.index = 1, .lo = 0, .hi = 200, .name = "c0", .unit = "%"};
    board.ready = false;
    board_forget();
    plant_hello();
    pass(60000);
    TEST_ASSERT_EQUAL(1, times_said("PLANT_REFUSED handmade 0 plant refused: PAGE does not come"));
    TEST_ASSERT_FALSE(board.ready);
}

static void a_refused_plant_that_is_unplugged_is_looked_at_anew(void)
{
    struct frame f = good_hello();
    memset(f.payload + 8, 0, 4);
    greets_with(&f, 10);
    board.mute = true;
    pass(3000);
    ask_ok("alarm");
    TEST_ASSERT_EQUAL_STRING("LINK_DOWN no plant is connected", reply[0]);
    greets_with(&f, 10);
    ends_up_refused("0 plant refused: tick_ms is 0");
}

/* ---- another controller, or ourselves ---- */

static void a_greeting_in_another_role_is_not_answered_and_told_once(void)
{
    for (uint8_t role = 0; role < 4; role++) {
        if (role == LINK_ROLE_PLANT)
            continue;
        power_on();
        struct frame f = good_hello();
        f.payload[1] = role;
        greets_with(&f, 40);
        TEST_ASSERT_EQUAL(1, times_said(" alarm PLANT_REFUSED - 1 plant refused: message of a "
                                        "controller: there is another, or the line echoes; type"));
        TEST_ASSERT_EQUAL(1, times_said("PLANT_REFUSED"));
        connect_plant();
    }
}

static void what_only_controllers_send_changes_nothing_under_a_plant(void)
{
    ask_ok("mode bottom auto");
    samples(1);
    board_forget();
    struct link_command m = {.number = board.number, .time_ms = board.time_ms, .n_outputs = 2};
    struct link_ready ready = {.session = board.session};
    struct frame f;
    for (unsigned n = 0; n < 10; n++) {
        pack_command(&m, &f);
        link_give(&f);
        pack_ready(&ready, &f);
        link_give(&f);
        samples(1);
    }
    TEST_ASSERT_EQUAL(1, times_said("PLANT_REFUSED"));
    TEST_ASSERT_FALSE(board.command.safe);
}

static void an_echo_is_no_sign_of_life(void)
{
    struct link_command m = {.number = board.number, .n_outputs = 2};
    struct frame f;
    ask_ok("mode bottom auto");
    samples(1);
    board.mute = true;
    board_forget();
    for (unsigned n = 0; n < 6; n++) {
        pack_command(&m, &f);
        link_give(&f);
        pass(500);
    }
    TEST_ASSERT_TRUE(said("LINK_DOWN"));
    TEST_ASSERT_TRUE(said("SAFE_STATE"));
}

/* ---- before there is a configuration ---- */

static void the_first_command_drives_what_nobody_configured_to_the_plants_safe_values(void)
{
    power_on();
    connect_plant();
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
    for (unsigned j = 0; j < 2; j++) {
        TEST_ASSERT_TRUE(board.command.output[j].drive);
        TEST_ASSERT_EQUAL_FLOAT(j ? 0.25f : 1.0f, board.command.output[j].value);
    }
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_FALSE(board.command.output[0].drive);
    TEST_ASSERT_FALSE(board.command.output[1].drive);
    board.session++; /* another plant: it is at its safe values by itself */
    plant_hello();
    board_run();
    samples(1);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_FALSE(board.command.output[0].drive);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(one_sample_of_another_shape_is_dropped_and_told);
    RUN_TEST(a_plant_that_goes_on_with_another_shape_is_refused);
    RUN_TEST(a_good_sample_between_odd_ones_keeps_the_plant);
    RUN_TEST(a_tick_of_zero_is_told);
    RUN_TEST(seventeen_channels_are_told);
    RUN_TEST(a_hello_that_cannot_be_read_is_told);
    RUN_TEST(a_flood_of_bad_greetings_is_not_a_flood_of_events);
    RUN_TEST(a_bad_plant_right_after_another_is_told_when_there_is_time);
    RUN_TEST(the_same_session_with_another_shape_is_another_plant);
    RUN_TEST(a_page_that_makes_no_sense_is_told);
    RUN_TEST(two_channels_of_one_name_are_told);
    RUN_TEST(a_measurement_may_have_the_name_of_an_output);
    RUN_TEST(pages_that_never_come_are_told_once_and_asked_for_all_the_same);
    RUN_TEST(pages_that_come_slowly_are_no_fault);
    RUN_TEST(a_plant_that_counts_its_pages_from_one_is_told);
    RUN_TEST(a_refused_plant_that_is_unplugged_is_looked_at_anew);
    RUN_TEST(a_greeting_in_another_role_is_not_answered_and_told_once);
    RUN_TEST(what_only_controllers_send_changes_nothing_under_a_plant);
    RUN_TEST(an_echo_is_no_sign_of_life);
    RUN_TEST(the_first_command_drives_what_nobody_configured_to_the_plants_safe_values);
    return UNITY_END();
}
