/* Blocks of a plan: finds the kind of each, makes its setup from the configuration, has the kind check it, and
 * gives it a place in the arena. */
#include <string.h>

#include "exchange/arena_sizes.h"
#include "exchange/block_links.h"
#include "exchange/block_settings.h"
#include "exchange/block_setup.h"
#include "plan/plan_blocks.h"
#include "plan/plan_parts.h"

#define NOT_IN_BUILD "is not in this build"

/* Returns the kind of a configuration group (decoupleN, ffN) that no blockN selects: the build's kind for that
 * stage. */
static uint8_t first_of_stage(enum block_stage stage)
{
    for (uint8_t k = 0; k < block_kind_count; k++)
        if (block_kinds[k]->stage == stage && !(CONFIG_BLOCKS && block_kind_is_numbered(k)))
            return k;
    return PLAN_NONE;
}

static uint8_t plan_find_kind(const struct plan *plan, uint8_t block)
{
    if (block >= BLOCK_FEEDFORWARDS)
        return first_of_stage(STAGE_FEED_FORWARD);
    if (block == BLOCK_MATRIX)
        return first_of_stage(STAGE_COMPENSATE);
    for (uint8_t k = 0; k < block_kind_count; k++)
        if (block_kinds[k]->algorithms & (1u << plan->config.loop[block].own.algorithm))
            return k;
    return PLAN_NONE;
}

bool plan_accepts_matrix(const float d[DECOUPLER_MAX][DECOUPLER_MAX], uint8_t loops)
{
    const struct matrix_settings matrix = {d};
    struct block_setup setup = {.settings = &matrix, .interval_s = 1.0f, .members = DECOUPLER_MAX};
    struct block_fault fault;
    uint8_t kind = first_of_stage(STAGE_COMPENSATE);
    for (uint8_t i = 0; i < loops; i++) {
        setup.present = (uint8_t)(setup.present | (1u << i));
        setup.member[i] = (struct block_member){i, true, 0.0f, 1.0f};
    }
    return kind != PLAN_NONE && block_kinds[kind]->check(&setup, &fault) == ERR_OK;
}

/* These checks are three functions and not one, because each then takes the stack of its own kinds alone. */
enum err plan_check_own(struct plan *plan, uint8_t i, struct config_fault *fault)
{
    struct block_instance b;
    struct block_fault reason;
    const char *name = plan->config.loop[i].name;
    plan->block[i].kind = plan_find_kind(plan, i);
    if (plan->block[i].kind == PLAN_NONE)
        return plan_refuse(fault, ERR_UNSUPPORTED, "loop", i + 1u, "algorithm", name, NOT_IN_BUILD);
    plan_setup_own(plan, i, &b);
    enum err err = plan_kind(plan, i)->check(&b.setup, &reason);
    if (err)
        return plan_refuse(fault, err, "loop", i + 1u, reason.field, name, reason.wanted);
    const char *uncompensated = plan_kind(plan, i)->uncompensated;
    if (plan->loop[i].decouple && uncompensated)
        return plan_refuse(fault, ERR_CONFLICT, "loop", i + 1u, "decouple", name, uncompensated);
    return ERR_OK;
}

enum err plan_check_matrix(struct plan *plan, struct config_fault *fault)
{
    struct block_setup setup;
    struct matrix_settings matrix;
    struct block_fault reason;
    plan_setup_matrix(plan, &setup, &matrix);
    if (!setup.present)
        return ERR_OK;
    plan->block[BLOCK_MATRIX].kind = plan_find_kind(plan, BLOCK_MATRIX);
    if (plan->block[BLOCK_MATRIX].kind == PLAN_NONE)
        return plan_refuse(fault, ERR_UNSUPPORTED, "decouple", 1, "d1", "", NOT_IN_BUILD);
    enum err err = plan_kind(plan, BLOCK_MATRIX)->check(&setup, &reason);
    return err ? plan_refuse(fault, err, "decouple", reason.member + 1u, reason.field,
                             plan->config.loop[reason.member].name, reason.wanted)
               : ERR_OK;
}

enum err plan_check_feedforward(struct plan *plan, uint8_t k, struct config_fault *fault)
{
    struct block_instance b;
    struct block_fault reason;
    const char *from = plan->config.feedforward[k].from;
    uint8_t block = (uint8_t)(BLOCK_FEEDFORWARDS + k);
    plan->block[block].kind = plan_find_kind(plan, block);
    if (plan->block[block].kind == PLAN_NONE)
        return plan_refuse(fault, ERR_UNSUPPORTED, "ff", k + 1u, "from", from, NOT_IN_BUILD);
    plan_setup_feedforward(plan, k, &b);
    enum err err = plan_kind(plan, block)->check(&b.setup, &reason);
    if (err && !reason.field[0])
        return plan_refuse(fault, err, "tick", 0, "base", from, reason.wanted);
    return err ? plan_refuse(fault, err, "ff", k + 1u, reason.field, from, reason.wanted) : ERR_OK;
}

static enum err refuse_memory(const struct plan *plan, uint8_t block, struct config_fault *fault)
{
    static const char *const wanted = "finds no memory";
    const struct config *c = &plan->config;
    if (CONFIG_BLOCKS && block >= BLOCK_NUMBERED) {
        unsigned n = block - BLOCK_NUMBERED;
        return plan_refuse(fault, ERR_MEMORY, "block", n + 1u, "kind", c->block[n].kind, wanted);
    }
    if (block >= BLOCK_FEEDFORWARDS) {
        unsigned k = block - BLOCK_FEEDFORWARDS;
        return plan_refuse(fault, ERR_MEMORY, "ff", k + 1u, "dead", c->feedforward[k].from,
                           "dead times need more memory than this board has");
    }
    return plan_refuse(fault, ERR_MEMORY, "loop", block + 1u, "algorithm", c->loop[block].name,
                       wanted);
}

static void list_stages(struct plan *plan)
{
    uint8_t n =
        plan->listed_end[STAGE_CONTROL]; /* these are listed already, as their loops are ordered */
    for (unsigned stage = STAGE_CONTROL + 1; stage < BLOCK_STAGES; stage++) {
        for (uint8_t block = BLOCK_MATRIX; block < PLAN_BLOCKS; block++)
            if (plan->block[block].kind != PLAN_NONE && plan_kind(plan, block)->stage == stage)
                plan->listed[n++] = block;
        plan->listed_end[stage] = n;
    }
}

enum err plan_place_blocks(struct plan *plan, struct config_fault *fault)
{
    uint8_t n[PLACED_KINDS];
    arena_count(plan, n);
    uint32_t at = arena_state_bytes(n) / ARENA_GRAIN;
    list_stages(plan);
    for (uint8_t block = 0; block < PLAN_BLOCKS; block++) {
        struct block_place *place = &plan->block[block];
        uint32_t grains = 0;
        if (place->kind != PLAN_NONE) {
            struct block_instance b;
            plan_block_setup(plan, block, &b);
            uint32_t bytes = plan_kind(plan, block)->bytes(&b.setup);
            grains = ARENA_GRAINS(bytes);
            place->spare = (uint8_t)(grains * ARENA_GRAIN - bytes);
            grains += plan_grains_behind(plan, block);
        }
        if (at + grains > PLAN_ARENA_BYTES / ARENA_GRAIN) {
            enum err err = refuse_memory(plan, block, fault);
            fault->bytes = (at + grains) * ARENA_GRAIN;
            return err;
        }
        place->grain = (uint16_t)at;
        place->grains = (uint16_t)grains;
        at += grains;
    }
    return plan_resolve_histories(plan, at, fault);
}
