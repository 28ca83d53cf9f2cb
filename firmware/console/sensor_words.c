/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "console/sensor_words.h"

#include "console/phrases.h"
#include "devices/devices.h"
#include "io/output_proof.h"
#include "outputs/output_kind.h"

void sensor_event_words(const struct event *e, struct text *line)
{
    if (e->code == EVENT_SENSOR_FAULT && e->detail != 0)
        put_reason(line, device_fault_text((uint16_t)(1u << (e->detail - 1u))));
    if (e->code == EVENT_OUTPUT_FAULT)
        put_reason(line, output_fault_text((uint8_t)e->detail));
    if (e->code == EVENT_OUTPUT_CONTRADICTED)
        put_reason(line, output_proof_text(e->detail));
}
