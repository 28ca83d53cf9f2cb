#include "base/crc32.h"

#include <string.h> /* memcpy */

#define ALWAYS_INLINE inline __attribute__((always_inline))

#define POLYNOMIAL 0xEDB88320u /* 0x04C11DB7 with its bits in the order in which they are sent */

/* Remainder of a byte after eight steps of the division: the sum, without carries, of the remainders of its bits. */
#define OF_BYTE(i)                                                                                 \
    (((i)&0x80u ? POLYNOMIAL : 0u) ^ ((i)&0x40u ? 0x76DC4190u : 0u) ^                              \
     ((i)&0x20u ? 0x3B6E20C8u : 0u) ^ ((i)&0x10u ? 0x1DB71064u : 0u) ^                             \
     ((i)&0x08u ? 0x0EDB8832u : 0u) ^ ((i)&0x04u ? 0x076DC419u : 0u) ^                             \
     ((i)&0x02u ? 0xEE0E612Cu : 0u) ^ ((i)&0x01u ? 0x77073096u : 0u))
#define FOUR(i, by)                                                                                \
    OF_BYTE(i), OF_BYTE((i) + (by)), OF_BYTE((i) + 2u * (by)), OF_BYTE((i) + 3u * (by))
#define SIXTEEN(i, by)                                                                             \
    FOUR(i, by), FOUR((i) + 4u * (by), by), FOUR((i) + 8u * (by), by), FOUR((i) + 12u * (by), by)

/* Divides by one byte: shifts the lowest byte out of crc, to which the caller has added the byte of the message. */
#if CRC32_TABLE == 256
static const uint32_t of_byte[256] = {
    SIXTEEN(0x00u, 1u), SIXTEEN(0x10u, 1u), SIXTEEN(0x20u, 1u), SIXTEEN(0x30u, 1u),
    SIXTEEN(0x40u, 1u), SIXTEEN(0x50u, 1u), SIXTEEN(0x60u, 1u), SIXTEEN(0x70u, 1u),
    SIXTEEN(0x80u, 1u), SIXTEEN(0x90u, 1u), SIXTEEN(0xA0u, 1u), SIXTEEN(0xB0u, 1u),
    SIXTEEN(0xC0u, 1u), SIXTEEN(0xD0u, 1u), SIXTEEN(0xE0u, 1u), SIXTEEN(0xF0u, 1u),
};

static ALWAYS_INLINE uint32_t divided(uint32_t crc)
{
    return (crc >> 8) ^ of_byte[crc & 0xFFu];
}
#elif CRC32_TABLE == 16
static const uint32_t of_half_byte[16] = {SIXTEEN(0u, 0x10u)};

static ALWAYS_INLINE uint32_t divided(uint32_t crc)
{
    crc = (crc >> 4) ^ of_half_byte[crc & 0xFu];
    return (crc >> 4) ^ of_half_byte[crc & 0xFu];
}
#elif CRC32_TABLE == 0
static ALWAYS_INLINE uint32_t divided(uint32_t crc)
{
    for (unsigned k = 0; k < 8; k++)
        crc = (crc >> 1) ^ (POLYNOMIAL & (0u - (crc & 1u)));
    return crc;
}
#else
#error CRC32_TABLE: 0, 16 or 256 entries
#endif

/* Reads four bytes in the order of a message: the first byte is the lowest. */
static ALWAYS_INLINE uint32_t four_bytes(const uint8_t *p)
{
    uint32_t x;
    if (__BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__)
        return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
    memcpy(&x, p, sizeof x); /* one load, at any address */
    return x;
}

/* The loop takes four bytes at a time. A step needs the lowest byte alone, so the bytes above it may be added early. */
uint32_t crc32_update(uint32_t crc, const void *data, size_t n)
{
    const uint8_t *p = data;
    crc = ~crc;
    for (; n >= 4; n -= 4, p += 4) {
        crc ^= four_bytes(p);
        crc = divided(crc);
        crc = divided(crc);
        crc = divided(crc);
        crc = divided(crc);
    }
    for (; n > 0; n--)
        crc = divided(crc ^ *p++);
    return ~crc;
}
