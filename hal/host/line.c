#define _GNU_SOURCE /* NOLINT(bugprone-reserved-identifier): accept4, ptsname_r */
#include "line.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

#include "hold.h"

static bool fail(char *err, size_t err_size, const char *what, const char *where)
{
    (void)snprintf(err, err_size, "%s %s: %s", what, where, strerror(errno));
    return false;
}

static bool set_nonblocking(int fd)
{
    int flags = fcntl(fd, F_GETFL);
    return flags >= 0 && fcntl(fd, F_SETFL, flags | O_NONBLOCK) == 0;
}

/* Does the link lead to a terminal of a host that runs? `own` is the terminal just opened: the kernel may have given it the
 * number of one that is gone. */
static bool leads_to_another_host(const char *target, const char *own, char *who, size_t size)
{
    int fd =
        strcmp(target, own) == 0 ? -1 : open(target, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0)
        return false;
    bool taken = hold_is_taken(fd, who, size);
    (void)close(fd);
    return taken;
}

/* Replaces a link that an ended run has left, and nothing that a person put there. */
static bool make_link(struct line *line, const char *terminal, const char *path, char *err,
                      size_t err_size)
{
    char target[108], who[64];
    if (strlen(path) >= sizeof line->path) {
        errno = ENAMETOOLONG;
        return fail(err, err_size, "cannot link", path);
    }
    ssize_t n = readlink(path, target, sizeof target - 1);
    if (n >= 0) {
        target[n] = '\0';
        if (strncmp(target, "/dev/pts/", 9) != 0) {
            (void)snprintf(err, err_size, "%s leads to %s, which no run has left: it stays", path,
                           target);
            return false;
        }
        if (leads_to_another_host(target, terminal, who, sizeof who)) {
            (void)snprintf(err, err_size, "%s is the link of %s", path, who);
            return false;
        }
        (void)unlink(path);
    }
    if (symlink(terminal, path) != 0)
        return fail(err, err_size, "cannot link", path);
    (void)snprintf(line->path, sizeof line->path, "%s", path);
    return true;
}

static bool open_pty(struct line *line, const char *link, char *err, size_t err_size)
{
    char name[64], who[64];
    struct termios raw;
    int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0 ||
        ptsname_r(master, name, sizeof name) != 0)
        return fail(err, err_size, "cannot open", "a pseudo-terminal");
    line->slave = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (line->slave < 0 || tcgetattr(line->slave, &raw) != 0)
        return fail(err, err_size, "cannot open", name);
    cfmakeraw(&raw);
    if (tcsetattr(line->slave, TCSANOW, &raw) != 0 || !set_nonblocking(master) ||
        !hold_take(line->slave, who, sizeof who))
        return fail(err, err_size, "cannot set up", name);
    line->in = line->out = master;
    line->kind = LINE_PTY;
    if (link[0] && !make_link(line, name, link, err, err_size))
        return false;
    (void)fprintf(stderr, "pseudo-terminal %s%s%s\n", name, link[0] ? " as " : "", link);
    return true;
}

static bool open_socket(struct line *line, const char *path, char *err, size_t err_size)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    struct stat st;
    if (strlen(path) >= sizeof address.sun_path) {
        errno = ENAMETOOLONG;
        return fail(err, err_size, "cannot listen on socket", path);
    }
    memcpy(address.sun_path, path, strlen(path) + 1);
    if (lstat(path, &st) == 0 && S_ISSOCK(st.st_mode))
        (void)unlink(path);
    line->listener = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (line->listener < 0 ||
        bind(line->listener, (const struct sockaddr *)&address, sizeof address) != 0 ||
        listen(line->listener, 1) != 0)
        return fail(err, err_size, "cannot listen on socket", path);
    (void)snprintf(line->path, sizeof line->path, "%s", path);
    line->kind = LINE_SOCKET;
    return true;
}

bool line_known(const char *where, char *err, size_t err_size)
{
    if (strcmp(where, "pty") == 0 || strcmp(where, "stdio") == 0 ||
        (strncmp(where, "pty:", 4) == 0 && where[4]) ||
        (strncmp(where, "socket:", 7) == 0 && where[7]))
        return true;
    (void)snprintf(err, err_size, "'%s' is not a line: use pty, pty:LINK, socket:PATH or stdio",
                   where);
    return false;
}

