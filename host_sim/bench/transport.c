#include "bench/transport.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "bench/text.h"
#include "bench/transport_board.h"

#define WRITE_PATIENCE_MS 2000
#define RETRY_MS          20
#define TRANSPORTS_MAX    4

static const char *extra_scheme;
static transport_opener extra_opener;

void transport_add_scheme(const char *scheme, transport_opener open)
{
    extra_scheme = scheme;
    extra_opener = open;
}

long transport_lost(struct transport *t, const char *reason)
{
    if (!t->gone) {
        t->gone = true;
        (void)snprintf(t->reason, sizeof(t->reason), "%s", reason);
    }
    return -1;
}

/* Before trying again to open what is not there yet: says so the first time. False: that was long enough. */
static bool wait_again(struct transport *t, uint64_t until)
{
    struct timespec span = {.tv_nsec = RETRY_MS * 1000000L};
    uint64_t now = sim_clock_ms();
    if (now >= until) {
        return false;
    }
    if (!t->waiting) {
        (void)fprintf(stderr, "reflux-sim: waiting for %s, %.3g s at most\n", t->where,
                      (double)t->patience_ms / 1000.0);
        t->waiting = true;
    }
    (void)nanosleep(&span, NULL);
    return true;
}

/* ---- descriptors: sockets and pseudo-terminals ---- */

static long fd_read(struct transport *t, void *buffer, size_t size)
{
    ssize_t n = read(t->fd, buffer, size);
    if (n > 0) {
        if (t->spare_fd >= 0) { /* the peer has come: from now on its leaving is to be seen */
            (void)close(t->spare_fd);
            t->spare_fd = -1;
        }
        return (long)n;
    }
    if (n == 0) {
        return transport_lost(t, "the other side closed the line");
    }
    if (errno == EAGAIN || errno == EINTR) {
        return 0;
    }
    return transport_lost(t, errno == EIO ? "the other side closed the line" : strerror(errno));
}

static long fd_result(struct transport *t, ssize_t n)
{
    if (n >= 0) {
        return (long)n;
    }
    if (errno == EAGAIN || errno == EINTR) {
        return 0;
    }
    return transport_lost(t, errno == EPIPE || errno == EIO || errno == ECONNRESET
                                 ? "the other side closed the line"
                                 : strerror(errno));
}

static long fd_write(struct transport *t, const void *data, size_t n)
{
    return fd_result(t, write(t->fd, data, n));
}

static long socket_write(struct transport *t, const void *data, size_t n)
{
    return fd_result(t, send(t->fd, data, n, MSG_NOSIGNAL));
}

static void fd_close(struct transport *t)
{
    (void)close(t->fd);
    if (t->spare_fd >= 0) {
        (void)close(t->spare_fd);
    }
    if (t->link[0] != '\0') {
        (void)unlink(t->link);
    }
}

static const struct transport_ops socket_ops = {
    .read = fd_read, .write = socket_write, .close = fd_close};
static const struct transport_ops pty_ops = {.read = fd_read, .write = fd_write, .close = fd_close};

static bool open_socket(struct transport *t, const char *path, uint64_t until, char *err,
                        size_t err_size)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    if (path[0] == '\0' || strlen(path) >= sizeof(address.sun_path)) {
        return sim_fail(err, err_size, "socket:%s: the path must have 1 to %zu characters", path,
                        sizeof(address.sun_path) - 1);
    }
    (void)snprintf(address.sun_path, sizeof(address.sun_path), "%s", path);
    for (;;) {
        int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
        if (fd < 0) {
            return sim_fail(err, err_size, "socket: %s", strerror(errno));
        }
        if (connect(fd, (const struct sockaddr *)&address, sizeof(address)) == 0) {
            (void)fcntl(fd, F_SETFL, O_NONBLOCK);
            t->fd = fd;
            t->ops = &socket_ops;
            return true;
        }
        int reason = errno;
        (void)close(fd);
        bool later = reason == ENOENT || reason == ECONNREFUSED || reason == EINTR;
        if (!later || !wait_again(t, until)) {
            return sim_fail(err, err_size, "socket:%s: %s%s", path, strerror(reason),
                            later ? " (nobody listens there)" : "");
        }
    }
}

