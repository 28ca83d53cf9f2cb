/* Which crystal a board has, by a measurement against the internal oscillator. Plain arithmetic, tried on the host. */
#ifndef REFLUX_STM32_CRYSTAL_H
#define REFLUX_STM32_CRYSTAL_H

#include <stdint.h>

/* cycles of the internal oscillator that were counted where a crystal of 1 MHz would have given per_mhz, were the
 * oscillator exact. Returns the one of the n known ones, MHz, that fits; 0: none.
 *
 * The oscillator is good to 1 % at 25 degrees only. Over temperature it is off by -8 % to +4.5 % on the STM32F405 (DS8626,
 * HSI oscillator characteristics) and by -2.4 % to +2.5 % on the STM32F100 (DS5944); 2 % on top for the count itself and the
 * crystal. Crystals on the lists are a third apart. One that is on no list and within 8 % of one cannot be told from it. */
static inline uint32_t crystal_mhz(const uint8_t *known, uint32_t n, uint32_t cycles,
                                   uint32_t per_mhz)
{
    for (uint32_t i = 0; i < n; i++) {
        uint64_t thousandths = UINT64_C(1000) * cycles * known[i];
        if (thousandths >= UINT64_C(900) * per_mhz && thousandths <= UINT64_C(1065) * per_mhz) {
            return known[i];
        }
    }
    return 0;
}

#endif
