/* The compact table of a column: made on the host, pasted at the console of the whole firmware, printed back, stored, shared,
 * refused. */
#include "pasted_table.h"

static struct table_lines splitter, pilot;

void setUp(void)
{
    memory_port_erase_all();
    if (!splitter.size) {
        splitter_table(&splitter);
        pilot_table(&pilot);
    }
    running();
}

void tearDown(void) {}

static void pasted_at_work(const struct table_lines *lines, unsigned block)
{
    paste(lines, block);
    samples(1);
}

/* ---- there and back ---- */

static void is_on_the_board(const struct table_lines *lines, unsigned block)
{
    char *text = text_of(lines, block), *save = NULL, *all = dumped();
    strtok_r(text, "\n", &save); /* begin, and what makes room for it */
    strtok_r(NULL, "\n", &save);
    for (char *line = strtok_r(NULL, "\n", &save); line; line = strtok_r(NULL, "\n", &save))
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(all, line), line);
    free(text);
    free(all);
}

static void what_the_host_makes_the_board_prints_back_to_the_letter(void)
{
    pasted_at_work(&splitter, 2);
    is_on_the_board(&splitter, 2);
    pasted_at_work(&pilot, 2);
    is_on_the_board(&pilot, 2);
}

static void the_board_says_what_the_table_says(void)
{
    pasted_at_work(&splitter, 2);
    ask_ok("block 2");
    TEST_ASSERT_TRUE(said("block2 column on"));
    TEST_ASSERT_TRUE(said("  table of splitter = 163"));
    TEST_ASSERT_TRUE(said("  stages = 37"));
    TEST_ASSERT_TRUE(said("  feed_stage = 19"));
    TEST_ASSERT_TRUE(said("  states = 57"));
    TEST_ASSERT_TRUE(said("  feed of "));
    TEST_ASSERT_EQUAL(3, times_said("  feed of "));
}

static void what_dump_prints_makes_the_same_table_on_another_board(void)
{
    pasted_at_work(&splitter, 2);
    char *all = dumped(), *save = NULL, *copy = strdup(all);
    memory_port_erase_all();
    power_on();
    for (char *line = strtok_r(copy, "\n", &save); line && strcmp(line, "ok") != 0;
         line = strtok_r(NULL, "\n", &save))
        ask_ok(line);
    char *again = dumped();
    TEST_ASSERT_EQUAL_STRING(all, again);
    free(all);
    free(copy);
    free(again);
}

static void saved_it_is_there_after_a_restart(void)
{
    pasted_at_work(&splitter, 2);
    char *before = dumped();
    ask_ok("save");
    power_on();
    pass(2500);
    TEST_ASSERT_TRUE(said("STORAGE_LOADED"));
    char *after = dumped();
    TEST_ASSERT_EQUAL_STRING(before, after);
    free(before);
    free(after);
}

static void a_loop_goes_on_in_auto_after_a_reset_beside_a_table(void)
{
    pasted_at_work(&splitter, 2);
    pasted_at_work(&pilot, 2); /* in the other place than after a start */
    ask_ok("set restart.policy resume");
    samples(1);
    ask_ok("save");
    ask_ok("mode bottom auto");
    samples(30);
    memory_port_reset(HAL_RESET_WATCHDOG);
    board.ready = false;
    board_run();
    type("mode machine\n");
    board_forget();
    pass(1000);
    sample_after(1000);
    samples(3);
    TEST_ASSERT_TRUE(said("RESTART_DONE"));
    ask_ok("loop");
    TEST_ASSERT_TRUE(said("bottom auto"));
}

/* ---- refused, with the table that was there in force ---- */

static void is_refused(const struct table_lines *lines, unsigned most, const char *words)
{
    char *before = dumped();
    paste_lines(lines, 2, most);
    const char *end = ask("apply");
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(end, words), end);
    samples(2);
    ask_ok("abandon");
    char *after = dumped();
    TEST_ASSERT_EQUAL_STRING(before, after);
    free(before);
    free(after);
    ask_ok("block 2");
    TEST_ASSERT_TRUE(said("table of splitter"));
}

/* Lines of a host that computes the checksum of whatever it is given. */
static struct table_lines wrong_at(unsigned place, float value)
{
    struct table_lines lines = splitter;
    lines.value[place] = value;
    table_close(&lines, lines.size);
    return lines;
}

