#include "lab.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bench/run_parts.h"
#include "bench/text.h"
#include "memory_transport.h"

#define OPTIONS_MAX 256

static struct run_parts lab;
static bool usable;
static char error[SIM_ERROR_SIZE];
static const volatile sig_atomic_t never;

/* A text under way, and the one handed out last. */
static struct text {
    FILE *file;
    char *buffer, *given;
    size_t size;
} texts[LAB_TEXTS];

static bool begin_text(struct text *x)
{
    x->buffer = NULL;
    x->file = open_memstream(&x->buffer, &x->size);
    return x->file != NULL || sim_fail(error, sizeof(error), "there is no memory for the log");
}

/* The owners of the files write into the new ones from now on. */
static void attach_texts(void)
{
    lab.log.file = texts[LAB_LOG].file;
    lab.console.telemetry = texts[LAB_TELEMETRY].file;
    lab.console.transcript = texts[LAB_CONSOLE].file;
}

static int32_t failed(const char *why)
{
    (void)sim_fail(error, sizeof(error), "%s", why);
    usable = false;
    return LAB_FAILED;
}

static int32_t no_lab(void)
{
    if (!usable && error[0] == '\0') {
        (void)sim_fail(error, sizeof(error), "there is no lab: it was not opened, or is closed");
    }
    return usable ? LAB_DONE : LAB_FAILED;
}

static bool read_options(int32_t n, const char *const *option)
{
    static char words[OPTIONS_MAX][512];
    static char *argv[OPTIONS_MAX + 6];
    static char *const fixed[] = {"lab", "--port", "memory", "--console", "memory"};
    int argc = 0;
    for (size_t k = 0; k < sizeof(fixed) / sizeof(fixed[0]); k++) {
        argv[argc] = fixed[k];
        argc++;
    }
    for (int32_t k = 0; k < n; k++) {
        if (n > OPTIONS_MAX || strlen(option[k]) >= sizeof(words[0])) {
            return sim_fail(error, sizeof(error), "at most %d options of less than %zu characters",
                            OPTIONS_MAX, sizeof(words[0]));
        }
        (void)snprintf(words[k], sizeof(words[k]), "%s", option[k]);
        argv[argc] = words[k];
        argc++;
    }
    return options_read(&lab.options, argc, argv, error, sizeof(error));
}

int32_t reflux_lab_open(int32_t n, const char *const *option)
{
    error[0] = '\0';
    if (usable) {
        (void)sim_fail(error, sizeof(error), "a lab is open; close it first");
        return LAB_REFUSED;
    }
    transport_add_scheme("memory", memory_transport_open);
    if (!read_options(n, option) || !run_parts_read(&lab, error, sizeof(error))) {
        return LAB_REFUSED;
    }
    for (int k = 0; k < LAB_TEXTS; k++) {
        if (!begin_text(&texts[k])) {
            return LAB_FAILED;
        }
    }
    char comment[160];
    run_parts_comment(&lab, comment, sizeof(comment));
    sim_log_begin(&lab.log, texts[LAB_LOG].file, &lab.instruments, comment);
    if (!run_parts_connect(&lab, &never, error, sizeof(error))) {
        return LAB_FAILED;
    }
    attach_texts();
    if (lockstep_begin(&lab.run) != RUN_DONE) {
        return failed(lab.run.error);
    }
    usable = true;
    return LAB_DONE;
}

int32_t reflux_lab_say(const char *line)
{
    if (no_lab() != LAB_DONE) {
        return LAB_FAILED;
    }
    if (strlen(line) >= SCRIPT_LINE_SIZE) {
        (void)sim_fail(error, sizeof(error), "a console line has at most %d characters",
                       SCRIPT_LINE_SIZE - 1);
        return LAB_REFUSED;
    }
    if (lockstep_line(&lab.run, line) != RUN_DONE) {
        return failed(lab.run.error);
    }
    if (lab.console.reply == REPLY_ERR) {
        (void)sim_fail(error, sizeof(error), "%s", lab.console.reply_text);
        return LAB_REFUSED;
    }
    return LAB_DONE;
}

int32_t reflux_lab_event(const char *text)
{
    if (no_lab() != LAB_DONE) {
        return LAB_FAILED;
    }
    return events_insert(&lab.events, lab.options.class, text, error, sizeof(error)) ? LAB_DONE
                                                                                     : LAB_REFUSED;
}

int32_t reflux_lab_step(int32_t samples)
{
    if (no_lab() != LAB_DONE) {
        return LAB_FAILED;
    }
    for (int32_t k = 0; k < samples; k++) {
        if (lockstep_step(&lab.run) != RUN_DONE) {
            return failed(lab.run.error);
        }
    }
    return LAB_DONE;
}

double reflux_lab_time_s(void)
{
    return (double)lab.run.time_ms / 1000.0;
}

uint32_t reflux_lab_number(void)
{
    return lab.run.number;
}

double reflux_lab_tick_s(void)
{
    return (double)lab.run.tick_ms / 1000.0;
}

double reflux_lab_value(const char *channel)
{
    const struct plant_class *class = lab.options.class;
    for (size_t k = 0; lab.plant != NULL && k < class->n_channels; k++) {
        if (strcmp(class->channels[k].name, channel) != 0) {
            continue;
        }
        for (size_t i = 0; i < lab.instruments.n_sensors; i++) {
            if (lab.instruments.sensor[i].channel == k) {
                return lab.run.samples > 0 ? (double)lab.instruments.sensor[i].reading : NAN;
            }
        }
        for (size_t i = 0; i < lab.instruments.n_actuators; i++) {
            if (lab.instruments.actuator[i].channel == k) {
                return lab.instruments.actuator[i].output;
            }
        }
        return class->value(lab.plant, k);
    }
    return NAN;
}

const char *reflux_lab_channel(int32_t k, const char **unit, int32_t *kind, double *lo, double *hi,
                               double *nominal)
{
    const struct plant_class *class = lab.options.class;
    if (class == NULL || k < 0 || (size_t)k >= class->n_channels) {
        return NULL;
    }
    const struct plant_channel *c = &class->channels[k];
    *unit = c->unit;
    *kind = (int32_t)c->kind;
    *lo = c->lo;
    *hi = c->hi;
    *nominal = c->nominal;
    return c->name;
}

const char *reflux_lab_text(int32_t which, size_t *length)
{
    *length = 0;
    if (which < 0 || which >= LAB_TEXTS || texts[which].file == NULL) {
        return "";
    }
    struct text *x = &texts[which];
    free(x->given);
    x->given = NULL;
    if (fclose(x->file) == 0) {
        x->given = x->buffer;
        *length = x->size;
    }
    if (!begin_text(x)) {
        usable = false;
    }
    attach_texts();
    return x->given != NULL ? x->given : "";
}

const char *reflux_lab_error(void)
{
    return error;
}

void reflux_lab_close(void)
{
    usable = false;
    lab.log.file = NULL;
    lab.console.telemetry = lab.console.transcript = NULL;
    (void)run_parts_close(&lab);
    for (int k = 0; k < LAB_TEXTS; k++) {
        struct text *x = &texts[k];
        if (x->file != NULL) {
            (void)fclose(x->file);
            free(x->buffer);
        }
        free(x->given);
        *x = (struct text){0};
    }
    (void)memset(&lab, 0, sizeof(lab));
    error[0] = '\0';
}
