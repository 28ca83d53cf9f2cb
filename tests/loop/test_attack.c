/* The plant link under attack on a live run: the real firmware, the real link server, a plant with two loops in
 * automatic, and between them a line that damages what passes, seeded, in one direction or both.
 *
 * What stands between two delimiters on the line is a piece. A piece is whole when it is, byte for byte, a frame
 * that was sent; otherwise it is damaged, and nobody may take it. The lines printed count pieces.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "link_server.h"
#include "memory_port.h"
#include "random_source.h"
#include "two_by_two.h"
#include "unity.h"

#define SEED       0xA77ACCu
#define TICK_MS    10000u
#define FRAMES     1500 /* sent on the attacked line for each kind, rate and direction */
#define SENT_MAX   4096
#define QUEUE_SIZE 65536

enum direction { DOWN, UP, DIRECTIONS }; /* plant to firmware, firmware to plant */

enum kind {
    BIT_FLIPS,
    BURST,
    DROP,
    INSERTION,
    DUPLICATE,
    TRUNCATION,
    REORDERING,
    FLOOD,
    FORGED,
    KINDS
};
static const char *const kind_names[KINDS] = {"bit flips",  "burst",      "byte drops",
                                              "insertions", "duplicates", "truncation",
                                              "reordering", "flood",      "wrong CRC"};

struct wire {
    uint8_t bytes[FRAME_WIRE_MAX];
    size_t n;
};

static struct {
    struct wire sent[SENT_MAX]; /* the newest are kept */
    unsigned n_sent;
    struct wire held; /* reordering: goes after the next */
    uint8_t piece[QUEUE_SIZE];
    size_t n_piece;
    struct frame_decoder decoder; /* takes what the receiver takes */
    unsigned since_end; /* frames sent since the disturbance ended, before one was taken */
    bool taken_since_end;
} line[DIRECTIONS];

static struct {
    unsigned frames, damaged, detected, undetected;
} count[KINDS];

static struct random_source source;
static enum kind kind;
static unsigned percent[DIRECTIONS]; /* of the frames that are attacked */
static uint64_t now;
static uint8_t to_plant[QUEUE_SIZE];
static size_t n_to_plant;
static struct transport transport;
static struct link_server server;
static struct plant *plant;
static struct link_sample sample;
static unsigned commands_accepted, rows_checked, worst_recovery;
static uint32_t last_row, greetings_at_row;
static float sent_value[1u << 16][2]; /* by the lower half of the sample number */
static char said[65536];
static size_t n_said;
static char message[200];

/* ---- the line ---- */

static void deliver(enum direction d, const uint8_t *bytes, size_t n)
{
    if (d == DOWN) {
        TEST_ASSERT_EQUAL(n, memory_port_give(HAL_UART_LINK, bytes, n));
    } else {
        TEST_ASSERT_TRUE(n_to_plant + n <= QUEUE_SIZE);
        memcpy(to_plant + n_to_plant, bytes, n);
        n_to_plant += n;
    }
}

static bool was_sent(enum direction d, const uint8_t *piece, size_t n)
{
    for (unsigned k = 1; k <= SENT_MAX && k <= line[d].n_sent; k++) {
        const struct wire *w = &line[d].sent[(line[d].n_sent - k) % SENT_MAX];
        if (w->n == n && memcmp(w->bytes, piece, n) == 0)
            return true;
    }
    return false;
}

/* The line goes through here: pieces are counted and judged, then delivered. */
static void put(enum direction d, const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        struct frame f;
        TEST_ASSERT_TRUE(line[d].n_piece < QUEUE_SIZE);
        line[d].piece[line[d].n_piece++] = bytes[i];
        bool taken = frame_decode(&line[d].decoder, bytes[i], &f);
        if (bytes[i] != 0)
            continue;
        if (line[d].n_piece > 1) {
            bool whole = was_sent(d, line[d].piece, line[d].n_piece);
            count[kind].frames++;
            count[kind].damaged += !whole;
            count[kind].detected += !whole && !taken;
            count[kind].undetected += !whole && taken;
            snprintf(message, sizeof message, "seed 0x%x, %s: a whole frame was refused", SEED,
                     kind_names[kind]);
            TEST_ASSERT_TRUE_MESSAGE(!whole || taken, message);
            line[d].taken_since_end = line[d].taken_since_end || taken;
        }
        line[d].n_piece = 0;
    }
    deliver(d, bytes, n);
}

