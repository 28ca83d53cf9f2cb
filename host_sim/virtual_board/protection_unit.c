/* The protection unit (PM0214 4.2): what it forbids.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "system_control.h"

#define MPU_ON        1u
#define MPU_REGION_ON 1u

/* PM0214 4.2: a region is 2^(SIZE + 1) bytes; access permission 0 is none at all. */
size_t interrupts_forbidden(const struct interrupts *i, struct forbidden *list, size_t n)
{
    size_t found = 0;
    if ((control_word(i, MPU_CTRL) & MPU_ON) == 0)
        return 0;
    for (uint32_t k = 0; k < i->board->chip->mpu_regions && found < n; k++) {
        uint32_t a = i->region[k].attributes;
        if ((a & MPU_REGION_ON) == 0)
            continue;
        if ((a >> 24 & 7u) != 0 || (a >> 8 & 0xFFu) != 0) {
            board_verdict(
                i->board,
                "region %u of the protection unit is of a form that is not modelled (0x%08x)", k,
                a);
            return 0;
        }
        list[found++] = (struct forbidden){.base = i->region[k].base & ~0x1Fu,
                                           .size = UINT32_C(2) << (a >> 1 & 0x1Fu)};
    }
    return found;
}

void protection_write(struct part *p, uint32_t offset, uint32_t word)
{
    struct interrupts *i = processor_interrupts(p->board);
    uint32_t number = part_get(p, MPU_RNR);
    if (p->board->chip->mpu_regions == 0 || number >= p->board->chip->mpu_regions) {
        board_verdict(p->board, "the protection unit has no region %u", number);
        return;
    }
    if (offset == MPU_RBAR && (word & 0x10u) != 0)
        board_verdict(p->board, "a region number within MPU_RBAR is not modelled");
    else if (offset == MPU_RBAR)
        i->region[number].base = word;
    else if (offset == MPU_RASR)
        i->region[number].attributes = word;
    processor_protection_changed(p->board);
}
