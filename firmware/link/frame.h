/* Plant link, lower half: frames on a byte stream.
 *
 *     frame = COBS( type(1) sequence(2) payload(0..FRAME_PAYLOAD_MAX) crc32(4) ) 0x00
 *
 * Numbers are little-endian. The CRC-32 (base/crc32.h) covers type, sequence and payload. Consistent Overhead
 * Byte Stuffing (Cheshire and Baker 1999) removes every zero byte, so 0x00 can only be the end of a frame and
 * a receiver that joins in the middle is in step after one frame. docs/inside/plant-link.md specifies the format.
 */
#ifndef REFLUX_LINK_FRAME_H
#define REFLUX_LINK_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"

#ifndef FRAME_PAYLOAD_MAX
/* Bytes of the longest payload. A small board takes less. The decoder skips and counts longer frames. */
#define FRAME_PAYLOAD_MAX 240
#endif
#define FRAME_BODY_MAX (3 + FRAME_PAYLOAD_MAX + 4) /* 247: one COBS block */
#define FRAME_WIRE_MAX (FRAME_BODY_MAX + 2)        /* overhead byte and delimiter */

struct frame {
    uint8_t type;
    uint16_t sequence; /* counter of the sender, which rises by one per frame and wraps */
    uint8_t n;         /* bytes of payload */
    uint8_t payload[FRAME_PAYLOAD_MAX];
};

/* Writes the frame, stuffed and delimited, to wire (room: FRAME_WIRE_MAX). Returns the bytes written,
 * 0 when n > FRAME_PAYLOAD_MAX. */
/*@ requires \valid_read(frame) && \valid(wire + (0 .. FRAME_WIRE_MAX - 1));
  @ requires \separated(frame, wire + (0 .. FRAME_WIRE_MAX - 1));
  @ assigns wire[0 .. FRAME_WIRE_MAX - 1];
  @ ensures frame->n > FRAME_PAYLOAD_MAX ==> \result == 0;
  @ ensures frame->n <= FRAME_PAYLOAD_MAX ==> \result == frame->n + 9;
  @*/
size_t frame_encode(const struct frame *frame, uint8_t *wire);

struct frame_decoder {
    uint8_t buffer[FRAME_WIRE_MAX];
    uint16_t n;    /* bytes collected since the last delimiter */
    bool overlong; /* the frame under way is too long and is being skipped */
    struct {
        uint32_t good;      /* frames delivered */
        uint32_t bad_crc;   /* right shape, wrong checksum */
        uint32_t malformed; /* impossible stuffing, or shorter than a header */
        uint32_t overlong;  /* no delimiter within FRAME_WIRE_MAX bytes */
    } count;
};

/* Drops the frame under way and sets the counters to 0. */
/*@ requires \valid(decoder);
  @ assigns decoder->n, decoder->overlong, decoder->count;
  @ ensures decoder->n == 0;
  @*/
void frame_decoder_reset(struct frame_decoder *decoder);

/* Takes bytes up to the end of the first frame, good or not, or all n. Returns the number of bytes it took; the caller
 * calls again with the rest. *delivered: the last byte completed a good frame, which is in *frame. The decoder drops and
 * counts anything else, and is in step again after the next delimiter. */
/*@ requires \valid(decoder) && \valid(frame) && \valid(delivered) && \valid_read(bytes + (0 .. n - 1));
  @ requires \separated(decoder, frame, delivered, bytes + (0 .. n - 1));
  @ requires decoder->n < FRAME_WIRE_MAX;
  @ assigns *decoder, *frame, *delivered;
  @ ensures decoder->n < FRAME_WIRE_MAX;
  @ ensures \result <= n && (n > 0 ==> \result > 0);
  @ ensures *delivered ==> frame->n <= FRAME_PAYLOAD_MAX;
  @*/
size_t frame_decode_bytes(struct frame_decoder *decoder, const uint8_t *bytes, size_t n,
                          struct frame *frame, bool *delivered);

/* Takes one byte. Returns whether it completed a good frame, which is then in *frame. */
/*@ requires \valid(decoder) && \valid(frame) && \separated(decoder, frame);
  @ requires decoder->n < FRAME_WIRE_MAX;
  @ assigns *decoder, *frame;
  @ ensures decoder->n < FRAME_WIRE_MAX;
  @ ensures \result ==> frame->n <= FRAME_PAYLOAD_MAX;
  @*/
bool frame_decode(struct frame_decoder *decoder, uint8_t byte, struct frame *frame);

#endif
