/* Automatic start-up of the Wood-Berry column on the board in memory: moments to begin from, and ways to end. */
#ifndef REFLUX_TESTS_COMMISSION_WOOD_BERRY_H
#define REFLUX_TESTS_COMMISSION_WOOD_BERRY_H

#include <math.h>

#include "commission_board.h"
#include "hal/identity.h"

#define TICK_MS 60000u

#define CASE(what) from_here(#what, what)

/* Two loops from before, in manual, and steps that are given. */
static const char *const old_loops[] = {
    "set loop1.name old_R",   "set loop1.pv xD",        "set loop1.out R",
    "set loop1.ti 1500",      "set loop2.name old_S",   "set loop2.pv xB",
    "set loop2.out S",        "set loop2.ti 1500",      "set loop2.action direct",
    "set meas1.hold 60",      "set mv1.follow 60",      "set mv2.follow 60",
    "set mv1.test_step 0.08", "set mv2.test_step 0.08", NULL};

static inline void wood_berry(const char *const *more)
{
    static const char *lines[40];
    unsigned n = 0;
    for (unsigned i = 0; old_loops[i]; i++)
        lines[n++] = old_loops[i];
    for (unsigned i = 0; more && more[i]; i++)
        lines[n++] = more[i];
    lines[n] = NULL;
    commission_plant("wood-berry", TICK_MS, 0.0, lines);
}

/* S, the second input, is 0.08 lb/min up, and has been for 20 minutes. */
static inline void second_step(void)
{
    ask_ok("commission begin");
    until("TEST_DONE R", 1500);
    until("TEST_STEP S", 300);
    plant_steps(20);
    ASSERT_OUTPUT(1.71 + 0.08, "S");
    ASSERT_OUTPUT(1.95, "R");
}

static inline void proposal(void)
{
    ask_ok("commission begin");
    until("PROPOSAL", 3000);
}

static inline void ended(const char *reason)
{
    char text[120];
    TEST_ASSERT_TRUE(phase_is("ended"));
    snprintf(text, sizeof text, "%s", reason);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(reply[1], text), reply[1]);
    TEST_ASSERT_TRUE(nothing_was_stored());
}

static inline void ended_with_everything_held(const char *reason)
{
    ended(reason);
    plant_step();
    ASSERT_OUTPUT(1.95, "R");
    ASSERT_OUTPUT(1.71, "S");
    plant_steps(50);
    ASSERT_OUTPUT(1.95, "R");
    ASSERT_OUTPUT(1.71, "S");
}

/* As it was before it was accepted, by the text of every setting. */
static char settings_before[200000];

static inline void remember_settings(void)
{
    ask_ok("diff defaults");
    settings_before[0] = '\0';
    for (unsigned i = 0; i < n_reply; i++) {
        strcat(settings_before, reply[i]);
        strcat(settings_before, "\n");
    }
}

static inline bool settings_are_as_before(void)
{
    const char *at = settings_before;
    ask_ok("diff defaults");
    for (unsigned i = 0; i < n_reply; i++) {
        size_t n = strlen(reply[i]);
        if (strncmp(at, reply[i], n) != 0 || at[n] != '\n')
            return false;
        at += n + 1;
    }
    return *at == '\0';
}

static inline void board_resets(enum hal_reset reason)
{
    memory_port_reset(reason);
    board.ready = false;
    board_run();
    type("mode machine\n");
    pass(1000);
    TEST_ASSERT_TRUE(board.ready);
}

static inline void nothing_goes_on_after_a_reset(void)
{
    board_resets(HAL_RESET_WATCHDOG);
    TEST_ASSERT_TRUE(phase_is("ended"));
    TEST_ASSERT_NOT_NULL(strstr(reply[1], "reset"));
    plant_steps(5);
    TEST_ASSERT_TRUE(board.command.safe); /* restart.policy safe, and no configuration in storage */
    ask_ok("events");
    TEST_ASSERT_TRUE(said("COMMISSION_ENDED"));
    TEST_ASSERT_TRUE(nothing_was_stored());
}

static inline void nothing_goes_on_after_power_was_lost(void)
{
    memory_port_start();
    board.ready = false;
    board.clock_ms = 0;
    board_run();
    type("mode machine\n");
    pass(1000);
    TEST_ASSERT_TRUE(phase_is("idle"));
    plant_steps(5);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_TRUE(nothing_was_stored());
}

static inline void a_reboot_is_a_reset(void)
{
    board.ready = false;
    type("reboot\n");
    board_run();
    type("mode machine\n");
    pass(1000);
    TEST_ASSERT_TRUE(phase_is("ended"));
    plant_steps(2);
    TEST_ASSERT_TRUE(board.command.safe);
    TEST_ASSERT_TRUE(nothing_was_stored());
}

#endif
