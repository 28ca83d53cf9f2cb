/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef REFLUX_OUTPUTS_MOTOR_VALVE_STATE_H
#define REFLUX_OUTPUTS_MOTOR_VALVE_STATE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/pin.h"
#include "outputs/output_settings.h"

#define VALVE_PINS (OUTPUT_CLOSED_END + 1u)

/* Owner: motor_valve.c. Directions: 1 opens, -1 closes, 0 none. */
struct output_motor_valve {
    hal_pin pin[VALVE_PINS]; /* enum output_pin */
    int8_t running;          /* direction of the motor */
    int8_t turned;           /* direction of its last run */
    int8_t seated;           /* end at which the valve certainly is */
    bool homed;              /* the position is known */
    int8_t home;             /* end that is looked for before it is */
    uint8_t faults;          /* enum output_fault */
    uint8_t closed_ms
        [2]; /* how long the contacts of the open and the closed end have been closed, up to the limit */
    uint32_t travel_ms, band_ms, pause_ms;
    uint32_t scale;     /* 2^32 / travel_ms */
    uint32_t place_ms;  /* reckoned position: 0 closed, travel_ms open */
    uint32_t beyond_ms; /* run of the motor since the position has reached an end */
    uint32_t rest_ms;   /* since the motor stopped; stops at its largest value */
};

#endif
