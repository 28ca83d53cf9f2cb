/* Compensators and feedforward elements with a number (blockN), in a plan. */
#include "exchange/block_settings.h"
#include "exchange/block_setup.h"
#include "exchange/numbered_setup.h"
#include "plan/plan_parts.h"

_Static_assert(CHANNEL_MAX <= 32, "a bit for each manipulated variable");

static enum err refuse_stage(struct config_fault *fault, enum err code, uint8_t n,
                             const char *field, const char *subject, const char *wanted)
{
    return plan_refuse(fault, code, "block", n + 1u, field, subject, wanted);
}

enum err plan_resolve_added(struct plan *plan, uint8_t n, struct config_fault *fault)
{
    struct numbered_plan *r = &plan->numbered[n];
    const struct block_kind *kind = plan_kind(plan, (uint8_t)(BLOCK_NUMBERED + n));
    char name[CHANNEL_NAME_SIZE];
    for (const char *at = plan->config.block[n].points; (at = plan_next_name(at, name)) != NULL;) {
        uint8_t j = config_find_mv(&plan->config, name);
        if (j == PLAN_NONE || plan->owner[j] == PLAN_NONE)
            return refuse_stage(fault, ERR_UNKNOWN, n, "points", name,
                                "must be a manipulated variable that a loop drives");
        for (uint8_t k = 0; k < r->points; k++)
            if (r->point[k] == j)
                return refuse_stage(fault, ERR_CONFLICT, n, "points", name, "is named twice");
        if (r->points >= kind->points_most)
            return refuse_stage(fault, ERR_RANGE, n, "points", name,
                                "is one more than this kind adds to");
        r->point[r->points++] = j;
    }
    return ERR_OK;
}

/* Refuses a compensator on a loop whose blockN gives outputs that may pass through no compensator. */
static enum err check_compensated(const struct plan *plan, uint8_t n, struct config_fault *fault)
{
    const struct numbered_plan *r = &plan->numbered[n];
    for (uint8_t k = 0; k < r->members; k++) {
        uint8_t server = plan->server[r->member[k]];
        if (server == PLAN_NONE || plan->block[server].kind == PLAN_NONE)
            continue;
        const char *uncompensated = plan_kind(plan, server)->uncompensated;
        if (uncompensated)
            return refuse_stage(fault, ERR_CONFLICT, n, "loops",
                                plan->config.loop[r->member[k]].name, uncompensated);
    }
    return ERR_OK;
}

enum err plan_check_stage(const struct plan *plan, uint8_t n, struct config_fault *fault)
{
    const struct numbered_plan *r = &plan->numbered[n];
    const char *kind = plan->config.block[n].kind;
    if (plan_has_stage(plan, n, STAGE_COMPENSATE))
        return check_compensated(plan, n, fault);
    if (!plan_has_stage(plan, n, STAGE_FEED_FORWARD))
        return ERR_OK;
    if (!r->inputs)
        return refuse_stage(fault, ERR_EMPTY, n, "inputs", kind, "must name what it looks at");
    if (!r->points)
        return refuse_stage(fault, ERR_EMPTY, n, "points", kind,
                            "must name the manipulated variables it adds to");
    return ERR_OK;
}

/* ---- rings ---- */

/* Returns the MVs that blockN moves in response to its inputs, a bit each. */
static uint32_t moved_by(const struct plan *plan, uint8_t n)
{
    const struct numbered_plan *r = &plan->numbered[n];
    uint32_t mvs = 0;
    if (plan_has_stage(plan, n, STAGE_FEED_FORWARD))
        for (uint8_t k = 0; k < r->points; k++)
            mvs |= 1u << r->point[k];
    if (plan_has_stage(plan, n, STAGE_COMPENSATE))
        for (uint8_t k = 0; k < r->members; k++)
            mvs |= 1u << plan->loop[r->member[k]].mv;
    return mvs;
}

/* Fills moves[j] with the MVs that MV j moves: by a feedforward element or compensator that looks at it, or through
 * others. */
static void find_moves(const struct plan *plan, uint32_t moves[CHANNEL_MAX])
{
    for (uint8_t j = 0; j < CHANNEL_MAX; j++)
        moves[j] = 0;
    for (uint8_t k = 0; k < CONFIG_FEEDFORWARDS; k++)
        if (plan->feedforward[k].input != PLAN_NONE && (plan->feedforward[k].input & INPUT_IS_MV))
            moves[plan->feedforward[k].input & ~INPUT_IS_MV] |= 1u << plan->feedforward[k].point;
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++)
        for (uint8_t k = 0; k < plan->numbered[n].inputs; k++)
            if (plan->numbered[n].input[k] & INPUT_IS_MV)
                moves[plan->numbered[n].input[k] & ~INPUT_IS_MV] |= moved_by(plan, n);
    for (uint8_t through = 0; through < CHANNEL_MAX; through++)
        for (uint8_t j = 0; j < CHANNEL_MAX; j++)
            if (moves[j] & (1u << through))
                moves[j] |= moves[through];
}

/* A block that looks at an MV that it moves, itself or through others, would drive itself. */
enum err plan_check_rings(const struct plan *plan, struct config_fault *fault)
{
    uint32_t moves[CHANNEL_MAX];
    find_moves(plan, moves);
    for (uint8_t n = 0; n < CONFIG_BLOCKS; n++)
        for (uint8_t k = 0; k < plan->numbered[n].inputs; k++) {
            uint8_t j = plan->numbered[n].input[k] & (uint8_t)~INPUT_IS_MV;
            if ((plan->numbered[n].input[k] & INPUT_IS_MV) && moved_by(plan, n) &&
                (moves[j] & (1u << j)))
                return refuse_stage(fault, ERR_CYCLE, n, "inputs", plan->config.mv[j].name,
                                    "is moved by what looks at it");
        }
    return ERR_OK;
}
