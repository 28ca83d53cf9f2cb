/* Guards a promise to programs and people that read the console: no word, line or unit of a listing changes unless somebody decides it.
 * The tools parse these listings (tools/reflux/commission), and operators know them by heart.
 *
 * Compares every listing in many states of the board with tests/reference/listings.txt, words to the letter and numbers within a
 * thousandth. Where a change is meant, read the difference before you commit it:
 *
 *     (cd tests; ../build/host/tests/loop/test_transcript --write reference/listings.txt)
 *
 * Results of a start-up are kept as the float build has them. The rest is the same in both formats. */
#include "commission_wood_berry.h"
#include "hal/retained.h"
#include "transcript.h"

#define KEPT "reference/listings.txt"
#define ADVICE                                                                                     \
    "A difference that is meant: write the file anew with a float build, then read its diff:\n"    \
    "    (cd tests; ../build/host/tests/loop/test_transcript --write " KEPT ")"

static size_t begun;
static const char *title;
static bool writing;

void setUp(void) {}
void tearDown(void) {}

/* ---- recording ---- */

static void part(const char *of)
{
    title = of;
    transcript_add("== %s\n", of);
    begun = transcript_n;
}

/* The version goes on by itself, and the name of the format is that of the build. */
static void masked(const char *line)
{
    if (strncmp(line, "reflux ", 7) == 0)
        line = strstr(line, ", plant link version") ? "reflux (version, board, numbers)" : line;
    transcript_add("%s\n", line);
}

/* Commands and what each says, its `ok` or `err` as well. */
static void record(const char *const *commands)
{
    for (; *commands; commands++) {
        transcript_add("> %s\n", *commands);
        (void)ask(*commands);
        for (unsigned i = 0; i < n_reply; i++)
            masked(reply[i]);
    }
}

#define RECORD(...) record((const char *const[]){__VA_ARGS__, NULL})

static void quietly(const char *const *commands)
{
    for (; *commands; commands++)
        ask_ok(*commands);
}

#define QUIETLY(...) quietly((const char *const[]){__VA_ARGS__, NULL})

/* Whoever holds off the tick lets it go on, and at no time twice: a board's lock does not count. */
static unsigned held;

static void hold(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, held++, "the tick is held off twice");
}

static void let_go(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(1, held--, "the tick is let go, and was not held off");
}

static void is_as_kept(void)
{
    TEST_ASSERT_EQUAL_MESSAGE(0, held, "the tick is held off for good");
    if (!writing)
        transcript_compare(title, begun);
}

/* ---- the board ---- */

#define LOOKS                                                                                      \
    "status", "loop", "alarm", "seq", "seq list", "events", "stats", "diff", "diff defaults"

static void a_board_without_settings_lists_what_it_is(void)
{
    part("a board without settings");
    power_on();
    pass(6000);
    RECORD("version", "help", LOOKS, "list", "dump", "load", "commission");
    is_as_kept();
}

/* One of each group, and of each type of value. */
static void parameters_are_shown_with_value_unit_and_range(void)
{
    part("parameters");
    running();
    RECORD("list", "list meas2", "list loop2.", "get meas1.unit", "get mv2.safe", "get console.key",
           "get config.schema", "help meas1.name", "help meas1.unit", "help mv1.rate",
           "help loop1.action", "help loop1.gain", "help alarm1.limit", "help lock1.limit",
           "help step1.timeout", "help ff1.gain", "help decouple1.d1", "help decouple1.d2",
           "help config.schema", "help console.key", "help tick.base", "help test.rounds",
           "help pair1.gain", "help sp", "help help", "help nothing", "get nothing",
           "get loop99.gain", "list nothing", "set loop1.gain 1e9", "set loop1.gain -1e9",
           "set loop1.gain x", "set meas1.unit kilograms/hour", "set meas1.unit a,b",
           "set loop1.name a-b", "set loop1.action sideways", "set config.schema 1",
           "set loop1.pv nobody");
    is_as_kept();
}

static void a_transaction_is_shown_beside_what_is_in_force(void)
{
    part("a transaction");
    running();
    RECORD("begin", "begin", "set loop2.gain 2.5", "set meas2.lo 80", "set loop1.name upper",
           "set loop1.action reverse", "diff", "status", "save", "load", "abandon", "diff",
           "abandon", "apply", "begin", "set loop2.out upper", "set loop1.out bottom", "apply",
           "abandon", "begin", "set meas1.lo 160", "apply", "abandon");
    is_as_kept();
}

