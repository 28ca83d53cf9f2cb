/* Guards the promise of docs/inside/commissioning.md that a start-up is the same run on every processor and in every build: the same
 * events in the same ticks, the same results, the same end. A number that depends on the compiler, the optimiser or the machine, or a
 * job that is taken in another tick, moves a line.
 *
 * The lines are each event with its tick, subject and value, and every listing at the end: Wood and Berry's column with and without noise
 * and with settings that ask for every way of testing, ways to end before the time, relay tests, and other plants of the library. The
 * other tests of automatic start-up check how right the numbers are.
 *
 * Kept in reference/commission_float.txt and, for fixed-point controllers, commission_fixed.txt; support/kept_transcript.h says how to
 * write them anew. */
#include "commission_wood_berry.h"
#include "kept_transcript.h"

void setUp(void) {}
void tearDown(void) {}

#ifdef REFLUX_FIXED_POINT
#define SCALAR "fixed"
#else
#define SCALAR "float"
#endif

#define SETTINGS 12

struct start_up {
    const char *name, *plant, *command; /* plant NULL: wood-berry with its two old loops */
    const char *settings[SETTINGS];
    double noise;
    const char *event;            /* of the plant, `tick` ticks after the command */
    const char *typed;            /* by a hand, then */
    unsigned tick, lost;          /* lost: samples from then on */
    const char *in_acceptance[2]; /* events of the plant once it is on trial */
    bool accepted;                /* and the proposal tried */
};

/* The events since. */
static void says_events(unsigned tick)
{
    char *line = board.said;
    for (char *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        *end = '\0';
        if (line[0] == '!')
            kept_line("%u %s", tick, line);
    }
    board_forget();
}

static void says_answer(const char *command)
{
    ask(command);
    kept_line("> %s", command);
    for (unsigned i = 0; i < n_reply; i++)
        kept_line("%s", reply[i]);
    board_forget();
}

/* Ended, one way or the other: no test, no trial, no working out. */
static bool is_over(void)
{
    static const char *const ways[] = {"phase idle", "phase ended",    "phase ready",
                                       "phase kept", "phase returned", "phase paused"};
    ask("commission");
    for (unsigned i = 0; i < sizeof ways / sizeof ways[0]; i++)
        if (strncmp(reply[0], ways[i], strlen(ways[i])) == 0)
            return true;
    return false;
}

/* Until it is over; the phase is looked at now and then, for the first time after two ticks. */
static void goes_on(const struct start_up *s, unsigned most)
{
    for (unsigned tick = 0; tick < most; tick++) {
        if (tick == s->tick && s->event)
            plant_event(s->event);
        if (tick == s->tick && s->typed)
            says_answer(s->typed);
        if (s->lost > 0 && tick == s->tick) {
            board.time_ms += (uint64_t)s->lost * board.tick_ms;
            board.number += s->lost;
        }
        plant_step();
        says_events(tick);
        if (tick % 16 == 2) {
            if (is_over())
                break;
            board_forget();
        }
    }
    board_forget();
}

static void runs(const struct start_up *s)
{
    static const char *const listings[] = {
        "commission",          "commission plan",    "commission model",
        "commission gains",    "commission pairing", "commission structure",
        "commission proposal", "commission relay",   "commission trial"};
    kept_line("# %s", s->name);
    if (s->plant)
        commission_plant(s->plant, 1000, s->noise, s->settings);
    else if (s->noise > 0)
        commission_plant("wood-berry", TICK_MS, s->noise, s->settings);
    else
        wood_berry(s->settings);
    says_answer(s->command);
    goes_on(s, 20000);
    for (unsigned i = 0; i < sizeof listings / sizeof listings[0]; i++)
        says_answer(listings[i]);
    if (!s->accepted)
        return;
    static const struct start_up nothing = {.tick = 1000000};
    says_answer("commission accept");
    for (unsigned i = 0; i < 2 && s->in_acceptance[i]; i++) {
        plant_steps(2);
        plant_event(s->in_acceptance[i]);
    }
    goes_on(&nothing, 6000);
    says_answer("commission");
    says_answer("commission trial");
}

