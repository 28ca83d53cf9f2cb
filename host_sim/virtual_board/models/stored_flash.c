/* The part of the flash that the firmware writes: an array whose bits only fall until they are erased, and which keeps what it held
 * when the supply goes. A word or an erase that is cut leaves bits that read differently each time, until they are programmed or
 * erased again (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "stored_flash.h"

#include <stdlib.h>
#include <string.h>

#define ERASE_SPREAD 100u /* per mille of its time: a guess */

struct stored_flash *stored_flash(struct board *b)
{
    return bus_part(b, "STORED")->state;
}

static void start(struct part *p)
{
    struct stored_flash *f = p->state;
    uint32_t size = p->board->chip->stored_size;
    f->bytes = aligned_alloc(0x1000, size); /* the processor library maps it */
    f->unstable = calloc(1, size);
    if (f->bytes == NULL || f->unstable == NULL)
        abort();
    (void)memset(f->bytes, 0xFF, size);
}

static void stop(struct part *p)
{
    struct stored_flash *f = p->state;
    free(f->bytes);
    free(f->unstable);
}

static void reset(struct part *p, enum board_reset kind)
{
    (void)p;
    (void)kind; /* flash is kept */
}

void stored_flash_changed(struct board *b)
{
    processor_stored_changed(b);
}

void stored_flash_set_open(struct board *b, bool open)
{
    stored_flash(b)->open = open;
    stored_flash_changed(b);
}

uint8_t *stored_flash_plain(struct board *b)
{
    const struct stored_flash *f = stored_flash(b);
    bool plain = !f->open && !f->watched && !f->cache_old;
    for (uint32_t at = 0; plain && at < b->chip->stored_size; at += sizeof(uint64_t)) {
        uint64_t unstable;
        (void)memcpy(&unstable, f->unstable + at, sizeof(unstable));
        plain = unstable == 0;
    }
    return plain ? f->bytes : NULL;
}

uint32_t stored_flash_read(struct board *b, uint32_t at, unsigned bytes)
{
    struct stored_flash *f = stored_flash(b);
    uint32_t word = 0, unstable = 0;
    f->reads++;
    if (f->cache_on && f->cache_old)
        board_verdict(b, "read of the flash through a cache that holds what was there before");
    (void)memcpy(&word, f->bytes + at, bytes);
    (void)memcpy(&unstable, f->unstable + at, bytes);
    return unstable == 0 ? word : word ^ (board_random(b) & unstable);
}

/* Bits that an operation moves when the supply goes at this part of it: those that have moved, and of these the weak ones. Cells differ
 * in the time they take, by `spread` either way. */
static uint8_t moved(struct board *b, uint32_t per_mille, uint32_t spread, uint8_t *weak)
{
    uint8_t bits = 0;
    *weak = 0;
    for (unsigned bit = 0; bit < 8; bit++) {
        uint32_t place = board_random(b) % 1000u, mask = 1u << bit;
        if (place > per_mille + spread)
            continue;
        bits = (uint8_t)(bits | mask);
        if (place + spread > per_mille)
            *weak = (uint8_t)(*weak | mask);
    }
    return bits;
}

void stored_flash_program(struct board *b, uint32_t at, unsigned bytes, uint32_t word)
{
    struct stored_flash *f = stored_flash(b);
    f->words++;
    bool cut = f->words == f->cut_word;
    uint32_t per_mille = cut ? board_random(b) % 1001u : 1000u,
             spread = cut ? board_random(b) % 400u : 0;
    for (unsigned i = 0; i < bytes; i++) {
        uint8_t low = (uint8_t) ~(word >> 8 * i), weak = 0;
        uint8_t falls = (uint8_t)(f->bytes[at + i] & low);
        if (cut)
            falls &= moved(b, per_mille, spread, &weak);
        else
            f->unstable[at + i] = (uint8_t)(f->unstable[at + i] & ~low);
        f->bytes[at + i] = (uint8_t)(f->bytes[at + i] & ~falls);
        f->unstable[at + i] = (uint8_t)(f->unstable[at + i] | (falls & weak));
    }
    if (cut) {
        f->cut = true;
        board_pause(b);
    }
}

void stored_flash_erase(struct board *b, uint32_t at, uint32_t bytes)
{
    struct stored_flash *f = stored_flash(b);
    f->erase_count++;
    if (f->erase_count != f->cut_erase) {
        (void)memset(f->bytes + at, 0xFF, bytes);
        (void)memset(f->unstable + at, 0, bytes);
        return;
    }
    stored_flash_erase_partly(b, at, bytes, f->cut_per_mille);
    f->cut = true;
    board_pause(b);
}

void stored_flash_erase_partly(struct board *b, uint32_t at, uint32_t bytes, uint32_t per_mille)
{
    struct stored_flash *f = stored_flash(b);
    /* The charge leaves all cells together: early on few bits have turned, near the end few have not, and those between are weak. */
    for (uint32_t i = 0; i < bytes; i++) {
        uint8_t weak, rises = moved(b, per_mille, ERASE_SPREAD, &weak);
        rises = (uint8_t)(rises & ~f->bytes[at + i]);
        f->bytes[at + i] = (uint8_t)(f->bytes[at + i] | rises);
        f->unstable[at + i] = (uint8_t)(f->unstable[at + i] | (rises & weak));
    }
}

uint32_t stored_flash_erase_share(struct board *b)
{
    const struct stored_flash *f = stored_flash(b);
    return f->erase_count + 1u == f->cut_erase ? f->cut_per_mille : 1000u;
}

void stored_flash_weaken(struct board *b, uint32_t at, uint32_t bytes)
{
    struct stored_flash *f = stored_flash(b);
    for (uint32_t i = 0; i < bytes; i++)
        f->unstable[at + i] =
            (uint8_t)(f->unstable[at + i] | (~f->bytes[at + i] & board_random(b)));
}

void flash_operation_start(struct part *interface, struct flash_operation *o,
                           void (*done)(void *context))
{
    o->done = (struct board_event){.due = done, .context = interface};
    board_add_event(interface->board, &o->done);
}

void flash_operation_begin(struct board *b, struct flash_operation *o, uint64_t ns)
{
    o->began_ns = board_ns(b);
    b->stalled_until_ns = o->began_ns + ns;
    board_schedule(b, &o->done, b->stalled_until_ns);
}

void flash_operation_end(struct board *b, struct flash_operation *o)
{
    if (o->erasing)
        stored_flash_erase(b, o->at, o->bytes);
    o->erasing = false;
}

/* A reset leaves a word or an erase of the STM32F100 in any state (unverified). For the STM32F405: RM0090 Rev 21 3.6. */
void flash_operation_reset(struct board *b, struct flash_operation *o, uint64_t erase_ns)
{
    bool under_way = o->done.at_ns != BOARD_NEVER;
    uint64_t spent = board_ns(b) - o->began_ns;
    o->done.at_ns = BOARD_NEVER;
    if (under_way && !stored_flash(b)->cut) { /* else what the cut has left is there */
        if (o->erasing)
            stored_flash_erase_partly(b, o->at, o->bytes, (uint32_t)(1000u * spent / erase_ns));
        else
            stored_flash_weaken(b, o->at, o->bytes);
    }
    o->erasing = false;
}

const struct part_class stored_flash_class = {.name = "flash that is written",
                                              .state_bytes = sizeof(struct stored_flash),
                                              .start = start,
                                              .stop = stop,
                                              .reset = reset};
