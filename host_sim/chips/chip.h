/* Chips around the board, bit by bit as their data sheets have them: behind the buses of the host and behind those of the virtual board.
 * A chip knows nothing of who asks. Time comes with each call, ns of the board; it does not go backwards.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_CHIPS_CHIP_H
#define REFLUX_CHIPS_CHIP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "chips/bus.h"

/* What the world does to a chip, by name: a quantity that it measures, in the unit of the name's list, or a fault, which is there while its
 * value is not 0. */
struct chip_input {
    const char *name; /* "temperature", "open" */
    const char *unit; /* "degC", "" of a fault */
    double lo, hi;
    double at_first;
    const char *what; /* for people */
};

/* A property of how it is wired, fixed when it is made: "reference" 430 ohm. One that is no number has a parser, and words for what it takes;
 * NAN at first: made from the seed. */
struct chip_property {
    const char *name, *unit;
    double lo, hi, at_first;
    bool (*parse)(const char *text, double *value);
    const char *form; /* "a letter of BEJKNRST" */
};

struct chip_kind {
    const char *name; /* "max31865" */
    enum chip_bus bus;
    const struct chip_property *properties;
    size_t n_properties;
    const struct chip_input *inputs;
    size_t n_inputs;
    size_t size; /* of its state, bytes; struct chip is at the beginning */
    void (*power_on)(struct chip *c, uint64_t now_ns);

    /* Ends the conversions that are due, with the inputs as they are. NULL: the kind has none that run by themselves. */
    void (*catch_up)(struct chip *c, uint64_t now_ns);

    /* SPI: the line of select, and a byte each way. The bus has this mode (0..3) at the moment; a chip that cannot take it answers rubbish.
     * exchange() is called when the last bit has been clocked. */
    void (*select)(struct chip *c, uint64_t now_ns, bool low);
    uint8_t (*exchange)(struct chip *c, uint64_t now_ns, unsigned mode, uint8_t out);
    bool shifts_always; /* it hears each byte of its bus; select is the line that latches */

    /* I2C: after start or start again the address is on the bus; true: it is acknowledged. */
    bool (*address)(struct chip *c, uint64_t now_ns, uint8_t address, bool read);
    bool (*write)(struct chip *c, uint64_t now_ns, uint8_t byte);
    uint8_t (*read)(struct chip *c, uint64_t now_ns, bool acknowledged);
    void (*stop)(struct chip *c, uint64_t now_ns);

    /* 1-wire: a reset pulse, true: presence; then time slots. bit_in() says what the chip does to the line in the slot that begins, false: it
     * pulls low, and changes nothing; bit_out() ends the slot, with the line as the chip samples it. A wire with several chips is low where
     * one of them pulls. */
    bool (*presence)(struct chip *c, uint64_t now_ns);
    void (*bit_out)(struct chip *c, uint64_t now_ns, bool bit);
    bool (*bit_in)(struct chip *c, uint64_t now_ns);

    /* Of a chip that has a load: mA or V there, and the level of its pin CLEAR, which works without a bus. NULL: it has none. */
    double (*drives)(struct chip *c, uint64_t now_ns);
    void (*clear)(struct chip *c, uint64_t now_ns, bool high);

    /* Of what is at a pin of the board itself (CHIP_PIN, chips/at_pin.h). From now on it counts its milliseconds anew; flows: what it measures
     * moves, else nothing does until it is called again. */
    void (*begin)(struct chip *c, uint64_t now_ns, bool flows);
    /* The pin is pulled to ground; else it is left alone. NULL: never. */
    bool (*low)(const struct chip *c, uint64_t now_ns);
    /* The first moment after now at which that may change, as long as no input does; UINT64_MAX: none. */
    uint64_t (*next_edge)(const struct chip *c, uint64_t now_ns);
    /* V at the pin. NULL: 0. */
    double (*pin_volts)(const struct chip *c, uint64_t now_ns);
};

#define CHIP_INPUTS_MAX 16u
#define CHIP_WRONG_SIZE 200u

struct chip {
    const struct chip_kind *kind;
    double property[CHIP_INPUTS_MAX];
    double input[CHIP_INPUTS_MAX];
    uint64_t seed;   /* what differs from chip to chip is made from it, at each power-on alike */
    uint64_t random; /* state of noise */
    bool powered, dead;
    unsigned stray_bits; /* SPI: bits of a byte that has not been clocked whole */
    char wrong
        [CHIP_WRONG_SIZE]; /* the first rule of the data sheet that was broken: chip, register, rule; "" none */
    unsigned wrongs; /* broken rules so far */
};

/* All kinds there are; n: how many. */
const struct chip_kind *const *chip_kinds(size_t *n);

/* A chip of the kind with this name, with its properties as in "reference=400 wires=3"; it has no power yet. NULL, with a sentence in err. */
struct chip *chip_new(const char *kind, const char *properties, uint64_t seed, char *err,
                      size_t err_size);
void chip_free(struct chip *c);

/* Sets an input, as the world has it from now on. False, with a sentence in err: the kind has no such input, or the value is beyond its range.
 * A fault that every kind has is "dead": the chip does not answer. Where the moment matters, chip_at() comes first. */
bool chip_set(struct chip *c, const char *input, double value, char *err, size_t err_size);

/* Index of an input by name, or -1. */
int chip_input_index(const struct chip_kind *kind, const char *name);

/* What the world does is taken over by chips at their own pace. Conversions that end by this time are done with the inputs as they are: call
 * before inputs change. */
void chip_at(struct chip *c, uint64_t now_ns);

/* Turns the supply on, with everything as at power-on, or off. */
void chip_power(struct chip *c, uint64_t now_ns, bool on);

/* mA or V that a chip drives into its load; 0 without power. Not earlier than the call before. */
double chip_drives(struct chip *c, uint64_t now_ns);

/* The chip has power and is not dead. */
bool chip_answers(const struct chip *c);

#endif
