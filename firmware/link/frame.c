#include "link/frame.h"

#include <string.h> /* memcpy */

#include "base/crc32.h"

#define HEADER_SIZE 3 /* type, sequence */
#define CRC_SIZE    4

/* Stuffs in place: each zero of the body wire[1 .. n] becomes the distance to the next zero, or to the delimiter behind
 * the body. The first distance goes to wire[0]. Bodies are shorter than 254 bytes, so no distance can reach 0xFF and the
 * overhead is always one byte. The loop runs from the end, because each distance leads to a later byte. */
/*@ requires 1 <= n <= FRAME_BODY_MAX && \valid(wire + (0 .. n));
  @ assigns wire[0 .. n];
  @*/
static void stuff(uint8_t *wire, size_t n)
{
    size_t next = n + 1;
    /*@ loop invariant 0 <= at <= n && at < next <= n + 1;
      @ loop assigns at, next, wire[1 .. n];
      @ loop variant at;
      @*/
    for (size_t at = n; at > 0; at--) {
        if (wire[at] == 0) {
            wire[at] = (uint8_t)(next - at);
            next = at;
        }
    }
    wire[0] = (uint8_t)next;
}

/* Undoes stuff(): the distances among wire[0 .. n - 1] become zeros again, and the body begins after wire[0]. Returns
 * whether the distances lead from the first byte to the end, as they must. */
/*@ requires 0 < n < FRAME_WIRE_MAX && \valid(wire + (0 .. n - 1));
  @ assigns wire[0 .. n - 1];
  @*/
static bool unstuff(uint8_t *wire, size_t n)
{
    size_t at = 0;
    /*@ loop invariant at <= n;
      @ loop assigns at, wire[0 .. n - 1];
      @ loop variant n - at;
      @*/
    while (at < n) {
        size_t group = wire[at];
        if (group == 0 || group > n - at) {
            return false;
        }
        wire[at] = 0;
        at += group;
    }
    return true;
}

size_t frame_encode(const struct frame *frame, uint8_t *wire)
{
    if (frame->n > FRAME_PAYLOAD_MAX) {
        return 0;
    }
    uint8_t *body = wire + 1;
    size_t covered = HEADER_SIZE + (size_t)frame->n;
    body[0] = frame->type;
    body[1] = (uint8_t)(frame->sequence & 0xFFu);
    body[2] = (uint8_t)(frame->sequence >> 8);
    memcpy(body + HEADER_SIZE, frame->payload, frame->n);
    uint32_t crc = crc32_update(0, body, covered);
    body[covered] = (uint8_t)(crc & 0xFFu);
    body[covered + 1] = (uint8_t)(crc >> 8 & 0xFFu);
    body[covered + 2] = (uint8_t)(crc >> 16 & 0xFFu);
    body[covered + 3] = (uint8_t)(crc >> 24);
    size_t size = covered + CRC_SIZE;
    stuff(wire, size);
    wire[size + 1] = 0;
    return size + 2;
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

/* Judges the n stuffed bytes before a delimiter. Returns whether they are a good frame. */
/*@ requires 0 < n < FRAME_WIRE_MAX && \valid(decoder) && \valid(frame);
  @ requires \separated(decoder, frame);
  @ assigns decoder->buffer[0 .. FRAME_WIRE_MAX - 1], decoder->count, *frame;
  @ ensures \result ==> frame->n <= FRAME_PAYLOAD_MAX;
  @*/
static bool complete_frame(struct frame_decoder *decoder, size_t n, struct frame *frame)
{
    const uint8_t *body = decoder->buffer + 1;
    size_t size = n - 1;
    if (!unstuff(decoder->buffer, n) || size < HEADER_SIZE + CRC_SIZE) {
        decoder->count.malformed++;
        return false;
    }
    size_t covered = size - CRC_SIZE;
    uint32_t crc = body[covered] | (uint32_t)body[covered + 1] << 8 |
                   (uint32_t)body[covered + 2] << 16 | (uint32_t)body[covered + 3] << 24;
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

/* Ends the collected bytes at a delimiter. Returns whether they are a good frame. */
/*@ requires \valid(decoder) && \valid(frame) && \separated(decoder, frame);
  @ requires decoder->n < FRAME_WIRE_MAX;
  @ assigns *decoder, *frame;
  @ ensures decoder->n == 0;
  @ ensures \result ==> frame->n <= FRAME_PAYLOAD_MAX;
  @*/
static bool delimited(struct frame_decoder *decoder, struct frame *frame)
{
    size_t n = decoder->n;
    bool overlong = decoder->overlong;
    decoder->n = 0;
    decoder->overlong = false;
    if (overlong) {
        decoder->count.overlong++;
        return false;
    }
    if (n == 0) {
        return false; /* a sender may begin with a delimiter to flush noise from the line */
    }
    return complete_frame(decoder, n, frame);
}

size_t frame_decode_bytes(struct frame_decoder *decoder, const uint8_t *bytes, size_t n,
                          struct frame *frame, bool *delivered)
{
    uint8_t *to = decoder->buffer + decoder->n;
    size_t room = (size_t)(FRAME_WIRE_MAX - 1) - decoder->n;
    size_t fits = n < room ? n : room;
    size_t i = 0;
    *delivered = false;
    /*@ loop invariant i <= fits;
      @ loop assigns i, decoder->buffer[0 .. FRAME_WIRE_MAX - 1];
      @ loop variant fits - i;
      @*/
    while (i < fits && bytes[i] != 0) {
        to[i] = bytes[i];
        i++;
    }
    decoder->n = (uint16_t)(decoder->n + i);
    /*@ loop invariant i <= n;
      @ loop assigns i, decoder->overlong;
      @ loop variant n - i;
      @*/
    while (i < n && bytes[i] != 0) {
        decoder->overlong = true; /* skipped until the next delimiter */
        i++;
    }
    if (i == n) {
        return n;
    }
    *delivered = delimited(decoder, frame);
    return i + 1;
}

bool frame_decode(struct frame_decoder *decoder, uint8_t byte, struct frame *frame)
{
    bool delivered;
    (void)frame_decode_bytes(decoder, &byte, 1, frame, &delivered);
    return delivered;
}
