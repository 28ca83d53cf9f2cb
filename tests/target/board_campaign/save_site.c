/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "save_site.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "versions.h"

#define SAVE_NS    (30u * SECOND)
#define START_NS   (10u * SECOND)
#define STEP_NS    (1u * MS)
#define EARLIER_NS (5u * MS)

static bool refuse(const char *what, const struct station *s)
{
    (void)fprintf(stderr, "board-campaign: %s; the board: %s; its console: %.300s\n", what,
                  s->board->verdict[0] != '\0' ? s->board->verdict : "runs", s->said);
    return false;
}

/* What the next save writes and erases, seen by a copy of the board. */
static bool rehearse(struct save_site *site)
{
    unsigned *seen = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (seen == MAP_FAILED)
        return false;
    (void)fflush(stdout);
    int pid = fork(), status = 1;
    if (pid == 0) {
        struct stored_flash *f = stored_flash(site->before->board);
        uint64_t words = f->words, erases = f->erase_count;
        bool ok = station_ask(site->before, "save");
        seen[0] = (unsigned)(f->words - words);
        seen[1] = (unsigned)(f->erase_count - erases);
        _exit(ok ? 0 : 1);
    }
    (void)waitpid(pid, &status, 0);
    site->words = seen[0];
    site->erases = seen[1];
    (void)munmap(seen, 4096);
    return status == 0 || refuse("the save that is to be cut was refused", site->before);
}

static bool next_version(struct save_site *site)
{
    if (!station_ask(site->before, "save"))
        return refuse("save", site->before);
    site->old++;
    return versions_set(site->before, site->old + 1u) ? rehearse(site)
                                                      : refuse("set", site->before);
}

/* The board reads its flash some 2 s after a start without a plant. Up to there a start is the same whatever is stored. The first time
 * finds out when, and leaves the code translated. */
static bool prepare_start(struct save_site *site, const struct campaign *c)
{
    struct station *s = site->start = station_new(c->image, c->seed + 1u);
    if (s == NULL)
        return false;
    struct stored_flash *f = stored_flash(s->board);
    f->watched = true;
    (void)memcpy(f->bytes, stored_flash(site->before->board)->bytes, c->image->chip->stored_size);
    board_power_on(s->board);
    uint64_t read_after = 0;
    if (!station_greet(s))
        return refuse("start", s);
    while (f->reads == 0 && board_ns(s->board) < START_NS)
        station_run(s, STEP_NS);
    read_after = board_ns(s->board);
    if (!station_loaded(s) || !versions_set(s, site->old + 1u) || !station_ask(s, "save") ||
        !station_ask(s, "dump"))
        return refuse("start", s);
    uint64_t began = board_ns(s->board);
    board_hold(s->board, RESET_POWER);
    board_release(s->board, RESET_POWER, true);
    station_forget(s);
    f->reads = 0;
    if (!station_greet(s))
        return refuse("start", s);
    while (board_ns(s->board) + EARLIER_NS < began + read_after)
        station_run(s, STEP_NS);
    station_forget(s);
    f->watched = false; /* from the next reset on */
    return f->reads == 0 || refuse("the flash was read earlier than in the start before", s);
}

bool save_site_begin(struct save_site *site, const struct campaign *c)
{
    char path[512], why[256];
    *site = (struct save_site){.before = station_new(c->image, c->seed), .old = 0};
    struct station *s = site->before;
    if (s == NULL)
        return false;
    (void)snprintf(path, sizeof(path), "%s/%s", c->root,
                   versions_use(c->image->chip == &chip_stm32f405));
    board_power_on(s->board);
    if (!station_greet(s))
        return refuse("start", s);
    station_run(s, NEW_CHIP_NS);
    if (!station_configure(s, path, why, sizeof(why)))
        return refuse(why, s);
    if (!versions_set(s, 0) || !versions_learn(s) || !station_ask(s, "save") || !versions_set(s, 1))
        return refuse("settings", s);
    return rehearse(site) && prepare_start(site, c);
}

bool save_site_fill(struct save_site *site)
{
    /* The first erase is of the other slot, which has had nothing yet. */
    for (unsigned erases = site->erases != 0; erases < 2u || site->erases == 0;) {
        if (site->old + 4u >= VERSIONS_MAX)
            return refuse("no save erased a slot", site->before);
        if (!next_version(site))
            return false;
        erases += site->erases != 0;
    }
    return true;
}

void save_site_put(struct station *s, const uint8_t *bytes, const uint8_t *unstable)
{
    struct stored_flash *f = stored_flash(s->board);
    (void)memcpy(f->bytes, bytes, s->board->chip->stored_size);
    (void)memcpy(f->unstable, unstable, s->board->chip->stored_size);
}

struct station *save_site_start(struct save_site *site)
{
    const struct stored_flash *f = stored_flash(site->before->board);
    site->start->board->random = site->before->board->random;
    save_site_put(site->start, f->bytes, f->unstable);
    return site->start;
}

bool save_with_cut(struct station *s, unsigned word, unsigned erase, unsigned per_mille)
{
    struct stored_flash *f = stored_flash(s->board);
    f->cut_word = word != 0 ? f->words + word : 0;
    f->cut_erase = erase != 0 ? f->erase_count + erase : 0;
    f->cut_per_mille = per_mille;
    (void)station_ask(s, "save");
    f->cut_word = f->cut_erase = 0;
    return f->cut;
}
