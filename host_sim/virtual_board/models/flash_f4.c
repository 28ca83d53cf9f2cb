/* Flash interface of the STM32F405, read in RM0090 Rev 21: 3.6 (lock, program, erase by sectors, errors; no read while it is busy), 3.7.1
 * (option bytes), 3.9 (registers).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "stored_flash.h"

enum { ACR = 0x00, KEYR = 0x04, OPTKEYR = 0x08, SR = 0x0C, CR = 0x10, OPTCR = 0x14 };

#define KEY1         0x45670123u
#define KEY2         0xCDEF89ABu
#define SR_EOP       (UINT32_C(1) << 0)
#define SR_WRP       (UINT32_C(1) << 4)
#define SR_PGA       (UINT32_C(1) << 5)
#define SR_PGP       (UINT32_C(1) << 6)
#define SR_PGS       (UINT32_C(1) << 7)
#define SR_BSY       (UINT32_C(1) << 16)
#define CR_PG        (UINT32_C(1) << 0)
#define CR_SER       (UINT32_C(1) << 1)
#define CR_MER       (UINT32_C(1) << 2)
#define CR_STRT      (UINT32_C(1) << 16)
#define CR_IRQS      (UINT32_C(3) << 24) /* EOPIE, ERRIE */
#define CR_LOCK      (UINT32_C(1) << 31)
#define ACR_DCEN     (UINT32_C(1) << 10)
#define ACR_DCRST    (UINT32_C(1) << 12)
#define ACR_RESETS   0x1800u
#define OPTCR_WDG_SW (UINT32_C(1) << 5)
#define OPTCR_NWRP   16u /* 0 in a sector's bit: write-protected */
#define ROW_BYTES    16u

/* A word takes 16 us, a sector of 128 KiB 1 s where it is erased by words, both typical of DS8626 (unverified). Others quote 2 s at most
 * from its table 40. */
#define WORD_NS             16000u
#define SECTOR_NS           UINT64_C(1000000000)
#define FIRST_STORED_SECTOR 10u
#define SECTOR_BYTES        0x20000u
#define NEEDED_MV           2700u /* for words (3.6.2) */

