/* Settings of blocks in storage. */
#include "block_settings_bench.h"
#include "settings/block_pool.h"

static void block_of_image(struct config *c)
{
    plant_of_images(c);
    bench_set(c, "block1.kind", "gmv");
    bench_set(c, "block1.loops", "bottom");
    bench_set(c, "block1.lambda", "0.5");
    bench_set(c, "block1.table.1", "1,0.25,0");
    bench_set(c, "block1.table.2", "0,2,0.5");
    bench_set(c, "block1.table.3", "0.125,0,4");
    bench_set(c, "block1.order", "3");
    bench_set(c, "block1.adapt", "off");
}

static void unknown_block_of_image(struct config *c)
{
    plant_of_images(c);
    TEST_ASSERT_FALSE(record_restore(c, 2, "mystery"));
    strcpy(c->block[2].loops, "bottom");
    strcpy(c->block[2].inputs, "T1");
}

static unsigned times_in_flash(const void *bytes, size_t n)
{
    unsigned times = 0;
    for (size_t i = 0; i + n <= sizeof flash_model; i++)
        times += memcmp(flash_model + i, bytes, n) == 0;
    return times;
}

/* Rows of the images: what newer firmware knows of a block, and all of a block whose kind nobody knows. */
static const uint8_t newer_row[] = {0,    0,    STORAGE_ROW, 16, 0xC0, 0,    66, 16, 0,    0,
                                    0xE0, 0x40, 0,           0,  0,    0x41, 0,  0,  0x10, 0x41};
static const uint8_t newer_value[] = {0, 0, STORAGE_FLOAT, 8, 0, 0, 124, 16, 0, 0, 0x70, 0x42};
static const uint8_t mystery_value[] = {0, 0, STORAGE_FLOAT, 8, 2, 0, 65, 16, 0, 0, 0x40, 0x3F};
static const uint8_t mystery_row[] = {0, 0, STORAGE_ROW, 12,   0xC2, 1, 73,   16,
                                      0, 0, 0xC0,        0x3F, 0,    0, 0x20, 0x40};

#define EACH_TIMES(n, record)                                                                      \
    TEST_ASSERT_EQUAL_MESSAGE(n, times_in_flash(record, sizeof(record)), #record)

static void a_kept_image_with_a_block_is_read_in_any_order(void)
{
    static const char *const images[] = {"block", "block_reversed"};
    for (unsigned i = 0; i < 2; i++) {
        block_of_image(&config);
        load_image(images[i]);
        bench_boot();
        TEST_ASSERT_EQUAL_MESSAGE(1, seen[EVENT_STORAGE_LOADED], images[i]);
        TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_CLIPPED] + seen[EVENT_BLOCK_UNKNOWN]);
        TEST_ASSERT_TRUE_MESSAGE(bench_is(&config), images[i]);
    }
}

static void parameters_of_newer_firmware_are_carried_over_by_every_save(void)
{
    block_of_image(&config);
    load_image("block");
    bench_boot();
    for (unsigned n = 2; n < 6; n++) {
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
        EACH_TIMES(n, newer_row);
        EACH_TIMES(n, newer_value);
        bench_boot();
        TEST_ASSERT_TRUE(bench_is(&config));
    }
}

static void a_block_of_an_unknown_kind_is_told_and_carried_over_by_every_save(void)
{
    unknown_block_of_image(&config);
    load_image("block_unknown");
    for (unsigned n = 1; n < 5; n++) {
        bench_boot();
        TEST_ASSERT_TRUE(bench_is(&config));
        TEST_ASSERT_EQUAL(1, seen[EVENT_STORAGE_LOADED]);
        TEST_ASSERT_EQUAL(1, seen[EVENT_BLOCK_UNKNOWN]);
        TEST_ASSERT_EQUAL_STRING("mystery", last_subject[EVENT_BLOCK_UNKNOWN]);
        TEST_ASSERT_EQUAL_FLOAT(3.0f, last_value[EVENT_BLOCK_UNKNOWN]);
        TEST_ASSERT_EQUAL(EVENT_ALARM, event_level(EVENT_BLOCK_UNKNOWN));
        EACH_TIMES(n, mystery_value);
        EACH_TIMES(n, mystery_row);
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    }
}