static void noise(enum direction d)
{
    uint8_t bytes[600];
    size_t n = 1 + random_below(&source, sizeof bytes);
    for (size_t i = 0; i < n; i++)
        bytes[i] = (uint8_t)random_next(&source);
    put(d, bytes, n);
}

/* A message the receiver would act on, right in everything but its checksum. */
static void forge(enum direction d)
{
    struct frame f;
    uint8_t wire[FRAME_WIRE_MAX];
    if (d == DOWN) {
        struct link_sample m = sample;
        m.number++;
        m.time_ms += TICK_MS;
        m.measurement[0].value = 199.0f;
        pack_sample(&m, &f);
    } else {
        struct link_command m = {
            .number = sample.number, .time_ms = sample.time_ms, .n_outputs = 2};
        m.output[0].value = m.output[1].value = 99.0f;
        m.output[0].drive = m.output[1].drive = true;
        pack_command(&m, &f);
    }
    f.sequence = (uint16_t)random_next(&source);
    size_t n = frame_encode(&f, wire);
    size_t at = n - 2; /* the last byte of the checksum: one bit, or all of it but no zero */
    uint8_t other = random_below(&source, 2) ? wire[at] ^ 0x40u : (uint8_t)~wire[at];
    wire[at] = other ? other : 0x55;
    put(d, wire, n);
}

static void attack(enum direction d, const struct wire *w)
{
    uint8_t b[2 * FRAME_WIRE_MAX];
    size_t n = w->n, at = random_below(&source, (uint32_t)n - 1), length;
    memcpy(b, w->bytes, n);
    switch (kind) {
    case BIT_FLIPS:
        for (unsigned k = 1 + random_below(&source, 4); k; k--)
            b[random_below(&source, (uint32_t)n)] ^= (uint8_t)(1u << random_below(&source, 8));
        break;
    case BURST:
        for (length = 2 + random_below(&source, 15); length && at < n; length--)
            b[at++] = (uint8_t)random_next(&source);
        break;
    case DROP:
        length = 1 + random_below(&source, 4);
        length = length < n - at ? length : n - at;
        memmove(b + at, b + at + length, n - at - length);
        n -= length;
        break;
    case INSERTION:
        length = 1 + random_below(&source, 4);
        memmove(b + at + length, b + at, n - at);
        for (size_t i = 0; i < length; i++)
            b[at + i] = (uint8_t)random_next(&source);
        n += length;
        break;
    case DUPLICATE:
        put(d, b, n);
        break;
    case TRUNCATION: /* half of them with their delimiter */
        n = at;
        if (random_below(&source, 2))
            b[n++] = 0;
        break;
    case REORDERING:
        line[d].held = *w;
        return;
    case FLOOD:
        for (unsigned k = 1 + random_below(&source, 5); k; k--)
            noise(d);
        break;
    default:
        forge(d);
    }
    put(d, b, n);
}

static void send(enum direction d, const uint8_t *bytes, size_t n)
{
    struct wire *w = &line[d].sent[line[d].n_sent++ % SENT_MAX];
    struct wire held = line[d].held;
    memcpy(w->bytes, bytes, n);
    w->n = n;
    line[d].held.n = 0;
    if (!line[d].taken_since_end)
        line[d].since_end++;
    if (random_below(&source, 100) < percent[d])
        attack(d, w);
    else
        put(d, w->bytes, w->n);
    if (held.n)
        put(d, held.bytes, held.n);
}