static const struct reg regs[] = {
    {"ACR", ACR, 0, 0x00001F07u, 0x00001F07u},
    {"KEYR", KEYR, 0, UINT32_MAX, 0},
    {"OPTKEYR", OPTKEYR, 0, UINT32_MAX, 0},
    {"SR", SR, 0, 0x000100F3u, 0},
    {"CR", CR, 0x80000000u, 0x8301037Fu, 0x8301037Fu},
    {"OPTCR", OPTCR, 0x0FFFAAEDu, 0x0FFFFFEFu, 0x0FFFFFEFu},
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
    /* The cache of data does not notice a program or an erase, RM0090 3.5.2 (unverified). */
    stored_flash(p->board)->cache_old = true;
    part_set(p, SR, part_get(p, SR) & ~SR_BSY);
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

/* 3.7.1: level 3 is 0. Which voltage falls into which level is of DS8626 5.3.5: 2.75 to 2.88 V, 2.44 to 2.56 V, 2.13 to 2.24 V, falling. */
static uint32_t option_brown_out(const struct board *b)
{
    uint32_t mv = b->around.brown_out_mv;
    return mv == 0 ? 3u : mv >= 2700u ? 0u : mv >= 2400u ? 1u : 2u;
}

static uint32_t options(const struct board *b, uint32_t optcr)
{
    optcr = (optcr & ~0xCu) | option_brown_out(b) << 2;
    if (b->around.hardware_watchdog)
        optcr &= ~OPTCR_WDG_SW;
    return optcr & ~((uint32_t)b->around.write_protect << OPTCR_NWRP);
}

static bool write_protected(const struct board *b, uint32_t sector)
{
    return (b->around.write_protect >> sector & 1u) != 0;
}

static void reset(struct part *p, enum board_reset kind)
{
    struct flash *f = p->state;
    (void)kind;
    flash_operation_reset(p->board, &f->operation, SECTOR_NS);
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    part_set(p, OPTCR, options(p->board, p->row->class->regs[5].reset));
    struct stored_flash *stored = stored_flash(p->board);
    stored->cache_on = stored->cache_old = false;
    stored_flash_set_open(p->board, false);
    f->keys = 0;
}

void flash_f4_store(struct board *b, uint32_t at, unsigned bytes, uint32_t word)
{
    struct part *p = bus_part(b, "FLASH");
    struct flash *f = p->state;
    uint32_t cr = part_get(p, CR), width = 1u << (cr >> 8 & 3u);
    if ((part_get(p, SR) & SR_BSY) != 0) {
        board_verdict(b, "store into the flash while it is busy"); /* RM0090 3.6 */
    } else if ((cr & CR_LOCK) != 0 || (cr & CR_PG) == 0 || (cr & (CR_SER | CR_MER)) != 0) {
        part_set(p, SR, part_get(p, SR) | SR_PGS);
    } else if (width != bytes) {
        part_set(p, SR, part_get(p, SR) | SR_PGP);
    } else if (at % ROW_BYTES + bytes > ROW_BYTES) { /* 3.6.4 */
        part_set(p, SR, part_get(p, SR) | SR_PGA);
    } else if (write_protected(b, FIRST_STORED_SECTOR + at / SECTOR_BYTES)) {
        part_set(p, SR, part_get(p, SR) | SR_WRP);
    } else {
        if (b->around.supply_mv < NEEDED_MV)
            board_verdict(b, "word programmed into the flash at %u mV; 2700 are needed",
                          b->around.supply_mv);
        stored_flash_program(b, at, bytes, word);
        f->operation.at = at & ~3u;
        f->operation.bytes = 4;
        busy(p, WORD_NS);
    }
}

static void write_cr(struct part *p, uint32_t before, uint32_t written)
{
    struct board *b = p->board;
    struct flash *f = p->state;
    if ((part_get(p, SR) & SR_BSY) != 0) {
        part_set(p, CR, before);
        board_verdict(b, "write of FLASH_CR while the flash is busy"); /* 3.6.1: stalls the bus */
        return;
    }
    if ((before & CR_LOCK) != 0) {
        part_set(p, CR, before); /* only the keys open it */
        return;
    }
    if ((written & CR_LOCK) != 0)
        stored_flash_set_open(b, false);
    if ((written & CR_MER) != 0) {
        board_verdict(b, "mass erase of the flash");
        return;
    }
    if ((written & CR_IRQS) != 0)
        board_verdict(b, "interrupts of the flash are not modelled");
    if ((written & CR_STRT) == 0)
        return;
    uint32_t sector = written >> 3 & 15u;
    if ((written & CR_SER) == 0 || (written & CR_PG) != 0) { /* 3.6.3, 3.6.4 */
        board_verdict(b,
                      "start of the flash with FLASH_CR at 0x%08x, which is not the erase of a "
                      "sector alone",
                      written);
    } else if (sector < FIRST_STORED_SECTOR || sector > FIRST_STORED_SECTOR + 1u) {
        board_verdict(b, "erase of sector %u of the flash, which holds the program or is not there",
                      sector);
    } else if (write_protected(b, sector)) {
        part_set(p, SR, part_get(p, SR) | SR_WRP);
        part_set(p, CR, part_get(p, CR) & ~CR_STRT);
    } else {
        if (b->around.supply_mv < NEEDED_MV)
            board_verdict(b, "sector of the flash erased by words at %u mV; 2700 are needed",
                          b->around.supply_mv);
        f->operation.erasing = true;
        f->operation.at = (sector - FIRST_STORED_SECTOR) * SECTOR_BYTES;
        f->operation.bytes = SECTOR_BYTES;
        busy(p, SECTOR_NS / 1000u * stored_flash_erase_share(b));
    }
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    struct flash *f = p->state;
    switch (offset) {
    case KEYR:
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
        break;
    case SR:
        part_set(p, SR, before & ~(written & 0xF3u));
        break;
    case CR:
        write_cr(p, before, written);
        break;
    case OPTCR:
    case OPTKEYR:
        board_verdict(p->board, "write of the option bytes");
        break;
    case ACR:
        stored_flash(p->board)->cache_on = (written & ACR_DCEN) != 0;
        if ((written & ACR_DCRST) != 0) {
            stored_flash(p->board)->cache_old = false;
            stored_flash_changed(p->board);
        }
        if ((written & ACR_RESETS) != 0 && (before & (written & ACR_RESETS) >> 2) != 0)
            board_verdict(p->board, "cache of the flash emptied while it is on"); /* 3.9.1 */
        break;
    default:
        break;
    }
}

/* 3.9.3, 3.9.4 */
static bool keys(uint32_t offset)
{
    return offset == KEYR || offset == OPTKEYR;
}

const struct part_class flash_f4_class = {.name = "flash interface of the STM32F4",
                                          .regs = regs,
                                          .n_regs = sizeof(regs) / sizeof(regs[0]),
                                          .state_bytes = sizeof(struct flash),
                                          .widths = WIDTH_BYTE | WIDTH_HALF | WIDTH_WORD,
                                          .only_words = keys,
                                          .start = start,
                                          .reset = reset,
                                          .write = write};
