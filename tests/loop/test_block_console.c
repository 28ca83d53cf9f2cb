/* Settings of blocks at the console: shown, set, refused, pasted. */
#include "board_bench.h"
#include "made_up_kinds.h"

void setUp(void)
{
    running();
}
void tearDown(void) {}

static void an_empty_block_shows_only_its_kind(void)
{
    ANSWERS("list block2", "block2.kind = -");
    ANSWERS("get block2.kind", "block2.kind = -");
    ask_refused("set block2.loops top", "STATE");
    TEST_ASSERT_TRUE(said("the block has no kind; set that first"));
    ask_refused("get block2.lambda", "UNKNOWN");
    TEST_ASSERT_TRUE(said("lacks the kind"));
}

static void a_block_is_set_and_shown_like_everything_else(void)
{
    ask_ok("begin");
    ask_ok("set block2.kind gmv");
    ask_ok("set block2.loops top,bottom");
    ask_ok("set block2.lambda 0.4");
    ask_ok("set block2.table.1 1,0,0");
    ask_ok("set block2.table.2 0,1,0");
    ask_ok("set block2.table.3 0.5,0.3,0.1");
    ANSWERS("diff", "set block2.kind gmv", "set block2.loops top,bottom", "set block2.lambda 0.4",
            "set block2.table.1 1,0,0", "set block2.table.2 0,1,0",
            "set block2.table.3 0.5,0.3,0.1");
    ANSWERS("list block2", "block2.kind = gmv", "block2.loops = top,bottom", "block2.inputs = -",
            "block2.points = -", "block2.lambda = 0.4 fraction", "block2.table.1 = 1,0,0 -",
            "block2.table.2 = 0,1,0 -", "block2.table.3 = 0.5,0.3,0.1 -", "block2.order = 2 -",
            "block2.adapt = on");
    ANSWERS("get block2.table.3", "block2.table.3 = 0.5,0.3,0.1 -");
    ANSWERS("help block2.lambda", "block2.lambda = 0.4 fraction", "  weight of the moves",
            "  allowed: 0 .. 10 fraction", "  default: 0.1  id: 0x10410001");
    ANSWERS("help block2.table.3", "block2.table.3 = 0.5,0.3,0.1 -", "  a matrix",
            "  allowed: 3 with commas between them, each -1000 .. 1000 -",
            "  default: 0,0,0  id: 0x10420081");
    ANSWERS("help block2.kind", "block2.kind = gmv",
            "  kind of the block, which has parameters of its own; - = unused",
            "  allowed: gmv|column|weights|-", "  default: -  id: 0x10010001");
    ask_ok("abandon");
    ANSWERS("list block2", "block2.kind = -");
}

static void refusals_say_what_would_be_right(void)
{
    ask_ok("begin");
    ask_refused("set block2.kind gmvx", "UNKNOWN");
    TEST_ASSERT_TRUE(said("block2.kind: 'gmvx' refused, allowed: gmv|column|weights|-"));
    ask_ok("set block1.kind column");
    ask_refused("set block2.kind column", "FULL");
    TEST_ASSERT_TRUE(said("block2.kind: 'column' refused, bytes needed: 1536, there are: 512"));
    ask_ok("set block2.kind gmv");
    ask_refused("set block2.lambda 11", "RANGE");
    TEST_ASSERT_TRUE(said("block2.lambda: '11' refused, allowed: 0 .. 10 fraction"));
    ask_refused("set block2.table.3 1,2", "PARSE");
    TEST_ASSERT_TRUE(said("allowed: 3 with commas between them, each -1000 .. 1000 -"));
    ask_refused("set block2.adapt maybe", "PARSE");
    TEST_ASSERT_TRUE(said("allowed: off|on"));
    ask_refused("set block2.loops top,", "PARSE");
    TEST_ASSERT_TRUE(said("names with commas between them, up to 47 characters, - for none"));
    ask_refused("set block2.inputs T1,T10,T1", "CONFLICT");
    TEST_ASSERT_TRUE(said("block2.inputs: 'T1,T10,T1' refused, a name stands in it twice"));
    ask_ok("set block2.inputs T1,T10");
    ask_refused("set block2.weight 1", "UNKNOWN");
    ask_ok("abandon");
}

