/* The whole firmware on the board in memory for fuzz targets: a console that counts replies and a plant that
 * answers greetings, remembers what it sent and demands that every command answers a sample. */
#ifndef REFLUX_TESTS_FUZZ_BOARD_H
#define REFLUX_TESTS_FUZZ_BOARD_H

#include <stdbool.h>

#include "fuzz.h"
#include "link/messages.h"

/* Powered on with empty flash, in machine mode; `loops`: configured with two loops, a plant connected, two
 * samples in. */
void fuzz_start(bool loops);
/* The first half of it: powered on with the flash as it is, in machine mode. */
void fuzz_power_on(void);

void fuzz_type(const void *text, size_t n); /* bytes into the console, as fast as they are taken */
void fuzz_link(const void *bytes, size_t n);
void fuzz_frame(struct frame *f); /* sequence and CRC as they should be */
void fuzz_sample(struct feed *f, bool again);
/* So many samples of a plant that answers to its outputs. */
void fuzz_stretch(unsigned n);
void fuzz_pass(uint64_t ms);
unsigned fuzz_reboots(void); /* since fuzz_start() */

/* Replies ended with `ok` or `err` since the last call. */
unsigned fuzz_replies(void);
/* ... those with `err` alone. */
unsigned fuzz_refusals(void);
/* A checksum of what `dump` shows. */
uint32_t fuzz_settings(void);
/* ... and whether in that a block was without its record though its kind is known. */
bool fuzz_had_no_room(void);

/* After any input: the console answers, what it shows as set is what it accepts, and the plan in force can be
 * built from it. */
void fuzz_settings_are_sound(void);
/* It costs as much as ten inputs: whether this is one of the eighth it is done for. */
bool fuzz_is_chosen(const uint8_t *data, size_t size);

#endif
