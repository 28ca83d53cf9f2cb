/* The memory port and the flash model: the contract of hal/uart.h, hal/clock.h, hal/nvm.h and hal/workspace.h. */
#include <string.h>

#include "app/app.h"
#include "base/workspace.h"
#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/nvm.h"
#include "hal/tick.h"
#include "hal/uart.h"
#include "hal/workspace.h"
#include "memory_port.h"
#include "unity.h"

/* A firmware that sends back what arrives on the link and restarts when the console says 'R'. */
struct app {
    unsigned starts, ticks;
};
static struct app the_app;

struct app *app_instance(void)
{
    return &the_app;
}

void app_init(struct app *app)
{
    app->starts++;
}

void app_background(struct app *app)
{
    uint8_t byte;
    (void)app;
    while (hal_uart_read(HAL_UART_CONSOLE, &byte, 1) == 1) {
        if (byte == 'R') {
            hal_reboot();
        }
    }
}

void app_clock(struct app *app, uint32_t now_ms)
{
    (void)app;
    (void)now_ms;
}

void app_tick(struct app *app)
{
    uint8_t bytes[64];
    size_t n;
    app->ticks++;
    while ((n = hal_uart_read(HAL_UART_LINK, bytes, sizeof bytes)) > 0) {
        (void)hal_uart_write(HAL_UART_LINK, bytes, n);
    }
}

void setUp(void)
{
    memset(&the_app, 0, sizeof the_app);
    memory_port_erase_all();
    memory_port_start();
    (void)memory_port_run(); /* the first tick, asked for at power-on */
}

void tearDown(void) {}

static void bytes_given_to_the_link_come_back_in_order(void)
{
    uint8_t out[5000], in[5000];
    for (size_t i = 0; i < sizeof out; i++) {
        out[i] = (uint8_t)(i * 7u);
    }
    TEST_ASSERT_EQUAL(sizeof out, memory_port_give(HAL_UART_LINK, out, sizeof out));
    (void)memory_port_run();
    TEST_ASSERT_EQUAL(sizeof in, memory_port_take(HAL_UART_LINK, in, sizeof in));
    TEST_ASSERT_EQUAL_MEMORY(out, in, sizeof in);
    TEST_ASSERT_EQUAL(0, memory_port_take(HAL_UART_LINK, in, 1));
}

static void bytes_beyond_a_full_receive_ring_are_dropped_and_counted(void)
{
    static uint8_t flood[40000];
    struct hal_uart_stats stats;
    size_t taken = memory_port_give(HAL_UART_CONSOLE, flood, sizeof flood);
    TEST_ASSERT_LESS_THAN(sizeof flood, taken);
    TEST_ASSERT_EQUAL(0, memory_port_give(HAL_UART_CONSOLE, flood, 1));
    hal_uart_get_stats(HAL_UART_CONSOLE, &stats);
    TEST_ASSERT_EQUAL(sizeof flood + 1 - taken, stats.rx_dropped);
    TEST_ASSERT_EQUAL(sizeof flood + 1, stats.received);
}

static void a_write_is_taken_whole_or_not_at_all(void)
{
    static uint8_t block[20000];
    size_t room = hal_uart_room(HAL_UART_CONSOLE);
    TEST_ASSERT_TRUE(room < sizeof block);
    TEST_ASSERT_FALSE(hal_uart_write(HAL_UART_CONSOLE, block, room + 1));
    TEST_ASSERT_EQUAL(room, hal_uart_room(HAL_UART_CONSOLE));
    TEST_ASSERT_TRUE(hal_uart_write(HAL_UART_CONSOLE, block, room));
    TEST_ASSERT_EQUAL(0, hal_uart_room(HAL_UART_CONSOLE));
    TEST_ASSERT_TRUE(hal_uart_write(HAL_UART_CONSOLE, block, 0));
    TEST_ASSERT_FALSE(hal_uart_write(HAL_UART_CONSOLE, block, 1));
}

static void the_clock_never_goes_back(void)
{
    memory_port_set_clock(1000);
    memory_port_set_clock(400);
    TEST_ASSERT_EQUAL_UINT64(1000, hal_clock_ms());
    memory_port_jump(UINT64_C(0xFFFFFFFF));
    memory_port_set_clock(UINT64_C(0x100000001));
    TEST_ASSERT_EQUAL_UINT64(UINT64_C(0x100000001), hal_clock_ms());
}

static void the_tick_comes_with_the_clock_and_with_the_link_and_not_else(void)
{
    unsigned before = the_app.ticks;
    (void)memory_port_run();
    TEST_ASSERT_EQUAL(before, the_app.ticks);
    memory_port_set_clock(hal_clock_ms() + HAL_TICK_PERIOD_MS - 1);
    (void)memory_port_run();
    TEST_ASSERT_EQUAL(before, the_app.ticks);
    memory_port_set_clock(hal_clock_ms() + 1);
    (void)memory_port_run();
    TEST_ASSERT_EQUAL(before + 1, the_app.ticks);
    (void)memory_port_give(HAL_UART_LINK, "x", 1);
    (void)memory_port_run();
    TEST_ASSERT_EQUAL(before + 2, the_app.ticks);
}

