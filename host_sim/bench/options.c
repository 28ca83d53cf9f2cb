#include "bench/options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/events.h"
#include "bench/text.h"
#include "chips/chip.h"
#include "plants/plant_library.h"
#include "plants/plant_task.h"

#define DURATION_MAX_S 3.2e9 /* a century */
#define HELP_COLUMNS   100   /* where a list of options is wrapped */
#define HELP_INDENT    "                         "

/* Prints the options of one kind of channel as lines of --help. */
static void print_options(const char *title, enum plant_kind kind)
{
    const char *name;
    int column = printf(HELP_INDENT "%s:", title);
    for (size_t n = 0; (name = events_option(kind, n)) != NULL; n++) {
        if (column + 1 + (int)strlen(name) > HELP_COLUMNS) {
            column = printf("\n" HELP_INDENT " ") - 1;
        }
        column += printf(" %s", name);
    }
    (void)putchar('\n');
}

static void print_faults(void)
{
    for (size_t k = 0; k < FAULT_KINDS; k++) {
        const struct fault_row *row = &fault_table[k];
        (void)printf(HELP_INDENT " %-18s %g to %g%s%s\n" HELP_INDENT "   %s\n", row->name, row->lo,
                     row->hi, row->unit[0] != '\0' ? " " : "", row->unit, row->about);
    }
}

static void print_pins_faults(void)
{
    size_t n;
    const char *name;
    const struct chip_kind *const *kinds = chip_kinds(&n);
    (void)fputs(
        HELP_INDENT
        "with --wiring, of a line or bus of the file, as T1.open=1; 0 takes it back:\n" HELP_INDENT
        " any chip on a bus: missing, dead, wrong (not on wire1, wire2); and\n",
        stdout);
    for (size_t i = 0; i < n; i++) {
        (void)printf(HELP_INDENT "  %s:", kinds[i]->name);
        for (size_t k = 0; (name = wiring_fault_of_kind(kinds[i], k)) != NULL; k++) {
            (void)printf(" %s", name);
        }
        (void)putchar('\n');
    }
    (void)fputs(HELP_INDENT
                " spi1, i2c1, wire1, ...: noise (a bit is wrong with this probability), "
                "stuck;\n" HELP_INDENT "  of spi1, ...: floats_low\n" HELP_INDENT
                " loads: shorted (not of a valve with two pins or a stepper), broken\n",
                stdout);
}

void options_print_help(void)
{
    (void)fputs(
        "usage: reflux-sim --plant NAME --port WHERE [options]\n"
        "Runs a simulated plant in lockstep with the firmware at the other end of the plant link.\n"
        "\n"
        "  --plant NAME           which plant (see --list), or a file: path/to/plant.json\n"
        "  --port WHERE           plant link: socket:PATH, pty:PATH, newpty[:LINK],\n"
        "                         serial:/dev/ttyX[@BAUD], or the path of a socket or terminal\n"
        "  --console WHERE        the firmware's console, for the options that follow\n"
        "  --script FILE          timed console lines: <time_s> <line>; ?<line> may be refused\n"
        "  --transcript FILE      everything said on the console, with direction and plant time\n"
        "  --telemetry FILE       telemetry header and rows\n"
        "  --log FILE             the run as the simulator saw it, CSV\n"
        "  --outputs FILE         commands to the outputs, in the time of the port, CSV\n"
        "  --wiring FILE          the plant is at the board's own pins, wired as this file says\n"
        "  --rest-on-link         with --wiring: what it does not name is at the link (io.source "
        "both)\n"
        "  --duration S           plant time of the last sample (default: without end)\n"
        "  --tick S               interval of samples in plant time (default: the plant's)\n"
        "  --speed max|X          as fast as it goes, or X times the clock on the wall, of a "
        "virtual board\n"
        "                         its own clock (default max)\n"
        "  --event T:NAME=VALUE   at plant time T; repeatable. NAME: a disturbance, "
        "CHANNEL.option, noise\n"
        "                         disturbances: swing (amplitude of a sine) period (s, 1200)\n",
        stdout);
    print_options("measurements", PLANT_MEASUREMENT);
    print_options("manipulated variables", PLANT_MV);
    (void)fputs("                         (docs/inside/faults.md says what each does)\n"
                "                         of a virtual board, as board.power_cut=2:\n",
                stdout);
    print_faults();
    print_pins_faults();
    (void)fputs(
        "  --measure NAME         a truth of the plant becomes a measurement, without lag and "
        "noise;\n"
        "                         repeatable\n"
        "  --start NAME=VALUE     the run begins at the steady state of this input; repeatable\n"
        "  --seed N               of the sensor noise (default 1)\n"
        "  --noise X              noise of all sensors, times their own (default 1)\n"
        "  --timeout S            longest wait for one answer, wall clock (default 10)\n"
        "  --progress             show how far the run has come, on stderr\n"
        "  --help                 this text\n",
        stdout);
    (void)fputs(plant_task_help, stdout);
    (void)fputs(
        "\n"
        "exit status: 0 done, 1 the run failed, 2 bad option or input file, 130 interrupted\n",
        stdout);
}

