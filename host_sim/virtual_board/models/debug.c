/* What tells one chip from another (RM0090 38.6.1 and 38.16, RM0041 25.6.1).
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

const struct part_class debug_f4_class = {
    .name = "debug of the STM32F4", .regs = f4, .n_regs = 4, .widths = WIDTH_WORD};
