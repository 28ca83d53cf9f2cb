/* Telemetry: the tick captures whole rows, and the main loop prints them as CSV.
 *
 *     H,1,number,time[s],state,ev,<meas>[unit],<meas>.q,...,<loop>.mode,<loop>.sp[unit],...,
 *         <mv>.cmd[unit],<mv>.app[unit],...,stat.tick
 *     T,1,...                                    the same number of fields
 *
 * With rows of sequences, seq (enum sequence_state) and step (0: none) follow `ev`. With an offset, .off (EU subtracted
 * in this tick) follows the .q of a measurement. With `every` above 1, .new follows then (1: the tick used a new reading).
 * state: 0 safe, 1 run. ev: events so far. <meas>: validated and filtered. q: enum quality. mode: 0 manual,
 * 1 auto, 2 cascade. cmd: output of control; app: applied output, after limits, interlocks and read-back.
 * stat. columns measure the board, not the process, and differ from run to run. Numbers have nine digits, so they read
 * back as the same float.
 */
#ifndef REFLUX_SERVICE_TELEMETRY_H
#define REFLUX_SERVICE_TELEMETRY_H

#include "base/text.h"
#include "supervise/supervisor.h"

#define TELEMETRY_FORMAT 1
#ifndef TELEMETRY_QUEUE_SIZE
#define TELEMETRY_QUEUE_SIZE 8 /* power of two */
#endif
/* Characters of the longest piece: all columns of a channel with the longest names. Header and row are written piece by piece,
 * so that a line may be longer than any buffer. */
#define TELEMETRY_PIECE_MAX (CONFIG_ANALYSERS ? 112 : 96)

struct telemetry_row {
    const struct plan *plan; /* plan in force at the capture; it gives the columns */
    uint32_t number;
    uint64_t time_ms;
    uint8_t state;
    uint8_t sequence, step; /* enum sequence_state; row from 1, 0: none */
    uint32_t events;
    uint32_t cycles; /* cost of this tick, counts of hal_cycles() */
    float measurement[CHANNEL_MAX];
    uint8_t quality[CHANNEL_MAX];
    uint8_t mode[CONFIG_LOOPS];
    uint16_t offsets; /* bit i: the offset of measurement i is on */
    uint16_t fresh;   /* bit i: measurement i has a new reading */
    float setpoint[CONFIG_LOOPS];
    float commanded[CHANNEL_MAX], applied[CHANNEL_MAX];
};

struct telemetry {
    uint32_t every; /* ticks between rows, 0 = off; written by the main loop */
    struct spsc index;
    struct telemetry_row slot[TELEMETRY_QUEUE_SIZE];
    uint32_t lost;
    /* A header or row is half printed, so its plan must stay unchanged. The main loop writes it. */
    bool printing;
};

void telemetry_init(struct telemetry *t);

/* Captures a row when one is due. Tick context. */
void telemetry_capture(struct telemetry *t, const struct supervisor *s, uint32_t number,
                       uint32_t events, uint32_t cycles);

/* Returns whether rows captured under one plan read the same under the other. */
bool telemetry_same_columns(const struct plan *a, const struct plan *b);

/* Writes piece n of the header for a plan, or of a row, into *piece; nothing where a channel is not used. Returns false
 * past the end of the line. Main loop. */
bool telemetry_header(const struct plan *plan, unsigned n, struct text *piece);
bool telemetry_row(const struct telemetry_row *row, unsigned n, struct text *piece);

#endif
