/* The channels of a plant at a board's own pins that no line of the wiring names: they are at the plant link, with --rest-on-link.
 *
 * The link's plant is plugged in when plant time begins. Its sample of a tick goes out when the board has taken its own, so that it is there at
 * the next one however slow the line is, and the command that answers it counts from then on. As long as the two greet, outputs are safe.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_HOST_SIM_REST_SIDE_H
#define REFLUX_HOST_SIM_REST_SIDE_H

#include "link_server.h"
#include "pins_side.h"

struct rest_side {
    struct link_server *link;
    bool begun;                           /* plant time runs, the link is plugged in */
    uint8_t measured[LINK_CHANNELS_MAX];  /* index in samples of the plant, of each measurement */
    uint8_t commanded[LINK_CHANNELS_MAX]; /* likewise in commands, of each output */
    struct link_command command;          /* what holds at present */
};

/* Begins the link with the channels that are at no pin. False, with a sentence in err: there are none. */
bool rest_side_open(struct rest_side *r, struct link_server *link, const struct pins_side *pins,
                    const struct plant_class *class, uint32_t tick_ms, uint32_t session, char *err,
                    size_t err_size);

/* The sample of the plant of a tick. Those before the second only plug the link in, so that its greeting never is a race. */
void rest_side_sample(struct rest_side *r, const struct link_sample *sample);

/* Looks whether an answer has come. */
void rest_side_listen(struct rest_side *r);

/* Adds what holds to the command of a tick. */
void rest_side_command(const struct rest_side *r, struct link_command *command);

#endif
