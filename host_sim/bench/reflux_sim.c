/* reflux-sim: reads the command line, puts plant, instruments, link, console and log together, and runs. */
#include "bench/reflux_sim.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "bench/options.h"
#include "bench/text.h"
#include "lockstep.h"
#include "plants/plant_library.h"
#include "plants/plant_task.h"

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_BAD_INPUT = 2, EXIT_INTERRUPTED = 130 };

static volatile sig_atomic_t interrupted;

static void on_signal(int signal_number)
{
    (void)signal_number;
    interrupted = 1;
}

/* Everything a run owns. Static: some of it is large. */
static struct {
    struct sim_options options;
    struct plant *plant;
    struct instruments instruments;
    struct events events;
    struct script script;
    struct sim_log log;
    struct progress progress;
    struct transport port, console_port;
    bool port_open, console_open;
    struct link_server link;
    struct console console;
    FILE *transcript, *telemetry;
    struct lockstep run;
} sim;

static bool open_file(const char *option, const char *path, FILE **file, char *err, size_t err_size)
{
    if (path == NULL) {
        return true;
    }
    *file = fopen(path, "w");
    return *file != NULL || sim_fail(err, err_size, "%s %s: %s", option, path, strerror(errno));
}

static void warn_if_late(double time_s, const char *what, const char *text)
{
    if (sim.options.duration_s >= 0.0 && time_s > sim.options.duration_s) {
        (void)fprintf(stderr,
                      "reflux-sim: warning: %s \"%s\" at %g s comes after the end at %g s\n", what,
                      text, time_s, sim.options.duration_s);
    }
}

/* Checks everything people wrote before anything is connected. */
static bool read_input(char *err, size_t err_size)
{
    const struct sim_options *o = &sim.options;
    for (size_t i = 0; i < o->n_events; i++) {
        if (!events_add(&sim.events, o->class, o->event[i], err, err_size)) {
            return false;
        }
        warn_if_late(sim.events.list[i].time_s, "event", o->event[i]);
    }
    if (!events_finish(&sim.events, o->class, err, err_size)) {
        return false;
    }
    if (o->script != NULL && !script_load(&sim.script, o->script, err, err_size)) {
        return false;
    }
    for (size_t i = 0; i < sim.script.n; i++) {
        warn_if_late(sim.script.list[i].time_s, "console line", sim.script.list[i].text);
    }
    if (!instruments_init(&sim.instruments, o->class, o->seed, o->noise, err, err_size) ||
        !instruments_analysers(&sim.instruments, (double)o->tick_ms / 1000.0, err, err_size)) {
        return false;
    }
    char comment[160];
    (void)snprintf(comment, sizeof(comment), "tick %g s; seed %" PRIu64 "; noise %g",
                   (double)o->tick_ms / 1000.0, o->seed, o->noise);
    return (o->log == NULL ||
            sim_log_open(&sim.log, o->log, &sim.instruments, comment, err, err_size)) &&
           open_file("--transcript", o->transcript, &sim.transcript, err, err_size) &&
           open_file("--telemetry", o->telemetry, &sim.telemetry, err, err_size);
}

/* A number that differs from one start to the next; it appears in no result. */
static uint32_t session_number(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_REALTIME, &now);
    uint64_t x = (uint64_t)now.tv_sec * 1000000007u + (uint64_t)now.tv_nsec + (uint64_t)getpid();
    return (uint32_t)(x ^ (x >> 32));
}

static bool connect_all(char *err, size_t err_size)
{
    const struct sim_options *o = &sim.options;
    uint64_t patience = (uint64_t)(o->timeout_s * 1000.0);
    bool bad_start = false;
    sim.plant = o->n_starts == 0
                    ? plant_create(o->class, err, err_size)
                    : plant_create_at(o->class, o->start, o->n_starts, &bad_start, err, err_size);
    if (sim.plant == NULL) {
        return false;
    }
    if (o->n_starts > 0) {
        instruments_begin(&sim.instruments, sim.plant);
    }
    sim.port_open = transport_open(&sim.port, o->port, patience, err, err_size);
    if (!sim.port_open) {
        return false;
    }
    if (o->console != NULL) {
        sim.console_open = transport_open(&sim.console_port, o->console, patience, err, err_size);
        if (!sim.console_open) {
            return false;
        }
        console_driver_init(&sim.console, &sim.console_port, sim.transcript, sim.telemetry);
    }
    return link_server_init(&sim.link, &sim.port, o->class, o->tick_ms, session_number(), err,
                            err_size);
}

static int run(char *err, size_t err_size)
{
    const struct sim_options *o = &sim.options;
    progress_begin(&sim.progress, o->progress, o->duration_s);
    sim.run = (struct lockstep){.class = o->class,
                                .plant = sim.plant,
                                .instruments = &sim.instruments,
                                .events = &sim.events,
                                .link = &sim.link,
                                .console = sim.console_open ? &sim.console : NULL,
                                .script = &sim.script,
                                .log = &sim.log,
                                .progress = &sim.progress,
                                .tick_ms = o->tick_ms,
                                .duration_s = o->duration_s,
                                .speed = o->speed,
                                .timeout_ms = (uint64_t)(o->timeout_s * 1000.0),
                                .interrupted = &interrupted};
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

static bool close_file(FILE *file)
{
    return file == NULL || fclose(file) == 0;
}

static int tidy_up(int status, char *err, size_t err_size)
{
    if (sim.console_open) {
        transport_close(&sim.console_port);
    }
    if (sim.port_open) {
        transport_close(&sim.port);
    }
    bool written = sim_log_close(&sim.log);
    written = close_file(sim.transcript) && written;
    written = close_file(sim.telemetry) && written;
    if (!written && status == EXIT_DONE) {
        (void)sim_fail(err, err_size,
                       "an output file could not be written to its end (disk full?)");
        status = EXIT_FAILED;
    }
    if (sim.plant != NULL) {
        sim.options.class->destroy(sim.plant);
    }
    script_free(&sim.script);
    plant_library_free();
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
    if (!read_input(err, sizeof(err))) {
        status = EXIT_BAD_INPUT;
    } else if (!connect_all(err, sizeof(err))) {
        status = EXIT_FAILED;
    } else {
        status = run(err, sizeof(err));
        print_summary();
    }
    status = tidy_up(status, err, sizeof(err));
    if (err[0] != '\0') {
        (void)fprintf(stderr, "reflux-sim: %s\n", err);
    }
    return status;
}
