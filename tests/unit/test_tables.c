/* Tables of blocks: in RAM once, whichever configurations refer to them, and none written that another has. The kind is the
 * firmware's own `column`; what is in a table is looked at by others. */
#include "exchange/tables.h"
#include "kinds/column/column.h"
#include "plan/plan_build.h"
#include "settings/block_pool.h"
#include "storage_bench.h"

static struct config first, second;

void setUp(void)
{
    tables_begin();
    parameters_defaults(&first);
    parameters_defaults(&second);
    tables_watch(TABLES_OF_PLAN, &first);
    tables_watch(TABLES_OF_OTHER_PLAN, &second);
}

void tearDown(void) {}

static enum err try_value(struct config *c, const char *name, const char *value)
{
    struct parameter p;
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find_in(c, name, &p));
    return parameter_set(&p, c, value);
}

static const struct column_record *record(const struct config *c, uint8_t n)
{
    return config_block_settings(c, n);
}

static void a_table_takes_nothing_of_the_pool(void)
{
    bench_set(&first, "block2.kind", "column");
    for (unsigned i = 0; i < CONFIG_POOL_BYTES; i++)
        TEST_ASSERT_EQUAL(0, first.pool[i]);
    TEST_ASSERT_TRUE(sizeof(struct column_record) <= CONFIG_TABLE_BYTES);
    TEST_ASSERT_EQUAL(2048, CONFIG_POOL_BYTES);
}

static void a_copy_has_the_same_table_until_one_of_them_is_written(void)
{
    bench_set(&first, "block2.kind", "column");
    bench_set(&first, "block2.version", "5");
    second = first;
    TEST_ASSERT_EQUAL_PTR(record(&first, 1), record(&second, 1));
    bench_set(&second, "block2.size", "100");
    TEST_ASSERT_NOT_EQUAL(record(&first, 1), record(&second, 1));
    TEST_ASSERT_EQUAL(5, record(&second, 1)->version);
    TEST_ASSERT_EQUAL(100, record(&second, 1)->size);
    TEST_ASSERT_EQUAL(0, record(&first, 1)->size);
    const struct column_record *own = record(&second, 1);
    bench_set(&second, "block2.value.3", "1,2,3,4,5,6,7,8"); /* it is its own by now */
    TEST_ASSERT_EQUAL_PTR(own, record(&second, 1));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, record(&first, 1)->value[18]);
    TEST_ASSERT_EQUAL_FLOAT(3.0f, own->value[18]);
}

static void every_way_to_write_leaves_the_other_alone(void)
{
    static const char *const ways[][2] = {{"block2.version", "7"},
                                          {"block2.checksum.1", "7,7"},
                                          {"block2.value.1", "7,7,7,7,7,7,7,7"}};
    bench_set(&first, "block2.kind", "column");
    struct column_record was = *record(&first, 1);
    for (unsigned i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        second = first;
        bench_set(&second, ways[i][0], ways[i][1]);
        TEST_ASSERT_EQUAL_MEMORY(&was, record(&first, 1), sizeof was);
    }
    second = first;
    struct parameter p;
    TEST_ASSERT_EQUAL(ERR_OK, parameter_find_in(&second, "block2.size", &p));
    TEST_ASSERT_EQUAL(ERR_OK, parameter_set_number(&p, &second, 9.0f));
    TEST_ASSERT_EQUAL(9, record(&second, 1)->size);
    TEST_ASSERT_EQUAL_MEMORY(&was, record(&first, 1), sizeof was);
}

static void equal_tables_are_the_same_once_more_and_others_are_not(void)
{
    bench_set(&first, "block2.kind", "column");
    bench_set(&first, "block2.version", "5");
    second = first;
    bench_set(&second, "block2.version", "6");
    tables_share(&second, &first);
    TEST_ASSERT_NOT_EQUAL(record(&first, 1), record(&second, 1));
    bench_set(&second, "block2.version", "5");
    TEST_ASSERT_NOT_EQUAL(record(&first, 1), record(&second, 1));
    tables_share(&second, &first);
    TEST_ASSERT_EQUAL_PTR(record(&first, 1), record(&second, 1));
}

