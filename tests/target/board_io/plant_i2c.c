/* A chip of registers on each I2C bus of the plant.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "board_io.h"

static struct plant_i2c *chip_on(unsigned bus)
{
    return &plant.i2c[bus - 1u];
}

static bool address(void *context, uint64_t now_ns, unsigned bus, uint8_t with, bool read)
{
    (void)context;
    struct plant_i2c *c = chip_on(bus);
    if (!c->addressed)
        c->began_ns = now_ns;
    c->starts++;
    c->by_hand = false;
    c->addressed = with == PLANT_ADDRESS && !(read && c->gives_none) && !plant_disturbs();
    c->reads = c->addressed && read;
    c->first = !read;
    c->last_was_acknowledged = true;
    return c->addressed;
}

static bool written(void *context, uint64_t now_ns, unsigned bus, uint8_t byte)
{
    (void)context;
    (void)now_ns;
    struct plant_i2c *c = chip_on(bus);
    CHECK(c->addressed && !c->reads, "a byte is written to a chip that does not take it");
    for (unsigned bit = 0; bit < 8; bit++)
        byte ^= (uint8_t)((plant_disturbs() ? 1u : 0) << bit);
    c->taken++;
    if (c->first) {
        c->first = false;
        c->at = byte;
        return true;
    }
    if (c->at >= PLANT_REFUSES)
        return false;
    c->registers[c->at++] = byte;
    return !plant_disturbs();
}

static uint8_t given(void *context, uint64_t now_ns, unsigned bus, bool acknowledged)
{
    (void)context;
    (void)now_ns;
    struct plant_i2c *c = chip_on(bus);
    CHECK(c->addressed && c->reads, "a byte is read from a chip that gives none");
    CHECK(c->last_was_acknowledged, "a byte is read behind one that was refused");
    uint8_t byte = c->registers[c->at++];
    c->given++;
    c->last_was_acknowledged = acknowledged;
    for (unsigned bit = 0; bit < 8; bit++)
        byte ^= (uint8_t)((plant_disturbs() ? 1u : 0) << bit);
    return byte;
}

static void stopped(void *context, uint64_t now_ns, unsigned bus)
{
    (void)context;
    struct plant_i2c *c = chip_on(bus);
    CHECK(!c->reads || !c->last_was_acknowledged || c->by_hand,
          "a stop behind a byte that was acknowledged: the chip may hold the line");
    c->addressed = c->reads = false;
    c->stops++;
    c->ended_ns = now_ns;
}

static unsigned held(void *context, uint64_t now_ns, unsigned bus)
{
    (void)context;
    (void)now_ns;
    return chip_on(bus)->held;
}

static void clocked(void *context, uint64_t now_ns, unsigned bus)
{
    (void)context;
    (void)now_ns;
    struct plant_i2c *c = chip_on(bus);
    c->by_hand = true;
    if (c->clocks > 0 && --c->clocks == 0) {
        c->held &= ~I2C_DATA_HELD;
        c->last_was_acknowledged = false;
    }
}

/* A chip in the middle of a byte that it gives holds the line for each 0 of it, until it has been clocked to the end. */
void plant_i2c_board_reset(void)
{
    for (unsigned k = 0; k < PLANT_I2C_BUSES; k++) {
        struct plant_i2c *c = &plant.i2c[k];
        if (c->reads && c->last_was_acknowledged && (c->held & I2C_DATA_HELD) == 0) {
            c->held |= I2C_DATA_HELD;
            c->clocks = 1u + random_word(&plant.random) % 9u;
        }
    }
}

void plant_i2c_world(struct world *world)
{
    world->i2c_address = address;
    world->i2c_write = written;
    world->i2c_read = given;
    world->i2c_stop = stopped;
    world->i2c_held = held;
    world->i2c_clock = clocked;
}
