#include "commission/analysis_settings.h"

#include "commission/analysis_state.h"

#define RESOLUTION REAL_C(1e-4) /* of a span: resolution of a 12-bit converter */

static void rule_config(const struct analysis *a, struct detune_config *c)
{
    detune_config_default(c);
    c->noise_sd = a->config.noise_sd;
    c->noise_least = RESOLUTION;
}

/* Part of the plant that pair k belongs to; all belong to one where parts are not known. */
static uint8_t part_of_pair(const struct analysis *a, uint8_t k)
{
    const struct structure *s = layout_structure(&a->layout);
    return s ? s->block[s->pair_block[k]].part : 0;
}

enum err settings_begin(struct analysis *a, bool decoupled)
{
    struct detune_config c;
    rule_config(a, &c);
    for (uint8_t k = 0; k < a->pairs.n; k++)
        c.part[k] = part_of_pair(a, k);
    enum err err = detune_begin(&a->work.detune, &a->plant, &a->pairs, a->config.h_s,
                                decoupled ? &a->d : NULL, &c, NULL);
    return err ? ERR_UNSUPPORTED : ERR_OK;
}

enum err settings_by_rule(struct analysis *a)
{
    enum err err = detune_step(&a->work.detune);
    if (err == ERR_BUSY)
        return err;
    a->loops = a->work.detune.loops; /* the slowest that were tried, where all are too fast */
    return err == ERR_TIMEOUT ? ERR_OK : err;
}

enum err settings_begin_search(struct analysis *a, uint16_t members)
{
    struct detune_config rule;
    rule_config(a, &rule);
    struct robust_config c;
    robust_config_default(&c);
    for (uint8_t k = 0; k < a->pairs.n; k++) {
        c.part[k] = part_of_pair(a, k);
        c.gain_most[k] = detune_largest_gain(&a->plant, &a->loops, &rule, k);
    }
    c.members = members;
    c.draw = a->config.draw;
    c.context = a->config.context;
    return robust_begin(&a->work.robust, &a->plant, &a->loops, &c, NULL);
}

enum err settings_by_search(struct analysis *a)
{
    struct robust *r = &a->work.robust;
    enum err err = robust_step(r);
    /* One plant may be so unlike the others that no settings serve both: its gains are as improbable as the pairing's sign. */
    if (err == ERR_TIMEOUT && r->worst_member < r->config.members && a->left_out == 0) {
        a->left_out = (uint16_t)(r->worst_member + 1u);
        return settings_begin_search(a, a->config.members) == ERR_OK ? ERR_BUSY : ERR_TIMEOUT;
    }
    if (err)
        return err;
    a->loops = r->loops;
    a->sensitivity = (struct analysis_sensitivity){.s_nominal = r->s_nominal,
                                                   .t_nominal = r->t_nominal,
                                                   .s_worst = r->s_worst,
                                                   .t_worst = r->t_worst,
                                                   .factor = r->factor};
    return ERR_OK;
}