static void two_blocks_that_share_one_are_parted_by_the_first_write(void)
{
    bench_set(&first, "block1.kind", "column");
    bench_set(&first, "block2.kind", "column");
    tables_share(&first, &first);
    TEST_ASSERT_EQUAL_PTR(record(&first, 0), record(&first, 1));
    bench_set(&first, "block2.version", "3");
    TEST_ASSERT_EQUAL(0, record(&first, 0)->version);
    TEST_ASSERT_EQUAL(3, record(&first, 1)->version);
}

static void what_somebody_may_go_back_to_is_kept(void)
{
    static struct config old;
    bench_set(&first, "block2.kind", "column");
    bench_set(&first, "block2.version", "5");
    old = first;
    tables_watch(TABLES_TO_GO_BACK_TO, &old);
    second = first;
    bench_set(&second, "block2.version", "6");
    first = second;
    TEST_ASSERT_EQUAL(5, record(&old, 1)->version);
    TEST_ASSERT_EQUAL(ERR_FULL, try_value(&second, "block2.version", "7"));
    TEST_ASSERT_EQUAL(6, record(&second, 1)->version);
    TEST_ASSERT_EQUAL(ERR_FULL, try_value(&second, "block3.kind", "column"));
    TEST_ASSERT_EQUAL(5, record(&old, 1)->version);
    tables_watch(TABLES_TO_GO_BACK_TO, NULL);
    bench_set(&second, "block2.version", "7");
    TEST_ASSERT_EQUAL(6, record(&first, 1)->version);
}

static void a_refused_table_changes_nothing(void)
{
    static struct config was;
    bench_set(&first, "block1.kind", "column");
    bench_set(&first, "block2.kind", "column");
    bench_set(&first, "block1.version", "3");
    was = first;
    TEST_ASSERT_EQUAL(ERR_FULL, try_value(&first, "block3.kind", "column"));
    TEST_ASSERT_EQUAL_MEMORY(&was, &first, sizeof was);
    TEST_ASSERT_FALSE(record_restore(&first, 2, "column")); /* as stored: kept by name */
    TEST_ASSERT_EQUAL_STRING("column", first.block[2].kind);
    TEST_ASSERT_NULL(config_block_settings(&first, 2));
    TEST_ASSERT_EQUAL(3, record(&first, 0)->version);
}

/* After a restart a table may stand elsewhere: a plan knows itself again by what is in it. */
static void a_plan_is_known_by_what_its_table_says_not_by_where_it_is(void)
{
    static struct plan a, b;
    struct config_fault fault;
    bench_set(&first, "block2.kind", "column");
    bench_set(&first, "block2.version", "1");
    second = first;
    bench_set(&second, "block2.version", "2");
    bench_set(&second, "block2.version", "1");
    TEST_ASSERT_NOT_EQUAL(record(&first, 1), record(&second, 1));
    (void)!plan_build(&a, &first, 1.0f, &fault);
    (void)!plan_build(&b, &second, 1.0f, &fault);
    TEST_ASSERT_EQUAL_HEX32(a.identity, b.identity);
    bench_set(&second, "block2.version", "2");
    (void)!plan_build(&b, &second, 1.0f, &fault);
    TEST_ASSERT_NOT_EQUAL(a.identity, b.identity);
}

static void records_in_the_pool_stay_packed_beside_tables(void)
{
    bench_set(&first, "block1.kind", "column");
    bench_set(&first, "block1.kind", "-");
    TEST_ASSERT_EQUAL(CONFIG_NO_TABLE, first.table[0]);
    TEST_ASSERT_EQUAL(CONFIG_TABLES, tables_free_for(&second));
    TEST_ASSERT_EQUAL_MEMORY(&second, &first, sizeof first);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_table_takes_nothing_of_the_pool);
    RUN_TEST(a_copy_has_the_same_table_until_one_of_them_is_written);
    RUN_TEST(every_way_to_write_leaves_the_other_alone);
    RUN_TEST(equal_tables_are_the_same_once_more_and_others_are_not);
    RUN_TEST(two_blocks_that_share_one_are_parted_by_the_first_write);
    RUN_TEST(what_somebody_may_go_back_to_is_kept);
    RUN_TEST(a_refused_table_changes_nothing);
    RUN_TEST(a_plan_is_known_by_what_its_table_says_not_by_where_it_is);
    RUN_TEST(records_in_the_pool_stay_packed_beside_tables);
    return UNITY_END();
}
