/* Pins of the STM32F100, read in RM0041 Rev 6: 7.2. Four bits each, mode and kind. A digital input reaches every part that listens there
 * (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "models.h"

enum { CRL = 0x00, CRH = 0x04, IDR = 0x08, ODR = 0x0C, BSRR = 0x10, BRR = 0x14, LCKR = 0x18 };

#define ALL         UINT32_MAX
#define MODE        3u   /* 0: input */
#define ALTERNATE   8u   /* of an output */
#define INPUT_KINDS 0xCu /* 0: analog, 4: floating, 8: pulled */
#define PULLED      8u

/* 7.2.1: all inputs, floating. The debugger's pins are as the others here, because no firmware takes them. */
static const struct reg regs[] = {
    {"CRL", CRL, 0x44444444u, ALL, ALL}, {"CRH", CRH, 0x44444444u, ALL, ALL},
    {"IDR", IDR, 0, 0xFFFFu, 0},         {"ODR", ODR, 0, 0xFFFFu, 0xFFFFu},
    {"BSRR", BSRR, 0, ALL, 0},           {"BRR", BRR, 0, 0xFFFFu, 0},
    {"LCKR", LCKR, 0, 0x1FFFFu, 0},
};

static uint32_t setting(const struct part *p, unsigned pin)
{
    return part_get(p, pin < 8 ? CRL : CRH) >> 4 * (pin & 7u) & 15u;
}

/* A digital input reaches every part that listens there; an output is driven by the one part that is there. */
uint8_t pin_function_f1(struct board *b, char port, unsigned pin)
{
    uint32_t s = setting(pins_part(b, port), pin);
    if ((s & MODE) == 0)
        return (s & INPUT_KINDS) == 0 ? PIN_NO_FUNCTION : PIN_INPUT;
    return (s & ALTERNATE) != 0 ? 0 : PIN_NO_FUNCTION;
}

/* Nothing is wired to the pins yet: an output reads itself, a pulled input its pull, which ODR chooses. */
static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    if (offset != IDR)
        return stored;
    uint32_t seen = 0;
    for (unsigned pin = 0; pin < 16; pin++) {
        uint32_t s = setting(p, pin);
        if ((s & MODE) != 0 || (s & INPUT_KINDS) == PULLED)
            seen |= part_get(p, ODR) & UINT32_C(1) << pin;
    }
    return seen;
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    (void)before;
    if (offset == BSRR) /* to set goes before to reset (7.2.5) */
        part_set(p, ODR, (part_get(p, ODR) & ~(written >> 16)) | (written & 0xFFFFu));
    else if (offset == BRR)
        part_set(p, ODR, part_get(p, ODR) & ~written);
    else if (offset == LCKR)
        board_verdict(p->board, "locking of pins is not modelled");
}

const struct part_class gpio_f1_class = {.name = "pins of the STM32F1",
                                         .regs = regs,
                                         .n_regs = sizeof(regs) / sizeof(regs[0]),
                                         .widths = WIDTH_WORD,
                                         .read = read,
                                         .write = write};
