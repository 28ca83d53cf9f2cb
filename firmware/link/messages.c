#include "link/messages.h"

#include <string.h> /* memcpy, memset */

#define HELLO_SIZE        (12 + LINK_PLANT_NAME_SIZE)
#define PAGE_REQUEST_SIZE 1
#define PAGE_SIZE         (14 + CHANNEL_NAME_SIZE + CHANNEL_UNIT_SIZE)
#define READY_SIZE        4
#define SAMPLE_HEAD_SIZE  14
#define COMMAND_HEAD_SIZE 14
#define VALUE_SIZE        5 /* an f32 and one byte */
#define COMMAND_SAFE      0x01u
#define HELLO_FIXED_SIZE  2 /* version and role stand first in every version of the protocol */

_Static_assert(SAMPLE_HEAD_SIZE + 2 * LINK_CHANNELS_ROOM * VALUE_SIZE <= FRAME_PAYLOAD_MAX &&
                   PAGE_SIZE <= FRAME_PAYLOAD_MAX,
               "the largest message fits a frame");
_Static_assert(sizeof(float) == sizeof(uint32_t), "float is IEEE-754 binary32");

/* Cursor over a payload. It needs no checks of its own, because the callers check lengths before they read. */
struct cursor {
    uint8_t *position;
};

struct reader {
    const uint8_t *position;
};

static void put_u8(struct cursor *c, uint8_t x)
{
    *c->position = x;
    c->position++;
}

static void put_u32(struct cursor *c, uint32_t x)
{
    c->position[0] = (uint8_t)(x & 0xFFu);
    c->position[1] = (uint8_t)(x >> 8 & 0xFFu);
    c->position[2] = (uint8_t)(x >> 16 & 0xFFu);
    c->position[3] = (uint8_t)(x >> 24);
    c->position += 4;
}

static void put_u64(struct cursor *c, uint64_t x)
{
    put_u32(c, (uint32_t)(x & 0xFFFFFFFFu));
    put_u32(c, (uint32_t)(x >> 32));
}

static void put_f32(struct cursor *c, float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof(bits));
    put_u32(c, bits);
}

/* Puts a text with a terminating zero and zeros up to the end, so that the same message gives the same bytes. */
static void put_text(struct cursor *c, const char *text, size_t size)
{
    size_t i = 0;
    for (; i < size - 1 && text[i] != '\0'; i++) {
        c->position[i] = (uint8_t)text[i];
    }
    memset(c->position + i, 0, size - i);
    c->position += size;
}

static uint8_t get_u8(struct reader *r)
{
    uint8_t x = *r->position;
    r->position++;
    return x;
}

