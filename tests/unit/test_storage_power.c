/* Power is cut everywhere; what is left behind is stable (where it is not: test_storage_unstable.c). One state is one content of the flash a cut can leave behind, followed by one start of the
 * firmware, which must find the settings before the save or those of the save, whole; and where none were stored,
 * the defaults, with an alarm.
 *
 *   in a program operation   every prefix of its bits is written, from none to all
 *   in an erase              nothing, everything, a beginning, or random words
 *   twice                    after the first cut comes a start and another save, which is cut as well: every byte
 *                            prefix of the first cut by every word prefix of the second (the full product by bits
 *                            would be 10^7 starts and more)
 *   never                    every bit of every stored byte flips
 *
 * Without arguments a sample of the states is tried, with `all` every one:
 *
 *     build/host/tests/unit/test_storage_power all
 */
#include "flash_recording.h"

static struct recording second;
static struct config newest;

void setUp(void)
{
    random_source.state = 20240607;
    flash_model_keep = keep;
    recording = NULL;
    flash_model_erase_all();
    parameters_defaults(&nothing);
}

void tearDown(void) {}

/* ---- one cut ---- */

static void test_cut_in_the_first_save_ever(void)
{
    bench_boot();
    bench_small(&newer, "2.5");
    record_save(&first, &newer);
    cut_everywhere(&first, &nothing, &newer);
}

static void test_cut_in_a_save_that_appends(void)
{
    bench_boot();
    bench_small(&older, "1.5");
    bench_small(&newer, "2.5");
    bench_set(&newer, "meas1.gain", "1.02");
    bench_set(&newer, "meas1.valid_hi", "104");
    bench_put(&older);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    record_save(&first, &newer);
    cut_everywhere(&first, &older, &newer);
}

/* Saves until the next one needs an erase; `config` alternates and the last saved is in *config. */
static void fill_slot(struct config *a, struct config *b, struct config **last)
{
    for (unsigned n = 0; n < 2000; n++) {
        *last = n % 2 ? a : b;
        bench_put(*last);
        record_into(&first);
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
        stop_recording();
        if (first.step[1].erase) /* the mark goes first */
            return;
    }
    TEST_FAIL_MESSAGE("never full");
}

static void test_cut_in_a_save_that_erases(void)
{
    struct config *last;
    bench_boot();
    bench_small(&older, "1.5");
    bench_small(&newer, "2.5");
    fill_slot(&older, &newer, &last); /* leaves that save in `first` */
    cut_everywhere(&first, last == &newer ? &older : &newer, last);
}

static void test_cut_while_a_start_erases(void)
{
    bench_boot();
    bench_small(&older, "1.5");
    bench_small(&newer, "2.5");
    /* Until a start finds it necessary, with sets in the slot that is erased. */
    for (unsigned n = 0;; n++) {
        TEST_ASSERT_TRUE(n < 2000);
        bench_put(n % 2 ? &older : &newer);
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
        record_into(&first);
        bench_boot();
        stop_recording();
        if (first.n > 1 && first.step[1].erase && n > 20 && fw.storage.erases[0] > 0 &&
            fw.storage.erases[1] > 1)
            break;
    }
    struct config found = *in_force();
    cut_everywhere(&first, &found, &found);
}

/* ---- two cuts ---- */

/* Another save after the first cut, cut in turn. */
static void cut_again(const struct config *before, const struct config *after)
{
    bench_boot();
    states++;
    if (!stored(before) && !stored(after))
        fail("first of two", 0, 0);
    struct config there = *in_force();
    record_save(&second, &newest);
    for (unsigned step = 0; step < second.n; step++) {
        if (second.step[step].erase) {
            for (unsigned n = some(); n < 6; n += stride) {
                tear_erase(&second, step, random_below(&random_source, ERASE_WAYS));
                expect_one_of(&there, &newest, "second erase", step, n);
            }
            continue;
        }
        for (uint32_t bits = 32u * some(); bits < 8u * second.step[step].n; bits += 32u * stride) {
            uint32_t torn = bits + random_below(&random_source, 32);
            tear_program(&second, step, torn);
            expect_one_of(&there, &newest, "second program", step, torn);
        }
    }
    replay(&second, second.n);
    expect_one_of(&newest, &newest, "after two", 0, 0);
}

