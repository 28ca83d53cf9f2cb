#include "base/elapsed.h"

float elapsed_ms(uint64_t now_ms, uint64_t then_ms)
{
    uint64_t passed = now_ms - then_ms;
    float unit = 1.0f;
    /* To 32 bits. What drops out at the end lives on in the last bit, far below those a float keeps: it still tells
     * which way to round. */
    while (passed >> 32) {
        passed = passed >> 1 | (passed & 1u);
        unit *= 2.0f;
    }
    return (float)(uint32_t)passed * unit;
}
