/* A board in memory: the firmware in the same process as whoever tests or simulates around it. The bytes that
 * cross are those of the real lines; only the wire is missing. One instance a process.
 */
#ifndef REFLUX_HAL_MEMORY_PORT_H
#define REFLUX_HAL_MEMORY_PORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/identity.h"
#include "hal/image.h"
#include "hal/uart.h"

/* Powers the board on: rings empty, clock 0, next boot id, firmware initialised. Flash is kept, the retained
 * memory (hal/retained.h) is not. */
void memory_port_start(void);

/* Sets the board's clock, ms, not backwards. Nothing happens until memory_port_run(). */
void memory_port_set_clock(uint64_t ms);
/* The clock is at this time at once: nothing turns in the time between. Towards the end of its 32 bits, 49.7 days. */
void memory_port_jump(uint64_t ms);

/* Bytes arriving on a line; returns how many found room (the rest are counted as dropped). */
size_t memory_port_give(enum hal_uart port, const void *data, size_t n);
/* A byte that arrived damaged: dropped and counted as a line error, as the boards' ports do. */
void memory_port_damage(enum hal_uart port);
/* Bytes the firmware sent; returns how many were taken. */
size_t memory_port_take(enum hal_uart port, void *data, size_t size);

/* Lets both contexts run until no more bytes move. A reboot asked for by the firmware happens inside, like
 * the real one: everything but flash starts again. Returns the turns it took. */
unsigned memory_port_run(void);

/* Sets the action of hal_tick_lock and hal_tick_unlock, for a caller who lets the tick context interrupt the main loop (app_tick from a
 * signal): NULL, as at the beginning, does nothing, which is right where both are called in turn. */
void memory_port_set_tick_lock(void (*lock)(void), void (*unlock)(void));

/* One turn of both contexts and no more: for who measures time by turns. */
void memory_port_turn(void);

/* Sizes of the console's rings from the next start on: powers of two up to 16384. */
void memory_port_set_console_rings(uint32_t rx, uint32_t tx);

unsigned memory_port_reboots(void);

/* Every look at hal_cycles() finds it so much further on; 0, as at the beginning: it stands. */
void memory_port_count_looks(uint32_t step);

/* While the firmware sends the next frame on the link the clock goes on by so much, ms: its tick takes time. */
void memory_port_slow_frame(uint32_t ms);
/* The longest time without a feeding of the watchdog, ms, since the start or since it was last asked for. */
uint64_t memory_port_unfed_ms(void);

/* A reset from outside, as by a watchdog: flash and the retained memory are kept. */
void memory_port_reset(enum hal_reset reason);

/* Sets the fault record that the port keeps from now on; NULL: none. */
void memory_port_set_fault(const struct hal_fault *what);

/* Sets the result of the image check from the next start on. */
void memory_port_set_image(enum hal_image state);

/* Flash as tests want it: contents (memory_port_flash_size() bytes), all erased by memory_port_erase_all(). */
uint8_t *memory_port_flash(void);
size_t memory_port_flash_size(void);
void memory_port_erase_all(void);

#endif
