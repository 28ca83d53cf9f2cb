/* The frame decoder against a second one written from docs/inside/plant-link.md: same frames, same counts, and what is
 * delivered encodes to the very bytes it came from. The line in pieces gives the same as byte by byte.
 *
 * Input: a first byte; when it is even the rest goes on the line as it is, else the rest describes frames
 * (operation, type, sequence, length, payload), which are encoded and damaged as the operation says.
 */
#include <stdbool.h>
#include <string.h>

#include "fuzz.h"
#include "link/frame.h"

#define LINE_MAX 8192
/* Without the delimiter: header 3, payload, CRC 4, COBS 1. 248 but on a small board. */
#define LONGEST (3u + FRAME_PAYLOAD_MAX + 4u + 1u)

static uint8_t line[LINE_MAX];
static size_t n_line;

static void put(const uint8_t *bytes, size_t n)
{
    if (n > LINE_MAX - n_line)
        n = LINE_MAX - n_line;
    if (n)
        memcpy(line + n_line, bytes, n);
    n_line += n;
}

static void put_described(struct feed *f)
{
    while (f->left && n_line < LINE_MAX) {
        uint8_t operation = feed_byte(f);
        struct frame frame = {.type = feed_byte(f)};
        frame.sequence = feed_byte(f);
        frame.sequence = (uint16_t)(frame.sequence | (unsigned)feed_byte(f) << 8);
        size_t n = feed_byte(f);
        uint8_t wire[FRAME_WIRE_MAX];
        frame.n = (uint8_t)n;
        if (n > FRAME_PAYLOAD_MAX) {
            DEMAND(frame_encode(&frame, wire) == 0);
            continue;
        }
        const uint8_t *payload = feed_bytes(f, &n);
        if (n)
            memcpy(frame.payload, payload, n);
        frame.n = (uint8_t)n;
        size_t size = frame_encode(&frame, wire);
        DEMAND(size == n + 9 && wire[size - 1] == 0 && memchr(wire, 0, size) == wire + size - 1);
        size_t at = (size_t)(operation >> 3) * size / 32;
        switch (operation & 7u) {
        case 4:
            wire[at] ^= (uint8_t)(1u << (at & 7u));
            put(wire, size);
            break;
        case 5: /* the end is missing */
            put(wire, at);
            break;
        case 6: /* torn in two */
            put(wire, at);
            put((const uint8_t *)"", 1);
            put(wire + at, size - at);
            break;
        case 7:
            put(wire, size);
            put(wire, size);
            break;
        default:
            put(wire, size);
        }
    }
}

static uint32_t crc_of(const uint8_t *bytes, size_t n)
{
    uint32_t r = 0xFFFFFFFFu;
    for (size_t i = 0; i < n; i++) {
        r ^= bytes[i];
        for (int k = 0; k < 8; k++)
            r = r & 1u ? (r >> 1) ^ 0xEDB88320u : r >> 1;
    }
    return ~r;
}

enum verdict { GOOD, BAD_CRC, MALFORMED, OVERLONG, NOTHING };

/* Judges the n bytes between two delimiters. */
static enum verdict judge(const uint8_t *piece, size_t n, struct frame *frame)
{
    uint8_t body[256];
    size_t size = 0;
    if (n == 0)
        return NOTHING;
    if (n > LONGEST)
        return OVERLONG;
    for (size_t at = 0; at < n; at += piece[at]) {
        if (at + piece[at] > n)
            return MALFORMED;
        if (at > 0)
            body[size++] = 0;
        memcpy(body + size, piece + at + 1, piece[at] - 1u);
        size += piece[at] - 1u;
    }
    if (size < 7)
        return MALFORMED;
    size_t covered = size - 4;
    uint32_t sent = (uint32_t)body[covered] | (uint32_t)body[covered + 1] << 8 |
                    (uint32_t)body[covered + 2] << 16 | (uint32_t)body[covered + 3] << 24;
    if (sent != crc_of(body, covered))
        return BAD_CRC;
    frame->type = body[0];
    frame->sequence = (uint16_t)(body[1] | (unsigned)body[2] << 8);
    frame->n = (uint8_t)(covered - 3);
    memcpy(frame->payload, body + 3, frame->n);
    return GOOD;
}

static uint32_t mixed(uint32_t sum, const struct frame *f)
{
    sum = (sum ^ f->type ^ (uint32_t)f->sequence << 8 ^ (uint32_t)f->n << 24) * 0x01000193u;
    for (unsigned i = 0; i < f->n; i++)
        sum = (sum ^ f->payload[i]) * 0x01000193u;
    return sum;
}

/* The line in pieces, whose sizes its own bytes give. */
static uint32_t in_pieces(struct frame_decoder *decoder)
{
    uint32_t sum = 0;
    frame_decoder_reset(decoder);
    for (size_t from = 0, end = 0; from < n_line;) {
        struct frame got;
        bool delivered;
        if (from == end)
            end += 1u + line[from] % 97u;
        if (end > n_line)
            end = n_line;
        size_t taken = frame_decode_bytes(decoder, line + from, end - from, &got, &delivered);
        DEMAND(taken > 0 && taken <= end - from);
        from += taken;
        if (delivered)
            sum = mixed(sum, &got);
    }
    return sum;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct feed f = {data, size};
    n_line = 0;
    if (feed_byte(&f) & 1u)
        put_described(&f);
    else
        put(f.data, f.left);

    struct frame_decoder decoder, second;
    uint32_t expected[5] = {0}, sum = 0;
    frame_decoder_reset(&decoder);
    size_t from = 0;
    for (size_t i = 0; i < n_line; i++) {
        struct frame got, wanted;
        bool delivered = frame_decode(&decoder, line[i], &got);
        if (line[i] != 0) {
            DEMAND(!delivered);
            continue;
        }
        enum verdict verdict = judge(line + from, i - from, &wanted);
        expected[verdict]++;
        DEMAND(delivered == (verdict == GOOD));
        if (delivered) {
            sum = mixed(sum, &got);
            uint8_t wire[FRAME_WIRE_MAX];
            DEMAND(got.type == wanted.type && got.sequence == wanted.sequence);
            DEMAND(got.n == wanted.n && memcmp(got.payload, wanted.payload, got.n) == 0);
            DEMAND(frame_encode(&got, wire) == i + 1 - from);
            DEMAND(memcmp(wire, line + from, i + 1 - from) == 0);
        }
        from = i + 1;
    }
    DEMAND(decoder.count.good == expected[GOOD]);
    DEMAND(decoder.count.bad_crc == expected[BAD_CRC]);
    DEMAND(decoder.count.malformed == expected[MALFORMED]);
    DEMAND(decoder.count.overlong == expected[OVERLONG]);
    DEMAND(in_pieces(&second) == sum && second.n == decoder.n);
    DEMAND(memcmp(&second.count, &decoder.count, sizeof decoder.count) == 0);
    return 0;
}