static bool number(const char *name, const char *text, double lo, double hi, const char *unit,
                   double *x, char *err, size_t err_size)
{
    if (sim_parse_number(text, x) && *x >= lo && *x <= hi) {
        return true;
    }
    return sim_fail(err, err_size, "%s %s: must be a number from %g to %g%s", name, text, lo, hi,
                    unit);
}

static bool take_plant(struct sim_options *o, const char *text, char *err, size_t err_size)
{
    char reason[SIM_ERROR_SIZE] = "";
    o->class = plant_open(text, reason, sizeof(reason));
    return o->class != NULL || sim_fail(err, err_size, "--plant %s", reason);
}

static bool take_number(struct sim_options *o, const char *name, const char *text, char *err,
                        size_t err_size)
{
    double x = 0.0;
    if (strcmp(name, "--speed") == 0) {
        o->speed = 0.0;
        if (strcmp(text, "max") == 0) {
            return true;
        }
        if (!sim_parse_number(text, &o->speed) || o->speed < 1e-3 || o->speed > 1e6) {
            return sim_fail(err, err_size, "--speed %s: must be max or a number from 0.001 to 1e6",
                            text);
        }
        return true;
    }
    if (strcmp(name, "--seed") == 0) {
        return sim_parse_unsigned(text, &o->seed) ||
               sim_fail(err, err_size, "--seed %s: must be a whole number from 0 to 2^64 - 1",
                        text);
    }
    if (strcmp(name, "--noise") == 0) {
        return number(name, text, 0.0, 1e6, "", &o->noise, err, err_size);
    }
    if (strcmp(name, "--duration") == 0) {
        return number(name, text, 0.0, DURATION_MAX_S, " s", &o->duration_s, err, err_size);
    }
    if (strcmp(name, "--timeout") == 0) {
        return number(name, text, 0.01, 86400.0, " s", &o->timeout_s, err, err_size);
    }
    if (!number(name, text, 0.001, 86400.0, " s", &x, err, err_size)) { /* --tick */
        return false;
    }
    if (fabs(x * 1000.0 - round(x * 1000.0)) > 1e-6) {
        return sim_fail(err, err_size, "--tick %s: must be a whole number of milliseconds", text);
    }
    o->tick_ms = (uint32_t)lround(x * 1000.0);
    return true;
}

