/* What must hold whatever is asked of the firmware: indices into the arena, slots, members and queues, and states that a state machine
 * does not have. On in host builds, under sanitizers and fuzzers, and in the image stm32f405-assert, which runs in the emulator
 * beside the flashed one; off in the flashed images.
 *
 * Never for what comes from outside: settings, lines, frames and stored bytes are checked, and refused with a reason. */
#ifndef REFLUX_BASE_ASSERTION_H
#define REFLUX_BASE_ASSERTION_H

#if REFLUX_ASSERTIONS
#define REFLUX_ASSERT(holds)                                                                       \
    ((holds) ? (void)0 : assertion_failed(#holds, __FILE__, (unsigned)__LINE__))
/* Reports, and ends the program: on a board by a fault, whose record names the place. */
_Noreturn void assertion_failed(const char *text, const char *file, unsigned line);
/* Told first, where it is set: a host process prints. */
extern void (*assertion_report)(const char *text, const char *file, unsigned line);
#else
#define REFLUX_ASSERT(holds) ((void)0)
#endif

#endif