static void a_running_board_is_listed_in_every_state(void)
{
    part("a running board");
    running();
    QUIETLY("begin", "set alarm1.on T10", "set alarm1.limit 120", "set lock2.meas T10",
            "set lock2.mv heat", "set lock2.limit 140", "set lock2.value 0", "set meas4.name lost",
            "set meas4.unit bar", "apply");
    samples(1);
    QUIETLY("mode bottom auto", "sp bottom 112.5");
    samples(5);
    RECORD(LOOKS, "loop bottom", "loop top", "loop nobody");
    board.values[1] = 145;
    samples(2);
    RECORD("status", "alarm", "loop bottom");
    board.quality[0] = 2;
    board.values[1] = 110;
    samples(62);
    RECORD("status", "alarm", "alarm ack all", "alarm shelve T10.hi 60", "alarm",
           "alarm ack nobody", "alarm shelve T10.hi 0", "alarm shelve T10.hi", "events");
    board.with_readback = true;
    board.readback[1] = 1.5;
    samples(3);
    board.mute = true;
    pass(4000);
    RECORD("status", "alarm", "loop", "stats");
    is_as_kept();
}

static void what_is_asked_in_vain_is_refused_in_words(void)
{
    part("refusals");
    running();
    RECORD("mode", "mode bottom", "mode bottom sideways", "mode nobody auto", "mode bottom cascade",
           "sp nobody 1", "sp bottom", "sp bottom x", "sp bottom 1e9", "out bottom 5",
           "out nobody 1", "out reflux 1", "mode bottom auto", "out bottom 1", "out heat 1", "log",
           "log maybe", "log on 0", "log on x", "log on 1000001", "log on 1 2", "save now",
           "unlock x", "key", "key a-b", "key -", "seq start", "seq nothing", "commission nothing",
           "commission relay", "commission relay nobody", "commission begin",
           "tune bottom simc 0 1 1", "tune bottom simc 1 -1 1", "tune bottom simc 1 1 0",
           "tune bottom best 1 1 1", "tune nobody simc 1 1 1", "frobnicate", "list a b",
           "events all", "reboot now");
    is_as_kept();
}

static void a_key_locks_what_an_operator_may_not_do(void)
{
    part("access");
    running();
    RECORD("key pot_still", "status", "version", "lock", "status", "set loop1.gain 2", "begin",
           "save", "load", "defaults", "key other", "reboot", "get console.key", "unlock wrong",
           "unlock pot_still", "unlock pot_still", "key -", "lock", "status");
    samples(1);
    RECORD("events");
    is_as_kept();
}

static void stored_settings_are_told_over_resets(void)
{
    part("storage and resets");
    memory_port_erase_all();
    running();
    RECORD("save", "version");
    QUIETLY("set loop2.gain 2");
    samples(1);
    RECORD("diff", "save", "defaults");
    samples(1);
    RECORD("load");
    samples(1);
    RECORD("get loop2.gain", "events");
    board_resets(HAL_RESET_WATCHDOG);
    samples(3);
    RECORD("version", "events", "get loop2.gain");
    type("reboot\n");
    board.ready = false;
    board_run();
    type("mode machine\n");
    pass(1000);
    samples(2);
    RECORD("version", "status", "events");
    for (unsigned n = 0; n < 4; n++)
        memory_port_reset(HAL_RESET_WATCHDOG);
    board.ready = false;
    type("mode machine\n");
    pass(6000);
    RECORD("version", "status", "alarm", "save");
    pass(1000);
    samples(3);
    RECORD("version", "status", "alarm", "events", "save", "load", "save", "version");
    memory_port_erase_all();
    board.mute = true;
    memory_port_start();
    board.clock_ms = 0;
    type("mode machine\n");
    RECORD("version");
    is_as_kept();
}

