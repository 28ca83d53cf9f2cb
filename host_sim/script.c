#include "script.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "text.h"

bool script_add(struct script *s, const char *line, unsigned at, char *err, size_t err_size)
{
    line += strspn(line, " \t");
    size_t n = strcspn(line, "\r\n");
    while (n > 0 && (line[n - 1] == ' ' || line[n - 1] == '\t')) {
        n--;
    }
    if (n == 0 || line[0] == '#') {
        return true;
    }
    struct script_line x = {.at = at};
    char time[64];
    size_t time_n = strcspn(line, " \t\r\n");
    size_t gap = strspn(line + time_n, " \t");
    if (time_n >= sizeof(time) || time_n + gap >= n) {
        return sim_fail(err, err_size,
                        "%s:%u: expected <time in s> <console line>, as in "
                        "\"120 log on\"",
                        s->file, at);
    }
    (void)memcpy(time, line, time_n);
    time[time_n] = '\0';
    if (!sim_parse_number(time, &x.time_s) || x.time_s < 0.0) {
        return sim_fail(err, err_size,
                        "%s:%u: the time \"%s\" must be a number of seconds, 0 or more", s->file,
                        at, time);
    }
    if (s->n > 0 && x.time_s < s->list[s->n - 1].time_s) {
        return sim_fail(err, err_size, "%s:%u: time %g s comes after %g s; lines must be in order",
                        s->file, at, x.time_s, s->list[s->n - 1].time_s);
    }
    const char *text = line + time_n + gap;
    n -= time_n + gap;
    if (text[0] == '?') {
        x.may_fail = true;
        size_t skip = 1 + strspn(text + 1, " \t");
        skip = skip < n ? skip : n;
        text += skip;
        n -= skip;
    }
    if (n == 0 || text[0] == '~' || n >= SCRIPT_LINE_SIZE) {
        return sim_fail(err, err_size,
                        "%s:%u: the console line must have 1 to %d characters and not begin with ~",
                        s->file, at, SCRIPT_LINE_SIZE - 1);
    }
    for (size_t i = 0; i < n; i++) {
        if ((unsigned char)text[i] < 0x20 || (unsigned char)text[i] > 0x7E) {
            return sim_fail(err, err_size,
                            "%s:%u: byte %zu of the console line is not printable ASCII", s->file,
                            at, i + 1);
        }
    }
    (void)memcpy(x.text, text, n);
    struct script_line *list = realloc(s->list, (s->n + 1) * sizeof(*list));
    if (list == NULL) {
        return sim_fail(err, err_size, "%s:%u: out of memory", s->file, at);
    }
    s->list = list;
    s->list[s->n] = x;
    s->n++;
    return true;
}

bool script_load(struct script *s, const char *path, char *err, size_t err_size)
{
    *s = (struct script){.list = NULL};
    (void)snprintf(s->file, sizeof(s->file), "%s", path);
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        return sim_fail(err, err_size, "--script %s: %s", path, strerror(errno));
    }
    char line[1024];
    bool good = true;
    for (unsigned at = 1; good && fgets(line, sizeof(line), file) != NULL; at++) {
        if (strlen(line) == sizeof(line) - 1) {
            good = sim_fail(err, err_size, "%s:%u: the line is longer than %zu characters", path,
                            at, sizeof(line) - 2);
        } else {
            good = script_add(s, line, at, err, err_size);
        }
    }
    if (good && ferror(file)) {
        good = sim_fail(err, err_size, "--script %s: cannot be read to its end", path);
    }
    (void)fclose(file);
    if (!good) {
        script_free(s);
    }
    return good;
}

void script_free(struct script *s)
{
    free(s->list);
    s->list = NULL;
    s->n = 0;
}
