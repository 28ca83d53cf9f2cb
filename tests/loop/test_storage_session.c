/* Stored settings as an operator meets them: save, load, defaults, dump, and a start with what was saved. */
#include "board_bench.h"
#include "flash_model.h"
#include "hal/identity.h"
#include "random_source.h"
#include "settings/parameters.h"

static bool take_no_write;

static bool keep(uint32_t address, uint32_t n)
{
    (void)address;
    (void)n;
    return !take_no_write;
}

void setUp(void)
{
    take_no_write = flash_model_supply_low = false;
    flash_model_keep = keep;
    memory_port_erase_all();
}

void tearDown(void) {}

/* `list all`, or any other reply, to compare. */
static char kept[SAID_MAX];

static void keep_reply(const char *command)
{
    ask_ok(command);
    kept[0] = '\0';
    size_t n = 0;
    for (unsigned i = 0; i + 1 < n_reply; i++)
        n += (size_t)snprintf(kept + n, sizeof kept - n, "%s\n", reply[i]);
}

static void expect_reply_again(const char *command)
{
    ask_ok(command);
    size_t n = 0;
    for (unsigned i = 0; i + 1 < n_reply; i++) {
        size_t length = strlen(reply[i]);
        TEST_ASSERT_EQUAL_STRING_LEN(reply[i], kept + n, length);
        n += length + 1;
    }
    TEST_ASSERT_EQUAL(n, strlen(kept));
}

/* A reset while everything around goes on; the console is a new session. */
static void reset(void)
{
    memory_port_reset(HAL_RESET_PIN);
    board.ready = false;
    board_run();
    type("mode machine\n");
    board_forget();
}

static void test_settings_are_back_after_power_on_with_loops_in_manual(void)
{
    running();
    ask_ok("mode bottom auto");
    samples(3);
    ask_ok("save");
    ask_ok("version");
    printf("two loops, %s\n", reply[n_reply - 2]);
    keep_reply("list all");
    power_on();
    ask_ok("loop");
    TEST_ASSERT_FALSE(said("bottom")); /* not yet: there may still be a plant */
    pass(2500);                        /* none */
    TEST_ASSERT_TRUE(said("STORAGE_LOADED"));
    expect_reply_again("list all");
    connect_plant();
    samples(3);
    ask_ok("loop");
    TEST_ASSERT_TRUE(said("bottom manual"));
    TEST_ASSERT_TRUE(said("top manual"));
    ask_ok("status");
    TEST_ASSERT_TRUE(said("state safe"));
    TEST_ASSERT_TRUE(said("storage ok"));
}

static void test_first_command_goes_out_before_storage_is_touched(void)
{
    running();
    ask_ok("save");
    power_on();
    connect_plant();
    unsigned commands = board.commands;
    ask_ok("status");
    TEST_ASSERT_TRUE(said("storage unread"));
    sample_after(1000);
    TEST_ASSERT_EQUAL(commands + 1, board.commands);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_EQUAL_FLOAT(0.25f, board.command.output[1].value); /* as the plant announced it */
    sample_after(1000);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, board.command.output[1].value); /* as configured: mv2.safe */
}

static void test_asking_ends_the_wait(void)
{
    running();
    ask_ok("save");
    power_on();
    ask_ok("load");
    pass(1100);
    ask_ok("loop");
    TEST_ASSERT_TRUE(said("bottom manual"));
}

static void test_pending_settings_are_saved_before_their_tick(void)
{
    running();
    ask_ok("set loop2.gain 2.25");
    ask_ok("save"); /* no sample in between */
    power_on();
    ask_ok("load");
    ask_ok("get loop2.gain");
    TEST_ASSERT_EQUAL_STRING("loop2.gain = 2.25 fraction/fraction", reply[0]);
}

