#include "bench/transport_board.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "bench/text.h"
#include "virtual_board/control_frame.h"

/* The protocol: host_sim/virtual_board/control.h */
#define NS_PER_MS UINT64_C(1000000)
#define STEP_MS   1000u /* at most, when nobody has anything to say */
#define AGAIN_US  10000u
#define FAULTS    4096u
#define LOADS_MAX 256u

enum { LINE_CONSOLE, LINE_LINK, LINES };

static struct {
    int fd;
    uint64_t now_ns;
    bool open[LINES], gone;
    uint8_t faults[FAULTS]; /* lines for the next step */
    size_t n_faults;
    uint64_t limit_ns, began_ns; /* time does not go beyond; the firmware's clock was 0 */
    uint64_t load_ns[LOADS_MAX];
    size_t n_loads;
    struct half {
        uint8_t bytes[FRAME_MOST];
        size_t n, taken;
    } to[LINES], from[LINES];
} board = {.fd = -1};

static unsigned line_of(const struct transport *t)
{
    return t->context == &board.to[LINE_LINK] ? LINE_LINK : LINE_CONSOLE;
}

static long board_read(struct transport *t, void *buffer, size_t size)
{
    struct half *h = &board.from[line_of(t)];
    size_t n = h->n - h->taken < size ? h->n - h->taken : size;
    (void)memcpy(buffer, h->bytes + h->taken, n);
    h->taken += n;
    if (n == 0 && board.gone)
        return transport_lost(t, "the board has ended");
    return (long)n;
}

static long board_write(struct transport *t, const void *data, size_t n)
{
    struct half *h = &board.to[line_of(t)];
    size_t room = sizeof(h->bytes) - h->n, taken = n < room ? n : room;
    (void)memcpy(h->bytes + h->n, data, taken);
    h->n += taken;
    return board.gone ? transport_lost(t, "the board has ended") : (long)taken;
}

/* One step: what was written goes there, what came back waits to be read. What was not read yet stays in front. */
static bool step(uint64_t ms)
{
    uint8_t head[REPLY_BYTES];
    uint64_t ns = ms * NS_PER_MS;
    if (board.limit_ns > board.now_ns && board.limit_ns - board.now_ns < ns)
        ns = board.limit_ns - board.now_ns;
    frame_put(head, ns, 8);
    frame_put(head + 8, board.to[LINE_CONSOLE].n, 2);
    frame_put(head + 10, board.to[LINE_LINK].n, 2);
    frame_put(head + 12, board.n_faults, 2);
    if (!frame_whole(board.fd, head, REQUEST_BYTES, true))
        return false;
    for (unsigned line = 0; line < LINES; line++) {
        if (!frame_whole(board.fd, board.to[line].bytes, board.to[line].n, true))
            return false;
        board.to[line].n = 0;
    }
    if (!frame_whole(board.fd, board.faults, board.n_faults, true))
        return false;
    board.n_faults = 0;
    if (!frame_whole(board.fd, head, REPLY_BYTES, false))
        return false;
    board.now_ns = frame_number(head, 8);
    board.began_ns = frame_number(head + 13, 8);
    board.n_loads = head[21];
    bool ended = head[12] != 0;
    for (unsigned line = 0; line < LINES; line++) {
        struct half *h = &board.from[line];
        size_t n = frame_number(head + 8 + (size_t)2 * line, 2);
        (void)memmove(h->bytes, h->bytes + h->taken, h->n - h->taken);
        h->n -= h->taken;
        h->taken = 0;
        if (n > sizeof(h->bytes) - h->n || !frame_whole(board.fd, h->bytes + h->n, n, false))
            return false;
        h->n += n;
    }
    for (size_t i = 0; i < board.n_loads; i++) {
        uint8_t load[LOAD_BYTES];
        if (!frame_whole(board.fd, load, LOAD_BYTES, false))
            return false;
        board.load_ns[i] = frame_number(load, LOAD_BYTES);
    }
    return !ended;
}