static void everything_of_a_block_is_in_the_dump_which_can_be_pasted(void)
{
    static char lines[REPLY_MAX][250];
    static char before[SAID_MAX];
    ask_ok("begin");
    ask_ok("set block3.kind weights");
    ask_ok("set block3.order.2 3,4,5");
    ask_ok("set block3.signs.1 minus,plus,minus,plus");
    ask_ok("dump");
    unsigned n = 0;
    for (; n + 1 < n_reply; n++)
        snprintf(lines[n], sizeof lines[n], "%s", reply[n]);
    TEST_ASSERT_TRUE(said("set block3.order.2 3,4,5"));
    ask_ok("list");
    memcpy(before, board.said, board.n_said + 1);
    ask_ok("abandon");
    for (unsigned i = 0; i + 1 < n; i++) /* all but `apply` */
        ask_ok(lines[i]);
    ask_ok("list");
    TEST_ASSERT_EQUAL_STRING(before, board.said);
    ask_ok("abandon");
}

/* Nine digits and an exponent in every column: what `dump` prints, the line editor takes. */
static void the_longest_row_is_shown_whole_and_can_be_pasted(void)
{
    char name[40], row[400] = "", line[480];
    snprintf(name, sizeof name, "block4.%s.%u", column_parameters[0].name,
             (unsigned)column_parameters[0].rows);
    for (unsigned k = 0; k < column_parameters[0].cols; k++)
        snprintf(row + strlen(row), sizeof row - strlen(row), "%s-1.2345678%ue-33", k ? "," : "",
                 k % 9 + 1);
    ask_ok("begin");
    ask_ok("set block4.kind column");
    ask_ok("set block4.loops top");
    snprintf(line, sizeof line, "set %s %s", name, row);
    ask_ok(line);
    snprintf(line, sizeof line, "get %s", name);
    ask_ok(line);
    snprintf(row, sizeof row, "%s", reply[0] + strlen(name) + 3);
    TEST_ASSERT_EQUAL_STRING(" -", row + strlen(row) - 2);
    row[strlen(row) - 2] = '\0';
    TEST_ASSERT_TRUE(strlen(row) > (size_t)14 * column_parameters[0].cols);
    snprintf(line, sizeof line, "set %s %s", name, row);
    ask_ok("dump");
    TEST_ASSERT_TRUE(said(line));
    ask_ok("diff");
    TEST_ASSERT_TRUE(said(line));
    ask_ok(line);
    ask_ok("dump");
    TEST_ASSERT_TRUE(said(line));
    ask_ok("abandon");
}

/* ---- a paste that is cut off ---- */

static void paste_a_table(unsigned rows)
{
    static const char *const table[] = {"1,0,0", "0,1,0", "0.5,0.3,0.1"};
    char line[60];
    ask_ok("begin");
    ask_ok("set block2.kind gmv");
    ask_ok("set block2.loops top,bottom");
    for (unsigned i = 0; i < rows; i++) {
        snprintf(line, sizeof line, "set block2.table.%u %s", i + 1, table[i]);
        ask_ok(line);
    }
}

static void half_a_table_is_refused_until_it_is_whole(void)
{
    for (unsigned rows = 0; rows < 3; rows++) {
        paste_a_table(rows);
        ask_refused("apply", "RANGE");
        TEST_ASSERT_TRUE(said("block2.table: 'gmv' a matrix whose diagonal has no 0"));
        ask_ok("abandon");
        ANSWERS("list block2", "block2.kind = -");
    }
    paste_a_table(3);
    ask_ok("apply");
}

static void half_a_table_is_gone_after_a_restart(void)
{
    static char before[SAID_MAX];
    ask_ok("save");
    ask_ok("dump");
    memcpy(before, board.said, board.n_said + 1);
    for (unsigned rows = 0; rows <= 3; rows++) {
        paste_a_table(rows);
        type("set block2.table.3 0.5,0."); /* the line as well is cut off */
        power_on();
        pass(3000);
        ask_ok("dump");
        TEST_ASSERT_EQUAL_STRING(before, board.said);
        ANSWERS("list block2", "block2.kind = -");
    }
}