static uint32_t get_u32(struct reader *r)
{
    const uint8_t *at = r->position;
    r->position += 4;
    return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static uint64_t get_u64(struct reader *r)
{
    uint64_t low = get_u32(r);
    return low | ((uint64_t)get_u32(r) << 32);
}

static float get_f32(struct reader *r)
{
    uint32_t bits = get_u32(r);
    float x;
    memcpy(&x, &bits, sizeof(x));
    return x;
}

/* Gets printable ASCII up to a terminating zero, and ignores the bytes after it. Returns whether the text is valid. */
static bool get_text(struct reader *r, char *text, size_t size)
{
    bool ended = false;
    bool good = true;
    for (size_t i = 0; i < size; i++) {
        uint8_t byte = get_u8(r);
        if (byte == 0) {
            ended = true;
        }
        if (!ended && (byte < 0x20 || byte > 0x7E)) {
            good = false;
        }
        text[i] = ended ? '\0' : (char)byte;
    }
    return ended && good;
}

static struct cursor begin_message(struct frame *f, enum link_message type)
{
    f->type = (uint8_t)type;
    f->n = 0;
    return (struct cursor){.position = f->payload};
}

static void end_message(struct frame *f, const struct cursor *c)
{
    f->n = (uint8_t)(c->position - f->payload);
}

static uint8_t at_most(uint8_t n, uint8_t limit)
{
    return n < limit ? n : limit;
}

void pack_hello(const struct link_hello *m, struct frame *f)
{
    struct cursor c = begin_message(f, LINK_HELLO);
    put_u8(&c, m->version);
    put_u8(&c, m->role);
    put_u32(&c, m->session);
    put_u8(&c, m->n_measurements);
    put_u8(&c, m->n_outputs);
    put_u32(&c, m->tick_ms);
    put_text(&c, m->name, LINK_PLANT_NAME_SIZE);
    end_message(f, &c);
}

void pack_page_request(const struct link_page_request *m, struct frame *f)
{
    struct cursor c = begin_message(f, LINK_PAGE_REQUEST);
    put_u8(&c, m->index);
    end_message(f, &c);
}

void pack_page(const struct link_page *m, struct frame *f)
{
    struct cursor c = begin_message(f, LINK_PAGE);
    put_u8(&c, m->index);
    put_u8(&c, m->manipulated ? 1 : 0);
    put_f32(&c, m->lo);
    put_f32(&c, m->hi);
    put_f32(&c, m->safe);
    put_text(&c, m->name, CHANNEL_NAME_SIZE);
    put_text(&c, m->unit, CHANNEL_UNIT_SIZE);
    end_message(f, &c);
}

void pack_ready(const struct link_ready *m, struct frame *f)
{
    struct cursor c = begin_message(f, LINK_READY);
    put_u32(&c, m->session);
    end_message(f, &c);
}

static void put_readings(struct cursor *c, const struct link_reading *reading, uint8_t n)
{
    for (uint8_t i = 0; i < n; i++) {
        put_f32(c, reading[i].value);
        put_u8(c, reading[i].quality);
    }
}

void pack_sample(const struct link_sample *m, struct frame *f)
{
    uint8_t n_measurements = at_most(m->n_measurements, LINK_CHANNELS_ROOM);
    uint8_t n_readback = at_most(m->n_readback, LINK_CHANNELS_ROOM);
    struct cursor c = begin_message(f, LINK_SAMPLE);
    put_u32(&c, m->number);
    put_u64(&c, m->time_ms);
    put_u8(&c, n_measurements);
    put_u8(&c, n_readback);
    put_readings(&c, m->measurement, n_measurements);
    put_readings(&c, m->readback, n_readback);
    end_message(f, &c);
}

void pack_command(const struct link_command *m, struct frame *f)
{
    uint8_t n_outputs = at_most(m->n_outputs, LINK_CHANNELS_ROOM);
    struct cursor c = begin_message(f, LINK_COMMAND);
    put_u32(&c, m->number);
    put_u64(&c, m->time_ms);
    put_u8(&c, m->safe ? COMMAND_SAFE : 0);
    put_u8(&c, n_outputs);
    for (uint8_t i = 0; i < n_outputs; i++) {
        put_f32(&c, m->output[i].value);
        put_u8(&c, m->output[i].drive ? 1 : 0);
    }
    end_message(f, &c);
}

void pack_keep_alive(struct frame *f)
{
    struct cursor c = begin_message(f, LINK_KEEP_ALIVE);
    end_message(f, &c);
}

static bool has_shape(const struct frame *f, enum link_message type, size_t size)
{
    return f->type == (uint8_t)type && f->n == size;
}

enum err unpack_hello(const struct frame *f, struct link_hello *m)
{
    if (f->type != LINK_HELLO || f->n < HELLO_FIXED_SIZE) {
        return ERR_FRAME;
    }
    struct reader r = {.position = f->payload};
    struct link_hello x = {.version = get_u8(&r)};
    x.role = get_u8(&r);
    if (x.role != LINK_ROLE_PLANT && x.role != LINK_ROLE_CONTROLLER) {
        return ERR_FRAME;
    }
    if (x.version != LINK_VERSION) {
        *m = x;
        return ERR_VERSION;
    }
    if (f->n != HELLO_SIZE) {
        return ERR_FRAME;
    }
    x.session = get_u32(&r);
    x.n_measurements = get_u8(&r);
    x.n_outputs = get_u8(&r);
    x.tick_ms = get_u32(&r);
    if (!get_text(&r, x.name, sizeof(x.name))) {
        return ERR_FRAME;
    }
    *m = x;
    bool too_many = x.n_measurements > LINK_CHANNELS_MAX || x.n_outputs > LINK_CHANNELS_MAX;
    return too_many || (x.role == LINK_ROLE_PLANT && x.tick_ms == 0) ? ERR_RANGE : ERR_OK;
}

enum err unpack_page_request(const struct frame *f, struct link_page_request *m)
{
    if (!has_shape(f, LINK_PAGE_REQUEST, PAGE_REQUEST_SIZE)) {
        return ERR_FRAME;
    }
    m->index = f->payload[0];
    return ERR_OK;
}

enum err unpack_page(const struct frame *f, struct link_page *m)
{
    if (!has_shape(f, LINK_PAGE, PAGE_SIZE)) {
        return ERR_FRAME;
    }
    struct reader r = {.position = f->payload};
    struct link_page x = {.index = get_u8(&r)};
    uint8_t manipulated = get_u8(&r);
    x.manipulated = manipulated == 1;
    x.lo = get_f32(&r);
    x.hi = get_f32(&r);
    x.safe = get_f32(&r);
    bool name = get_text(&r, x.name, sizeof(x.name));
    bool unit = get_text(&r, x.unit, sizeof(x.unit));
    if (!name || !unit || manipulated > 1 || x.name[0] == '\0') {
        return ERR_FRAME;
    }
    if (!float_is_finite(x.lo) || !float_is_finite(x.hi) || !float_is_finite(x.safe)) {
        return ERR_NOT_FINITE;
    }
    if (x.lo >= x.hi || (x.manipulated && (x.safe < x.lo || x.safe > x.hi))) {
        return ERR_RANGE;
    }
    *m = x;
    return ERR_OK;
}

enum err unpack_ready(const struct frame *f, struct link_ready *m)
{
    if (!has_shape(f, LINK_READY, READY_SIZE)) {
        return ERR_FRAME;
    }
    struct reader r = {.position = f->payload};
    m->session = get_u32(&r);
    return ERR_OK;
}

/* Returns whether the quality bytes of n readings are known. */
static bool qualities_known(const uint8_t *payload, unsigned n)
{
    for (unsigned i = 0; i < n; i++) {
        if (payload[i * VALUE_SIZE + 4] > QUALITY_MISSING) {
            return false;
        }
    }
    return true;
}

static void get_readings(struct reader *r, struct link_reading *reading, uint8_t n)
{
    for (uint8_t i = 0; i < n; i++) {
        /* A value that is no number passes: the fault of the measurement is then `not a number`. */
        reading[i].value = get_f32(r);
        reading[i].quality = get_u8(r);
    }
}

enum err unpack_sample(const struct frame *f, struct link_sample *m)
{
    if (f->type != LINK_SAMPLE || f->n < SAMPLE_HEAD_SIZE) {
        return ERR_FRAME;
    }
    struct reader r = {.position = f->payload};
    uint32_t number = get_u32(&r);
    uint64_t time_ms = get_u64(&r);
    uint8_t n_measurements = get_u8(&r);
    uint8_t n_readback = get_u8(&r);
    if (n_measurements > LINK_CHANNELS_ROOM || n_readback > LINK_CHANNELS_ROOM) {
        return ERR_FRAME;
    }
    unsigned readings = (unsigned)n_measurements + n_readback;
    if (f->n != SAMPLE_HEAD_SIZE + readings * VALUE_SIZE ||
        !qualities_known(r.position, readings)) {
        return ERR_FRAME;
    }
    m->number = number;
    m->time_ms = time_ms;
    m->n_measurements = n_measurements;
    m->n_readback = n_readback;
    get_readings(&r, m->measurement, n_measurements);
    get_readings(&r, m->readback, n_readback);
    return ERR_OK;
}

enum err unpack_command(const struct frame *f, struct link_command *m)
{
    if (f->type != LINK_COMMAND || f->n < COMMAND_HEAD_SIZE) {
        return ERR_FRAME;
    }
    struct reader r = {.position = f->payload};
    struct link_command x = {.number = get_u32(&r)};
    x.time_ms = get_u64(&r);
    uint8_t flags = get_u8(&r);
    x.safe = (flags & COMMAND_SAFE) != 0;
    x.n_outputs = get_u8(&r);
    if ((flags & (uint8_t)~COMMAND_SAFE) != 0 || x.n_outputs > LINK_CHANNELS_ROOM ||
        f->n != COMMAND_HEAD_SIZE + (unsigned)x.n_outputs * VALUE_SIZE) {
        return ERR_FRAME;
    }
    for (uint8_t i = 0; i < x.n_outputs; i++) {
        float value = get_f32(&r);
        uint8_t drive = get_u8(&r);
        if (drive > 1) {
            return ERR_FRAME;
        }
        if (drive == 1 && !float_is_finite(value)) {
            return ERR_NOT_FINITE;
        }
        x.output[i].drive = drive == 1;
        x.output[i].value = drive == 1 ? value : 0.0f;
    }
    *m = x;
    return ERR_OK;
}
