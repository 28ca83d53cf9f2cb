/* Non-volatile memory as flash offers it: program units that go from erased to written once, and from there to zero,
 * and larger sectors that are erased whole.
 *
 * Rules
 *  1. Addresses are offsets into the area, 0 .. sectors * sector_size - 1.
 *  2. program() needs an erased target, but for units of zeros, which go over anything; and address and length that are
 *     multiples of program_size.
 *  3. An erase may stall the processor (up to seconds): callers do it only at start or in manual.
 *  4. read() tells what the memory holds at that moment, not what a cache remembers of an earlier reading.
 *  5. With a supply too low for it nothing is programmed or erased. An erase in which the supply has been too low may have left weak bits
 *     and counts as none. Both end in ERR_STATE.
 *  6. A port whose memory silently ignores writes (an emulator) reports ERR_IO: every write is read back.
 */
#ifndef REFLUX_HAL_NVM_H
#define REFLUX_HAL_NVM_H

#include <stdint.h>

#include "base/error.h"

struct hal_nvm_geometry {
    uint32_t sectors;      /* 0 = this board has none */
    uint32_t sector_size;  /* bytes, the erase unit */
    uint32_t program_size; /* bytes, the program unit */
    uint8_t erased;        /* value of an erased byte, usually 0xFF */
};

void hal_nvm_get_geometry(struct hal_nvm_geometry *geometry);
/* ERR_RANGE outside the area. */
MUST_CHECK enum err hal_nvm_read(uint32_t address, void *data, uint32_t n);
/* ERR_RANGE outside the area or misaligned, ERR_STATE with a low supply (as
 * far as it has got), ERR_IO when the target must be erased and is not (nothing is
 * written then) or the read-back differs, ERR_TIMEOUT. */
MUST_CHECK enum err hal_nvm_program(uint32_t address, const void *data, uint32_t n);
/* ERR_RANGE no such sector, ERR_STATE with a low supply before or in it, ERR_IO when it does not read erased, ERR_TIMEOUT. */
MUST_CHECK enum err hal_nvm_erase(uint32_t sector);

#endif
