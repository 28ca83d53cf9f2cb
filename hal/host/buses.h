/* What is at the pins of a board that is a program (host_sim/chips/world.h). Where nobody gives a world, buses answer like wires without a
 * device.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_HAL_HOST_BUSES_H
#define REFLUX_HAL_HOST_BUSES_H

#include "chips/world.h"

/* The world lives longer than the board; NULL: nothing is there any more. */
void buses_set_world(const struct world *world);

/* What is wired to an input has another level from now on. A falling edge counts as a pulse. */
void buses_set_pin(unsigned pin, enum pin_level level);

/* The board's clock has turned: counts the edges that have come since, and converts each analogue input that is open. Once a millisecond, before the
 * world changes. */
void buses_clock(void);

/* A reset of the board: all pins are inputs. */
void buses_reset(void);

#endif
