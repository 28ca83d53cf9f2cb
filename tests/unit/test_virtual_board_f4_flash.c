/* What the flash interface of the virtual STM32F405 stands for. Sections are those of RM0090 Rev 21. */
#include "board_registers.h"

#define FLASH_OPTKEYR  (FLASH_KEYR + 4u)
#define FLASH_CR_MER   BIT(2)
#define FLASH_CR_ERRIE BIT(25)
#define PGSERR         BIT(7)
#define PGPERR         BIT(6)
#define PGAERR         BIT(5)
#define WRPERR         BIT(4)
#define PLACE          0x1234u /* in sector 10 */
#define SECTOR_11      0x20000u
#define WORD_NS        16000u
#define SECOND         UINT64_C(1000000000)

static void start_with(const struct surroundings *around)
{
    start_board(&chip_stm32f405, around, empty_image, sizeof empty_image);
}

void setUp(void)
{
    const struct surroundings around = usual(&chip_stm32f405, 8000000);
    start_with(&around);
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
}

static void unlock(void)
{
    put_ok(FLASH_KEYR, FLASH_KEY1);
    put_ok(FLASH_KEYR, FLASH_KEY2);
    TEST_ASSERT_EQUAL(0, get(FLASH_CR) & FLASH_CR_LOCK);
}

static void store(uint32_t at, uint32_t word)
{
    b->chip->store(b, at, 4, word);
    TEST_ASSERT_EQUAL_STRING("", b->verdict);
    pass(WORD_NS);
}

static uint32_t errors(void)
{
    uint32_t found = get(FLASH_SR) & FLASH_SR_ERRORS;
    put_ok(FLASH_SR, found); /* 3.9.5: ones clear */
    TEST_ASSERT_EQUAL(0, get(FLASH_SR));
    return found;
}

/* 3.6.1 */
static void test_keys_open_the_flash_and_a_wrong_one_locks_it(void)
{
    put_ok(FLASH_CR, FLASH_CR_PG);
    TEST_ASSERT_EQUAL_HEX32(FLASH_CR_LOCK, get(FLASH_CR));
    unlock();
    put_ok(FLASH_CR, FLASH_CR_LOCK);
    TEST_ASSERT_EQUAL_HEX32(FLASH_CR_LOCK, get(FLASH_CR));
    put(FLASH_KEYR, FLASH_KEY2);
    expect_verdict("wrong key 0xcdef89ab");
    put(FLASH_KEYR, FLASH_KEY1);
    expect_verdict("wrong key"); /* until a reset */
    restart(RESET_SOFTWARE);
    unlock();
    bus_write(b, FLASH_KEYR, 2, 0x0123u);
    expect_verdict("FLASH_KEYR (0x40023c04), which takes no such width");
    put(FLASH_OPTKEYR, 0x08192A3Bu);
    expect_verdict("write of the option bytes");
}

/* 3.6, 3.6.4: ones fall to zeros; while the flash is busy nothing reads it. */
static void test_a_word_takes_its_time_and_the_core_stands_still(void)
{
    unlock();
    put_ok(FLASH_CR, FLASH_CR_PG | FLASH_CR_PSIZE32);
    uint64_t from = board_ns(b);
    b->chip->store(b, PLACE, 4, 0x12345678u);
    TEST_ASSERT_EQUAL_HEX32(FLASH_SR_BSY, get(FLASH_SR));
    TEST_ASSERT_EQUAL(from + WORD_NS, b->stalled_until_ns);
    b->chip->store(b, PLACE + 4u, 4, 0);
    expect_verdict("while it is busy");
    put(FLASH_CR, 0);
    expect_verdict("write of FLASH_CR while the flash is busy");
    pass(WORD_NS);
    TEST_ASSERT_EQUAL_HEX32(0, get(FLASH_SR)); /* EOP is for those with EOPIE */
    store(PLACE, 0xFFFF0FFFu);
    TEST_ASSERT_EQUAL_HEX32(0x12340678u, stored_flash_read(b, PLACE, 4));
    put(FLASH_CR, FLASH_CR_ERRIE);
    expect_verdict("interrupts of the flash are not modelled");
}

