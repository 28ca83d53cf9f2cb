/* The command line of reflux-sim, read strictly: a wrong option is one line that says what would be right. */
#ifndef REFLUX_HOST_SIM_OPTIONS_H
#define REFLUX_HOST_SIM_OPTIONS_H

#include "plants/plant_inputs.h"

#include <stdint.h>

#define OPTIONS_EVENTS_MAX 1024
#define OPTIONS_STARTS_MAX 32

struct sim_options {
    const struct plant_class *class;
    const char *port, *console, *script, *transcript, *telemetry, *log, *outputs, *wiring;
    double speed; /* 0 = max */
    uint64_t seed;
    double noise;
    double duration_s; /* negative: without end */
    uint32_t tick_ms;
    double timeout_s;
    bool progress, rest_on_link, help;
    const char *event[OPTIONS_EVENTS_MAX];
    size_t n_events;
    const char *measure[OPTIONS_STARTS_MAX];
    size_t n_measures;
    const char *start_text[OPTIONS_STARTS_MAX];
    struct plant_change start[OPTIONS_STARTS_MAX];
    size_t n_starts;
};

bool options_read(struct sim_options *o, int argc, char **argv, char *err, size_t err_size);
void options_print_help(void);

#endif
