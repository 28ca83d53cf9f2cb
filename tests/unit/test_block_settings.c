/* Settings of blocks: records in the pool. What becomes of them in storage: test_block_stored.c. */
#include "block_settings_bench.h"
#include "random_source.h"
#include "settings/block_pool.h"

/* ---- records in the pool ---- */

/* One behind the other in the order of the blocks, nothing behind them. */
static void pool_is_packed(const struct config *c)
{
    uint32_t at = 0;
    for (unsigned n = 0; n < CONFIG_BLOCKS; n++) {
        TEST_ASSERT_EQUAL(c->block[n].bytes ? at : 0, c->block[n].offset);
        at += c->block[n].bytes;
    }
    for (; at < CONFIG_POOL_BYTES; at++)
        TEST_ASSERT_EQUAL(0, c->pool[at]);
}

static void a_kind_begins_with_its_defaults(void)
{
    set("block2.kind", "gmv");
    const struct gmv_settings *s = config_block_settings(&config, 1);
    TEST_ASSERT_NOT_NULL(s);
    TEST_ASSERT_EQUAL_FLOAT(0.1f, s->lambda);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, s->table[2][2]);
    TEST_ASSERT_EQUAL(2, s->order);
    TEST_ASSERT_EQUAL(1, s->adapt);
    IS(&config, "block2.table.3", "0,0,0");
    TEST_ASSERT_NULL(config_block_settings(&config, 0));
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
    const struct gmv_settings *s = config_block_settings(&config, 1);
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

static void a_row_with_a_value_for_each_loop_needs_those_of_the_loops_there_are(void)
{
    set("block1.kind", "weights");
    TEST_ASSERT_EQUAL(ERR_PARSE, try_set("block1.order.1", "5"));
    set("block1.loops", "top,bottom");
    set("block1.order.1", "5,6");
    IS(&config, "block1.order.1", "5,6,2");
    set("block1.order.1", "1,3,4");
    set("block1.loops", "top");
    set("block1.order.1", "8");
    IS(&config, "block1.order.1", "8,3,4");
    static const char *const bad[] = {"", "9", "8,", "8,9", "8,3,4,5", "8,x"};
    for (unsigned i = 0; i < sizeof bad / sizeof bad[0]; i++)
        TEST_ASSERT_NOT_EQUAL_MESSAGE(ERR_OK, try_set("block1.order.1", bad[i]), bad[i]);
    TEST_ASSERT_EQUAL(ERR_PARSE, try_set("block1.signs.1", "minus")); /* not of the loops */
    IS(&config, "block1.order.1", "8,3,4");
}

static void records_of_other_blocks_move_and_keep_their_values(void)
{
    static struct config direct;
    set("block1.kind", "column");
    set("block2.kind", "gmv");
    set("block4.kind", "weights");
    set("block1.stage.48", "1,2,3,4,5,6,7,8");
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
    /* Nor what another kind had in the same place: not in the bytes between parameters either. */
    static struct config direct;
    set("block2.kind", "gmv");
    direct = config;
    set("block2.kind", "column");
    for (unsigned i = 0; i < sizeof(struct gmv_settings) / 32 + 1; i++) {
        char name[20];
        snprintf(name, sizeof name, "block2.stage.%u", i + 1);
        set(name, "-1.1,-1.1,-1.1,-1.1,-1.1,-1.1,-1.1,-1.1");
    }
    set("block2.kind", "gmv");
    TEST_ASSERT_EQUAL_MEMORY(&direct, &config, sizeof config);
    /* A set may name a block's kind twice. */
    TEST_ASSERT_FALSE(record_restore(&config, 1, "mystery"));
    TEST_ASSERT_NULL(config_block_settings(&config, 1));
    TEST_ASSERT_EQUAL(0, config.block[1].bytes);
    pool_is_packed(&config);
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
    TEST_ASSERT_EQUAL(1536, needed);
    TEST_ASSERT_EQUAL(CONFIG_POOL_BYTES - 1536u - sizeof(struct gmv_settings), room);
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
        of_blocks += parameter_id(&p) >> 24 != 0;
    }
    TEST_ASSERT_EQUAL(n, parameter_count(&config));
    TEST_ASSERT_EQUAL(4 + 48 + 4 + 1 + 3 + 1 + 1 + 4 + 2 + 1 + 1, of_blocks);
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
    RUN_TEST(a_row_with_a_value_for_each_loop_needs_those_of_the_loops_there_are);
    RUN_TEST(records_of_other_blocks_move_and_keep_their_values);
    RUN_TEST(the_same_kind_again_changes_nothing_and_none_leaves_nothing);
    RUN_TEST(a_full_pool_says_how_many_bytes_are_needed);
    RUN_TEST(the_settings_of_a_block_that_had_no_room_are_all_changes);
    RUN_TEST(every_parameter_of_a_block_is_found_by_name_and_id);
    RUN_TEST(random_sets_keep_the_pool_in_order_and_come_back);
    return UNITY_END();
}