static const struct start_up cases[] = {
    {"as it comes", .command = "commission begin", .accepted = true},
    {"with noise", .command = "commission begin", .noise = 1, .accepted = true},
    {"a valve that hangs on trial", .command = "commission begin",
     .in_acceptance = {"R.readback=2", "R.stuck=1.95"}, .accepted = true},
    {"a sluggish valve on trial", .command = "commission begin",
     .in_acceptance = {"S.readback=2", "S.lag=20000"}, .accepted = true},
    {"a disturbance on trial", .command = "commission begin", .in_acceptance = {"xB.bias=12"},
     .accepted = true},
    {"a measurement lost on trial", .command = "commission begin",
     .in_acceptance = {"xB.quality=3"}, .accepted = true},
    {"with much noise, two rounds", .command = "commission begin",
     .settings = {"set test.rounds 2"}, .noise = 8},
    {"amplitudes and times that are set", .command = "commission begin",
     .settings = {"set mv1.test_step 0.2", "set mv2.test_time 1800", "set test.window 40"}},
    {"pairs that are known", .command = "commission begin",
     .settings = {"set pair1.meas xB", "set pair1.mv S", "set pair1.gain 10", "set pair1.time 1000",
                  "set pair2.meas xD", "set pair2.mv R", "set pair2.time 300"}},
    {"the second input first, three limits narrower", .command = "commission begin",
     .settings = {"set mv2.test_critical on", "set meas1.test_limit 0.8",
                  "set meas2.test_limit 1"}},
    {"limits too narrow for a step", .command = "commission begin",
     .settings = {"set mv1.test_step 0.4", "set meas2.test_limit 0.3"}},
    {"the line's guard", .command = "commission begin",
     .settings = {"set mv1.test_step 0.4", "set meas1.test_limit 2", "set test.guard line"}},
    {"halves that are too short", .command = "commission begin",
     .settings = {"set test.longest 5400", "set test.rounds 1"}},
    {"halves that are much too short", .command = "commission begin",
     .settings = {"set test.longest 3660", "set test.rounds 3"}},
    {"an abort", .command = "commission begin", .typed = "commission abort", .tick = 120},
    {"a hand", .command = "commission begin", .typed = "out old_R 2.1", .tick = 120},
    {"a pause", .command = "commission begin", .typed = "commission pause", .tick = 120},
    {"an input skipped", .command = "commission begin", .typed = "commission skip", .tick = 120},
    {"an input again", .command = "commission begin", .typed = "commission repeat", .tick = 420},
    {"another configuration", .command = "commission begin", .typed = "set loop1.gain 0.7",
     .tick = 120},
    {"a measurement lost", .command = "commission begin", .event = "xD.quality=3", .tick = 120},
    {"a measurement offset", .command = "commission begin", .event = "xB.bias=9", .tick = 120},
    {"three samples lost", .command = "commission begin", .lost = 3, .tick = 120},
    {"eight samples lost", .command = "commission begin", .settings = {"set tick.miss_limit 1000"},
     .lost = 8, .tick = 120},
    {"nine samples lost", .command = "commission begin", .settings = {"set tick.miss_limit 1000"},
     .lost = 9, .tick = 120},
    {"twenty samples lost", .command = "commission begin", .settings = {"set tick.miss_limit 1000"},
     .lost = 20, .tick = 120},
    {"a relay on the first loop", .command = "commission relay old_R", .accepted = true},
    {"a relay on the second loop", .command = "commission relay old_S", .accepted = true},
    {"a relay's loop on a valve that hangs", .command = "commission relay old_R",
     .in_acceptance = {"R.readback=2", "R.stuck=1.95"}, .accepted = true},
    {"a relay of a given step", .command = "commission relay old_R",
     .settings = {"set mv1.test_step 0.3", "set test.noise 40"}},
    {"a relay past a limit", .command = "commission relay old_R",
     .settings = {"set mv1.test_step 0.4", "set meas2.test_limit 0.05"}},
    {"a relay without an answer", .command = "commission relay old_R",
     .settings = {"set mv1.test_step 0.0001", "set test.longest 9000"}},
    {"a relay of the wrong action", .command = "commission relay old_R",
     .settings = {"set loop1.action direct", "set test.longest 12000"}},
    {"a relay and lost samples", .command = "commission relay old_R", .lost = 5, .tick = 60},
    {"a relay and many lost samples", .command = "commission relay old_R",
     .settings = {"set tick.miss_limit 1000"}, .lost = 12, .tick = 60},
    {"a relay and a hand", .command = "commission relay old_R", .typed = "out old_R 2.1",
     .tick = 60},
    {"a relay and nine lost samples", .command = "commission relay old_R",
     .settings = {"set tick.miss_limit 1000"}, .lost = 9, .tick = 60},
    {"Siddha's rig", .plant = "siddha-rig", .command = "commission begin",
     .settings = {"set test.rounds 1"}},
    {"a furnace", .plant = "furnace", .command = "commission begin",
     .settings = {"set test.rounds 1"}},
    {"Luyben and Vinante's column", .plant = "luyben-vinante", .command = "commission begin",
     .settings = {"set test.rounds 2"}},
    {"a packed bed", .plant = "packed-bed", .command = "commission begin",
     .settings = {"set test.rounds 1", "set test.longest 4000"}},
    {"a paper machine", .plant = "paper-machine", .command = "commission begin",
     .settings = {"set test.rounds 1"}},
};

#define CASES (sizeof cases / sizeof cases[0])

static void what_automatic_start_up_says_is_what_was_kept(void)
{
    kept_open("reference/commission_" SCALAR ".txt",
              "a start-up is the same run on every processor and in every build");
    for (unsigned i = 0; i < CASES; i++)
        runs(&cases[i]);
    kept_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_automatic_start_up_says_is_what_was_kept);
    int failed = UNITY_END();
    plant_power_off();
    plant_library_free();
    return failed;
}