static bool make_raw(int fd)
{
    struct termios settings;
    if (tcgetattr(fd, &settings) != 0) {
        return false;
    }
    cfmakeraw(&settings);
    settings.c_cc[VMIN] = 1; /* so that a read of nothing is a hang-up and not an empty line */
    settings.c_cc[VTIME] = 0;
    return tcsetattr(fd, TCSANOW, &settings) == 0;
}

static bool open_pty(struct transport *t, const char *path, uint64_t until, char *err,
                     size_t err_size)
{
    int fd;
    while ((fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) < 0) {
        int reason = errno;
        if (reason != ENOENT || !wait_again(t, until)) {
            return sim_fail(err, err_size, "pty:%s: %s", path, strerror(reason));
        }
    }
    if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
        (void)close(fd);
        return sim_fail(err, err_size, "pty:%s: another simulator has it open", path);
    }
    if (!make_raw(fd)) {
        (void)close(fd);
        return sim_fail(err, err_size, "pty:%s: is not a terminal", path);
    }
    t->fd = fd;
    t->ops = &pty_ops;
    return true;
}

static bool open_new_pty(struct transport *t, const char *link_path, char *err, size_t err_size)
{
    char name[64];
    int fd = posix_openpt(O_RDWR | O_NOCTTY);
    if (fd < 0 || grantpt(fd) != 0 || unlockpt(fd) != 0 || ptsname_r(fd, name, sizeof(name)) != 0) {
        int reason = errno;
        if (fd >= 0) {
            (void)close(fd);
        }
        return sim_fail(err, err_size, "newpty: %s", strerror(reason));
    }
    t->spare_fd = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (t->spare_fd < 0 || !make_raw(t->spare_fd)) {
        (void)close(fd);
        return sim_fail(err, err_size, "newpty: %s: %s", name, strerror(errno));
    }
    (void)fcntl(fd, F_SETFL, O_NONBLOCK);
    (void)fcntl(fd, F_SETFD, FD_CLOEXEC);
    t->fd = fd;
    t->ops = &pty_ops;
    if (link_path[0] != '\0') {
        if (strlen(link_path) >= sizeof(t->link)) {
            fd_close(t);
            return sim_fail(err, err_size, "newpty:%s: the path is too long", link_path);
        }
        struct stat there;
        if (lstat(link_path, &there) == 0 && S_ISLNK(there.st_mode)) {
            (void)unlink(link_path); /* left by a killed run */
        }
        if (symlink(name, link_path) != 0) {
            int reason = errno;
            fd_close(t);
            return sim_fail(err, err_size, "newpty:%s: %s", link_path, strerror(reason));
        }
        (void)snprintf(t->link, sizeof(t->link), "%s", link_path);
    }
    (void)printf("newpty %s\n", name);
    (void)fflush(stdout);
    return true;
}

/* A bare path: what kind of file is it? */
static bool open_path(struct transport *t, const char *path, uint64_t until, char *err,
                      size_t err_size)
{
    struct stat file;
    while (stat(path, &file) != 0) {
        int reason = errno;
        if (reason != ENOENT || !wait_again(t, until)) {
            return sim_fail(err, err_size,
                            "%s: %s; expected socket:PATH, pty:PATH, newpty[:LINK], "
                            "serial:/dev/ttyX[@BAUD] or the path of a socket or terminal",
                            path, strerror(reason));
        }
    }
    if (S_ISSOCK(file.st_mode)) {
        return open_socket(t, path, until, err, err_size);
    }
    if (S_ISCHR(file.st_mode)) {
        unsigned kind = major(file.st_rdev);
        bool pseudo_terminal = kind >= 136 && kind <= 143; /* Linux: UNIX98_PTY_SLAVE_MAJOR */
        return pseudo_terminal ? open_pty(t, path, until, err, err_size)
                               : transport_open_serial(t, path, err, err_size);
    }
    return sim_fail(err, err_size, "%s: is neither a socket nor a terminal", path);
}

static const char *after_scheme(const char *where, const char *scheme)
{
    size_t n = strlen(scheme);
    return strncmp(where, scheme, n) == 0 && where[n] == ':' ? where + n + 1 : NULL;
}

