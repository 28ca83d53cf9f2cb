/* Faults of sensors and outputs at the board's own pins, in words. A board without pins has none.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_CONSOLE_SENSOR_WORDS_H
#define REFLUX_CONSOLE_SENSOR_WORDS_H

#include "base/event.h"
#include "base/text.h"
#include "exchange/config.h"

#if CONFIG_DEVICES
void sensor_event_words(const struct event *e, struct text *line);
#else
static inline void sensor_event_words(const struct event *e, struct text *line)
{
    (void)e;
    (void)line;
}
#endif

#endif
