/* A board: a chip at register level around a processor that runs the flashed file whole.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 *
 * Time is cycles of the core. An instruction counts one, and the instructions of a block of code (up to a jump or the end of a
 * page) are counted together when the block begins; so a run with block steps and one with instruction steps see the same times.
 * A real core takes about 1.3 cycles an instruction, and more where the flash is slow: no cycle count of a board is one of a chip.
 *
 * What a chip would not do, or what the reference manual forbids, ends the run with a verdict in words: an access outside the models,
 * one to a part whose clock is off, a reserved bit written other than it is after reset.
 */
#ifndef REFLUX_VIRTUAL_BOARD_BOARD_H
#define REFLUX_VIRTUAL_BOARD_BOARD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "world.h"

#define BOARD_NEVER      UINT64_MAX
#define BOARD_LINES      2 /* serial lines: 0 console, 1 plant link */
#define BOARD_EVENTS     64
#define BOARD_PARTS      48
#define BOARD_VERDICT    240
#define BOARD_NAMED      32
#define BOARD_LINE_ROOM  65536u
#define BOARD_LAST_FLASH 16 /* regions of memory */

struct chip;
struct faults;
struct replay;
struct part;
struct processor;

/* What surrounds the chip. Zero in a field named *_hz or *_mv means: not there. */
struct surroundings {
    uint32_t crystal_hz;    /* 0: none fitted */
    uint32_t slow_clock_hz; /* of the watchdog */
    int32_t oscillator_ppm; /* error of the internal oscillator */
    uint32_t supply_mv;
    uint32_t brown_out_mv;  /* below this the chip is held in reset; 0: brown-out reset off */
    bool hardware_watchdog; /* option byte: it runs from a reset on */
    uint16_t
        write_protect; /* option bytes: a bit of each sector of the flash that is write-protected */
    uint32_t baud;     /* of what is at the other end of both lines */
    uint64_t seed;     /* memory at power-on, half-programmed bits */
};

struct board_event {
    uint64_t at_ns;
    void (*due)(void *context);
    void *context;
    bool outlives_reset; /* of what surrounds the chip */
};

/* Bytes on their way between a line's far end and its serial port. */
struct line {
    uint8_t to_board[BOARD_LINE_ROOM];
    uint8_t from_board[BOARD_LINE_ROOM];
    uint32_t to_head, to_tail, from_head, from_tail;
    uint32_t corrupt_per_million; /* bytes of either direction that noise changes */
    bool unplugged;               /* bytes of either direction are lost */
    bool far_end_obeys; /* a terminal at the console: it stops at XOFF and goes on at XON */
    bool asked_to_wait;
    struct part *port;
};

enum board_reset { RESET_POWER, RESET_BROWN_OUT, RESET_PIN, RESET_SOFTWARE, RESET_WATCHDOG };

struct board {
    const struct chip *chip;
    struct surroundings around;
    struct processor *processor;

    /* time */
    uint64_t cycles;       /* of the core, asleep and stalled ones too */
    uint64_t instructions; /* that were run */
    uint64_t core_hz;
    uint64_t anchor_cycles, anchor_ns;
    struct board_event *events[BOARD_EVENTS];
    size_t n_events;
    uint64_t next_ns;

    struct part *parts[BOARD_PARTS];
    size_t n_parts;
    struct part *last; /* that was read or written: mostly it is the next one, too */
    struct named {
        const char *name; /* as a caller has it: looked up by address */
        struct part *part;
    } named[BOARD_NAMED];
    struct line lines[BOARD_LINES];
    struct world world; /* empty until board_set_world() */
    bool has_world;
    enum pin_level wired[WORLD_PINS]; /* by the world */
    /* Interrupts of SysTick, which are the firmware's clock; where that was 0. */
    uint64_t clock_ms, clock_began_ns;

    uint64_t stalled_until_ns;             /* the flash answers no fetch */
    bool held;                             /* no supply, or the reset pin is low: nothing runs */
    bool hang_main, hang_tick, hang_clock; /* main loop, tick or board clock no longer gets on */
    struct faults *faults;
    struct replay *replay; /* NULL: what comes is not kept */
    bool found; /* of a second board: it has come to the access whose address is wanted */
    uint32_t found_pc;
    FILE *diary;      /* of faults and resets as they come; NULL: none is kept */
    uint32_t flipped; /* where the last bit turned over: address, or number of the register */
    bool reset_asked;
    enum board_reset reset_kind;
    uint32_t resets[RESET_WATCHDOG + 1];
    bool paused;           /* the run ends at the next block */
    bool clock_changed;    /* it goes on from there, with its end counted anew */
    bool from_board_moved; /* a byte has left since the caller looked */
    uint64_t random;
    char verdict[BOARD_VERDICT]; /* empty: all is well */
};

/* image: of the flash from its beginning, image_bytes of it; exact: instruction steps, which give every verdict and fault its exact address.
 * NULL with the reason in err. */
struct board *board_new(const struct chip *chip, const struct surroundings *around,
                        const uint8_t *image, size_t image_bytes, bool exact, char *err,
                        size_t err_size);
void board_free(struct board *b);

/* Power comes on, or has come back: flags say power-on. Memory holds random bits after a power-on (unverified). */
void board_power_on(struct board *b);
/* Runs until the time, a verdict, or board_pause(). */
void board_run(struct board *b, uint64_t until_ns);
void board_run_to_cycle(struct board *b, uint64_t cycle);
void board_pause(struct board *b);
/* A reset at the next block. */
void board_ask_reset(struct board *b, enum board_reset kind);

/* The supply has gone, or a reset is held; then it ends. forgets: memory holds random bits. */
void board_hold(struct board *b, enum board_reset kind);
void board_release(struct board *b, enum board_reset kind, bool forgets);

const char *board_reset_name(enum board_reset kind);

uint64_t board_ns(const struct board *b);
uint64_t
board_internal_hz(const struct board *b); /* of the chip's own oscillator, with its error */
uint64_t board_cycles_at(const struct board *b,
                         uint64_t ns); /* the first cycle that is not before ns */
void board_set_core_hz(struct board *b, uint64_t hz);

void board_add_event(struct board *b, struct board_event *e);
void board_schedule(struct board *b, struct board_event *e, uint64_t at_ns); /* BOARD_NEVER: not */
void board_run_events(struct board *b);

/* The first one counts. */
void board_verdict(struct board *b, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A line of the diary: the time, and this. */
void board_note(struct board *b, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A generator of random words (xorshift64*): its state after a seed, and the next word. */
uint64_t random_state(uint64_t seed);
uint32_t random_word(uint64_t *state);
uint32_t board_random(struct board *b);

size_t line_give(struct board *b, unsigned line, const uint8_t *bytes,
                 size_t n); /* returns how many there was room for */
size_t line_take(struct board *b, unsigned line, uint8_t *bytes, size_t size);

#endif
