/* Timed events of a run: "T:NAME=VALUE", carried out before the first sample at or after plant time T.
 *
 *     600:zF=0.35        a disturbance of the plant, within its span
 *     600:F.swing=10     it swings by so much about its value from then on, a sine; 0 ends it
 *     600:F.period=1200  ... with this period, s
 *     900:Lr.hi=6.5      an option of a channel (see instruments.h, docs/inside/faults.md)
 *     1200:noise=2       the noise of all sensors, times their own
 *     900:board.power_cut=2   a fault of a virtual board (virtual_board/fault_table.h)
 *     900:T1.open=1      with a wiring file: a fault of a chip, of a bus (spi1.noise=1e-4) or of a load (Qrb.shorted=1), by the file's names
 *                        (chips/wiring.h); 0 takes it back
 *
 * Everything is checked before the run begins.
 */
#ifndef REFLUX_HOST_SIM_EVENTS_H
#define REFLUX_HOST_SIM_EVENTS_H

#include "bench/swings.h"
#include "bench/transport.h"
#include "chips/wiring.h"
#include "instruments.h"
#include "virtual_board/fault_table.h"

#define EVENTS_MAX      1024
#define EVENT_PINS_SIZE 40u /* "T1.overvoltage" */

struct event {
    double time_s;
    size_t channel;
    double value;
    enum {
        EVENT_DISTURBANCE,
        EVENT_SWING,
        EVENT_PERIOD,
        EVENT_OPTION,
        EVENT_NOISE,
        EVENT_BOARD,
        EVENT_PINS
    } kind;
    enum instrument_option option;
    enum fault_kind fault;
    char pins[EVENT_PINS_SIZE]; /* of EVENT_PINS: name and fault, "T1.open" */
};

struct events {
    struct event list[EVENTS_MAX];
    size_t n, next;
    struct swings swings;
    struct transport *board;     /* that faults of a board go to; NULL: none takes them */
    const struct wiring *wiring; /* of its pins; NULL: the plant is at the link */
};

/* Returns the name of the n-th option of a measurement or of a manipulated variable, and NULL past the last. */
const char *events_option(enum plant_kind kind, size_t n);

/* Is a fault of the board among them? */
bool events_want_board(const struct events *e);

/* Reads one event; false with one line saying what is wrong, where, and what would be right. */
bool events_add(struct events *e, const struct plant_class *class, const char *text, char *err,
                size_t err_size);

/* Sorts by time (same time: in the order given) and checks what only shows in order: limits that cross, swings that leave a
 * span. */
bool events_finish(struct events *e, const struct plant_class *class, char *err, size_t err_size);

/* Adds one event to a run that is under way: sorted in, checked, and refused as above. It is carried out at the first sample to come
 * when its time is past. Events that later ones have overridden make room. */
bool events_insert(struct events *e, const struct plant_class *class, const char *text, char *err,
                   size_t err_size);

/* Carries out everything due at time_s, once for each sample. Disturbances of one time count together, whatever their order. */
bool events_apply(struct events *e, double time_s, struct plant *plant, struct instruments *in,
                  char *err, size_t err_size);

#endif
