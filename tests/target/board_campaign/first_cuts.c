/* The first cut: everywhere. Some are followed by a whole start (--whole), the others by one that is kept from before it reads the flash.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdio.h>
#include <string.h>

#include "faults.h"
#include "save_site.h"
#include "versions.h"

#define OFF_NS   (10u * SECOND)
#define RESET_NS (1u * MS)

struct place {
    const struct campaign *c;
    struct save_site *site;
    unsigned word, erase, per_mille;
    unsigned number;
};

static bool lost(char *result, const struct station *s, const char *what)
{
    size_t tail = s->n > 100u ? s->n - 100u : 0;
    (void)snprintf(result, RUN_TEXT, "LOST %.120s; %.100s; console: %.100s", what,
                   s->board->verdict[0] != '\0' ? s->board->verdict : "no verdict", s->said + tail);
    for (char *at = result; *at != '\0'; at++)
        if (*at == '\n' || *at == '\t')
            *at = ' ';
    return false;
}

/* Saves another set, which must be there after a reset. */
static bool goes_on(struct station *s, unsigned version, char *result)
{
    char why[RUN_TEXT];
    if (!versions_set(s, version) || !station_ask(s, "save"))
        return lost(result, s, "no further save");
    board_ask_reset(s->board, RESET_PIN);
    station_run(s, RESET_NS);
    station_forget(s);
    if (!station_greet(s) || !station_loaded(s))
        return lost(result, s, "no start after a further save");
    int found = versions_read(s, why, sizeof(why));
    return found == (int)version || lost(result, s, found < 0 ? why : "the further save is lost");
}

/* Off and on again, with all that a start does. False: it did not start. */
static bool real_start(struct station *s)
{
    struct board *b = s->board;
    (void)faults_take_flash_cut(b);
    uint64_t end = board_ns(b) + OFF_NS;
    while (b->held && board_ns(b) < end)
        board_run(b, board_ns(b) + MS);
    station_forget(s);
    return station_greet(s);
}

static void one_cut(void *context, char *result)
{
    const struct place *p = context;
    struct station *s = p->site->before;
    char why[RUN_TEXT];
    s->board->random = campaign_random(p->c, p->number);
    if (!save_with_cut(s, p->word, p->erase, p->per_mille)) {
        (void)snprintf(result, RUN_TEXT, "UNREACHED %.200s", s->said);
        return;
    }
    bool whole = p->number / p->c->stride % p->c->whole == 0;
    bool started = true;
    if (whole)
        started = real_start(s);
    else
        s = save_site_start(p->site);
    if (!started || !station_loaded(s)) {
        (void)lost(result, s, "no start");
        return;
    }
    int found = whole ? versions_whole(s, why, sizeof(why)) : versions_read(s, why, sizeof(why));
    if (found != (int)p->site->old && found != (int)p->site->old + 1)
        (void)lost(result, s, found < 0 ? why : "an older set");
    else if (!whole || goes_on(s, p->site->old + 2u, result))
        (void)snprintf(result, RUN_TEXT, found == (int)p->site->old ? "old" : "new");
}

static void every_place(const struct campaign *c, struct save_site *site, const char *name,
                        unsigned *number)
{
    unsigned places = site->words + site->erases * ERASE_POINTS;
    (void)printf("%s: %u words, %u erases\n", name, site->words, site->erases);
    for (unsigned i = 0; i < places; i++, (*number)++) {
        struct place p = {.c = c, .site = site, .number = *number};
        char key[64];
        if (i < site->words) {
            p.word = i + 1u;
            (void)snprintf(key, sizeof(key), "%s word %u", name, p.word);
        } else {
            p.erase = (i - site->words) / ERASE_POINTS + 1u;
            p.per_mille =
                (2u * ((i - site->words) % ERASE_POINTS) + 1u) * 1000u / (2u * ERASE_POINTS);
            (void)snprintf(key, sizeof(key), "%s erase %u at %u per mille", name, p.erase,
                           p.per_mille);
        }
        if (i % c->stride == 0 && !runs_are_done(c->runs, key))
            runs_add(c->runs, key, one_cut, &p);
    }
}

bool first_cuts(const struct campaign *c)
{
    struct save_site site;
    unsigned number = 0;
    if (!save_site_begin(&site, c))
        return false;
    every_place(c, &site, "append", &number);
    if (c->append_only)
        return true;
    if (!save_site_fill(&site))
        return false;
    every_place(c, &site, "erase", &number);
    return true;
}
