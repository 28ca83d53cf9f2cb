/* Telemetry: one row a tick, captured whole in the tick, printed as CSV by the main loop.
 *
 *     H,1,number,time[s],state,ev,<meas>[unit],<meas>.q,...,<loop>.mode,<loop>.sp[unit],...,
 *         <mv>.cmd[unit],<mv>.app[unit],...,stat.tick
 *     T,1,...                                    the same number of fields
 *
 * With rows of sequences `ev` is followed by seq (enum sequence_state) and step (0: none); with an offset a
 * measurement's .q is followed by .off (what is subtracted now), and with `every` above 1 then by .new (1: a reading of it
 * was looked at in this tick).
 * state: 0 safe, 1 run. ev: events so far. <meas>: validated and filtered. q: enum quality. mode: 0 manual,
 * 1 auto, 2 cascade. cmd: asked for by control; app: applied, after limits, interlocks and read-back.
 * stat. columns measure the board, not the process, and differ from run to run. Numbers have nine digits:
 * they read back as the same float.
 */
#ifndef REFLUX_SERVICE_TELEMETRY_H
#define REFLUX_SERVICE_TELEMETRY_H

#include "base/text.h"
#include "supervise/supervisor.h"

#define TELEMETRY_FORMAT 1
#ifndef TELEMETRY_QUEUE_SIZE
#define TELEMETRY_QUEUE_SIZE 8 /* power of two */
#endif
/* Header and row are written piece by piece, so that a line may be longer than any buffer. */
/* In characters: all columns of a channel with the longest names. */
#define TELEMETRY_PIECE_MAX (CONFIG_ANALYSERS ? 112 : 96)

struct telemetry_row {
    const struct plan *plan; /* in force when captured: the columns */
    uint32_t number;
    uint64_t time_ms;
    uint8_t state;
    uint8_t sequence, step; /* enum sequence_state; row from 1, 0: none */
    uint32_t events;
    uint32_t cycles; /* of this tick */
    float measurement[CHANNEL_MAX];
    uint8_t quality[CHANNEL_MAX];
    uint8_t mode[CONFIG_LOOPS];
    uint16_t offsets; /* switched on, a bit for each measurement */
    uint16_t fresh;   /* a bit for each measurement */
    float setpoint[CONFIG_LOOPS];
    float commanded[CHANNEL_MAX], applied[CHANNEL_MAX];
};

struct telemetry {
    uint32_t every; /* ticks between rows, 0 = off; written by the main loop */
    struct spsc index;
    struct telemetry_row slot[TELEMETRY_QUEUE_SIZE];
    uint32_t lost;
    /* A header or row is half printed: the plan it belongs to stays where it is. Main loop. */
    bool printing;
};

void telemetry_init(struct telemetry *t);

/* Tick context: captures a row when one is due. */
void telemetry_capture(struct telemetry *t, const struct supervisor *s, uint32_t number,
                       uint32_t events, uint32_t cycles);

/* Rows captured under one plan read the same under the other. */
bool telemetry_same_columns(const struct plan *a, const struct plan *b);

/* Main loop: puts piece n of the header for a plan, or of a row, into *piece (empty where a channel is not
 * used); false past the end of the line. */
bool telemetry_header(const struct plan *plan, unsigned n, struct text *piece);
bool telemetry_row(const struct telemetry_row *row, unsigned n, struct text *piece);

#endif
