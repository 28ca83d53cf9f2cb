/* CRC-32 (ISO-HDLC: reflected 0x04C11DB7, initial and final XOR 0xFFFFFFFF), the one of Ethernet and zlib.
 * Check value: the nine ASCII bytes "123456789" give 0xCBF43926. */
#ifndef REFLUX_BASE_CRC32_H
#define REFLUX_BASE_CRC32_H

#include <stddef.h>
#include <stdint.h>

/* Entries of the look-up table, 4 bytes of flash each: 256, 16 (half bytes) or none. All sizes give the same checksums. tools/bench
 * measures the cost of each size in a tick (tests/bench/results.md). A board sets its own size in its limits. */
#ifndef CRC32_TABLE
#define CRC32_TABLE 256
#endif

/* Returns the CRC of n bytes. Start with crc = 0. To continue over a second part, pass the previous result. */
uint32_t crc32_update(uint32_t crc, const void *data, size_t n);

#endif