static void parameters_of_an_unknown_kind_cannot_be_set(void)
{
    load_image("block_unknown");
    bench_boot();
    config = *in_force();
    IS(&config, "block3.kind", "mystery");
    TEST_ASSERT_EQUAL(ERR_UNSUPPORTED, try_set("block3.loops", "bottom"));
    TEST_ASSERT_EQUAL(ERR_EMPTY, try_set("block3.lambda", "1"));
    TEST_ASSERT_NULL(config_block_settings(&config, 2));
    TEST_ASSERT_TRUE(bench_is(&config));
}

static void a_block_of_another_kind_takes_nothing_along(void)
{
    load_image("block");
    bench_boot();
    config = *in_force();
    set("block1.kind", "weights"); /* some of its ids are those of the first, for something else */
    bench_put(&config);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    EACH_TIMES(1, newer_row);
    EACH_TIMES(1, newer_value);
    bench_boot();
    TEST_ASSERT_TRUE(bench_is(&config));
    IS(in_force(), "block1.order.1", "2,2,2");
    IS(in_force(), "block1.signs.1", "plus,plus,plus,plus");
    /* Nor where one that nobody knew becomes one of ours, or none. */
    for (unsigned i = 0; i < 2; i++) {
        load_image("block_unknown");
        bench_boot();
        config = *in_force();
        set("block3.kind", i ? "weights" : "-");
        bench_put(&config);
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
        EACH_TIMES(1, mystery_value);
        EACH_TIMES(1, mystery_row);
        bench_boot();
        TEST_ASSERT_TRUE(bench_is(&config));
        TEST_ASSERT_EQUAL(0, seen[EVENT_BLOCK_UNKNOWN]);
    }
}

static void a_table_pasted_by_half_is_refused_and_nothing_of_it_is_in_force(void)
{
    struct config_fault fault;
    static struct config before;
    bench_boot();
    bench_small(&config, "1.5");
    bench_put(&config);
    before = *in_force();
    set("block1.kind", "gmv");
    set("block1.loops", config.loop[0].name);
    set("block1.table.1", "1,0,0");
    set("block1.table.2", "0,1,0");
    TEST_ASSERT_EQUAL(ERR_RANGE, service_apply(&fw.service, &config, &fault));
    TEST_ASSERT_EQUAL_STRING("block", fault.group);
    TEST_ASSERT_EQUAL_STRING("table", fault.field);
    TEST_ASSERT_TRUE(bench_is(&before));
    set("block1.table.3", "0,0,1");
    bench_put(&config);
    TEST_ASSERT_TRUE(bench_is(&config));
}

static void a_table_that_fills_most_of_the_pool_comes_back(void)
{
    char name[30], row[300];
    bench_small(&config, "1.5");
    set("block2.kind", "column");
    set("block2.loops", config.loop[0].name);
    for (unsigned i = 1; i <= 48; i++) {
        row[0] = '\0';
        for (unsigned k = 0; k < 8; k++)
            snprintf(row + strlen(row), sizeof row - strlen(row), "%s%g", k ? "," : "",
                     (double)i * 0.5 - k);
        snprintf(name, sizeof name, "block2.stage.%u", i);
        set(name, row);
    }
    bench_boot();
    bench_put(&config);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    bench_boot();
    TEST_ASSERT_TRUE(bench_is(&config));
    IS(in_force(), "block2.stage.48", "24,23,22,21,20,19,18,17");
}