static void what_is_wrong_is_refused_in_words_and_the_old_table_stays(void)
{
    pasted_at_work(&splitter, 2);
    struct table_lines lines = splitter;
    lines.version = 2;
    is_refused(&lines, UINT32_MAX, "err VERSION block2.version: 'column' must be 1, of a table");
    lines = splitter;
    lines.size = 400;
    is_refused(&lines, 10,
               "block2.size: 'column' must be the number of values, at most those of 40");
    lines = splitter;
    lines.checksum[1] ^= 1u;
    is_refused(&lines, UINT32_MAX, "err CRC block2.checksum: 'column' must be that of version");
    lines = splitter;
    lines.value[100] = lines.value[100] + 1.0f;
    is_refused(&lines, UINT32_MAX, "err CRC block2.checksum");
    lines = wrong_at(COLUMN_TABLE_EFFICIENCY, 1.5f);
    is_refused(&lines, UINT32_MAX, "err RANGE block2.efficiency: 'column' must be 0.01 to 1");
    lines = wrong_at(COLUMN_TABLE_N_STAGES, 41.0f);
    is_refused(&lines, UINT32_MAX, "err RANGE block2.stages: 'column' must be 4 to 40");
    lines = wrong_at(COLUMN_TABLE_FEED_STAGE, 36.0f);
    is_refused(&lines, UINT32_MAX, "block2.feed_stage: 'column' must be 2 to stages - 2");
}

static void pasted_by_half_it_is_refused_and_can_be_completed(void)
{
    pasted_at_work(&splitter, 2);
    is_refused(&splitter, 3, "err VERSION block2.version");
    is_refused(&splitter, 12, "err CRC block2.checksum");
    paste_lines(&pilot, 2, 10);
    ask_refused("apply", "CRC");
    ask_ok("abandon");
    paste(&pilot, 2);
    samples(1);
    is_on_the_board(&pilot, 2);
}

static void a_value_that_is_none_is_refused_at_its_line(void)
{
    pasted_at_work(&splitter, 2);
    ask_ok("begin");
    ask_refused("set block2.value.3 1,2,nan,4,5,6,7,8", "PARSE");
    ask_refused("set block2.value.3 1,2,3,4,5,6,7", "PARSE");
    ask_refused("set block2.value.3 1,2,1e31,4,5,6,7,8", "RANGE");
    ask_refused("set block2.value.36 1,2,3,4,5,6,7,8", "UNKNOWN");
    ask_refused("set block2.checksum.1 65536,0", "RANGE");
    ask_ok("apply");
    is_on_the_board(&splitter, 2);
    ask_refused("set block2.value.3 1,2,3,4,5,6,7,8", "CRC"); /* a single line makes no table */
    is_on_the_board(&splitter, 2);
}

/* ---- one at work, another staged ---- */

static void while_one_is_at_work_another_is_pasted_and_applied(void)
{
    pasted_at_work(&splitter, 2);
    ask_ok("mode bottom auto");
    paste_lines(&pilot, 2, UINT32_MAX);
    samples(3);
    ask_ok("block 2");
    TEST_ASSERT_TRUE(said("table of splitter"));
    ask_ok("apply");
    samples(1);
    ask_ok("block 2");
    TEST_ASSERT_TRUE(said("table of pilot"));
    is_on_the_board(&pilot, 2);
    ask_ok("loop");
    TEST_ASSERT_TRUE(said("bottom auto"));
}

static void one_line_written_in_a_transaction_leaves_the_table_in_force_alone(void)
{
    pasted_at_work(&splitter, 2);
    ask_ok("begin");
    ask_ok("set block2.value.1 1,2,3,4,5,6,7,8");
    samples(2);
    ANSWERS("diff", "set block2.value.1 1,2,3,4,5,6,7,8");
    ask_ok("abandon");
    is_on_the_board(&splitter, 2);
    for (unsigned i = 0; i < 5; i++) { /* what was given up takes no place */
        ask_ok("begin");
        ask_ok("set block2.value.1 1,2,3,4,5,6,7,8");
        ask_ok("abandon");
    }
    pasted_at_work(&pilot, 2);
    is_on_the_board(&pilot, 2);
}

