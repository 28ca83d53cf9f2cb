/* What the processor asks of its interrupt controller and system control space (system_control.c).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_INTERRUPTS_H
#define REFLUX_VIRTUAL_BOARD_INTERRUPTS_H

#include "chip.h"

enum {
    EXCEPTION_NMI = 2,
    EXCEPTION_HARD_FAULT = 3,
    EXCEPTION_MEM_MANAGE = 4,
    EXCEPTION_BUS_FAULT = 5,
    EXCEPTION_USAGE_FAULT = 6,
    EXCEPTION_PENDSV = 14,
    EXCEPTION_SYSTICK = 15,
    EXCEPTION_IRQ0 = 16
};

/* Bits of CFSR (PM0214 Rev 10 4.4.10 to 4.4.13) */
#define CFSR_IACCVIOL   (UINT32_C(1) << 0)
#define CFSR_DACCVIOL   (UINT32_C(1) << 1)
#define CFSR_MMARVALID  (UINT32_C(1) << 7)
#define CFSR_IBUSERR    (UINT32_C(1) << 8)
#define CFSR_PRECISERR  (UINT32_C(1) << 9)
#define CFSR_UNSTKERR   (UINT32_C(1) << 11)
#define CFSR_STKERR     (UINT32_C(1) << 12)
#define CFSR_BFARVALID  (UINT32_C(1) << 15)
#define CFSR_UNDEFINSTR (UINT32_C(1) << 16)
#define CFSR_INVSTATE   (UINT32_C(1) << 17)
#define CFSR_INVPC      (UINT32_C(1) << 18)
#define CFSR_NOCP       (UINT32_C(1) << 19)
#define CFSR_DIVBYZERO  (UINT32_C(1) << 25)

/* Masks as the core holds them. */
struct masks {
    bool primask, faultmask;
    uint8_t basepri;
};

/* The most urgent exception that is pending and may interrupt what runs; 0: none. With asleep, PRIMASK counts for nothing. */
unsigned interrupts_pick(const struct interrupts *i, struct masks masks, bool asleep);
bool interrupts_any(const struct interrupts *i); /* something is pending, masked or not */
void interrupts_enter(struct interrupts *i, unsigned exception);
/* Returns false: none is active, or not this one. */
bool interrupts_leave(struct interrupts *i, unsigned exception);
unsigned interrupts_active(const struct interrupts *i); /* 0: none */
unsigned interrupts_depth(const struct interrupts *i);
/* A fault of what runs now: notes its status and address. Returns the exception to enter at once; 0: locked up. */
unsigned interrupts_fault(struct interrupts *i, struct masks masks, unsigned exception,
                          uint32_t status, uint32_t address);
uint32_t interrupts_vectors(const struct interrupts *i);
bool interrupts_align_stack(const struct interrupts *i);
bool interrupts_divide_traps(const struct interrupts *i);
bool interrupts_fpu_on(const struct interrupts *i);

/* Regions that nobody may reach; n of them at most. Ends the run where a region is of a form that is not modelled. */
struct forbidden {
    uint32_t base, size;
};
size_t interrupts_forbidden(const struct interrupts *i, struct forbidden *list, size_t n);

uint64_t systick_next(const struct interrupts *i); /* cycles; BOARD_NEVER: off */
void systick_run(struct interrupts *i);

#endif
