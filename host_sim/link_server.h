/* The plant's side of the plant link (docs/inside/plant-link.md): greeting, pages, samples out, commands in, keep-alive
 * and silence. It never waits: call link_server_turn() whenever bytes may have come or link_server_due() is over.
 */
#ifndef REFLUX_HOST_SIM_LINK_SERVER_H
#define REFLUX_HOST_SIM_LINK_SERVER_H

#include "bench/output_log.h"
#include "bench/transport.h"
#include "link/messages.h"
#include "plants/plant.h"

#define LINK_REPEAT_MS 500 /* an unanswered sample is sent again */

enum link_state { LINK_GREETING, LINK_SAMPLING };

struct link_server {
    struct transport *transport;
    struct output_log *outputs; /* NULL: none */
    enum link_state state;
    uint64_t last_sent, last_heard, last_hello; /* own clock, ms */
    uint16_t sequence;
    struct frame_decoder decoder;
    struct link_hello hello; /* what the plant says of itself */
    struct link_page page[2 * LINK_CHANNELS_MAX];

    uint32_t greetings;     /* rises with each READY */
    uint32_t introductions; /* rises with each READY of a controller that did not know the plant */
    bool pages_asked;       /* since the last READY */
    bool controller_known;
    uint32_t controller_session;
    char controller_name[LINK_PLANT_NAME_SIZE];
    uint32_t silences; /* times the controller was given up */

    struct frame sample; /* the one under way, to send again */
    uint32_t sample_number;
    uint64_t sample_time_ms;
    uint64_t sample_sent;
    bool waiting; /* for the command that answers it */
    bool held;    /* after a new greeting: not sent again before link_server_resend() */
    bool answered;
    struct link_command command; /* valid when answered */

    struct {
        uint32_t frames_in, frames_out, repeats, unexpected, lost;
        uint16_t expected_sequence;
        bool sequence_known;
    } count;
    char error[160];
};

/* tick_ms: as announced. Fails when the plant does not fit the link. */
bool link_server_init(struct link_server *s, struct transport *t, const struct plant_class *class,
                      uint32_t tick_ms, uint32_t session, char *err, size_t err_size);

/* Takes what has arrived and does what is due. False when the peer is gone or speaks another version: the
 * reason is in s->error. */
bool link_server_turn(struct link_server *s);

/* Milliseconds until link_server_turn() has something to do even if nothing arrives. */
uint64_t link_server_due(struct link_server *s);

/* Sends a new sample; false when the peer is gone. */
bool link_server_sample(struct link_server *s, const struct link_sample *sample);

/* Sends the sample under way once more, now. */
bool link_server_resend(struct link_server *s);

#endif
