/* Power is cut in saves of a table that takes the place of another: what a start finds is one of the two, whole, with everything
 * else that was set with it, and finds it again. */
#include "flash_cut.h"
#include "pasted_table.h"

static struct table_lines splitter, pilot;

void setUp(void)
{
    splitter_table(&splitter);
    pilot_table(&pilot);
}

void tearDown(void)
{
    flash_model_keep = NULL;
    flash_model_glance = NULL;
}

/* On, with what is stored, as `dump` prints it; free() it. */
static char *started(void)
{
    power_on();
    pass(2500);
    return dumped();
}

static void change_to_pilot(void)
{
    paste(&pilot, 2);
    ask_ok("set tick.miss_limit 7");
}

static void a_save_that_is_cut_leaves_one_table_or_the_other(void)
{
    static uint8_t image[sizeof flash_model];
    unsigned operations, old = 0, new = 0;
    memory_port_erase_all();
    power_on();
    configure();
    paste(&splitter, 2);
    ask_ok("save");
    char *before = started();
    memcpy(image, flash_model, sizeof image);
    cut_begin(1);
    change_to_pilot();
    ask_ok("save");
    operations = cut.operations;
    char *after = started();
    TEST_ASSERT_TRUE(strcmp(before, after) != 0);
    for (unsigned k = 0; k < operations; k++) {
        flash_model_keep = NULL;
        flash_model_glance = NULL;
        memcpy(flash_model, image, sizeof image);
        cut_begin(k + 2);
        free(started());
        change_to_pilot();
        cut.operations = 0;
        cut.left = k;
        type("save\n");
        cut_power_on();
        char *found = started();
        bool is_old = strcmp(found, before) == 0;
        TEST_ASSERT_TRUE_MESSAGE(is_old || strcmp(found, after) == 0, found);
        old += is_old;
        new += !is_old;
        cut_power_on();
        char *again = started();
        TEST_ASSERT_EQUAL_STRING(found, again);
        free(found);
        free(again);
    }
    printf("saves cut: %u of %u operations, %u find the table before, %u the new one\n", old + new,
           operations, old, new);
    TEST_ASSERT_TRUE(old > 0 && new > 0);
    free(before);
    free(after);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_save_that_is_cut_leaves_one_table_or_the_other);
    plant_library_free();
    return UNITY_END();
}
