#include "plants/plant_inputs.h"

#include <stdlib.h>
#include <string.h>

#include "bench/text.h"

/* An earlier change of the same channel still waits. */
static bool must_wait(const struct plant_change *change, const bool *done, size_t k)
{
    for (size_t i = 0; i < k; i++) {
        if (!done[i] && change[i].channel == change[k].channel) {
            return true;
        }
    }
    return false;
}

bool plant_set_inputs(const struct plant_class *class, struct plant *p,
                      const struct plant_change *change, size_t n, char *err, size_t err_size)
{
    bool done[PLANT_CHANGES_MAX] = {false};
    size_t left = n, before = n + 1;
    if (n > PLANT_CHANGES_MAX) {
        return sim_fail(err, err_size, "%s: more than %zu inputs change at a time", class->name,
                        PLANT_CHANGES_MAX);
    }
    while (left > 0 && left < before) { /* each round sets one more at least */
        bool said = false;
        before = left;
        for (size_t k = 0; k < n; k++) {
            char reason[SIM_ERROR_SIZE] = "";
            if (done[k] || must_wait(change, done, k)) {
                continue;
            }
            if (class->set_input(p, change[k].channel, change[k].value, reason, sizeof(reason))) {
                done[k] = true;
                left--;
            } else if (!said) {
                said = true;
                (void)sim_fail(err, err_size, "%s", reason);
            }
        }
    }
    if (left == 0 && err_size > 0) {
        err[0] = '\0';
    }
    return left == 0;
}

bool plant_read_input(const char *option, const struct plant_class *class, const char *text,
                      struct plant_change *change, char *err, size_t err_size)
{
    const char *equals = strchr(text, '=');
    double value;
    if (equals == NULL || !sim_parse_number(equals + 1, &value)) {
        return sim_fail(err, err_size, "%s %s: must be NAME=NUMBER", option, text);
    }
    for (size_t i = 0; i < class->n_channels; i++) {
        const struct plant_channel *c = &class->channels[i];
        if (strlen(c->name) == (size_t)(equals - text) &&
            strncmp(c->name, text, (size_t)(equals - text)) == 0 &&
            (c->kind == PLANT_MV || c->kind == PLANT_DISTURBANCE)) {
            *change = (struct plant_change){i, value};
            return true;
        }
    }
    (void)sim_fail(err, err_size, "%s %s: %s has no such input; there is", option, text,
                   class->name);
    for (size_t i = 0; i < class->n_channels; i++) {
        const struct plant_channel *c = &class->channels[i];
        if (c->kind == PLANT_MV || c->kind == PLANT_DISTURBANCE) {
            sim_append(err, err_size, " %s", c->name);
        }
    }
    return false;
}

struct plant *plant_create_at(const struct plant_class *class, const struct plant_change *change,
                              size_t n, bool *bad_input, char *err, size_t err_size)
{
    struct plant *p = plant_create(class, err, err_size);
    if (p == NULL) {
        return NULL;
    }
    *bad_input = !plant_set_inputs(class, p, change, n, err, err_size);
    if (!*bad_input && class->settle(p, err, err_size)) {
        return p;
    }
    class->destroy(p);
    return NULL;
}

static struct plant_channel *truth_of(const struct plant_class *class,
                                      struct plant_channel *channels, const char *name)
{
    for (size_t i = 0; i < class->n_channels; i++) {
        if (strcmp(channels[i].name, name) == 0 && channels[i].kind == PLANT_INTERNAL) {
            return &channels[i];
        }
    }
    return NULL;
}

const struct plant_class *plant_measuring(const struct plant_class *class, const char *const *name,
                                          size_t n, char *err, size_t err_size)
{
    struct plant_class *measuring = malloc(sizeof(*measuring));
    struct plant_channel *channels = malloc(class->n_channels * sizeof(*channels));
    if (measuring == NULL || channels == NULL) {
        free(measuring);
        free(channels);
        (void)sim_fail(err, err_size, "out of memory");
        return NULL;
    }
    *measuring = *class;
    (void)memcpy(channels, class->channels, class->n_channels * sizeof(*channels));
    measuring->channels = channels;
    for (size_t k = 0; k < n; k++) {
        struct plant_channel *c = truth_of(class, channels, name[k]);
        if (c == NULL) {
            (void)sim_fail(err, err_size, "--measure %s: %s has no such truth that is not measured",
                           name[k], class->name);
            free(channels);
            free(measuring);
            return NULL;
        }
        c->kind = PLANT_MEASUREMENT;
    }
    return measuring;
}
