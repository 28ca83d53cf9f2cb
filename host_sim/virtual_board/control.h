/* One who decides how time goes on: over a unix socket, in steps, with the bytes of both lines. All numbers are little-endian.
 *
 *     to the board    u64 ns to run at most, u16 bytes for the console, u16 bytes for the link, u16 bytes of faults, then these bytes
 *     from the board  u64 ns since power first came on, u16, u16, u8 state (0 runs, 1 ended by a verdict or a
 *                     fault that it cannot have), u64 ns at which the firmware's clock began, u8 loads, then the bytes of console and link,
 *                     then u64 ns for each load (chips/wired.h)
 *
 * Faults are lines "NAME VALUE\n" of fault_table.h, for the moment at which the step begins; after_ns and after_instructions put the next
 * one later, to the instruction. With a wiring file, "pins.T1 78.3" gives a sensor its quantity, and "pins.T1.open 1" is a fault of its chip.
 *
 * A step ends early when bytes have left and the lines have been quiet for two byte times. So a run depends on nothing but what was sent.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_CONTROL_H
#define REFLUX_VIRTUAL_BOARD_CONTROL_H

#include "board.h"

/* Listens at path, serves one peer to its end. wired: what is at the pins; NULL: nothing. Returns the exit status; err says why it is not 0. */
struct wired;
int control_serve(struct board *b, struct wired *wired, const char *path, char *err,
                  size_t err_size);

/* Both lines as unix sockets, in step with the clock on the wall. Serves until *stop. */
int lines_serve(struct board *b, const char *console, const char *link, const volatile int *stop,
                char *err, size_t err_size);

#endif
