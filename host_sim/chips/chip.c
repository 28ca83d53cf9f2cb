/* The kinds of chips, and what all of them have: properties, inputs, power.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "chips/chip.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "bench/text.h"
#include "chips/chip_inside.h"

#define NAME_SIZE 64u

static const struct chip_kind *const kinds[] = {
    &chip_max31865, &chip_max31856, &chip_ds18b20, &chip_ads1115, &chip_bme280, &chip_bmp280,
    &chip_xgzp6897, &chip_ad5422,   &chip_analog,  &chip_flow,    &chip_mains,  &chip_level,
};

const struct chip_kind *const *chip_kinds(size_t *n)
{
    *n = CHIP_COUNT(kinds);
    return kinds;
}

uint64_t chip_random(uint64_t *state)
{
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

double chip_uniform(uint64_t *state)
{
    return (double)(chip_random(state) >> 11) * (1.0 / 9007199254740992.0);
}

double chip_normal(uint64_t *state)
{
    double sum = -6.0;
    for (unsigned i = 0; i < 12; i++) {
        sum += chip_uniform(state);
    }
    return sum;
}

int32_t chip_code(double x, int32_t lo, int32_t hi)
{
    double nearest = floor(x + 0.5);
    return nearest <= lo ? lo : nearest >= hi ? hi : (int32_t)nearest;
}

bool chip_parse_hex(const char *text, double *value)
{
    size_t digits = strlen(text) < 3 ? 0 : strspn(text + 2, "0123456789abcdefABCDEF");
    if (strncmp(text, "0x", 2) != 0 || digits == 0 || digits > 4 || text[2 + digits] != '\0') {
        return false;
    }
    *value = (double)strtoul(text, NULL, 16);
    return true;
}

void chip_wrong(struct chip *c, const char *format, ...)
{
    c->wrongs++;
    if (c->wrong[0] != '\0') {
        return;
    }
    char text[CHIP_WRONG_SIZE];
    va_list list;
    va_start(list, format);
    /* NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized): va_start stands one line above */
    (void)vsnprintf(text, sizeof(text), format, list);
    va_end(list);
    sim_append(c->wrong, sizeof(c->wrong), "%s: %s", c->kind->name, text);
}

static const struct chip_kind *kind_named(const char *name)
{
    for (size_t i = 0; i < CHIP_COUNT(kinds); i++) {
        if (strcmp(kinds[i]->name, name) == 0) {
            return kinds[i];
        }
    }
    return NULL;
}

static bool no_property(const struct chip_kind *kind, const char *name, char *err, size_t err_size)
{
    (void)sim_fail(err, err_size, "%s has no property %s; it has", kind->name, name);
    for (size_t i = 0; i < kind->n_properties; i++) {
        sim_append(err, err_size, "%s %s", i == 0 ? "" : ",", kind->properties[i].name);
    }
    return false;
}

/* One word of the properties: name=value. given: those that were there before. */
static bool set_property(struct chip *c, const char *word, bool *given, char *err, size_t err_size)
{
    const struct chip_kind *kind = c->kind;
    const char *value = strchr(word, '=');
    if (value == NULL) {
        return sim_fail(err, err_size, "%s: %s is no property; one is written name=value",
                        kind->name, word);
    }
    char name[NAME_SIZE];
    (void)snprintf(name, sizeof(name), "%.*s", (int)(value - word), word);
    size_t i = 0;
    while (i < kind->n_properties && strcmp(kind->properties[i].name, name) != 0) {
        i++;
    }
    if (i == kind->n_properties) {
        return no_property(kind, name, err, err_size);
    }
    if (given[i]) {
        return sim_fail(err, err_size, "%s: %s is there twice", kind->name, name);
    }
    given[i] = true;
    const struct chip_property *p = &kind->properties[i];
    const char *form = p->parse == NULL ? "a number" : p->form;
    bool read = p->parse == NULL ? sim_parse_number(value + 1, &c->property[i])
                                 : p->parse(value + 1, &c->property[i]);
    if (!read) {
        return sim_fail(err, err_size, "%s: %s is %s, not %s", kind->name, name, form, value + 1);
    }
    if (c->property[i] < p->lo || c->property[i] > p->hi) {
        if (p->parse != NULL) {
            return sim_fail(err, err_size, "%s: %s %s is none that it can have: %s", kind->name,
                            name, value + 1, form);
        }
        return sim_fail(err, err_size, "%s: %s is %g to %g%s%s, not %s", kind->name, name, p->lo,
                        p->hi, p->unit[0] == '\0' ? "" : " ", p->unit, value + 1);
    }
    return true;
}