/* A dead time that finds room with the plant's tick, and none with the 1 s that is taken while there is no plant. */
static void save_for_a_slow_plant(void)
{
    power_on();
    board.tick_ms = 60000;
    configure();
    ask_ok("set meas3.name feed");
    ask_ok("set meas3.unit l/h");
    connect_plant();
    samples(2);
    ask_ok("begin");
    ask_ok("set ff1.from feed");
    ask_ok("set ff1.to heat");
    ask_ok("set ff1.gain 0.5");
    ask_ok("set ff1.dead 90000");
    ask_ok("apply");
    samples(1);
    ask_ok("save");
    power_on();
    board.tick_ms = 60000;
    pass(5000);
}

static void a_set_for_a_slow_plant_comes_into_force_when_the_plant_comes_late(void)
{
    save_for_a_slow_plant();
    TEST_ASSERT_TRUE(said("STORAGE_REFUSED ff1.dead"));
    connect_plant();
    samples(2);
    TEST_ASSERT_TRUE(said("STORAGE_LOADED"));
    ask_ok("get ff1.dead");
    TEST_ASSERT_EQUAL_STRING("ff1.dead = 90000 s", reply[0]);
    samples(1);
    TEST_ASSERT_EQUAL_FLOAT(0.5f, board.command.output[1].value);
}

static void a_set_refused_for_want_of_a_plant_overrules_nobody(void)
{
    save_for_a_slow_plant();
    ask_ok("set meas1.name T1");
    connect_plant();
    samples(2);
    TEST_ASSERT_FALSE(said("STORAGE_LOADED"));
    ask_ok("get ff1.dead");
    TEST_ASSERT_EQUAL_STRING("ff1.dead = 0 s", reply[0]);
}

static void test_load_puts_back_and_keeps_loops_that_are_the_same(void)
{
    running();
    ask_ok("save");
    ask_ok("mode bottom auto");
    samples(2);
    ask_ok("set loop2.gain 9");
    samples(2);
    ask_ok("load");
    samples(2);
    ask_ok("get loop2.gain");
    TEST_ASSERT_EQUAL_STRING("loop2.gain = 1.5 fraction/fraction", reply[0]);
    ask_ok("loop");
    TEST_ASSERT_TRUE(said("bottom auto"));
}

static void test_load_and_defaults_in_a_transaction_wait_for_apply(void)
{
    running();
    ask_ok("save");
    ask_ok("set loop2.gain 9");
    samples(1);
    ask_ok("begin");
    ask_ok("load");
    ask_ok("diff");
    TEST_ASSERT_EQUAL_STRING("set loop2.gain 1.5", reply[0]);
    TEST_ASSERT_EQUAL(2, n_reply);
    ask_refused("save", "STATE");
    ask_ok("defaults");
    ask_ok("list loop2.name");
    TEST_ASSERT_EQUAL_STRING("loop2.name = -", reply[0]);
    ask_ok("abandon");
    ask_ok("get loop2.gain");
    TEST_ASSERT_EQUAL_STRING("loop2.gain = 9 fraction/fraction", reply[0]);
}

static void test_nothing_to_load_is_said(void)
{
    running();
    ask_refused("load", "EMPTY");
}

static void test_flash_that_takes_no_write_is_said_in_one_line(void)
{
    take_no_write = true;
    running();
    ask_refused("save", "IO");
    TEST_ASSERT_EQUAL(1, n_reply);
    TEST_ASSERT_TRUE(said("does not take the write"));
    ask_ok("status");
    TEST_ASSERT_TRUE(said("storage failed"));
    ask_ok("version");
    TEST_ASSERT_TRUE(said("storage: failed"));
}

static void test_without_a_brown_out_reset_a_save_wants_a_word_more(void)
{
    running();
    flash_model_brown_out_off = true;
    ask_refused("save", "STATE");
    TEST_ASSERT_TRUE(said("the brown-out reset is off"));
    TEST_ASSERT_TRUE(said("save unsafe"));
    ask_refused("save replace", "STATE");
    ask_ok("save unsafe");
    ask_ok("save replace unsafe");
    (void)ask("save sure");
    TEST_ASSERT_TRUE(said("err "));
    flash_model_brown_out_off = false;
    ask_ok("save");
    ask_ok("save unsafe");
}

