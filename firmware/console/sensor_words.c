/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "console/sensor_words.h"

#include "console/phrases.h"
#include "io/fault_words.h"

void sensor_event_words(const struct event *e, struct text *line)
{
    if (e->code == EVENT_SENSOR_FAULT)
        put_reason(line, fault_word_text(e->detail));
}
