/* A cut in a save, and two more in the starts and saves after it.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "save_site.h"
#include "versions.h"

#define CUTS        3u
#define START_WORDS 16u
#define TRIES       4u

/* State that one start of the board leaves to the next. */
struct carried {
    uint64_t possible; /* bits of the versions that the next start may find */
    unsigned next;     /* version of the next save */
    bool cut;
    char path[RUN_TEXT / 2], wrong[RUN_TEXT / 2];
    uint8_t flash[]; /* bytes, then bits that are unstable */
};

struct life {
    const struct campaign *c;
    const struct save_site *site;
    struct carried *carried;
    uint64_t random;
    unsigned number, cuts; /* of the run; before this life */
};

static void say(struct carried *to, const char *words, unsigned a, unsigned b)
{
    size_t n = strlen(to->path);
    (void)snprintf(to->path + n, sizeof(to->path) - n, words, a, b);
}

static void wrong(struct carried *to, const struct station *s, const char *what)
{
    size_t tail = s->n > 60u ? s->n - 60u : 0;
    (void)snprintf(to->wrong, sizeof(to->wrong), "%.70s; %.60s; %.60s", what, s->board->verdict,
                   s->said + tail);
}

static void keep_flash(struct life *l, const struct station *s)
{
    size_t size = l->c->image->chip->stored_size;
    (void)memcpy(l->carried->flash, stored_flash(s->board)->bytes, size);
    (void)memcpy(l->carried->flash + size, stored_flash(s->board)->unstable, size);
}

/* Cuts a save somewhere; sure: where every save comes. False: it ended before the place came. */
static bool cut_a_save(struct life *l, struct station *s, bool sure)
{
    const struct save_site *site = l->site;
    if (!sure && site->erases != 0 && below(&l->random, 2) == 0) {
        unsigned erase = 1u + below(&l->random, site->erases), per_mille = below(&l->random, 1001);
        say(l->carried, " save/erase%u@%u", erase, per_mille);
        return save_with_cut(s, 0, erase, per_mille);
    }
    unsigned word = 1u + below(&l->random, sure ? site->words / 2u : site->words);
    say(l->carried, " save/word%u", word, 0);
    return save_with_cut(s, word, 0, 0);
}

static void first_life(struct life *l)
{
    struct station *s = l->site->before;
    if (!cut_a_save(l, s, false))
        wrong(l->carried, s, "the first cut was not reached");
    l->carried->cut = true;
    keep_flash(l, s);
}

static void arm_start(struct life *l, struct stored_flash *f)
{
    if (below(&l->random, 2) == 0)
        return;
    f->cut_word = f->words + 1u + below(&l->random, START_WORDS);
    if (below(&l->random, 2) == 0) {
        f->cut_word = 0;
        f->cut_erase = f->erase_count + 1u;
        f->cut_per_mille = below(&l->random, 1001);
    }
}

/* Reads what the start has found. */
static bool found_set(struct life *l, struct station *s, bool whole)
{
    char why[RUN_TEXT];
    int found = whole ? versions_whole(s, why, sizeof(why)) : versions_read(s, why, sizeof(why));
    if (found < 0 || (l->carried->possible >> found & 1u) == 0) {
        if (found >= 0)
            (void)snprintf(why, sizeof(why), "version %d", found);
        wrong(l->carried, s, why);
        return false;
    }
    say(l->carried, " v%u", (unsigned)found, 0);
    l->carried->possible = UINT64_C(1) << found;
    return true;
}

/* tries: saves that may be cut, this one counted; 0: it is not to be cut. False: it was, or something is wrong. */
static bool save_next(struct life *l, struct station *s, unsigned tries)
{
    struct carried *to = l->carried;
    unsigned version = to->next++;
    if (!versions_set(s, version)) {
        wrong(to, s, "settings refused");
        return false;
    }
    if (tries != 0 && cut_a_save(l, s, tries == 1u)) {
        to->possible |= UINT64_C(1) << version;
        to->cut = true;
        return false;
    }
    if (tries == 0 && !station_ask(s, "save")) {
        wrong(to, s, "save refused");
        return false;
    }
    if (strstr(s->said, "ok\n") == NULL) {
        wrong(to, s, "save not answered");
        return false;
    }
    say(to, " saved", 0, 0);
    to->possible = UINT64_C(1) << version;
    return true;
}

