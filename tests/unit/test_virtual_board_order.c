/* Orders of writes that the models of the virtual STM32F405 insist on, asked of them register by register. */
#include <string.h>

#include "models/stored_flash.h"
#include "stm32_addresses.h"
#include "unity.h"

static struct board *b;

static void put(uint32_t address, uint32_t word)
{
    bus_write(b, address, 4, word);
}

static void expect_verdict(const char *words)
{
    if (strstr(b->verdict, words) == NULL)
        TEST_FAIL_MESSAGE(b->verdict[0] != '\0' ? b->verdict : words);
    b->verdict[0] = '\0';
}

void setUp(void)
{
    static const uint8_t image[8] = {0, 0x20, 0, 0x20, 0x09, 0, 0, 0x08};
    const struct surroundings around = {
        .slow_clock_hz = 32000, .supply_mv = 3300, .baud = 115200, .seed = 1};
    char err[200] = "";
    b = board_new(&chip_stm32f405, &around, image, sizeof image, false, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(b, err);
    board_power_on(b);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
    board_free(b);
}

/* PM0214 4.5.5: reload, clear, start. */
static void test_systick_is_cleared_before_it_starts(void)
{
    put(SYST_RVR, 999);
    put(SYST_CSR, SYST_CSR_ENABLE | SYST_CSR_CLKSOURCE);
    expect_verdict("SysTick started without a write of SYST_CVR before");
    put(SYST_CSR, 0);
    put(SYST_CVR, 0);
    put(SYST_CSR, SYST_CSR_ENABLE | SYST_CSR_CLKSOURCE);
    TEST_ASSERT_EQUAL(1000, bus_read(b, SYST_CVR, 4));
}

static void write_word(uint32_t at, uint32_t word)
{
    put(FLASH_KEYR, FLASH_KEY1);
    put(FLASH_KEYR, FLASH_KEY2);
    put(FLASH_CR, FLASH_CR_PSIZE32 | FLASH_CR_PG);
    b->chip->store(b, at, 4, word);
    b->cycles = board_cycles_at(b, board_ns(b) + 100000);
    board_run_events(b);
    put(FLASH_CR, FLASH_CR_LOCK);
}

/* RM0090 3.5.2 and 3.9.1: a write leaves the cache of data as it was; it is emptied while it is off. */
static void test_after_a_write_the_cache_of_data_is_emptied(void)
{
    put(FLASH_ACR, FLASH_ACR_DCEN);
    (void)stored_flash_read(b, 0, 4);
    write_word(0, 0x12345678u);
    (void)stored_flash_read(b, 0, 4);
    expect_verdict("through a cache that holds what was there before");
    put(FLASH_ACR, 0);
    TEST_ASSERT_EQUAL_HEX32(0x12345678u, stored_flash_read(b, 0, 4));
    put(FLASH_ACR, FLASH_ACR_DCEN);
    (void)stored_flash_read(b, 0, 4);
    expect_verdict("through a cache that holds what was there before");
    put(FLASH_ACR, 0);
    put(FLASH_ACR, FLASH_ACR_DCRST);
    put(FLASH_ACR, FLASH_ACR_DCEN);
    TEST_ASSERT_EQUAL_HEX32(0x12345678u, stored_flash_read(b, 0, 4));
    put(FLASH_ACR, FLASH_ACR_DCEN | FLASH_ACR_DCRST);
    expect_verdict("cache of the flash emptied while it is on");
}

static void test_core_coupled_memory_keeps_its_clock(void)
{
    put(RCC_AHB1ENR, RCC_AHB1ENR_CCM | RCC_AHB1ENR_GPIOA);
    put(RCC_AHB1ENR, RCC_AHB1ENR_GPIOA);
    expect_verdict("core-coupled memory without its clock");
}

/* RM0090 21.4: five periods of the slow clock. */
static void test_a_value_of_the_watchdog_is_read_once_it_has_arrived(void)
{
    put(IWDG_KR, IWDG_KR_ACCESS);
    put(IWDG_RLR, 100);
    (void)bus_read(b, IWDG_RLR, 4);
    expect_verdict("read of IWDG_RLR while a value is on its way");
    (void)bus_read(b, IWDG_PR, 4);
    b->cycles = board_cycles_at(b, board_ns(b) + 200000);
    board_run_events(b);
    TEST_ASSERT_EQUAL(100, bus_read(b, IWDG_RLR, 4));
}

/* RM0090 19.5.5 */
static void test_the_input_of_a_channel_is_chosen_while_it_is_off(void)
{
    put(RCC_APB2ENR, RCC_APB2ENR_TIM11);
    put(TIM11_CCMR1, TIM11_CCMR1_TI1_8);
    put(TIM11_CCER, TIM11_CCER_CC1E);
    put(TIM11_CCMR1, 0);
    expect_verdict("TIM11_CCMR1 chooses an input while the channel is on");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_systick_is_cleared_before_it_starts);
    RUN_TEST(test_after_a_write_the_cache_of_data_is_emptied);
    RUN_TEST(test_a_value_of_the_watchdog_is_read_once_it_has_arrived);
    RUN_TEST(test_the_input_of_a_channel_is_chosen_while_it_is_off);
    RUN_TEST(test_core_coupled_memory_keeps_its_clock);
    return UNITY_END();
}
