/* The programmable voltage detector of both chips (RM0090 Rev 21 5.2.3 and 5.4, RM0041 Rev 6 4.4): one comparator with a hysteresis. Between its
 * two thresholds it stays as it was when it was last looked at: a dip that nobody sees leaves no trace.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "models.h"

#define CR_PVDE  (UINT32_C(1) << 4)
#define CSR_PVDO (UINT32_C(1) << 2)

void voltage_detector_reset(struct part *p, enum board_reset kind)
{
    struct voltage_detector *d = p->state;
    (void)kind;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    d->low = false;
}

uint32_t voltage_detector(struct part *p, uint32_t cr, uint32_t falling_mv, uint32_t rising_mv)
{
    struct voltage_detector *d = p->state;
    uint32_t mv = p->board->around.supply_mv;
    if ((cr & CR_PVDE) == 0) {
        d->low = false;
        return 0;
    }
    d->low = mv < falling_mv || (d->low && mv < rising_mv);
    return d->low ? CSR_PVDO : 0;
}
