#include "base/elapsed.h"

float elapsed_ms(uint64_t now_ms, uint64_t then_ms)
{
    uint64_t passed = now_ms - then_ms;
    float unit = 1.0f;
    /* Reduces to 32 bits. A bit that drops out stays in the last bit, far below the bits that a float keeps, so the
     * rounding still goes the right way. */
    while (passed >> 32) {
        passed = passed >> 1 | (passed & 1u);
        unit *= 2.0f;
    }
    return (float)(uint32_t)passed * unit;
}
