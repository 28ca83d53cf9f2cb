/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "virtual_board/fault_table.h"

#include <string.h>

const struct fault_row fault_table[FAULT_KINDS] = {
    [FAULT_POWER_CUT] = {"power_cut", "s", 0.001, 3600, false,
                         "the supply is off for so long; memory is lost, flash kept"},
    [FAULT_SUPPLY] =
        {"supply", "V", 0, 3.6, false,
         "the supply steps to this; below the brown-out level the chip is held in reset"},
    [FAULT_SUPPLY_RAMP] = {"supply_ramp", "V", 0, 3.6, false,
                           "the supply goes to this in even steps of 1 ms, within ramp_time"},
    [FAULT_CRYSTAL] = {"crystal", "Hz", 0, 26e6, true,
                       "frequency of the crystal from now on; 0: it stops"},
    [FAULT_SLOW_CLOCK] = {"slow_clock", "Hz", 10e3, 100e3, true,
                          "frequency of the watchdog's clock from its next feeding on"},
    [FAULT_BUTTON] = {"button", "s", 1e-6, 3600, false, "the reset button is held for so long"},
    [FAULT_HANG_MAIN] = {"hang_main", "", 0, 1, true,
                         "1: the main loop no longer gets on; interrupts do; 0 or a reset ends it"},
    [FAULT_HANG_TICK] = {"hang_tick", "", 0, 1, true,
                         "1: the tick no longer gets on, once it runs; 0 or a reset ends it"},
    [FAULT_HANG_CLOCK] =
        {"hang_clock", "", 0, 1, true,
         "1: the board clock no longer gets on, once it runs; 0 or a reset ends it"},
    [FAULT_FLIP_RAM] = {"flip_ram", "bits", 1, 1000, true, "bits of the SRAM turn over"},
    [FAULT_FLIP_CCM] = {"flip_ccm", "bits", 1, 1000, true,
                        "bits of the core-coupled memory turn over"},
    [FAULT_FLIP_FLASH] = {"flip_flash", "bits", 1, 1000, true, "bits of the image turn over"},
    [FAULT_FLIP_STORED] = {"flip_stored", "bits", 1, 1000, true,
                           "bits of the flash for settings turn over, where it is not erased"},
    [FAULT_FLIP_REGISTER] = {"flip_register", "bits", 1, 32, true,
                             "bits of R0 to R12, SP, LR, PC, S0 to S31 turn over"},
    [FAULT_SET_R0] = {"set_r0", "", 0, 4294967295.0, true, "R0 takes this value"},
    [FAULT_JUMP] = {"jump", "", 0, 4294967295.0, true,
                    "the core goes on at this address, in whatever it was about"},
    [FAULT_NOISE_CONSOLE] = {"noise_console", "", 0, 1e6, true,
                             "bytes in a million, of either direction, that noise changes"},
    [FAULT_NOISE_LINK] = {"noise_link", "", 0, 1e6, true, "likewise, of the plant link"},
    [FAULT_FLASH_CUT_WORD] = {"flash_cut_word", "", 1, 1e6, true,
                              "the supply goes within the n-th word that is stored from now on, "
                              "for off_time"},
    [FAULT_FLASH_CUT_ERASE] = {"flash_cut_erase", "per mille", 0, 1000, true,
                               "the supply goes at this part of the next erase, for off_time"},
    [FAULT_UNPLUG_CONSOLE] = {"unplug_console", "s", 0.001, 3600, false,
                              "both directions of the console are cut for so long"},
    [FAULT_UNPLUG_LINK] = {"unplug_link", "s", 0.001, 3600, false, "likewise, of the plant link"},
    [FAULT_AFTER_NS] = {"after_ns", "ns", 0, 1e15, true,
                        "the next fault comes so much later than its event"},
    [FAULT_AFTER_INSTRUCTIONS] = {"after_instructions", "", 0, 1e12, true,
                                  "the next fault comes so many instructions of the core later"},
    [FAULT_RAMP_TIME] = {"ramp_time", "s", 0.001, 3600, false, "of supply_ramp (1)"},
    [FAULT_OFF_TIME] = {"off_time", "s", 0.001, 3600, false,
                        "of flash_cut_word and flash_cut_erase (1)"},
    [FAULT_PLACE] = {"place", "", 0, 4294967295.0, true,
                     "seed of the places of the next flips (that of the board)"},
    [FAULT_FLIP_FROM] = {"flip_from", "", 0, 4294967295.0, true,
                         "address from which on the next flips of a memory come (its first)"},
    [FAULT_FLIP_BYTES] = {"flip_bytes", "", 0, 4294967295.0, true,
                          "how many bytes from there they may hit (0: all that follow)"},
};

enum fault_kind fault_find(const char *name)
{
    size_t k = 0;
    while (k < FAULT_KINDS && strcmp(fault_table[k].name, name) != 0)
        k++;
    return (enum fault_kind)k;
}
