/* Power is cut everywhere in saves of blocks that have a record: another kind, rows of a table, a pool that is full, a kind that
 * nobody knows, records of newer firmware. What a start finds is the old record or the new one, never a mixture, and what
 * is carried over stays whatever is cut. As test_storage_power.c, of which it shares the way to cut:
 *
 *     build/host/tests/unit/test_storage_power_blocks all
 */
#include "flash_recording.h"
#include "made_up_kinds.h"
#include "storage_images.h"

void setUp(void)
{
    random_source.state = 20261122;
    flash_model_keep = keep;
    recording = NULL;
    flash_model_erase_all();
    parameters_defaults(&nothing);
}

void tearDown(void) {}

static void put_rows(struct config *c, const char *block, double x)
{
    char name[40], row[60];
    for (unsigned i = 1; i <= 3; i++) {
        snprintf(name, sizeof name, "%s.table.%u", block, i);
        snprintf(row, sizeof row, "%g,%g,%g", x + i, x * 2 + i, x * 3 + i);
        bench_set(c, name, row);
    }
}

static void with_gmv(struct config *c, double x)
{
    bench_small(c, "1.5");
    bench_set(c, "block1.kind", "gmv");
    bench_set(c, "block1.loops", "bottom");
    put_rows(c, "block1", x);
}

static void cut_the_save(const struct config *before, const struct config *after)
{
    bench_boot();
    bench_put(before);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    record_save(&first, after);
    cut_everywhere(&first, before, after);
}

/* ---- one cut ---- */

static void cut_where_a_block_gets_another_kind(void)
{
    with_gmv(&older, 1.5);
    with_gmv(&newer, 1.5);
    bench_set(&newer, "block1.kind", "weights"); /* some ids are the same, for something else */
    bench_set(&newer, "block1.order.2", "5,6,7");
    cut_the_save(&older, &newer);
}

static void cut_where_a_block_goes_and_another_takes_its_place(void)
{
    with_gmv(&older, 1.5);
    newer = older;
    bench_set(&newer, "block1.kind", "-");
    bench_set(&newer, "block3.kind", "weights");
    bench_set(&newer, "block3.loops", "bottom");
    bench_set(&newer, "block3.signs.1", "minus,plus,minus,plus");
    cut_the_save(&older, &newer);
}

static void cut_where_rows_of_a_table_change(void)
{
    with_gmv(&older, 1.5);
    with_gmv(&newer, -7.25);
    cut_the_save(&older, &newer);
}

static void a_column(struct config *c, double x)
{
    char name[40], row[160];
    bench_small(c, "1.5");
    bench_set(c, "block2.kind", "column");
    bench_set(c, "block2.loops", "bottom");
    for (unsigned i = 1; i <= 48; i++) {
        snprintf(name, sizeof name, "block2.stage.%u", i);
        snprintf(row, sizeof row, "%g,1,2,3,4,5,6,%u", x, i);
        bench_set(c, name, row);
    }
}

/* The pool has no room for more than this table: its save may need an erase, which is cut too. */
static void cut_where_the_pool_is_full(void)
{
    uint32_t before = stride;
    a_column(&older, 1.5);
    a_column(&newer, 2.5);
    stride = stride > 1 ? 101 : 1;
    cut_the_save(&older, &newer);
    stride = before;
}

/* ---- what is carried over ---- */

/* Contents of the images: a value and a row that this firmware knows nothing of. */
static const uint8_t newer_row[] = {0,    0,    STORAGE_ROW, 16, 0xC0, 0,    66, 16, 0,    0,
                                    0xE0, 0x40, 0,           0,  0,    0x41, 0,  0,  0x10, 0x41};
static const uint8_t mystery_row[] = {0, 0, STORAGE_ROW, 12,   0xC2, 1, 73,   16,
                                      0, 0, 0xC0,        0x3F, 0,    0, 0x20, 0x40};

/* In the newest set, as it is found. */
static bool newest_set_has(const uint8_t *bytes, size_t n)
{
    const uint8_t *set = flash_model + fw.storage.newest.address;
    for (size_t i = STORAGE_GRAIN; i + n <= STORAGE_GRAIN + fw.storage.newest.length; i++)
        if (memcmp(set + i, bytes, n) == 0)
            return true;
    return false;
}

static void cut_where_it_is_carried_over(const char *image, const uint8_t *carried, size_t n)
{
    load_image(image);
    bench_boot();
    older = *in_force();
    newer = older;
    bench_set(&newer, "loop1.gain", "9");
    record_save(&first, &newer);
    for (unsigned step = 0; step < first.n; step++) {
        for (uint32_t bits = some(); bits < 8u * first.step[step].n; bits += stride) {
            tear_program(&first, step, bits);
            expect_one_of(&older, &newer, image, step, bits);
            if (!newest_set_has(carried, n))
                fail("not carried over", step, bits);
        }
    }
    replay(&first, first.n);
    expect_one_of(&newer, &newer, image, first.n, 0);
    TEST_ASSERT_TRUE(newest_set_has(carried, n));
}

static void cut_where_records_of_newer_firmware_are_carried_over(void)
{
    cut_where_it_is_carried_over("block", newer_row, sizeof newer_row);
}

static void cut_where_a_block_of_an_unknown_kind_is_carried_over(void)
{
    cut_where_it_is_carried_over("block_unknown", mystery_row, sizeof mystery_row);
}

/* ---- no cut: every bit flips ---- */

static void every_bit_of_records_flips(void)
{
    static uint8_t image[FLASH_MODEL_SIZE];
    bench_boot();
    with_gmv(&older, 1.5);
    with_gmv(&newer, -7.25);
    bench_set(&newer, "block1.kind", "weights");
    bench_put(&older);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    bench_put(&newer);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    memcpy(image, flash_model, sizeof image);
    for (uint32_t i = 0; i < fw.storage.used[0]; i++) {
        for (unsigned bit = some(); bit < 8; bit += stride) {
            memcpy(flash_model, image, sizeof image);
            flash_model[i] ^= (uint8_t)(1u << bit);
            expect_one_of(&older, &newer, "flip", i, bit);
        }
    }
}

int main(int argc, char **argv)
{
    stride = argc > 1 && strcmp(argv[1], "all") == 0 ? 1 : 13;
    UNITY_BEGIN();
    memory_port_erase_all();
    RUN_TEST(cut_where_a_block_gets_another_kind);
    RUN_TEST(cut_where_a_block_goes_and_another_takes_its_place);
    RUN_TEST(cut_where_rows_of_a_table_change);
    RUN_TEST(cut_where_the_pool_is_full);
    RUN_TEST(cut_where_records_of_newer_firmware_are_carried_over);
    RUN_TEST(cut_where_a_block_of_an_unknown_kind_is_carried_over);
    RUN_TEST(every_bit_of_records_flips);
    printf("storage power-cut states with blocks: %lu\n", states);
    return UNITY_END();
}
