/* The host port: flash kept in a file, and lines whose other side comes and goes. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "app/app.h"
#include "hal/clock.h"
#include "hal/nvm.h"
#include "hal/tick.h"
#include "hal/uart.h"
#include "host_port.h"
#include "unity.h"

static char folder[] = "/tmp/reflux-hal-XXXXXX";
static char console_path[64], link_path[64], nvm_path[64], console_where[80], link_where[80],
    err[256];

/* The port's own loop is not run here: the tests call what the firmware would. */
struct app {
    int unused;
};
static struct app the_app;

struct app *app_instance(void)
{
    return &the_app;
}

void app_init(struct app *app)
{
    (void)app;
}

void app_background(struct app *app)
{
    (void)app;
}

void app_clock(struct app *app, uint32_t now_ms)
{
    (void)app;
    (void)now_ms;
}

void app_tick(struct app *app)
{
    (void)app;
}

static void open_port(void)
{
    struct host_port_options options = {
        .console = console_where, .link = link_where, .nvm = nvm_path, .boot_id = 1};
    TEST_ASSERT_TRUE_MESSAGE(host_port_open(&options, err, sizeof err), err);
}

static int join(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
    TEST_ASSERT_EQUAL(0, connect(fd, (const struct sockaddr *)&address, sizeof address));
    return fd;
}

void setUp(void)
{
    (void)unlink(nvm_path);
    open_port();
}

void tearDown(void)
{
    host_port_close();
    (void)unlink(nvm_path);
}

static void flash_in_a_file_outlives_the_process_that_wrote_it(void)
{
    uint32_t word = 0xCAFEF00Du, back = 0;
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_program(64, &word, 4));
    host_port_close();
    open_port();
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_read(64, &back, 4));
    TEST_ASSERT_EQUAL_HEX32(word, back);
    TEST_ASSERT_EQUAL(ERR_IO, hal_nvm_program(64, &word, 4));
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_erase(0));
    host_port_close();
    open_port();
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_read(64, &back, 4));
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, back);
}

static void a_flash_file_of_another_size_is_refused(void)
{
    struct host_port_options options = {
        .console = console_where, .link = link_where, .nvm = nvm_path, .boot_id = 1};
    host_port_close();
    TEST_ASSERT_EQUAL(0, truncate(nvm_path, 100));
    TEST_ASSERT_FALSE(host_port_open(&options, err, sizeof err));
    TEST_ASSERT_NOT_NULL(strstr(err, nvm_path));
}

static void the_console_obeys_xoff_until_xon_or_the_next_peer(void)
{
    char heard[8] = "";
    int peer = join(console_path);
    hal_idle(true);
    TEST_ASSERT_EQUAL(1, write(peer, "\x13", 1));
    hal_idle(true);
    TEST_ASSERT_TRUE(hal_uart_write(HAL_UART_CONSOLE, "held", 4));
    TEST_ASSERT_EQUAL(0, hal_uart_pump(HAL_UART_CONSOLE)); /* nothing to be busy with */
    TEST_ASSERT_EQUAL(-1, recv(peer, heard, sizeof heard, MSG_DONTWAIT));
    TEST_ASSERT_EQUAL(1, write(peer, "\x11", 1));
    hal_idle(true);
    TEST_ASSERT_EQUAL(0, hal_uart_pump(HAL_UART_CONSOLE));
    TEST_ASSERT_EQUAL(4, recv(peer, heard, sizeof heard, MSG_DONTWAIT));
    TEST_ASSERT_EQUAL(1, write(peer, "\x13", 1));
    hal_idle(true);
    (void)close(peer);
    hal_idle(true);
    peer = join(console_path);
    hal_idle(true);
    TEST_ASSERT_TRUE(hal_uart_write(HAL_UART_CONSOLE, "next", 4));
    (void)hal_uart_pump(HAL_UART_CONSOLE);
    TEST_ASSERT_EQUAL(4, recv(peer, heard, sizeof heard, MSG_DONTWAIT));
    (void)close(peer);
}

static void the_console_asks_for_a_pause_when_its_ring_fills(void)
{
    static uint8_t much[13000];
    uint8_t byte = 0;
    int peer = join(console_path);
    hal_idle(true);
    memset(much, 'x', sizeof much);
    TEST_ASSERT_EQUAL(sizeof much, write(peer, much, sizeof much));
    for (int turn = 0; turn < 10; turn++)
        hal_idle(true);
    (void)hal_uart_pump(HAL_UART_CONSOLE);
    TEST_ASSERT_EQUAL(1, recv(peer, &byte, 1, MSG_DONTWAIT));
    TEST_ASSERT_EQUAL(0x13, byte);
    TEST_ASSERT_EQUAL(10000, hal_uart_read(HAL_UART_CONSOLE, much, 10000));
    (void)hal_uart_pump(HAL_UART_CONSOLE);
    TEST_ASSERT_EQUAL(1, recv(peer, &byte, 1, MSG_DONTWAIT));
    TEST_ASSERT_EQUAL(0x11, byte);
    (void)close(peer);
}

