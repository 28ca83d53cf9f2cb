/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "replay.h"

#include <stdlib.h>
#include <string.h>

#include "chip.h"
#include "faults.h"
#include "models/models.h"

struct input {
    uint64_t cycles;
    enum replay_input what;
    size_t at, n;
};

struct replay {
    struct surroundings around;
    uint8_t *image, *stored;
    uint32_t image_bytes;
    uint64_t cut_word;
    struct input *list;
    uint8_t *bytes;
    size_t n, room, n_bytes, bytes_room;
};

void replay_begin(struct board *b)
{
    struct replay *r = calloc(1, sizeof(*r));
    uint32_t stored = b->chip->stored_size;
    if (r == NULL)
        abort();
    r->around = b->around;
    r->image_bytes = processor_image_bytes(b);
    r->image = malloc(r->image_bytes);
    r->stored = malloc(stored);
    if (r->image == NULL || r->stored == NULL)
        abort();
    (void)memcpy(r->image, processor_memory(b, b->chip->memory[0].base, r->image_bytes),
                 r->image_bytes);
    (void)memcpy(r->stored, stored_flash(b)->bytes, stored);
    r->cut_word = stored_flash(b)->cut_word;
    b->replay = r;
}

void replay_free(struct board *b)
{
    struct replay *r = b->replay;
    if (r == NULL)
        return;
    free(r->image);
    free(r->stored);
    free(r->list);
    free(r->bytes);
    free(r);
}

void replay_note(struct board *b, enum replay_input what, const void *bytes, size_t n)
{
    struct replay *r = b->replay;
    if (r == NULL || n == 0)
        return;
    if (r->n == r->room) {
        r->room = 2u * r->room + 256u;
        r->list = realloc(r->list, r->room * sizeof(*r->list));
    }
    if (r->n_bytes + n > r->bytes_room) {
        r->bytes_room = 2u * r->bytes_room + n + 4096u;
        r->bytes = realloc(r->bytes, r->bytes_room);
    }
    if (r->list == NULL || r->bytes == NULL)
        abort();
    r->list[r->n++] = (struct input){.cycles = b->cycles, .what = what, .at = r->n_bytes, .n = n};
    (void)memcpy(r->bytes + r->n_bytes, bytes, n);
    r->n_bytes += n;
}

static void run_to(struct board *second, uint64_t cycles)
{
    while (second->verdict[0] == '\0' && !second->found && second->cycles < cycles) {
        board_run_to_cycle(second, cycles);
        if (!faults_take_flash_cut(second) && second->paused && !second->found)
            return;
    }
}

static void give(struct board *second, const struct input *i, const uint8_t *bytes)
{
    char err[BOARD_VERDICT];
    if (i->what == REPLAY_FAULT)
        (void)faults_add_text(second, (const char *)bytes, i->n, err, sizeof(err));
    else
        (void)line_give(second, i->what == REPLAY_LINK ? 1u : 0u, bytes, i->n);
}

bool replay_find_pc(struct board *b, uint64_t block_began, uint32_t *pc)
{
    const struct replay *r = b->replay;
    char err[BOARD_VERDICT];
    if (r == NULL ||
        b->has_world) /* what a world does is not kept: a second board would go another way */
        return false;
    struct board *second =
        board_new(b->chip, &r->around, r->image, r->image_bytes, false, err, sizeof(err));
    if (second == NULL)
        return false;
    (void)memcpy(stored_flash(second)->bytes, r->stored, b->chip->stored_size);
    stored_flash(second)->cut_word = r->cut_word;
    processor_exact_from(second, block_began);
    board_power_on(second);
    for (size_t i = 0; i < r->n && !second->found; i++) {
        run_to(second, r->list[i].cycles);
        give(second, &r->list[i], r->bytes + r->list[i].at);
    }
    run_to(second, b->cycles + 1u);
    bool found = second->found && second->cycles == b->cycles;
    *pc = second->found_pc;
    board_free(second);
    return found;
}
