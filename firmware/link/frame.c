#include "link/frame.h"

#include <string.h> /* memcpy */

#include "base/crc32.h"

#define HEADER_SIZE 3 /* type, sequence */
#define CRC_SIZE    4

/* Bytes being stuffed as they come. Bodies are shorter than 254 bytes, so no group can reach the full length of
 * 0xFF and the overhead is always one byte. */
struct stuffing {
    uint8_t *wire;
    size_t code_at; /* where the length of the group under way will be written */
    size_t out;
};

/*@ requires \valid(s) && \valid(s->wire + (0 .. FRAME_BODY_MAX)) && \valid_read(bytes + (0 .. n - 1));
  @ requires \separated(s, s->wire + (0 .. FRAME_BODY_MAX));
  @ requires \separated(s, bytes + (0 .. n - 1));
  @ requires \separated(s->wire + (0 .. FRAME_BODY_MAX), bytes + (0 .. n - 1));
  @ requires s->code_at < s->out && s->out + n <= FRAME_BODY_MAX + 1;
  @ assigns s->code_at, s->out, s->wire[0 .. FRAME_BODY_MAX];
  @ ensures s->out == \old(s->out) + n && s->code_at < s->out;
  @*/
static void stuff(struct stuffing *s, const uint8_t *bytes, size_t n)
{
    /*@ loop invariant i <= n && s->out == \at(s->out, Pre) + i && s->code_at < s->out;
      @ loop assigns i, s->code_at, s->out, s->wire[0 .. FRAME_BODY_MAX];
      @ loop variant n - i;
      @*/
    for (size_t i = 0; i < n; i++) {
        if (bytes[i] == 0) {
            s->wire[s->code_at] = (uint8_t)(s->out - s->code_at);
            s->code_at = s->out;
        } else {
            s->wire[s->out] = bytes[i];
        }
        s->out++;
    }
}

/* Undoes stuff() in place (the result is never ahead of what is read). Returns the bytes of the body, or 0
 * when the group lengths do not add up to n. */
/*@ requires n < FRAME_WIRE_MAX && \valid(buffer + (0 .. n - 1));
  @ assigns buffer[0 .. n - 1];
  @ ensures n > 0 ==> \result < n;
  @ ensures n == 0 ==> \result == 0;
  @*/
static size_t unstuff(uint8_t *buffer, size_t n)
{
    size_t in = 0;
    size_t out = 0;
    /*@ loop invariant in <= n && out <= in && (0 < in == n ==> out < n);
      @ loop assigns in, out, buffer[0 .. n - 1];
      @ loop variant n - in;
      @*/
    while (in < n) {
        size_t group = buffer[in];
        if (group == 0 || group > n - in) {
            return 0;
        }
        in++;
        /*@ loop invariant 1 <= i <= group && out < in && in == \at(in, LoopEntry) + (i - 1);
          @ loop assigns i, in, out, buffer[0 .. n - 1];
          @ loop variant group - i;
          @*/
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
    const uint8_t header[HEADER_SIZE] = {frame->type, (uint8_t)(frame->sequence & 0xFFu),
                                         (uint8_t)(frame->sequence >> 8)};
    uint8_t tail[CRC_SIZE];
    uint32_t crc = crc32_update(crc32_update(0, header, HEADER_SIZE), frame->payload, frame->n);
    /*@ loop invariant i <= CRC_SIZE;
      @ loop assigns i, tail[0 .. CRC_SIZE - 1];
      @ loop variant CRC_SIZE - i;
      @*/
    for (unsigned i = 0; i < CRC_SIZE; i++) {
        tail[i] = (uint8_t)(crc >> (8u * i));
    }
    struct stuffing s = {.wire = wire, .code_at = 0, .out = 1};
    stuff(&s, header, HEADER_SIZE);
    stuff(&s, frame->payload, frame->n);
    stuff(&s, tail, CRC_SIZE);
    wire[s.code_at] = (uint8_t)(s.out - s.code_at);
    wire[s.out] = 0;
    return s.out + 1;
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
/*@ requires 0 < n < FRAME_WIRE_MAX && \valid(decoder) && \valid(frame);
  @ requires \separated(decoder, frame);
  @ assigns decoder->buffer[0 .. FRAME_WIRE_MAX - 1], decoder->count, *frame;
  @ ensures \result ==> frame->n <= FRAME_PAYLOAD_MAX;
  @*/
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
    /*@ loop invariant i <= CRC_SIZE;
      @ loop assigns i, crc;
      @ loop variant CRC_SIZE - i;
      @*/
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
