#include "bench/script.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/text.h"

/* ~until CODES [LIMIT_S] and ~end. Leaves the codes in x->text. */
static bool directive(struct script_line *x, const char *text)
{
    char word[16], codes[SCRIPT_LINE_SIZE], limit[64], more[2];
    int n = sscanf(text, "~%15s %255s %63s %1s", word, codes, limit, more);
    if (n == 1 && strcmp(word, "end") == 0) {
        x->kind = SCRIPT_END;
        return true;
    }
    if ((n != 2 && n != 3) || strcmp(word, "until") != 0) {
        return false;
    }
    x->kind = SCRIPT_UNTIL;
    x->limit_s = -1.0;
    x->waiting_s = -1.0;
    (void)memcpy(x->text, codes, sizeof(x->text));
    return n == 2 || (sim_parse_number(limit, &x->limit_s) && x->limit_s > 0.0);
}

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
    struct script_line x = {.line = at};
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
        x.may_fail = x.may_be_cut = true;
        size_t skip = 1 + strspn(text + 1, " \t");
        skip = skip < n ? skip : n;
        text += skip;
        n -= skip;
    }
    if (n == 0 || n >= SCRIPT_LINE_SIZE) {
        return sim_fail(err, err_size, "%s:%u: the console line must have 1 to %d characters",
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
    if (text[0] == '~') {
        char copy[SCRIPT_LINE_SIZE] = "";
        (void)memcpy(copy, text, n);
        if (!directive(&x, copy)) {
            return sim_fail(err, err_size,
                            "%s:%u: after ~ the words are until CODE[|CODE...] [LIMIT_S], or end",
                            s->file, at);
        }
    }
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
    char reason[SIM_ERROR_SIZE];
    FILE *file = sim_open_text(path, reason, sizeof(reason));
    if (file == NULL) {
        return sim_fail(err, err_size, "--script %s", reason);
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
