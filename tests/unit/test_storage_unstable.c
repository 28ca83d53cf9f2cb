/* Power is cut in saves, starts and repairs, and the words of what was interrupted read differently each time
 * (tests/support/flash_cut.h). Whatever was answered with `ok` is found at every start that follows, with saves
 * between; and what one start has found is what the next one finds.
 *
 * A case is a flash with a history, a cut at one operation of a save and the start after it, a cut at one operation of
 * what follows, and a way to read. Without arguments a sample of the cases is tried, with `all` every one:
 *
 *     build/host/tests/unit/test_storage_unstable all
 *
 * Compiled WITH_BLOCKS it is the same with a block in the settings, whose kind changes from save to save.
 */
#include "base/crc32.h"
#include "flash_cut.h"
#include "storage/storage.h"
#include "storage/storage_parts.h"
#include "storage_bench.h"
#ifdef WITH_BLOCKS
#include "changing_block.h"
#endif

static bool all, may_fail;
static unsigned long starts, cases;

/* ---- settings: one number, and records nobody here knows, which make a set as long as wanted ---- */

static uint32_t settings_now(void)
{
    return fw.storage.newest.sequence ? (uint32_t)bench_get("tick.miss_limit") : 0;
}

static void make_settings(struct config *c, uint32_t number)
{
    char text[16];
    snprintf(text, sizeof text, "%u", (unsigned)number);
    bench_tiny(c, text);
#ifdef WITH_BLOCKS
    if (number >= 100)
        block_of(c, number);
#endif
}

static void put_settings(uint32_t number)
{
    struct config c;
    make_settings(&c, number);
    bench_put(&c);
}

static void put_grain(uint8_t *at, const char *magic, uint32_t a, uint32_t b)
{
    memcpy(at, magic, 4);
    put32(at + 4, a);
    put32(at + 8, b);
    put32(at + 12, crc32_update(0, at, 12));
}

/* Leaves what earlier firmware would have: one set, with `padding` bytes of unknown records and no settings of ours. */
static void old_flash(uint32_t padding, uint32_t sequence)
{
    uint8_t *at = flash_model;
    uint32_t length = 0;
    flash_model_erase_all();
    put_grain(at, "RXSM", 1, 1);
    at += (size_t)2 * STORAGE_GRAIN;
    for (unsigned i = 0; length < padding; i++, length += 204) {
        put16(at + length, (uint16_t)(15u << 12 | 62u << 6 | i));
        at[length + 2] = 9;
        at[length + 3] = 200;
        memset(at + length + 4, (int)i, 200);
    }
    put_grain(at - STORAGE_GRAIN, "RXSH", sequence, length | 1u << 16 | 1u << 24);
    uint32_t body = (length + STORAGE_GRAIN - 1u) / STORAGE_GRAIN * STORAGE_GRAIN;
    memset(at + length, 0, body - length);
    at += body;
    memcpy(at, "RXST", 4);
    put32(at + 4, length);
    put32(at + 8, sequence);
    put32(at + 12, crc32_update(0, flash_model + STORAGE_GRAIN,
                                (size_t)(at - flash_model) + 12u - STORAGE_GRAIN));
}

/* ---- one life of a board ---- */

static struct {
    uint32_t answered; /* the last one with `ok`, or what a start since then has found */
    uint32_t tried;    /* the last one asked for */
    bool open;         /* a cut came before an answer: each may be found as well, */
    uint32_t first;    /* from this one on */
    unsigned fails;    /* operations of the next start until the flash fails */
    char what[160];
} life;

static void fail(const char *reason)
{
    char text[260];
    snprintf(text, sizeof text, "%s, start %u: %s; found %u, answered %u, tried %u", life.what,
             cut.start, reason, (unsigned)settings_now(), (unsigned)life.answered,
             (unsigned)life.tried);
    TEST_FAIL_MESSAGE(text);
}

/* Power on, perhaps with a cut before the settings are in force: then there is nothing to say about them. */
static bool start(unsigned cut_at)
{
    cut_power_on();
    cut.left = cut_at;
    cut.fails = life.fails;
    bench_boot();
    starts++;
    if (cut.off)
        return false;
    if (seen[EVENT_STORAGE_DAMAGED] && life.answered)
        fail("damaged");
    uint32_t found = settings_now();
    static struct config whole;
    if (found >= 100)
        make_settings(&whole, found);
    if (found >= 100 && !bench_is(&whole))
        fail("a mixture");
    if (found != life.answered && !(life.open && found >= life.first && found <= life.tried))
        fail("lost");
    /* A start cannot decide for nothing, nor where it cannot write that down: earlier firmware has left no room, or the
     * flash does not take it. */
    bool undecided = found == 0 || (storage_unsettled(&fw.storage) &&
                                    (!storage_can_renew(&fw.storage) || fw.storage.failed));
    life.open = life.open && undecided;
    life.answered = found;
    return true;
}

