/* Settings of blocks: records in the pool, and what becomes of them in storage. */
#include "made_up_kinds.h"
#include "random_source.h"
#include "storage_images.h"

static struct config config;

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

void setUp(void)
{
    flash_model_keep = NULL;
    memory_port_erase_all();
    parameters_defaults(&config);
}

void tearDown(void) {}

static void set(const char *name, const char *value)
{
    bench_set(&config, name, value);
}

static enum err try_set(const char *name, const char *value)
{
    struct parameter p;
    enum err err = parameter_find_in(&config, name, &p);
    return err ? err : parameter_set(&p, &config, value);
}

static const char *value_of(const struct config *c, const char *name)
{
    static char text[200];
    struct parameter p;
    struct text t = text_on(text, sizeof text);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_find_in(c, name, &p), name);
    parameter_value(&p, c, &t);
    return text;
}

#define IS(c, name, value) TEST_ASSERT_EQUAL_STRING_MESSAGE(value, value_of(c, name), name)

/* ---- records in the pool ---- */

/* One behind the other in the order of the blocks, nothing behind them. */
static void pool_is_packed(const struct config *c)
{
    uint32_t at = 0;
    for (unsigned n = 0; n < CONFIG_BLOCKS; n++) {
        TEST_ASSERT_EQUAL(c->block[n].bytes ? at : 0, c->block[n].at);
        at += c->block[n].bytes;
    }
    for (; at < CONFIG_POOL_BYTES; at++)
        TEST_ASSERT_EQUAL(0, c->pool[at]);
}

static void a_kind_begins_with_its_defaults(void)
{
    set("block2.kind", "gmv");
    const struct gmv_settings *s = config_record(&config, 1);
    TEST_ASSERT_NOT_NULL(s);
    TEST_ASSERT_EQUAL_FLOAT(0.1f, s->lambda);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, s->table[2][2]);
    TEST_ASSERT_EQUAL(2, s->order);
    TEST_ASSERT_EQUAL(1, s->adapt);
    IS(&config, "block2.table.3", "0,0,0");
    TEST_ASSERT_NULL(config_record(&config, 0));
    TEST_ASSERT_EQUAL(4, block_kind_find("gmv"));
    TEST_ASSERT_EQUAL(0xFF, block_kind_find("gm"));
    TEST_ASSERT_EQUAL(0xFF, block_kind_find(""));
}

static void what_is_set_is_in_the_record(void)
{
    set("block2.kind", "gmv");
    set("block2.lambda", "0.4");
    set("block2.table.3", "0.5,-0.3,1000");
    set("block2.order", "8");
    set("block2.adapt", "off");
    set("block2.loops", "top,bottom");
    const struct gmv_settings *s = config_record(&config, 1);
    TEST_ASSERT_EQUAL_FLOAT(0.4f, s->lambda);
    TEST_ASSERT_EQUAL_FLOAT(-0.3f, s->table[2][1]);
    TEST_ASSERT_EQUAL(8, s->order);
    TEST_ASSERT_EQUAL(0, s->adapt);
    TEST_ASSERT_EQUAL_STRING("top bottom", config.block[1].loops);
    IS(&config, "block2.loops", "top,bottom");
    IS(&config, "block2.table.3", "0.5,-0.3,1000");
    IS(&config, "block2.adapt", "off");
    set("block2.loops", "bottom"); /* nothing of the longer one is left */
    set("block2.loops", "-");
    for (unsigned i = 0; i < BLOCK_LOOPS_SIZE; i++)
        TEST_ASSERT_EQUAL(0, config.block[1].loops[i]);
}