static void test_nothing_is_written_while_the_supply_is_too_low(void)
{
    running();
    ask_ok("save");
    ask_ok("set loop1.gain 3");
    samples(1);
    flash_model_supply_low = true;
    ask_refused("save", "IO");
    TEST_ASSERT_TRUE(said("supply is too low"));
    flash_model_supply_low = false;
    ask_ok("save");
    power_on();
    pass(2500);
    ask_ok("get loop1.gain");
    TEST_ASSERT_TRUE(said("= 3 "));
}

static void test_save_that_needs_an_erase_waits_for_manual(void)
{
    running();
    ask_ok("mode bottom auto");
    samples(2);
    unsigned saves = 0;
    while (strcmp(ask("save"), "ok") == 0)
        TEST_ASSERT_TRUE(++saves < 100);
    TEST_ASSERT_TRUE(saves > 3);
    ask_refused("save", "STATE");
    TEST_ASSERT_TRUE(said("manual"));
    ask_ok("mode bottom manual");
    ask_refused("mode nobody manual", "UNKNOWN");
    samples(1);
    ask_ok("save");
    ask_ok("mode bottom auto");
    samples(1);
    ask_ok("save");
}

/* Erases of both slots, as `version` tells them. */
static unsigned erases_told(void)
{
    ask_ok("version");
    const char *at = strstr(board.said, " erases ");
    TEST_ASSERT_NOT_NULL(at);
    return (unsigned)strtoul(at + 8, NULL, 10);
}

/* An erase stops the processor for seconds: the plant would wait for its first command. */
static void test_nothing_is_erased_before_the_first_command(void)
{
    power_on(); /* with a new flash */
    connect_plant();
    ask_refused("save", "STATE");
    TEST_ASSERT_EQUAL(0, erases_told());
    samples(1);
    ask_ok("save");
    TEST_ASSERT_EQUAL(1, erases_told());
}

/* Each start erases too: the largest set of this build has no room behind the one that the save has left. */
static void test_erases_are_counted_through_starts(void)
{
    running();
    ask_ok("save");
    for (unsigned so_far = 1; so_far < 9; so_far += 2) {
        TEST_ASSERT_EQUAL(so_far, erases_told());
        for (unsigned n = 0; erases_told() == so_far; n++) {
            TEST_ASSERT_LESS_THAN(100, n);
            ask_ok("save");
        }
        TEST_ASSERT_EQUAL(so_far + 1, erases_told());
        power_on();
        pass(2500);
        connect_plant();
        samples(2);
    }
    TEST_ASSERT_EQUAL(9, erases_told());
}

static void test_rows_and_events_come_while_a_save_is_under_way(void)
{
    running();
    ask_ok("log on");
    board_forget();
    memory_port_give(HAL_UART_CONSOLE, "save\nstatus\n", 12);
    for (unsigned i = 0; i < 20; i++) { /* a turn or two of the main loop for each sample */
        struct frame f;
        board.number++;
        board.time_ms += board.tick_ms;
        pack_present_sample(&f);
        link_give(&f);
        memory_port_turn();
    }
    board_run();
    TEST_ASSERT_TRUE(times_said("\nT,1,") >= 15);
    cut_reply();
    TEST_ASSERT_EQUAL(2, n_replies);
    TEST_ASSERT_EQUAL_STRING("ok", reply[0]); /* of the save, before anything of the status */
}

static void load_image(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, STORAGE_IMAGES "/%s.bin", name);
    FILE *file = fopen(path, "rb");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    TEST_ASSERT_TRUE(fread(flash_model, 1, sizeof flash_model, file) > 0);
    fclose(file);
}

static void test_inconsistent_set_is_explained_again_by_load(void)
{
    load_image("inconsistent");
    power_on();
    pass(2500);
    TEST_ASSERT_TRUE(said("alarm STORAGE_REFUSED loop1.pv 3"));
    ask_ok("diff defaults");
    TEST_ASSERT_EQUAL(1, n_reply);
    for (unsigned i = 0; i < 2; i++) {
        ask_refused("load", "UNKNOWN");
        TEST_ASSERT_EQUAL_STRING(
            "err UNKNOWN loop1.pv: 'T1' must be the name of a configured measurement", reply[0]);
    }
    ask_refused("save", "STATE"); /* the defaults that run would replace it */
    /* To be mended: */
    ask_ok("begin");
    ask_ok("load");
    ask_ok("set meas1.name T1");
    ask_ok("apply");
    pass(1100);
    ask_ok("save");
    power_on();
    pass(2500);
    TEST_ASSERT_TRUE(said("STORAGE_LOADED"));
}

