/* Declarations that every fuzz target shares. A target is one function that takes any bytes, judges what the firmware made
 * of them with DEMAND, and leaves nothing behind for the next input. Two programs are made of each: fuzz_NAME
 * (libFuzzer; tools/fuzz) and replay_NAME (replay.c: any compiler; tools/test fuzz).
 */
#ifndef REFLUX_TESTS_FUZZ_H
#define REFLUX_TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define DEMAND(condition)                                                                          \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            (void)fprintf(stderr, "%s:%d: demanded, but not so: %s\n", __FILE__, __LINE__,         \
                          #condition);                                                             \
            abort();                                                                               \
        }                                                                                          \
    } while (0)

/* The input, taken from the front; zeros once it is used up. */
struct feed {
    const uint8_t *data;
    size_t left;
};

static inline uint8_t feed_byte(struct feed *f)
{
    if (f->left == 0)
        return 0;
    f->left--;
    return *f->data++;
}

/* Up to n bytes in place; *n becomes how many there were. */
static inline const uint8_t *feed_bytes(struct feed *f, size_t *n)
{
    const uint8_t *at = f->data;
    if (*n > f->left)
        *n = f->left;
    f->data += *n;
    f->left -= *n;
    return at;
}

#endif