static void what_is_no_value_is_refused_and_nothing_changes(void)
{
    static const char *const bad[][2] = {
        {"block2.kind", "gm"},
        {"block2.kind", "pid"},
        {"block2.kind", ""},
        {"block2.lambda", "11"},
        {"block2.lambda", "x"},
        {"block2.lambda", ""},
        {"block2.table", "1,2,3"},
        {"block2.table.0", "1,2,3"},
        {"block2.table.4", "1,2,3"},
        {"block2.table.01", "1,2,3"},
        {"block2.table.", "1,2,3"},
        {"block2.table.1", "1,2"},
        {"block2.table.1", "1,2,3,4"},
        {"block2.table.1", "1,2,3,"},
        {"block2.table.1", "1,,3"},
        {"block2.table.1", ",1,2,3"},
        {"block2.table.1", "1,2,nan"},
        {"block2.table.1", "1,2,1001"},
        {"block2.table.1", ""},
        {"block2.table.1", "-"},
        {"block2.order", "0"},
        {"block2.order", "2.5"},
        {"block2.order.1", "2"},
        {"block2.adapt", "1"},
        {"block2.adapt", "o"},
        {"block2.loops", ""},
        {"block2.loops", "top,"},
        {"block2.loops", ",top"},
        {"block2.loops", "top,,bottom"},
        {"block2.loops", "a-b"},
        {"block2.loops", "top,bott.m"},
        {"block2.loops", "a_name_of_sixteen"},
        {"block2.loops", "a0123456789,b0123456789,c0123456789,d0123456789x"},
        {"block3.loops", "top"},
        {"block3.lambda", "1"},
        {"block5.kind", "gmv"},
        {"block0.kind", "gmv"},
        {"block2.", "1"},
        {"block.kind", "gmv"},
        {"block2.kindx", "gmv"},
        {"block02.kind", "gmv"},
        {"block22.kind", "gmv"}};
    set("block2.kind", "gmv");
    set("block2.lambda", "1");
    set("block2.table.1", "1 2 3"); /* blanks serve as well */
    static struct config before;
    before = config;
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        TEST_ASSERT_NOT_EQUAL_MESSAGE(ERR_OK, try_set(bad[i][0], bad[i][1]), bad[i][1]);
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&before, &config, sizeof config, bad[i][1]);
    }
    TEST_ASSERT_EQUAL(ERR_STATE, try_set("block3.loops", "top"));
    TEST_ASSERT_EQUAL(ERR_UNKNOWN, try_set("block2.kind", "gm"));
}

static void records_of_other_blocks_move_and_keep_their_values(void)
{
    static struct config direct;
    set("block1.kind", "column");
    set("block2.kind", "gmv");
    set("block4.kind", "weights");
    set("block1.stage.128", "1,2,3,4,5,6,7,8");
    set("block2.table.1", "1,2,3");
    set("block4.order.2", "3,4,5");
    set("block4.signs.1", "minus,plus,minus,plus");
    pool_is_packed(&config);
    set("block1.kind", "weights");
    set("block3.kind", "gmv");
    set("block3.kind", "-");
    pool_is_packed(&config);
    IS(&config, "block2.table.1", "1,2,3");
    IS(&config, "block4.order.2", "3,4,5");
    IS(&config, "block4.signs.1", "minus,plus,minus,plus");
    IS(&config, "block1.order.1", "2,2,2");
    /* Whatever was there before: equal settings have equal bytes. */
    direct = config;
    parameters_defaults(&config);
    set("block4.kind", "weights");
    set("block4.order.2", "3,4,5");
    set("block4.signs.1", "minus,plus,minus,plus");
    set("block2.kind", "gmv");
    set("block2.table.1", "1,2,3");
    set("block1.kind", "weights");
    TEST_ASSERT_EQUAL_MEMORY(&direct, &config, sizeof config);
}

static void the_same_kind_again_changes_nothing_and_none_leaves_nothing(void)
{
    static struct config empty;
    empty = config;
    set("block2.kind", "gmv");
    set("block2.lambda", "1");
    set("block2.loops", "top");
    set("block2.kind", "gmv");
    IS(&config, "block2.lambda", "1");
    set("block2.kind", "-");
    TEST_ASSERT_EQUAL_MEMORY(&empty, &config, sizeof config);
}

