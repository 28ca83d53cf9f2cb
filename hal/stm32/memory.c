/* memset and memcpy by words. The C library's go byte by byte, which is smaller; but ticks clear and copy tens of
 * kilobytes (automatic start-up, plans), and that was more than half of the longest one. Single words may lie at any
 * address on these processors, so nothing is aligned first. */
#include <stdint.h>
#include <string.h>

#define WORD 4u
#define LINE 16u

/* A word anywhere, of anything. Pairs and multiples of words would have to be aligned: the compiler may not make them. */
struct __attribute__((packed, may_alias)) word {
    uint32_t bits;
};

void *memset(void *to, int value, size_t n)
{
    uint8_t *at = to;
    uint32_t bits = (uint8_t)value * 0x01010101u;
    for (; n >= LINE; n -= LINE, at += LINE) {
        struct word *line = (struct word *)at;
        line[0].bits = bits;
        line[1].bits = bits;
        line[2].bits = bits;
        line[3].bits = bits;
    }
    for (; n >= WORD; n -= WORD, at += WORD)
        ((struct word *)at)->bits = bits;
    for (; n > 0; n--)
        *at++ = (uint8_t)value;
    return to;
}

void *memcpy(void *restrict to, const void *restrict from, size_t n)
{
    uint8_t *at = to;
    const uint8_t *source = from;
    for (; n >= LINE; n -= LINE, at += LINE, source += LINE) {
        struct word *line = (struct word *)at;
        const struct word *read = (const struct word *)source;
        line[0].bits = read[0].bits;
        line[1].bits = read[1].bits;
        line[2].bits = read[2].bits;
        line[3].bits = read[3].bits;
    }
    for (; n >= WORD; n -= WORD, at += WORD, source += WORD)
        ((struct word *)at)->bits = ((const struct word *)source)->bits;
    for (; n > 0; n--)
        *at++ = *source++;
    return to;
}
