/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "station.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "plant_side.h"

#define CONSOLE    0
#define SLICE_NS   (5u * MS) /* a byte of the console takes 87 us */
#define WITH_PLANT (1u * MS)
#define REPLY_NS   (20u * SECOND)
#define GREET_NS   (15u * SECOND)
#define LOADED_NS  (20u * SECOND)
#define SETTLE_NS  (150u * MS)
/* As code and, before the console is in machine mode, as a sentence (firmware/base/event_list.h). */
#define STORAGE_TOLD                                                                               \
    "STORAGE_LOADED|stored settings are being applied|STORAGE_REFUSED|are not in force|"           \
    "STORAGE_DAMAGED|no whole set is stored|STORAGE_NEWER|STORAGE_LEFT_OUT"

struct station *station_new(const struct image *image, uint64_t seed)
{
    char err[256] = "";
    struct station *s = calloc(1, sizeof(*s));
    const struct surroundings around = {.crystal_hz = 8000000,
                                        .slow_clock_hz = image->chip->slow_clock_hz,
                                        .supply_mv = 3300,
                                        .brown_out_mv = 2700,
                                        .baud = 115200,
                                        .seed = seed};
    if (s == NULL)
        return NULL;
    s->board = board_new(image->chip, &around, image->data, image->bytes, false, err, sizeof(err));
    if (s->board != NULL)
        return s;
    (void)fprintf(stderr, "board-campaign: %s\n", err);
    free(s);
    return NULL;
}

static bool has_one_of(const char *text, const char *words)
{
    while (*words != '\0') {
        char word[64];
        size_t n = strcspn(words, "|");
        (void)snprintf(word, sizeof(word), "%.*s", (int)n, words);
        if (strstr(text, word) != NULL)
            return true;
        words += n + (words[n] == '|');
    }
    return false;
}

/* A line that has begun stays. */
static void clear(struct station *s)
{
    s->n -= s->line;
    (void)memmove(s->said, s->said + s->line, s->n);
    s->line = 0;
    s->said[s->n] = '\0';
}

void station_forget(struct station *s)
{
    s->n = s->line = 0;
    s->said[0] = '\0';
    s->loaded = false;
}

static void listen(struct station *s)
{
    uint8_t bytes[4096];
    size_t n;
    while ((n = line_take(s->board, CONSOLE, bytes, sizeof(bytes))) > 0)
        for (size_t i = 0; i < n && s->n + 1u < STATION_ROOM; i++) {
            if (bytes[i] == '\r' || bytes[i] == '\0')
                continue;
            s->said[s->n++] = (char)bytes[i];
            s->said[s->n] = '\0';
            if (bytes[i] == '\n') {
                s->loaded = s->loaded || has_one_of(s->said + s->line, STORAGE_TOLD);
                s->line = s->n;
            }
        }
}

static bool ended(const struct station *s)
{
    return s->board->verdict[0] != '\0' || stored_flash(s->board)->cut;
}

static void slice(struct station *s, uint64_t end)
{
    uint64_t to = board_ns(s->board) + (s->plant != NULL ? WITH_PLANT : SLICE_NS);
    board_run(s->board, to < end ? to : end);
    listen(s);
    if (s->plant != NULL)
        plant_side_turn(s->plant);
}

void station_run(struct station *s, uint64_t ns)
{
    uint64_t end = board_ns(s->board) + ns;
    while (!ended(s) && board_ns(s->board) < end)
        slice(s, end);
}

bool station_until(struct station *s, const char *words, uint64_t ns)
{
    uint64_t end = board_ns(s->board) + ns;
    while (!has_one_of(s->said, words)) {
        if (ended(s) || board_ns(s->board) >= end)
            return false;
        slice(s, end);
    }
    return true;
}

/* A line "ok" or "err ...", whole. */
static const char *reply_in(const char *text)
{
    for (const char *line = text, *end; (end = strchr(line, '\n')) != NULL; line = end + 1)
        if (strncmp(line, "ok\n", 3) == 0 || strncmp(line, "err ", 4) == 0)
            return line;
    return NULL;
}

bool station_ask(struct station *s, const char *line)
{
    uint64_t end = board_ns(s->board) + REPLY_NS;
    const char *reply;
    clear(s);
    (void)line_give(s->board, CONSOLE, (const uint8_t *)line, strlen(line));
    (void)line_give(s->board, CONSOLE, (const uint8_t *)"\r", 1);
    while ((reply = reply_in(s->said)) == NULL) {
        if (ended(s) || board_ns(s->board) >= end)
            return false;
        slice(s, end);
    }
    return reply[0] == 'o';
}

bool station_greet(struct station *s)
{
    if (!station_until(s, "(STARTED)\n| STARTED ", GREET_NS))
        return false;
    station_run(s, SETTLE_NS);
    return station_ask(s, "mode machine");
}

bool station_loaded(struct station *s)
{
    uint64_t end = board_ns(s->board) + LOADED_NS;
    while (!s->loaded && !ended(s) && board_ns(s->board) < end)
        slice(s, end);
    if (!s->loaded)
        return false;
    station_run(s, SETTLE_NS);
    return !ended(s);
}

bool station_configure(struct station *s, const char *path, char *why, size_t size)
{
    char line[256];
    FILE *f = fopen(path, "r");
    bool ok = f != NULL;
    (void)snprintf(why, size, "%s: cannot be read", path);
    while (ok && fgets(line, sizeof(line), f) != NULL) {
        line[strcspn(line, "\r\n")] = '\0';
        if (line[0] == '\0' || line[0] == '#')
            continue;
        ok = station_ask(s, line);
        if (!ok)
            (void)snprintf(why, size, "%.80s: \"%.80s\" was answered \"%.80s\"", path, line,
                           s->said);
    }
    if (f != NULL)
        (void)fclose(f);
    return ok;
}
