/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "control.h"

#include "chips/wired.h"
#include "control_frame.h"
#include "faults.h"
#include "world.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#define LOOK_NS      UINT64_C(200000) /* two bytes at 115200 baud and a little */
#define WALL_STEP_NS UINT64_C(1000000)

static int listen_at(const char *path, char *err, size_t err_size)
{
    struct sockaddr_un a = {.sun_family = AF_UNIX};
    if (strlen(path) >= sizeof(a.sun_path)) {
        (void)snprintf(err, err_size, "%s: a socket's path has at most %zu characters", path,
                       sizeof(a.sun_path) - 1);
        return -1;
    }
    (void)snprintf(a.sun_path, sizeof(a.sun_path), "%s", path);
    (void)unlink(path);
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd < 0 || bind(fd, (struct sockaddr *)&a, sizeof(a)) != 0 || listen(fd, 1) != 0) {
        (void)snprintf(err, err_size, "%s: %s", path, strerror(errno));
        if (fd >= 0)
            (void)close(fd);
        return -1;
    }
    return fd;
}

/* Until the time, or until what left has left. */
static void step(struct board *b, uint64_t ns)
{
    uint64_t end = board_ns(b) + ns;
    bool moved = false;
    while (b->verdict[0] == '\0' && board_ns(b) < end) {
        uint64_t to = board_ns(b) + LOOK_NS;
        b->from_board_moved = false;
        board_run(b, to < end ? to : end);
        (void)faults_take_flash_cut(b);
        if (moved && !b->from_board_moved)
            return;
        moved = moved || b->from_board_moved;
    }
}

static size_t put_loads(struct board *b, struct wired *wired, uint8_t *bytes)
{
    double ns[WIRED_OUTPUTS_MAX];
    size_t n = wired == NULL ? 0 : wired_loads(wired, board_ns(b), ns);
    for (size_t i = 0; i < n; i++)
        frame_put(bytes + i * LOAD_BYTES, (uint64_t)ns[i], LOAD_BYTES);
    return n;
}

static bool serve_one(struct board *b, struct wired *wired, int fd)
{
    static uint8_t bytes[2 * FRAME_MOST], loads[WIRED_OUTPUTS_MAX * LOAD_BYTES];
    uint8_t head[REPLY_BYTES];
    if (!frame_whole(fd, head, REQUEST_BYTES, false))
        return false;
    size_t n[BOARD_LINES] = {frame_number(head + 8, 2), frame_number(head + 10, 2)};
    for (unsigned line = 0; line < BOARD_LINES; line++) {
        if (n[line] > FRAME_MOST || !frame_whole(fd, bytes, n[line], false))
            return false;
        (void)line_give(b, line, bytes, n[line]);
    }
    size_t faults = frame_number(head + 12, 2);
    char refused[BOARD_VERDICT];
    if (faults > FRAME_MOST || !frame_whole(fd, bytes, faults, false))
        return false;
    if (wired != NULL && faults != 0) {
        faults = wired_lines(wired, board_ns(b), (char *)bytes, faults, refused, sizeof(refused));
        board_world_changed(b);
    }
    if (faults > FRAME_MOST ||
        !faults_add_text(b, (const char *)bytes, faults, refused, sizeof(refused)))
        board_verdict(b, "%s", refused);
    step(b, frame_number(head, 8));
    n[0] = line_take(b, 0, bytes, FRAME_MOST);
    n[1] = line_take(b, 1, bytes + n[0], FRAME_MOST);
    frame_put(head, board_ns(b), 8);
    frame_put(head + 8, n[0], 2);
    frame_put(head + 10, n[1], 2);
    head[12] = b->verdict[0] != '\0';
    frame_put(head + 13, b->clock_began_ns, 8);
    size_t n_loads = put_loads(b, wired, loads);
    head[21] = (uint8_t)n_loads;
    return frame_whole(fd, head, REPLY_BYTES, true) && frame_whole(fd, bytes, n[0] + n[1], true) &&
           frame_whole(fd, loads, n_loads * LOAD_BYTES, true) && b->verdict[0] == '\0';
}

