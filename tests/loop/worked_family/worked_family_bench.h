/* The wood-berry column with the worked family: what its tests do with it. Everything is asked for at the console, and read
 * from there. */
#ifndef REFLUX_TESTS_WORKED_FAMILY_BENCH_H
#define REFLUX_TESTS_WORKED_FAMILY_BENCH_H

#include <math.h>

#include "plant_board.h"

#define TICK_S  60.0
#define TICK_MS 60000u

/* Settings of the loops in worked_family.conf. */
#define TOP_GAIN      0.375 /* lb/min per %w */
#define TOP_TI_S      497.0
#define BOTTOM_GAIN   0.075
#define BOTTOM_TI_S   1416.0
#define POINT_HOLD_S  120.0
#define XD_RESOLUTION 0.0032
#define XB_RESOLUTION 0.004

/* A number behind " NAME = " in the last reply; what follows it. */
static inline double number_of(const char *name, const char **rest)
{
    char wanted[40];
    snprintf(wanted, sizeof wanted, "%s = ", name);
    for (unsigned i = 0; i < n_reply; i++) {
        const char *at = strstr(reply[i], wanted);
        if (!at || (at != reply[i] && at[-1] != ' '))
            continue;
        char *end;
        double value = strtod(at + strlen(wanted), &end);
        if (rest)
            *rest = end;
        return value;
    }
    TEST_FAIL_MESSAGE(name);
    return 0;
}

/* A measurement or a point as `status` has it. */
static inline double reads(const char *name)
{
    ask_ok("status");
    return number_of(name, NULL);
}

static inline bool reads_as(const char *name, const char *quality)
{
    const char *rest;
    ask_ok("status");
    (void)number_of(name, &rest);
    return strstr(rest, quality) != NULL;
}

/* An inner value of a block. */
static inline double inside(const char *block, const char *name)
{
    char line[40];
    snprintf(line, sizeof line, "block %s", block);
    ask_ok(line);
    return number_of(name, NULL);
}

static inline void sets(const char *name, double value)
{
    char line[80];
    snprintf(line, sizeof line, "set %s %.9g", name, value);
    ask_ok(line);
}

static inline void setpoint(const char *loop, double value)
{
    char line[80];
    snprintf(line, sizeof line, "sp %s %.9g", loop, value);
    ask_ok(line);
}

/* Configured, connected, at rest where the plant is designed for, in manual. */
static inline void column_at_rest(double noise)
{
    plant_power_on("wood-berry", TICK_MS, 1, noise);
    ask_file(WORKED_FAMILY_CONF);
    plant_connect();
    plant_steps(2);
    ask_ok("out top 1.95");
    ask_ok("out bottom 1.71");
    plant_steps(300);
    board_forget();
}

static inline void in_auto(void)
{
    ask_ok("mode top auto");
    ask_ok("mode bottom auto");
    setpoint("top", 96.25);
    setpoint("bottom", 0.5);
    plant_steps(60);
    board_forget();
}

/* From one build of the firmware to another. */
static inline void flash_to(const char *path)
{
    FILE *file = fopen(path, "wb");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    TEST_ASSERT_EQUAL(1, fwrite(memory_port_flash(), memory_port_flash_size(), 1, file));
    TEST_ASSERT_EQUAL(0, fclose(file));
}

static inline void flash_from(const char *path)
{
    FILE *file = fopen(path, "rb");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    memory_port_erase_all();
    TEST_ASSERT_EQUAL(1, fread(memory_port_flash(), memory_port_flash_size(), 1, file));
    fclose(file);
}

/* Errors of both loops from a moment on. */
struct deviation {
    double top, bottom; /* integral of the absolute error, %w min */
};

static inline struct deviation deviates(double top, double bottom, unsigned minutes)
{
    struct deviation d = {0, 0};
    for (unsigned k = 0; k < minutes; k++) {
        plant_step();
        d.top += fabs(top - truly("xD"));
        d.bottom += fabs(bottom - truly("xB"));
    }
    return d;
}

#endif