static void an_event_cut_by_a_reset_is_listed_as_damaged_and_no_other(void)
{
    part("an event cut by a reset");
    running();
    uint8_t *kept = hal_retained(HAL_RETAINED_EVENTS, HAL_RETAINED_EVENTS_BYTES);
    TEST_ASSERT_NOT_NULL(kept);
    RECORD("events");
    kept[2 * 32 + 4] ^= 1u; /* of the third, by its size in hal/retained.h */
    RECORD("events");
    board_resets(HAL_RESET_PIN);
    RECORD("events");
    is_as_kept();
}

static void what_is_left_of_a_fault_is_told(void)
{
    struct hal_fault f = {.pc = 0x08001234,
                          .lr = 0x0800ABCD,
                          .psr = 0x21000000,
                          .status = 0x00008200,
                          .hard = 0x40000000,
                          .address = 0x20030000,
                          .up_ms = 987654321,
                          .boots_ago = 3};
    part("faults");
    power_on();
    for (f.exception = 2; f.exception <= 7; f.exception++) {
        f.in_tick = f.exception % 2 != 0;
        memory_port_set_fault(&f);
        RECORD("version");
    }
    memory_port_set_fault(NULL);
    is_as_kept();
}

static void a_damaged_image_and_worn_settings_are_told(void)
{
    part("damage");
    memory_port_erase_all();
    running();
    QUIETLY("save");
    uint8_t *flash = memory_port_flash();
    for (size_t i = 16; i < memory_port_flash_size(); i++)
        if (flash[i] != 0xFF && flash[i] != flash[0])
            flash[i] &= 0x55;
    memory_port_set_image(HAL_IMAGE_DAMAGED);
    memory_port_start();
    board.clock_ms = 0;
    board.mute = true;
    type("mode machine\n");
    pass(8000);
    RECORD("version", "status", "alarm", "events", "save", "save replace", "alarm");
    memory_port_set_image(HAL_IMAGE_NO_CHECKSUM);
    memory_port_erase_all();
    is_as_kept();
}

/* ---- sequences ---- */

static void rows_of_a_sequence_are_listed_as_they_are_done(void)
{
    part("a sequence");
    running();
    QUIETLY("begin", "set meas3.name feed", "set meas3.unit l/h", "set meas3.hi 8",
            "set meas3.offset 1", "set step1.seq start", "set step1.do guard",
            "set step1.until above", "set step1.meas feed", "set step1.limit 1",
            "set step1.hold 10", "set step2.seq start", "set step2.do out", "set step2.what heat",
            "set step2.value 0.9", "set step2.until above", "set step2.meas T10",
            "set step2.limit 120", "set step2.hold 3", "set step2.timeout 100",
            "set step3.seq start", "set step3.do offset_on", "set step3.what feed",
            "set step4.seq start", "set step4.until confirm", "set step4.timeout 50",
            "set step4.else hold", "set step5.seq start", "set step5.do auto",
            "set step5.what bottom", "set step6.seq start", "set step6.do sp",
            "set step6.what bottom", "set step6.value 118", "set step7.seq stop",
            "set step7.do out", "set step7.what heat", "set step7.value 0", "apply");
    samples(1);
    RECORD("seq", "seq list", "seq go", "seq confirm", "seq skip", "seq hold");
    QUIETLY("seq start");
    samples(3);
    RECORD("seq", "seq list", "seq start", "commission begin", "status");
    board.values[1] = 125;
    samples(6);
    RECORD("seq", "status", "seq confirm");
    samples(3);
    RECORD("seq", "loop");
    board.values[1] = 110;
    samples(1);
    QUIETLY("seq stop");
    samples(3);
    QUIETLY("seq start");
    samples(3);
    RECORD("seq abort", "seq abort");
    samples(2);
    RECORD("seq");
    samples(3);
    QUIETLY("seq start");
    board.values[1] = 125;
    samples(65); /* nobody confirms */
    RECORD("seq", "alarm", "seq go", "seq stop");
    samples(3);
    RECORD("seq", "events");
    is_as_kept();
}

/* ---- automatic start-up: numbers of the float build ---- */

#ifndef REFLUX_FIXED_POINT

#define FOUND                                                                                      \
    "commission", "commission plan", "commission model", "commission gains", "commission pairing", \
        "commission structure", "commission proposal", "commission trial", "commission relay"

