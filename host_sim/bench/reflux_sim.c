/* reflux-sim: reads the command line, puts plant, instruments, link, console and log together, and runs. */
#include "bench/reflux_sim.h"

#include <inttypes.h>
#include <stdlib.h>

#include "bench/run_parts.h"
#include "bench/text.h"
#include "plants/plant_task.h"

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_BAD_INPUT = 2, EXIT_INTERRUPTED = 130 };

static volatile sig_atomic_t interrupted;

static void on_signal(int signal_number)
{
    (void)signal_number;
    interrupted = 1;
}

static struct run_parts sim;

static void warn_if_late(double time_s, const char *what, const char *text)
{
    if (sim.options.duration_s >= 0.0 && time_s > sim.options.duration_s) {
        (void)fprintf(stderr,
                      "reflux-sim: warning: %s \"%s\" at %g s comes after the end at %g s\n", what,
                      text, time_s, sim.options.duration_s);
    }
}

/* Warns of events and console lines that the run does not reach. */
static void warn_of_late(void)
{
    for (size_t i = 0; i < sim.options.n_events; i++) {
        double time_s;
        char *rest;
        time_s = strtod(sim.options.event[i], &rest);
        warn_if_late(time_s, "event", sim.options.event[i]);
    }
    for (size_t i = 0; i < sim.script.n; i++) {
        warn_if_late(sim.script.list[i].time_s, "console line", sim.script.list[i].text);
    }
}

static int run(char *err, size_t err_size)
{
    const struct sim_options *o = &sim.options;
    progress_begin(&sim.progress, o->progress, o->duration_s);
    enum lockstep_result result = lockstep_run(&sim.run);
    progress_end(&sim.progress, (double)sim.run.time_ms / 1000.0, sim.run.samples);
    if (result == RUN_FAILED) {
        (void)sim_fail(err, err_size, "%s", sim.run.error);
        return EXIT_FAILED;
    }
    return result == RUN_INTERRUPTED ? EXIT_INTERRUPTED : EXIT_DONE;
}

static void print_summary(void)
{
    const struct lockstep *k = &sim.run;
    const struct frame_decoder *d = &sim.link.decoder;
    (void)printf("reflux-sim: %" PRIu64 " samples, %.3f s plant time, %.3f s wall time, "
                 "%.0f ticks/s, %" PRIu32 " frames bad, %" PRIu32 " samples repeated, %" PRIu32
                 " controller restarts\n",
                 k->samples, (double)k->time_ms / 1000.0, k->wall_s,
                 (double)k->samples / (k->wall_s > 0.0 ? k->wall_s : 1.0),
                 d->count.bad_crc + d->count.malformed + d->count.overlong, sim.link.count.repeats,
                 k->restarts);
}

static int tidy_up(int status, char *err, size_t err_size)
{
    if (!run_parts_close(&sim) && status == EXIT_DONE) {
        (void)sim_fail(err, err_size,
                       "an output file could not be written to its end (disk full?)");
        status = EXIT_FAILED;
    }
    return status;
}

int reflux_sim(int argc, char **argv)
{
    char err[SIM_ERROR_SIZE] = "";
    if (plant_task_wanted(argc, argv)) {
        int done = plant_task(argc, argv, err, sizeof(err));
        if (err[0] != '\0') {
            (void)fprintf(stderr, "reflux-sim: %s\n", err);
        }
        return done;
    }
    if (!options_read(&sim.options, argc, argv, err, sizeof(err))) {
        (void)fprintf(stderr, "reflux-sim: %s\n", err);
        return EXIT_BAD_INPUT;
    }
    if (sim.options.help) {
        options_print_help();
        return EXIT_DONE;
    }
    struct sigaction action = {.sa_handler = on_signal};
    (void)sigaction(SIGINT, &action, NULL);
    (void)sigaction(SIGTERM, &action, NULL);
    int status;
    if (!run_parts_read(&sim, err, sizeof(err))) {
        status = EXIT_BAD_INPUT;
    } else {
        warn_of_late();
        if (!run_parts_connect(&sim, &interrupted, err, sizeof(err))) {
            status = EXIT_FAILED;
        } else {
            status = run(err, sizeof(err));
            print_summary();
        }
    }
    status = tidy_up(status, err, sizeof(err));
    if (err[0] != '\0') {
        (void)fprintf(stderr, "reflux-sim: %s\n", err);
    }
    return status;
}
