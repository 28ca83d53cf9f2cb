/* The whole firmware on the board in memory, with a script at its console and a hand-made plant on its link.
 * Every byte goes through the real codec; nothing is reached behind the firmware's back. */
#ifndef REFLUX_TESTS_BOARD_BENCH_H
#define REFLUX_TESTS_BOARD_BENCH_H

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "link/frame.h"
#include "link/messages.h"
#include "memory_port.h"
#include "unity.h"

#define SAID_MAX 400000

struct board_bench {
    uint64_t clock_ms;
    char said[SAID_MAX]; /* console output since board_forget() */
    size_t n_said;

    /* The plant: handmade, unless a test announces another (power_on forgets it) */
    uint8_t n_measurements, n_outputs; /* 0: 4 and 2 */
    void (*announce)(uint8_t index, struct link_page *page);
    bool mute;          /* answers nothing */
    bool deaf_to_pages; /* does not answer page requests */
    uint8_t version;
    uint32_t session, tick_ms;
    const char *units[4]; /* T1, T10, feed, extra */
    const char *names[4];
    bool ready; /* READY has come */
    uint16_t sequence;
    uint32_t number;
    uint64_t time_ms;
    double values[4];
    uint8_t quality[4]; /* enum quality of each; 0 = good */
    bool with_readback;
    double readback[2];
    struct frame_decoder decoder;
    unsigned hellos, page_requests, readies, keep_alives, commands;
    struct link_command command; /* the last one */
    struct link_hello greeted;   /* the last one */
};

static struct board_bench board;

static inline void link_give(struct frame *f)
{
    uint8_t wire[FRAME_WIRE_MAX];
    f->sequence = board.sequence++;
    size_t n = frame_encode(f, wire);
    TEST_ASSERT_EQUAL(n, memory_port_give(HAL_UART_LINK, wire, n));
}

static inline void plant_hello(void)
{
    struct link_hello m = {.version = board.version,
                           .role = LINK_ROLE_PLANT,
                           .session = board.session,
                           .n_measurements = board.announce ? board.n_measurements : 4,
                           .n_outputs = board.announce ? board.n_outputs : 2,
                           .tick_ms = board.tick_ms,
                           .name = "handmade"};
    struct frame f;
    pack_hello(&m, &f);
    link_give(&f);
}

static inline void plant_page(uint8_t index)
{
    static const char *const outputs[2] = {"reflux", "heat"};
    static const char *const output_units[2] = {"l/h", "kW"};
    struct link_page m = {.index = index, .manipulated = index >= 4, .lo = 0, .hi = 200, .safe = 0};
    struct frame f;
    if (board.announce) {
        board.announce(index, &m);
        pack_page(&m, &f);
        link_give(&f);
        return;
    }
    if (index >= 6)
        return;
    snprintf(m.name, sizeof m.name, "%s", index < 4 ? board.names[index] : outputs[index - 4]);
    snprintf(m.unit, sizeof m.unit, "%s", index < 4 ? board.units[index] : output_units[index - 4]);
    if (index >= 4)
        m.safe = index == 4 ? 1.0f : 0.25f;
    pack_page(&m, &f);
    link_give(&f);
}

static inline void plant_answers(const struct frame *f)
{
    struct link_hello hello;
    struct link_page_request page;
    struct link_ready ready;
    switch (f->type) {
    case LINK_HELLO:
        board.hellos++;
        TEST_ASSERT_EQUAL(ERR_OK, unpack_hello(f, &hello));
        TEST_ASSERT_EQUAL(LINK_ROLE_CONTROLLER, hello.role);
        board.greeted = hello;
        board.ready = false;
        if (!board.mute)
            plant_hello();
        break;
    case LINK_PAGE_REQUEST:
        board.page_requests++;
        TEST_ASSERT_EQUAL(ERR_OK, unpack_page_request(f, &page));
        if (!board.mute && !board.deaf_to_pages)
            plant_page(page.index);
        break;
    case LINK_READY:
        board.readies++;
        TEST_ASSERT_EQUAL(ERR_OK, unpack_ready(f, &ready));
        board.ready = ready.session == board.session;
        break;
    case LINK_COMMAND:
        board.commands++;
        TEST_ASSERT_EQUAL(ERR_OK, unpack_command(f, &board.command));
        break;
    case LINK_KEEP_ALIVE:
        board.keep_alives++;
        break;
    default:
        TEST_FAIL_MESSAGE("the firmware sent a message no controller sends");
    }
}

