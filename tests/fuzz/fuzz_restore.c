/* A start from any flash image: the board comes up, says something to every command, and its settings are sound.
 *
 * Input: a first byte. Odd: what follows is the flash, at the begin of each slot in turn. Even: it is the records of
 * a set (and of a second one), which is wrapped as tests/reference/storage-format.md says, so that its checksums hold, and then
 * perhaps damaged.
 */
#include <string.h>

#include "base/crc32.h"
#include "fuzz.h"
#include "fuzz_board.h"
#include "memory_port.h"

#define GRAIN 16u

static void put32(uint8_t *at, uint32_t x)
{
    for (unsigned i = 0; i < 4; i++)
        at[i] = (uint8_t)(x >> (8u * i));
}

static void checked_grain(uint8_t *at, const char *magic, uint32_t a, uint32_t b)
{
    memcpy(at, magic, 4);
    put32(at + 4, a);
    put32(at + 8, b);
    put32(at + 12, crc32_update(0, at, 12));
}

/* One set of n bytes of records at `at`; returns what it takes. */
static size_t put_set(uint8_t *at, uint32_t sequence, const uint8_t *records, size_t n)
{
    size_t body = (n + GRAIN - 1u) / GRAIN * GRAIN;
    checked_grain(at, "RXSH", sequence, (uint32_t)n | 1u << 16);
    memset(at + GRAIN, 0, body);
    if (n)
        memcpy(at + GRAIN, records, n);
    uint8_t *tail = at + GRAIN + body;
    memcpy(tail, "RXST", 4);
    put32(tail + 4, (uint32_t)n);
    put32(tail + 8, sequence);
    put32(tail + 12, crc32_update(0, at, (size_t)(tail - at) + 12u));
    return body + 2u * GRAIN;
}

static void wrapped(struct feed *f, uint8_t first)
{
    uint8_t *slot = memory_port_flash() + (first & 2u ? memory_port_flash_size() / 2u : 0);
    size_t at = GRAIN, n = feed_byte(f);
    uint8_t flips = (uint8_t)((first >> 2) & 3u);
    checked_grain(slot, "RXSM", 1, 1);
    const uint8_t *records = feed_bytes(f, &n);
    at += put_set(slot + at, 1, records, n);
    if (first & 16u) {
        n = f->left > 1000 ? 1000 : f->left;
        if (flips)
            n = n > 2u * flips ? n - 2u * flips : 0;
        records = feed_bytes(f, &n);
        at += put_set(slot + at, 2, records, n);
    }
    for (; flips; flips--)
        slot[(feed_byte(f) * at) / 256u] ^= (uint8_t)(1u << (feed_byte(f) & 7u));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct feed f = {data, size};
    uint8_t first = feed_byte(&f);
    memory_port_erase_all();
    if (first & 1u) {
        size_t half = memory_port_flash_size() / 2u, n = f.left / 2u, rest = f.left - n;
        if (rest)
            memcpy(memory_port_flash(), f.data, rest);
        if (n)
            memcpy(memory_port_flash() + half, f.data + rest, n);
    } else {
        wrapped(&f, first);
    }
    fuzz_power_on();
    (void)fuzz_replies();
    fuzz_pass(2100); /* no plant comes */
    fuzz_pass(100);
    if (first & 32u) {
        static const char commands[] = "load\nsave\nload\n";
        fuzz_type(commands, sizeof commands - 1);
        DEMAND(fuzz_replies() == 3);
    }
    if (fuzz_is_chosen(data, size))
        fuzz_settings_are_sound();
    return 0;
}
