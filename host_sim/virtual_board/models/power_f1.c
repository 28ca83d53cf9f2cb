/* Power control of the STM32F100 (RM0041 4.4): voltage detector, key to the backup domain. From memory of the manual (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "models.h"

enum { CR = 0x0, CSR = 0x4 };

#define CR_PVDE  (UINT32_C(1) << 4)
#define CSR_PVDO (UINT32_C(1) << 2)

static const struct reg regs[] = {
    {"CR", CR, 0, 0x000001FFu, 0x000001F3u},
    {"CSR", CSR, 0, 0x00000107u, 0x00000100u},
};

/* RM0041 4.4.1, PLS: 2.2 to 2.9 V in steps of 0.1 V in the manual's words; DS5944 has 0.02 V less for a rising supply and 0.12 V less for a
 * falling one, typical (unverified): the falling one here. */
static uint32_t threshold_mv(uint32_t pls)
{
    return 2080u + 100u * (pls & 7u);
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    uint32_t cr = part_get(p, CR);
    if (offset != CSR || (cr & CR_PVDE) == 0)
        return stored;
    return p->board->around.supply_mv < threshold_mv(cr >> 5) ? stored | CSR_PVDO : stored;
}

const struct part_class power_f1_class = {.name = "PWR of the STM32F1",
                                          .regs = regs,
                                          .n_regs = 2,
                                          .widths = WIDTH_HALF | WIDTH_WORD,
                                          .read = read};
