/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "rest_side.h"

#include "bench/text.h"

static void outputs_safe(struct rest_side *r)
{
    const struct link_hello *h = &r->link->hello;
    for (size_t i = 0; i < h->n_outputs; i++) {
        r->command.output[i].value = r->link->page[h->n_measurements + i].safe;
        r->command.output[i].drive = true;
    }
}

bool rest_side_open(struct rest_side *r, struct link_server *link, const struct pins_side *pins,
                    const struct plant_class *class, uint32_t tick_ms, uint32_t session, char *err,
                    size_t err_size)
{
    struct plant_channel channels[2 * LINK_CHANNELS_MAX];
    struct plant_class rest = *class;
    size_t n[2] = {0, 0}, all[2] = {0, 0}, limit[2] = {pins->n_measurements, pins->n_outputs};
    *r = (struct rest_side){.link = link};
    rest.channels = channels;
    rest.n_channels = 0;
    for (size_t i = 0; i < class->n_channels; i++) {
        const struct plant_channel *c = &class->channels[i];
        bool mv = c->kind == PLANT_MV;
        if ((!mv && c->kind != PLANT_MEASUREMENT) || all[mv] == limit[mv]) {
            continue;
        }
        size_t index = all[mv]++;
        if ((mv ? pins->output_of : pins->sensor_of)[index] != PINS_NONE) {
            continue;
        }
        (mv ? r->commanded : r->measured)[n[mv]++] = (uint8_t)index;
        channels[rest.n_channels++] = *c;
    }
    if (rest.n_channels == 0) {
        return sim_fail(err, err_size, "--rest-on-link: every channel of the plant is wired");
    }
    if (!link_server_init(link, pins->port, &rest, tick_ms, session, err, err_size)) {
        return false;
    }
    outputs_safe(r);
    return true;
}

void rest_side_sample(struct rest_side *r, const struct link_sample *sample)
{
    const struct link_hello *h = &r->link->hello;
    struct link_sample part = {.number = sample->number,
                               .time_ms = sample->time_ms,
                               .n_measurements = h->n_measurements,
                               .n_readback = h->n_outputs};
    bool first = !r->begun;
    r->begun = true;
    if (first || r->link->state != LINK_SAMPLING) {
        return;
    }
    for (size_t i = 0; i < h->n_measurements; i++) {
        part.measurement[i] = sample->measurement[r->measured[i]];
    }
    for (size_t i = 0; i < h->n_outputs; i++) {
        part.readback[i] = sample->readback[r->commanded[i]];
    }
    (void)link_server_sample(r->link, &part);
}

void rest_side_listen(struct rest_side *r)
{
    if (r->link->state != LINK_SAMPLING) {
        outputs_safe(r);
    } else if (r->link->answered) {
        r->link->answered = false;
        for (size_t i = 0; i < r->link->hello.n_outputs; i++) {
            if (r->link->command.output[i].drive) {
                r->command.output[i] = r->link->command.output[i];
            }
        }
    }
}

void rest_side_command(const struct rest_side *r, struct link_command *command)
{
    for (size_t i = 0; i < r->link->hello.n_outputs; i++) {
        command->output[r->commanded[i]] = r->command.output[i];
    }
}
