/* The host as a board: hal/ on POSIX. One thread; the tick context is called from the main loop. */
#define _GNU_SOURCE /* NOLINT(bugprone-reserved-identifier): accept4, ptsname_r */
#include "host_port.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <setjmp.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include "app/app.h"
#include "base/assertion.h"
#include "buses.h"
#include "flash_model.h"
#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/image.h"
#include "hal/retained.h"
#include "hal/self_check.h"
#include "hal/tick.h"
#include "hal/watchdog.h"
#include "hold.h"
#include "line.h"

#define IDLE_MS 20

static struct line lines[HAL_UART_COUNT];
static bool tick_asked;
static uint64_t ticked_ms, clocked_ms, start_ns;
static uint32_t boot_id;
static enum hal_reset cause = HAL_RESET_POWER_ON;
static sigjmp_buf reset_vector;
static bool watchdog_wanted;
static uint32_t watchdog_ms; /* 0 = does not run */
static volatile bool stopping;
static int flash_file = -1;
static struct hal_retained_memory retained; /* lives through resets, not through the process */

static uint64_t now_ns(void)
{
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

static bool keep_in_file(uint32_t address, uint32_t n)
{
    return pwrite(flash_file, flash_model + address, n, (off_t)address) == (ssize_t)n;
}

/* The file holds the access key: only its owner may read it. */
static bool open_flash(const char *path, char *err, size_t err_size)
{
    char who[64];
    flash_file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (flash_file >= 0 && !hold_take(flash_file, who, sizeof who)) {
        if (errno == EACCES)
            (void)snprintf(err, err_size, "%s is the flash of %s", path, who);
        else
            (void)snprintf(err, err_size, "cannot lock %s: %s", path, strerror(errno));
        return false;
    }
    ssize_t n = flash_file < 0 ? -1 : pread(flash_file, flash_model, sizeof flash_model, 0);
    if (n < 0 || (n != 0 && n != (ssize_t)sizeof flash_model)) {
        (void)snprintf(err, err_size, "cannot use %s as flash: %s", path,
                       n < 0 ? strerror(errno) : "it has another size than this board's flash");
        return false;
    }
    if (n == 0 &&
        pwrite(flash_file, flash_model, sizeof flash_model, 0) != (ssize_t)sizeof flash_model) {
        (void)snprintf(err, err_size, "cannot write %s: %s", path, strerror(errno));
        return false;
    }
    flash_model_keep = keep_in_file;
    return true;
}

bool host_port_open(const struct host_port_options *options, char *err, size_t err_size)
{
    start_ns = now_ns();
    boot_id = options->boot_id;
    tick_asked = false;
    watchdog_wanted = options->watchdog;
    flash_model_erase_all();
    if (options->nvm && !open_flash(options->nvm, err, err_size))
        return false;
    if (!line_open(&lines[HAL_UART_CONSOLE], options->console, err, err_size) ||
        !line_open(&lines[HAL_UART_LINK], options->link, err, err_size))
        return false;
    lines[HAL_UART_CONSOLE].flow.on = true;
    return true;
}

static void watchdog_stop(void)
{
    struct itimerval off = {.it_value = {0}};
    if (watchdog_ms != 0)
        (void)setitimer(ITIMER_REAL, &off, NULL);
    watchdog_ms = 0;
}

#if REFLUX_ASSERTIONS
static void print_assertion(const char *text, const char *file, unsigned line)
{
    (void)fprintf(stderr, "reflux-host: %s:%u: must hold, and does not: %s\n", file, line, text);
}
#endif

void host_port_run(void)
{
#if REFLUX_ASSERTIONS
    assertion_report = print_assertion;
#endif
    int reason = sigsetjmp(reset_vector, 1);
    if (reason != 0) {
        boot_id++;
        cause = reason == 1 ? HAL_RESET_REQUESTED : HAL_RESET_WATCHDOG;
        for (unsigned i = 0; i < HAL_UART_COUNT; i++) {
            ring_clear(&lines[i].rx);
            ring_clear(&lines[i].tx);
            lines[i].flow.held = false;
            flow_look(&lines[i].flow, &lines[i].rx); /* who was asked to wait goes on */
        }
    }
    buses_reset();
    app_init(app_instance());
    tick_asked = true;
    clocked_ms = hal_clock_ms();
    while (!stopping) {
        uint64_t now = hal_clock_ms();
        while (clocked_ms < now) {
            app_clock(app_instance(), (uint32_t)++clocked_ms);
            buses_clock();
        }
        if (tick_asked || now - ticked_ms >= HAL_TICK_PERIOD_MS) {
            tick_asked = false;
            ticked_ms = now;
            app_tick(app_instance());
        }
        app_background(app_instance());
    }
    watchdog_stop();
}

void host_port_stop(void)
{
    stopping = true;
}

void host_port_close(void)
{
    watchdog_stop();
    for (unsigned i = 0; i < HAL_UART_COUNT; i++)
        line_close(&lines[i]);
    if (flash_file >= 0)
        (void)close(flash_file);
    flash_file = -1;
    flash_model_keep = NULL;
}

void hal_idle(bool wait)
{
    struct pollfd fds[HAL_UART_COUNT * LINE_FDS];
    unsigned owner[HAL_UART_COUNT * LINE_FDS];
    int n = 0;
    for (unsigned i = 0; i < HAL_UART_COUNT; i++) {
        for (int more = line_watch(&lines[i], &fds[n]); more > 0; more--)
            owner[n++] = i;
        /* Output that is stuck is no reason to spin: room is waited for. */
        wait = wait || lines[i].blocked;
    }
    if (poll(fds, (nfds_t)n, wait && !tick_asked ? IDLE_MS : 0) <= 0)
        return;
    for (int i = 0; i < n; i++)
        if (fds[i].revents && line_serve(&lines[owner[i]], fds[i].revents) &&
            owner[i] == HAL_UART_LINK)
            tick_asked = true;
}

size_t hal_uart_read(enum hal_uart port, uint8_t *buffer, size_t size)
{
    size_t n = ring_read(&lines[port].rx, buffer, size);
    flow_look(&lines[port].flow, &lines[port].rx);
    return n;
}

size_t hal_uart_room(enum hal_uart port)
{
    return ring_room(&lines[port].tx);
}

bool hal_uart_write(enum hal_uart port, const void *data, size_t n)
{
    return ring_write(&lines[port].tx, data, n);
}

size_t hal_uart_pump(enum hal_uart port)
{
    size_t waiting = flow_ready(&lines[port].flow, &lines[port].tx);
    return lines[port].blocked || waiting == 0 ? waiting : line_flush(&lines[port]);
}

bool hal_uart_sends_alone(void)
{
    return false;
}

bool hal_uart_connected(enum hal_uart port)
{
    return lines[port].out >= 0;
}

void hal_uart_get_stats(enum hal_uart port, struct hal_uart_stats *stats)
{
    *stats = lines[port].stats;
}

uint64_t hal_clock_ms(void)
{
    return (now_ns() - start_ns) / 1000000u;
}

uint32_t hal_cycles(void)
{
    return (uint32_t)now_ns();
}

const char *hal_cycles_unit(void)
{
    return "ns";
}

const char *hal_clock_source(void)
{
    return "operating system";
}

void hal_tick_request(void)
{
    tick_asked = true;
}

/* One thread: nothing can come between. */
void hal_tick_lock(void) {}

void hal_tick_unlock(void) {}

/* The watchdog is the interval timer of the process: it bites whatever the firmware is doing just then, and
 * nothing of what that was goes on, as on a board. */
static void bite(int number)
{
    (void)number;
    siglongjmp(reset_vector, 2);
}

void hal_watchdog_feed(void)
{
    struct itimerval timer = {.it_value = {.tv_sec = watchdog_ms / 1000u,
                                           .tv_usec = (suseconds_t)(watchdog_ms % 1000u) * 1000}};
    if (watchdog_ms != 0)
        (void)setitimer(ITIMER_REAL, &timer, NULL);
}

bool hal_watchdog_change(uint32_t timeout_ms)
{
    if (watchdog_ms != 0)
        watchdog_ms = timeout_ms;
    return true;
}

bool hal_watchdog_start(uint32_t timeout_ms)
{
    struct sigaction action = {.sa_handler = bite};
    if (!watchdog_wanted || sigaction(SIGALRM, &action, NULL) != 0)
        return false;
    watchdog_ms = timeout_ms;
    hal_watchdog_feed();
    return true;
}

const char *hal_board_name(void)
{
    return "host";
}

const char *hal_board_text(void)
{
    return "POSIX process";
}

bool hal_last_fault(struct hal_fault *fault)
{
    (void)fault;
    return false; /* the operating system ends the process */
}

enum hal_reset hal_reset_cause(void)
{
    return cause;
}

uint32_t hal_boot_id(void)
{
    return boot_id;
}

void *hal_retained(enum hal_retained_area area, size_t n)
{
    return hal_retained_in(&retained, area, n);
}

_Noreturn void hal_reboot(void)
{
    siglongjmp(reset_vector, 1);
}

enum hal_image hal_image_check(void)
{
    return HAL_IMAGE_NO_CHECKSUM;
}

enum hal_image hal_image_watch(void)
{
    return HAL_IMAGE_NO_CHECKSUM;
}
