/* reflux-plant: a plant alone between standard input and output, for programs that try out many inputs on it. True values, no
 * instruments. One command a line, one line of answer, `err` and the reason where it fails.
 *
 *   plant NAME              opens it at its nominal steady state
 *   set CHANNEL VALUE       an input, from now on
 *   keep                    the state as it is now, after the last `try` that is its end, is where `try` begins
 *   try DT N IN... : OUT... : VALUES
 *                           from the kept state N intervals of DT seconds; VALUES are those of the inputs IN, interval by
 *                           interval. Answers OUT at the end of each
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "plants/plant.h"
#include "plants/plant_library.h"

#define LINE_MAX_BYTES 200000
#define LIST_MAX       24
#define STATES_MAX     4096

static char line[LINE_MAX_BYTES];
static char err[512];
static const struct plant_class *class;
static struct plant *plant;
static double kept[STATES_MAX];
static double time_s;

static bool refuse(const char *what)
{
    (void)printf("err %s\n", what);
    return false;
}

static bool channel_of(const char *name, size_t *found)
{
    for (size_t i = 0; i < class->n_channels; i++) {
        if (strcmp(class->channels[i].name, name) == 0) {
            *found = i;
            return true;
        }
    }
    return refuse("no such channel");
}

static bool number_of(const char *word, double *value)
{
    char *end = NULL;
    *value = word != NULL ? strtod(word, &end) : 0.0;
    return (end != word && end != NULL && *end == '\0') || refuse("a number is missing");
}

static bool open_plant(const char *name)
{
    class = name != NULL ? plant_open(name, err, sizeof(err)) : NULL;
    plant = class != NULL ? plant_create(class, err, sizeof(err)) : NULL;
    if (plant == NULL) {
        return refuse(err);
    }
    if (class->states == NULL || class->states->count(plant) > STATES_MAX) {
        return refuse("its state cannot be kept");
    }
    return true;
}

static bool set_channel(void)
{
    const char *name = strtok(NULL, " \n");
    size_t channel = 0;
    double value = 0.0;
    if (name == NULL || !channel_of(name, &channel) || !number_of(strtok(NULL, " \n"), &value)) {
        return name != NULL ? false : refuse("set CHANNEL VALUE");
    }
    return class->set_input(plant, channel, value, err, sizeof(err)) || refuse(err);
}

/* Channel names up to a colon. */
static bool list_of(size_t *list, size_t *n)
{
    *n = 0;
    for (char *word = strtok(NULL, " \n"); word != NULL && strcmp(word, ":") != 0;
         word = strtok(NULL, " \n")) {
        if (*n == LIST_MAX) {
            return refuse("too many channels");
        }
        if (!channel_of(word, &list[*n])) {
            return false;
        }
        (*n)++;
    }
    return true;
}

static bool one_interval(double dt, const size_t *in, size_t n_in)
{
    for (size_t k = 0; k < n_in; k++) {
        double value = 0.0;
        if (!number_of(strtok(NULL, " \n"), &value)) {
            return false;
        }
        if (!class->set_input(plant, in[k], value, err, sizeof(err))) {
            return refuse(err);
        }
    }
    time_s += dt;
    return class->advance(plant, time_s, err, sizeof(err)) || refuse(err);
}

static bool try_inputs(void)
{
    size_t in[LIST_MAX], out[LIST_MAX], n_in = 0, n_out = 0;
    double dt = 0.0, n = 0.0;
    if (!number_of(strtok(NULL, " \n"), &dt) || !number_of(strtok(NULL, " \n"), &n) ||
        !list_of(in, &n_in) || !list_of(out, &n_out)) {
        return false;
    }
    if (!class->states->set(plant, kept, err, sizeof(err))) {
        return refuse(err);
    }
    for (size_t i = 0; i < (size_t)n; i++) {
        if (!one_interval(dt, in, n_in)) {
            return false;
        }
        for (size_t k = 0; k < n_out; k++) {
            (void)printf("%.17g ", class->value(plant, out[k]));
        }
    }
    (void)printf("\n");
    return true;
}

static void obey(const char *verb)
{
    bool said = true;
    if (strcmp(verb, "plant") == 0) {
        said = plant == NULL ? !open_plant(strtok(NULL, " \n")) : !refuse("there is one already");
    } else if (plant == NULL) {
        (void)refuse("plant NAME comes first");
    } else if (strcmp(verb, "set") == 0) {
        said = !set_channel();
    } else if (strcmp(verb, "try") == 0) {
        (void)try_inputs();
    } else if (strcmp(verb, "keep") == 0) {
        class->states->get(plant, kept);
        said = false;
    } else {
        (void)refuse("plant, set, keep or try");
    }
    if (!said) {
        (void)printf("ok\n");
    }
    (void)fflush(stdout);
}

int main(void)
{
    while (fgets(line, sizeof(line), stdin) != NULL) {
        const char *verb = strtok(line, " \n");
        if (verb != NULL) {
            obey(verb);
        }
    }
    return 0;
}