/* ---- the two ends ---- */

static long server_read(struct transport *t, void *buffer, size_t size)
{
    (void)t;
    size_t n = n_to_plant < size ? n_to_plant : size;
    memcpy(buffer, to_plant, n);
    memmove(to_plant, to_plant + n, n_to_plant - n);
    n_to_plant -= n;
    return (long)n;
}

static long server_write(struct transport *t, const void *data, size_t n)
{
    (void)t;
    send(DOWN, data, n);
    return (long)n;
}

static uint64_t server_now(struct transport *t)
{
    (void)t;
    return now;
}

static void server_close(struct transport *t)
{
    (void)t;
}

static const struct transport_ops ops = {
    .read = server_read, .write = server_write, .now_ms = server_now, .close = server_close};

/* A telemetry row is a tick that ran: its sample was sent, with these values, and has not run before (only after a
 * new greeting does the sample under way begin anew). */
static void check_row(const char *row)
{
    unsigned long number, state, events, q;
    double time_s, y[2];
    int fields = sscanf(row, "T,1,%lu,%lf,%lu,%lu,%lf,%lu,%lf", &number, &time_s, &state, &events,
                        &y[0], &q, &y[1]);
    snprintf(message, sizeof message, "seed 0x%x, %s: %.150s", SEED, kind_names[kind], row);
    TEST_ASSERT_EQUAL_MESSAGE(7, fields, message);
    TEST_ASSERT_TRUE_MESSAGE(number <= sample.number, message);
    bool first = number > last_row;
    TEST_ASSERT_TRUE_MESSAGE(first || (number == last_row && server.greetings != greetings_at_row),
                             message);
    greetings_at_row = server.greetings;
    TEST_ASSERT_EQUAL_DOUBLE_MESSAGE((double)number * TICK_MS / 1000.0, time_s, message);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-4, (double)sent_value[number & 0xFFFFu][0], y[0], message);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-4, (double)sent_value[number & 0xFFFFu][1], y[1], message);
    last_row = (uint32_t)number;
    rows_checked++;
}

static void hear_console(void)
{
    n_said += memory_port_take(HAL_UART_CONSOLE, said + n_said, sizeof said - 1 - n_said);
    said[n_said] = '\0';
}

static void read_rows(void)
{
    hear_console();
    char *at = said, *end;
    while ((end = strchr(at, '\n')) != NULL) {
        *end = '\0';
        if (strncmp(at, "T,", 2) == 0)
            check_row(at);
        at = end + 1;
    }
    n_said = strlen(at);
    memmove(said, at, n_said + 1);
}

static void hear_firmware(void)
{
    static struct wire w;
    uint8_t byte;
    while (memory_port_take(HAL_UART_LINK, &byte, 1)) {
        w.bytes[w.n++] = byte;
        if (byte != 0)
            continue;
        send(UP, w.bytes, w.n);
        w.n = 0;
    }
}

/* The plant took the command that the firmware sent in answer to this sample. */
static void check_command(void)
{
    for (unsigned k = 1; k <= SENT_MAX && k <= line[UP].n_sent; k++) {
        const struct wire *w = &line[UP].sent[(line[UP].n_sent - k) % SENT_MAX];
        struct frame_decoder decoder;
        struct frame f;
        struct link_command m;
        bool good = false;
        frame_decoder_reset(&decoder);
        for (size_t i = 0; i < w->n; i++)
            good = frame_decode(&decoder, w->bytes[i], &f);
        if (!good || unpack_command(&f, &m) != ERR_OK || m.number != sample.number ||
            m.time_ms != sample.time_ms)
            continue;
        if (m.safe == server.command.safe && m.output[0].value == server.command.output[0].value &&
            m.output[1].value == server.command.output[1].value)
            return;
    }
    snprintf(message, sizeof message, "seed 0x%x, %s: command to sample %u was never sent", SEED,
             kind_names[kind], (unsigned)sample.number);
    TEST_FAIL_MESSAGE(message);
}

