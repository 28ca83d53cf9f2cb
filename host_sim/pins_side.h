/* The plant's side of a board's own pins: what the sensors of a wiring file measure, and what its loads do to the plant.
 *
 * A tick of the plant is a tick of the board's clock: what sensors measure holds over it, and the plant then goes on with the mean of what each
 * load was. Ticks begin just before whole multiples of the tick of the firmware's clock, where it takes its sample.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_HOST_SIM_PINS_SIDE_H
#define REFLUX_HOST_SIM_PINS_SIDE_H

#include "bench/transport.h"
#include "chips/wiring.h"
#include "link/messages.h"
#include "plants/plant.h"

#define PINS_NONE 0xFFu
/* What a board does in a millisecond of its clock it has done so long after it: then its loads are read. */
#define PINS_DONE_NS UINT64_C(200000)

struct pins_side {
    struct transport *port;
    const struct wiring *wiring;
    uint8_t sensor_of
        [LINK_CHANNELS_MAX]; /* first line of the wiring for each measurement; PINS_NONE: none */
    uint8_t output_of[LINK_CHANNELS_MAX]; /* likewise for each manipulated variable */
    size_t n_measurements, n_outputs;
    double loads_ns[LINK_CHANNELS_MAX]; /* at the beginning of the tick */
    uint64_t tick_ms, begin_ns, end_ns;
};

/* Has the board at the port connected as the wiring says, which was read from the file and lives longer. False, with a sentence in err: the
 * wiring has nothing of the plant, or the board has no pins. */
bool pins_side_open(struct pins_side *p, struct transport *port, const struct wiring *wiring,
                    const char *file, const struct plant_class *class, uint32_t tick_ms,
                    uint64_t seed, char *err, size_t err_size);

/* Whether this manipulated variable, by its number in the plant, is a load that is switched on and off: it has no speed but its own. */
bool pins_side_switches(const struct pins_side *p, size_t output);

/* Drops what the board says on the link, where nobody listens. */
void pins_side_turn(struct pins_side *p);

/* Gives the sensors these readings until the firmware's clock is a whole multiple of PINS_START_MS, or of the least multiple of the tick that is
 * not shorter: however long a board took to get its settings, plant time then begins at the same moment of its clock, in which it takes a sample,
 * and windows of outputs in the same place. */
#define PINS_START_MS 30000u
void pins_side_set_up(struct pins_side *p, const struct link_sample *sample);
/* Whether the clock is there. It is not where it stood meanwhile, as while the flash is erased. */
bool pins_side_is_set_up(const struct pins_side *p);

/* While plant time has not begun: goes on until the board has taken its next sample. */
void pins_side_next_sample(struct pins_side *p);

/* Once the clock is there: all that pulses or bounces counts its time from now on. flows: plant time begins; else nothing flows through meters until
 * it does. The mains do not notice the second time, because there are whole cycles between the two. */
void pins_side_count(struct pins_side *p, bool flows);

/* Begins a tick with these readings. Its first part ends when the board has taken its sample; pins_side_go_on() begins the second. */
void pins_side_begin(struct pins_side *p, const struct link_sample *sample);
void pins_side_go_on(struct pins_side *p);

/* Ms that are left of this part; 0: it is over. */
uint64_t pins_side_left(const struct pins_side *p);

/* Ends it: what the loads were, as commands in the plant's units. False: the board is gone. */
bool pins_side_end(struct pins_side *p, struct link_command *command);

#endif
