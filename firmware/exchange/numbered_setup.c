/* The setup of a block with a number, blockN: its members, the channels it reads and writes, the block it names. */
#include <string.h>

#include "exchange/block_settings.h"
#include "exchange/numbered_setup.h"
#include "exchange/reach.h"

/* Returns the base ticks of a step of blockN. Compensators and feedforward elements run in every base tick,
 * whatever the divisors of the loops. */
uint16_t plan_divisor(const struct plan *plan, uint8_t n)
{
    const struct numbered_plan *r = &plan->numbered[n];
    if (!r->members || plan_has_stage(plan, n, STAGE_COMPENSATE))
        return 1;
    return plan->config.loop[r->member[0]].divisor;
}

static struct block_signal signal_of(const struct config *c, uint8_t at)
{
    if (at & INPUT_IS_MV) {
        const struct mv_config *o = &c->mv[at & (uint8_t)~INPUT_IS_MV];
        return (struct block_signal){o->lo, o->hi, true};
    }
    return (struct block_signal){c->measurement[at].lo, c->measurement[at].hi, false};
}

/* Returns the parameter with which a block of that kind names another, or NULL. */
const struct block_parameter *plan_names_with(const struct block_kind *kind)
{
    for (unsigned i = 0; kind->names && i < kind->parameters; i++)
        if (kind->parameter[i].id == kind->names)
            return &kind->parameter[i];
    return NULL;
}

/* Returns the number of the block that block n names; 0 if it names none. */
uint16_t plan_number_named(const struct plan *plan, uint8_t n)
{
    uint8_t kind = plan->block[BLOCK_NUMBERED + n].kind;
    const struct block_parameter *with =
        kind == PLAN_NONE ? NULL : plan_names_with(block_kinds[kind]);
    const uint8_t *settings = config_block_settings(&plan->config, n);
    uint16_t number = 0;
    if (with && settings)
        memcpy(&number, settings + with->offset, sizeof number);
    return number;
}

const void *plan_named(const struct plan *plan, uint8_t n)
{
    uint16_t number = plan_number_named(plan, n);
    return number && number <= CONFIG_BLOCKS
               ? config_block_settings(&plan->config, (uint8_t)(number - 1u))
               : NULL;
}

bool plan_names_a(const struct plan *plan, uint8_t n, const char *kind)
{
    return plan_named(plan, n) &&
           plan->block[BLOCK_NUMBERED + plan_number_named(plan, n) - 1u].kind ==
               block_kind_find(kind);
}

bool plan_names_other(const struct plan *plan, uint8_t n)
{
    uint8_t kind = plan->block[BLOCK_NUMBERED + n].kind;
    return kind != PLAN_NONE && block_kinds[kind]->other_kind &&
           plan_names_a(plan, n, block_kinds[kind]->other_kind);
}

void plan_setup_numbered(const struct plan *plan, uint8_t n, struct block_setup *setup)
{
    const struct numbered_plan *r = &plan->numbered[n];
    setup->settings = config_block_settings(&plan->config, n);
    setup->named = plan_named(plan, n);
    setup->named_other = plan_names_other(plan, n);
    setup->interval_s = plan->tick_s * (float)plan_divisor(plan, n);
    setup->members = r->members;
    setup->inputs = r->inputs;
    setup->points = r->points;
    setup->present = (uint8_t)((1u << r->members) - 1u);
    for (uint8_t k = 0; k < r->members; k++) {
        const struct loop_plan *p = &plan->loop[r->member[k]];
        const struct measurement_config *m = &plan->config.measurement[p->pv];
        float reach = plan_has_stage(plan, n, STAGE_COMPENSATE)
                          ? plan_member_reach(plan, n, r->member[k])
                          : 1.0f;
        setup->member[k] =
            (struct block_member){r->member[k], p->mv != PLAN_NONE, m->hi - m->lo, reach};
        setup->pv[k] = signal_of(&plan->config, p->pv);
    }
    for (uint8_t k = 0; k < r->inputs; k++)
        setup->input[k] = signal_of(&plan->config, r->input[k]);
    uint8_t mv = plan_has_stage(plan, n, STAGE_FEED_FORWARD) ? INPUT_IS_MV : 0;
    for (uint8_t k = 0; k < r->points; k++)
        setup->point[k] = signal_of(&plan->config, r->point[k] | mv);
}
