/* Registers of the system control space and what stands behind them: shared by interrupts.c, systick.c, protection_unit.c and
 * system_control.c.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_SYSTEM_CONTROL_H
#define REFLUX_VIRTUAL_BOARD_SYSTEM_CONTROL_H

#include "interrupts.h"

#define EXCEPTIONS 128u
#define DEPTH      16u

#define SYST_ENABLE    1u
#define SYST_INTERRUPT 2u
#define SYST_CORE      4u
#define SYST_COUNTED   (UINT32_C(1) << 16)

enum {
    SYST_CSR = 0x010,
    SYST_RVR = 0x014,
    SYST_CVR = 0x018,
    ISER = 0x100,
    ICER = 0x180,
    ISPR = 0x200,
    ICPR = 0x280,
    IPR = 0x400,
    CPUID = 0xD00,
    ICSR = 0xD04,
    VTOR = 0xD08,
    AIRCR = 0xD0C,
    SCR = 0xD10,
    CCR = 0xD14,
    SHPR1 = 0xD18,
    SHPR3 = 0xD20,
    SHCSR = 0xD24,
    CFSR = 0xD28,
    HFSR = 0xD2C,
    DFSR = 0xD30,
    MMFAR = 0xD34,
    BFAR = 0xD38,
    AFSR = 0xD3C,
    CPACR = 0xD88,
    MPU_TYPE = 0xD90,
    MPU_CTRL = 0xD94,
    MPU_RNR = 0xD98,
    MPU_RBAR = 0xD9C,
    MPU_RASR = 0xDA0,
    DHCSR = 0xDF0,
    DEMCR = 0xDFC,
    FPCCR = 0xF34,
    FPCAR = 0xF38,
    FPDSCR = 0xF3C
};

struct interrupts {
    struct board *board;
    struct part *control; /* registers */
    bool pending[EXCEPTIONS], line[EXCEPTIONS], enabled[EXCEPTIONS];
    uint64_t asking[EXCEPTIONS / 64]; /* pending or high, and enabled: a bit each */
    unsigned active[DEPTH], depth;
    uint64_t tick_next; /* cycles at which SysTick comes to 0 */
    bool tick_cleared;  /* SYST_CVR has been written since the reset */
    struct {
        uint32_t base, attributes;
    } region[16];
};

static inline uint32_t control_word(const struct interrupts *i, uint32_t offset)
{
    return part_get(i->control, offset);
}

/* interrupts.c: what runs has priority -1 or -2. */
bool interrupts_in_hard_fault(const struct interrupts *i);
/* After a change of what makes it ask. */
void interrupts_look_at(struct interrupts *i, unsigned n);
void interrupts_set_pending(struct interrupts *i, unsigned n, bool to);

/* systick.c */
uint32_t systick_count(const struct interrupts *i);
void systick_restart(struct interrupts *i);

/* protection_unit.c: after a write of MPU_CTRL, MPU_RBAR or MPU_RASR. */
void protection_write(struct part *p, uint32_t offset, uint32_t word);

#endif
