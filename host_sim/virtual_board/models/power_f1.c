/* Power control of the STM32F100: voltage detector, key to the backup domain. Read in RM0041 Rev 6: 4.4.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "models.h"

enum { CR = 0x0, CSR = 0x4 };

#define CR_DBP        (UINT32_C(1) << 8)
#define RCC_BDCR      0x20
#define BDCR_HSE_RTC  (UINT32_C(3) << 8)
#define BDCR_RTCEN    (UINT32_C(1) << 15)
#define HYSTERESIS_MV 100u

static const struct reg regs[] = {
    {"CR", CR, 0, 0x000001FFu, 0x000001F3u},
    {"CSR", CSR, 0, 0x00000107u, 0x00000100u},
};

/* 4.4.1 says 2.2 to 2.9 V in steps of 0.1 V. The detector's threshold is 0.12 V below that for a falling supply and 0.02 V for a rising one,
 * typical of DS5944 (unverified). */
static uint32_t falling_mv(uint32_t pls)
{
    return 2080u + 100u * (pls & 7u);
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    if (offset != CSR)
        return stored;
    uint32_t cr = part_get(p, CR), falling = falling_mv(cr >> 5);
    return stored | voltage_detector(p, cr, falling, falling + HYSTERESIS_MV);
}

/* 4.4.1: the key stays in while the crystal's 128th is the RTC's clock. */
static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    uint32_t bdcr = part_get(bus_part(p->board, "RCC"), RCC_BDCR);
    if (offset == CR && (before & ~written & CR_DBP) != 0 && (bdcr & BDCR_RTCEN) != 0 &&
        (bdcr & BDCR_HSE_RTC) == BDCR_HSE_RTC)
        board_verdict(p->board,
                      "PWR_CR_DBP cleared while the crystal's 128th is the clock of the RTC");
}

const struct part_class power_f1_class = {.name = "PWR of the STM32F1",
                                          .regs = regs,
                                          .n_regs = 2,
                                          .state_bytes = sizeof(struct voltage_detector),
                                          .widths = WIDTH_HALF | WIDTH_WORD,
                                          .reset = voltage_detector_reset,
                                          .read = read,
                                          .write = write};
