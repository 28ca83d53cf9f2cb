/* Plant link, upper half: the messages in the frames. Each message has a struct, a pack and an unpack function.
 * P = plant (the simulator, or real hardware speaking the protocol), C = controller (the firmware).
 *
 * pack_*: fill frame->type, n and payload (the caller sets sequence). Texts are cut to their field, counts
 * to LINK_CHANNELS_ROOM.
 * unpack_*: ERR_FRAME when type, length, counts, flags, or texts (no terminating zero, bytes outside printable
 * ASCII, no channel name) are wrong; ERR_NOT_FINITE for a span, safe value or driven output that is no number;
 * ERR_RANGE for an empty span, a safe value outside it, a plant tick of 0, more channels in a HELLO than
 * LINK_CHANNELS_MAX. A reading that is not finite passes as it is, because a broken sensor is not a broken frame.
 * On error *m is unchanged, except for a HELLO: ERR_VERSION fills in m->version and m->role, the rest is 0; ERR_RANGE
 * fills in everything.
 */
#ifndef REFLUX_LINK_MESSAGES_H
#define REFLUX_LINK_MESSAGES_H

#include "base/channel.h"
#include "base/error.h"
#include "link/frame.h"

#define LINK_VERSION 1
/* Silence after which the other side counts as gone: no valid frame for this long by the receiver's own clock. */
#define LINK_SILENCE_MS      2000
#define LINK_KEEP_ALIVE_MS   500 /* longest time without a frame sent */
#define LINK_HELLO_MS        250 /* time between greetings until the other side answers */
#define LINK_PLANT_NAME_SIZE 24
#define LINK_CHANNELS_MAX    16 /* channels of each kind in the protocol */
#ifndef LINK_CHANNELS_ROOM
/* Channels of each kind in the longest sample and command that this build takes. */
#define LINK_CHANNELS_ROOM LINK_CHANNELS_MAX
#endif

enum link_message {
    LINK_HELLO = 1,        /* P->C and C->P */
    LINK_PAGE_REQUEST = 2, /* C->P */
    LINK_PAGE = 3,         /* P->C */
    LINK_READY = 4,        /* C->P */
    LINK_SAMPLE = 5,       /* P->C */
    LINK_COMMAND = 6,      /* C->P */
    LINK_KEEP_ALIVE = 7    /* both, no payload */
};

#define SAMPLE_COUNT_AT 12 /* index of n_measurements in the payload of a SAMPLE */

enum link_role { LINK_ROLE_PLANT = 1, LINK_ROLE_CONTROLLER = 2 };

/* payload: version u8, role u8, session u32, n_measurements u8, n_outputs u8, tick_ms u32, name char[24] */
struct link_hello {
    uint8_t version;
    uint8_t role;
    uint32_t session;                  /* differs after each restart of the sender */
    uint8_t n_measurements, n_outputs; /* controller: 0, 0 */
    uint32_t tick_ms; /* plant: interval of its samples in plant time; controller: 0 */
    char name[LINK_PLANT_NAME_SIZE];
};

/* payload: index u8 (measurements first, then manipulated variables) */
struct link_page_request {
    uint8_t index;
};

/* payload: index u8, manipulated u8 (0 or 1), lo f32, hi f32, safe f32, name char[16], unit char[12] */
struct link_page {
    uint8_t index;
    bool manipulated;
    float lo, hi, safe;
    char name[CHANNEL_NAME_SIZE];
    char unit[CHANNEL_UNIT_SIZE];
};

/* payload: session u32 (from the HELLO of the plant) */
struct link_ready {
    uint32_t session;
};

struct link_reading {
    float value;
    uint8_t quality; /* enum quality */
};

/* payload: number u32, time_ms u64, n_measurements u8, n_readback u8, then value f32 + quality u8 for each */
struct link_sample {
    uint32_t number;
    uint64_t time_ms;
    uint8_t n_measurements, n_readback; /* n_readback: 0 or n_outputs */
    struct link_reading measurement[LINK_CHANNELS_ROOM];
    struct link_reading readback[LINK_CHANNELS_ROOM];
};

/* payload: number u32, time_ms u64, flags u8 (bit 0: safe state), n_outputs u8, then value f32 + drive u8 */
struct link_command {
    uint32_t number;  /* number of the sample that the command answers */
    uint64_t time_ms; /* plant time of that sample */
    bool safe;
    uint8_t n_outputs;
    struct {
        float value;
        bool drive; /* false: the controller does not command this one */
    } output[LINK_CHANNELS_ROOM];
};

void pack_hello(const struct link_hello *m, struct frame *f);
void pack_page_request(const struct link_page_request *m, struct frame *f);
void pack_page(const struct link_page *m, struct frame *f);
void pack_ready(const struct link_ready *m, struct frame *f);
void pack_sample(const struct link_sample *m, struct frame *f);
void pack_command(const struct link_command *m, struct frame *f);
void pack_keep_alive(struct frame *f);

MUST_CHECK enum err unpack_hello(const struct frame *f, struct link_hello *m);
MUST_CHECK enum err unpack_page_request(const struct frame *f, struct link_page_request *m);
MUST_CHECK enum err unpack_page(const struct frame *f, struct link_page *m);
MUST_CHECK enum err unpack_ready(const struct frame *f, struct link_ready *m);
MUST_CHECK enum err unpack_sample(const struct frame *f, struct link_sample *m);
MUST_CHECK enum err unpack_command(const struct frame *f, struct link_command *m);

#endif