static void a_reboot_starts_the_firmware_again_with_its_flash_and_another_boot_id(void)
{
    uint32_t id = hal_boot_id(), word = 0x12345678u, back = 0;
    TEST_ASSERT_EQUAL(HAL_RESET_POWER_ON, hal_reset_cause());
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_program(0, &word, 4));
    (void)memory_port_give(HAL_UART_CONSOLE, "R", 1);
    (void)memory_port_run();
    TEST_ASSERT_EQUAL(1, memory_port_reboots());
    TEST_ASSERT_EQUAL(2, the_app.starts);
    TEST_ASSERT_EQUAL(HAL_RESET_REQUESTED, hal_reset_cause());
    TEST_ASSERT_NOT_EQUAL(id, hal_boot_id());
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_read(0, &back, 4));
    TEST_ASSERT_EQUAL_HEX32(word, back);
}

static void flash_is_programmed_once_after_each_erase(void)
{
    struct hal_nvm_geometry g;
    uint32_t word = 0xA5A5F00Fu, other = 0xA5A5F00Eu, zeros = 0, back = 0;
    hal_nvm_get_geometry(&g);
    uint32_t at = g.sector_size + 8;
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_program(at, &word, 4));
    /* Clearing more bits is refused too: not every flash can. */
    TEST_ASSERT_EQUAL(ERR_IO, hal_nvm_program(at, &other, 4));
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_read(at, &back, 4));
    TEST_ASSERT_EQUAL_HEX32(word, back);
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_erase(1));
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_read(at, &back, 4));
    TEST_ASSERT_EQUAL_HEX32(UINT32_MAX, back);
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_program(at, &other, 4));
    /* But for zeros, which go over anything. */
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_program(at, &zeros, 4));
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_read(at, &back, 4));
    TEST_ASSERT_EQUAL_HEX32(zeros, back);
}

static void an_erase_leaves_the_other_sector_alone(void)
{
    uint32_t word = 7, back = 0;
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_program(0, &word, 4));
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_erase(1));
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_read(0, &back, 4));
    TEST_ASSERT_EQUAL(word, back);
}

static void flash_refuses_what_lies_outside_or_across_its_units(void)
{
    struct hal_nvm_geometry g;
    uint8_t bytes[8] = {0};
    hal_nvm_get_geometry(&g);
    uint32_t end = g.sectors * g.sector_size;
    TEST_ASSERT_EQUAL(ERR_RANGE, hal_nvm_read(end - 3, bytes, 4));
    TEST_ASSERT_EQUAL(ERR_RANGE, hal_nvm_read(4, bytes, UINT32_MAX - 2)); /* a sum that wraps */
    TEST_ASSERT_EQUAL(ERR_OK, hal_nvm_read(end - 4, bytes, 4));
    TEST_ASSERT_EQUAL(ERR_RANGE, hal_nvm_program(end, bytes, 4));
    TEST_ASSERT_EQUAL(ERR_RANGE, hal_nvm_program(2, bytes, 4));
    TEST_ASSERT_EQUAL(ERR_RANGE, hal_nvm_program(0, bytes, 6));
    TEST_ASSERT_EQUAL(ERR_RANGE, hal_nvm_erase(g.sectors));
}

static void the_workspace_is_cleared_at_every_start(void)
{
    uint8_t *memory = hal_workspace();
    TEST_ASSERT_EQUAL_UINT(0, (uintptr_t)memory % _Alignof(max_align_t));
    for (uint8_t *at = memory; at < memory + WORKSPACE_BYTES; at++)
        *at = 0xA5;
    TEST_ASSERT_EQUAL_PTR(memory, hal_workspace());
    for (const uint8_t *at = memory; at < memory + WORKSPACE_BYTES; at++)
        TEST_ASSERT_EQUAL_UINT8(0, *at);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(bytes_given_to_the_link_come_back_in_order);
    RUN_TEST(bytes_beyond_a_full_receive_ring_are_dropped_and_counted);
    RUN_TEST(a_write_is_taken_whole_or_not_at_all);
    RUN_TEST(the_clock_never_goes_back);
    RUN_TEST(the_tick_comes_with_the_clock_and_with_the_link_and_not_else);
    RUN_TEST(a_reboot_starts_the_firmware_again_with_its_flash_and_another_boot_id);
    RUN_TEST(flash_is_programmed_once_after_each_erase);
    RUN_TEST(an_erase_leaves_the_other_sector_alone);
    RUN_TEST(the_workspace_is_cleared_at_every_start);
    RUN_TEST(flash_refuses_what_lies_outside_or_across_its_units);
    return UNITY_END();
}
