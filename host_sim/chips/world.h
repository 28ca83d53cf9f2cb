/* What surrounds a board's pins: chips on its buses, levels and voltages at its inputs, and who looks at its outputs.
 *
 * The port of the host and the models of the virtual board call these functions; time is ns of the board, and does not go backwards but in a reset. A function that is NULL
 * stands for an empty board: nobody answers, nothing is wired. Buses are numbered as the chip's manual does: SPI1 is bus 1. Pins are
 * numbered as in hal/pin.h: PA0 is 0, PB0 16.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_CHIPS_WORLD_H
#define REFLUX_CHIPS_WORLD_H

#include <stdbool.h>
#include <stdint.h>

#define WORLD_PINS 64u

/* What the board does to one of its pins. */
enum pin_drive { PIN_FLOATS, PIN_PULLED_UP, PIN_PULLED_DOWN, PIN_LOW, PIN_HIGH, PIN_OF_BUS };

/* What the world does to it. */
enum pin_level { PIN_LEVEL_OPEN, PIN_LEVEL_LOW, PIN_LEVEL_HIGH };

/* Lines of an I2C bus that somebody holds low, as bits. */
#define I2C_CLOCK_HELD 1u
#define I2C_DATA_HELD  2u

/* What the board sees on a wire after its own pulse: nobody pulls, somebody does as the bus has it, or it stays low. */
enum wire_answer { WIRE_SILENT, WIRE_PULLED, WIRE_SHORTED };

struct world {
    void *context;

    /* The board drives a pin differently from now on. */
    void (*pin_driven)(void *context, uint64_t now_ns, unsigned pin, enum pin_drive drive);
    /* A pin has a pulse width from now on: high for this part of each period, 0 to 1. Edges are not told one by one. */
    void (*pin_pulses)(void *context, uint64_t now_ns, unsigned pin, double hz, double high);
    /* What is wired to an input, asked whenever the board looks at the pin. NULL or open: what the board was told. */
    enum pin_level (*pin_input)(void *context, uint64_t now_ns, unsigned pin);
    /* The first moment after now at which inputs may get another level although nobody changes the world; UINT64_MAX: none. NULL: inputs change
     * only when somebody changes the world. */
    uint64_t (*next_edge)(void *context, uint64_t now_ns);
    /* V at an analogue input; NULL: 0. */
    double (*pin_volts)(void *context, uint64_t now_ns, unsigned pin);

    /* A byte each way, at its last bit. Which chip is selected, the world knows from pin_driven. Mode: 0 to 3. */
    uint8_t (*spi_exchange)(void *context, uint64_t now_ns, unsigned bus, unsigned mode,
                            uint8_t out);

    /* After a start, or a start again, the address has gone out. Returns true: acknowledged. */
    bool (*i2c_address)(void *context, uint64_t now_ns, unsigned bus, uint8_t address, bool read);
    bool (*i2c_write)(void *context, uint64_t now_ns, unsigned bus, uint8_t byte);
    /* acknowledged: by the board, after this byte. */
    uint8_t (*i2c_read)(void *context, uint64_t now_ns, unsigned bus, bool acknowledged);
    void (*i2c_stop)(void *context, uint64_t now_ns, unsigned bus);
    /* I2C_*_HELD; asked whenever the board looks at its lines. */
    unsigned (*i2c_held)(void *context, uint64_t now_ns, unsigned bus);
    /* A clock pulse that the board makes by its pins, outside of any transfer. */
    void (*i2c_clock)(void *context, uint64_t now_ns, unsigned bus);

    enum wire_answer (*wire_reset)(void *context, uint64_t now_ns, unsigned bus);
    /* A time slot. out: the board lets go early, which is a 1 written or a bit asked for: the wire cannot tell them apart. Pulled: a 0. */
    enum wire_answer (*wire_bit)(void *context, uint64_t now_ns, unsigned bus, bool out);
};

#endif
