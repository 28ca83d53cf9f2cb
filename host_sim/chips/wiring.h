/* What is wired where: a file of lines, each a sensor behind a chip or an output on a pin, by the name that the plant has for it.
 *
 *     # name   chip      where            properties
 *     T1       max31865  spi1 PA4         reference=430 wires=3
 *     T10      ds18b20   wire1            rom=28-000005e2fdc3
 *     dP       ads1115   i2c1 0x48 2      lo=0 hi=60 lo_in=0.4 hi_in=2
 *     P        bme280    i2c1 0x76 pressure  lo_in=0 hi_in=100 # mbar to Pa
 *     I        analog    PC0              lo=0 hi=10 lo_in=0.4 hi_in=2
 *     F        flow      PC9              hi=8 # 450 pulses a litre at 8 l/h are 1 a second
 *     low      level     PC8              quantity=M limit=2 hysteresis=0.1 normally=closed
 *     grid     mains     PC7              frequency=60
 *     Q        ssr       PB0              hi=3
 *     Lr       valve     PB1 PB2          hi=20 travel=60 active=low
 *     F        ad5422    spi2 PC0         clear=PC1 hi=8
 *     D        stepper   PB3 PB4          steps=120 hi=6
 *
 * A sensor stands on spiN and the pin of its select, on i2cN and its address, or on wireN; behind that the input of the chip: a name, or the number
 * of one of several alike. Voltages, pulses and contacts stand on a pin of the board (chips/at_pin.h). Several lines may name one chip, each with another input; the chip's properties stand on the first.
 *
 * Properties of each line: quantity, the plant's name where it is another; lo and hi, values of the quantity at lo_in and hi_in of the chip's input
 * (a straight line; without them they are the same), of an output with the load off and fully on (without them 0 and 1).
 * Of an output: active=low where a low pin turns it on. A valve has one pin, or two that open and close it, and `travel`, s from end to end. Behind
 * the two there may be two more, of contacts that close to ground at its open and its closed end.
 *
 * An ad5422 has the pin of its LATCH and clear=, the pin of its CLEAR, which a resistor pulls up. Its load is a valve or drive with an input: lo and
 * hi are at lo_in and hi_in, which are 4 and 20 mA, and 0 and 10 V with signal=voltage. A stepper has the pin of its steps and where wanted that of
 * its direction. It is a pump with steps= a ml and gives l/h: lo is 0, and hi the flow that the plant's input can have at most.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_CHIPS_WIRING_H
#define REFLUX_CHIPS_WIRING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "chips/bus.h"
#include "hal/pin.h"

#define WIRING_NAME_SIZE 16u

enum wiring_kind {
    WIRING_SSR,
    WIRING_RELAY,
    WIRING_PWM,
    WIRING_VALVE,
    WIRING_STEPPER,
    WIRING_CHIP
};

struct wiring_sensor {
    char name[WIRING_NAME_SIZE];
    char quantity[WIRING_NAME_SIZE]; /* of the plant */
    enum chip_bus bus;
    unsigned bus_number; /* from 1 */
    hal_pin select;      /* SPI, or what is at a pin of the board; else HAL_PIN_NONE */
    uint8_t address;     /* I2C */
    struct chip *chip;
    const char *input;   /* of the chip */
    double lo, hi;       /* of the quantity */
    double lo_in, hi_in; /* of the chip's input */
    bool open;           /* fault: the wire to the input is broken */
    unsigned line;
};