static void a_full_pool_says_how_many_bytes_are_needed(void)
{
    uint32_t needed = 0, room = 0;
    set("block1.kind", "column");
    set("block2.kind", "gmv");
    static struct config before;
    before = config;
    TEST_ASSERT_EQUAL(ERR_FULL, try_set("block3.kind", "column"));
    TEST_ASSERT_EQUAL(ERR_FULL, record_make(&config, 2, "column", &needed, &room));
    TEST_ASSERT_EQUAL(4096, needed);
    TEST_ASSERT_EQUAL(CONFIG_POOL_BYTES - 4096u - sizeof(struct gmv_settings), room);
    TEST_ASSERT_EQUAL_MEMORY(&before, &config, sizeof config);
    set("block1.kind", "gmv"); /* its own bytes are free for what it becomes */
    set("block1.kind", "column");
}

/* A stored block that finds no room has a kind and no record: there is nothing to compare the new one with. */
static void the_settings_of_a_block_that_had_no_room_are_all_changes(void)
{
    static struct config before;
    struct parameter p;
    set("block1.kind", "column");
    set("block1.stage.1", "1,2,3,4,5,6,7,8");
    TEST_ASSERT_FALSE(record_restore(&config, 1, "column"));
    before = config;
    IS(&before, "block2.kind", "column");
    set("block1.kind", "-");
    set("block2.kind", "column");
    set("block2.stage.1", "1,2,3,4,5,6,7,8");
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find_in(&config, "block2.stage.1", &p));
    TEST_ASSERT_FALSE(parameter_equal(&p, &config, &before));
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find_in(&config, "block2.stage.2", &p));
    TEST_ASSERT_TRUE(parameter_equal(&p, &config, &before));
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find_in(&config, "block2.kind", &p));
    TEST_ASSERT_FALSE(parameter_equal(&p, &config, &before));
}

static void every_parameter_of_a_block_is_found_by_name_and_id(void)
{
    struct parameter p, found;
    char name[40];
    unsigned of_blocks = 0, n = 0;
    set("block1.kind", "column");
    set("block2.kind", "gmv");
    set("block3.kind", "weights");
    for (; parameter_of(&config, n, &p); n++) {
        struct text t = text_on(name, sizeof name);
        parameter_name(&p, &t);
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_find_in(&config, name, &found), name);
        TEST_ASSERT_EQUAL_PTR_MESSAGE(p.own, found.own, name);
        TEST_ASSERT_TRUE_MESSAGE(found.field == p.field && found.row == p.row, name);
        memset(&found, 0, sizeof found);
        TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, parameter_find_id(&config, parameter_id(&p), &found),
                                  name);
        TEST_ASSERT_TRUE_MESSAGE(found.field == p.field && found.index == p.index &&
                                     found.own == p.own && found.row == p.row,
                                 name);
        of_blocks += parameter_id(&p) >> 16 != 0;
    }
    TEST_ASSERT_EQUAL(n, parameter_count(&config));
    TEST_ASSERT_EQUAL(4 + 128 + 4 + 1 + 3 + 1 + 1 + 4 + 2 + 1 + 1, of_blocks);
}

/* ---- storage ---- */

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

/* Of the images: what newer firmware knows of a block, and all of a block whose kind nobody knows. */
static const uint8_t newer_row[] = {0,    0,    STORAGE_ROW, 16, 0xC0, 0,    66, 16, 0,    0,
                                    0xE0, 0x40, 0,           0,  0,    0x41, 0,  0,  0x10, 0x41};
static const uint8_t newer_value[] = {0, 0, STORAGE_FLOAT, 8, 0, 0, 124, 16, 0, 0, 0x70, 0x42};
static const uint8_t mystery_value[] = {0, 0, STORAGE_FLOAT, 8, 2, 0, 65, 16, 0, 0, 0x40, 0x3F};
static const uint8_t mystery_row[] = {0, 0, STORAGE_ROW, 12,   0xC2, 1, 73,   16,
                                      0, 0, 0xC0,        0x3F, 0,    0, 0x20, 0x40};

