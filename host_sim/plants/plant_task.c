#include "plants/plant_task.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/text.h"
#include "columns/column_profile.h"
#include "columns/table_task.h"
#include "plants/plant_inputs.h"
#include "plants/plant_library.h"
#include "plants/plant_print.h"

enum { EXIT_DONE = 0, EXIT_FAILED = 1, EXIT_BAD_INPUT = 2 };

#define SETS_MAX  64
#define TICKS_MAX 1e6

const char plant_task_help[] =
    "\n"
    "A plant alone, without a firmware (CSV onto stdout):\n"
    "  --list [NAME]          all plants, one a line; or one in full, with its channels and "
    "source\n"
    "  --steady --plant NAME  the steady state\n"
    "  --profile --plant NAME every stage of a column: temperature, its difference to the stage\n"
    "                         below, flows, holdup, compositions; --format csv|json\n"
    "  --linearise --plant NAME   matrices A, B, C, D there; --format csv|json\n"
    "  --step --plant NAME    response to a step of every input; --size % of span (default 5),\n"
    "                         --duration S (default 200 ticks), --tick S\n"
    "  --table --plant NAME   the compact table of a column, as console lines for a board:\n"
    "                         --components A,B,C (the last closes, or --closing A), --truncated "
    "2-9,12,\n"
    "                         --antoine 320-370 (three constants, fitted there, K), --block N "
    "(default 1)\n"
    "  --table-check FILE     what such lines say, or what is wrong with them\n"
    "  --set NAME=VALUE       for these: an input's value instead of its nominal one\n";

static struct {
    const char *task, *list, *plant, *lines;
    struct table_task table;
    const char *set[SETS_MAX];
    size_t n_sets;
    double tick_s, duration_s, percent;
    bool json, bad_set;
    const struct plant_class *class;
} task;

static bool is_task(const char *text)
{
    return strcmp(text, "--list") == 0 || strcmp(text, "--steady") == 0 ||
           strcmp(text, "--profile") == 0 || strcmp(text, "--linearise") == 0 ||
           strcmp(text, "--step") == 0 || strcmp(text, "--table") == 0 ||
           strcmp(text, "--table-check") == 0;
}

bool plant_task_wanted(int argc, char **argv)
{
    for (int i = 1; i < argc; i++) {
        if (is_task(argv[i])) {
            return true;
        }
    }
    return false;
}

static bool number(const char *name, const char *text, double lo, double hi, double *x, char *err,
                   size_t err_size)
{
    return (sim_parse_number(text, x) && *x >= lo && *x <= hi) ||
           sim_fail(err, err_size, "%s %s: must be a number from %g to %g", name, text, lo, hi);
}

static bool take_value(const char *name, const char *text, char *err, size_t err_size)
{
    if (strcmp(name, "--plant") == 0) {
        task.plant = text;
        return true;
    }
    if (strcmp(name, "--set") == 0) {
        if (task.n_sets == SETS_MAX) {
            return sim_fail(err, err_size, "--set %s: more than %d values", text, SETS_MAX);
        }
        task.set[task.n_sets++] = text;
        return true;
    }
    if (strcmp(name, "--format") == 0) {
        task.json = strcmp(text, "json") == 0;
        return task.json || strcmp(text, "csv") == 0 ||
               sim_fail(err, err_size, "--format %s: must be csv or json", text);
    }
    if (strcmp(name, "--size") == 0) {
        return number(name, text, 1e-6, 50.0, &task.percent, err, err_size);
    }
    if (strcmp(name, "--tick") == 0) {
        return number(name, text, 0.001, 86400.0, &task.tick_s, err, err_size);
    }
    if (strcmp(name, "--duration") == 0) {
        return number(name, text, 0.0, 1e9, &task.duration_s, err, err_size);
    }
    if (strcmp(task.task, "--table") == 0 && strcmp(name, "--components") == 0) {
        task.table.components = text;
        return true;
    }
    if (strcmp(task.task, "--table") == 0 && strcmp(name, "--closing") == 0) {
        task.table.closing = text;
        return true;
    }
    if (strcmp(task.task, "--table") == 0 && strcmp(name, "--truncated") == 0) {
        task.table.truncated = text;
        return true;
    }
    if (strcmp(task.task, "--table") == 0 && strcmp(name, "--antoine") == 0) {
        task.table.antoine = text;
        return true;
    }
    if (strcmp(task.task, "--table") == 0 && strcmp(name, "--block") == 0) {
        return number(name, text, 1.0, TABLE_BLOCKS, &task.table.block, err, err_size);
    }
    return sim_fail(err, err_size, "%s: has no meaning with %s; see reflux-sim --help", name,
                    task.task);
}

