/* Chips on the 1-wire buses of the plant.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <string.h>

#include "board_io.h"

enum { COMMAND, SEARCH_FIRST, SEARCH_SECOND, SEARCH_CHOICE, MATCH, LENGTH, HEARS, ANSWERS, AWAY };

#define SEARCH 0xF0u
#define SELECT 0x55u
#define SKIP   0xCCu

enum wire_answer plant_wire_reset(void *context, uint64_t now_ns, unsigned bus)
{
    (void)context;
    struct plant_wire *w = &plant.wires[bus - 1u];
    w->reset_ns = w->last_ns = now_ns;
    for (unsigned i = 0; i < w->n; i++) {
        struct plant_on_wire *c = &w->chips[i];
        c->stage = COMMAND;
        c->bits = c->byte = 0;
    }
    return w->shorted ? WIRE_SHORTED : w->n > 0 && !plant_disturbs() ? WIRE_PULLED : WIRE_SILENT;
}

static bool rom_bit(const struct plant_on_wire *c)
{
    return (c->rom[c->bits / 8u] >> c->bits % 8u & 1u) != 0;
}

/* Whether the chip pulls in this slot, in which it may. */
static bool pulls(struct plant_on_wire *c)
{
    if (c->stage == SEARCH_FIRST || c->stage == SEARCH_SECOND)
        return rom_bit(c) == (c->stage == SEARCH_SECOND);
    if (c->stage != ANSWERS)
        return false;
    if (c->bits == 0)
        c->byte = plant_answer(c->sum, c->answered);
    return ((unsigned)c->byte >> c->bits & 1u) == 0;
}

/* A whole byte has come in. */
static void hears_byte(struct plant_on_wire *c)
{
    uint8_t byte = c->byte;
    c->byte = 0;
    c->bits = 0;
    if (c->stage == COMMAND) {
        c->stage = byte == SEARCH   ? SEARCH_FIRST
                   : byte == SELECT ? MATCH
                   : byte == SKIP   ? LENGTH
                                    : AWAY;
        return;
    }
    if (c->stage == LENGTH) {
        c->wanted = byte;
        c->heard = c->answered = 0;
        c->sum = 0;
    } else {
        c->bytes[c->heard++] = byte;
        c->sum += byte;
    }
    c->stage = c->heard < c->wanted ? HEARS : ANSWERS;
}

static void after_slot(struct plant_on_wire *c, bool bit)
{
    switch (c->stage) {
    case SEARCH_FIRST:
        c->stage = SEARCH_SECOND;
        break;
    case SEARCH_SECOND:
        c->stage = SEARCH_CHOICE;
        break;
    case SEARCH_CHOICE:
        c->stage = rom_bit(c) != bit || c->bits == 63u ? AWAY : SEARCH_FIRST;
        c->bits++;
        break;
    case MATCH:
        if (rom_bit(c) != bit) {
            c->stage = AWAY;
        } else if (++c->bits == 64u) {
            c->stage = LENGTH;
            c->bits = 0;
        }
        break;
    case ANSWERS:
        if (++c->bits == 8u) {
            c->bits = 0;
            c->answered++;
        }
        break;
    case AWAY:
        break;
    default:
        c->byte |= (uint8_t)((bit ? 1u : 0) << c->bits);
        if (++c->bits == 8u)
            hears_byte(c);
        break;
    }
}

enum wire_answer plant_wire_bit(void *context, uint64_t now_ns, unsigned bus, bool out)
{
    (void)context;
    struct plant_wire *w = &plant.wires[bus - 1u];
    bool pulled = w->pulled;
    if (w->slot_ns == 0 || now_ns - w->last_ns < w->slot_ns)
        w->slot_ns = now_ns - w->last_ns;
    w->last_ns = now_ns;
    if (w->shorted)
        return WIRE_SHORTED;
    for (unsigned i = 0; i < w->n; i++)
        pulled = pulls(&w->chips[i]) || pulled;
    if (out && plant_disturbs())
        pulled = !pulled;
    for (unsigned i = 0; i < w->n; i++)
        after_slot(&w->chips[i], out && !pulled);
    return pulled ? WIRE_PULLED : WIRE_SILENT;
}