static void stored_rows_are_clipped_or_left_out_and_told(void)
{
    static const float allowed[3] = {1.0f, 1e3f, -1e3f};
    load_image("block");
    uint8_t *at = NULL;
    static const uint8_t first_row[] = {0, 0, STORAGE_ROW, 16, 0, 0, 66, 16};
    struct stored_record r = {.type = STORAGE_ROW, .size = 16, .wide = 4};
    struct parameter p;
    block_of_image(&config);
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find_in(&config, "block1.table.1", &p));
    for (size_t i = 0; !at && i + sizeof first_row <= sizeof flash_model; i++)
        if (memcmp(flash_model + i, first_row, sizeof first_row) == 0)
            at = flash_model + i;
    TEST_ASSERT_NOT_NULL(at);
    r.address = (uint32_t)(at - flash_model);
    TEST_ASSERT_TRUE(record_take(&r, &p, &config));
    float outside[3] = {1.0f, 1e4f, -1e9f};
    memcpy(at + 8, outside, sizeof outside);
    TEST_ASSERT_FALSE(record_take(&r, &p, &config));
    const struct gmv_settings *s = config_block_settings(&config, 0);
    TEST_ASSERT_EQUAL_FLOAT_ARRAY(allowed, s->table[0], 3);
    memset(at + 8, 0xFF, 4); /* no number */
    TEST_ASSERT_FALSE(record_take(&r, &p, &config));
    r.size = 12; /* another number of columns */
    TEST_ASSERT_FALSE(record_take(&r, &p, &config));
    static const float others[3] = {5.0f, 6.0f, 7.0f};
    memcpy(at + 8, others, sizeof others);
    r.size = 20; /* more of them: which is which nobody knows */
    TEST_ASSERT_FALSE(record_take(&r, &p, &config));
    TEST_ASSERT_EQUAL_FLOAT_ARRAY(allowed, s->table[0], 3);
    r.type = STORAGE_FLOAT;
    r.size = 8;
    TEST_ASSERT_FALSE(record_take(&r, &p, &config));
    TEST_ASSERT_EQUAL_FLOAT_ARRAY(allowed, s->table[0], 3);
}

static unsigned operations, operations_left;

static bool keep(uint32_t address, uint32_t n)
{
    static uint8_t known[FLASH_MODEL_SIZE];
    operations++;
    if (operations_left == 0) {
        memcpy(flash_model + address, known + address, n);
        return false;
    }
    operations_left--;
    memcpy(known + address, flash_model + address, n);
    return true;
}

/* Power goes after every operation of a save that gives a block another kind. */
static void a_cut_leaves_the_old_kind_or_the_new_one_whole(void)
{
    static uint8_t image[FLASH_MODEL_SIZE];
    static struct config old;
    unsigned olds = 0, news = 0;
    block_of_image(&old);
    config = old;
    set("block1.kind", "weights");
    set("block1.order.2", "5,6,7");
    load_image("block");
    bench_boot();
    memcpy(image, flash_model, sizeof image);
    for (unsigned cut = 0; !news || operations > cut; cut++) {
        memcpy(flash_model, image, sizeof image);
        bench_boot();
        bench_put(&config);
        flash_model_keep = keep;
        operations_left = UINT32_MAX; /* what it knows of the flash */
        for (uint32_t i = 0; i < FLASH_MODEL_SIZE; i += STORAGE_GRAIN)
            (void)keep(i, STORAGE_GRAIN);
        operations = 0;
        operations_left = cut;
        (void)!bench_save();
        flash_model_keep = NULL;
        bench_boot();
        bool is_new = bench_is(&config);
        TEST_ASSERT_TRUE(is_new || bench_is(&old));
        TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_CLIPPED]);
        TEST_ASSERT_TRUE(news == 0 || is_new);
        news += is_new;
        olds += !is_new;
    }
    TEST_ASSERT_TRUE(olds > 5);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_kept_image_with_a_block_is_read_in_any_order);
    RUN_TEST(parameters_of_newer_firmware_are_carried_over_by_every_save);
    RUN_TEST(a_block_of_an_unknown_kind_is_told_and_carried_over_by_every_save);
    RUN_TEST(parameters_of_an_unknown_kind_cannot_be_set);
    RUN_TEST(a_block_of_another_kind_takes_nothing_along);
    RUN_TEST(a_table_pasted_by_half_is_refused_and_nothing_of_it_is_in_force);
    RUN_TEST(a_table_that_fills_most_of_the_pool_comes_back);
    RUN_TEST(stored_rows_are_clipped_or_left_out_and_told);
    RUN_TEST(a_cut_leaves_the_old_kind_or_the_new_one_whole);
    return UNITY_END();
}
