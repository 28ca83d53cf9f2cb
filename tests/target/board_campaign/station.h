/* A board with somebody at its console and, if there is one, a plant at its link.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_BOARD_CAMPAIGN_STATION_H
#define REFLUX_BOARD_CAMPAIGN_STATION_H

#include "chip.h"
#include "models/models.h"

#define MS           UINT64_C(1000000)
#define SECOND       (1000u * MS)
#define STATION_ROOM (1u << 18)
#define NEW_CHIP_NS  (5u * SECOND) /* a new chip erases first, and may lose what it is sent */

struct plant_side;

struct station {
    struct board *board;
    struct plant_side *plant; /* NULL: none */
    bool loaded;              /* since station_forget(): an event has told of the stored set */
    size_t n, line;
    char said[STATION_ROOM]; /* on the console since the last question, without carriage returns */
};

struct image {
    const struct chip *chip;
    size_t bytes;
    uint32_t crc;
    uint8_t data[1u << 20];
};

/* Power is not on yet. NULL: no memory, or the image does not fit. */
struct station *station_new(const struct image *image, uint64_t seed);

/* Goes on for so long, or until a verdict or a cut of the flash (stored_flash.cut). */
void station_run(struct station *s, uint64_t ns);
/* Until the console has said words, |-separated; false: not within ns. */
bool station_until(struct station *s, const char *words, uint64_t ns);
void station_forget(struct station *s);
/* Sends a line. True: answered `ok`; what was answered is in said. */
bool station_ask(struct station *s, const char *line);

/* From power-on or a reset to the console's machine mode. */
bool station_greet(struct station *s);
/* Until the stored set, if any, is in force. */
bool station_loaded(struct station *s);
/* Every line of a .conf file. False with the line that was refused. */
bool station_configure(struct station *s, const char *path, char *why, size_t size);

#endif