static void later_life(struct life *l)
{
    struct station *s = l->site->start;
    struct stored_flash *f = stored_flash(s->board);
    size_t size = l->c->image->chip->stored_size;
    bool last = l->cuts == CUTS;
    save_site_put(s, l->carried->flash, l->carried->flash + size);
    l->carried->cut = false;
    if (!last)
        arm_start(l, f);
    bool loaded = station_loaded(s);
    f->cut_word = f->cut_erase = 0;
    if (f->cut) {
        say(l->carried, " start/word%u,erase%u", (unsigned)f->words, (unsigned)f->erase_count);
        l->carried->cut = true;
    } else if (!loaded) {
        wrong(l->carried, s, "not loaded");
    } else if (found_set(l, s, last && l->number % l->c->whole == 0)) {
        for (unsigned i = last ? 0 : TRIES; save_next(l, s, i) && i > 1u; i--) {
        }
    }
    keep_flash(l, s);
}

/* A life in a process of its own, which leaves only what it carries over. */
static void live(struct life *l, void (*what)(struct life *l))
{
    int pid = fork(), status = 1;
    if (pid == 0) {
        what(l);
        _exit(0);
    }
    (void)waitpid(pid, &status, 0);
    if (pid < 0 || status != 0)
        (void)snprintf(l->carried->wrong, sizeof(l->carried->wrong), "crashed, status 0x%x",
                       (unsigned)status);
}

static void three_cuts(void *context, char *result)
{
    struct life l = *(struct life *)context;
    size_t size = sizeof(struct carried) + 2u * l.c->image->chip->stored_size;
    l.carried = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (l.carried == MAP_FAILED)
        return;
    l.carried->possible = UINT64_C(3) << l.site->old;
    l.carried->next = l.site->old + 2u;
    uint64_t random = campaign_random(l.c, l.number);
    for (unsigned life = 0; l.carried->wrong[0] == '\0' && life <= CUTS; life++) {
        l.random = random_state(random + life);
        l.site->before->board->random = l.site->start->board->random = random_state(~random + life);
        l.cuts = life;
        live(&l, life == 0 ? first_life : later_life);
        if (life < CUTS && l.carried->wrong[0] == '\0' && !l.carried->cut)
            (void)snprintf(l.carried->wrong, sizeof(l.carried->wrong), "not cut");
    }
    (void)snprintf(result, RUN_TEXT, "%s%.190s%s%.180s",
                   l.carried->wrong[0] == '\0' ? "kept" : "LOST", l.carried->path,
                   l.carried->wrong[0] == '\0' ? "" : ": ", l.carried->wrong);
    for (char *at = result; *at != '\0'; at++)
        if (*at == '\n' || *at == '\t')
            *at = ' ';
}

bool further_cuts(const struct campaign *c)
{
    struct save_site site;
    if (!runs_are_left(c->runs, c->from, c->from + c->count, 1))
        return true;
    if (!save_site_begin(&site, c))
        return false;
    /* Even numbers append, odd ones erase. */
    for (unsigned erase = 0; erase < (c->append_only ? 1u : 2u); erase++) {
        if (erase != 0 && !save_site_fill(&site))
            return false;
        (void)printf("%s: %u words, %u erases\n", erase != 0 ? "erase" : "append", site.words,
                     site.erases);
        for (unsigned n = c->from; n < c->from + c->count; n++) {
            struct life l = {.c = c, .site = &site, .number = n};
            char key[64];
            (void)snprintf(key, sizeof(key), "%u", n);
            if ((n % 2u == erase || c->append_only) && !runs_are_done(c->runs, key))
                runs_add(c->runs, key, three_cuts, &l);
        }
    }
    return true;
}
