/* A board and a plant in the calling process, moved tick by tick: libreflux_lab.so. tools/reflux/in_process.py is the Python side.
 *
 * Rules
 *  1. One lab for each copy of the library in a process: the firmware has one instance. Who wants several loads copies of the file.
 *  2. Functions return a LAB_ code; reflux_lab_error() has one line that says what was wrong. After LAB_FAILED only the
 *     texts, the numbers and reflux_lab_close() are left.
 *  3. The run is that of reflux-sim (host_sim/lockstep.h): same calls, same log, bit for bit.
 *  4. One thread. */
#ifndef REFLUX_LAB_H
#define REFLUX_LAB_H

#include <stddef.h>
#include <stdint.h>

/* REFUSED: an option or an event is wrong, or the board answered `err`. */
enum { LAB_DONE, LAB_FAILED, LAB_REFUSED };

/* What is written while a lab runs: the simulator's log (CSV), telemetry (H, and T, lines), and each line of the console
 * with plant time and direction, as in --transcript. */
enum { LAB_LOG, LAB_TELEMETRY, LAB_CONSOLE, LAB_TEXTS };

/* Starts board and plant. Options are those of reflux-sim that describe plant and run (--plant --tick --seed --noise --start
 * --measure). The console is in machine mode; plant time is 0 and no sample has been taken. */
int32_t reflux_lab_open(int32_t n, const char *const *option);

/* Sends a console line and waits for its reply, which LAB_CONSOLE has. */
int32_t reflux_lab_say(const char *line);

/* Adds an event, "T:NAME=VALUE" as in --event: carried out before the first sample at or after T that is still to come. */
int32_t reflux_lab_event(const char *text);

/* Takes so many samples, each followed by a tick of the plant. */
int32_t reflux_lab_step(int32_t samples);

/* Plant time and number of the sample to come, and the interval. */
double reflux_lab_time_s(void);
uint32_t reflux_lab_number(void);
double reflux_lab_tick_s(void);

/* A channel of the plant: measurements as last sent, manipulated variables as they stand, others as the plant has them. NaN:
 * there is no such channel, or no sample yet. */
double reflux_lab_value(const char *channel);
/* Name, unit and kind (enum plant_kind) of channel k; NULL past the last. */
const char *reflux_lab_channel(int32_t k, const char **unit, int32_t *kind, double *lo, double *hi,
                               double *nominal);

/* What has been written since the last call; it lives until the next call for the same text. */
const char *reflux_lab_text(int32_t which, size_t *length);

const char *reflux_lab_error(void);

void reflux_lab_close(void);

#endif