int control_serve(struct board *b, struct wired *wired, const char *path, char *err,
                  size_t err_size)
{
    int listener = listen_at(path, err, err_size);
    if (listener < 0)
        return 1;
    int fd;
    do {
        fd = accept(listener, NULL, NULL);
    } while (fd < 0 && errno == EINTR);
    (void)close(listener);
    (void)unlink(path);
    while (fd >= 0 && serve_one(b, wired, fd)) {
    }
    (void)close(fd);
    if (b->verdict[0] == '\0')
        return 0;
    (void)snprintf(err, err_size, "%s", b->verdict);
    return 3;
}

/* ---- in step with the wall ---- */

struct end {
    int listener, fd;
};

static uint64_t wall_ns(void)
{
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

static void close_end(struct end *e)
{
    (void)close(e->fd);
    e->fd = -1;
}

static void exchange(struct board *b, struct end *e, unsigned line)
{
    uint8_t bytes[4096];
    size_t room = BOARD_LINE_ROOM - (b->lines[line].to_tail - b->lines[line].to_head);
    if (e->fd >= 0 && room > 0) {
        ssize_t n = recv(e->fd, bytes, room < sizeof(bytes) ? room : sizeof(bytes), MSG_DONTWAIT);
        if (n > 0)
            (void)line_give(b, line, bytes, (size_t)n);
        else if (n == 0 || (errno != EAGAIN && errno != EINTR))
            close_end(e);
    }
    size_t n = line_take(b, line, bytes, sizeof(bytes));
    if (e->fd >= 0 && n > 0 && !frame_whole(e->fd, bytes, n, true))
        close_end(e);
}

#define ENDS_POLLED 4u /* each line, and its listener */
_Static_assert(ENDS_POLLED == 2 * BOARD_LINES, "two descriptors for each line");

/* Waits for bytes or for the time, ms. */
static void wait_for(struct end *ends, int ms)
{
    struct pollfd p[ENDS_POLLED];
    for (unsigned i = 0; i < BOARD_LINES; i++) {
        p[i] = (struct pollfd){.fd = ends[i].fd, .events = POLLIN};
        p[BOARD_LINES + i] =
            (struct pollfd){.fd = ends[i].fd < 0 ? ends[i].listener : -1, .events = POLLIN};
    }
    (void)poll(p, ENDS_POLLED, ms);
    for (unsigned i = 0; i < BOARD_LINES; i++)
        if (ends[i].fd < 0 && (p[BOARD_LINES + i].revents & POLLIN) != 0)
            ends[i].fd = accept(ends[i].listener, NULL, NULL);
}

int lines_serve(struct board *b, const char *console, const char *link, const volatile int *stop,
                char *err, size_t err_size)
{
    struct end ends[BOARD_LINES] = {{listen_at(console, err, err_size), -1}, {-1, -1}};
    if (ends[0].listener < 0)
        return 1;
    ends[1].listener = listen_at(link, err, err_size);
    if (ends[1].listener < 0)
        return 1;
    while (!*stop && ends[0].fd < 0)
        wait_for(ends, 1000); /* nothing that the board says at power-on is lost */
    uint64_t behind = wall_ns() - board_ns(b);
    while (!*stop && b->verdict[0] == '\0') {
        for (unsigned line = 0; line < BOARD_LINES; line++)
            exchange(b, &ends[line], line);
        uint64_t wall = wall_ns() - behind, now = board_ns(b);
        if (now >= wall) {
            wait_for(ends, 1);
            continue;
        }
        if (wall - now >
            1000000000u) /* a machine that stood still: the board does not run after it */
            behind += wall - now - WALL_STEP_NS;
        wait_for(ends, 0);
        board_run(b, now + WALL_STEP_NS);
        (void)faults_take_flash_cut(b);
    }
    for (unsigned line = 0; line < BOARD_LINES; line++) {
        exchange(b, &ends[line], line);
        (void)close(ends[line].listener);
    }
    (void)unlink(console);
    (void)unlink(link);
    if (b->verdict[0] == '\0')
        return 0;
    (void)snprintf(err, err_size, "%s", b->verdict);
    return 3;
}
