/* What `commission` shows before anything is known, with a proposal, and after the trial. */
#include "commission_wood_berry.h"

void setUp(void) {}
void tearDown(void) {}

static void shows(const char *command, const char *const *words)
{
    ask_ok(command);
    for (; *words; words++)
        TEST_ASSERT_TRUE_MESSAGE(said(*words), *words);
}

#define SHOWS(command, ...) shows(command, (const char *const[]){__VA_ARGS__, NULL})

static void before_the_tests_there_is_nothing_but_the_plant(void)
{
    wood_berry(NULL);
    SHOWS("commission", "phase idle");
    SHOWS("commission plant", "plant tick s 60", "output xD unit %w lo 80 hi 112",
          "input R unit lb/min");
    /* 60 samples of a minute in all that is known least, 1000 at most, both inputs, 4 rounds; nothing has moved. */
    SHOWS("commission plan", "plan inputs 2 outputs 2 rounds 4 hours at least 10 at most 416",
          "input R held 1.95 step 0.08 at most 1 lb/min", "output xD limit 6.4 %w");
    ask_ok("commission model");
    TEST_ASSERT_FALSE(said("element"));
    SHOWS("commission gains", "nothing yet");
    SHOWS("commission pairing", "nothing yet");
    SHOWS("commission proposal", "nothing yet");
    ask_refused("commission nonsense", "PARSE");
    ask_refused("commission accept", "STATE");
    ask_refused("commission resume", "STATE");
}

static void a_proposal_is_shown_with_what_it_rests_on(void)
{
    SHOWS("commission begin", "plan inputs 2", "input R held 1.95 step 0.08", "output xB limit");
    until("TEST_STEP R", 300);
    SHOWS("commission", "phase testing", "input R (1 of 2), round 1: positive half");
    until("PROPOSAL", 3000);
    SHOWS("commission", "phase ready", "a proposal waits");
    SHOWS("commission model", "input R held 1.95", "output xD noise", "element xD R gain 12.",
          "element xB S gain -19.", "moments xD R");
    SHOWS("commission gains", "rank 2", "singular", "rga R S", "rga xD 2.0");
    SHOWS("commission pairing", "pairing determined", "pair xD R lambda 2.0", "pair xB S");
    SHOWS("commission structure", "block");
    SHOWS("commission proposal", "settings SIMC", "decoupler none", "loop xD R gain",
          "loop xB S gain");
}

static void a_trial_is_shown_beside_what_was_predicted(void)
{
    ask_ok("commission accept");
    until("TRIAL_BEGUN", 5);
    SHOWS("commission", "phase trial", "loop 1 of 2 on trial");
    until("TRIAL_KEPT", 4000);
    SHOWS("commission trial", "xD", "xB");
    SHOWS("commission", "phase kept");
}

static void what_cannot_be_told_is_shown_as_open(void)
{
    static const char *const once[] = {"set test.rounds 1", NULL};
    commission_plant("paper-machine", 1000, 0.0, once);
    ask_ok("commission begin");
    until("NOT_DETERMINED", 12000);
    SHOWS("commission", "no proposal");
    SHOWS("commission gains", "rank 4", "null inputs u1", "null outputs y1");
    SHOWS("commission pairing", "pairing not determined", "open y");
    SHOWS("commission proposal", "no proposal: pairing not determined");
    ask_ok("commission structure");
    ask_ok("commission model");
    ask_refused("commission accept", "STATE");
    ask_refused("commission edit", "STATE");
}

static void show(const char *c){ ask(c); printf("--- %s\n", c); for(unsigned i=0;i<n_reply;i++) printf("%s\n", reply[i]); }
static void probe(void)
{
    commission_plant("wood-berry", 60000, 0.0, NULL);
    ask_ok("commission begin");
    until("TEST_STEP R", 300); show("commission"); show("commission plan");
    until("PROPOSAL", 3000); show("events"); printf("number %u\n", board.number);
    show("commission"); show("commission plant"); show("commission plan"); show("commission model"); show("commission gains"); show("commission pairing"); show("commission structure"); show("commission proposal"); show("commission trial");
    show("commission edit"); show("diff"); ask("abandon");
    ask_ok("commission accept"); until("TRIAL_BEGUN",5); plant_steps(30); show("commission"); show("commission trial"); until("TRIAL_KEPT", 4000); show("commission trial"); show("commission");show("loop"); show("events");
    commission_plant("wood-berry", 60000, 1.0, NULL);
    ask_ok("commission begin");
    until("PROPOSAL", 3000);  show("commission model"); show("commission gains"); show("commission pairing"); show("commission proposal"); 
}
int main(void)
{
    UNITY_BEGIN(); RUN_TEST(probe);
    RUN_TEST(before_the_tests_there_is_nothing_but_the_plant);
    RUN_TEST(a_proposal_is_shown_with_what_it_rests_on);
    RUN_TEST(a_trial_is_shown_beside_what_was_predicted);
    RUN_TEST(what_cannot_be_told_is_shown_as_open);
    int failed = UNITY_END();
    plant_power_off();
    plant_library_free();
    return failed;
}
