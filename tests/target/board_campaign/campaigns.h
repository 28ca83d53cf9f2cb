/* The campaigns of board-campaign.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_BOARD_CAMPAIGN_CAMPAIGNS_H
#define REFLUX_BOARD_CAMPAIGN_CAMPAIGNS_H

#include "runs.h"
#include "station.h"

#define ERASE_POINTS 20u

struct campaign {
    const struct image *image;
    const char *root; /* of the repository */
    struct runs *runs;
    uint64_t seed;
    unsigned from, count; /* runs by number */
    unsigned stride;      /* of the first cuts: every so many places */
    unsigned whole;       /* every so many runs read everything back, and save once more */
    bool append_only;     /* no saves that erase */
};

/* The first cut at each word of a save, and at 20 points within each of its erases. False: it could not begin. */
bool first_cuts(const struct campaign *c);
/* A cut in a save, and two more in the starts and saves after it, at random. */
bool further_cuts(const struct campaign *c);
/* A reset or a cut at a random instant, in five states, with a plant. */
bool random_instants(const struct campaign *c);

/* For these: a generator for one run, and a number below another. */
uint64_t campaign_random(const struct campaign *c, unsigned run);
uint32_t below(uint64_t *random, uint32_t limit);

#endif