/* Another value, cut at that operation from here. False: the power is off. */
static bool save(unsigned cut_at)
{
    life.tried++;
    put_settings(life.tried);
    cut.left = cut_at;
    enum err err = bench_save();
    if (err == ERR_OK) {
        TEST_ASSERT_FALSE(cut.off);
        life.answered = life.tried;
        life.open = false;
    } else {
        life.first = life.open ? life.first : life.tried;
        life.open = true;
        if (!cut.off && !may_fail)
            fail(save_why);
    }
    return !cut.off;
}

/* Ten starts with saves between. */
static void ten_starts(void)
{
    for (unsigned i = 0; i < 10; i++) {
        (void)start(CUT_NEVER);
        if (i % 4 == 2)
            (void)save(CUT_NEVER);
    }
}

/* ---- all cuts ---- */

/* The flash before the cuts, and the life up to there. */
static uint8_t image[FLASH_MODEL_SIZE];
static uint32_t image_answered;

static void begin(uint64_t seed, enum cut_view view, unsigned turn, uint32_t word)
{
    memcpy(flash_model, image, sizeof image);
    cut_begin(seed);
    cut.view = view;
    cut.turn = turn;
    cut.word = word;
    life.answered = image_answered;
    life.tried = 10000;
    life.open = false;
    life.fails = CUT_NEVER;
    cases++;
}

static void prepare_image(uint32_t padding, uint32_t sequence, unsigned saves)
{
    if (sequence)
        old_flash(padding, sequence);
    else
        flash_model_erase_all();
    cut_begin(1);
    bench_boot();
    life.answered = settings_now();
    life.tried = 100;
    for (unsigned i = 0; i < saves; i++)
        TEST_ASSERT_TRUE(save(CUT_NEVER));
    memcpy(image, flash_model, sizeof image);
    image_answered = life.answered;
}

/* A start and a save, cut at operation `first`, then both again, cut at operation `second`. False: there is no first
 * such operation; *second_there tells of the other. */
static bool cut_twice(unsigned first, unsigned second, bool *second_there)
{
    if (start(first) && save(first - cut.operations))
        return false;
    *second_there = !start(second) || !save(second - cut.operations);
    ten_starts();
    return true;
}

/* Long sets are written in hundreds of pieces, which are all the same: some of them. */
static unsigned next_operation(unsigned n, unsigned of)
{
    if (n < 12 || n + 10 >= of)
        return n + 1;
    return n + 40 < of ? n + 30 : of - 10;
}

static unsigned count_operations(void)
{
    begin(1, CUT_AT_RANDOM, 0, 4);
    (void)start(CUT_NEVER);
    (void)save(CUT_NEVER);
    return cut.operations;
}

/* Every `step`-th case of the flash in `image`, from a random one on. */
static void try_cuts(const char *what, unsigned step, uint64_t seed)
{
    struct random_source random = {seed};
    unsigned number = random_below(&random, step), of = count_operations();
    bool there = true;
    for (unsigned first = 0; there; first = next_operation(first, of)) {
        bool second_there = true;
        for (unsigned second = 0; there && second_there; second = next_operation(second, of)) {
            for (unsigned k = 0; k < 2 * CUT_VIEWS; k++) {
                bool last = k + 1 == 2 * CUT_VIEWS && (second == 0 || second >= of);
                if (number++ % step != 0 && !last) /* that one tells whether there are more */
                    continue;
                uint64_t own = random_next(&random);
                unsigned turn = 1u + (unsigned)(own % 40u);
                begin(own, (enum cut_view)(k / 2), own & 64 ? turn : turn * 50u, k % 2 ? 2 : 4);
                snprintf(life.what, sizeof life.what, "%s: cuts at %u and %u, way %u, seed %llu",
                         what, first, second, k, (unsigned long long)own);
                there = cut_twice(first, second, &second_there);
            }
        }
    }
}

#define STEP(n) (all ? 1u : (n))
/* Runs tests that do not depend on the contents of a set. */
#ifdef WITH_BLOCKS
#define RUN_REST(test)                                                                             \
    if (all)                                                                                       \
    RUN_TEST(test)
#else
#define RUN_REST(test) RUN_TEST(test)
#endif

