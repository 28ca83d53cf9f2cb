/* Pins of the STM32F405, read in RM0090 Rev 21: 8.4.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "models.h"

enum {
    MODER = 0x00,
    OTYPER = 0x04,
    OSPEEDR = 0x08,
    PUPDR = 0x0C,
    IDR = 0x10,
    ODR = 0x14,
    BSRR = 0x18,
    LCKR = 0x1C,
    AFRL = 0x20,
    AFRH = 0x24
};

#define ALL UINT32_MAX

static const struct reg regs[] = {
    {"MODER", MODER, 0, ALL, ALL},     {"OTYPER", OTYPER, 0, 0xFFFFu, 0xFFFFu},
    {"OSPEEDR", OSPEEDR, 0, ALL, ALL}, {"PUPDR", PUPDR, 0, ALL, ALL},
    {"IDR", IDR, 0, 0xFFFFu, 0},       {"ODR", ODR, 0, 0xFFFFu, 0xFFFFu},
    {"BSRR", BSRR, 0, ALL, 0},         {"LCKR", LCKR, 0, 0x1FFFFu, 0},
    {"AFRL", AFRL, 0, ALL, ALL},       {"AFRH", AFRH, 0, ALL, ALL},
};

static void reset(struct part *p, enum board_reset kind)
{
    (void)kind;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    if (p->row->number == 0) { /* 8.4.1, 8.4.3, 8.4.4: the debugger's pins */
        part_set(p, MODER, 0xA8000000u);
        part_set(p, OSPEEDR, 0x0C000000u);
        part_set(p, PUPDR, 0x64000000u);
    } else if (p->row->number == 1) {
        part_set(p, MODER, 0x00000280u);
        part_set(p, OSPEEDR, 0x000000C0u);
        part_set(p, PUPDR, 0x00000100u);
    }
}

uint8_t pin_function_f4(struct board *b, char port, unsigned pin)
{
    const struct part *p = pins_part(b, port);
    if ((part_get(p, MODER) >> 2 * pin & 3u) != 2u)
        return PIN_NO_FUNCTION;
    return (uint8_t)(part_get(p, pin < 8 ? AFRL : AFRH) >> 4 * (pin & 7u) & 15u);
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    if (offset == BSRR)
        return 0;
    return offset == IDR ? part_get(p, ODR) : stored; /* nothing is wired to the pins yet */
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    (void)before;
    if (offset == BSRR) /* to set goes before to reset (8.4.7) */
        part_set(p, ODR, (part_get(p, ODR) & ~(written >> 16)) | (written & 0xFFFFu));
    else if (offset == LCKR)
        board_verdict(p->board, "locking of pins is not modelled");
}

/* 8.4.5, 8.4.8 */
static bool only_words(uint32_t offset)
{
    return offset == IDR || offset == LCKR;
}

const struct part_class gpio_f4_class = {.name = "pins of the STM32F4",
                                         .regs = regs,
                                         .n_regs = sizeof(regs) / sizeof(regs[0]),
                                         .widths = WIDTH_BYTE | WIDTH_HALF | WIDTH_WORD,
                                         .only_words = only_words,
                                         .reset = reset,
                                         .read = read,
                                         .write = write};