/* One row did not arrive: the others are as good as none. */
static void a_row_that_is_lost_is_noticed(void)
{
    ask_ok("begin");
    ask_ok("set block2.kind gmv");
    ask_ok("set block2.loops top,bottom");
    ask_ok("set block2.table.1 1,0,0");
    ask_refused("set block2.table.2 0,1", "PARSE");
    ask_ok("set block2.table.3 0.5,0.3,0.1");
    ask_refused("apply", "RANGE");
    ask_ok("set block2.table.2 0,1,0");
    ask_ok("apply");
    ANSWERS("get block2.table.2", "block2.table.2 = 0,1,0 -");
}

/* ---- a kind that this build lacks ---- */

static void start_with_image(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, STORAGE_IMAGES "/%s.bin", name);
    FILE *file = fopen(path, "rb");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    memory_port_erase_all();
    TEST_ASSERT_TRUE(fread(memory_port_flash(), 1, memory_port_flash_size(), file) > 0);
    fclose(file);
    power_on();
    pass(3000);
}

static void a_dump_with_an_unknown_kind_can_be_pasted(void)
{
    static char lines[REPLY_MAX][250];
    start_with_image("block_unknown");
    ANSWERS("get block3.kind", "block3.kind = mystery unknown");
    ask_ok("dump");
    TEST_ASSERT_TRUE(said("\n# set block3.kind mystery\n"));
    TEST_ASSERT_TRUE(said("\n# set block3.loops bottom\n"));
    unsigned n = n_reply - 1;
    for (unsigned i = 0; i < n; i++)
        snprintf(lines[i], sizeof lines[i], "%s", reply[i]);
    for (unsigned i = 0; i < n; i++)
        if (lines[i][0] != '#')
            ask_ok(lines[i]);
    ANSWERS("get block3.kind", "block3.kind = -");
    ANSWERS("get loop1.name", "loop1.name = bottom");
}

static void a_loop_of_an_unknown_kind_cannot_leave_manual(void)
{
    start_with_image("block_unknown");
    ask_refused("mode bottom auto", "UNSUPPORTED");
    TEST_ASSERT_TRUE(said("bottom: is served by a block whose kind this build lacks"));
    ask_refused("out bottom 1", "STATE"); /* that it may: there is no plant */
    ask_ok("set block3.kind -");
    ask_refused("mode bottom auto", "STATE");
}

static void completes(const char *begun, const char *whole)
{
    board_forget();
    type("\x15");
    type(begun);
    type("\t");
    TEST_ASSERT_TRUE_MESSAGE(said(whole), begun);
}

static void names_and_values_are_completed(void)
{
    ask_ok("begin");
    ask_ok("set block2.kind gmv");
    type("mode human\n");
    completes("set block2.la", "block2.lambda");
    completes("set block2.ta", "block2.table.1");
    completes("set block2.kind co", "set block2.kind column");
    completes("set block2.adapt of", "set block2.adapt off");
    completes("set block2.loops bo", "set block2.loops bottom");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_empty_block_shows_only_its_kind);
    RUN_TEST(a_block_is_set_and_shown_like_everything_else);
    RUN_TEST(refusals_say_what_would_be_right);
    RUN_TEST(everything_of_a_block_is_in_the_dump_which_can_be_pasted);
    RUN_TEST(the_longest_row_is_shown_whole_and_can_be_pasted);
    RUN_TEST(half_a_table_is_refused_until_it_is_whole);
    RUN_TEST(half_a_table_is_gone_after_a_restart);
    RUN_TEST(a_row_that_is_lost_is_noticed);
    RUN_TEST(a_dump_with_an_unknown_kind_can_be_pasted);
    RUN_TEST(a_loop_of_an_unknown_kind_cannot_leave_manual);
    RUN_TEST(names_and_values_are_completed);
    return UNITY_END();
}
