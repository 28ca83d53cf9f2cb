/* What is at the board's pins in these tests: a chip on each bus that answers what only the bytes that it has heard can give.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <string.h>

#include "board_io.h"

struct plant plant;

/* Select pins of the chips on SPI1 to SPI3: PA4, PB12, PD2. The third takes any mode, the others 1 and 3. */
static const struct plant_spi chips[PLANT_CHIPS] = {
    {.pin = HAL_PIN('A', 4), .modes = 0xA},
    {.pin = HAL_PIN('B', 12), .modes = 0xA},
    {.pin = HAL_PIN('D', 2), .modes = 0xF},
};

bool plant_disturbs(void)
{
    bool noise = plant.errors_per_million != 0 &&
                 random_word(&plant.random) % 1000000u < plant.errors_per_million;
    plant.errors += noise ? 1u : 0;
    return noise;
}

static uint8_t disturbed(uint8_t byte)
{
    for (unsigned bit = 0; bit < 8; bit++)
        byte ^= (uint8_t)((plant_disturbs() ? 1u : 0) << bit);
    return byte;
}

static void pin_driven(void *context, uint64_t now_ns, unsigned pin, enum pin_drive drive)
{
    (void)context;
    plant.pins[pin] = drive;
    plant.moved_ns[pin] = now_ns;
    plant.moves[pin]++;
    for (unsigned i = 0; i < PLANT_CHIPS; i++) {
        struct plant_spi *c = &plant.spi[i];
        if (c->pin != pin)
            continue;
        bool low = drive == PIN_LOW; /* a resistor holds it high otherwise */
        if (low && !c->selected) {
            c->heard = c->sum = 0;
            c->selected_ns = now_ns;
        }
        if (!low && c->selected)
            c->released_ns = now_ns;
        c->selected = low;
    }
}

static void pin_pulses(void *context, uint64_t now_ns, unsigned pin, double hz, double high)
{
    (void)context;
    (void)now_ns;
    plant.hz[pin] = hz;
    plant.high[pin] = high;
}

static double pin_volts(void *context, uint64_t now_ns, unsigned pin)
{
    (void)context;
    (void)now_ns;
    return plant.volts[pin];
}

uint8_t plant_answer(uint32_t sum, unsigned k)
{
    return (uint8_t)(sum * 5u + 17u * k + 0xA5u);
}

static uint8_t spi_exchange(void *context, uint64_t now_ns, unsigned bus, unsigned mode,
                            uint8_t out)
{
    (void)context;
    (void)now_ns;
    struct plant_spi *c = &plant.spi[bus - 1u];
    if (!c->selected)
        return 0xFF;
    if ((c->modes >> mode & 1u) == 0)
        return (uint8_t)random_word(&plant.random);
    uint8_t answer = plant_answer(c->sum, c->heard);
    if (c->heard < PLANT_HEARD)
        c->bytes[c->heard] = out;
    c->heard++;
    c->sum += out;
    return disturbed(answer);
}

void plant_reset(uint64_t seed)
{
    plant = (struct plant){.random = random_state(seed)};
    (void)memcpy(plant.spi, chips, sizeof(chips));
}

struct world plant_world(void)
{
    struct world world = {.pin_driven = pin_driven,
                          .pin_pulses = pin_pulses,
                          .pin_volts = pin_volts,
                          .spi_exchange = spi_exchange,
                          .wire_reset = plant_wire_reset,
                          .wire_bit = plant_wire_bit};
    plant_i2c_world(&world);
    return world;
}
