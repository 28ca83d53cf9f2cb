#include "linear/linearise.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void linearised_free(struct linearised *l)
{
    free(l->input);
    free(l->output);
    free(l->a);
    free(l->b);
    free(l->c);
    free(l->d);
    free(l->dead_s);
    free(l->x);
    free(l->u);
    free(l->y);
    *l = (struct linearised){0};
}

void linearised_column(struct linearised *l, bool of_input, size_t number, const double *slope)
{
    double *of_rates = of_input ? l->b : l->a, *of_outputs = of_input ? l->d : l->c;
    size_t width = of_input ? l->m : l->n;

    for (size_t i = 0; i < l->n; i++)
        of_rates[i * width + number] = slope[i];
    for (size_t i = 0; i < l->p; i++)
        of_outputs[i * width + number] = slope[l->n + i];
}

/* "state 3" or the channel's name. */
static void name_of(const struct linearised *l, const struct plant_class *class, bool of_input,
                    size_t number, char *text, size_t size)
{
    if (of_input)
        snprintf(text, size, "%s", class->channels[l->input[number]].name);
    else
        snprintf(text, size, "state %zu", number + 1);
}

static void add_line(struct linearised *l, const char *format, ...)
{
    static const char more[] = "and others\n";
    size_t used = strlen(l->notes), room = sizeof l->notes - sizeof more - used;
    va_list arguments;

    if (used >= sizeof more && strcmp(l->notes + used + 1 - sizeof more, more) == 0)
        return;
    va_start(arguments, format);
    int length = vsnprintf(l->notes + used, room, format, arguments);
    va_end(arguments);
    if (length < 0 || (size_t)length >= room)
        memcpy(l->notes + used, more, sizeof more);
}

void linearised_note(struct linearised *l, const struct plant_class *class, bool of_input,
                     size_t number, const struct derivative_found *found)
{
    const char *side = found->side == DERIVATIVE_BELOW ? "downwards" : "upwards";
    char moved[64], row[64];

    name_of(l, class, of_input, number, moved, sizeof moved);
    if (found->kink) {
        if (found->kinked < l->n)
            snprintf(row, sizeof row, "the rate of state %zu", found->kinked + 1);
        else
            snprintf(row, sizeof row, "%s", class->channels[l->output[found->kinked - l->n]].name);
        add_line(l, "%s: %s has a kink here, so there is no derivative; slopes are those %s\n",
                 moved, row, side);
    } else if (found->side != DERIVATIVE_BOTH) {
        add_line(l, "%s is at an end of its range; slopes are those %s\n", moved, side);
    }
}