static void a_peer_may_leave_and_another_come(void)
{
    uint8_t byte = 0;
    TEST_ASSERT_FALSE(hal_uart_connected(HAL_UART_LINK));
    for (int round = 0; round < 3; round++) {
        int peer = join(link_path);
        hal_idle(true); /* takes the peer */
        TEST_ASSERT_TRUE(hal_uart_connected(HAL_UART_LINK));
        TEST_ASSERT_EQUAL(1, write(peer, "a", 1));
        hal_idle(true);
        TEST_ASSERT_EQUAL(1, hal_uart_read(HAL_UART_LINK, &byte, 1));
        TEST_ASSERT_TRUE(hal_uart_write(HAL_UART_LINK, "b", 1));
        TEST_ASSERT_EQUAL(0, hal_uart_pump(HAL_UART_LINK));
        TEST_ASSERT_EQUAL(1, read(peer, &byte, 1));
        TEST_ASSERT_EQUAL('b', byte);
        (void)close(peer);
        hal_idle(false);
        TEST_ASSERT_FALSE(hal_uart_connected(HAL_UART_LINK));
    }
}

static void bytes_for_nobody_are_dropped_and_do_not_pile_up(void)
{
    static uint8_t block[1000];
    for (int i = 0; i < 100; i++) {
        TEST_ASSERT_TRUE(hal_uart_write(HAL_UART_LINK, block, sizeof block));
        TEST_ASSERT_EQUAL(0, hal_uart_pump(HAL_UART_LINK));
    }
}

static void a_peer_that_does_not_read_gets_everything_later_and_blocks_nothing(void)
{
    static uint8_t block[1000];
    uint8_t back[4096];
    size_t written = 0, got = 0;
    int peer = join(link_path);
    hal_idle(true);
    while (hal_uart_write(HAL_UART_LINK, block, sizeof block) && written < 50000000u) {
        written += sizeof block;
        (void)hal_uart_pump(HAL_UART_LINK);
    }
    TEST_ASSERT_LESS_THAN(50000000u, written);
    while (got < written) {
        ssize_t n = read(peer, back, sizeof back);
        TEST_ASSERT_GREATER_THAN(0, n);
        got += (size_t)n;
        hal_idle(false);
        (void)hal_uart_pump(HAL_UART_LINK);
    }
    TEST_ASSERT_EQUAL(written, got);
    (void)close(peer);
}

static void waiting_lasts_twenty_milliseconds_at_most_also_when_a_peer_has_left(void)
{
    int peer = join(link_path);
    hal_idle(true);
    (void)close(peer);
    hal_idle(true);
    uint64_t before = hal_clock_ms();
    for (int i = 0; i < 5; i++) {
        hal_idle(true);
    }
    uint64_t took = hal_clock_ms() - before;
    TEST_ASSERT_TRUE_MESSAGE(took >= 90, "waits instead of spinning");
    TEST_ASSERT_TRUE_MESSAGE(took < 2000, "comes back");
}

static void the_clock_only_rises(void)
{
    uint64_t last = hal_clock_ms();
    for (int i = 0; i < 100000; i++) {
        uint64_t now = hal_clock_ms();
        TEST_ASSERT_TRUE(now >= last);
        last = now;
    }
}

int main(void)
{
    if (!mkdtemp(folder)) {
        return 1;
    }
    (void)snprintf(console_path, sizeof console_path, "%s/console", folder);
    (void)snprintf(link_path, sizeof link_path, "%s/link", folder);
    (void)snprintf(nvm_path, sizeof nvm_path, "%s/flash", folder);
    (void)snprintf(console_where, sizeof console_where, "socket:%s", console_path);
    (void)snprintf(link_where, sizeof link_where, "socket:%s", link_path);
    UNITY_BEGIN();
    RUN_TEST(flash_in_a_file_outlives_the_process_that_wrote_it);
    RUN_TEST(a_flash_file_of_another_size_is_refused);
    RUN_TEST(the_console_obeys_xoff_until_xon_or_the_next_peer);
    RUN_TEST(the_console_asks_for_a_pause_when_its_ring_fills);
    RUN_TEST(a_peer_may_leave_and_another_come);
    RUN_TEST(bytes_for_nobody_are_dropped_and_do_not_pile_up);
    RUN_TEST(a_peer_that_does_not_read_gets_everything_later_and_blocks_nothing);
    RUN_TEST(waiting_lasts_twenty_milliseconds_at_most_also_when_a_peer_has_left);
    RUN_TEST(the_clock_only_rises);
    int failed = UNITY_END();
    (void)rmdir(folder);
    return failed;
}