/* Lets everything run until nobody has anything more to say. */
static inline void board_run(void)
{
    uint8_t byte;
    for (unsigned round = 0; round < 400; round++) {
        bool any = false;
        memory_port_run();
        size_t n;
        while ((n = memory_port_take(HAL_UART_CONSOLE, board.said + board.n_said,
                                     SAID_MAX - 1 - board.n_said)) != 0) {
            board.n_said += n;
            board.said[board.n_said] = '\0';
            any = true;
        }
        struct frame f;
        while (memory_port_take(HAL_UART_LINK, &byte, 1)) {
            any = true;
            if (frame_decode(&board.decoder, byte, &f))
                plant_answers(&f);
        }
        if (!any)
            return;
    }
    TEST_FAIL_MESSAGE("the board never came to rest");
}

static inline void board_forget(void)
{
    board.n_said = 0;
    board.said[0] = '\0';
}

/* The board's clock goes on; a living plant sends keep-alives. */
static inline void pass(uint64_t ms)
{
    struct frame f;
    for (uint64_t end = board.clock_ms + ms; board.clock_ms < end;) {
        board.clock_ms += 50;
        if (!board.mute && board.clock_ms % 500 == 0) {
            pack_keep_alive(&f);
            link_give(&f);
        }
        memory_port_set_clock(board.clock_ms);
        board_run();
    }
}

static inline void type(const char *text)
{
    size_t n = strlen(text);
    while (n) { /* as fast as it is taken */
        size_t part = n < 512 ? n : 512;
        TEST_ASSERT_EQUAL(part, memory_port_give(HAL_UART_CONSOLE, text, part));
        board_run();
        text += part;
        n -= part;
    }
}

static inline bool tagged(const char *line)
{
    return strncmp(line, "T,", 2) == 0 || strncmp(line, "H,", 2) == 0 ||
           strncmp(line, "! ", 2) == 0;
}

static inline bool ends_reply(const char *line)
{
    return strcmp(line, "ok") == 0 || strncmp(line, "err ", 4) == 0;
}

#define REPLY_MAX 4000

static char reply_text[SAID_MAX];
static char *reply[REPLY_MAX]; /* lines of the last reply, the `ok` or `err` last */
static unsigned n_reply;
static unsigned n_replies; /* how many ends were in what was said */

/* Cuts what was said into the reply and leaves tagged lines out. */
static inline void cut_reply(void)
{
    memcpy(reply_text, board.said, board.n_said + 1);
    n_reply = n_replies = 0;
    TEST_ASSERT_TRUE_MESSAGE(board.n_said == 0 || reply_text[board.n_said - 1] == '\n', reply_text);
    char *save = NULL;
    for (char *line = strtok_r(reply_text, "\n", &save); line; line = strtok_r(NULL, "\n", &save)) {
        if (tagged(line))
            continue;
        TEST_ASSERT_TRUE(n_reply < REPLY_MAX);
        reply[n_reply++] = line;
        n_replies += ends_reply(line);
    }
}

/* One command in machine mode; returns the line that ends its reply. */
static inline const char *ask(const char *command)
{
    board_forget();
    type(command);
    type("\n");
    cut_reply();
    TEST_ASSERT_EQUAL_MESSAGE(1, n_replies, command);
    TEST_ASSERT_TRUE_MESSAGE(ends_reply(reply[n_reply - 1]), command);
    return reply[n_reply - 1];
}

static inline void ask_ok(const char *command)
{
    const char *end = ask(command);
    char message[512];
    snprintf(message, sizeof message, "%s -> %s", command, end);
    TEST_ASSERT_EQUAL_STRING_MESSAGE("ok", end, message);
}

/* The lines of the reply before its `ok` are these, to the letter; the list ends with NULL. */
static inline void answers_with(const char *command, const char *const *lines)
{
    ask_ok(command);
    unsigned n = 0;
    for (; lines[n]; n++) {
        TEST_ASSERT_TRUE_MESSAGE(n + 1 < n_reply, lines[n]);
        TEST_ASSERT_EQUAL_STRING_MESSAGE(lines[n], reply[n], command);
    }
    TEST_ASSERT_EQUAL_MESSAGE(n + 1, n_reply, board.said);
}

