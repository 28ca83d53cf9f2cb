/* Flash interface of the STM32F100 (PM0063): lock, program by half-words, erase by pages, errors. Register map, reset values and masks: the
 * vendor's SVD file. Writing needs the internal oscillator, which is the clock of the interface (RM0041 Rev 6 6.2). The flash takes half-words
 * only (unverified). A half-word that is not erased takes only 0, else PGERR comes and it stays as it was (unverified). A wrong
 * key locks until a reset (unverified). EOP comes at the end of every operation (unverified). While the flash is busy no code is
 * fetched, and nothing of its interface may be written (unverified). Reading by half cycles is for 8 MHz at most (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "stored_flash.h"

enum {
    ACR = 0x00,
    KEYR = 0x04,
    OPTKEYR = 0x08,
    SR = 0x0C,
    CR = 0x10,
    AR = 0x14,
    OBR = 0x1C,
    WRPR = 0x20
};

#define KEY1       0x45670123u
#define KEY2       0xCDEF89ABu
#define SR_BSY     (UINT32_C(1) << 0)
#define SR_PGERR   (UINT32_C(1) << 2)
#define SR_EOP     (UINT32_C(1) << 5)
#define SR_CLEARED 0x34u /* by ones */
#define CR_PG      (UINT32_C(1) << 0)
#define CR_PER     (UINT32_C(1) << 1)
#define CR_STRT    (UINT32_C(1) << 6)
#define CR_LOCK    (UINT32_C(1) << 7)
#define CR_OTHER   0x1634u /* mass erase, option bytes, interrupts */
#define RCC_HSION  1u

/* A half-word takes 40 to 70 us, 52.5 us typical, a page 20 to 40 ms, the supply must be 2.0 V at least, of DS5944 (unverified). */
#define HALF_NS    52500u
#define PAGE_NS    UINT64_C(40000000)
#define PAGE_BYTES 0x400u
#define NEEDED_MV  2000u

static const struct reg regs[] = {
    {"ACR", ACR, 0, 0x8u, 0x8u},
    {"KEYR", KEYR, 0, UINT32_MAX, 0},
    {"OPTKEYR", OPTKEYR, 0, UINT32_MAX, 0},
    {"SR", SR, 0, 0x35u, 0},
    {"CR", CR, CR_LOCK, 0x16F7u, 0x16F7u},
    {"AR", AR, 0, UINT32_MAX, UINT32_MAX},
    {"OBR", OBR, 0x03FFFFFCu, UINT32_MAX, 0},
    {"WRPR", WRPR, UINT32_MAX, UINT32_MAX, 0},
};

struct flash {
    struct flash_operation operation;
    unsigned keys; /* given so far; 3: a wrong one, locked until reset */
};

static void done(void *context)
{
    struct part *p = context;
    struct flash *f = p->state;
    flash_operation_end(p->board, &f->operation);
    part_set(p, SR, (part_get(p, SR) & ~SR_BSY) | SR_EOP);
    part_set(p, CR, part_get(p, CR) & ~CR_STRT);
}

static void busy(struct part *p, uint64_t ns)
{
    struct flash *f = p->state;
    part_set(p, SR, part_get(p, SR) | SR_BSY);
    flash_operation_begin(p->board, &f->operation, ns);
}

static void start(struct part *p)
{
    struct flash *f = p->state;
    flash_operation_start(p, &f->operation, done);
}

static void reset(struct part *p, enum board_reset kind)
{
    struct flash *f = p->state;
    (void)kind;
    flash_operation_reset(p->board, &f->operation, PAGE_NS);
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    stored_flash_set_open(p->board, false);
    f->keys = 0;
}

/* What a write of the array needs: the supply and the chip's own oscillator. */
static void check_conditions(struct board *b)
{
    if (b->around.supply_mv < NEEDED_MV)
        board_verdict(b, "flash written at %u mV; 2000 are needed", b->around.supply_mv);
    if ((part_get(bus_part(b, "RCC"), 0) & RCC_HSION) == 0)
        board_verdict(b, "flash written while the internal oscillator is off");
}