struct wiring_output {
    char name[WIRING_NAME_SIZE];
    char quantity[WIRING_NAME_SIZE]; /* of the plant */
    enum wiring_kind kind;
    hal_pin pin;
    hal_pin
        close_pin; /* of a valve with two, else HAL_PIN_NONE; of a stepper that of its direction */
    hal_pin
        end_pin[2]; /* contacts at the open and the closed end of such a valve, or HAL_PIN_NONE */
    bool low_active;
    double lo, hi;       /* of the quantity, off and on */
    double travel_s;     /* of a valve with two pins */
    double steps;        /* of a stepper, a ml */
    struct chip *chip;   /* of WIRING_CHIP: pin is its latch */
    hal_pin clear_pin;   /* of that, else HAL_PIN_NONE */
    double lo_in, hi_in; /* mA or V, likewise */
    bool shorted;        /* fault: the load is on whatever the pin does */
    bool broken;         /* fault: it is off whatever the pin does */
    unsigned line;
};

struct wiring;

/* Reads a file and makes its chips, without power. seed: of addresses and tolerances that the file leaves open. NULL, with a sentence in err that
 * names file and line, what is wrong and what would be right. */
struct wiring *wiring_read(const char *path, uint64_t seed, char *err, size_t err_size);
void wiring_free(struct wiring *w);

size_t wiring_n_sensors(const struct wiring *w);
const struct wiring_sensor *wiring_sensor(const struct wiring *w, size_t i);
size_t wiring_n_outputs(const struct wiring *w);
const struct wiring_output *wiring_output(const struct wiring *w, size_t i);

/* A bus by number, from 1. NULL: nothing is on it. */
struct chips *wiring_bus(const struct wiring *w, enum chip_bus kind, unsigned number);

/* Supply of all chips. */
void wiring_power(struct wiring *w, uint64_t now_ns, bool on);

/* What is at pins of the board begins its time anew: see begin() of its kind. */
void wiring_begin(struct wiring *w, uint64_t now_ns, bool flows);

/* What is at this pin of the board. NULL: nothing is. */
const struct chip *wiring_at_pin(const struct wiring *w, unsigned pin);

/* Before the world changes: see chip_at(). */
void wiring_at(struct wiring *w, uint64_t now_ns);

/* Gives a sensor the value of its quantity; what is beyond the chip's range is its end. */
void wiring_measure(struct wiring *w, size_t sensor, double value);

/* A fault or an input by name: "T1", "open"; "spi1", "noise"; "Q", "shorted" or "broken" of outputs. False, with a sentence in err. */
bool wiring_set(struct wiring *w, const char *name, const char *what, double value, char *err,
                size_t err_size);

/* What can happen to a line or to a bus: a fault, which is there while its value is not 0, or a quantity of its chip that no line gives it. */
struct wiring_fault {
    const char *name; /* "open" */
    const char *unit; /* "" of a fault */
    double lo, hi;
    const char *what; /* for people */
};

/* The n-th fault of a line or bus with this name. False: it has no more, or nothing has the name. */
bool wiring_fault_at(const struct wiring *w, const char *name, size_t n,
                     struct wiring_fault *fault);

/* Whether a line or bus with this name has this fault, or any where `what` is NULL. */
bool wiring_has(const struct wiring *w, const char *name, const char *what);

/* Appends the names of all lines and buses: "T1, T10, Qrb, spi1". */
void wiring_append_names(const struct wiring *w, char *text, size_t size);

/* The n-th fault that chips of a kind have beside those of all chips; NULL past the last. */
struct chip_kind;
const char *wiring_fault_of_kind(const struct chip_kind *kind, size_t n);

/* Whether a fault of a line or bus that there is may have this value. False, with a sentence in err that says which faults it has. */
bool wiring_fault_check(const struct wiring *w, const char *name, const char *what, double value,
                        char *err, size_t err_size);

/* Sets a fault, or takes it back with 0: all of wiring_fault_at(), and what wiring_set() takes. */
bool wiring_fault(struct wiring *w, uint64_t now_ns, const char *name, const char *what,
                  double value, char *err, size_t err_size);

/* Whether the load of an output is on while the pin has this level. */
bool wiring_load(const struct wiring_output *output, bool high);

/* First text of a broken rule of a data sheet (struct chip), or "", and how many there were. */
const char *wiring_wrong(const struct wiring *w, unsigned *count);

#endif