static bool take_value(struct sim_options *o, const char *name, const char *text, char *err,
                       size_t err_size)
{
    static const char *const numbers[] = {"--speed",    "--seed",    "--noise",
                                          "--duration", "--timeout", "--tick"};
    const struct {
        const char *name;
        const char **value;
    } texts[] = {{"--port", &o->port},           {"--console", &o->console},
                 {"--script", &o->script},       {"--transcript", &o->transcript},
                 {"--telemetry", &o->telemetry}, {"--log", &o->log},
                 {"--outputs", &o->outputs},     {"--wiring", &o->wiring}};
    if (strcmp(name, "--plant") == 0) {
        return take_plant(o, text, err, err_size);
    }
    if (strcmp(name, "--event") == 0) {
        if (o->n_events == OPTIONS_EVENTS_MAX) {
            return sim_fail(err, err_size, "--event %s: more than %d events", text,
                            OPTIONS_EVENTS_MAX);
        }
        o->event[o->n_events] = text;
        o->n_events++;
        return true;
    }
    if (strcmp(name, "--measure") == 0) {
        if (o->n_measures == OPTIONS_STARTS_MAX) {
            return sim_fail(err, err_size, "--measure %s: more than %d truths", text,
                            OPTIONS_STARTS_MAX);
        }
        o->measure[o->n_measures] = text;
        o->n_measures++;
        return true;
    }
    if (strcmp(name, "--start") == 0) {
        if (o->n_starts == OPTIONS_STARTS_MAX) {
            return sim_fail(err, err_size, "--start %s: more than %d inputs", text,
                            OPTIONS_STARTS_MAX);
        }
        o->start_text[o->n_starts] = text;
        o->n_starts++;
        return true;
    }
    for (size_t k = 0; k < sizeof(texts) / sizeof(texts[0]); k++) {
        if (strcmp(name, texts[k].name) == 0) {
            *texts[k].value = text;
            return text[0] != '\0' || sim_fail(err, err_size, "%s: must not be empty", name);
        }
    }
    for (size_t k = 0; k < sizeof(numbers) / sizeof(numbers[0]); k++) {
        if (strcmp(name, numbers[k]) == 0) {
            return take_number(o, name, text, err, err_size);
        }
    }
    return sim_fail(err, err_size, "%s: unknown option; see reflux-sim --help", name);
}

static bool complete(struct sim_options *o, char *err, size_t err_size)
{
    if (o->help) {
        return true;
    }
    if (o->class == NULL || o->port == NULL) {
        return sim_fail(err, err_size, "%s is missing; see reflux-sim --help",
                        o->class == NULL ? "--plant NAME" : "--port WHERE");
    }
    if (o->console == NULL &&
        (o->script != NULL || o->transcript != NULL || o->telemetry != NULL)) {
        return sim_fail(err, err_size, "%s needs --console WHERE",
                        o->script != NULL       ? "--script"
                        : o->transcript != NULL ? "--transcript"
                                                : "--telemetry");
    }
    if (o->rest_on_link && o->wiring == NULL) {
        return sim_fail(err, err_size, "--rest-on-link needs --wiring FILE");
    }
    if (o->n_measures > 0) {
        o->class = plant_measuring(o->class, o->measure, o->n_measures, err, err_size);
        if (o->class == NULL) {
            return false;
        }
    }
    for (size_t k = 0; k < o->n_starts; k++) {
        if (!plant_read_input("--start", o->class, o->start_text[k], &o->start[k], err, err_size)) {
            return false;
        }
    }
    if (o->tick_ms == 0) {
        o->tick_ms = (uint32_t)lround(o->class->tick_s * 1000.0);
    }
    if (o->class->period_s > 0.0 && o->tick_ms != (uint32_t)lround(o->class->period_s * 1000.0)) {
        return sim_fail(err, err_size,
                        "--tick %g: %s is a discrete plant of period %g s; no other tick will do",
                        (double)o->tick_ms / 1000.0, o->class->name, o->class->period_s);
    }
    return true;
}

bool options_read(struct sim_options *o, int argc, char **argv, char *err, size_t err_size)
{
    *o = (struct sim_options){.seed = 1, .noise = 1.0, .duration_s = -1.0, .timeout_s = 10.0};
    for (int i = 1; i < argc; i++) {
        const char *name = argv[i];
        if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
            o->help = true;
        } else if (strcmp(name, "--progress") == 0) {
            o->progress = true;
        } else if (strcmp(name, "--rest-on-link") == 0) {
            o->rest_on_link = true;
        } else if (strncmp(name, "--", 2) != 0) {
            return sim_fail(err, err_size, "%s: not an option; see reflux-sim --help", name);
        } else if (strchr(name, '=') != NULL) { /* --name=value */
            char *equals = strchr(argv[i], '=');
            *equals = '\0';
            if (!take_value(o, name, equals + 1, err, err_size)) {
                return false;
            }
        } else {
            const char *value = i + 1 < argc ? argv[i + 1] : "";
            struct sim_options unused = *o;
            if (i + 1 >= argc && (take_value(&unused, name, value, err, err_size) ||
                                  strstr(err, "unknown option") == NULL)) {
                return sim_fail(err, err_size, "%s: a value is missing", name);
            }
            if (!take_value(o, name, value, err, err_size)) {
                return false;
            }
            i++;
        }
    }
    return complete(o, err, err_size);
}