#define EACH_TIMES(n, record)                                                                      \
    TEST_ASSERT_EQUAL_MESSAGE(n, times_in_flash(record, sizeof record), #record)

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
    TEST_ASSERT_NULL(config_record(&config, 2));
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

static void a_table_of_four_kilobytes_comes_back(void)
{
    char name[30], row[300];
    bench_small(&config, "1.5");
    set("block2.kind", "column");
    set("block2.loops", config.loop[0].name);
    for (unsigned i = 1; i <= 128; i++) {
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
    IS(in_force(), "block2.stage.128", "64,63,62,61,60,59,58,57");
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
    const struct gmv_settings *s = config_record(&config, 0);
    TEST_ASSERT_EQUAL_FLOAT_ARRAY(allowed, s->table[0], 3);
    memset(at + 8, 0xFF, 4); /* no number */
    TEST_ASSERT_FALSE(record_take(&r, &p, &config));
    r.size = 12; /* another number of columns */
    TEST_ASSERT_FALSE(record_take(&r, &p, &config));
    r.type = STORAGE_FLOAT;
    r.size = 8;
    TEST_ASSERT_FALSE(record_take(&r, &p, &config));
    TEST_ASSERT_EQUAL_FLOAT_ARRAY(allowed, s->table[0], 3);
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

/* ---- at random ---- */

static void random_sets_keep_the_pool_in_order_and_come_back(void)
{
    static const char *const words[] = {
        "-",   "gmv",     "column", "weights", "pid",
        "1",   "0.5",     "1,2,3",  "3,3,3",   "off",
        "on",  "bottom",  "a,b",    "1,2",     "plus,plus,minus,minus",
        "1e9", "mystery", "",       "7",       "0,0,0"};
    static const char *const fields[] = {"kind",   "kind",    "loops",   "inputs",  "points",
                                         "lambda", "table.1", "order",   "order.1", "order.2",
                                         "adapt",  "signs.1", "table.3", "stage.9"};
    struct random_source random = {.state = 11};
    char name[40];
    unsigned taken = 0;
    printf("seed %u\n", 11u);
    bench_boot();
    plant_of_images(&config);
    for (unsigned i = 0; i < 4000; i++) {
        static struct config before;
        before = config;
        snprintf(name, sizeof name, "block%u.%s", 1u + random_below(&random, CONFIG_BLOCKS),
                 fields[random_below(&random, sizeof fields / sizeof fields[0])]);
        enum err err = try_set(name, words[random_below(&random, sizeof words / sizeof words[0])]);
        if (err)
            TEST_ASSERT_EQUAL_MEMORY(&before, &config, sizeof config);
        else
            taken++;
        pool_is_packed(&config);
    }
    TEST_ASSERT_TRUE(taken > 400);
    static struct config loaded;
    const char *reason;
    *service_stage(&fw.service) = config;
    fw.service.plan[fw.service.newest].config = config;
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    TEST_ASSERT_EQUAL(ERR_OK, storage_load(&fw.storage, &loaded, &reason));
    TEST_ASSERT_EQUAL_MEMORY(&config, &loaded, sizeof config);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_kind_begins_with_its_defaults);
    RUN_TEST(what_is_set_is_in_the_record);
    RUN_TEST(what_is_no_value_is_refused_and_nothing_changes);
    RUN_TEST(records_of_other_blocks_move_and_keep_their_values);
    RUN_TEST(the_same_kind_again_changes_nothing_and_none_leaves_nothing);
    RUN_TEST(a_full_pool_says_how_many_bytes_are_needed);
    RUN_TEST(the_settings_of_a_block_that_had_no_room_are_all_changes);
    RUN_TEST(every_parameter_of_a_block_is_found_by_name_and_id);
    RUN_TEST(a_kept_image_with_a_block_is_read_in_any_order);
    RUN_TEST(parameters_of_newer_firmware_are_carried_over_by_every_save);
    RUN_TEST(a_block_of_an_unknown_kind_is_told_and_carried_over_by_every_save);
    RUN_TEST(parameters_of_an_unknown_kind_cannot_be_set);
    RUN_TEST(a_block_of_another_kind_takes_nothing_along);
    RUN_TEST(a_table_pasted_by_half_is_refused_and_nothing_of_it_is_in_force);
    RUN_TEST(a_table_of_four_kilobytes_comes_back);
    RUN_TEST(stored_rows_are_clipped_or_left_out_and_told);
    RUN_TEST(a_cut_leaves_the_old_kind_or_the_new_one_whole);
    RUN_TEST(random_sets_keep_the_pool_in_order_and_come_back);
    return UNITY_END();
}