#define ANSWERS(command, ...) answers_with(command, (const char *const[]){__VA_ARGS__, NULL})

static inline void ask_refused(const char *command, const char *code)
{
    char begin[32], message[512];
    snprintf(begin, sizeof begin, "err %s ", code);
    const char *end = ask(command);
    snprintf(message, sizeof message, "%s -> %s", command, end);
    TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(begin, end, strlen(begin), message);
}

static inline bool said(const char *text)
{
    return strstr(board.said, text) != NULL;
}

/* Times `text` stands in what was said. */
static inline unsigned times_said(const char *text)
{
    unsigned n = 0;
    for (const char *at = board.said; (at = strstr(at, text)) != NULL; at++)
        n++;
    return n;
}

static inline void power_on(void)
{
    memset(&board, 0, sizeof board);
    board.version = LINK_VERSION;
    board.session = 77;
    board.tick_ms = 1000;
    board.names[0] = "T1";
    board.names[1] = "T10";
    board.names[2] = "feed";
    board.names[3] = "extra";
    board.units[0] = board.units[1] = "degC";
    board.units[2] = "l/h";
    board.units[3] = "-";
    board.values[0] = 85;
    board.values[1] = 115;
    board.values[2] = 5;
    board.mute = true;
    memory_port_start();
    board_run();
    type("mode machine\n");
    board_forget();
}

static inline void configure(void)
{
    static const char *const lines[] = {"begin",
                                        "set meas1.name T1",
                                        "set meas1.unit degC",
                                        "set meas1.lo 60",
                                        "set meas1.hi 160",
                                        "set meas2.name T10",
                                        "set meas2.unit degC",
                                        "set meas2.lo 60",
                                        "set meas2.hi 160",
                                        "set mv1.name reflux",
                                        "set mv1.unit l/h",
                                        "set mv1.hi 10",
                                        "set mv1.max 10",
                                        "set mv2.name heat",
                                        "set mv2.unit kW",
                                        "set mv2.hi 2",
                                        "set mv2.max 2",
                                        "set mv2.safe 0.5",
                                        "set loop1.name top",
                                        "set loop1.pv T1",
                                        "set loop1.out reflux",
                                        "set loop1.action direct",
                                        "set loop1.ti 200",
                                        "set loop2.name bottom",
                                        "set loop2.pv T10",
                                        "set loop2.out heat",
                                        "set loop2.gain 1.5",
                                        "set loop2.ti 300",
                                        "apply"};
    for (unsigned i = 0; i < sizeof lines / sizeof lines[0]; i++)
        ask_ok(lines[i]);
}

static inline void connect_plant(void)
{
    board.mute = false;
    pass(600);
    TEST_ASSERT_TRUE_MESSAGE(board.ready, "the plant was not connected");
}

static inline void pack_present_sample(struct frame *f)
{
    struct link_sample m = {.number = board.number,
                            .time_ms = board.time_ms,
                            .n_measurements = 4,
                            .n_readback = board.with_readback ? 2 : 0};
    for (unsigned i = 0; i < 4; i++) {
        m.measurement[i].value = (float)board.values[i];
        m.measurement[i].quality = (enum quality)board.quality[i];
    }
    for (unsigned i = 0; i < 2; i++)
        m.readback[i].value = (float)board.readback[i];
    pack_sample(&m, f);
}

static inline void send_sample_again(void)
{
    struct frame f;
    pack_present_sample(&f);
    link_give(&f);
    board_run();
}

/* The next sample, `after_ms` of plant time after the last. */
static inline void sample_after(uint64_t after_ms)
{
    board.number++;
    board.time_ms += after_ms;
    send_sample_again();
}

static inline void samples(unsigned n)
{
    while (n--)
        sample_after(board.tick_ms);
}

static inline uint32_t tick_count(void)
{
    ask_ok("status");
    const char *at = strstr(board.said, " ticks ");
    TEST_ASSERT_NOT_NULL(at);
    return (uint32_t)strtoul(at + 7, NULL, 10);
}

/* Configured, connected, and five samples in. */
static inline void running(void)
{
    power_on();
    configure();
    connect_plant();
    samples(5);
    board_forget();
}

#endif
