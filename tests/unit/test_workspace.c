/* The region that is leased by name. */
#include "base/workspace.h"

#include "unity.h"

static struct workspace w;
static uint64_t region[64];
static char said[120];

void setUp(void)
{
    workspace_init(&w, region, sizeof region);
}
void tearDown(void) {}

static enum err lease(const char *holder, const char *frees, uint32_t bytes)
{
    void *memory = NULL;
    enum err err = workspace_lease(&w, holder, frees, bytes, &memory);
    TEST_ASSERT_EQUAL_PTR(err ? NULL : (void *)region, memory);
    return err;
}

static const char *refusal(void)
{
    struct text t = text_on(said, sizeof said);
    workspace_refusal(&w, &t);
    return said;
}

static void nobody_holds_it_at_the_start(void)
{
    TEST_ASSERT_FALSE(workspace_holds(&w, "start-up"));
    TEST_ASSERT_EQUAL(ERR_OK, lease("start-up", "commission abort", sizeof region));
    TEST_ASSERT_TRUE(workspace_holds(&w, "start-up"));
}

static void of_two_who_ask_the_second_is_told_who_has_it_and_how_to_free_it(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, lease("start-up", "commission abort", 100));
    TEST_ASSERT_EQUAL(ERR_BUSY, lease("covariances", "block est freeze", 100));
    TEST_ASSERT_EQUAL_STRING("start-up has it; `commission abort` frees it", refusal());
    TEST_ASSERT_TRUE(workspace_holds(&w, "start-up"));
    TEST_ASSERT_FALSE(workspace_holds(&w, "covariances"));
}

static void the_command_goes_with_what_its_holder_does(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, lease("start-up", "commission abort", 100));
    workspace_frees(&w, "start-up", "commission reject");
    TEST_ASSERT_EQUAL(ERR_BUSY, lease("covariances", "block est freeze", 100));
    TEST_ASSERT_EQUAL_STRING("start-up has it; `commission reject` frees it", refusal());
}

static void nobody_ends_the_lease_of_another(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, lease("start-up", "commission abort", 100));
    workspace_frees(&w, "covariances", NULL);
    TEST_ASSERT_EQUAL(ERR_BUSY, lease("covariances", "block est freeze", 100));
}

static void what_is_left_by_a_lease_that_has_ended_is_its_holders_until_the_next(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, lease("start-up", "commission abort", 100));
    workspace_frees(&w, "start-up", NULL);
    TEST_ASSERT_TRUE(workspace_holds(&w, "start-up"));
    TEST_ASSERT_EQUAL(ERR_OK, lease("covariances", "block est freeze", 100));
    TEST_ASSERT_FALSE(workspace_holds(&w, "start-up"));
    workspace_frees(&w, "start-up", NULL); /* comes too late to matter */
    TEST_ASSERT_EQUAL(ERR_BUSY, lease("start-up", "commission abort", 100));
    TEST_ASSERT_EQUAL_STRING("covariances has it; `block est freeze` frees it", refusal());
}

static void who_holds_it_goes_on_with_it(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, lease("start-up", "commission discard", 100));
    TEST_ASSERT_EQUAL(ERR_OK, lease("start-up", "commission abort", 100));
    TEST_ASSERT_EQUAL(ERR_BUSY, lease("covariances", "block est freeze", 100));
    TEST_ASSERT_EQUAL_STRING("start-up has it; `commission abort` frees it", refusal());
}

static void more_than_the_board_has_is_refused_and_changes_nothing(void)
{
    TEST_ASSERT_EQUAL(ERR_MEMORY, lease("start-up", "commission abort", sizeof region + 1u));
    TEST_ASSERT_FALSE(workspace_holds(&w, "start-up"));
    TEST_ASSERT_EQUAL(ERR_OK, lease("covariances", "block est freeze", sizeof region));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(nobody_holds_it_at_the_start);
    RUN_TEST(of_two_who_ask_the_second_is_told_who_has_it_and_how_to_free_it);
    RUN_TEST(the_command_goes_with_what_its_holder_does);
    RUN_TEST(nobody_ends_the_lease_of_another);
    RUN_TEST(what_is_left_by_a_lease_that_has_ended_is_its_holders_until_the_next);
    RUN_TEST(who_holds_it_goes_on_with_it);
    RUN_TEST(more_than_the_board_has_is_refused_and_changes_nothing);
    return UNITY_END();
}
