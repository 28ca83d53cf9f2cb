/* Pins of the STM32F405, read in RM0090 Rev 21: 8.4. What is wired to them is the world's (world.h). A pin of a bus or timer reads as its wire is,
 * an analogue pin reads 0 (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "pins.h"

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

enum { MODE_OUTPUT = 1, MODE_FUNCTION = 2, MODE_ANALOG = 3 };

static const struct reg regs[] = {
    {"MODER", MODER, 0, ALL, ALL},     {"OTYPER", OTYPER, 0, 0xFFFFu, 0xFFFFu},
    {"OSPEEDR", OSPEEDR, 0, ALL, ALL}, {"PUPDR", PUPDR, 0, ALL, ALL},
    {"IDR", IDR, 0, 0xFFFFu, 0},       {"ODR", ODR, 0, 0xFFFFu, 0xFFFFu},
    {"BSRR", BSRR, 0, ALL, 0},         {"LCKR", LCKR, 0, 0x1FFFFu, 0},
    {"AFRL", AFRL, 0, ALL, ALL},       {"AFRH", AFRH, 0, ALL, ALL},
};

struct gpio {
    enum pin_drive drives[16]; /* as the world has been told */
};

static enum pin_drive drive_of(const struct part *p, unsigned pin)
{
    uint32_t mode = part_get(p, MODER) >> 2 * pin & 3u, pull = part_get(p, PUPDR) >> 2 * pin & 3u;
    bool high = (part_get(p, ODR) >> pin & 1u) != 0,
         open_drain = (part_get(p, OTYPER) >> pin & 1u) != 0;
    if (mode == MODE_FUNCTION)
        return PIN_OF_BUS;
    if (mode == MODE_OUTPUT && !(high && open_drain))
        return high ? PIN_HIGH : PIN_LOW;
    return mode == MODE_ANALOG || pull == 0 ? PIN_FLOATS
           : pull == 1u                     ? PIN_PULLED_UP
                                            : PIN_PULLED_DOWN;
}

/* Tells the world which pins are driven differently. */
static void look(struct part *p)
{
    struct gpio *g = p->state;
    struct board *b = p->board;
    for (unsigned k = 0; k < 16; k++) {
        enum pin_drive drive = drive_of(p, k);
        unsigned pin = 16u * p->row->number + k;
        if (drive == g->drives[k])
            continue;
        g->drives[k] = drive;
        if (b->world.pin_driven != NULL)
            b->world.pin_driven(b->world.context, board_ns(b), pin, drive);
        i2c_pin_moved(b, pin, drive);
        exti_look(b, pin);
    }
}

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
    look(p);
}

static const struct part *pins_of(struct board *b, unsigned pin)
{
    return pins_part(b, (char)('A' + (int)(pin / 16u)));
}

bool pin_has_function(struct board *b, unsigned pin, uint8_t function)
{
    return pin_function_f4(b, (char)('A' + (int)(pin / 16u)), pin % 16u) == function;
}

bool pin_is_open_drain(struct board *b, unsigned pin)
{
    return (part_get(pins_of(b, pin), OTYPER) >> pin % 16u & 1u) != 0;
}

unsigned pin_speed(struct board *b, unsigned pin)
{
    return part_get(pins_of(b, pin), OSPEEDR) >> 2 * (pin % 16u) & 3u;
}

bool pin_is_analog(struct board *b, unsigned pin)
{
    return (part_get(pins_of(b, pin), MODER) >> 2 * (pin % 16u) & 3u) == MODE_ANALOG;
}

bool pin_level(struct board *b, unsigned pin)
{
    const struct part *p = pins_of(b, pin);
    enum pin_drive drive = drive_of(p, pin % 16u);
    if (drive == PIN_LOW || drive == PIN_HIGH)
        return drive == PIN_HIGH;
    if ((part_get(p, MODER) >> 2 * (pin % 16u) & 3u) == MODE_ANALOG || i2c_holds_pin(b, pin))
        return false;
    enum pin_level level = PIN_LEVEL_OPEN;
    if (b->world.pin_input != NULL)
        level = b->world.pin_input(b->world.context, board_ns(b), pin);
    if (level == PIN_LEVEL_OPEN)
        level = b->wired[pin];
    if (level != PIN_LEVEL_OPEN)
        return level == PIN_LEVEL_HIGH;
    return (part_get(p, PUPDR) >> 2 * (pin % 16u) & 3u) == 1u;
}

void board_set_world(struct board *b, const struct world *world)
{
    b->world = *world;
    b->has_world = true;
    board_world_changed(b);
}

void board_set_pin(struct board *b, unsigned pin, enum pin_level level)
{
    b->wired[pin] = level;
    exti_look(b, pin);
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
    if (offset != IDR)
        return stored;
    uint32_t seen = 0;
    for (unsigned k = 0; k < 16; k++)
        seen |= pin_level(p->board, 16u * p->row->number + k) ? UINT32_C(1) << k : 0;
    return seen;
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    (void)before;
    if (offset == BSRR) /* to set goes before to reset (8.4.7) */
        part_set(p, ODR, (part_get(p, ODR) & ~(written >> 16)) | (written & 0xFFFFu));
    else if (offset == LCKR)
        board_verdict(p->board, "locking of pins is not modelled");
    look(p);
    if (offset == MODER || offset == AFRL || offset == AFRH)
        pwm_look(p->board);
}

/* 8.4.5, 8.4.8 */
static bool only_words(uint32_t offset)
{
    return offset == IDR || offset == LCKR;
}

const struct part_class gpio_f4_class = {.name = "pins of the STM32F4",
                                         .regs = regs,
                                         .n_regs = sizeof(regs) / sizeof(regs[0]),
                                         .state_bytes = sizeof(struct gpio),
                                         .widths = WIDTH_BYTE | WIDTH_HALF | WIDTH_WORD,
                                         .only_words = only_words,
                                         .reset = reset,
                                         .read = read,
                                         .write = write};
