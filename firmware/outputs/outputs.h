/* Outputs of the board: they turn commands into pins, once a millisecond.
 *
 * Contexts
 *     main loop or tick: outputs_open(), before the clock runs or while it does
 *     tick:              outputs_command(), outputs_stuck(), outputs_readback(), outputs_report()
 *     main loop:         outputs_safe(), outputs_resume(), outputs_report()
 *     board clock:       outputs_clock(), which interrupts all the others and is interrupted by none of them
 * A command reaches the clock in one word, so that the clock sees all of it or nothing.
 *
 * Safety
 *  1. Dead man. Where the tick has not given an output a command for settings.dead_man, it goes to its safe position: off, or for a motor
 *     valve and an analogue output settings.safe. The next command ends that. The tick must therefore repeat its commands, also the same
 *     ones, at least twice in the shortest dead man's time, and only as long as it is well.
 *  2. An output of type `enable`, a contactor in series with all heaters, is on only while clock, tick and main loop have each turned within
 *     OUTPUTS_REPORT_MS and no heater is said to be stuck on. Outputs with settings.heater are off while it is off, and read back so.
 *  3. Where the clock itself stands, nothing here runs: the watchdog resets the chip, and pull resistors hold the pins off (hal/output.h).
 *     A chip on a bus falls by its clear pin, which is such a pin.
 *  4. outputs_safe() switches everything off at once, until outputs_resume().
 * Going to the safe position does not wait for a least time on. A least time off is kept always.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_OUTPUTS_OUTPUTS_H
#define REFLUX_OUTPUTS_OUTPUTS_H

#include "base/error.h"
#include "outputs/output_settings.h"

#define OUTPUTS_REPORT_MS 1000u

/* What rules an output at the moment. The enable output has OUTPUT_COMMANDED while it may be on, and OUTPUT_DEAD_MAN where somebody has not
 * reported or a heater is stuck on. */
enum output_rule {
    OUTPUT_UNUSED,    /* there is no such output */
    OUTPUT_COMMANDED, /* the tick */
    OUTPUT_NO_DRIVER, /* nobody: the tick says so. It is in its safe position, or on its way there. */
    OUTPUT_DEAD_MAN, /* no command for too long; also before the first one. It is in its safe position, or on its way there. */
    OUTPUT_NO_ENABLE, /* a heater, while the enable output is off */
    OUTPUT_SAFE       /* outputs_safe() */
};

enum output_reporter { OUTPUTS_TICK, OUTPUTS_MAIN_LOOP, OUTPUTS_REPORTERS };

/* Closes all outputs and opens these; the settings have passed output_check() and need not stay. On an error all are closed, and *failed is
 * the index of the output that could not be opened. Errors of hal/output.h. */
MUST_CHECK enum err outputs_open(const struct output_settings *settings, uint8_t n,
                                 uint8_t *failed);

/* Tick. The command for output `index` < OUTPUTS_MAX, fraction of its span, cut at 0 and 1; a NaN counts as not driven. drive: false if nobody
 * drives the output. */
void outputs_command(uint8_t index, bool drive, float fraction);

/* Tick. Says whether this output seems to be on although it is told to be off. True drops the enable output. */
void outputs_stuck(uint8_t index, bool stuck);

/* Tick and main loop, each for itself: it has turned. */
void outputs_report(enum output_reporter who);

/* Tick. Mean of what the output really was since the call before (since it was opened), as a fraction of its span: time on, pulse width,
 * steps made, position of a valve as reckoned. From whole milliseconds, so that host and chip give the same bits. 0 where no millisecond
 * has passed, or for an output that is not used. */
float outputs_readback(uint8_t index);

enum output_rule outputs_rule(uint8_t index);

/* Bits of enum output_fault (outputs/output_kind.h). */
uint8_t outputs_faults(uint8_t index);

/* Tick. Frequency of the mains, Hz, that a burst output measures at its zero crossings; 0: none, or none that can be the mains. */
float outputs_mains(uint8_t index);

/* Board clock. now_ms: its milliseconds, which wrap. The first turn after outputs_open() only begins to count. Turns
 * without a new millisecond do nothing; lost milliseconds are made up for. */
void outputs_clock(uint32_t now_ms);

/* Switches all outputs off at once and keeps them so until outputs_resume(): around an erase of the flash, in which nothing here runs.
 * Any context. */
void outputs_safe(void);
void outputs_resume(void);

#endif
