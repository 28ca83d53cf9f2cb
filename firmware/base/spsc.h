/* Index arithmetic of a queue between two contexts: one writer, one reader, no lock.
 * The owner keeps an array of `size` slots (a power of two) beside it:
 *
 *     if (spsc_can_write(&q)) { slot[spsc_write_index(&q)] = x; spsc_write_done(&q); }
 *     if (spsc_can_read(&q))  { x = slot[spsc_read_index(&q)];  spsc_read_done(&q); }
 */
#ifndef REFLUX_BASE_SPSC_H
#define REFLUX_BASE_SPSC_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/assertion.h"

struct spsc {
    _Atomic uint32_t written, read; /* items since the start; a wrap does no harm */
    uint32_t size;
};

static inline void spsc_init(struct spsc *q, uint32_t size)
{
    REFLUX_ASSERT(size != 0 && (size & (size - 1u)) == 0);
    atomic_store(&q->written, 0);
    atomic_store(&q->read, 0);
    q->size = size;
}
static inline uint32_t spsc_count(const struct spsc *q)
{
    return atomic_load_explicit(&q->written, memory_order_acquire) -
           atomic_load_explicit(&q->read, memory_order_acquire);
}
static inline bool spsc_can_write(const struct spsc *q)
{
    return spsc_count(q) < q->size;
}
static inline bool spsc_can_read(const struct spsc *q)
{
    return spsc_count(q) != 0;
}
static inline uint32_t spsc_write_index(const struct spsc *q)
{
    return atomic_load_explicit(&q->written, memory_order_relaxed) & (q->size - 1u);
}
static inline uint32_t spsc_read_index(const struct spsc *q)
{
    return atomic_load_explicit(&q->read, memory_order_relaxed) & (q->size - 1u);
}
static inline void spsc_write_done(struct spsc *q)
{
    REFLUX_ASSERT(spsc_can_write(q));
    atomic_store_explicit(&q->written, atomic_load_explicit(&q->written, memory_order_relaxed) + 1u,
                          memory_order_release);
}
static inline void spsc_read_done(struct spsc *q)
{
    REFLUX_ASSERT(spsc_can_read(q));
    atomic_store_explicit(&q->read, atomic_load_explicit(&q->read, memory_order_relaxed) + 1u,
                          memory_order_release);
}

#endif
