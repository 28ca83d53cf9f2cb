/* Reasons why the firmware refuses a plant on the line: the detail of EVENT_PLANT_REFUSED, and of `alarm` while the refusal lasts. */
#ifndef REFLUX_IO_PLANT_FAULT_H
#define REFLUX_IO_PLANT_FAULT_H

#include <stdint.h>

/* The comment behind each reason is the value of the event. */
enum plant_fault {
    PLANT_FINE,
    PLANT_TOO_LARGE, /* channels of a kind */
    PLANT_LONG_TEXT, /* bytes of names and units so far */
    PLANT_HELLO,     /* bytes of the message */
    PLANT_NO_TICK,   /* 0 */
    PLANT_PAGE,      /* page asked for */
    PLANT_SPAN,      /* page */
    PLANT_SAME_NAME, /* page */
    PLANT_NO_PAGE,   /* page, for which the firmware goes on asking */
    PLANT_SHAPE,     /* measurements in the sample */
    PLANT_ROLE,      /* type of the message; a connected plant stays connected */
    PLANT_AT_PINS,   /* page */
    PLANT_FAULTS
};

/* Returns the reason in words; "?" out of range. */
const char *plant_fault_text(uint8_t fault);

#endif