static void next_sample(void)
{
    sample.number++;
    sample.time_ms = (uint64_t)sample.number * TICK_MS;
    sample.n_measurements = sample.n_readback = 2;
    for (size_t i = 0; i < 2; i++) {
        double jitter = (double)random_below(&source, 2000) / 1000.0 - 1.0;
        sample.measurement[i].value = (float)(two_by_two.value(plant, 3 + i) + jitter);
        sample.readback[i].value = (float)two_by_two.value(plant, i);
        sent_value[sample.number & 0xFFFFu][i] = sample.measurement[i].value;
    }
    TEST_ASSERT_TRUE(link_server_sample(&server, &sample));
}

static void apply_command(void)
{
    char err[100];
    check_command();
    commands_accepted++;
    server.answered = false;
    for (size_t i = 0; i < 2; i++)
        if (server.command.output[i].drive)
            TEST_ASSERT_TRUE_MESSAGE(two_by_two.set_input(plant, i,
                                                          (double)server.command.output[i].value,
                                                          err, sizeof err),
                                     err);
    TEST_ASSERT_TRUE(
        two_by_two.advance(plant, (double)(sample.number + 1) * TICK_MS / 1000.0, err, sizeof err));
}

/* One turn of both sides, 10 ms of their clocks. */
static void turn(void)
{
    static unsigned greetings;
    now += 10;
    memory_port_set_clock(now);
    memory_port_run();
    read_rows();
    hear_firmware();
    transport.ready = true;
    TEST_ASSERT_TRUE_MESSAGE(link_server_turn(&server), server.error);
    if (server.greetings != greetings && server.waiting && server.state == LINK_SAMPLING)
        (void)link_server_resend(&server);
    greetings = server.greetings;
    if (server.answered) {
        apply_command();
        next_sample();
    }
}

static void do_line(const char *text)
{
    char reply[200];
    read_rows();
    n_said = 0;
    memory_port_give(HAL_UART_CONSOLE, text, strlen(text));
    memory_port_give(HAL_UART_CONSOLE, "\n", 1);
    memory_port_run();
    hear_console();
    snprintf(reply, sizeof reply, "%s -> %.100s", text, said);
    TEST_ASSERT_TRUE_MESSAGE(strstr(said, "ok\n") != NULL, reply);
}

static unsigned long stat_of(const char *name)
{
    do_line("stats");
    const char *at = strstr(said, name);
    TEST_ASSERT_NOT_NULL_MESSAGE(at, name);
    unsigned long value = strtoul(at + strlen(name), NULL, 10);
    n_said = 0;
    return value;
}

static const char *const configuration[] = {"mode machine",
                                            "begin",
                                            "set meas1.name y1",
                                            "set meas1.unit degC",
                                            "set meas1.hi 200",
                                            "set meas2.name y2",
                                            "set meas2.unit degC",
                                            "set meas2.hi 200",
                                            "set mv1.name u1",
                                            "set mv1.unit %",
                                            "set mv2.name u2",
                                            "set mv2.unit %",
                                            "set loop1.name one",
                                            "set loop1.pv y1",
                                            "set loop1.out u1",
                                            "set loop1.ti 100",
                                            "set loop2.name two",
                                            "set loop2.pv y2",
                                            "set loop2.out u2",
                                            "set loop2.ti 150",
                                            "apply"};

