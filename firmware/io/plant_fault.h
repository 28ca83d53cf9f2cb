/* Why a plant on the line is not taken: detail of EVENT_PLANT_REFUSED, and of `alarm` while it lasts. */
#ifndef REFLUX_IO_PLANT_FAULT_H
#define REFLUX_IO_PLANT_FAULT_H

#include <stdint.h>

/* What the value of the event is stands behind each. */
enum plant_fault {
    PLANT_FINE,
    PLANT_TOO_LARGE, /* channels of a kind */
    PLANT_LONG_TEXT, /* bytes of names and units so far */
    PLANT_HELLO,     /* bytes of the message */
    PLANT_NO_TICK,   /* 0 */
    PLANT_PAGE,      /* page asked for */
    PLANT_SPAN,      /* page */
    PLANT_SAME_NAME, /* page */
    PLANT_NO_PAGE,   /* page; it is asked for again and again */
    PLANT_SHAPE,     /* measurements in the sample */
    PLANT_ROLE,      /* type of the message; a plant that is there stays */
    PLANT_FAULTS
};

/* In words; "?" out of range. */
const char *plant_fault_text(uint8_t fault);

#endif