bool line_open(struct line *line, const char *where, char *err, size_t err_size)
{
    memset(line, 0, sizeof *line);
    line->rx = (struct ring){.bytes = line->rx_bytes, .size = LINE_RING};
    line->tx = (struct ring){.bytes = line->tx_bytes, .size = LINE_RING};
    line->listener = line->in = line->out = line->slave = -1;
    if (!line_known(where, err, err_size))
        return false;
    if (strcmp(where, "pty") == 0)
        return open_pty(line, "", err, err_size);
    if (strncmp(where, "pty:", 4) == 0)
        return open_pty(line, where + 4, err, err_size);
    if (strncmp(where, "socket:", 7) == 0)
        return open_socket(line, where + 7, err, err_size);
    line->in_flags = fcntl(STDIN_FILENO, F_GETFL);
    line->out_flags = fcntl(STDOUT_FILENO, F_GETFL);
    line->kind = LINE_STDIO;
    line->in = STDIN_FILENO;
    line->out = STDOUT_FILENO;
    if (set_nonblocking(line->in) && set_nonblocking(line->out))
        return true;
    return fail(err, err_size, "cannot use", "standard input and output");
}

static void drop_peer(struct line *line)
{
    if (line->kind == LINE_SOCKET && line->in >= 0)
        (void)close(line->in);
    line->in = line->out = -1;
    line->blocked = false;
}

void line_close(struct line *line)
{
    if (line->kind == LINE_NONE)
        return;
    if (line->kind == LINE_PTY) {
        (void)close(line->in);
        (void)close(line->slave);
    }
    if (line->kind == LINE_STDIO) { /* the shell's own terminal: as it was */
        (void)fcntl(STDIN_FILENO, F_SETFL, line->in_flags);
        (void)fcntl(STDOUT_FILENO, F_SETFL, line->out_flags);
    }
    drop_peer(line);
    if (line->listener >= 0)
        (void)close(line->listener);
    if (line->path[0])
        (void)unlink(line->path);
    line->kind = LINE_NONE;
}

int line_watch(const struct line *line, struct pollfd *fds)
{
    bool peer = line->in >= 0 || line->out >= 0;
    int n = 0;
    if (!peer && line->listener >= 0)
        fds[n++] = (struct pollfd){.fd = line->listener, .events = POLLIN};
    if (line->in >= 0)
        fds[n++] = (struct pollfd){.fd = line->in, .events = POLLIN};
    if (line->out >= 0 && line->blocked) {
        if (line->in == line->out)
            fds[0].events |= POLLOUT;
        else
            fds[n++] = (struct pollfd){.fd = line->out, .events = POLLOUT};
    }
    return n;
}

bool line_serve(struct line *line, short events)
{
    uint8_t buffer[4096];
    if (line->in < 0 && line->out < 0) {
        int peer = accept4(line->listener, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (peer >= 0) {
            line->in = line->out = peer;
            line->flow.held = false; /* what the one before has asked for is his */
        }
        return false;
    }
    if (events & (POLLOUT | POLLERR))
        line->blocked = false; /* the next write tells, also when the reader is gone */
    if (line->in < 0 || !(events & (POLLIN | POLLHUP | POLLERR)))
        return false;
    ssize_t n = read(line->in, buffer, sizeof buffer);
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) {
        if (line->kind == LINE_STDIO)
            line->in = -1; /* no more commands, but whoever reads the output goes on reading */
        else
            drop_peer(line);
        return false;
    }
    for (ssize_t i = 0; i < n; i++) {
        line->stats.received++;
        if (flow_received(&line->flow, buffer[i]) && !ring_put(&line->rx, buffer[i]))
            line->stats.rx_dropped++;
    }
    flow_look(&line->flow, &line->rx);
    return n > 0;
}

/* Returns the bytes that may go out next, in one piece; drop it with gone(). */
static size_t to_send(const struct line *line, const uint8_t **data)
{
    if (line->flow.pending) {
        *data = &line->flow.pending;
        return 1;
    }
    return line->flow.held ? 0 : ring_peek(&line->tx, data);
}

static void gone(struct line *line, size_t n)
{
    if (line->flow.pending)
        line->flow.pending = 0;
    else
        ring_skip(&line->tx, n);
}

size_t line_flush(struct line *line)
{
    const uint8_t *data;
    size_t n;
    while ((n = to_send(line, &data)) > 0) {
        if (line->out < 0) { /* a wire nobody listens to takes everything */
            gone(line, n);
            continue;
        }
        ssize_t sent = line->kind == LINE_SOCKET ? send(line->out, data, n, MSG_NOSIGNAL)
                                                 : write(line->out, data, n);
        if (sent > 0) {
            gone(line, (size_t)sent);
            line->stats.sent += (uint32_t)sent;
            continue;
        }
        if (sent < 0 && (errno == EAGAIN || errno == EINTR)) {
            line->blocked = true;
            break;
        }
        drop_peer(line);
    }
    return flow_ready(&line->flow, &line->tx);
}
