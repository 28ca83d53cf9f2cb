/* Sets that differ in values at their beginning, in their middle and at their end: version v of the settings. What a board says of its
 * settings is one of these, or something else.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_BOARD_CAMPAIGN_VERSIONS_H
#define REFLUX_BOARD_CAMPAIGN_VERSIONS_H

#include "station.h"

#define VERSIONS_MAX 64

/* Chooses the settings: three blocks with a table, or two loops. Returns their file, below the repository. */
const char *versions_use(bool blocks);

/* Puts a version into force. */
bool versions_set(struct station *s, unsigned version);
/* All that is in force becomes the reference for versions_whole(). */
bool versions_learn(struct station *s);

/* The version in force, by the values that differ; -1 with the reason: it is none. */
int versions_read(struct station *s, char *why, size_t size);
/* The same by everything that `dump` prints. */
int versions_whole(struct station *s, char *why, size_t size);

#endif