static bool set_properties(struct chip *c, const char *text, char *err, size_t err_size)
{
    bool given[CHIP_INPUTS_MAX] = {false};
    while (text += strspn(text, " \t"), *text != '\0') {
        size_t length = strcspn(text, " \t");
        char word[2 * NAME_SIZE];
        if (length >= sizeof(word)) {
            return sim_fail(err, err_size, "%s: property of more than %zu characters",
                            c->kind->name, sizeof(word) - 1);
        }
        memcpy(word, text, length);
        word[length] = '\0';
        if (!set_property(c, word, given, err, err_size)) {
            return false;
        }
        text += length;
    }
    return true;
}

struct chip *chip_new(const char *kind_name, const char *properties, uint64_t seed, char *err,
                      size_t err_size)
{
    const struct chip_kind *kind = kind_named(kind_name);
    if (kind == NULL) {
        (void)sim_fail(err, err_size, "no chip is called %s; there are", kind_name);
        for (size_t i = 0; i < CHIP_COUNT(kinds); i++) {
            sim_append(err, err_size, "%s %s", i == 0 ? "" : ",", kinds[i]->name);
        }
        return NULL;
    }
    struct chip *c = calloc(1, kind->size);
    if (c == NULL) {
        (void)sim_fail(err, err_size, "no memory for a %s", kind->name);
        return NULL;
    }
    c->kind = kind;
    c->seed = c->random = seed;
    for (size_t i = 0; i < kind->n_properties; i++) {
        c->property[i] = kind->properties[i].at_first;
    }
    for (size_t i = 0; i < kind->n_inputs; i++) {
        c->input[i] = kind->inputs[i].at_first;
    }
    if (!set_properties(c, properties, err, err_size)) {
        free(c);
        return NULL;
    }
    return c;
}

void chip_free(struct chip *c)
{
    free(c);
}

int chip_input_index(const struct chip_kind *kind, const char *name)
{
    for (size_t i = 0; i < kind->n_inputs; i++) {
        if (strcmp(kind->inputs[i].name, name) == 0) {
            return (int)i;
        }
    }
    return -1;
}

bool chip_set(struct chip *c, const char *input, double value, char *err, size_t err_size)
{
    if (strcmp(input, "dead") == 0) {
        c->dead = value != 0.0;
        return true;
    }
    int i = chip_input_index(c->kind, input);
    if (i < 0) {
        (void)sim_fail(err, err_size, "%s has no input %s; it has", c->kind->name, input);
        for (size_t k = 0; k < c->kind->n_inputs; k++) {
            sim_append(err, err_size, " %s,", c->kind->inputs[k].name);
        }
        sim_append(err, err_size, " dead");
        return false;
    }
    const struct chip_input *in = &c->kind->inputs[i];
    if (!(value >= in->lo && value <= in->hi)) {
        return sim_fail(err, err_size, "%s: %s is %g to %g%s%s, not %g", c->kind->name, input,
                        in->lo, in->hi, in->unit[0] == '\0' ? "" : " ", in->unit, value);
    }
    c->input[i] = value;
    return true;
}

void chip_at(struct chip *c, uint64_t now_ns)
{
    if (c->powered && c->kind->catch_up != NULL) {
        c->kind->catch_up(c, now_ns);
    }
}

void chip_power(struct chip *c, uint64_t now_ns, bool on)
{
    c->powered = on;
    if (on) {
        c->kind->power_on(c, now_ns);
    }
}

double chip_drives(struct chip *c, uint64_t now_ns)
{
    return c->powered && c->kind->drives != NULL ? c->kind->drives(c, now_ns) : 0.0;
}

bool chip_answers(const struct chip *c)
{
    return c->powered && !c->dead;
}