void flash_f1_store(struct board *b, uint32_t at, unsigned bytes, uint32_t word)
{
    struct part *p = bus_part(b, "FLASH");
    struct flash *f = p->state;
    uint32_t cr = part_get(p, CR);
    if ((part_get(p, SR) & SR_BSY) != 0) {
        board_verdict(b, "store into the flash while it is busy");
    } else if ((cr & CR_LOCK) != 0 || (cr & CR_PG) == 0 || (cr & CR_PER) != 0) {
        board_verdict(
            b, "store into the flash with FLASH_CR at 0x%08x, which is not for programming", cr);
    } else if (bytes != 2u || (at & 1u) != 0) {
        board_verdict(b, "store of %u bytes into the flash, which takes half-words; the bus fails",
                      bytes);
    } else if (stored_flash_read(b, at, 2) != 0xFFFFu && (word & 0xFFFFu) != 0) {
        part_set(p, SR, part_get(p, SR) | SR_PGERR);
    } else {
        check_conditions(b);
        stored_flash_program(b, at, bytes, word);
        f->operation.at = at;
        f->operation.bytes = 2;
        busy(p, HALF_NS);
    }
}

static void start_erase(struct part *p, uint32_t written)
{
    struct board *b = p->board;
    struct flash *f = p->state;
    uint32_t at = part_get(p, AR) - b->chip->stored_base;
    if ((written & CR_PER) == 0 || (written & CR_PG) != 0) {
        board_verdict(b, "start of the flash with FLASH_CR at 0x%08x, which is no erase of a page",
                      written);
    } else if (at >= b->chip->stored_size) {
        board_verdict(b, "erase of the page at 0x%08x, which holds the program or is not there",
                      part_get(p, AR));
    } else {
        check_conditions(b);
        f->operation.erasing = true;
        f->operation.at = at & ~(PAGE_BYTES - 1u);
        f->operation.bytes = PAGE_BYTES;
        busy(p, PAGE_NS / 1000u * stored_flash_erase_share(b));
    }
}

static void write_cr(struct part *p, uint32_t before, uint32_t written)
{
    if ((before & CR_LOCK) == 0 && (written & CR_LOCK) != 0)
        stored_flash_set_open(p->board, false);
    if ((before & CR_LOCK) != 0)
        part_set(p, CR, before); /* only the keys open it */
    else if ((written & CR_OTHER) != 0)
        board_verdict(p->board,
                      "FLASH_CR of 0x%08x: mass erase, option bytes and interrupts are "
                      "not modelled",
                      written);
    else if ((written & CR_STRT) != 0)
        start_erase(p, written);
}

static void write_key(struct part *p, uint32_t written)
{
    struct flash *f = p->state;
    if (f->keys == 0 && written == KEY1) {
        f->keys = 1;
    } else if (f->keys == 1 && written == KEY2) {
        f->keys = 0;
        part_set(p, CR, part_get(p, CR) & ~CR_LOCK);
        stored_flash_set_open(p->board, true);
    } else {
        f->keys = 3;
        board_verdict(
            p->board,
            "wrong key 0x%08x for the flash; it stays locked until a reset and the bus fails",
            written);
    }
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    if ((part_get(p, SR) & SR_BSY) != 0 && offset != ACR) {
        board_verdict(p->board, "write of the flash interface while the flash is busy");
        return;
    }
    switch (offset) {
    case KEYR:
        write_key(p, written);
        break;
    case SR:
        part_set(p, SR, before & ~(written & SR_CLEARED));
        break;
    case CR:
        write_cr(p, before, written);
        break;
    case OPTKEYR:
        board_verdict(p->board, "write of the option bytes");
        break;
    case ACR:
        if (written != 0 && p->board->core_hz > 8400000u)
            board_verdict(p->board, "half-cycle access of the flash above 8 MHz");
        break;
    default:
        break;
    }
}

const struct part_class flash_f1_class = {.name = "flash interface of the STM32F1",
                                          .regs = regs,
                                          .n_regs = sizeof(regs) / sizeof(regs[0]),
                                          .state_bytes = sizeof(struct flash),
                                          .widths = WIDTH_HALF | WIDTH_WORD,
                                          .start = start,
                                          .reset = reset,
                                          .write = write};