static void test_set_kept_back_by_a_transaction_is_not_replaced_by_defaults(void)
{
    running();
    ask_ok("save");
    power_on();
    ask_ok("begin");
    pass(2500);
    TEST_ASSERT_TRUE(said("alarm STORAGE_REFUSED configured 0"));
    ask_ok("abandon");
    ask_refused("save", "STATE");
    ask_ok("load");
    pass(1100);
    ask_ok("save");
}

/* dump -> defaults -> replay gives the same configuration, whatever it is. */
static void replay_dump(void)
{
    static char script[SAID_MAX];
    size_t n = 0;
    ask_ok("dump");
    for (unsigned i = 0; i + 1 < n_reply; i++)
        n += (size_t)snprintf(script + n, sizeof script - n, "%s\n", reply[i]);
    keep_reply("list all");
    ask_ok("defaults");
    samples(1);
    ask_ok("diff defaults");
    TEST_ASSERT_TRUE(n_reply <= 2); /* the key alone stays */
    board_forget();
    type(script);
    cut_reply();
    for (unsigned i = 0; i < n_reply; i++)
        TEST_ASSERT_EQUAL_STRING("ok", reply[i]);
    samples(1);
    expect_reply_again("list all");
}

static void test_dump_restores_exactly(void)
{
    running();
    ask_ok("begin");
    ask_ok("set lock1.meas T10");
    ask_ok("set lock1.mv heat");
    ask_ok("apply");
    samples(1);
    replay_dump();
}

static void test_dump_restores_exactly_with_a_key(void)
{
    running();
    ask_ok("key s3cret");
    samples(1);
    replay_dump();
    TEST_ASSERT_FALSE(said("s3cret"));
    ask_ok("lock");
    ask_refused("defaults", "LOCKED");
    ask_refused("save", "LOCKED");
    ask_ok("unlock s3cret");
}

static void test_dump_restores_random_settings(void)
{
    struct random_source random = {42};
    running();
    for (unsigned round = 0; round < 12; round++) {
        ask_ok("begin");
        for (unsigned k = 0; k < 40; k++) {
            struct parameter p;
            char line[120], value[40];
            struct text t;
            unsigned count = 0;
            while (parameter_at(count, &p))
                count++;
            (void)parameter_at(random_below(&random, count), &p);
            if (p.field->type == PARAMETER_FLOAT) {
                double x = (double)random_below(&random, 1000001) / 1e6;
                snprintf(value, sizeof value, "%.9g",
                         (double)field_lo(p.field) +
                             x * ((double)field_hi(p.field) - (double)field_lo(p.field)));
            } else if (p.field->type == PARAMETER_UNIT) {
                snprintf(value, sizeof value, "u%u", k);
            } else {
                continue; /* names make plans; the others have few values */
            }
            char name[40];
            t = text_on(name, sizeof name);
            parameter_name(&p, &t);
            snprintf(line, sizeof line, "set %s %s", name, value);
            ask_ok(line);
        }
        if (strcmp(ask("apply"), "ok") != 0) {
            ask_ok("abandon");
            continue;
        }
        samples(1);
        replay_dump();
    }
}

static void test_dump_before_and_after_a_reset_is_the_same(void)
{
    running();
    ask_ok("save");
    keep_reply("dump");
    reset();
    pass(2500);
    samples(3);
    expect_reply_again("dump");
    ask_ok("load");
    expect_reply_again("dump");
}

