/* Who has a bus, or a chip on it, and until when. A transfer needs its bus; a conversion of a chip with several inputs needs its chip.
 *
 * A bus could say itself that it is busy. But a bus of the host is faster than one of a chip, and then the devices on it would take their
 * turns in another order. With times given, both run alike. Board clock only.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_DEVICES_LINE_H
#define REFLUX_DEVICES_LINE_H

#include <stdbool.h>
#include <stdint.h>

/* All seven buses of a board, and a chip for each of twelve channels. */
#ifndef LINE_CLAIMS_MAX
#define LINE_CLAIMS_MAX 20u
#endif
#define LINE_WHOLE 0xFFu /* in place of an address: the bus itself */

/* Claims a bus (unit LINE_WHOLE) or a chip on it (unit: its address) for this time from now; a claim that the holder has is renewed. line:
 * enum device_line. False: another holder has it, or LINE_CLAIMS_MAX claims are in force. The holder is only compared, never looked into. */
bool line_claim(uint8_t line, uint8_t bus, uint8_t unit, const void *holder, uint32_t now_ms,
                uint16_t for_ms);

/* Ends all claims of this holder. */
void line_release(const void *holder);

#endif