static void test_first_save_ever(void)
{
    prepare_image(0, 0, 0);
    memset(image, 0xFF, sizeof image);
    try_cuts("first save", STEP(60), 1);
}

static void test_save_that_appends(void)
{
    prepare_image(0, 0, 3);
    try_cuts("append", STEP(60), 2);
}

static void test_save_that_changes_the_slot(void)
{
    prepare_image(3000, 7, 4);
    try_cuts("change of slot", STEP(150), 3);
}

static void test_set_as_large_as_a_slot(void)
{
    prepare_image(15600, 7, 1);
    try_cuts("largest", STEP(500), 4);
}

/* Earlier firmware has filled the slot to the last grain and confirmed nothing. */
static void test_slot_of_earlier_firmware_without_room(void)
{
    old_flash(900, 7);
    put32(flash_model + FLASH_MODEL_SIZE / 2 - 4, 0);
    memcpy(image, flash_model, sizeof image);
    image_answered = 5; /* the default */
    try_cuts("full slot", STEP(60), 5);
}

/* The largest set leaves room for its confirmation and four renewals behind it; one that does not is refused. */
static void test_set_that_leaves_no_room_behind_it_is_refused(void)
{
    const uint32_t most = FLASH_MODEL_SIZE / 2 - STORAGE_GRAIN - SAVE_ROOM;
    unsigned refused = 0, taken = 0;
    flash_model_keep = NULL;
    flash_model_glance = NULL;
    flash_model_erase_all();
    bench_boot();
    put_settings(7);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    const uint32_t own = fw.storage.newest.length;
    for (uint32_t padding = 15504; padding <= 16116; padding += 204) { /* whole records of 204 */
        old_flash(padding, 1);
        bench_boot();
        TEST_ASSERT_EQUAL(padding, fw.storage.newest.length);
        put_settings(7);
        enum err err = bench_save();
        bool fits = set_size(padding + own) <= most;
        TEST_ASSERT_EQUAL(fits ? ERR_OK : ERR_FULL, err);
        refused += !fits;
        taken += fits;
        if (fits)
            TEST_ASSERT_EQUAL(padding + own, fw.storage.newest.length);
        else
            TEST_ASSERT_NOT_NULL(strstr(save_why, "more than this board's flash"));
    }
    TEST_ASSERT_TRUE(refused > 0 && taken > 0);
}

static void test_sequence_that_goes_round(void)
{
    for (uint32_t sequence = UINT32_MAX - 3u; sequence != 0; sequence++) {
        prepare_image(400, sequence, 1);
        try_cuts("going round", STEP(500), sequence);
    }
}

/* Up to seven cuts in a row, anywhere, again and again; what is programmed over a cut may also come out
 * as the bits that both leave. */
static void test_many_cuts_in_a_row(void)
{
    struct random_source random = {6};
    for (unsigned n = 0; n < (all ? 5000u : 60u); n++) {
        uint64_t own = random_next(&random);
        if (n % 12 == 0)
            prepare_image(random_below(&random, 5) * 1500u, 1 + random_below(&random, 9),
                          1 + random_below(&random, 30));
        begin(own, (enum cut_view)(own % CUT_VIEWS), (unsigned)(own >> 8) % 3000u,
              own & 16 ? 2 : 4);
        cut.blend = (own & 32) != 0;
        snprintf(life.what, sizeof life.what, "walk %u, seed %llu", n, (unsigned long long)own);
        for (unsigned i = 0; i < 24; i++) {
            unsigned left = random_below(&random, 3) ? random_below(&random, 40) : CUT_NEVER;
            bool quiet = i % 8 == 7;
            if (start(quiet ? CUT_NEVER : left) && random_below(&random, 2))
                (void)save(quiet || left == CUT_NEVER ? CUT_NEVER : left / 2u);
        }
        ten_starts();
    }
}

/* Cuts, and operations that the flash does by half and says so. */
static void test_flash_that_fails_now_and_then(void)
{
    struct random_source random = {8};
    for (unsigned n = 0; n < (all ? 2000u : 30u); n++) {
        uint64_t own = random_next(&random);
        if (n % 10 == 0)
            prepare_image(random_below(&random, 4) * 1500u, 1 + random_below(&random, 9),
                          1 + random_below(&random, 20));
        begin(own, (enum cut_view)(own % CUT_VIEWS), (unsigned)(own >> 8) % 3000u, 4);
        snprintf(life.what, sizeof life.what, "failing %u, seed %llu", n, (unsigned long long)own);
        may_fail = true;
        for (unsigned i = 0; i < 24; i++) {
            life.fails = random_below(&random, 3) ? CUT_NEVER : random_below(&random, 6);
            bool on = start(random_below(&random, 4) ? CUT_NEVER : random_below(&random, 10));
            cut.fails = random_below(&random, 30);
            if (on && random_below(&random, 2))
                (void)save(random_below(&random, 4) ? CUT_NEVER : random_below(&random, 20));
        }
        may_fail = false;
        life.fails = CUT_NEVER;
        ten_starts();
    }
}