static void a_start_up_is_listed_from_its_plan_to_its_trial(void)
{
    part("start-up of Wood and Berry's column");
    wood_berry(NULL);
    RECORD("commission plant", FOUND, "commission begin", "commission begin");
    plant_step();
    RECORD("commission", "commission pause");
    plant_step();
    RECORD("commission", "commission resume", "commission accept");
    until("TEST_STEP R", 300);
    plant_steps(20);
    RECORD(FOUND);
    until("TEST_STEP S", 3000);
    plant_steps(20);
    RECORD(FOUND);
    until("PROPOSAL", 3000);
    RECORD(FOUND, "commission edit", "diff", "abandon", "commission accept");
    until("SETPOINT", 400);
    plant_steps(20);
    RECORD(FOUND, "save", "status");
    until("TRIAL_KEPT", 4000);
    RECORD(FOUND, "loop", "diff defaults", "events");
    is_as_kept();
}

static void structured(const char *plant_file, uint32_t tick_ms, const char *of)
{
    part(of);
    commission_plant(plant_file, tick_ms, 0.0, NULL);
    QUIETLY("commission begin");
    until("PROPOSAL", 12000);
    RECORD("commission plant", FOUND, "commission edit", "diff", "abandon");
    is_as_kept();
}

static void a_cascade_is_listed_with_its_inner_loop(void)
{
    structured("loop/data/cascade.json", 2000, "start-up of a cascade");
}

static void a_triangular_plant_is_listed_with_its_ways(void)
{
    structured("loop/data/triangular.json", 2000, "start-up of a triangular plant");
}

static void what_cannot_be_determined_is_listed_with_its_reasons(void)
{
    static const char *const once[] = {"set test.rounds 1", NULL};
    part("start-up of a paper machine");
    commission_plant("paper-machine", 1000, 0.0, once);
    QUIETLY("commission begin");
    until("NOT_DETERMINED", 12000);
    RECORD(FOUND, "commission accept", "commission edit", "events");
    is_as_kept();
}

static void a_relay_test_is_listed_while_it_runs_and_after(void)
{
    part("a relay test");
    wood_berry(NULL);
    QUIETLY("commission relay old_R");
    until("TEST_STEP R", 300);
    plant_steps(12);
    RECORD(FOUND);
    until("RELAY_DONE old_R", 1000);
    RECORD(FOUND, "commission edit", "diff", "abandon", "commission accept");
    until("TRIAL_KEPT", 4000);
    RECORD(FOUND, "events");
    is_as_kept();
}

#endif

int main(int argc, char **argv)
{
    writing = argc == 3 && strcmp(argv[1], "--write") == 0;
    if (!writing && !transcript_read(KEPT)) {
        printf("%s cannot be read; it is found from tests/\n", KEPT);
        return 1;
    }
    transcript_add(
        "## Promise: no word, line or unit of a listing changes unless somebody decides it\n");
    memory_port_set_tick_lock(hold, let_go);
    UNITY_BEGIN();
    RUN_TEST(a_board_without_settings_lists_what_it_is);
    RUN_TEST(parameters_are_shown_with_value_unit_and_range);
    RUN_TEST(a_transaction_is_shown_beside_what_is_in_force);
    RUN_TEST(a_running_board_is_listed_in_every_state);
    RUN_TEST(what_is_asked_in_vain_is_refused_in_words);
    RUN_TEST(a_key_locks_what_an_operator_may_not_do);
    RUN_TEST(stored_settings_are_told_over_resets);
    RUN_TEST(an_event_cut_by_a_reset_is_listed_as_damaged_and_no_other);
    RUN_TEST(what_is_left_of_a_fault_is_told);
    RUN_TEST(a_damaged_image_and_worn_settings_are_told);
    RUN_TEST(rows_of_a_sequence_are_listed_as_they_are_done);
#ifndef REFLUX_FIXED_POINT
    RUN_TEST(a_start_up_is_listed_from_its_plan_to_its_trial);
    RUN_TEST(a_cascade_is_listed_with_its_inner_loop);
    RUN_TEST(a_triangular_plant_is_listed_with_its_ways);
    RUN_TEST(what_cannot_be_determined_is_listed_with_its_reasons);
    RUN_TEST(a_relay_test_is_listed_while_it_runs_and_after);
#endif
    int failed = UNITY_END();
    if (failed && !writing)
        puts(ADVICE);
    return writing && !transcript_write(argv[2]) ? 1 : failed;
}
