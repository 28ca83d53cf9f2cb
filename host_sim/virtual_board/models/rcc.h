/* What the clock controls of both chips share.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_RCC_H
#define REFLUX_VIRTUAL_BOARD_RCC_H

#include "models.h"

/* RCC_CR: its offset and its ready bits. */
#define CR        0x00u
#define CR_HSIRDY (UINT32_C(1) << 1)
#define CR_HSERDY (UINT32_C(1) << 17)
#define CR_PLLRDY (UINT32_C(1) << 25)

/* Writes SWS of RCC_CFGR, at that offset, as SW asks, if that clock is ready. Returns whether the core has another clock now. */
bool clock_switches(struct part *rcc, uint32_t cfgr_offset);

/* After a write of the register of resets at this offset: a part is reset while its bit is set, which has the place of its bit in the register of
 * enables at the other (RM0090 7.3.8 and 7.3.9, RM0041 6.3.4 and 6.3.5). */
void reset_parts(const struct part *rcc, uint32_t offset, uint32_t enable);

#endif
