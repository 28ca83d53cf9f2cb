/* Pins of the STM32F100, read in RM0041 Rev 6: 7.2. Four bits each, mode and kind. What is wired to them is the world's (world.h). A digital input
 * reaches every part that listens there (unverified). An output that nothing is wired to reads as ODR has it, also where a part of the chip
 * drives it.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "pins.h"

enum { CRL = 0x00, CRH = 0x04, IDR = 0x08, ODR = 0x0C, BSRR = 0x10, BRR = 0x14, LCKR = 0x18 };

#define ALL         UINT32_MAX
#define MODE        3u   /* 0: input */
#define ALTERNATE   8u   /* of an output */
#define INPUT_KINDS 0xCu /* 0: analog, 4: floating, 8: pulled */
#define PULLED      8u
#define OPEN_DRAIN  4u /* of an output */

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

static bool is_high(const struct part *p, unsigned pin)
{
    return (part_get(p, ODR) >> pin & 1u) != 0;
}

static enum pin_drive drive_of(const struct part *p, unsigned pin)
{
    uint32_t s = setting(p, pin);
    bool high = is_high(p, pin);
    if ((s & MODE) == 0)
        return (s & INPUT_KINDS) != PULLED ? PIN_FLOATS : high ? PIN_PULLED_UP : PIN_PULLED_DOWN;
    if ((s & ALTERNATE) != 0)
        return PIN_OF_BUS;
    if (high && (s & OPEN_DRAIN) != 0)
        return PIN_FLOATS;
    return high ? PIN_HIGH : PIN_LOW;
}

static bool is_analog(const struct part *p, unsigned pin)
{
    return (setting(p, pin) & (MODE | INPUT_KINDS)) == 0;
}

static bool pulled_up(const struct part *p, unsigned pin)
{
    uint32_t s = setting(p, pin);
    return ((s & MODE) != 0 || (s & INPUT_KINDS) == PULLED) && is_high(p, pin);
}

static bool is_open_drain(const struct part *p, unsigned pin)
{
    return (setting(p, pin) & OPEN_DRAIN) != 0;
}

/* 7.2.1: code 2 is 2 MHz, 1 is 10 MHz, 3 is 50 MHz. */
static unsigned speed(const struct part *p, unsigned pin)
{
    static const uint8_t order[] = {0, 1, 0, 2};
    return order[setting(p, pin) & MODE];
}

const struct pins_model pins_f1 = {drive_of, pulled_up, is_analog, is_open_drain, speed};

static void reset(struct part *p, enum board_reset kind)
{
    (void)kind;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    pins_look(p);
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    return offset == IDR ? pins_seen(p) : stored;
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
    pins_look(p);
}

const struct part_class gpio_f1_class = {.name = "pins of the STM32F1",
                                         .regs = regs,
                                         .n_regs = sizeof(regs) / sizeof(regs[0]),
                                         .state_bytes = PINS_STATE_BYTES,
                                         .widths = WIDTH_WORD,
                                         .reset = reset,
                                         .read = read,
                                         .write = write};