/* ---- no cut: one reading is wrong ---- */

static void test_one_wrong_reading_costs_nothing(void)
{
    prepare_image(600, 3, 8);
    begin(1, CUT_AT_RANDOM, 0, 4);
    (void)start(CUT_NEVER); /* which makes room in the other slot */
    memcpy(image, flash_model, sizeof image);
    begin(1, CUT_AT_RANDOM, 0, 4);
    (void)start(CUT_NEVER);
    unsigned readings = cut.readings;
    struct random_source random = {7};
    for (unsigned wrong = random_below(&random, STEP(29u)); wrong < readings; wrong += STEP(29u)) {
        begin(wrong, CUT_AT_RANDOM, 0, 4);
        cut_power_on();
        cut.wrong = wrong;
        bench_boot();
        starts++;
        snprintf(life.what, sizeof life.what, "reading %u is wrong", wrong);
        if (settings_now() != life.answered || seen[EVENT_STORAGE_OLDER] != 0)
            fail("lost");
        TEST_ASSERT_EQUAL_MEMORY(image, flash_model, sizeof image);
    }
}

static uint32_t doubtful;

/* The bit reads wrong as long as the set is looked at for the first time. */
static void wrong_at_first(uint32_t address, uint8_t *data, uint32_t n)
{
    bool first = fw.storage.state == CHECKING && !fw.storage.again;
    if (first && address <= doubtful && doubtful < address + n)
        data[doubtful - address] ^= 1u;
}

static void test_set_that_reads_wrong_at_first_is_looked_at_again_before_it_is_given_up(void)
{
    void (*glance)(uint32_t, uint8_t *, uint32_t) = flash_model_glance;
    prepare_image(600, 3, 3);
    doubtful = fw.storage.newest.address + 100u;
    begin(1, CUT_AT_RANDOM, 0, 4);
    flash_model_glance = wrong_at_first;
    bench_boot();
    flash_model_glance = glance;
    TEST_ASSERT_EQUAL(life.answered, settings_now());
    TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_OLDER]);
    TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_DAMAGED]);
}

/* Nor does a start that reads all of the newest set wrong: the next one finds it again. */
static void test_newest_set_is_found_again_after_a_start_that_could_not_read_it(void)
{
    prepare_image(600, 3, 3);
    uint32_t at = fw.storage.newest.address + 100u;
    begin(1, CUT_AT_RANDOM, 0, 4);
    flash_model[at] ^= 1u;
    bench_boot();
    TEST_ASSERT_EQUAL(life.answered - 1u, settings_now());
    TEST_ASSERT_EQUAL(1, seen[EVENT_STORAGE_OLDER]);
    flash_model[at] ^= 1u;
    bench_boot();
    TEST_ASSERT_EQUAL(life.answered, settings_now());
    TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_OLDER]);
}

int main(int argc, char **argv)
{
    all = argc > 1 && strcmp(argv[1], "all") == 0;
    UNITY_BEGIN();
    RUN_REST(test_first_save_ever);
    RUN_TEST(test_save_that_appends);
    RUN_REST(test_save_that_changes_the_slot);
    RUN_REST(test_set_as_large_as_a_slot);
    RUN_REST(test_slot_of_earlier_firmware_without_room);
    RUN_REST(test_set_that_leaves_no_room_behind_it_is_refused);
    RUN_REST(test_sequence_that_goes_round);
    RUN_TEST(test_many_cuts_in_a_row);
    RUN_TEST(test_flash_that_fails_now_and_then);
    RUN_REST(test_one_wrong_reading_costs_nothing);
    RUN_REST(test_set_that_reads_wrong_at_first_is_looked_at_again_before_it_is_given_up);
    RUN_REST(test_newest_set_is_found_again_after_a_start_that_could_not_read_it);
    printf("storage unstable words: %lu cases, %lu starts\n", cases, starts);
    return UNITY_END();
}

void setUp(void) {}

void tearDown(void)
{
    flash_model_keep = NULL;
    flash_model_glance = NULL;
}
