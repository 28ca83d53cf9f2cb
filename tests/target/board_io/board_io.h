/* The io image (tests/target/io_image) on the virtual STM32F405, with a small plant at its pins.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef BOARD_IO_H
#define BOARD_IO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "../io_image/mailbox.h"
#include "base/error.h"
#include "chip.h"
#include "hal/pin.h"
#include "hal/transfer.h"
#include "world.h"

#define MS UINT64_C(1000000)

/* Ends the program with status 1. */
_Noreturn void fail(const char *format, ...) __attribute__((format(printf, 1, 2)));
#define CHECK(what, ...)                                                                           \
    do {                                                                                           \
        if (!(what))                                                                               \
            fail(__VA_ARGS__);                                                                     \
    } while (0)

/* ---- bench.c ---- */

struct bench {
    struct board *board;
    volatile struct mailbox *box; /* in the board's memory */
    uint32_t asked;               /* number of the last request */
    uint32_t hold_ms;             /* of the next request */
    uint64_t random;
};

/* Steps by instructions: barriers are checked (host_sim/virtual_board/barrier_rules.h). */
extern bool bench_exact;

void bench_start(struct bench *bench, const char *image, uint64_t seed);
void bench_stop(struct bench *bench);
/* A reset by the pin; the image starts again. */
void bench_reset(struct bench *bench);
void bench_run(struct bench *bench, uint64_t ns);
/* 0 to n - 1 */
uint32_t bench_random(struct bench *bench, uint32_t n);

/* Fills the mailbox for a request of this kind: everything else is 0. */
volatile struct mailbox *bench_prepare(struct bench *bench, enum io_command command);
/* The board begins with it at its next millisecond. */
void bench_ask(struct bench *bench);
/* Runs until it is done, and returns its err; the program fails if that takes longer than 1 s: a hang. */
enum err bench_wait(struct bench *bench);
enum err bench_do(struct bench *bench, enum io_command command, unsigned pin, uint32_t mode,
                  uint32_t value);

/* ---- plant.c ---- */

#define PLANT_HEARD 512u

struct plant_spi {
    unsigned pin, modes; /* modes: a bit each that it takes */
    bool selected;
    unsigned heard; /* bytes since it was selected */
    uint32_t sum;   /* of them */
    uint8_t bytes[PLANT_HEARD];
    uint64_t selected_ns, released_ns;
};

#define PLANT_CHIPS 3u

#define PLANT_WIRES     2u
#define PLANT_ON_A_WIRE 8u

/* A chip on a wire: after a reset pulse a command of its address (search, match, skip), then a byte n, n bytes that it hears, and answers. */
struct plant_on_wire {
    uint8_t rom[8];
    uint8_t stage; /* of plant_wire.c */
    uint8_t byte;  /* that comes in or goes out */
    unsigned bits, wanted, heard, answered;
    uint32_t sum;
    uint8_t bytes[PLANT_HEARD];
};

struct plant_wire {
    struct plant_on_wire chips[PLANT_ON_A_WIRE];
    unsigned n;
    bool shorted, pulled;       /* pulled: somebody pulls in each slot */
    uint64_t reset_ns, slot_ns; /* of the last one, and of the shortest distance of two slots */
    uint64_t last_ns;
};

#define PLANT_I2C_BUSES 2u
#define PLANT_ADDRESS   0x48u

/* A chip of registers: the first byte that is written says which, what follows goes into it and the next ones. It refuses to write from
 * PLANT_REFUSES on. */
#define PLANT_REFUSES 0xF0u
struct plant_i2c {
    uint8_t registers[256], at;
    bool addressed, reads, first; /* first: the register is written next */
    unsigned held;                /* lines that it holds, I2C_*_HELD */
    unsigned clocks;              /* that it wants until it lets go of the data line */
    unsigned starts, stops, taken, given;
    bool last_was_acknowledged;
    bool gives_none; /* it does not answer to be read */
    bool
        by_hand; /* the board has clocked the line outside of a transfer, and may stop wherever the chip is */
    uint64_t began_ns, ended_ns;
};

struct plant {
    enum pin_drive pins[WORLD_PINS];
    uint64_t moved_ns[WORLD_PINS];
    uint32_t moves[WORLD_PINS];
    double hz[WORLD_PINS], high[WORLD_PINS]; /* of pulse widths; 0 Hz: none */
    double volts[WORLD_PINS];                /* at analogue inputs */
    struct plant_spi spi[PLANT_CHIPS];       /* one on each bus */
    struct plant_i2c i2c[PLANT_I2C_BUSES];
    struct plant_wire wires[PLANT_WIRES];
    uint32_t errors_per_million; /* bits that change on a bus */
    uint64_t random;
    uint32_t errors; /* that there were */
};

extern struct plant plant;

struct world plant_world(void);
void plant_reset(uint64_t seed);
/* Answer of a chip: its k-th byte, after it has heard bytes of this sum. */
uint8_t plant_answer(uint32_t sum, unsigned k);

/* A bit of an answer, as noise leaves it. */
bool plant_disturbs(void);

/* plant_wire.c */
enum wire_answer plant_wire_reset(void *context, uint64_t now_ns, unsigned bus);
enum wire_answer plant_wire_bit(void *context, uint64_t now_ns, unsigned bus, bool out);

/* plant_i2c.c: fills in the functions of its buses. */
void plant_i2c_world(struct world *world);
/* The board has been reset: a chip that was giving a byte may hold the data line now. */
void plant_i2c_board_reset(void);

/* ---- cases ---- */

void case_pins(const char *image);
void case_outputs(const char *image);
void case_pwm(const char *image);
void case_pulses(const char *image);
void case_analog(const char *image);
void case_spi(const char *image);
void case_spi_campaign(const char *image, uint32_t count, uint64_t seed);
void case_wire(const char *image);
void case_i2c(const char *image);
void case_together(const char *image);
void case_i2c_campaign(const char *image, uint32_t count, uint64_t seed);
void case_wire_campaign(const char *image, uint32_t count, uint64_t seed);

#endif