/* 3.6.4, 3.9.5 */
static void test_each_error_has_its_flag_and_writes_nothing(void)
{
    store(PLACE, 0);
    TEST_ASSERT_EQUAL_HEX32(PGSERR, errors()); /* locked */
    unlock();
    store(PLACE, 0);
    TEST_ASSERT_EQUAL_HEX32(PGSERR, errors()); /* PG is off */
    put_ok(FLASH_CR, FLASH_CR_PG);
    store(PLACE, 0);
    TEST_ASSERT_EQUAL_HEX32(PGPERR, errors()); /* by bytes */
    put_ok(FLASH_CR, FLASH_CR_PG | FLASH_CR_PSIZE32);
    store(0x100Eu, 0);
    TEST_ASSERT_EQUAL_HEX32(PGAERR, errors()); /* over the end of a row of 16 bytes */
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFFFFu, stored_flash_read(b, PLACE, 4));
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFFFFu, stored_flash_read(b, 0x100Eu, 4));
    store(0x100Cu, 0);
    TEST_ASSERT_EQUAL(0, errors());
}

static void start_erase(uint32_t sector)
{
    put(FLASH_CR, FLASH_CR_SER | FLASH_CR_SNB(sector));
    put(FLASH_CR, FLASH_CR_SER | FLASH_CR_SNB(sector) | FLASH_CR_STRT);
}

/* 3.6.3 */
static void test_an_erase_takes_one_sector(void)
{
    unlock();
    put_ok(FLASH_CR, FLASH_CR_PG | FLASH_CR_PSIZE32);
    store(SECTOR_11 - 4u, 0x11111111u);
    store(SECTOR_11, 0x22222222u);
    start_erase(11);
    pass(SECOND - 1000000u);
    TEST_ASSERT_EQUAL_HEX32(FLASH_SR_BSY, get(FLASH_SR));
    pass(1000000u);
    TEST_ASSERT_EQUAL_HEX32(0, get(FLASH_SR));
    TEST_ASSERT_EQUAL(0, get(FLASH_CR) & FLASH_CR_STRT);
    TEST_ASSERT_EQUAL_HEX32(0x11111111u, stored_flash_read(b, SECTOR_11 - 4u, 4));
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFFFFu, stored_flash_read(b, SECTOR_11, 4));
    put(FLASH_CR, FLASH_CR_STRT);
    expect_verdict("which is not the erase of a sector alone");
    put(FLASH_CR, FLASH_CR_PG | FLASH_CR_SER | FLASH_CR_STRT | FLASH_CR_SNB(11));
    expect_verdict("which is not the erase of a sector alone");
    start_erase(9);
    expect_verdict("erase of sector 9 of the flash, which holds the program");
    put(FLASH_CR, FLASH_CR_MER);
    expect_verdict("mass erase");
}

/* 3.6: what a reset interrupts is not guaranteed */
static void test_a_reset_within_an_erase_leaves_weak_bits(void)
{
    unlock();
    put_ok(FLASH_CR, FLASH_CR_PG | FLASH_CR_PSIZE32);
    store(SECTOR_11, 0);
    start_erase(11);
    pass(SECOND / 2u);
    restart(RESET_PIN);
    uint32_t first = stored_flash_read(b, SECTOR_11, 4), differ = 0;
    for (unsigned i = 0; i < 100; i++)
        differ |= first ^ stored_flash_read(b, SECTOR_11, 4);
    TEST_ASSERT_NOT_EQUAL(0, differ);
}

/* 3.6.2: x32 from 2.7 V on */
static void test_words_need_their_supply(void)
{
    unlock();
    put_ok(FLASH_CR, FLASH_CR_PG | FLASH_CR_PSIZE32);
    b->around.supply_mv = 2699;
    b->chip->store(b, PLACE, 4, 0);
    expect_verdict("at 2699 mV; 2700 are needed");
    pass(WORD_NS);
    start_erase(10);
    expect_verdict("erased by words at 2699 mV");
}

