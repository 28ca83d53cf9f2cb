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

/* ---- leases that are renewed ---- */

static uint32_t number;

static enum err lease_for_now(uint32_t bytes)
{
    void *memory = NULL;
    enum err err =
        workspace_lease_for_now(&w, "composition", "block N free", bytes, &number, &memory);
    TEST_ASSERT_EQUAL_PTR(err ? NULL : (void *)region, memory);
    return err;
}

static void ticks(unsigned n)
{
    while (n-- > 0)
        workspace_tick(&w);
}

static void a_lease_that_is_renewed_lasts(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, lease_for_now(sizeof region));
    for (unsigned n = 0; n < 1000; n++) {
        ticks(WORKSPACE_TICKS);
        TEST_ASSERT_TRUE(workspace_renew(&w, number));
    }
    TEST_ASSERT_EQUAL(ERR_BUSY, lease("start-up", "commission abort", 100));
    TEST_ASSERT_EQUAL_STRING("composition has it; `block N free` frees it", refusal());
}

static void one_that_is_not_renewed_ends_after_its_ticks(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, lease_for_now(100));
    ticks(WORKSPACE_TICKS);
    TEST_ASSERT_EQUAL(ERR_BUSY, lease("start-up", "commission abort", 100));
    ticks(1);
    TEST_ASSERT_FALSE(workspace_renew(&w, number));
    TEST_ASSERT_EQUAL(ERR_OK, lease("start-up", "commission abort", 100));
    TEST_ASSERT_FALSE(workspace_holds(&w, "composition"));
}

static void of_two_of_one_kind_the_number_tells_which_has_it(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, lease_for_now(100));
    uint32_t first = number;
    TEST_ASSERT_EQUAL(ERR_BUSY, lease_for_now(100));
    workspace_end(&w, first);
    TEST_ASSERT_EQUAL(ERR_OK, lease_for_now(100));
    TEST_ASSERT_FALSE(first == number);
    TEST_ASSERT_FALSE(workspace_renew(&w, first));
    TEST_ASSERT_TRUE(workspace_renew(&w, number));
    workspace_end(&w, first); /* comes too late to matter */
    TEST_ASSERT_TRUE(workspace_renew(&w, number));
    workspace_end(&w, number);
    TEST_ASSERT_FALSE(workspace_renew(&w, number));
}

static void who_was_slow_does_not_find_it_again_after_another(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, lease_for_now(100));
    ticks(WORKSPACE_TICKS + 1);
    TEST_ASSERT_EQUAL(ERR_OK, lease("start-up", "commission abort", 100));
    TEST_ASSERT_FALSE(workspace_renew(&w, number));
    workspace_end(&w, number);
    ticks(10 * WORKSPACE_TICKS); /* that of start-up needs no renewal */
    TEST_ASSERT_EQUAL(ERR_BUSY, lease_for_now(100));
    TEST_ASSERT_EQUAL_STRING("start-up has it; `commission abort` frees it", refusal());
    workspace_frees(&w, "start-up", NULL);
    uint32_t before = number;
    TEST_ASSERT_FALSE(workspace_renew(&w, before));
    TEST_ASSERT_EQUAL(ERR_OK, lease_for_now(100));
    TEST_ASSERT_FALSE(workspace_renew(&w, before));
}

static void a_renewal_counts_from_its_tick_on(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, lease_for_now(100));
    ticks(WORKSPACE_TICKS);
    TEST_ASSERT_TRUE(workspace_renew(&w, number));
    ticks(WORKSPACE_TICKS);
    TEST_ASSERT_TRUE(workspace_renew(&w, number));
    ticks(WORKSPACE_TICKS + 1);
    TEST_ASSERT_FALSE(workspace_renew(&w, number));
}

static void one_begins_with_all_its_ticks_whatever_was_before(void)
{
    TEST_ASSERT_EQUAL(ERR_OK, lease_for_now(100));
    ticks(WORKSPACE_TICKS);
    workspace_end(&w, number);
    TEST_ASSERT_EQUAL(ERR_OK, lease_for_now(100));
    ticks(WORKSPACE_TICKS);
    TEST_ASSERT_TRUE(workspace_renew(&w, number));
}

static void one_for_now_that_has_no_room_leaves_nothing_behind(void)
{
    TEST_ASSERT_EQUAL(ERR_MEMORY, lease_for_now(sizeof region + 1u));
    TEST_ASSERT_FALSE(workspace_renew(&w, number));
    TEST_ASSERT_EQUAL(ERR_OK, lease("start-up", "commission abort", 100));
    ticks(10 * WORKSPACE_TICKS);
    TEST_ASSERT_EQUAL(ERR_BUSY, lease_for_now(100));
}

static void a_region_that_is_shared_is_found(void)
{
    workspace_share(&w);
    TEST_ASSERT_EQUAL_PTR(&w, workspace_shared());
    workspace_share(NULL);
    TEST_ASSERT_NULL(workspace_shared());
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
    RUN_TEST(a_lease_that_is_renewed_lasts);
    RUN_TEST(one_that_is_not_renewed_ends_after_its_ticks);
    RUN_TEST(of_two_of_one_kind_the_number_tells_which_has_it);
    RUN_TEST(who_was_slow_does_not_find_it_again_after_another);
    RUN_TEST(a_renewal_counts_from_its_tick_on);
    RUN_TEST(one_begins_with_all_its_ticks_whatever_was_before);
    RUN_TEST(one_for_now_that_has_no_room_leaves_nothing_behind);
    RUN_TEST(a_region_that_is_shared_is_found);
    return UNITY_END();
}
