/* The workspace between start-up and somebody else who asks for it, on the whole firmware. */
#include "app/app.h"
#include "base/workspace.h"
#include "commission_wood_berry.h"

#define OTHER      "covariances"
#define OTHER_ENDS "block est freeze"

static char expected[40000], found[40000], refusal[200];

void setUp(void)
{
    children_failed = 0;
}
void tearDown(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, children_failed, "cases of this test, see above");
}

/* The other gets it, and writes all over it what is no number. */
static bool other_leases(void)
{
    void *memory;
    struct workspace *w = app_workspace(app_instance());
    struct text t = text_on(refusal, sizeof refusal);
    if (workspace_lease(w, OTHER, OTHER_ENDS, w->bytes, &memory) == ERR_OK) {
        memset(memory, 0xFF, w->bytes);
        return true;
    }
    workspace_refusal(w, &t);
    return false;
}

static void other_is_done(void)
{
    workspace_frees(app_workspace(app_instance()), OTHER, NULL);
}

static void other_is_refused(const char *command)
{
    char wanted[100];
    snprintf(wanted, sizeof wanted, "start-up has it; `%s` frees it", command);
    TEST_ASSERT_FALSE(other_leases());
    TEST_ASSERT_EQUAL_STRING(wanted, refusal);
}

static void listed(char *text)
{
    static const char *const listings[] = {"commission model", "commission gains",
                                           "commission pairing", "commission structure",
                                           "commission proposal"};
    text[0] = '\0';
    for (unsigned k = 0; k < sizeof listings / sizeof listings[0]; k++) {
        ask_ok(listings[k]);
        for (unsigned i = 0; i < n_reply; i++)
            strcat(text, reply[i]);
    }
}

static void start_up_is_told_who_has_it(void)
{
    static const char refused[] =
        "err BUSY workspace: covariances has it; `block est freeze` frees it";
    wood_berry(NULL);
    TEST_ASSERT_TRUE(other_leases());
    TEST_ASSERT_EQUAL_STRING(refused, ask("commission begin"));
    TEST_ASSERT_EQUAL_STRING(refused, ask("commission relay old_R"));
    plant_steps(3);
    TEST_ASSERT_TRUE(phase_is("idle"));
    other_is_done();
    ask_ok("commission begin");
    plant_steps(3);
    TEST_ASSERT_TRUE(phase_is("testing"));
}

static void what_another_has_left_in_it_changes_no_result(void)
{
    wood_berry(NULL);
    proposal();
    listed(expected);
    wood_berry(NULL);
    TEST_ASSERT_TRUE(other_leases());
    other_is_done();
    proposal();
    listed(found);
    TEST_ASSERT_EQUAL_STRING(expected, found);
    ask_ok("commission accept");
    until("TRIAL_KEPT", 4000);
}

static void the_other_is_refused_from_the_asking_to_the_end_of_the_tests(void)
{
    wood_berry(NULL);
    ask_ok("commission begin");
    other_is_refused("commission abort");
    until("TEST_STEP R", 300);
    other_is_refused("commission abort");
    ask_refused("commission discard", "STATE");
    ask_ok("commission pause");
    plant_steps(2);
    other_is_refused("commission abort");
    ask_ok("commission abort");
    plant_step();
    TEST_ASSERT_TRUE(other_leases()); /* nothing has been found */
    ask_ok("commission model");
    TEST_ASSERT_TRUE(said("results discarded"));
}

static void a_beginning_that_is_called_off_frees_it(void)
{
    wood_berry(NULL);
    ask_ok("commission begin");
    other_is_refused("commission abort");
    ask_ok("commission abort");
    TEST_ASSERT_TRUE(other_leases());
}

static void a_part_of_a_model_must_have_been_looked_at(void)
{
    wood_berry(NULL);
    second_step();
    ask_ok("commission abort");
    plant_step();
    other_is_refused("commission discard");
    ask_ok("commission");
    other_is_refused("commission discard");
    ask_ok("commission model");
    TEST_ASSERT_TRUE(said("element xD R"));
    TEST_ASSERT_TRUE(other_leases());
    ask_ok("commission model");
    TEST_ASSERT_FALSE(said("element"));
    TEST_ASSERT_TRUE(said("results discarded"));
    ask_ok("commission advice");
    TEST_ASSERT_TRUE(said("results discarded"));
}

static void or_given_up(void)
{
    ask_ok("commission discard");
    TEST_ASSERT_TRUE(other_leases());
    ask_refused("commission discard", "STATE");
}

