/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "versions.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE 160

/* before: text, base + version, after: text */
struct value {
    const char *name, *before;
    unsigned base;
    const char *after;
};

static const struct value large[] = {
    {"meas1.lo", "", 200, ""},   {"meas16.hi", "", 2500, ""}, {"meas15.unit", "u", 0, ""},
    {"loop1.ti", "", 150, ""},   {"loop2.ti", "", 90, ""},    {"block3.tau.1", "", 60, ",60,0,0"},
    {"block3.miss", "", 100, ""}};
static const struct value small[] = {{"meas1.lo", "", 10, ""},   {"mv2.follow", "", 90, ""},
                                     {"mv1.follow", "", 90, ""}, {"loop1.ti", "", 200, ""},
                                     {"loop2.ti", "", 150, ""},  {"lock1.hysteresis", "", 2, ""}};

static const struct kit {
    const char *file;
    const struct value *values;
    size_t n;
} kits[] = {{"host_sim/scenarios/methanol-ahead.conf", large, sizeof(large) / sizeof(large[0])},
            {"host_sim/scenarios/pilot.conf", small, sizeof(small) / sizeof(small[0])}};

static const struct kit *kit = &kits[0];
static char *reference; /* lines of `dump` */

const char *versions_use(bool blocks)
{
    kit = &kits[blocks ? 0 : 1];
    return kit->file;
}

bool versions_set(struct station *s, unsigned version)
{
    char line[LINE];
    bool ok = station_ask(s, "begin");
    for (size_t i = 0; ok && i < kit->n; i++) {
        const struct value *v = &kit->values[i];
        (void)snprintf(line, sizeof(line), "set %s %s%u%s", v->name, v->before, v->base + version,
                       v->after);
        ok = station_ask(s, line);
    }
    return ok && station_ask(s, "apply");
}

/* The version whose value this is; -1: of none. */
static int version_of(const struct value *v, const char *text)
{
    char *end;
    size_t n = strlen(v->before);
    if (strncmp(text, v->before, n) != 0)
        return -1;
    unsigned long number = strtoul(text + n, &end, 10);
    n = strlen(v->after);
    bool whole = strncmp(end, v->after, n) == 0 && (end[n] == '\0' || end[n] == ' ');
    return whole && number >= v->base && number < v->base + VERSIONS_MAX ? (int)(number - v->base)
                                                                         : -1;
}

static int differs(char *why, size_t size, const char *what, const char *text)
{
    (void)snprintf(why, size, "%s is %.60s", what, text);
    return -1;
}

int versions_read(struct station *s, char *why, size_t size)
{
    int version = -1;
    for (size_t i = 0; i < kit->n; i++) {
        char line[LINE];
        (void)snprintf(line, sizeof(line), "get %s", kit->values[i].name);
        if (!station_ask(s, line))
            return differs(why, size, line, s->said[0] != '\0' ? s->said : "not answered");
        const char *text = strstr(s->said, " = ");
        (void)snprintf(line, sizeof(line), "%.150s", text == NULL ? s->said : text + 3);
        line[strcspn(line, "\n")] = '\0';
        int one = version_of(&kit->values[i], line);
        if (one < 0 || (i > 0 && one != version))
            return differs(why, size, kit->values[i].name, line);
        version = one;
    }
    return version;
}

static const struct value *value_in(const char *line, const char **text)
{
    for (size_t i = 0; i < kit->n; i++) {
        size_t n = strlen(kit->values[i].name);
        if (strncmp(line, "set ", 4) == 0 && strncmp(line + 4, kit->values[i].name, n) == 0 &&
            line[4 + n] == ' ') {
            *text = line + 5 + n;
            return &kit->values[i];
        }
    }
    return NULL;
}

bool versions_learn(struct station *s)
{
    if (!station_ask(s, "dump"))
        return false;
    free(reference);
    reference = strdup(s->said);
    return reference != NULL;
}

/* The next line of a listing that is none of an event; false: there is none. */
static bool next_line(const char **at, char *line)
{
    while (**at != '\0') {
        size_t n = strcspn(*at, "\n");
        (void)snprintf(line, LINE, "%.*s", (int)n, *at);
        *at += n + ((*at)[n] == '\n');
        if (line[0] != '!')
            return true;
    }
    return false;
}

int versions_whole(struct station *s, char *why, size_t size)
{
    char line[LINE], wanted[LINE];
    const char *at = s->said, *was = reference;
    int version = -1;
    if (!station_ask(s, "dump"))
        return differs(why, size, "dump", "not answered");
    while (next_line(&was, wanted)) {
        const char *text = NULL;
        if (!next_line(&at, line))
            return differs(why, size, wanted, "not there");
        const struct value *v = value_in(line, &text);
        int one = v == NULL ? -1 : version_of(v, text);
        if (v == NULL ? strcmp(line, wanted) != 0 : one < 0 || (version >= 0 && one != version))
            return differs(why, size, wanted, line);
        version = v == NULL ? version : one;
    }
    return next_line(&at, line) ? differs(why, size, "more", line) : version;
}
