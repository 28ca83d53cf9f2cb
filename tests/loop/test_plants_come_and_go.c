/* Plants that come, go, fall silent, change, announce what cannot be, and send what nobody asked for, by chance and for
 * hours, in steps of 50 ms of the board's clock, so that every time-out is met to the millisecond. Every event is kept,
 * how the link and its counters stand, and a checksum of all the controller has sent and when.
 *
 * Kept in reference/plants.txt; how it is made anew is in support/kept_transcript.h. What is right about it the other
 * tests of the link say. */
#include "base/crc32.h"
#include "board_bench.h"
#include "event_sum.h"
#include "kept_transcript.h"
#include "random_source.h"

#define STEP_MS 50u
#define STEPS   16000u
#define WHOLE   640u /* steps from one listing to the next */

static struct random_source source;
static uint32_t sum;
static struct {
    uint8_t measurements, outputs;
    unsigned page, fault; /* what is wrong with that page; 0 nothing */
    bool samples, odd_shape;
    unsigned idle; /* steps to the next sample */
} there;

void setUp(void) {}
void tearDown(void) {}

static bool once_in(uint32_t n)
{
    return random_below(&source, n) == 0;
}

static int from_to(int lo, int hi)
{
    return lo + (int)random_below(&source, (uint32_t)(hi - lo + 1));
}

static void sums(const char *text)
{
    sum = crc32_update(sum, text, strlen(text));
}

static void says(void)
{
    char *line = board.said;
    for (char *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        *end = '\0';
        sums(line);
        if (line[0] != '!')
            continue;
        char time[24], level[12], name[24], subject[24], value[24];
        TEST_ASSERT_EQUAL(
            5, sscanf(line, "! %23s %11s %23s %23s %23s", time, level, name, subject, value));
        const char *which = strchr(line, ':'); /* of the plant's faults */
        kept_line("%u %s %s %s%s", (unsigned)board.clock_ms, time, name, value, which ? which : "");
    }
    board_forget();
}

/* Finds a line of the answer that begins so. */
static void lists(const char *command, const char *begin)
{
    ask_ok(command);
    for (unsigned i = 0; i + 1 < n_reply; i++) {
        sums(reply[i]);
        if (!begin[0] || strncmp(reply[i], begin, strlen(begin)) == 0)
            kept_line("%s", reply[i]);
    }
    board_forget();
}

/* ---- plants ---- */

static void announces(uint8_t index, struct link_page *page)
{
    bool output = index >= there.measurements;
    uint8_t k = output ? (uint8_t)(index - there.measurements) : index;
    *page = (struct link_page){.index = index, .manipulated = output, .hi = 10.0f + k, .safe = 2};
    snprintf(page->name, sizeof page->name, "%s%u", output ? "out" : "in", k + 1u);
    snprintf(page->unit, sizeof page->unit, "%s", output ? "%" : k % 2 ? "-" : "K");
    if (index != there.page)
        return;
    switch (there.fault) {
    case 1:
        page->manipulated = !output;
        break;
    case 2:
        page->lo = page->hi;
        break;
    case 3:
        page->safe = 11.0f + k;
        break;
    case 4:
        snprintf(page->name, sizeof page->name, "%s", output ? "out1" : "in1");
        break;
    case 5:
        page->index = (uint8_t)(index + 1);
        break;
    case 6:
        page->name[0] = '\0';
        break;
    case 7:
        page->hi = __builtin_inff();
        break;
    case 8:
        page->name[1] = '\a';
        break;
    case 9:
        snprintf(page->name, sizeof page->name, "%s", "in1");
        break;
    default:
        break;
    }
}

static void another_plant(void)
{
    board.session = (uint32_t)from_to(1, 1000000);
    there.measurements = (uint8_t)(once_in(8) ? from_to(0, 17) : 2);
    there.outputs = (uint8_t)(once_in(8) ? from_to(0, 17) : 2);
    board.n_measurements = there.measurements;
    board.n_outputs = there.outputs;
    board.version = once_in(8) ? LINK_VERSION + 1 : LINK_VERSION;
    board.tick_ms = once_in(8) ? 0 : once_in(4) ? 500 : 1000;
    there.fault = once_in(2) ? (unsigned)from_to(1, 9) : 0;
    there.page = (unsigned)from_to(0, 3);
    board.deaf_to_pages = once_in(6);
    board.mute = false;
    there.samples = !once_in(6);
    there.odd_shape = once_in(3);
}