static void a_third_table_is_refused_in_words_that_say_how_to_get_room(void)
{
    pasted_at_work(&splitter, 2);
    pasted_at_work(&pilot, 3);
    is_on_the_board(&splitter, 2);
    is_on_the_board(&pilot, 3);
    char *before = dumped();
    ask_ok("begin");
    ask_refused("set block4.kind column", "FULL");
    TEST_ASSERT_TRUE(said("block4.kind: no place for another table"));
    TEST_ASSERT_TRUE(said("set the kind of a block that has one to -, apply, then paste"));
    ask_refused("set block2.value.1 1,2,3,4,5,6,7,8", "FULL");
    TEST_ASSERT_TRUE(said("block2.value.1: no place for another table"));
    ask_refused("set block2.version 3", "FULL");
    ask_ok("apply");
    char *after = dumped();
    TEST_ASSERT_EQUAL_STRING(before, after);
    free(before);
    free(after);
    /* as it says: */
    ask_ok("set block3.kind -");
    samples(1);
    pasted_at_work(&pilot, 4);
    is_on_the_board(&pilot, 4);
    is_on_the_board(&splitter, 2);
}

static void two_tables_are_saved_and_come_back_and_load_says_when_it_has_no_room(void)
{
    pasted_at_work(&splitter, 2);
    pasted_at_work(&pilot, 3);
    ask_ok("save");
    char *before = dumped();
    ask_refused("load", "FULL");
    TEST_ASSERT_TRUE(said("not loaded: no place for another table"));
    samples(1);
    char *after = dumped();
    TEST_ASSERT_EQUAL_STRING(before, after);
    power_on();
    pass(2500);
    free(after);
    after = dumped();
    TEST_ASSERT_EQUAL_STRING(before, after);
    free(before);
    free(after);
}

static void with_one_table_load_and_defaults_replace_it_and_abandon_keeps_it(void)
{
    pasted_at_work(&splitter, 2);
    ask_ok("save");
    for (unsigned i = 0; i < 3; i++) {
        ask_ok("load");
        samples(1);
        is_on_the_board(&splitter, 2);
    }
    pasted_at_work(&pilot, 2);
    ask_ok("begin");
    ask_ok("load");
    is_on_the_board(&splitter, 2); /* as staged */
    ask_ok("abandon");
    is_on_the_board(&pilot, 2);
    ask_ok("load");
    samples(1);
    is_on_the_board(&splitter, 2);
    ask_ok("defaults");
    samples(1);
    ask_ok("list block2");
    TEST_ASSERT_TRUE(said("block2.kind = -"));
}

static void a_block_of_another_kind_gives_the_place_of_its_table_back(void)
{
    for (unsigned i = 0; i < 4; i++) {
        pasted_at_work(i & 1 ? &pilot : &splitter, 1u + i);
        is_on_the_board(i & 1 ? &pilot : &splitter, 1u + i);
        char line[40];
        snprintf(line, sizeof line, "set block%u.kind -", 1u + i);
        ask_ok(line);
        samples(1);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_the_host_makes_the_board_prints_back_to_the_letter);
    RUN_TEST(the_board_says_what_the_table_says);
    RUN_TEST(what_dump_prints_makes_the_same_table_on_another_board);
    RUN_TEST(saved_it_is_there_after_a_restart);
    RUN_TEST(a_loop_goes_on_in_auto_after_a_reset_beside_a_table);
    RUN_TEST(what_is_wrong_is_refused_in_words_and_the_old_table_stays);
    RUN_TEST(pasted_by_half_it_is_refused_and_can_be_completed);
    RUN_TEST(a_value_that_is_none_is_refused_at_its_line);
    RUN_TEST(while_one_is_at_work_another_is_pasted_and_applied);
    RUN_TEST(one_line_written_in_a_transaction_leaves_the_table_in_force_alone);
    RUN_TEST(a_third_table_is_refused_in_words_that_say_how_to_get_room);
    RUN_TEST(two_tables_are_saved_and_come_back_and_load_says_when_it_has_no_room);
    RUN_TEST(with_one_table_load_and_defaults_replace_it_and_abandon_keeps_it);
    RUN_TEST(a_block_of_another_kind_gives_the_place_of_its_table_back);
    plant_library_free();
    return UNITY_END();
}
