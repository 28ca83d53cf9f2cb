/* Everything that a run is put together from: plant, instruments, events, script, link, console, files. Its owner moves it with
 * lockstep.h: reflux-sim from start to end, tools/libreflux/lab.c piece by piece.
 *
 * Order of calls: run_parts_read(), run_parts_connect(), a run with `run`, run_parts_close(). The last is right after
 * any of them, whatever they returned.
 */
#ifndef REFLUX_HOST_SIM_RUN_PARTS_H
#define REFLUX_HOST_SIM_RUN_PARTS_H

#include "bench/options.h"
#include "lockstep.h"

/* Large: keep it static. All zero at first, but for the options. */
struct run_parts {
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
    struct wiring *wiring; /* with --wiring, and so */
    struct pins_side pins;
    struct rest_side rest; /* with --rest-on-link */
    struct console console;
    FILE *transcript, *telemetry;
    struct output_log outputs;
    struct lockstep run;
};

/* Checks everything that people wrote before anything is connected, and opens the files that the options name. */
bool run_parts_read(struct run_parts *p, char *err, size_t err_size);

/* Makes the plant, opens the lines and sets up `run`. */
bool run_parts_connect(struct run_parts *p, const volatile sig_atomic_t *interrupted, char *err,
                       size_t err_size);

/* Text of the second comment of a log. */
void run_parts_comment(const struct run_parts *p, char *text, size_t size);

/* Closes and frees everything; false when a file could not be written to its end. */
bool run_parts_close(struct run_parts *p);

#endif
