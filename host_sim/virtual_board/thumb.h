/* As much of the instructions' encoding as counting and stopping need. Lengths of instructions, IT, divisions and coprocessors are as in the
 * ARMv7-M manual, DDI 0403 A5 and A7 (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_THUMB_H
#define REFLUX_VIRTUAL_BOARD_THUMB_H

#include <stdbool.h>
#include <stdint.h>

/* A halfword of 0xE800 and above begins one of two halfwords. */
static inline uint32_t thumb_length(const uint8_t *code)
{
    return code[1] >= 0xE8u ? 4u : 2u;
}

static inline uint32_t thumb_count(const uint8_t *code, uint32_t bytes)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < bytes; n++)
        i += thumb_length(code + i);
    return n;
}

/* Offset of instruction n; bytes where there are fewer. */
static inline uint32_t thumb_offset(const uint8_t *code, uint32_t bytes, uint32_t n)
{
    uint32_t i = 0;
    for (; n > 0 && i < bytes; n--)
        i += thumb_length(code + i);
    return i < bytes ? i : bytes;
}

/* Offset of the first instruction of coprocessors 10 and 11; bytes: there is none. */
static inline uint32_t thumb_first_fpu(const uint8_t *code, uint32_t bytes)
{
    uint32_t i = 0;
    while (i < bytes && !((code[i + 1u] & 0xECu) == 0xECu &&
                          ((code[i + 3u] & 0xFu) == 10u || (code[i + 3u] & 0xFu) == 11u)))
        i += thumb_length(code + i);
    return i < bytes ? i : bytes;
}

/* Offset of the IT instruction that governs what lies at `at`; else `at`. */
static inline uint32_t thumb_it_start(const uint8_t *code, uint32_t at)
{
    uint32_t i = 0, begin = at, governed = 0;
    for (; i < at; i += thumb_length(code + i)) {
        if (code[i + 1u] == 0xBFu && (code[i] & 0xFu) != 0) {
            begin = i;
            governed = 4u - (uint32_t)__builtin_ctz(code[i] & 0xFu);
        } else if (governed > 0) {
            governed--;
        }
    }
    return governed > 0 ? begin : at;
}

/* SDIV or UDIV */
static inline bool thumb_divides(const uint8_t *code)
{
    return code[1] == 0xFBu && ((code[0] & 0xF0u) == 0x90u || (code[0] & 0xF0u) == 0xB0u) &&
           (code[3] & 0xF0u) == 0xF0u && (code[2] & 0xF0u) == 0xF0u;
}

#endif
