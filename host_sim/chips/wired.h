/* The world of a board (chips/world.h) made of a wiring file: chips on its buses, loads at its outputs.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_CHIPS_WIRED_H
#define REFLUX_CHIPS_WIRED_H

#include "chips/wiring.h"
#include "chips/world.h"

#define WIRED_OUTPUTS_MAX 16u

struct wired;

/* Reads the file and connects its chips, which have power from the first moment on. NULL, with a sentence in err. */
struct wired *wired_open(const char *path, uint64_t seed, char *err, size_t err_size);
void wired_close(struct wired *w);

/* For the port or the model of the board. */
const struct world *wired_world(struct wired *w);
const struct wiring *wired_wiring(const struct wired *w);

/* In place of a sensor: pulses, contacts and the mains count their time anew from this moment, soon after the board's clock has turned
 * (chips/at_pin.h). 0: nothing flows through meters; 1: it does, plant time begins. Who never says so begins with 1 at power-on. */
#define WIRED_TIME "-"

/* Gives the sensor of this name the value of its quantity from this moment on. */
void wired_measure(struct wired *w, uint64_t now_ns, const char *sensor, double value);

/* Sets a fault from this moment on: as wiring_fault(). */
bool wired_fault(struct wired *w, uint64_t now_ns, const char *name, const char *what, double value,
                 char *err, size_t err_size);

/* How long each load has been on since the beginning, ns; of a valve with two pins and of a load behind a chip the integral of its
 * position, 0 to 1; of a stepper that of its flow as a part of hi. ns: one number for each
 * output of the wiring, whose number is returned. */
size_t wired_loads(struct wired *w, uint64_t now_ns, double *ns);

/* Carries out and takes out the lines "pins.NAME VALUE" and "pins.NAME.FAULT VALUE" of a text of n bytes. Returns the bytes that are left;
 * SIZE_MAX, with a sentence in err, where it cannot. */
size_t wired_lines(struct wired *w, uint64_t now_ns, char *text, size_t n, char *err,
                   size_t err_size);

#endif