static void cut_twice(const struct config *before, const struct config *after)
{
    for (unsigned step = 0; step < first.n; step++) {
        if (first.step[step].erase) {
            for (unsigned way = some(); way < ERASE_WAYS; way += stride) {
                tear_erase(&first, step, way);
                cut_again(before, after);
            }
            continue;
        }
        for (uint32_t bits = 8u * some(); bits < 8u * first.step[step].n; bits += 8u * stride) {
            tear_program(&first, step, bits + random_below(&random_source, 8));
            cut_again(before, after);
        }
    }
}

static void test_two_cuts(void)
{
    bench_boot();
    bench_tiny(&older, "7");
    bench_tiny(&newer, "8");
    bench_tiny(&newest, "9");
    bench_put(&older);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    record_save(&first, &newer);
    cut_twice(&older, &newer);
}

static void test_two_cuts_from_nothing(void)
{
    bench_boot();
    bench_tiny(&newer, "8");
    bench_tiny(&newest, "9");
    record_save(&first, &newer);
    cut_twice(&nothing, &newer);
}

static void test_two_cuts_around_an_erase(void)
{
    struct config *last;
    bench_boot();
    bench_small(&older, "1.5");
    bench_small(&newer, "2.5");
    bench_small(&newest, "3.5");
    fill_slot(&older, &newer, &last);
    first.n = 4; /* unmark, erase, mark, head: the rest is as in the other tests */
    cut_twice(last == &newer ? &older : &newer, last);
}

/* ---- no cut: every bit flips ---- */

static void flip_everything(const struct config *before, const struct config *after)
{
    static uint8_t image[FLASH_MODEL_SIZE];
    memcpy(image, flash_model, sizeof image);
    uint32_t end = fw.storage.used[0];
    for (uint32_t i = 0; i < FLASH_MODEL_SIZE; i++) {
        if (image[i] == 0xFF && (i == 0 || image[i - 1] == 0xFF) && image[i | 15u] == 0xFF)
            continue; /* nothing stored there */
        for (unsigned bit = some(); bit < 8; bit += stride) {
            memcpy(flash_model, image, sizeof image);
            flash_model[i] ^= (uint8_t)(1u << bit);
            expect_one_of(before, after, "flip", i, bit);
            /* Behind the sets a bit looks like a save that was cut at once. */
            bool reverted = before != &nothing && bench_is(before);
            if (seen[EVENT_STORAGE_OLDER] != (reverted || i >= end))
                fail("what was told of an older set", i, bit);
        }
    }
}

static void test_every_bit_of_one_set_flips(void)
{
    bench_boot();
    bench_small(&newer, "2.5");
    bench_put(&newer);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    flip_everything(&nothing, &newer);
}

static void test_every_bit_of_two_sets_flips(void)
{
    bench_boot();
    bench_small(&older, "1.5");
    bench_small(&newer, "2.5");
    bench_put(&older);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    bench_put(&newer);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    flip_everything(&older, &newer);
}

int main(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "all") == 0)
        stride = 1;
    UNITY_BEGIN();
    memory_port_erase_all();
    RUN_TEST(test_cut_in_the_first_save_ever);
    RUN_TEST(test_cut_in_a_save_that_appends);
    RUN_TEST(test_cut_in_a_save_that_erases);
    RUN_TEST(test_cut_while_a_start_erases);
    RUN_TEST(test_two_cuts);
    RUN_TEST(test_two_cuts_from_nothing);
    RUN_TEST(test_two_cuts_around_an_erase);
    RUN_TEST(test_every_bit_of_one_set_flips);
    RUN_TEST(test_every_bit_of_two_sets_flips);
    printf("storage power-cut states: %lu\n", states);
    return UNITY_END();
}
