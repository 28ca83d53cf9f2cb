/* Byte ring for one writer and one reader in different contexts, shared by the ports.
 *
 * head and tail count bytes for ever and wrap at 2^32; the size is a power of two. Each is written by one side
 * only, so neither side needs a lock.
 */
#ifndef REFLUX_HAL_RING_H
#define REFLUX_HAL_RING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h> /* memcpy */

struct ring {
    uint8_t *bytes;
    uint32_t size; /* power of two */
    uint32_t head; /* bytes ever put in: the writer's */
    uint32_t tail; /* bytes ever taken out: the reader's */
};

#define RING_OVER(array)                                                                           \
    {                                                                                              \
        .bytes = (array), .size = sizeof(array)                                                    \
    }

static inline uint32_t ring_used(const struct ring *r)
{
    return __atomic_load_n(&r->head, __ATOMIC_ACQUIRE) -
           __atomic_load_n(&r->tail, __ATOMIC_ACQUIRE);
}

static inline uint32_t ring_room(const struct ring *r)
{
    return r->size - ring_used(r);
}

static inline bool ring_put(struct ring *r, uint8_t byte)
{
    uint32_t head = r->head;
    if (ring_room(r) == 0) {
        return false;
    }
    r->bytes[head & (r->size - 1u)] = byte;
    __atomic_store_n(&r->head, head + 1u, __ATOMIC_RELEASE);
    return true;
}

static inline bool ring_get(struct ring *r, uint8_t *byte)
{
    uint32_t tail = r->tail;
    if (ring_used(r) == 0) {
        return false;
    }
    *byte = r->bytes[tail & (r->size - 1u)];
    __atomic_store_n(&r->tail, tail + 1u, __ATOMIC_RELEASE);
    return true;
}

/* All n bytes or none. */
static inline bool ring_write(struct ring *r, const void *data, size_t n)
{
    uint32_t head = r->head, at = head & (r->size - 1u);
    size_t first = r->size - at; /* up to the end of the ring; the rest goes to its beginning */
    if (n > ring_room(r)) {
        return false;
    }
    if (first > n) {
        first = n;
    }
    memcpy(r->bytes + at, data, first);
    if (n > first) {
        memcpy(r->bytes, (const uint8_t *)data + first, n - first);
    }
    __atomic_store_n(&r->head, head + (uint32_t)n, __ATOMIC_RELEASE);
    return true;
}

/* Takes up to n bytes; returns how many. */
static inline size_t ring_read(struct ring *r, void *data, size_t n)
{
    uint32_t tail = r->tail, at = tail & (r->size - 1u), used = ring_used(r);
    size_t first = r->size - at;
    if (n > used) {
        n = used;
    }
    if (first > n) {
        first = n;
    }
    memcpy(data, r->bytes + at, first);
    if (n > first) {
        memcpy((uint8_t *)data + first, r->bytes, n - first);
    }
    __atomic_store_n(&r->tail, tail + (uint32_t)n, __ATOMIC_RELEASE);
    return n;
}

/* The longest run of queued bytes that lies in one piece; drop it with ring_skip. The reader's side. */
static inline size_t ring_peek(const struct ring *r, const uint8_t **data)
{
    uint32_t at = r->tail & (r->size - 1u), used = ring_used(r);
    *data = r->bytes + at;
    return used < r->size - at ? used : r->size - at;
}

static inline void ring_skip(struct ring *r, size_t n)
{
    __atomic_store_n(&r->tail, r->tail + (uint32_t)n, __ATOMIC_RELEASE);
}

/* Only while neither side is in use. */
static inline void ring_clear(struct ring *r)
{
    r->head = r->tail = 0;
}

#endif
