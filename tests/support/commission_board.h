/* Automatic start-up on the board in memory, with a plant of the library behind the bench's instruments, and children of
 * this process for everything that can happen from a moment on. */
#ifndef REFLUX_TESTS_COMMISSION_BOARD_H
#define REFLUX_TESTS_COMMISSION_BOARD_H

#include <sys/wait.h>
#include <unistd.h>

#include "plant_board.h"

static uint8_t flash_before[1 << 20];

/* Every channel of the plant as it announces them; lines: more settings, NULL at the end, or NULL. */
static inline void commission_configure(const char *const *lines)
{
    static const char *const groups[2] = {"meas", "mv"};
    static const enum plant_kind kinds[2] = {PLANT_MEASUREMENT, PLANT_MV};
    char line[120];
    ask_ok("begin");
    for (unsigned k = 0; k < 2; k++) {
        unsigned n = 0;
        for (size_t i = 0; i < kind->n_channels; i++) {
            const struct plant_channel *c = &kind->channels[i];
            if (c->kind != kinds[k])
                continue;
            n++;
            snprintf(line, sizeof line, "set %s%u.name %s", groups[k], n, c->name);
            ask_ok(line);
            snprintf(line, sizeof line, "set %s%u.unit %s", groups[k], n, c->unit);
            ask_ok(line);
            snprintf(line, sizeof line, "set %s%u.lo %.9g", groups[k], n, c->lo);
            ask_ok(line);
            snprintf(line, sizeof line, "set %s%u.hi %.9g", groups[k], n, c->hi);
            ask_ok(line);
            if (k == 0)
                continue;
            snprintf(line, sizeof line, "set mv%u.min %.9g", n, c->lo);
            ask_ok(line);
            snprintf(line, sizeof line, "set mv%u.max %.9g", n, c->hi);
            ask_ok(line);
            snprintf(line, sizeof line, "set mv%u.safe %.9g", n, c->safe);
            ask_ok(line);
        }
    }
    for (; lines && *lines; lines++)
        ask_ok(*lines);
    ask_ok("apply");
}

static inline double nominal(const char *name)
{
    return kind->channels[plant_channel_of(name)].nominal;
}

/* A loop's output is moved by the loop's name. */
static inline void commission_outputs_nominal(void)
{
    char line[80];
    for (size_t i = 0; i < kind->n_channels; i++) {
        const struct plant_channel *c = &kind->channels[i];
        if (c->kind != PLANT_MV)
            continue;
        snprintf(line, sizeof line, "out %s %.9g", c->name, c->nominal);
        if (strcmp(ask(line), "ok") == 0)
            continue;
        snprintf(line, sizeof line, "out old_%s %.9g", c->name, c->nominal);
        ask_ok(line);
    }
}

/* Connected, at rest, outputs at nominal. noise: times the sensors' own. */
static inline void commission_plant(const char *name, uint32_t tick_ms, double noise,
                                    const char *const *lines)
{
    if (plant)
        plant_power_off();
    plant_power_on(name, tick_ms, 1, noise);
    commission_configure(lines);
    plant_connect();
    plant_steps(2);
    commission_outputs_nominal();
    plant_steps(400); /* what the safe values have disturbed has died away */
    TEST_ASSERT_TRUE(memory_port_flash_size() <= sizeof flash_before);
    memcpy(flash_before, memory_port_flash(), memory_port_flash_size());
    board_forget();
}

/* "phase testing, ..." */
static inline bool phase_is(const char *phase)
{
    char text[40];
    ask_ok("commission");
    snprintf(text, sizeof text, "phase %s", phase);
    return strncmp(reply[0], text, strlen(text)) == 0;
}

/* Goes on until an event or another text is said. */
static inline void until(const char *text, unsigned ticks)
{
    board_forget();
    while (ticks-- && !said(text))
        plant_step();
    TEST_ASSERT_TRUE_MESSAGE(said(text), text);
}

/* No set has come into the slot in use, the first half. A start may erase the other one, where the first has no room for the largest set of
 * this build (docs/inside/storage.md). */
static inline bool nothing_was_stored(void)
{
    return memcmp(flash_before, memory_port_flash(), memory_port_flash_size() / 2u) == 0;
}

#define ASSERT_OUTPUT(value, name)                                                                 \
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-4 * (1.0 + fabs((double)(value))), value,                 \
                                      commanded(name), name)

/* With coverage (its preset links this in): what a child has counted is written before it leaves. */
extern void __gcov_dump(void) __attribute__((weak));

static unsigned children_failed; /* for tearDown() to look at */

/* Does it in a child, from this very moment. */
static inline void from_here(const char *name, void (*what)(void))
{
    int status = 0;
    fflush(stdout);
    pid_t child = fork();
    TEST_ASSERT_TRUE(child >= 0);
    if (child == 0) {
        if (TEST_PROTECT()) {
            what();
            if (__gcov_dump)
                __gcov_dump();
            _exit(0);
        }
        fflush(stdout);
        printf("  ... in: %s; last said:\n%.2000s\n", name,
               board.n_said > 2000 ? board.said + board.n_said - 2000 : board.said);
        fflush(stdout);
        _exit(1);
    }
    TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
    children_failed += !(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

#endif
