/* Automatic start-up beside the table of a column: the settings that a trial may go back to keep their table, whatever is pasted
 * meanwhile. */
#include "commission_wood_berry.h"
#include "pasted_table.h"

static struct table_lines splitter, pilot;

void setUp(void)
{
    splitter_table(&splitter);
    pilot_table(&pilot);
    children_failed = 0;
}
void tearDown(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, children_failed, "cases of this test, see above");
}

static void has_table(const char *of)
{
    char line[40];
    ask_ok("block 2");
    snprintf(line, sizeof line, "table of %s =", of);
    TEST_ASSERT_TRUE_MESSAGE(said(line), board.said);
}

static void on_trial(void)
{
    ask_ok("commission accept");
    until("TRIAL_BEGUN", 5);
    plant_steps(5);
    TEST_ASSERT_TRUE(phase_is("trial"));
}

static void taken_back(void)
{
    ask_ok("commission abort");
    plant_steps(4);
    TEST_ASSERT_TRUE(phase_is("returned"));
    has_table("splitter");
    TEST_ASSERT_TRUE(settings_are_as_before());
}

static void a_trial_with_another_table_gives_the_old_one_back(void)
{
    ask_ok("commission edit");
    char *text = text_of(&pilot, 2), *save = NULL;
    strtok_r(text, "\n", &save); /* the transaction is open */
    for (char *line = strtok_r(NULL, "\n", &save); line && strcmp(line, "apply") != 0;
         line = strtok_r(NULL, "\n", &save))
        ask_ok(line);
    free(text);
    on_trial();
    has_table("pilot");
    /* Both places are taken: by what is on trial, and what it may go back to. */
    ask_ok("begin");
    ask_refused("set block2.value.1 1,2,3,4,5,6,7,8", "FULL");
    TEST_ASSERT_TRUE(said("start-up's way back"));
    ask_refused("set block3.kind column", "FULL");
    ask_ok("abandon");
    plant_steps(2);
    taken_back();
}

static void what_is_pasted_on_trial_and_abandoned_leaves_the_old_table(void)
{
    on_trial();
    has_table("splitter");
    paste_lines(&pilot, 2, UINT32_MAX);
    ask_ok("commission abort");
    plant_steps(3);
    has_table("splitter");
    ask_ok("abandon");
    plant_steps(3);
    has_table("splitter");
    TEST_ASSERT_TRUE(settings_are_as_before());
}

static void after_a_trial_the_place_is_free_again(void)
{
    on_trial();
    taken_back();
    paste(&pilot, 2);
    plant_step();
    paste(&splitter, 2);
    plant_step();
    paste(&pilot, 3);
    plant_step();
    has_table("splitter");
    ask_ok("block 3");
    TEST_ASSERT_TRUE(said("table of pilot ="));
}

static void the_way_back_of_a_trial_keeps_its_table(void)
{
    wood_berry(NULL);
    paste(&splitter, 2);
    plant_step();
    proposal();
    remember_settings();
    CASE(a_trial_with_another_table_gives_the_old_one_back);
    CASE(what_is_pasted_on_trial_and_abandoned_leaves_the_old_table);
    CASE(after_a_trial_the_place_is_free_again);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_way_back_of_a_trial_keeps_its_table);
    plant_library_free();
    return UNITY_END();
}