bool transport_open(struct transport *t, const char *where, uint64_t patience_ms, char *err,
                    size_t err_size)
{
    *t = (struct transport){.fd = -1, .spare_fd = -1, .patience_ms = patience_ms};
    (void)snprintf(t->where, sizeof(t->where), "%s", where);
    uint64_t until = sim_clock_ms() + patience_ms;
    const char *rest;
    if (extra_scheme != NULL && strcmp(where, extra_scheme) == 0) {
        return extra_opener(t, "", err, err_size);
    }
    if (extra_scheme != NULL && (rest = after_scheme(where, extra_scheme)) != NULL) {
        return extra_opener(t, rest, err, err_size);
    }
    if ((rest = after_scheme(where, "socket")) != NULL) {
        return open_socket(t, rest, until, err, err_size);
    }
    if ((rest = after_scheme(where, "pty")) != NULL) {
        return open_pty(t, rest, until, err, err_size);
    }
    if ((rest = after_scheme(where, "serial")) != NULL) {
        return transport_open_serial(t, rest, err, err_size);
    }
    if ((rest = after_scheme(where, "board")) != NULL) {
        return transport_open_board(t, rest, patience_ms, err, err_size);
    }
    if ((rest = after_scheme(where, "newpty")) != NULL || strcmp(where, "newpty") == 0) {
        return open_new_pty(t, rest != NULL ? rest : "", err, err_size);
    }
    return open_path(t, where, until, err, err_size);
}

void transport_close(struct transport *t)
{
    if (t->ops != NULL) {
        t->ops->close(t);
    }
    *t = (struct transport){.fd = -1, .spare_fd = -1, .gone = true};
}

size_t transport_read(struct transport *t, void *buffer, size_t size)
{
    if (t->gone || !t->ready) {
        return 0;
    }
    long n = t->ops->read(t, buffer, size);
    if (n < (long)size) {
        t->ready = false; /* taken everything: ask again only after the next wait */
    }
    if (n <= 0) {
        return 0;
    }
    t->bytes_read += (uint64_t)n;
    return (size_t)n;
}

bool transport_write(struct transport *t, const void *data, size_t n)
{
    const char *at = data;
    uint64_t until = 0;
    while (n > 0 && !t->gone) {
        long taken = t->ops->write(t, at, n);
        if (taken < 0) {
            break;
        }
        at += taken;
        n -= (size_t)taken;
        t->bytes_written += (uint64_t)taken;
        if (n == 0) {
            return true;
        }
        uint64_t now = transport_now_ms(t);
        until = taken > 0 || until == 0 ? now + WRITE_PATIENCE_MS : until;
        if (now >= until) {
            (void)transport_lost(t, "the other side takes no more bytes");
        } else if (t->fd < 0) {
            t->ops->turn(t, 1);
        } else {
            struct pollfd writable = {.fd = t->fd, .events = POLLOUT};
            (void)poll(&writable, 1, (int)(until - now));
        }
    }
    return !t->gone;
}

void transport_wait(struct transport *const *list, size_t n, uint64_t timeout_ms)
{
    struct pollfd wanted[TRANSPORTS_MAX];
    for (size_t i = 0; i < n; i++) {
        if (list[i]->gone || list[i]->ready) {
            return;
        }
        wanted[i] = (struct pollfd){.fd = list[i]->fd, .events = POLLIN};
    }
    if (n > 0 && list[0]->fd < 0) {
        list[0]->ops->turn(list[0], timeout_ms);
        for (size_t i = 0; i < n; i++) {
            list[i]->ready = true;
        }
        return;
    }
    int timeout = timeout_ms > 3600000u ? 3600000 : (int)timeout_ms;
    if (poll(wanted, (nfds_t)n, timeout) <= 0) {
        return;
    }
    for (size_t i = 0; i < n; i++) {
        list[i]->ready =
            wanted[i].revents != 0; /* a hang-up is read too: that is how it is noticed */
    }
}

bool transport_keeps_time(const struct transport *t)
{
    return t->ops->now_ms != NULL;
}

uint64_t transport_now_ms(struct transport *t)
{
    return transport_keeps_time(t) ? t->ops->now_ms(t) : sim_clock_ms();
}

bool transport_pins_fault(struct transport *t, const char *name, double value)
{
    return t->ops != NULL && t->ops->pins_fault != NULL && t->ops->pins_fault(t, name, value);
}

bool transport_fault(struct transport *t, const char *name, double value)
{
    return t->ops != NULL && t->ops->fault != NULL && t->ops->fault(t, name, value);
}