/* With a proposal that nobody has looked at. */
static void rejected_it_is_free(void)
{
    other_is_refused("commission reject");
    ask_refused("commission discard", "STATE");
    ask_ok("commission proposal");
    other_is_refused("commission reject"); /* it waits to be accepted all the same */
    ask_ok("commission reject");
    plant_step();
    ask_ok("commission pairing"); /* listed, as long as nobody wants its place */
    TEST_ASSERT_TRUE(said("pair xD R"));
    TEST_ASSERT_TRUE(other_leases());
    ask_ok("commission pairing");
    TEST_ASSERT_TRUE(said("results discarded"));
    ask_ok("commission structure");
    TEST_ASSERT_TRUE(said("results discarded"));
}

static void kept_unseen_it_is_held_until_it_is_looked_at_or_given_up(void)
{
    ask_ok("commission accept");
    until("TRIAL_BEGUN", 5);
    other_is_refused("commission abort");
    until("TRIAL_KEPT", 4000);
    other_is_refused("commission discard");
    CASE(or_given_up);
    ask_ok("commission gains");
    TEST_ASSERT_TRUE(other_leases());
    ask_ok("commission trial");
    TEST_ASSERT_TRUE(said("trial xD R step")); /* kept outside */
    ask_ok("commission proposal");
    TEST_ASSERT_TRUE(said("results discarded"));
    ask_refused("commission edit", "STATE");
    ask_refused("commission accept", "STATE");
}

static void the_way_back_keeps_it(void)
{
    ask_ok("commission proposal");
    ask_ok("commission accept");
    until("TRIAL_BEGUN", 5);
    ask_ok("begin");
    ask_ok("commission abort");
    plant_steps(3);
    TEST_ASSERT_TRUE(phase_is("returned"));
    other_is_refused("abandon"); /* the old settings are still in it */
    ask_ok("abandon");
    plant_steps(2);
    TEST_ASSERT_TRUE(settings_are_as_before());
    TEST_ASSERT_TRUE(other_leases());
    plant_steps(2);
    TEST_ASSERT_TRUE(settings_are_as_before());
    ask_ok("commission");
    TEST_ASSERT_TRUE(said("asked for"));
    ask_ok("commission trial");
    TEST_ASSERT_TRUE(said("trial xD R step"));
}

static void a_trial_called_off_before_it_begins_keeps_the_proposal(void)
{
    ask_ok("commission accept");
    ask_ok("commission abort");
    plant_steps(2);
    TEST_ASSERT_TRUE(settings_are_as_before());
    other_is_refused("commission reject");
    ask_ok("commission accept");
    until("TRIAL_BEGUN", 5);
}

/* Somebody else has had it since, and the beginning that leased it again was refused in the tick. */
static void what_has_made_room_does_not_come_back(void)
{
    ask_ok("commission reject");
    plant_step();
    TEST_ASSERT_TRUE(other_leases());
    other_is_done();
    ask_ok("commission begin");
    ask_ok("mode old_R auto");
    plant_step();
    TEST_ASSERT_TRUE(said("REQUEST_REFUSED"));
    ask_ok("commission pairing");
    TEST_ASSERT_TRUE(said("results discarded"));
    TEST_ASSERT_TRUE(other_leases());
}

static void what_is_begun_anew_goes_over_what_was_there(void)
{
    ask_ok("commission reject");
    plant_step();
    ask_ok("commission begin");
    until("TEST_STEP R", 300);
    other_is_refused("commission abort");
}

static void with_a_proposal(void)
{
    wood_berry(NULL);
    remember_settings();
    proposal();
    CASE(rejected_it_is_free);
    CASE(kept_unseen_it_is_held_until_it_is_looked_at_or_given_up);
    CASE(the_way_back_keeps_it);
    CASE(a_trial_called_off_before_it_begins_keeps_the_proposal);
    CASE(what_has_made_room_does_not_come_back);
    CASE(what_is_begun_anew_goes_over_what_was_there);
}

static void a_relay_test_is_kept_outside(void)
{
    wood_berry(NULL);
    ask_ok("commission relay old_R");
    until("RELAY_DONE", 3000);
    other_is_refused("commission reject");
    ask_ok("commission reject");
    plant_step();
    TEST_ASSERT_TRUE(other_leases());
    ask_ok("commission relay");
    TEST_ASSERT_TRUE(said("ultimate"));
}

static void a_reset_frees_it(void)
{
    wood_berry(NULL);
    second_step();
    board_resets(HAL_RESET_WATCHDOG);
    TEST_ASSERT_TRUE(phase_is("ended"));
    TEST_ASSERT_TRUE(other_leases());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(start_up_is_told_who_has_it);
    RUN_TEST(what_another_has_left_in_it_changes_no_result);
    RUN_TEST(the_other_is_refused_from_the_asking_to_the_end_of_the_tests);
    RUN_TEST(a_beginning_that_is_called_off_frees_it);
    RUN_TEST(a_part_of_a_model_must_have_been_looked_at);
    RUN_TEST(with_a_proposal);
    RUN_TEST(a_relay_test_is_kept_outside);
    RUN_TEST(a_reset_frees_it);
    return UNITY_END();
}
