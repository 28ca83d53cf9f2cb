/* Pins and what is wired to them, whatever the chip: each chip names the model of its own that knows what a pin drives. A pin of a bus or timer
 * reads as its wire is, an analogue pin reads 0 (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "pins.h"

static struct part *pins_of(struct board *b, unsigned pin)
{
    return pins_part(b, (char)('A' + (int)(pin / 16u)));
}

void pins_look(struct part *p)
{
    struct pins_state *g = p->state;
    struct board *b = p->board;
    for (unsigned k = 0; k < 16; k++) {
        enum pin_drive drive = b->chip->pins->drive(p, k);
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

uint32_t pins_seen(struct part *p)
{
    uint32_t seen = 0;
    for (unsigned k = 0; k < 16; k++)
        seen |= pin_level(p->board, 16u * p->row->number + k) ? UINT32_C(1) << k : 0;
    return seen;
}

bool pin_has_function(struct board *b, unsigned pin, uint8_t function)
{
    return pin_function(b, (char)('A' + (int)(pin / 16u)), pin % 16u) == function;
}

bool pin_is_open_drain(struct board *b, unsigned pin)
{
    return b->chip->pins->is_open_drain(pins_of(b, pin), pin % 16u);
}

unsigned pin_speed(struct board *b, unsigned pin)
{
    return b->chip->pins->speed(pins_of(b, pin), pin % 16u);
}

bool pin_is_analog(struct board *b, unsigned pin)
{
    return b->chip->pins->is_analog(pins_of(b, pin), pin % 16u);
}

bool pin_level(struct board *b, unsigned pin)
{
    const struct part *p = pins_of(b, pin);
    const struct pins_model *model = b->chip->pins;
    if (p == NULL) /* the chip has no such port */
        return false;
    enum pin_drive drive = model->drive(p, pin % 16u);
    if (drive == PIN_LOW || drive == PIN_HIGH)
        return drive == PIN_HIGH;
    if (model->is_analog(p, pin % 16u) || i2c_holds_pin(b, pin))
        return false;
    enum pin_level level = PIN_LEVEL_OPEN;
    if (b->world.pin_input != NULL)
        level = b->world.pin_input(b->world.context, board_ns(b), pin);
    if (level == PIN_LEVEL_OPEN)
        level = b->wired[pin];
    if (level != PIN_LEVEL_OPEN)
        return level == PIN_LEVEL_HIGH;
    return model->pulled_up(p, pin % 16u);
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
