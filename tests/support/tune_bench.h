/* The kind `ff_tune` on the whole firmware with Siddha's loop, twenty times slower (host_sim/plants/siddha-slow.json). */
#ifndef REFLUX_TESTS_TUNE_BENCH_H
#define REFLUX_TESTS_TUNE_BENCH_H

#include <math.h>

#include "plant_board.h"

enum { IDLE, SILENCES, LOOP, DISTURBANCE, COMPUTES, TESTS, PROPOSES, RUNS };
enum {
    NONE,
    ADOPTED,
    STILL,
    LOOP_STILL,
    SLOW,
    NO_BAND,
    UNSURE,
    NO_MODEL,
    NO_BETTER,
    UNTESTED,
    REJECTED,
    WORSE,
    STOPPED,
    SIGNAL
};

static const char *const methods[] = {"joint", "sensitivity", "tracking", "input"};
#define METHODS 4u

/* The course of d: a square wave, from `on` on. */
static struct {
    double size, period, error, count;
    bool quiet;
} course;

static inline void set_disturbance(double d)
{
    TEST_ASSERT_TRUE_MESSAGE(
        kind->set_input(plant, plant_channel_of("d"), d, plant_err, sizeof plant_err), plant_err);
}

static inline void set_parameter(const char *name, int value)
{
    TEST_ASSERT_TRUE_MESSAGE(
        kind->set_input(plant, plant_channel_of(name), value, plant_err, sizeof plant_err),
        plant_err);
}

/* A second; the square of what is left of the disturbance in y adds up in `course`. */
static inline void tune_second(void)
{
    double t = (double)board.time_ms / 1000.0;
    bool up = fmod(t, course.period) < course.period / 2;
    set_disturbance(course.quiet ? 0 : up ? course.size : -course.size);
    plant_step();
    course.error += truly("y") * truly("y");
    course.count++;
}

static inline void tune_seconds(unsigned n)
{
    while (n--)
        tune_second();
}

/* Mean square of y over so many seconds, no setpoint moving. */
static inline double mean_square(unsigned seconds)
{
    course.error = course.count = 0;
    tune_seconds(seconds);
    return course.error / course.count;
}

static inline int tune_value(const char *name)
{
    return (int)value_of(1, name);
}

static inline void tune_begin(const char *folder, uint64_t seed, double noise)
{
    char path[300];
    course.size = 1;
    course.period = 300;
    course.quiet = false;
    plant_power_on("siddha-slow", 1000, seed, noise);
    snprintf(path, sizeof path, "%s/tune.conf", folder);
    ask_file(path);
    plant_connect();
    plant_steps(2);
    ask_ok("mode one auto");
    tune_seconds(10);
}

/* `tune`, until it is in one of these stages (bits) or idle, looked at every so many seconds. staged: the disturbance rests while a loop is
 * identified by its setpoint, as in the source. */
static inline void tune_stages(bool staged, unsigned stages, unsigned every_s)
{
    course.quiet = staged;
    ask_ok("block 1 tune");
    tune_seconds(40);
    for (unsigned k = 0; k < 20000; k += every_s) {
        int stage = tune_value("stage");
        if (stage == DISTURBANCE)
            course.quiet = false;
        if (stage == IDLE || (stages & (1u << stage)))
            return;
        tune_seconds(every_s);
    }
}

#endif
