/* For tools/prove alone: copying and the checksum with typed pointers, which the prover's memory model wants. What is
 * required here of the caller is what the C library and base/crc32.h require. */
#ifndef REFLUX_TESTS_PROOFS_STUBS_H
#define REFLUX_TESTS_PROOFS_STUBS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/crc32.h"

/*@ requires \valid(to + (0 .. n - 1)) && \valid_read(from + (0 .. n - 1));
  @ requires \separated(to + (0 .. n - 1), from + (0 .. n - 1));
  @ assigns to[0 .. n - 1] \from from[0 .. n - 1];
  @*/
void copy_bytes(uint8_t *to, const uint8_t *from, size_t n);

/*@ requires \valid_read(data + (0 .. n - 1));
  @ assigns \result \from crc, data[0 .. n - 1], n;
  @*/
uint32_t crc32_of_bytes(uint32_t crc, const uint8_t *data, size_t n);

#define memcpy       copy_bytes
#define crc32_update crc32_of_bytes

#endif
