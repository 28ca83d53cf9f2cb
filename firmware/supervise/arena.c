#include "supervise/arena.h"

#include <stddef.h>
#include <string.h>

#include "exchange/arena_sizes.h"

/* States with a place in the arena: the kinds of enum placed, then the blocks, then the histories. Their order
 * never changes. */
#define PLACED_BLOCKS (PLACED_KINDS + PLAN_BLOCKS)
#define PLACES        (PLACED_BLOCKS + PLAN_POINTS)

struct place {
    uint32_t from, to;     /* grains */
    uint32_t kept, grains; /* bytes of the state that stay; grains of the new place */
};

/* Returns the grain of the history of MV j, behind the blocks and the histories before it. */
static uint32_t history_from(uint32_t behind_blocks, const uint16_t *ticks, uint8_t j)
{
    for (uint8_t k = 0; k < j; k++)
        behind_blocks += arena_history_grains(ticks[k]);
    return behind_blocks;
}

static uint32_t behind_blocks(const struct supervisor *s)
{
    const struct block_state *last = &s->block[PLAN_BLOCKS - 1];
    return (uint32_t)last->grain + last->grains;
}

static void find_history(const struct supervisor *s, const struct plan *plan, uint8_t j,
                         struct place *p)
{
    if (!s->history[j] && !plan->history[j])
        return; /* most MVs have none */
    const struct block_place *last = &plan->block[PLAN_BLOCKS - 1];
    p->from = history_from(behind_blocks(s), s->history, j);
    p->to = history_from((uint32_t)last->grain + last->grains, plan->history, j);
    p->grains = arena_history_grains(plan->history[j]);
    uint16_t least = s->history[j] < plan->history[j] ? s->history[j] : plan->history[j];
    p->kept = least ? applied_history_bytes(least) : 0;
}

static void find_place(const struct supervisor *s, const struct plan *plan,
                       const uint8_t n[PLACED_KINDS], unsigned which, struct place *p)
{
    *p = (struct place){0};
    if (CONFIG_BLOCKS && which >= PLACED_BLOCKS) {
        find_history(s, plan, (uint8_t)(which - PLACED_BLOCKS), p);
        return;
    }
    if (which >= PLACED_KINDS) {
        const struct block_state *before = &s->block[which - PLACED_KINDS];
        const struct block_place *now = &plan->block[which - PLACED_KINDS];
        p->from = before->grain;
        p->to = now->grain;
        p->grains = now->grains;
        if (before->kind == now->kind && before->grains == now->grains)
            p->kept = now->grains * ARENA_GRAIN;
        return;
    }
    for (unsigned k = 0; k < which; k++) {
        p->from += arena_kind_grains((enum placed)k, s->placed[k]);
        p->to += arena_kind_grains((enum placed)k, n[k]);
    }
    p->kept = (uint32_t)(s->placed[which] < n[which] ? s->placed[which] : n[which]) *
              arena_kind_bytes((enum placed)which);
    p->grains = arena_kind_grains((enum placed)which, n[which]);
}

static uint8_t *arena_at(const struct supervisor *s, uint32_t grains)
{
    REFLUX_ASSERT(grains <= PLAN_ARENA_BYTES / ARENA_GRAIN);
    return (uint8_t *)s->arena + (size_t)grains * ARENA_GRAIN;
}

struct applied_history *arena_history(const struct supervisor *s, uint8_t j)
{
    return (void *)arena_at(s, history_from(behind_blocks(s), s->history, j));
}

static void move_place(struct supervisor *s, const struct place *p, bool down)
{
    REFLUX_ASSERT(p->kept <= PLAN_ARENA_BYTES &&
                  p->to + p->grains <= PLAN_ARENA_BYTES / ARENA_GRAIN);
    if (p->to != p->from && down == (p->to < p->from))
        memmove(arena_at(s, p->to), arena_at(s, p->from), p->kept);
}

void arena_place(struct supervisor *s, const struct plan *plan)
{
    uint8_t n[PLACED_KINDS];
    struct place p;
    void *place[PLACED_KINDS];
    arena_count(plan, n);
    /* States that move down go first, the lowest before the others; then those that move up, the highest before the
     * others. The order of states never changes, so no state overwrites one that has still to move. */
    for (unsigned k = 0; k < PLACES; k++) {
        find_place(s, plan, n, k, &p);
        move_place(s, &p, true);
    }
    for (unsigned k = PLACES; k-- > 0;) {
        find_place(s, plan, n, k, &p);
        move_place(s, &p, false);
    }
    for (unsigned k = 0; k < PLACES; k++) {
        find_place(s, plan, n, k, &p);
        memset(arena_at(s, p.to) + p.kept, 0, (size_t)p.grains * ARENA_GRAIN - p.kept);
        if (k < PLACED_KINDS)
            place[k] = arena_at(s, p.to);
    }
    memcpy(s->placed, n, PLACED_KINDS);
    for (uint8_t b = 0; b < PLAN_BLOCKS; b++) {
        const struct block_place *now = &plan->block[b];
        struct block_state *state = &s->block[b];
        if (state->kind != now->kind)
            *state = (struct block_state){.kind = now->kind};
        state->grain = now->grain;
        state->grains = now->grains;
    }
    memcpy(s->history, plan->history, sizeof s->history);
    s->measurement = place[PLACED_MEASUREMENTS];
    s->mv = place[PLACED_MVS];
    s->loop = place[PLACED_LOOPS];
    s->interlock = place[PLACED_INTERLOCKS];
    s->alarm = place[PLACED_ALARMS];
}
