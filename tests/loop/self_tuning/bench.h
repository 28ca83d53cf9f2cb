/* The pilot column with a self-tuner: what its tests do with it. Everything is asked for at the console, and read from there. */
#ifndef REFLUX_TESTS_SELF_TUNING_BENCH_H
#define REFLUX_TESTS_SELF_TUNING_BENCH_H

#include <math.h>

#include "plant_board.h"

#define TICK_S  30.0
#define TICK_MS 30000u

/* A number behind " NAME = " in the last reply. */
static inline double number_of(const char *name)
{
    char wanted[40];
    snprintf(wanted, sizeof wanted, "%s = ", name);
    for (unsigned i = 0; i < n_reply; i++) {
        const char *at = strstr(reply[i], wanted);
        if (at && (at == reply[i] || at[-1] == ' '))
            return strtod(at + strlen(wanted), NULL);
    }
    TEST_FAIL_MESSAGE(name);
    return 0;
}

static inline double inside(const char *name)
{
    ask_ok("block 1");
    return number_of(name);
}

static inline void setpoint(const char *loop, double value)
{
    char line[80];
    snprintf(line, sizeof line, "sp %s %.9g", loop, value);
    ask_ok(line);
}

#endif
