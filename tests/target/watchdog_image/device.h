/* What differs between the boards that run this image, beside hal/watchdog.h. */
#ifndef WATCHDOG_IMAGE_DEVICE_H
#define WATCHDOG_IMAGE_DEVICE_H

#include <stdint.h>

extern const uint32_t device_hz; /* of the core */
void device_start(void);
void device_send(char byte);

#endif
