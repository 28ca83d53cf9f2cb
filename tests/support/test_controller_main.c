/* The test controller as a process: serves the link, and a console if asked, to whoever connects.
 *
 *     test-controller socket LINK_PATH [CONSOLE_PATH] [options]
 *     test-controller pty    LINK_SYMLINK [CONSOLE_SYMLINK] [options]
 * options: drop=N mute=N version die=N (leaves after N ticks)
 */
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

#include "bench/text.h"
#include "test_controller.h"

static struct test_controller controller;

static void give_up(const char *what)
{
    perror(what);
    exit(1);
}

static int listen_at(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    (void)snprintf(address.sun_path, sizeof(address.sun_path), "%s", path);
    (void)unlink(path);
    int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    if (fd < 0 || bind(fd, (struct sockaddr *)&address, sizeof(address)) != 0 ||
        listen(fd, 1) != 0) {
        give_up(path);
    }
    return fd;
}

static int new_pty(const char *path)
{
    int fd = posix_openpt(O_RDWR | O_NOCTTY);
    if (fd < 0 || grantpt(fd) != 0 || unlockpt(fd) != 0) {
        give_up("pty");
    }
    int far =
        open(ptsname(fd), O_RDWR | O_NOCTTY); /* held open: no hang-up before somebody comes */
    struct termios settings;
    if (far < 0 || tcgetattr(far, &settings) != 0) {
        give_up("pty");
    }
    cfmakeraw(&settings);
    (void)tcsetattr(far, TCSANOW, &settings);
    (void)unlink(path);
    if (symlink(ptsname(fd), path) != 0) {
        give_up(path);
    }
    return fd;
}

static void flush(int fd, const void *bytes, unsigned *n)
{
    if (fd >= 0 && *n > 0 && write(fd, bytes, *n) < 0) {
        exit(0); /* the bench has left */
    }
    *n = 0;
}

static unsigned take(const struct pollfd *p, char *bytes, size_t size)
{
    if (p->fd < 0 || p->revents == 0) {
        return 0;
    }
    ssize_t n = read(p->fd, bytes, size);
    if (n <= 0) {
        exit(0);
    }
    return (unsigned)n;
}

static void serve(int link_fd, int console_fd, uint32_t die_after)
{
    struct pollfd p[2] = {{.fd = link_fd, .events = POLLIN}, {.fd = console_fd, .events = POLLIN}};
    struct test_controller *c = &controller;
    while (die_after == 0 || c->ticks < die_after) {
        test_controller_turn(c, sim_clock_ms());
        flush(console_fd, c->console_out, &c->n_console_out);
        flush(link_fd, c->link_out, &c->n_link_out);
        if (c->reboot_wanted) {
            test_controller_init(c, c->session + 1, sim_clock_ms());
        }
        (void)poll(p, 2, 50);
        char bytes[2048];
        unsigned n = take(&p[0], bytes, sizeof(bytes));
        test_controller_link(c, (const uint8_t *)bytes, n);
        n = take(&p[1], bytes, sizeof(bytes));
        test_controller_console(c, bytes, n);
    }
}

int main(int argc, char **argv)
{
    if (argc < 3) {
        (void)fprintf(stderr, "usage: test-controller socket|pty LINK [CONSOLE] [options]\n");
        return 2;
    }
    bool sockets = strcmp(argv[1], "socket") == 0;
    const char *path[2] = {argv[2], NULL};
    uint32_t die_after = 0;
    test_controller_init(&controller, (uint32_t)getpid(), sim_clock_ms());
    for (int i = 3; i < argc; i++) {
        unsigned x;
        if (sscanf(argv[i], "drop=%u", &x) == 1) {
            controller.drop_command_every = x;
        } else if (sscanf(argv[i], "mute=%u", &x) == 1) {
            controller.mute_from_tick = x;
        } else if (sscanf(argv[i], "die=%u", &x) == 1) {
            die_after = x;
        } else if (strcmp(argv[i], "version") == 0) {
            controller.refuse_version = true;
        } else {
            path[1] = argv[i];
        }
    }
    int fd[2] = {-1, -1};
    for (int i = 0; i < 2; i++) {
        if (path[i] != NULL) {
            fd[i] = sockets ? listen_at(path[i]) : new_pty(path[i]);
        }
    }
    for (int i = 0; i < 2 && sockets; i++) {
        if (fd[i] >= 0) {
            fd[i] = accept(fd[i], NULL, NULL);
        }
    }
    serve(fd[0], fd[1], die_after);
    return 0;
}
