/* Outputs of the STM32F100: pins that switch. No timer is used for pulse widths.
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

bool hal_pwm_find(hal_pin pin, uint32_t hz, struct hal_pwm_place *place)
{
    (void)pin;
    (void)hz;
    (void)place;
    return false;
}

enum err hal_pwm_open(hal_pin pin, uint32_t hz, bool low)
{
    (void)pin;
    (void)hz;
    (void)low;
    return ERR_RANGE;
}

void hal_pwm_set(hal_pin pin, uint16_t part)
{
    (void)pin;
    (void)part;
}

void hal_output_safe(void)
{
    pin_switch_all_off();
}