/* The safe command first, then the stored settings, then the loops as they were. */
static void test_restart_policy_finds_its_settings_in_storage(void)
{
    running();
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
    TEST_ASSERT_TRUE(board.ready);
    sample_after(1000);
    TEST_ASSERT_TRUE(board.command.safe);
    samples(3);
    TEST_ASSERT_TRUE(said("RESTART_DONE"));
    ask_ok("loop");
    TEST_ASSERT_TRUE(said("bottom auto"));
}

static void test_newer_firmware_s_settings_are_replaced_only_when_asked_to(void)
{
    static uint8_t image[sizeof flash_model];
    load_image("newer_slot");
    memcpy(image, flash_model, sizeof image);
    power_on();
    pass(2500);
    TEST_ASSERT_TRUE(said("alarm STORAGE_NEWER - 2"));
    ask_ok("status");
    TEST_ASSERT_TRUE(said("storage blocked"));
    ask_ok("version");
    TEST_ASSERT_TRUE(said("storage: blocked, set 40"));
    ask_ok("set loop1.gain 6");
    pass(1100);
    ask_refused("save", "VERSION");
    TEST_ASSERT_TRUE(said("`save replace`"));
    ask_refused("save now", "PARSE");
    TEST_ASSERT_EQUAL_MEMORY(image, flash_model, sizeof image);
    ask_ok("save replace");
    ask_ok("status");
    TEST_ASSERT_TRUE(said("storage ok"));
    power_on();
    pass(2500);
    TEST_ASSERT_TRUE(said("STORAGE_LOADED"));
    TEST_ASSERT_FALSE(said("STORAGE_NEWER"));
    ask_ok("get loop1.gain");
    TEST_ASSERT_EQUAL_STRING("loop1.gain = 6 fraction/fraction", reply[0]);
}

static void test_history_keeps_who_saved(void)
{
    running();
    ask_ok("save");
    ask_ok("defaults");
    ask_ok("events");
    TEST_ASSERT_TRUE(said("DO_STORAGE save"));
    TEST_ASSERT_TRUE(said("DO_STORAGE defaults"));
}

/* A reset that something in the firmware caused, so many seconds after the start. */
static void brought_down(enum hal_reset reason, uint64_t after_s)
{
    pass(1000 * after_s);
    memory_port_reset(reason);
    board.ready = false;
    board_run();
    type("mode machine\n");
    board_forget();
}

static void saved_two_loops(void)
{
    running();
    ask_ok("save");
    power_on();
    pass(2500);
    TEST_ASSERT_TRUE(said("STORAGE_LOADED"));
}

static void test_settings_that_bring_the_board_down_three_times_are_left_out(void)
{
    static const enum hal_reset whys[] = {HAL_RESET_FAULT, HAL_RESET_WATCHDOG, HAL_RESET_FAULT};
    saved_two_loops();
    for (unsigned i = 0; i < 3; i++) {
        board_forget();
        brought_down(whys[i], 57); /* 2.5 s have passed before */
        pass(2500);
        TEST_ASSERT_EQUAL(i < 2, said("STORAGE_LOADED"));
        ask_ok("loop");
        TEST_ASSERT_EQUAL(i < 2, said("bottom"));
    }
    ask_ok("events");
    TEST_ASSERT_TRUE(said("alarm STORAGE_LEFT_OUT - 3 "));
    ask_ok("version");
    TEST_ASSERT_TRUE(said("started by: fault"));
    TEST_ASSERT_TRUE(said("early_resets 3"));
    connect_plant();
    samples(1); /* the first command drives everything to where the plant said it is safe */
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_EQUAL_FLOAT(0.25f, board.command.output[1].value);
    ask_refused("save", "STATE");
    TEST_ASSERT_TRUE(said("left out after resets in a row"));
    brought_down(HAL_RESET_WATCHDOG, 10); /* by something else, then */
    pass(2500);
    TEST_ASSERT_FALSE(said("STORAGE_LOADED"));
    type("reboot\n"); /* somebody wants another try */
    type("mode machine\n");
    pass(600);
    samples(2);
    TEST_ASSERT_TRUE(said("STORAGE_LOADED"));
    ask_ok("version");
    TEST_ASSERT_FALSE(said("early_resets"));
}