static bool read_arguments(int argc, char **argv, char *err, size_t err_size)
{
    task.percent = 5.0;
    task.table.block = 1.0;
    task.duration_s = -1.0;
    task.task = "--list"; /* replaced: plant_task_wanted() has seen one */
    for (int i = argc - 1; i > 0; i--) {
        task.task = is_task(argv[i]) ? argv[i] : task.task;
    }
    for (int i = 1; i < argc; i++) {
        if (is_task(argv[i])) {
            if (strcmp(argv[i], task.task) != 0) {
                return sim_fail(err, err_size, "%s and %s: only one of them at a time", task.task,
                                argv[i]);
            }
            if (strcmp(argv[i], "--list") == 0 && i + 1 < argc && argv[i + 1][0] != '-') {
                task.list = argv[++i];
            }
            if (strcmp(argv[i], "--table-check") == 0) {
                if (i + 1 == argc) {
                    return sim_fail(err, err_size, "--table-check: a file is missing");
                }
                task.lines = argv[++i];
            }
        } else if (strncmp(argv[i], "--", 2) == 0 && i + 1 < argc) {
            if (!take_value(argv[i], argv[i + 1], err, err_size)) {
                return false;
            }
            i++;
        } else {
            return sim_fail(err, err_size, "%s: %s; see reflux-sim --help", argv[i],
                            i + 1 < argc ? "not an option"
                                         : "not an option, or its value is missing");
        }
    }
    return true;
}

/* The class, and what the command line says about ticks, checked against it. */
static bool open_class(const char *name, char *err, size_t err_size)
{
    char reason[SIM_ERROR_SIZE] = "";
    task.class = plant_open(name, reason, sizeof(reason));
    if (task.class == NULL) {
        return sim_fail(err, err_size, "--plant %s", reason);
    }
    if (task.tick_s == 0.0) {
        task.tick_s = task.class->tick_s;
    }
    if (task.class->period_s > 0.0 && task.tick_s != task.class->period_s) {
        return sim_fail(err, err_size,
                        "--tick %g: %s is a discrete plant of period %g s; no other "
                        "tick will do",
                        task.tick_s, task.class->name, task.class->period_s);
    }
    return true;
}

/* The plant at the steady state that --set asks for. */
static struct plant *begin(char *err, size_t err_size)
{
    struct plant_change change[SETS_MAX];
    for (size_t k = 0; k < task.n_sets; k++) {
        if (!plant_read_input("--set", task.class, task.set[k], &change[k], err, err_size)) {
            task.bad_set = true;
            return NULL;
        }
    }
    return plant_create_at(task.class, change, task.n_sets, &task.bad_set, err, err_size);
}

static int list(char *err, size_t err_size)
{
    const char *name = task.list != NULL ? task.list : task.plant;
    if (name != NULL) {
        if (!open_class(name, err, err_size)) {
            return EXIT_BAD_INPUT;
        }
        plant_print_full(task.class);
        return EXIT_DONE;
    }
    plant_library_each(plant_print_line);
    (void)printf(
        "  One in full: --list NAME. A plant of your own: --plant FILE.json, or a file in the "
        "folder REFLUX_PLANTS.\n"
        "  Not here: example 11 of Johansson (1994), a drum boiler-turbine; its matrices are "
        "lost in the text at hand.\n");
    return EXIT_DONE;
}

static int work(char *err, size_t err_size)
{
    bool good = false;
    if (strcmp(task.task, "--step") == 0) {
        double ticks = task.duration_s < 0.0 ? 200.0 : ceil(task.duration_s / task.tick_s - 1e-9);
        if (!(ticks <= TICKS_MAX)) {
            (void)sim_fail(err, err_size, "--duration %g: %.0f ticks of %g s; at most %g",
                           task.duration_s, ticks, task.tick_s, TICKS_MAX);
            return EXIT_BAD_INPUT;
        }
        good = plant_print_steps(task.class, begin, task.tick_s, (size_t)ticks, task.percent, err,
                                 err_size);
        return good ? EXIT_DONE : task.bad_set ? EXIT_BAD_INPUT : EXIT_FAILED;
    }
    bool profile = strcmp(task.task, "--profile") == 0;
    if (profile && task.class->column == NULL) {
        (void)sim_fail(err, err_size,
                       "--profile: %s is not a column that comes from a file; it has no "
                       "stages to show",
                       task.class->name);
        return EXIT_BAD_INPUT;
    }
    struct plant *p = begin(err, err_size);
    struct linearised matrices;
    if (p != NULL && strcmp(task.task, "--steady") == 0) {
        plant_print_values(task.class, p);
        good = true;
    } else if (p != NULL && profile) {
        column_profile_print(task.class, p, task.json);
        good = true;
    } else if (p != NULL && strcmp(task.task, "--table") == 0) {
        good = table_task_print(task.class, p, &task.table, err, err_size);
        task.bad_set = !good;
    } else if (p != NULL && linearise(task.class, p, &matrices, err, err_size)) {
        plant_print_matrices(task.class, &matrices, task.json);
        linearised_free(&matrices);
        good = true;
    }
    if (p != NULL) {
        task.class->destroy(p);
    }
    return good ? EXIT_DONE : task.bad_set ? EXIT_BAD_INPUT : EXIT_FAILED;
}

int plant_task(int argc, char **argv, char *err, size_t err_size)
{
    int status = EXIT_BAD_INPUT;
    if (!read_arguments(argc, argv, err, err_size)) {
        return status;
    }
    if (strcmp(task.task, "--list") == 0) {
        status = list(err, err_size);
    } else if (strcmp(task.task, "--table-check") == 0) {
        status = table_task_check(task.lines, err, err_size) ? EXIT_DONE : EXIT_BAD_INPUT;
    } else if (task.plant == NULL) {
        (void)sim_fail(err, err_size, "--plant NAME is missing; see reflux-sim --help");
    } else if (open_class(task.plant, err, err_size)) {
        status = work(err, err_size);
    }
    plant_library_free();
    return status;
}
