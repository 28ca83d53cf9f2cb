/* Runtime assertions: conditions that must hold whatever a client asks of the firmware. They guard indices into the arena, slots,
 * members and queues, and the default branches of state machines. They are on in host builds, under sanitizers and fuzzers, and in
 * the image stm32f405-assert, which runs in the emulator beside the flashed one. They are off in the flashed images.
 *
 * Never assert anything about input from outside. The firmware checks settings, lines, frames and stored bytes, and refuses them
 * with a reason. */
#ifndef REFLUX_BASE_ASSERTION_H
#define REFLUX_BASE_ASSERTION_H

#if REFLUX_ASSERTIONS
#define REFLUX_ASSERT(holds)                                                                       \
    ((holds) ? (void)0 : assertion_failed(#holds, __FILE__, (unsigned)__LINE__))
/* Reports the condition and ends the program. On a board it ends with a fault, whose record names the place. */
_Noreturn void assertion_failed(const char *text, const char *file, unsigned line);
/* Called before the program ends, where it is set. A host process prints the condition. */
extern void (*assertion_report)(const char *text, const char *file, unsigned line);
#else
#define REFLUX_ASSERT(holds) ((void)0)
#endif

#endif