static void gives_raw(uint8_t type, const uint8_t *payload, uint8_t n)
{
    struct frame f = {.type = type, .n = n};
    memcpy(f.payload, payload, n);
    link_give(&f);
}

/* Nothing but keep-alives, or nothing at all. */
static void is_quiet(unsigned steps, bool alive)
{
    struct frame f;
    for (; steps; steps--) {
        board.clock_ms += STEP_MS;
        memory_port_set_clock(board.clock_ms);
        if (alive && board.clock_ms % 500 == 0) {
            pack_keep_alive(&f);
            link_give(&f);
        }
        board_run();
    }
}

static void gives_sample(void);

static void something_odd(void)
{
    uint8_t bytes[40];
    struct frame f;
    for (unsigned i = 0; i < sizeof bytes; i++)
        bytes[i] = (uint8_t)random_next(&source);
    switch (from_to(0, 12)) {
    case 0:
        gives_raw(LINK_SAMPLE, bytes, (uint8_t)from_to(0, 30));
        break;
    case 1: /* a controller, or an echo */
        gives_raw((uint8_t)(once_in(2) ? LINK_COMMAND : LINK_READY), bytes, 4);
        break;
    case 2:
        gives_raw((uint8_t)from_to(0x60, 0x90), bytes, (uint8_t)from_to(0, 10));
        break;
    case 3:
        bytes[0] = (uint8_t)from_to(0, 2);
        bytes[1] = (uint8_t)from_to(0, 2);
        gives_raw(LINK_HELLO, bytes, (uint8_t)from_to(0, 36));
        break;
    case 4:
        gives_raw(LINK_PAGE, bytes, (uint8_t)from_to(0, 40));
        break;
    case 5:
        board.sequence = (uint16_t)(board.sequence + (uint16_t)from_to(-3, 5));
        break;
    case 6:
        (void)memory_port_give(HAL_UART_LINK, bytes, sizeof bytes);
        break;
    case 7:
        plant_hello();
        break;
    case 9: { /* silent for as long as is borne, or a little less or more */
        bool mute = board.mute;
        board.mute = true;
        is_quiet((unsigned)from_to(38, 42), false);
        board.mute = mute;
        plant_hello();
        break;
    }
    case 10: /* the same sample for long */
        for (int n = from_to(1, 4); n && board.ready; n--) {
            is_quiet((unsigned)from_to(80, 260), true);
            gives_sample();
        }
        break;
    case 11:
        board.sequence = (uint16_t)(board.sequence + 0x7FFFu + random_below(&source, 3));
        break;
    case 8:
        plant_page((uint8_t)from_to(0, 3));
        break;
    default:
        pack_keep_alive(&f);
        link_give(&f);
    }
}

static void gives_sample(void)
{
    struct link_sample m = {.number = board.number,
                            .time_ms = board.time_ms,
                            .n_measurements = there.measurements,
                            .n_readback = once_in(3) ? there.outputs : 0};
    struct frame f;
    for (unsigned i = 0; i < m.n_measurements; i++)
        m.measurement[i].value = (float)(board.number % 9) + (float)i / 8.0f;
    if (there.odd_shape || once_in(80))
        m.n_measurements++;
    if (once_in(80))
        m.n_readback = (uint8_t)(there.outputs + 1);
    pack_sample(&m, &f);
    link_give(&f);
}

