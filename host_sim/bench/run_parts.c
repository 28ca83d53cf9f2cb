#include "bench/run_parts.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "bench/text.h"
#include "plants/plant_library.h"

static bool open_file(const char *option, const char *path, FILE **file, char *err, size_t err_size)
{
    if (path == NULL) {
        return true;
    }
    *file = fopen(path, "w");
    return *file != NULL || sim_fail(err, err_size, "%s %s: %s", option, path, strerror(errno));
}

void run_parts_comment(const struct run_parts *p, char *text, size_t size)
{
    (void)snprintf(text, size, "tick %g s; seed %" PRIu64 "; noise %g",
                   (double)p->options.tick_ms / 1000.0, p->options.seed, p->options.noise);
}

bool run_parts_read(struct run_parts *p, char *err, size_t err_size)
{
    const struct sim_options *o = &p->options;
    if (o->wiring != NULL) {
        p->wiring = wiring_read(o->wiring, o->seed, err, err_size);
        if (p->wiring == NULL) {
            return false;
        }
        p->events.wiring = p->wiring;
    }
    for (size_t i = 0; i < o->n_events; i++) {
        if (!events_add(&p->events, o->class, o->event[i], err, err_size)) {
            return false;
        }
    }
    if (!events_finish(&p->events, o->class, err, err_size)) {
        return false;
    }
    if (events_want_board(&p->events) && strncmp(o->port, "board:", 6) != 0 &&
        strcmp(o->port, "memory") != 0) {
        return sim_fail(err, err_size,
                        "--port %s: an event is a fault of a virtual board, and only one at "
                        "board:PATH can have it",
                        o->port);
    }
    if (o->script != NULL && !script_load(&p->script, o->script, err, err_size)) {
        return false;
    }
    if (!instruments_init(&p->instruments, o->class, o->seed, o->noise, err, err_size) ||
        !instruments_analysers(&p->instruments, (double)o->tick_ms / 1000.0, err, err_size)) {
        return false;
    }
    char comment[160];
    run_parts_comment(p, comment, sizeof(comment));
    return (o->log == NULL ||
            sim_log_open(&p->log, o->log, &p->instruments, comment, err, err_size)) &&
           open_file("--transcript", o->transcript, &p->transcript, err, err_size) &&
           open_file("--telemetry", o->telemetry, &p->telemetry, err, err_size) &&
           (o->outputs == NULL ||
            output_log_open(&p->outputs, o->outputs, o->class, err, err_size));
}

/* Differs from one start to the next. A board that keeps the time is new with each run: there the same bytes go out again, for what
 * a frame holds is what the board takes time for. */
static uint32_t session_number(const struct transport *port)
{
    if (transport_keeps_time(port)) {
        return 1;
    }
    struct timespec now;
    (void)clock_gettime(CLOCK_REALTIME, &now);
    uint64_t x = (uint64_t)now.tv_sec * 1000000007u + (uint64_t)now.tv_nsec + (uint64_t)getpid();
    return (uint32_t)(x ^ (x >> 32));
}

static bool make_plant(struct run_parts *p, char *err, size_t err_size)
{
    const struct sim_options *o = &p->options;
    bool bad_start = false;
    p->plant = o->n_starts == 0
                   ? plant_create(o->class, err, err_size)
                   : plant_create_at(o->class, o->start, o->n_starts, &bad_start, err, err_size);
    if (p->plant != NULL && o->n_starts > 0) {
        instruments_begin(&p->instruments, p->plant);
    }
    return p->plant != NULL;
}

/* A load that is switched is on or off at once: the plant's own actuator, which takes seconds for its way, would never get there. */
static void release_switched(struct run_parts *p)
{
    const struct plant_class *class = p->options.class;
    size_t output = 0;
    for (size_t i = 0; i < class->n_channels; i++) {
        if (class->channels[i].kind == PLANT_MV && pins_side_switches(&p->pins, output++)) {
            instruments_set(&p->instruments, i, OPTION_SLEW, 0.0);
        }
    }
}

/* With --wiring: the pins, and the link for what is at none of them. */
static bool wire(struct run_parts *p, uint32_t session, char *err, size_t err_size)
{
    const struct sim_options *o = &p->options;
    p->run.pins = &p->pins;
    p->run.rest = o->rest_on_link ? &p->rest : NULL;
    if (!pins_side_open(&p->pins, &p->port, p->wiring, o->wiring, o->class, o->tick_ms, o->seed,
                        err, err_size)) {
        return false;
    }
    release_switched(p);
    return !o->rest_on_link || rest_side_open(&p->rest, &p->link, &p->pins, o->class, o->tick_ms,
                                              session, err, err_size);
}

bool run_parts_connect(struct run_parts *p, const volatile sig_atomic_t *interrupted, char *err,
                       size_t err_size)
{
    const struct sim_options *o = &p->options;
    uint64_t patience = (uint64_t)(o->timeout_s * 1000.0);
    if (!make_plant(p, err, err_size)) {
        return false;
    }
    p->port_open = transport_open(&p->port, o->port, patience, err, err_size);
    if (!p->port_open) {
        return false;
    }
    p->events.board = &p->port;
    if (o->console != NULL) {
        p->console_open = transport_open(&p->console_port, o->console, patience, err, err_size);
        if (!p->console_open) {
            return false;
        }
        console_driver_init(&p->console, &p->console_port, p->transcript, p->telemetry);
    }
    p->run = (struct lockstep){.class = o->class,
                               .plant = p->plant,
                               .instruments = &p->instruments,
                               .events = &p->events,
                               .link = &p->link,
                               .console = p->console_open ? &p->console : NULL,
                               .script = &p->script,
                               .log = &p->log,
                               .progress = &p->progress,
                               .tick_ms = o->tick_ms,
                               .duration_s = o->duration_s,
                               .speed = o->speed,
                               .timeout_ms = patience,
                               .interrupted = interrupted};
    uint32_t session = session_number(&p->port);
    if (!link_server_init(&p->link, &p->port, o->class, o->tick_ms, session, err, err_size)) {
        return false;
    }
    if (o->wiring != NULL && !wire(p, session, err, err_size)) {
        return false;
    }
    p->link.outputs = &p->outputs;
    return true;
}

static bool close_file(FILE *file)
{
    return file == NULL || fclose(file) == 0;
}

bool run_parts_close(struct run_parts *p)
{
    wiring_free(p->wiring);
    p->wiring = NULL;
    p->events.wiring = NULL;
    if (p->console_open) {
        transport_close(&p->console_port);
    }
    if (p->port_open) {
        transport_close(&p->port);
    }
    p->console_open = p->port_open = false;
    bool written = sim_log_close(&p->log);
    written = close_file(p->transcript) && written;
    written = close_file(p->telemetry) && written;
    written = output_log_close(&p->outputs) && written;
    p->transcript = p->telemetry = NULL;
    if (p->plant != NULL) {
        p->options.class->destroy(p->plant);
        p->plant = NULL;
    }
    script_free(&p->script);
    plant_library_free();
    return written;
}
