/* A board just before a save, and one just before it reads what is stored: every run begins as a copy of them.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_BOARD_CAMPAIGN_SAVE_SITE_H
#define REFLUX_BOARD_CAMPAIGN_SAVE_SITE_H

#include "campaigns.h"

struct save_site {
    struct station *before; /* `save` is the next line */
    struct station *start;  /* powered on, in machine mode, its flash not read yet */
    unsigned old;           /* version that is stored; the next one is in force */
    unsigned words, erases; /* of the save */
};

/* A board with three blocks (STM32F405) or two loops in force, and saved. */
bool save_site_begin(struct save_site *site, const struct campaign *c);
/* Saves until the next save erases a slot full of earlier sets. */
bool save_site_fill(struct save_site *site);

/* What is stored, with its unstable bits, goes into a board that has not read it yet. */
void save_site_put(struct station *s, const uint8_t *bytes, const uint8_t *unstable);
/* The start after the save: with what it has left. */
struct station *save_site_start(struct save_site *site);

/* Sends `save` with the supply cut within a word (1 = the first) or, where word is 0, in an erase. False: it was not cut; said has the
 * answer. */
bool save_with_cut(struct station *s, unsigned word, unsigned erase, unsigned per_mille);

#endif
