#include "link/frame.h"

#include <string.h> /* memcpy */

#include "base/crc32.h"

#define HEADER_SIZE 3 /* type, sequence */
#define CRC_SIZE    4

/* Stuffs n bytes of body. Bodies are shorter than 254 bytes, so no group can reach the full length of 0xFF
 * and the overhead is always one byte. Returns the bytes written. */
static size_t stuff(const uint8_t *body, size_t n, uint8_t *wire)
{
    size_t code_at = 0; /* where the length of the group under way will be written */
    size_t out = 1;
    for (size_t i = 0; i < n; i++) {
        if (body[i] == 0) {
            wire[code_at] = (uint8_t)(out - code_at);
            code_at = out;
            out++;
        } else {
            wire[out] = body[i];
            out++;
        }
    }
    wire[code_at] = (uint8_t)(out - code_at);
    return out;
}

/* Undoes stuff() in place (the result is never ahead of what is read). Returns the bytes of the body, or 0
 * when the group lengths do not add up to n. */
static size_t unstuff(uint8_t *buffer, size_t n)
{
    size_t in = 0;
    size_t out = 0;
    while (in < n) {
        size_t group = buffer[in];
        if (group == 0 || group > n - in) {
            return 0;
        }
        in++;
        for (size_t i = 1; i < group; i++) {
            buffer[out] = buffer[in];
            out++;
            in++;
        }
        if (in < n) {
            buffer[out] = 0;
            out++;
        }
    }
    return out;
}

size_t frame_encode(const struct frame *frame, uint8_t *wire)
{
    if (frame->n > FRAME_PAYLOAD_MAX) {
        return 0;
    }
    uint8_t body[FRAME_BODY_MAX];
    size_t n = HEADER_SIZE + (size_t)frame->n;
    body[0] = frame->type;
    body[1] = (uint8_t)(frame->sequence & 0xFFu);
    body[2] = (uint8_t)(frame->sequence >> 8);
    memcpy(body + HEADER_SIZE, frame->payload, frame->n);
    uint32_t crc = crc32_update(0, body, n);
    for (unsigned i = 0; i < CRC_SIZE; i++) {
        body[n + i] = (uint8_t)(crc >> (8u * i));
    }
    size_t written = stuff(body, n + CRC_SIZE, wire);
    wire[written] = 0;
    return written + 1;
}

void frame_decoder_reset(struct frame_decoder *decoder)
{
    decoder->n = 0;
    decoder->overlong = false;
    decoder->count.good = 0;
    decoder->count.bad_crc = 0;
    decoder->count.malformed = 0;
    decoder->count.overlong = 0;
}

/* Judges the n stuffed bytes that stand before a delimiter. */
static bool complete(struct frame_decoder *decoder, size_t n, struct frame *frame)
{
    uint8_t *body = decoder->buffer;
    size_t size = unstuff(body, n);
    if (size < HEADER_SIZE + CRC_SIZE || size > FRAME_BODY_MAX) {
        decoder->count.malformed++;
        return false;
    }
    size_t covered = size - CRC_SIZE;
    uint32_t crc = 0;
    for (unsigned i = 0; i < CRC_SIZE; i++) {
        crc |= (uint32_t)body[covered + i] << (8u * i);
    }
    if (crc != crc32_update(0, body, covered)) {
        decoder->count.bad_crc++;
        return false;
    }
    frame->type = body[0];
    frame->sequence = (uint16_t)(body[1] | ((unsigned)body[2] << 8));
    frame->n = (uint8_t)(covered - HEADER_SIZE);
    memcpy(frame->payload, body + HEADER_SIZE, frame->n);
    decoder->count.good++;
    return true;
}

bool frame_decode(struct frame_decoder *decoder, uint8_t byte, struct frame *frame)
{
    if (byte != 0) {
        if (decoder->n < FRAME_WIRE_MAX - 1) {
            decoder->buffer[decoder->n] = byte;
            decoder->n++;
        } else {
            decoder->overlong = true; /* skipped until the next delimiter */
        }
        return false;
    }
    size_t n = decoder->n;
    bool overlong = decoder->overlong;
    decoder->n = 0;
    decoder->overlong = false;
    if (overlong) {
        decoder->count.overlong++;
        return false;
    }
    if (n == 0) {
        return false; /* delimiters in a row: a sender may begin with one to flush noise from the line */
    }
    return complete(decoder, n, frame);
}
