/* The whole firmware on the board in memory, with a plant of the library on its link, behind the bench's instruments.
 * One sample after the other; a test may fork() to try several things from the same moment. */
#ifndef REFLUX_TESTS_PLANT_BOARD_H
#define REFLUX_TESTS_PLANT_BOARD_H

#include <stdlib.h>

#include "bench/events.h"
#include "board_bench.h"
#include "instruments.h"
#include "plants/plant.h"
#include "plants/plant_library.h"

static const struct plant_class *kind;
static struct plant *plant;
static struct instruments instruments;
static char plant_err[512];

static inline void plant_announces(uint8_t index, struct link_page *page)
{
    static const enum plant_kind kinds[2] = {PLANT_MEASUREMENT, PLANT_MV};
    uint8_t n = 0;
    for (unsigned k = 0; k < 2; k++)
        for (size_t i = 0; i < kind->n_channels; i++) {
            const struct plant_channel *c = &kind->channels[i];
            if (c->kind != kinds[k] || n++ != index)
                continue;
            *page = (struct link_page){.index = index,
                                       .manipulated = k == 1,
                                       .lo = (float)c->lo,
                                       .hi = (float)c->hi,
                                       .safe = (float)c->safe};
            snprintf(page->name, sizeof page->name, "%s", c->name);
            snprintf(page->unit, sizeof page->unit, "%s", c->unit);
            return;
        }
    TEST_FAIL_MESSAGE("the firmware asked for a page the plant has not");
}

/* Flash as an earlier firmware has left it; what follows the image is erased. */
static inline void plant_flash_from(const char *path)
{
    FILE *file = fopen(path, "rb");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    memory_port_erase_all();
    TEST_ASSERT_TRUE(fread(memory_port_flash(), 1, memory_port_flash_size(), file) > 0);
    fclose(file);
}

/* Greets anew; the firmware has found the plant when this returns. */
static inline void plant_connect(void)
{
    board.mute = false;
    pass(1000);
    TEST_ASSERT_TRUE_MESSAGE(board.ready, "the plant was not connected");
}

/* Board and plant from the beginning, not yet connected. noise: times the sensors' own. */
static inline void plant_power_on(const char *name, uint32_t tick_ms, uint64_t seed, double noise)
{
    power_on();
    kind = plant_open(name, plant_err, sizeof plant_err);
    TEST_ASSERT_NOT_NULL_MESSAGE(kind, plant_err);
    plant = plant_create(kind, plant_err, sizeof plant_err);
    TEST_ASSERT_NOT_NULL_MESSAGE(plant, plant_err);
    TEST_ASSERT_TRUE_MESSAGE(
        instruments_init(&instruments, kind, seed, noise, plant_err, sizeof plant_err), plant_err);
    board.tick_ms = tick_ms;
    board.n_measurements = (uint8_t)instruments.n_sensors;
    board.n_outputs = (uint8_t)instruments.n_actuators;
    board.announce = plant_announces;
}

static inline void plant_power_off(void)
{
    if (plant)
        kind->destroy(plant);
    plant = NULL;
}

/* A sample, its answer, and the plant goes on by one tick. A plant that is not connected heads for its safe values. */
static inline void plant_step(void)
{
    double tick_s = board.tick_ms / 1000.0;
    struct frame f;
    struct link_sample sample;
    unsigned before = board.commands;
    instruments_measure(&instruments, plant, tick_s, &sample);
    sample.number = ++board.number;
    sample.time_ms = board.time_ms;
    if (board.ready && !board.mute) {
        pack_sample(&sample, &f);
        link_give(&f);
        board_run();
        TEST_ASSERT_EQUAL_MESSAGE(before + 1, board.commands, "a sample was not answered");
        for (unsigned j = 0; j < board.n_outputs; j++) {
            const struct plant_channel *c = &kind->channels[instruments.actuator[j].channel];
            double u = (double)board.command.output[j].value;
            TEST_ASSERT_TRUE_MESSAGE(u >= c->lo && u <= c->hi, c->name);
        }
        instruments_command(&instruments, &board.command);
    } else {
        instruments_safe(&instruments);
    }
    TEST_ASSERT_TRUE_MESSAGE(
        instruments_drive(&instruments, plant, tick_s, plant_err, sizeof plant_err), plant_err);
    board.time_ms += board.tick_ms;
    TEST_ASSERT_TRUE_MESSAGE(
        kind->advance(plant, (double)board.time_ms / 1000.0, plant_err, sizeof plant_err),
        plant_err);
}

static inline void plant_steps(unsigned n)
{
    while (n--)
        plant_step();
}

static inline size_t plant_channel_of(const char *name)
{
    for (size_t i = 0; i < kind->n_channels; i++)
        if (strcmp(kind->channels[i].name, name) == 0)
            return i;
    TEST_FAIL_MESSAGE(name);
    return 0;
}

/* True value, noise and faults aside. */
static inline double truly(const char *name)
{
    return kind->value(plant, plant_channel_of(name));
}

/* Last command for an output, by its name. */
static inline double commanded(const char *name)
{
    for (unsigned j = 0; j < board.n_outputs; j++)
        if (strcmp(kind->channels[instruments.actuator[j].channel].name, name) == 0)
            return (double)board.command.output[j].value;
    TEST_FAIL_MESSAGE(name);
    return 0;
}

/* "LB.quality=2", "supply=0" (docs/inside/faults.md); NULL is nothing. */
static inline void plant_event(const char *what)
{
    static struct events events;
    char text[80];
    if (!what)
        return;
    memset(&events, 0, sizeof events);
    snprintf(text, sizeof text, "0:%s", what);
    TEST_ASSERT_TRUE_MESSAGE(events_add(&events, kind, text, plant_err, sizeof plant_err),
                             plant_err);
    TEST_ASSERT_TRUE_MESSAGE(
        events_apply(&events, 0, plant, &instruments, plant_err, sizeof plant_err), plant_err);
}

/* Sends the lines of a file, as somebody would paste it, each awaited. Path from the build folder. */
static inline void ask_file(const char *path)
{
    char line[256];
    FILE *file = fopen(path, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    while (fgets(line, sizeof line, file)) {
        line[strcspn(line, "\r\n")] = '\0';
        if (line[0])
            ask_ok(line);
    }
    fclose(file);
}

static inline bool loop_is(const char *loop, const char *mode)
{
    char text[40];
    ask_ok("loop");
    snprintf(text, sizeof text, "%s %s ", loop, mode);
    return said(text);
}

/* An inner value of the block; a test that asks for one that is not there fails. */
static inline double value_of(unsigned block, const char *name)
{
    char line[40], begin[40];
    snprintf(line, sizeof line, "block %u", block);
    ask_ok(line);
    snprintf(begin, sizeof begin, "  %s = ", name);
    for (unsigned k = 0; k < n_reply; k++)
        if (strncmp(reply[k], begin, strlen(begin)) == 0)
            return strtod(reply[k] + strlen(begin), NULL);
    TEST_FAIL_MESSAGE(name);
    return 0;
}

static inline double setting_of(const char *parameter)
{
    char command[60];
    snprintf(command, sizeof command, "get %s", parameter);
    ask_ok(command);
    const char *at = strstr(reply[0], " = ");
    TEST_ASSERT_NOT_NULL_MESSAGE(at, reply[0]);
    return strtod(at + 3, NULL);
}

static inline bool events_say(const char *text)
{
    ask_ok("events");
    return said(text);
}

#endif
