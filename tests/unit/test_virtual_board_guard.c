/* The protection unit of the virtual STM32F405: a read through a null pointer is a fault once its region is on (PM0214 4.2, DDI 0403 B1.5.14).
 * Code is never fetched from devices (PM0214 2.2.1, unverified), and from the SRAM but not from the memory next to the core (RM0090 Rev 21 2.3.1). */
#include <string.h>

#include "chip.h"
#include "stm32_addresses.h"
#include "unity.h"

static struct board *b;

#define STORE 0x08000048u

/* movs r0, #0; ldr r0, [r0]; b . and, at STORE, str r1, [r2]; b . and, for the fault, b . */
static void start(void)
{
    static uint32_t image[0x18] = {
        [0] = 0x20001000u, [1] = 0x08000041u,    [3] = 0x08000051u, [0x10] = 0x68002000u,
        [0x11] = 0xE7FEu,  [0x12] = 0xE7FE6011u, [0x14] = 0xE7FEu};
    const struct surroundings around = {.crystal_hz = 8000000,
                                        .slow_clock_hz = 32000,
                                        .supply_mv = 3300,
                                        .baud = 115200,
                                        .seed = 1};
    char err[200] = "";
    b = board_new(&chip_stm32f405, &around, (const uint8_t *)image, sizeof image, true, err,
                  sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(b, err);
    board_power_on(b);
}

void setUp(void)
{
    start();
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
    board_free(b);
}

static void test_without_it_the_flash_is_read_there(void)
{
    board_run(b, 100000);
    TEST_ASSERT_EQUAL_HEX32(0, bus_read(b, SCB_CFSR, 4));
}

static void test_with_it_the_read_is_a_fault_that_names_the_address(void)
{
    bus_write(b, MPU_RNR, 4, 0);
    bus_write(b, MPU_RBAR, 4, 0);
    bus_write(b, MPU_RASR, 4, MPU_RASR_XN | MPU_RASR_AP_NONE | MPU_RASR_SIZE(20) | MPU_RASR_ENABLE);
    bus_write(b, MPU_CTRL, 4, MPU_CTRL_ENABLE | MPU_CTRL_PRIVDEFENA);
    board_run(b, 100000);
    TEST_ASSERT_EQUAL_HEX32(SCB_CFSR_MMARVALID | 2u, bus_read(b, SCB_CFSR, 4)); /* DACCVIOL */
    TEST_ASSERT_EQUAL_HEX32(0, bus_read(b, SCB_MMFAR, 4));
    TEST_ASSERT_EQUAL_HEX32(0x08000050u, processor_pc(b));
}

static void test_nothing_is_fetched_from_where_devices_are(void)
{
    board_run(b, 100000);
    processor_set_register(b, REGISTER_PC, 0xA0000000u);
    board_run(b, 200000);
    TEST_ASSERT_EQUAL_HEX32(1u, bus_read(b, SCB_CFSR, 4)); /* IACCVIOL */
    TEST_ASSERT_EQUAL_HEX32(0x08000050u, processor_pc(b));
}

/* Stores nop; b . at an address, and jumps there. */
static void run_stored_code(uint32_t address)
{
    board_run(b, 100000);
    processor_set_register(b, 1, 0xE7FEBF00u);
    processor_set_register(b, 2, address);
    processor_set_register(b, REGISTER_PC, STORE);
    board_run(b, 200000);
    TEST_ASSERT_EQUAL_HEX32(STORE + 2, processor_pc(b));
    processor_set_register(b, REGISTER_PC, address);
    board_run(b, 300000);
}

static void test_code_that_was_stored_in_the_sram_runs_across_its_pages(void)
{
    run_stored_code(0x20008FFEu);
    TEST_ASSERT_EQUAL_HEX32(0x20009000u, processor_pc(b));
    TEST_ASSERT_EQUAL_HEX32(0, bus_read(b, SCB_CFSR, 4));
}

static void test_a_jump_to_the_memory_next_to_the_core_is_a_verdict(void)
{
    run_stored_code(0x10008000u);
    const char expected[] = "jump to 0x10008000, which is memory for data, at";
    TEST_ASSERT_EQUAL_STRING_LEN(expected, b->verdict, sizeof(expected) - 1);
    b->verdict[0] = '\0';
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_without_it_the_flash_is_read_there);
    RUN_TEST(test_with_it_the_read_is_a_fault_that_names_the_address);
    RUN_TEST(test_nothing_is_fetched_from_where_devices_are);
    RUN_TEST(test_code_that_was_stored_in_the_sram_runs_across_its_pages);
    RUN_TEST(test_a_jump_to_the_memory_next_to_the_core_is_a_verdict);
    return UNITY_END();
}
