/* Power control of the STM32F405: voltage detector, regulator scale. Read in RM0090 Rev 21: 5.4; in DS8626: 5.3.5, table 19. PWR_CSR_VOSRDY,
 * which reads 0 here, follows PWR_CR_VOS on a chip (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "models.h"

enum { CR = 0x0, CSR = 0x4 };

static const struct reg regs[] = {
    {"CR", CR, 0x00004000u, 0x000043FFu, 0x000043F3u},
    {"CSR", CSR, 0, 0x0000430Fu, 0x00000300u},
};

/* DS8626 table 19, typical: for a falling supply, and for a rising one. */
static const uint16_t falling_mv[] = {2040, 2190, 2350, 2510, 2660, 2840, 2930, 3030};
static const uint16_t rising_mv[] = {2140, 2300, 2450, 2600, 2760, 2930, 3030, 3140};

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    if (offset != CSR)
        return stored;
    uint32_t pls = part_get(p, CR) >> 5 & 7u;
    return stored | voltage_detector(p, part_get(p, CR), falling_mv[pls], rising_mv[pls]);
}

const struct part_class power_f4_class = {.name = "PWR of the STM32F4",
                                          .regs = regs,
                                          .n_regs = 2,
                                          .state_bytes = sizeof(struct voltage_detector),
                                          .widths = WIDTH_HALF | WIDTH_WORD,
                                          .reset = voltage_detector_reset,
                                          .read = read};