void setUp(void)
{
    char err[200];
    memset(line, 0, sizeof line);
    percent[DOWN] = percent[UP] = 0;
    for (unsigned d = 0; d < DIRECTIONS; d++) {
        frame_decoder_reset(&line[d].decoder);
        line[d].taken_since_end = true;
    }
    source.state = SEED;
    now = 0;
    n_said = n_to_plant = 0;
    last_row = 0;
    memset(&sample, 0, sizeof sample);
    memory_port_erase_all();
    memory_port_start();
    memory_port_run();
    for (unsigned i = 0; i < sizeof configuration / sizeof configuration[0]; i++)
        do_line(configuration[i]);
    plant = two_by_two.create(err, sizeof err);
    TEST_ASSERT_NOT_NULL(plant);
    transport = (struct transport){.ops = &ops, .fd = -1, .where = "memory"};
    TEST_ASSERT_TRUE(
        link_server_init(&server, &transport, &two_by_two, TICK_MS, 4711, err, sizeof err));
    next_sample();
    for (unsigned i = 0; i < 200; i++)
        turn();
    TEST_ASSERT_TRUE_MESSAGE(sample.number > 10, "the run never began");
    do_line("log on");
}

void tearDown(void)
{
    two_by_two.destroy(plant);
}

static void disturb(unsigned down_percent, unsigned up_percent)
{
    do_line("mode one auto");
    do_line("mode two auto");
    unsigned before[DIRECTIONS] = {line[DOWN].n_sent, line[UP].n_sent};
    percent[DOWN] = down_percent;
    percent[UP] = up_percent;
    enum direction watched = down_percent ? DOWN : UP;
    for (unsigned turns = 0; line[watched].n_sent - before[watched] < FRAMES; turns++) {
        TEST_ASSERT_TRUE_MESSAGE(turns < 40u * FRAMES, "nobody sends any more");
        turn();
    }
    /* The disturbance ends, here and now; what is held back is lost. */
    for (unsigned d = 0; d < DIRECTIONS; d++) {
        line[d].since_end = 0;
        line[d].taken_since_end = false;
        line[d].held.n = 0;
        percent[d] = 0;
    }
    uint32_t number = sample.number;
    for (unsigned turns = 0; sample.number < number + 3; turns++) {
        snprintf(message, sizeof message, "seed 0x%x, %s: no recovery within 5 s", SEED,
                 kind_names[kind]);
        TEST_ASSERT_TRUE_MESSAGE(turns < 500, message);
        turn();
    }
    for (unsigned d = 0; d < DIRECTIONS; d++) {
        TEST_ASSERT_TRUE(line[d].taken_since_end);
        if (line[d].since_end > worst_recovery)
            worst_recovery = line[d].since_end;
    }
    TEST_ASSERT_LESS_OR_EQUAL_UINT(2, worst_recovery);
}

static void no_bad_frame_is_acted_on_and_two_good_ones_end_it(void)
{
    static const unsigned rates[] = {2, 10, 50};
    unsigned accepted = 0;
    for (kind = 0; kind < KINDS; kind++) {
        for (unsigned r = 0; r < 3; r++) {
            disturb(rates[r], 0);
            disturb(0, rates[r]);
            disturb(rates[r] / 2, rates[r] / 2);
        }
        /* Both receivers counted what the witness on the line counted. */
        TEST_ASSERT_EQUAL_UINT(line[UP].decoder.count.good, server.count.frames_in);
        TEST_ASSERT_EQUAL_UINT(line[DOWN].decoder.count.good, stat_of(" good "));
        printf("attack %s: frames %u, damaged %u, detected %u, undetected %u\n", kind_names[kind],
               count[kind].frames, count[kind].damaged, count[kind].detected,
               count[kind].undetected);
        TEST_ASSERT_EQUAL_UINT(0, count[kind].undetected);
        TEST_ASSERT_EQUAL_UINT(count[kind].damaged, count[kind].detected);
        TEST_ASSERT_TRUE_MESSAGE(commands_accepted > accepted, "the run did not go on");
        accepted = commands_accepted;
    }
    read_rows();
    printf("attack recovery: within %u good frames; ticks checked %u, commands checked %u, seed "
           "0x%x\n",
           worst_recovery, rows_checked, commands_accepted, SEED);
    TEST_ASSERT_TRUE(rows_checked > commands_accepted / 2);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(no_bad_frame_is_acted_on_and_two_good_ones_end_it);
    return UNITY_END();
}
