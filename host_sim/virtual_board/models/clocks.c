/* Clocks, asked for whatever the chip: each chip names the RCC's model that answers.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "rcc.h"

uint64_t bus_clock_hz(struct board *b, const char *bus)
{
    return b->chip->clocks->bus_hz(b, bus);
}

uint64_t timer_clock_hz(struct board *b, const char *bus)
{
    return b->chip->clocks->timer_hz(b, bus);
}

uint64_t rtc_clock_hz(struct board *b)
{
    return b->chip->clocks->rtc_hz(b);
}

bool crystal_runs(struct board *b)
{
    return b->chip->clocks->crystal_runs(b);
}

void crystal_changed(struct board *b)
{
    b->chip->clocks->crystal_changed(b);
}

uint8_t pin_function(struct board *b, char port, unsigned pin)
{
    return b->chip->pin_function(b, port, pin);
}

/* RM0090 Rev 21 7.2.6, RM0041 Rev 6 6.2.6: the switch waits until the clock that SW asks for is ready. */
bool clock_switches(struct part *rcc, uint32_t cfgr_offset)
{
    static const uint32_t ready[] = {CR_HSIRDY, CR_HSERDY, CR_PLLRDY, 0};
    uint32_t cfgr = part_get(rcc, cfgr_offset), wanted = cfgr & 3u;
    if (wanted == 3u)
        board_verdict(rcc->board, "RCC_CFGR switches to clock 3, which is none");
    if ((part_get(rcc, CR) & ready[wanted]) == 0 || (cfgr >> 2 & 3u) == wanted)
        return false;
    part_set(rcc, cfgr_offset, (cfgr & ~12u) | wanted << 2);
    return true;
}

/* RM0090 Rev 21 7.3.3, RM0041 Rev 6 6.3.2: codes below the first divider mean undivided. */
uint32_t ahb_divider(uint32_t code)
{
    static const uint16_t by[] = {2, 4, 8, 16, 64, 128, 256, 512};
    return (code & 8u) == 0 ? 1u : by[code & 7u];
}

uint32_t apb_divider(uint32_t code)
{
    return (code & 4u) == 0 ? 1u : 2u << (code & 3u);
}

/* RM0090 7.2, RM0041 6.2 */
uint64_t timer_of_bus_hz(struct board *b, const char *bus)
{
    uint64_t hz = bus_clock_hz(b, bus);
    return hz == b->core_hz ? hz : 2u * hz;
}

void reset_parts(const struct part *rcc, uint32_t offset, uint32_t enable)
{
    struct board *b = rcc->board;
    uint32_t bits = part_get(rcc, offset);
    for (size_t i = 0; i < b->n_parts; i++) {
        struct part *p = b->parts[i];
        if (p->row->enable_offset != enable)
            continue;
        bool held = (bits >> p->row->enable_bit & 1u) != 0;
        if (held && !p->held_in_reset) {
            if (p->row->class->restart == NULL)
                board_verdict(b, "a reset of %s alone is not modelled", p->row->name);
            else
                p->row->class->restart(p);
        }
        p->held_in_reset = held;
    }
}
