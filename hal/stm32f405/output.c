/* Outputs of the STM32F405.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "hal/output.h"

#include "pin_map.h"

enum err hal_output_open(hal_pin pin, bool low)
{
    if (!hal_pin_is_free(pin)) {
        return ERR_RANGE;
    }
    pin_make_switched(pin, low);
    return ERR_OK;
}

void hal_output_safe(void)
{
    pin_switch_all_off();
}