static void plant_goes_on(void)
{
    struct frame f;
    if (once_in(300))
        another_plant();
    if (once_in(300))
        board.mute = !board.mute;
    if (once_in(300))
        there.samples = !there.samples;
    if (once_in(300))
        board.deaf_to_pages = !board.deaf_to_pages;
    if (once_in(60))
        something_odd();
    if (board.mute)
        return;
    if (board.clock_ms % 500 == 0) {
        pack_keep_alive(&f);
        link_give(&f);
    }
    if (!board.ready || !there.samples || there.idle-- > 0)
        return;
    there.idle = board.tick_ms / STEP_MS / 2;
    board.number += !once_in(40);
    board.time_ms += once_in(40)   ? 0
                     : once_in(20) ? (uint64_t)board.tick_ms * (unsigned)from_to(2, 8)
                     : once_in(20) ? board.tick_ms * 7u / 8u - once_in(2)
                     : once_in(20) ? board.tick_ms * 9u / 8u + once_in(2)
                     : once_in(20) ? board.tick_ms * 3u / 2u - once_in(2)
                                   : board.tick_ms;
    gives_sample();
}

static void sums_answers(void)
{
    static unsigned told[6];
    const unsigned now[6] = {board.hellos,      board.page_requests, board.readies,
                             board.keep_alives, board.commands,      board.command.safe};
    char text[120];
    if (memcmp(now, told, sizeof now) == 0)
        return;
    memcpy(told, now, sizeof now);
    snprintf(text, sizeof text, "%u %u %u %u %u %u %u %u %u %s", (unsigned)board.clock_ms, now[0],
             now[1], now[2], now[3], now[4], now[5], (unsigned)board.command.n_outputs,
             (unsigned)board.greeted.session, board.greeted.name);
    sums(text);
    for (unsigned j = 0; j < board.command.n_outputs; j++) {
        snprintf(text, sizeof text, " %.7g %d", (double)board.command.output[j].value,
                 board.command.output[j].drive);
        sums(text);
    }
}

static void lives_with(const char *name, const char *const *settings)
{
    memory_port_erase_all();
    power_on();
    memset(&there, 0, sizeof there);
    board.announce = announces;
    another_plant();
    kept_line("# %s", name);
    for (; *settings; settings++)
        ask_ok(*settings);
    for (unsigned step = 0; step < STEPS; step++) {
        plant_goes_on();
        board.clock_ms += STEP_MS;
        memory_port_set_clock(board.clock_ms);
        board_run();
        sums_answers();
        says();
        if (step % (STEPS / 8) == STEPS / 16) { /* somebody acts, where that is possible */
            (void)ask("out a 5");
            says();
        }
        if (step % 30 == 0) /* for the checksum */
            lists("commission plant", "nothing");
        if (step % WHOLE == WHOLE - 1) {
            sum = event_sum(sum);
            kept_line("%08x", (unsigned)sum);
            lists("status", "state");
            lists("alarm", "");
            lists("stats", "link");
        }
    }
}

static void whoever_is_on_the_link_is_met_as_before(void)
{
    static const char *const plain[] = {"begin",
                                        "set meas1.name in1",
                                        "set meas1.unit K",
                                        "set meas1.hi 16",
                                        "set meas2.name in2",
                                        "set meas2.hi 16",
                                        "set mv1.name out1",
                                        "set mv1.unit %",
                                        "set mv1.hi 128",
                                        "set mv1.max 128",
                                        "set mv2.name out2",
                                        "set mv2.hi 64",
                                        "set mv2.max 64",
                                        "set mv2.unit K",
                                        "set loop1.name a",
                                        "set loop1.pv in1",
                                        "set loop1.out out1",
                                        "apply",
                                        NULL};
    static const char *const limits[] = {"begin",
                                         "set meas1.name in2",
                                         "set meas1.hi 16",
                                         "set mv1.name out1",
                                         "set mv1.unit %",
                                         "set mv1.hi 128",
                                         "set mv1.max 128",
                                         "set mv1.safe 3",
                                         "set loop1.name a",
                                         "set loop1.pv in2",
                                         "set loop1.out out1",
                                         "set tick.timeout 3",
                                         "set tick.miss_limit 2",
                                         "set tick.base 1",
                                         "apply",
                                         NULL};
    source.state = 20261122u;
    kept_open("reference/plants.txt");
    lives_with("plants", plain);
    lives_with("with a time-out and a tick of its own", limits);
    kept_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(whoever_is_on_the_link_is_met_as_before);
    return UNITY_END();
}
