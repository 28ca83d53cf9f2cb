/* The unpackers of the plant link on any payload. What one accepts keeps the promises of link/messages.h, packs
 * to a frame of the same length that unpacks and packs to itself; what it refuses leaves the message alone, but for a
 * HELLO of another version or with numbers out of range.
 *
 * Input: type, then the payload.
 */
#include <stdbool.h>
#include <string.h>

#include "fuzz.h"
#include "link/messages.h"

static void same(const struct frame *a, const struct frame *b)
{
    DEMAND(a->type == b->type && a->n == b->n);
    DEMAND(a->n == 0 || memcmp(a->payload, b->payload, a->n) == 0);
}

static void untouched(const void *message, size_t n)
{
    for (size_t i = 0; i < n; i++)
        DEMAND(((const uint8_t *)message)[i] == 0xA5);
}

static void is_text(const char *text, size_t size)
{
    DEMAND(memchr(text, 0, size) != NULL);
    for (; *text; text++)
        DEMAND(*text >= ' ' && *text <= '~');
}

/* unpack -> pack -> unpack -> pack: the frames of the two packings are equal. */
#define ROUND_TRIP(kind, accepted)                                                                 \
    static void kind##_trip(const struct frame *f)                                                 \
    {                                                                                              \
        struct link_##kind m, again;                                                               \
        struct frame packed = {0}, twice = {0};                                                    \
        memset(&m, 0xA5, sizeof m);                                                                \
        enum err err = unpack_##kind(f, &m);                                                       \
        if (err == ERR_VERSION || (f->type == LINK_HELLO && err == ERR_RANGE))                     \
            return;                                                                                \
        if (err != ERR_OK) {                                                                       \
            untouched(&m, sizeof m);                                                               \
            return;                                                                                \
        }                                                                                          \
        accepted(f, &m);                                                                           \
        pack_##kind(&m, &packed);                                                                  \
        DEMAND(packed.type == f->type && packed.n == f->n);                                        \
        DEMAND(unpack_##kind(&packed, &again) == ERR_OK);                                          \
        pack_##kind(&again, &twice);                                                               \
        same(&packed, &twice);                                                                     \
    }

static void hello_accepted(const struct frame *f, const struct link_hello *m)
{
    DEMAND(f->type == LINK_HELLO && m->version == LINK_VERSION);
    DEMAND(m->n_measurements <= LINK_CHANNELS_MAX && m->n_outputs <= LINK_CHANNELS_MAX);
    is_text(m->name, sizeof m->name);
}

static void page_request_accepted(const struct frame *f, const struct link_page_request *m)
{
    DEMAND(f->type == LINK_PAGE_REQUEST && f->n == 1 && m->index == f->payload[0]);
}

static void page_accepted(const struct frame *f, const struct link_page *m)
{
    DEMAND(f->type == LINK_PAGE && f->n == 42);
    DEMAND(float_is_finite(m->lo) && float_is_finite(m->hi) && float_is_finite(m->safe));
    DEMAND(m->lo < m->hi);
    DEMAND(!m->manipulated || (m->safe >= m->lo && m->safe <= m->hi));
    DEMAND(m->name[0] != '\0');
    is_text(m->name, sizeof m->name);
    is_text(m->unit, sizeof m->unit);
}

static void ready_accepted(const struct frame *f, const struct link_ready *m)
{
    (void)m;
    DEMAND(f->type == LINK_READY && f->n == 4);
}

static void reading_accepted(const struct link_reading *r)
{
    DEMAND(r->quality <= QUALITY_MISSING);
}

static void sample_accepted(const struct frame *f, const struct link_sample *m)
{
    DEMAND(f->type == LINK_SAMPLE && f->n == 14 + 5 * (m->n_measurements + m->n_readback));
    DEMAND(m->n_measurements <= LINK_CHANNELS_MAX && m->n_readback <= LINK_CHANNELS_MAX);
    for (unsigned i = 0; i < m->n_measurements; i++)
        reading_accepted(&m->measurement[i]);
    for (unsigned i = 0; i < m->n_readback; i++)
        reading_accepted(&m->readback[i]);
}

static void command_accepted(const struct frame *f, const struct link_command *m)
{
    DEMAND(f->type == LINK_COMMAND && f->n == 14 + 5 * m->n_outputs);
    DEMAND(m->n_outputs <= LINK_CHANNELS_MAX);
    for (unsigned i = 0; i < m->n_outputs; i++)
        DEMAND(!m->output[i].drive || float_is_finite(m->output[i].value));
}

ROUND_TRIP(hello, hello_accepted)
ROUND_TRIP(page_request, page_request_accepted)
ROUND_TRIP(page, page_accepted)
ROUND_TRIP(ready, ready_accepted)
ROUND_TRIP(sample, sample_accepted)
ROUND_TRIP(command, command_accepted)

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct feed f = {data, size};
    struct frame frame = {.type = feed_byte(&f)};
    size_t n = FRAME_PAYLOAD_MAX;
    const uint8_t *payload = feed_bytes(&f, &n);
    if (n)
        memcpy(frame.payload, payload, n);
    frame.n = (uint8_t)n;
    hello_trip(&frame);
    page_request_trip(&frame);
    page_trip(&frame);
    ready_trip(&frame);
    sample_trip(&frame);
    command_trip(&frame);
    return 0;
}
