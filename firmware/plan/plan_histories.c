/* Histories of applied inputs in a plan: finds which MV has one, and how deep it is. */
#include "exchange/arena_sizes.h"
#include "exchange/block_setup.h"
#include "exchange/numbered_setup.h"
#include "plan/plan_parts.h"

static void need_history(struct plan *plan, uint8_t j, uint16_t ticks)
{
    if (j != PLAN_NONE && plan->history[j] < ticks)
        plan->history[j] = ticks;
    if (j != PLAN_NONE && plan->histories <= j)
        plan->histories = (uint8_t)(j + 1u);
}

/* Returns the base ticks that blockN wants to look back. */
static uint32_t ticks_wanted(const struct plan *plan, uint8_t n)
{
    uint8_t block = (uint8_t)(BLOCK_NUMBERED + n);
    if (plan->block[block].kind == PLAN_NONE || !plan_kind(plan, block)->history)
        return 0;
    struct block_setup setup;
    plan_setup_numbered(plan, n, &setup);
    return applied_history_ticks(plan_kind(plan, block)->history(&setup), plan_divisor(plan, n));
}

static enum err refuse_history(const struct plan *plan, uint8_t n, uint32_t grains,
                               struct config_fault *fault)
{
    (void)!plan_refuse(fault, ERR_MEMORY, "block", n + 1u, "kind", plan->config.block[n].kind,
                       "finds no memory for its history of applied inputs");
    fault->bytes = grains * ARENA_GRAIN;
    return ERR_MEMORY;
}

enum err plan_resolve_histories(struct plan *plan, uint32_t at, struct config_fault *fault)
{
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++) {
        const struct numbered_plan *r = &plan->numbered[n];
        uint32_t ticks = ticks_wanted(plan, n);
        /* The depth of a history that is too large by itself may not even fit 16 bits. */
        uint32_t grains = at + ARENA_GRAINS(applied_history_bytes(ticks));
        if (ticks && grains > PLAN_ARENA_BYTES / ARENA_GRAIN)
            return refuse_history(plan, n, grains, fault);
        for (uint8_t k = 0; ticks && k < r->members; k++)
            need_history(plan, plan->loop[r->member[k]].mv, (uint16_t)ticks);
        for (uint8_t k = 0; ticks && k < r->inputs; k++)
            if (r->input[k] & INPUT_IS_MV)
                need_history(plan, r->input[k] & (uint8_t)~INPUT_IS_MV, (uint16_t)ticks);
        grains = at;
        for (uint8_t j = 0; j < plan->histories; j++)
            grains += arena_history_grains(plan->history[j]);
        if (grains > PLAN_ARENA_BYTES / ARENA_GRAIN)
            return refuse_history(plan, n, grains, fault);
    }
    return ERR_OK;
}