/* 3.7.1, 3.9.9 */
static void test_option_bytes(void)
{
    TEST_ASSERT_EQUAL_HEX32(0x0FFFAAEDu, get(FLASH_OPTCR));
    struct surroundings around = usual(&chip_stm32f405, 8000000);
    around.brown_out_mv = 2830;
    around.hardware_watchdog = true;
    around.write_protect = 1u << 11 | 1u;
    start_with(&around);
    TEST_ASSERT_EQUAL_HEX32(0x07FEAAC1u, get(FLASH_OPTCR));
    unlock();
    put_ok(FLASH_CR, FLASH_CR_PG | FLASH_CR_PSIZE32);
    store(SECTOR_11, 0);
    TEST_ASSERT_EQUAL_HEX32(WRPERR, errors());
    start_erase(11);
    TEST_ASSERT_EQUAL_HEX32(WRPERR, errors());
    TEST_ASSERT_EQUAL_HEX32(0xFFFFFFFFu, stored_flash_read(b, SECTOR_11, 4));
    put_ok(FLASH_CR, FLASH_CR_PG | FLASH_CR_PSIZE32);
    store(SECTOR_11 - 4u, 0);
    TEST_ASSERT_EQUAL(0, errors());
    put(FLASH_OPTCR, 0x0FFFAAEDu);
    expect_verdict("write of the option bytes");
}

/* 3.9.1 */
static void test_a_cache_is_emptied_while_it_is_off(void)
{
    put_ok(FLASH_ACR, FLASH_ACR_ICRST | FLASH_ACR_DCRST);
    put_ok(FLASH_ACR, FLASH_ACR_ICEN);
    put_ok(FLASH_ACR, FLASH_ACR_ICEN | FLASH_ACR_DCRST);
    put(FLASH_ACR, FLASH_ACR_ICEN | FLASH_ACR_ICRST);
    expect_verdict("cache of the flash emptied while it is on");
}

/* The processor library then reads the bytes without the model. */
static void test_what_is_stored_is_plain_memory_while_a_read_has_no_other_effect(void)
{
    TEST_ASSERT_EQUAL_PTR(stored_flash(b)->bytes, stored_flash_plain(b));
    unlock();
    TEST_ASSERT_NULL(stored_flash_plain(b));
    put_ok(FLASH_CR, FLASH_CR_PG | FLASH_CR_PSIZE32);
    store(PLACE, 0);
    put_ok(FLASH_CR, FLASH_CR_LOCK);
    TEST_ASSERT_NULL(stored_flash_plain(b)); /* the cache is old */
    put_ok(FLASH_ACR, FLASH_ACR_DCRST);
    TEST_ASSERT_NOT_NULL(stored_flash_plain(b));
    unlock();
    put_ok(FLASH_CR, FLASH_CR_PG | FLASH_CR_PSIZE32);
    b->chip->store(b, PLACE + 4u, 4, 0);
    restart(RESET_PIN); /* within the word */
    TEST_ASSERT_NULL(stored_flash_plain(b));
    b->verdict[0] = '\0';
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_keys_open_the_flash_and_a_wrong_one_locks_it);
    RUN_TEST(test_a_word_takes_its_time_and_the_core_stands_still);
    RUN_TEST(test_each_error_has_its_flag_and_writes_nothing);
    RUN_TEST(test_an_erase_takes_one_sector);
    RUN_TEST(test_a_reset_within_an_erase_leaves_weak_bits);
    RUN_TEST(test_words_need_their_supply);
    RUN_TEST(test_option_bytes);
    RUN_TEST(test_a_cache_is_emptied_while_it_is_off);
    RUN_TEST(test_what_is_stored_is_plain_memory_while_a_read_has_no_other_effect);
    board_free(b);
    return UNITY_END();
}
