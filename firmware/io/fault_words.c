/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "io/fault_words.h"

#define FAULTS 11u

uint8_t fault_word(uint16_t faults)
{
    for (uint8_t i = 0; i + 1u < FAULTS; i++)
        if ((faults >> i & 1u) != 0)
            return (uint8_t)(i + 1u);
    return 0;
}

const char *fault_word_text(uint8_t fault)
{
    /* In the order of enum device_fault (devices/device.h). */
    static const char *const texts[FAULTS] = {
        "?",
        "no chip answers",
        "another chip answers, or it does not take its settings",
        "its data have a wrong checksum, or two readings differ",
        "sensor open",
        "sensor shorted",
        "over- or undervoltage at its input",
        "beyond what the sensor can have",
        "cold junction out of range",
        "the chip has lost its supply",
        "its bus failed",
    };
    return texts[fault < FAULTS ? fault : 0];
}
