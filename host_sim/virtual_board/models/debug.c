/* Debug registers identify the chip and choose what stops with a halted core. Read in RM0090 Rev 21: 38.16.4 and 38.16.5; in RM0041 Rev 6: 25.6.1.
 * Masks: ST's device header (STM32F405), the vendor's SVD file (STM32F100). Only a power-on resets these registers (38.16). On the STM32F100, too,
 * only a power-on resets DBGMCU_CR (unverified). The STM32F405 of the board is of revision 0x1007, and the reserved bits of its DBGMCU_IDCODE
 * hold 6 (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "models.h"

static const struct reg f4[] = {
    {"IDCODE", 0x0, 0x10076413u, UINT32_MAX, 0},
    {"CR", 0x4, 0, 0xE7u, 0xE7u},
    {"APB1_FZ", 0x8, 0, 0x06E01DFFu, 0x06E01DFFu},
    {"APB2_FZ", 0xC, 0, 0x00070003u, 0x00070003u},
};

static const struct reg f1[] = {
    {"IDCODE", 0x0, 0x10010420u, UINT32_MAX, 0}, /* low and medium density value line, revision Z */
    {"CR", 0x4, 0, 0x0FDDBFE7u, 0x0FDDBFE7u},
};

static void reset(struct part *p, enum board_reset kind)
{
    for (size_t k = 0; kind == RESET_POWER && k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
}

const struct part_class debug_f4_class = {.name = "debug of the STM32F4",
                                          .regs = f4,
                                          .n_regs = sizeof(f4) / sizeof(f4[0]),
                                          .widths = WIDTH_WORD,
                                          .reset = reset};
const struct part_class debug_f1_class = {.name = "debug of the STM32F1",
                                          .regs = f1,
                                          .n_regs = sizeof(f1) / sizeof(f1[0]),
                                          .widths = WIDTH_WORD,
                                          .reset = reset};
