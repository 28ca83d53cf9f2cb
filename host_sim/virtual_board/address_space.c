/* The address space: memories of the chip, windows that go to models, and what the protection unit forbids. The library does not
 * enforce that unit: regions that nobody may reach are taken from the address space.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdlib.h>
#include <string.h>

#include "core.h"

/* In the chip's memories from this one on; the flash is the first. */
static uint8_t *memory_from(struct board *b, size_t first, uint32_t address, uint32_t bytes)
{
    for (size_t i = first; i < b->chip->n_memory; i++) {
        const struct chip_memory *m = &b->chip->memory[i];
        if (address >= m->base && bytes <= m->size && address - m->base <= m->size - bytes)
            return b->processor->memory[i] + (address - m->base);
    }
    return NULL;
}

uint8_t *processor_memory(struct board *b, uint32_t address, uint32_t bytes)
{
    return memory_from(b, 0, address, bytes);
}

uint8_t *address_data(struct board *b, uint32_t address, uint32_t bytes)
{
    return memory_from(b, 1, address, bytes);
}

void processor_scramble(struct board *b)
{
    for (size_t i = 0; i < b->chip->n_memory; i++)
        for (uint32_t k = 0; b->chip->memory[i].kind != MEMORY_FLASH && k < b->chip->memory[i].size;
             k += 4u) {
            uint32_t word = board_random(b);
            (void)memcpy(b->processor->memory[i] + k, &word, 4);
        }
}

static uint64_t on_read(uc_engine *uc, uint64_t offset, unsigned bytes, void *context)
{
    const struct window *w = context;
    (void)uc;
    barrier_rules_access(w->board, w->base + (uint32_t)offset, w->stored, false, 0);
    return w->stored ? stored_flash_read(w->board, (uint32_t)offset, bytes)
                     : bus_read(w->board, w->base + (uint32_t)offset, bytes);
}

static void on_write(uc_engine *uc, uint64_t offset, unsigned bytes, uint64_t value, void *context)
{
    const struct window *w = context;
    (void)uc;
    barrier_rules_access(w->board, w->base + (uint32_t)offset, w->stored, true, (uint32_t)value);
    if (w->stored)
        w->board->chip->store(w->board, (uint32_t)offset, bytes, (uint32_t)value);
    else
        bus_write(w->board, w->base + (uint32_t)offset, bytes, (uint32_t)value);
}

bool address_map_memory(struct board *b, struct processor *p)
{
    for (size_t i = 0; i < b->chip->n_memory; i++) {
        const struct chip_memory *m = &b->chip->memory[i];
        p->memory[i] = aligned_alloc(0x1000, m->size);
        if (p->memory[i] == NULL)
            return false;
        uint32_t size = m->size;
        /* With BOOT0 low the flash lies at 0 once more (unverified). */
        if (m->kind == MEMORY_FLASH) {
            (void)memset(p->memory[i], 0xFF, size);
            size -=
                b->chip
                    ->stored_size; /* what the firmware writes lies at the end and goes through the flash's model */
            if (uc_mem_map_ptr(p->uc, 0, size, UC_PROT_READ | UC_PROT_EXEC, p->memory[i]) !=
                UC_ERR_OK)
                return false;
        }
        /* SRAM from which nothing has been fetched is mapped as data: the library need not look for code at each store. */
        uint32_t rights = UC_PROT_READ | (m->kind == MEMORY_FLASH ? UC_PROT_EXEC : UC_PROT_WRITE);
        if (uc_mem_map_ptr(p->uc, m->base, size, rights, p->memory[i]) != UC_ERR_OK)
            return false;
    }
    return true;
}

bool address_map_windows(struct board *b, struct processor *p)
{
    p->windows[0] = (struct window){b, 0x40000000u, 0x00080000u, false};
    p->windows[1] = (struct window){b, 0x50000000u, 0x00061000u, false};
    p->windows[2] = (struct window){b, 0xE0000000u, 0x00100000u, false};
    p->windows[3] = (struct window){b, b->chip->stored_base, b->chip->stored_size, true};
    for (size_t i = 0; i < WINDOWS; i++) {
        struct window *w = &p->windows[i];
        if (uc_mmio_map(p->uc, w->base, w->size, on_read, w, on_write, w) != UC_ERR_OK)
            return false;
    }
    return true;
}

void address_map_stored(struct processor *p)
{
    struct board *b = p->board;
    struct window *w = &p->windows[WINDOWS - 1];
    uint8_t *plain = p->exact ? NULL : stored_flash_plain(b); /* barrier_rules.h wants to see it */
    p->stored_changed = false;
    if ((plain != NULL) == p->stored_plain)
        return;
    p->stored_plain = plain != NULL;
    uc_err e = uc_mem_unmap(p->uc, w->base, w->size);
    if (e == UC_ERR_OK && plain != NULL)
        e = uc_mem_map_ptr(p->uc, w->base, w->size, UC_PROT_READ, plain);
    else if (e == UC_ERR_OK)
        e = uc_mmio_map(p->uc, w->base, w->size, on_read, w, on_write, w);
    if (e != UC_ERR_OK)
        board_verdict(b, "the processor library did not map the stored flash: %s", uc_strerror(e));
}

void processor_stored_changed(struct board *b)
{
    b->processor->stored_changed = true;
    processor_break(b);
}

bool address_forbidden(const struct processor *p, uint32_t address)
{
    for (size_t i = 0; i < p->n_forbidden; i++)
        if (address - p->forbidden[i].base < p->forbidden[i].size)
            return true;
    return false;
}

/* The protection unit has been set: what is forbidden leaves the address space. Only whole regions of memory, and the alias. */
void address_protect(struct processor *p)
{
    struct board *b = p->board;
    p->protection_changed = false;
    const struct chip_memory *flash = flash_of(b->chip);
    uint32_t mapped =
        flash->size - b->chip->stored_size; /* the library refuses a range of which some is not */
    bool ok = uc_mem_protect(p->uc, 0, mapped, UC_PROT_READ | UC_PROT_EXEC) == UC_ERR_OK;
    p->n_forbidden = interrupts_forbidden(p->interrupts, p->forbidden,
                                          sizeof(p->forbidden) / sizeof(p->forbidden[0]));
    for (size_t i = 0; i < p->n_forbidden; i++) {
        const struct forbidden *f = &p->forbidden[i];
        if (f->base != 0 || f->size < flash->size)
            board_verdict(b, "a protected region of %u bytes at 0x%08x is not modelled", f->size,
                          f->base);
        else
            ok = uc_mem_protect(p->uc, 0, mapped, UC_PROT_NONE) == UC_ERR_OK && ok;
    }
    if (!ok)
        board_verdict(b, "the processor library did not protect the first %u bytes", mapped);
}

bool address_code_in_ram(struct processor *p, uint32_t address)
{
    uint32_t page = address & ~0xFFFu;
    for (size_t i = 0; i < p->board->chip->n_memory; i++) {
        const struct chip_memory *m = &p->board->chip->memory[i];
        /* The chip fetches from the SRAM as well, and not from the memory next to the core (RM0090 Rev 21 2.1.2, 2.1.3, 2.3.1). */
        if (m->kind == MEMORY_RAM && address - m->base < m->size)
            return uc_mem_protect(p->uc, page, 0x1000, UC_PROT_ALL) == UC_ERR_OK;
    }
    return false;
}

void processor_protection_changed(struct board *b)
{
    b->processor->protection_changed = true;
    processor_break(b);
}