static void test_left_out_settings_can_be_loaded_or_given_up(void)
{
    saved_two_loops();
    for (unsigned i = 0; i < 3; i++)
        brought_down(HAL_RESET_FAULT, 1);
    pass(2500);
    ask_ok("load");
    ask_ok("loop");
    TEST_ASSERT_TRUE(said("bottom"));
    ask_ok("save");
    brought_down(HAL_RESET_FAULT, 1);
    pass(2500);
    ask_refused("save", "STATE");
    ask_ok("defaults");
    ask_ok("save");
    power_on();
    pass(2500);
    ask_ok("loop");
    TEST_ASSERT_FALSE(said("bottom"));
}

static void test_resets_that_are_far_apart_or_asked_for_leave_no_settings_out(void)
{
    static const struct {
        enum hal_reset reason;
        uint64_t after_s;
    } lives[] = {{HAL_RESET_FAULT, 61},    {HAL_RESET_FAULT, 61}, {HAL_RESET_WATCHDOG, 61},
                 {HAL_RESET_FAULT, 61},    {HAL_RESET_FAULT, 1},  {HAL_RESET_FAULT, 1},
                 {HAL_RESET_PIN, 1},       {HAL_RESET_FAULT, 1},  {HAL_RESET_FAULT, 1},
                 {HAL_RESET_WATCHDOG, 61}, {HAL_RESET_FAULT, 1},  {HAL_RESET_FAULT, 1}};
    saved_two_loops();
    for (unsigned i = 0; i < sizeof lives / sizeof lives[0]; i++) {
        brought_down(lives[i].reason, lives[i].after_s);
        pass(2500);
        TEST_ASSERT_TRUE_MESSAGE(said("STORAGE_LOADED"), "settings were left out");
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_settings_that_bring_the_board_down_three_times_are_left_out);
    RUN_TEST(test_left_out_settings_can_be_loaded_or_given_up);
    RUN_TEST(test_resets_that_are_far_apart_or_asked_for_leave_no_settings_out);
    RUN_TEST(test_settings_are_back_after_power_on_with_loops_in_manual);
    RUN_TEST(test_first_command_goes_out_before_storage_is_touched);
    RUN_TEST(test_asking_ends_the_wait);
    RUN_TEST(test_pending_settings_are_saved_before_their_tick);
    RUN_TEST(a_set_for_a_slow_plant_comes_into_force_when_the_plant_comes_late);
    RUN_TEST(a_set_refused_for_want_of_a_plant_overrules_nobody);
    RUN_TEST(test_load_puts_back_and_keeps_loops_that_are_the_same);
    RUN_TEST(test_load_and_defaults_in_a_transaction_wait_for_apply);
    RUN_TEST(test_nothing_to_load_is_said);
    RUN_TEST(test_flash_that_takes_no_write_is_said_in_one_line);
    RUN_TEST(test_set_kept_back_by_a_transaction_is_not_replaced_by_defaults);
    RUN_TEST(test_nothing_is_written_while_the_supply_is_too_low);
    RUN_TEST(test_without_a_brown_out_reset_a_save_wants_a_word_more);
    RUN_TEST(test_save_that_needs_an_erase_waits_for_manual);
    RUN_TEST(test_nothing_is_erased_before_the_first_command);
    RUN_TEST(test_erases_are_counted_through_starts);
    RUN_TEST(test_rows_and_events_come_while_a_save_is_under_way);
    RUN_TEST(test_inconsistent_set_is_explained_again_by_load);
    RUN_TEST(test_dump_restores_exactly);
    RUN_TEST(test_dump_restores_exactly_with_a_key);
    RUN_TEST(test_dump_restores_random_settings);
    RUN_TEST(test_dump_before_and_after_a_reset_is_the_same);
    RUN_TEST(test_restart_policy_finds_its_settings_in_storage);
    RUN_TEST(test_newer_firmware_s_settings_are_replaced_only_when_asked_to);
    RUN_TEST(test_history_keeps_who_saved);
    return UNITY_END();
}
