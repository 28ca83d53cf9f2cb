/* Power control of the STM32F405 (RM0090 5.4): voltage detector, regulator scale.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "models.h"

enum { CR = 0x0, CSR = 0x4 };

#define CR_PVDE  (UINT32_C(1) << 4)
#define CSR_PVDO (UINT32_C(1) << 2)

static const struct reg regs[] = {
    {"CR", CR, 0x00004000u, 0x000043FFu, 0x000043F3u},
    {"CSR", CSR, 0, 0x0000430Fu, 0x00000300u},
};

/* RM0090 5.4.1, PLS: 2.0 to 2.7 V in the manual's words; DS8626 has 2.71 V falling and 2.80 V rising for 6, typical: one threshold here. */
static uint32_t threshold_mv(uint32_t pls)
{
    static const uint16_t mv[] = {2080, 2210, 2360, 2530, 2640, 2760, 2890, 3000};
    return mv[pls & 7u];
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    uint32_t cr = part_get(p, CR);
    if (offset != CSR || (cr & CR_PVDE) == 0)
        return stored;
    return p->board->around.supply_mv < threshold_mv(cr >> 5) ? stored | CSR_PVDO : stored;
}

const struct part_class power_f4_class = {.name = "PWR of the STM32F4",
                                          .regs = regs,
                                          .n_regs = 2,
                                          .widths = WIDTH_HALF | WIDTH_WORD,
                                          .read = read};
