/* The board's own time. Plant time is another thing: it comes with the samples (hal/io.h). */
#ifndef REFLUX_HAL_CLOCK_H
#define REFLUX_HAL_CLOCK_H

#include <stdint.h>

/* Monotonic milliseconds since start. Used for link silence, time-outs of the console and the watchdog only:
 * never for control. Callable from both contexts. */
uint64_t hal_clock_ms(void);

/* Free-running cycle counter for measuring code, wraps at 2^32. Its meaning is hal_cycles_unit(). */
uint32_t hal_cycles(void);

/* Names the unit of one count of hal_cycles() on this board in this run: "cycles", "ns", "none", or "model ticks" of an
 * emulator's timer (instructions when the emulator counts them, else time of the host). */
const char *hal_cycles_unit(void);

/* Core clock found at start, hertz (0 = not applicable) and how it was arrived at, for `version`. */
uint32_t hal_core_hz(void);
const char *hal_clock_source(void);

#endif
