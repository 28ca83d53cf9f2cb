/* Rules about memory barriers that the virtual board checks in its exact mode (host_sim/virtual_board/barrier_rules.h): each with code that
 * keeps it and with code that does not. */
#include <string.h>

#include "chip.h"
#include "models/models.h"
#include "stm32_addresses.h"
#include "unity.h"

#define NOP           0xBF00u
#define WFI           0xBF30u
#define BARRIER       0xF3BFu
#define DSB           BARRIER, 0x8F4Fu
#define DMB           BARRIER, 0x8F5Fu
#define ISB           BARRIER, 0x8F6Fu
#define WRITE_FIRST   0x6008u      /* str r0, [r1] */
#define READ_FIRST    0x680Bu      /* ldr r3, [r1] */
#define WRITE_SECOND  0x6010u      /* str r0, [r2] */
#define READ_SECOND   0x6813u      /* ldr r3, [r2] */
#define JUMP          0xE000u, NOP /* over one halfword */
#define STORED        0x080C0000u
#define CODE_MOST     20u
#define PROGRAM_BYTES 0x80u

static const char *run(uint32_t word, uint32_t first, uint32_t second, const uint16_t *code,
                       size_t n, bool exact)
{
    static char verdict[BOARD_VERDICT];
    /* 0x40: ldr r0, word; ldr r1, first; ldr r2, second; the code; b . */
    uint16_t image[PROGRAM_BYTES / 2] = {[0x20] = 0x480Bu, 0x490Cu, 0x4A0Cu};
    const uint32_t head[4] = {0x20001000u, 0x08000041u, 0, 0x08000041u};
    const uint32_t literals[] = {word, first, second};
    const struct surroundings around = {
        .slow_clock_hz = 32000, .supply_mv = 3300, .baud = 115200, .seed = 1};
    char err[200] = "";
    TEST_ASSERT_TRUE(n < CODE_MOST);
    memcpy(image, head, sizeof head);
    memcpy(image + 0x23, code, n * sizeof *code);
    image[0x23 + n] = 0xE7FEu;
    memcpy(image + 0x38, literals, sizeof literals);
    struct board *b = board_new(&chip_stm32f405, &around, (const uint8_t *)image, sizeof image,
                                exact, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(b, err);
    board_power_on(b);
    stored_flash(b)->open = true; /* stores come to the model */
    board_run(b, 100000);
    memcpy(verdict, b->verdict, sizeof verdict);
    board_free(b);
    return verdict;
}

#define KEEPS(word, first, second, ...)                                                            \
    do {                                                                                           \
        static const uint16_t code[] = {__VA_ARGS__};                                              \
        TEST_ASSERT_EQUAL_STRING("", run(word, first, second, code, sizeof code / 2, true));       \
    } while (0)

/* In exact mode; without it nothing is checked. */
#define BREAKS(words, word, first, second, ...)                                                    \
    do {                                                                                           \
        static const uint16_t code[] = {__VA_ARGS__};                                              \
        const char *said = run(word, first, second, code, sizeof code / 2, true);                  \
        if (strncmp(said, words, strlen(words)) != 0)                                              \
            TEST_FAIL_MESSAGE(said[0] != '\0' ? said : words);                                     \
        TEST_ASSERT_EQUAL_STRING("", run(word, first, second, code, sizeof code / 2, false));      \
    } while (0)

void setUp(void) {}

void tearDown(void) {}

static void test_the_protection_unit_wants_dsb_and_isb_before_a_jump(void)
{
    KEEPS(0, MPU_CTRL, 0, WRITE_FIRST, DSB, ISB, JUMP);
    KEEPS(0, MPU_RBAR, MPU_CTRL, WRITE_FIRST, WRITE_SECOND, NOP, DSB, NOP, ISB, JUMP);
    BREAKS("jump after a write of the protection unit without DSB", 0, MPU_CTRL, 0, WRITE_FIRST,
           ISB, JUMP);
    BREAKS("jump after a write of the protection unit without ISB", 0, MPU_RASR, 0, WRITE_FIRST,
           DSB, JUMP);
    BREAKS("jump after a write of the protection unit without ISB", 0, MPU_RBAR, 0, WRITE_FIRST,
           ISB, DSB, JUMP);
    BREAKS("jump after a write of the protection unit without DSB", 0, MPU_RBAR, MPU_CTRL,
           WRITE_FIRST, DSB, WRITE_SECOND, ISB, JUMP);
}

static void test_the_floating_point_unit_wants_dsb_and_isb_before_a_jump(void)
{
    KEEPS(SCB_CPACR_FPU, SCB_CPACR, 0, WRITE_FIRST, DSB, ISB, JUMP);
    BREAKS("jump after a write of CPACR without DSB", SCB_CPACR_FPU, SCB_CPACR, 0, WRITE_FIRST, ISB,
           JUMP);
    BREAKS("jump after a write of CPACR without ISB", SCB_CPACR_FPU, SCB_CPACR, 0, WRITE_FIRST, DSB,
           JUMP);
}

static void test_the_vector_table_wants_dsb_before_a_jump(void)
{
    KEEPS(0x08000000u, SCB_VTOR, 0, WRITE_FIRST, DSB, JUMP);
    BREAKS("jump after a write of VTOR without DSB", 0x08000000u, SCB_VTOR, 0, WRITE_FIRST, ISB,
           DMB, JUMP);
}

static void test_sleep_wants_dsb_right_before_it(void)
{
    KEEPS(0, 0, 0, DSB, WFI);
    BREAKS("WFI without DSB before it", 0, 0, 0, NOP, WFI);
    BREAKS("WFI without DSB before it", 0, 0, 0, DSB, NOP, WFI);
}

static void test_a_reset_stands_between_two_dsb(void)
{
    KEEPS(SCB_AIRCR_RESET, SCB_AIRCR, 0, DSB, WRITE_FIRST, DSB);
    KEEPS(0x05FA0000u, SCB_AIRCR, 0, WRITE_FIRST); /* asks for none */
    KEEPS(4, SCB_AIRCR, 0, WRITE_FIRST);           /* has no key */
    BREAKS("reset by AIRCR without DSB before it", SCB_AIRCR_RESET, SCB_AIRCR, 0, WRITE_FIRST, DSB);
    BREAKS("reset by AIRCR without DSB before it", SCB_AIRCR_RESET, SCB_AIRCR, 0, DSB, JUMP,
           WRITE_FIRST, DSB);
    BREAKS("no DSB after a reset by AIRCR", SCB_AIRCR_RESET, SCB_AIRCR, 0, DSB, WRITE_FIRST, NOP);
}

static void test_flash_and_registers_want_a_barrier_between_them(void)
{
    KEEPS(0, STORED, FLASH_SR, WRITE_FIRST, DSB, READ_SECOND);
    KEEPS(0, STORED, FLASH_SR, WRITE_FIRST, DMB, READ_SECOND);
    KEEPS(0, STORED, SCB_VTOR, WRITE_FIRST, READ_SECOND); /* of the core itself */
    BREAKS("read of a register after a store into the flash", 0, STORED, FLASH_SR, WRITE_FIRST, ISB,
           READ_SECOND);
    KEEPS(0, STORED, FLASH_CR, WRITE_SECOND, DMB, WRITE_FIRST);
    BREAKS("store into the flash after a write of FLASH_CR", 0, STORED, FLASH_CR, WRITE_SECOND,
           WRITE_FIRST);
    KEEPS(0, STORED, FLASH_ACR, WRITE_SECOND, DSB, READ_FIRST);
    KEEPS(0, STORED, FLASH_ACR, READ_FIRST, WRITE_SECOND);
    KEEPS(FLASH_ACR_DCEN, STORED, FLASH_ACR, WRITE_SECOND, READ_FIRST);
    BREAKS("read of the flash after its cache was turned off", 0, STORED, FLASH_ACR, WRITE_SECOND,
           READ_FIRST);
}

/* ES0182: a clock takes a while to arrive. */
static void test_a_part_is_reached_some_time_after_its_clock_was_turned_on(void)
{
    const uint32_t on = RCC_AHB1ENR_CCM | RCC_AHB1ENR_GPIOA;
    KEEPS(on, RCC_AHB1ENR, GPIOA_MODER, WRITE_FIRST, READ_FIRST, READ_SECOND);
    KEEPS(on, RCC_AHB1ENR, GPIOA_MODER, WRITE_FIRST, DSB, READ_SECOND);
    KEEPS(on, RCC_AHB1ENR, FLASH_SR, WRITE_FIRST, READ_SECOND);
    KEEPS(on, RCC_AHB1ENR, GPIOA_MODER, WRITE_FIRST, DSB, WRITE_FIRST, READ_SECOND); /* it was on */
    BREAKS("access to GPIOA right after its clock was turned on", on, RCC_AHB1ENR, GPIOA_MODER,
           WRITE_FIRST, NOP, READ_SECOND);
    BREAKS("access to GPIOA right after its clock was turned on", on, RCC_AHB1ENR, GPIOA_AFRL,
           WRITE_FIRST, WRITE_SECOND);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_protection_unit_wants_dsb_and_isb_before_a_jump);
    RUN_TEST(test_the_floating_point_unit_wants_dsb_and_isb_before_a_jump);
    RUN_TEST(test_the_vector_table_wants_dsb_before_a_jump);
    RUN_TEST(test_sleep_wants_dsb_right_before_it);
    RUN_TEST(test_a_reset_stands_between_two_dsb);
    RUN_TEST(test_flash_and_registers_want_a_barrier_between_them);
    RUN_TEST(test_a_part_is_reached_some_time_after_its_clock_was_turned_on);
    return UNITY_END();
}
