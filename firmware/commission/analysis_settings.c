#include "commission/analysis_settings.h"

#include "commission/analysis_state.h"

#define RESOLUTION REAL_C(1e-4) /* of a span: resolution of a 12-bit converter */

void settings_exchange_beginnings(struct analysis *a, bool begins)
{
    if (a->begins == begins)
        return;
    a->begins = begins;
    for (uint8_t j = 0; j < a->plant.outputs; j++)
        for (uint8_t i = 0; i < a->plant.inputs; i++) {
            struct beginning *b = &a->beginning[j][i];
            struct fopdt *e = &a->plant.element[j][i];
            if (!(b->time_constant_s > REAL_C(0.0)))
                continue;
            struct beginning other = {e->time_constant_s, e->dead_time_s};
            e->time_constant_s = b->time_constant_s;
            e->dead_time_s = b->dead_time_s;
            *b = other;
        }
}

enum err settings_begin(struct analysis *a, bool decoupled)
{
    struct detune_config c;
    detune_config_default(&c);
    c.noise_sd = a->config.noise_sd;
    c.noise_least = RESOLUTION;
    settings_exchange_beginnings(a, true);
    const struct structure *s = layout_structure(&a->layout);
    for (uint8_t k = 0; s && k < a->pairs.n; k++)
        c.part[k] = s->block[s->pair_block[k]].part;
    for (uint8_t k = 0; k < a->pairs.n && !decoupled; k++)
        if (a->beginning[a->pairs.output[k]][a->pairs.input[k]].time_constant_s > REAL_C(0.0))
            c.begins = (uint16_t)(c.begins | 1u << k);
    enum err err = detune_begin(&a->work.detune, &a->plant, &a->pairs, a->config.h_s,
                                decoupled ? &a->d : NULL, &c, NULL);
    return err ? ERR_UNSUPPORTED : ERR_OK;
}
