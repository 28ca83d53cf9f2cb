/* Reads and writes of registers, with what the reference manual asks of each: a register there, its clock on, a width that
 * it takes, reserved bits as they were.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdlib.h>
#include <string.h>

#include "chip.h"

void bus_start(struct board *b)
{
    for (size_t i = 0; i < b->chip->n_parts; i++) {
        const struct chip_part *row = &b->chip->parts[i];
        struct part *p = calloc(1, sizeof(*p));
        p->board = b;
        p->row = row;
        p->words = calloc(row->class->n_regs + 1, sizeof(uint32_t));
        p->index = calloc(row->size / 4u, sizeof(*p->index));
        for (size_t at = 0; at < row->size / 4u; at++)
            p->index[at] = (uint8_t)row->class->n_regs;
        for (size_t k = 0; k < row->class->n_regs; k++)
            p->index[row->class->regs[k].offset / 4u] = (uint8_t)k;
        p->state = row->class->state_bytes ? calloc(1, row->class->state_bytes) : NULL;
        b->parts[b->n_parts++] = p;
    }
    for (size_t i = 0; i < b->n_parts; i++)
        if (b->parts[i]->row->class->start != NULL)
            b->parts[i]->row->class->start(b->parts[i]);
}

void bus_stop(struct board *b)
{
    for (size_t i = 0; i < b->n_parts; i++) {
        if (b->parts[i]->row->class->stop != NULL)
            b->parts[i]->row->class->stop(b->parts[i]);
        free(b->parts[i]->words);
        free(b->parts[i]->index);
        free(b->parts[i]->state);
        free(b->parts[i]);
    }
}

void bus_reset(struct board *b, enum board_reset kind)
{
    for (size_t i = 0; i < b->n_parts; i++) {
        struct part *p = b->parts[i];
        p->held_in_reset = false;
        if (p->row->class->reset != NULL) {
            p->row->class->reset(p, kind);
            continue;
        }
        for (size_t k = 0; k < p->row->class->n_regs; k++)
            p->words[k] = p->row->class->regs[k].reset;
    }
}

static struct part *part_named(struct board *b, const char *name)
{
    for (size_t i = 0; i < b->n_parts; i++)
        if (strcmp(b->parts[i]->row->name, name) == 0)
            return b->parts[i];
    return NULL;
}

/* Models ask for the same few names all the time, each with a string of its own. */
struct part *bus_part(struct board *b, const char *name)
{
    size_t i = 0;
    while (i < BOARD_NAMED && b->named[i].name != NULL && b->named[i].name != name)
        i++;
    if (i < BOARD_NAMED && b->named[i].name == name)
        return b->named[i].part;
    struct part *found = part_named(b, name);
    if (i < BOARD_NAMED && found != NULL)
        b->named[i] = (struct named){name, found};
    return found;
}

struct part *pins_part(struct board *b, char port)
{
    static const char *const names[] = {"GPIOA", "GPIOB", "GPIOC", "GPIOD"};
    return bus_part(b, names[port - 'A']);
}

uint32_t part_get(const struct part *p, uint32_t offset)
{
    return p->words[p->index[offset / 4u]];
}

void part_set(struct part *p, uint32_t offset, uint32_t word)
{
    p->words[p->index[offset / 4u]] = word;
}

static bool clocked(const struct part *p)
{
    const struct chip_part *row = p->row;
    if (row->enable_offset == 0)
        return true;
    const struct part *rcc = bus_part(p->board, "RCC");
    return (part_get(rcc, row->enable_offset) >> row->enable_bit & 1u) != 0;
}

static bool takes(const struct part_class *class, uint32_t offset, unsigned bytes)
{
    return class->only_words != NULL && class->only_words(offset) ? bytes == WIDTH_WORD
                                                                  : (class->widths & bytes) != 0;
}

/* The part and the index of its register; NULL with a verdict: the access is none that a chip takes. */
static struct part *find(struct board *b, uint32_t address, unsigned bytes, const char *what,
                         size_t *reg)
{
    for (size_t i = 0; i <= b->n_parts; i++) {
        struct part *p = i == 0 ? b->last : b->parts[i - 1];
        if (p == NULL || address < p->row->base || address - p->row->base >= p->row->size)
            continue;
        const struct chip_part *row = p->row;
        b->last = p;
        *reg = p->index[(address - row->base) / 4u];
        if (*reg == row->class->n_regs) {
            board_verdict(b, "%s of 0x%08x: %s has no register there, or it is not modelled", what,
                          address, row->name);
            return NULL;
        }
        if (!clocked(p)) {
            board_verdict(b, "%s of %s_%s (0x%08x) while its clock is off", what, row->name,
                          row->class->regs[*reg].name, address);
            return NULL;
        }
        if (p->held_in_reset) {
            board_verdict(b, "%s of %s_%s (0x%08x), which the RCC holds in reset", what, row->name,
                          row->class->regs[*reg].name, address);
            return NULL;
        }
        if (!takes(row->class, row->class->regs[*reg].offset, bytes)) {
            board_verdict(b, "%s of %u bytes of %s_%s (0x%08x), which takes no such width", what,
                          bytes, row->name, row->class->regs[*reg].name, address);
            return NULL;
        }
        return p;
    }
    board_verdict(b, "%s of 0x%08x, where no part is modelled", what, address);
    return NULL;
}

uint32_t bus_read(struct board *b, uint32_t address, unsigned bytes)
{
    size_t reg;
    struct part *p = find(b, address, bytes, "read", &reg);
    if (p == NULL)
        return 0;
    const struct part_class *class = p->row->class;
    uint32_t word = class->read != NULL ? class->read(p, class->regs[reg].offset, p->words[reg])
                                        : p->words[reg];
    return word >> 8 * (address & 3u);
}

void bus_write(struct board *b, uint32_t address, unsigned bytes, uint32_t value)
{
    size_t reg;
    struct part *p = find(b, address, bytes, "write", &reg);
    if (p == NULL)
        return;
    const struct part_class *class = p->row->class;
    const struct reg *r = &class->regs[reg];
    uint32_t before = p->words[reg], shift = 8 * (address & 3u);
    uint32_t there = bytes == 4 ? UINT32_MAX : ((UINT32_C(1) << 8 * bytes) - 1u) << shift;
    uint32_t word = (before & ~there) | (value << shift & there);
    uint32_t wrong = (word ^ r->reset) & ~r->defined & there;
    if (wrong != 0) {
        board_verdict(b, "write of 0x%08x to %s_%s (0x%08x): reserved bits 0x%08x", word,
                      p->row->name, r->name, address, wrong);
        return;
    }
    p->words[reg] = (before & ~r->writable) | (word & r->writable);
    if (class->write != NULL)
        class->write(p, r->offset, before, word);
}