static void board_turn(struct transport *t, uint64_t timeout_ms)
{
    (void)t;
    for (unsigned line = 0; line < LINES; line++)
        if (board.open[line] && board.from[line].n != board.from[line].taken)
            return; /* first what there is */
    uint64_t ms = timeout_ms < 1u ? 1u : timeout_ms < STEP_MS ? timeout_ms : STEP_MS;
    board.gone = board.gone || !step(ms);
}

static bool board_fault(struct transport *t, const char *name, double value)
{
    char line[96];
    int n = snprintf(line, sizeof(line), "%s %.17g\n", name, value);
    (void)t;
    if (n < 0 || (size_t)n > sizeof(board.faults) - board.n_faults)
        return false;
    (void)memcpy(board.faults + board.n_faults, line, (size_t)n);
    board.n_faults += (size_t)n;
    return true;
}

static void board_measure(struct transport *t, const char *sensor, double value)
{
    char name[64];
    (void)snprintf(name, sizeof(name), "pins.%s", sensor);
    (void)board_fault(t, name, value);
}

static bool board_pins_fault(struct transport *t, const char *fault, double value)
{
    char name[64];
    (void)snprintf(name, sizeof(name), "pins.%s", fault);
    return board_fault(t, name, value);
}

static bool board_loads(struct transport *t, double *ns, size_t n)
{
    (void)t;
    for (size_t i = 0; i < n && i < board.n_loads; i++)
        ns[i] = (double)board.load_ns[i];
    return n == board.n_loads && !board.gone;
}

static void board_clock(struct transport *t, uint64_t *now_ns, uint64_t *began_ns)
{
    (void)t;
    *now_ns = board.now_ns;
    *began_ns = board.began_ns;
}

static void board_limit(struct transport *t, uint64_t ns)
{
    (void)t;
    board.limit_ns = ns;
}

static uint64_t board_now(struct transport *t)
{
    (void)t;
    return board.now_ns / 1000000u;
}

static void board_close(struct transport *t)
{
    board.open[line_of(t)] = false;
    if (!board.open[LINE_CONSOLE] && !board.open[LINE_LINK] && board.fd >= 0) {
        (void)close(board.fd);
        board.fd = -1;
    }
}

static const struct transport_ops board_ops = {.read = board_read,
                                               .write = board_write,
                                               .turn = board_turn,
                                               .now_ms = board_now,
                                               .fault = board_fault,
                                               .measure = board_measure,
                                               .pins_fault = board_pins_fault,
                                               .loads = board_loads,
                                               .clock = board_clock,
                                               .limit = board_limit,
                                               .close = board_close};

static bool connect_to(const char *path, uint64_t until_ms)
{
    struct sockaddr_un a = {.sun_family = AF_UNIX};
    (void)snprintf(a.sun_path, sizeof(a.sun_path), "%s", path);
    for (;;) {
        board.fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
        if (board.fd >= 0 && connect(board.fd, (struct sockaddr *)&a, sizeof(a)) == 0)
            return true;
        (void)close(board.fd);
        board.fd = -1;
        if (sim_clock_ms() >= until_ms)
            return false;
        (void)usleep(AGAIN_US);
    }
}

bool transport_open_board(struct transport *t, const char *path, uint64_t patience_ms, char *err,
                          size_t err_size)
{
    unsigned line = board.open[LINE_LINK] ? LINE_CONSOLE : LINE_LINK;
    if (board.open[line])
        return sim_fail(err, err_size, "board: there is one link and one console");
    if (board.fd < 0 && !connect_to(path, sim_clock_ms() + patience_ms))
        return sim_fail(err, err_size, "board:%s: %s", path, strerror(errno));
    board.open[line] = true;
    t->context = &board.to[line];
    t->ops = &board_ops;
    return true;
}
