#include "kinds/composition/composition_analysis.h"

#include <string.h>

#include "base/assertion.h"
#include "kinds/composition/composition_analysis_state.h"

/* Share g, where none is given. */
#define SHARE_INITIAL REAL_C(0.7)

/* ---- one analysis ---- */

uint16_t composition_analysis_every(real_t h, real_t reach)
{
    real_t every = reach / (h * (real_t)(ANALYSIS_PAST - 1u));
    return every < REAL_C(60000.0) ? (uint16_t)(every + REAL_C(1.0)) : 60000u;
}

void composition_analysis_begin(struct composition_analysis *a, real_t h, real_t reach)
{
    memset(a->past, 0, sizeof a->past);
    a->newest = a->filled = a->counted = 0;
    a->every = composition_analysis_every(h, reach);
    a->correction = a->surprise = a->age_s = REAL_C(0.0);
    a->seen = a->rejected = a->fresh = false;
}

static void remember(struct composition_analysis *a, real_t x)
{
    REFLUX_ASSERT(a->newest < ANALYSIS_PAST);
    if (a->filled > 0 && ++a->counted < a->every)
        return;
    a->counted = 0;
    a->newest = (uint16_t)((a->newest + 1u) % ANALYSIS_PAST);
    a->past[a->newest] = (float)x;
    if (a->filled < ANALYSIS_PAST)
        a->filled++;
}

/* Recalls the estimate of age_s ago, by the nearest that is kept; false: none is. */
static bool recall(const struct composition_analysis *a, real_t h, real_t age_s, real_t *x)
{
    REFLUX_ASSERT(a->newest < ANALYSIS_PAST && a->filled <= ANALYSIS_PAST);
    real_t steps = age_s / h - (real_t)a->counted, slots = steps / (real_t)a->every;
    if (slots < REAL_C(0.0))
        slots = REAL_C(0.0);
    if (!(slots + REAL_C(0.5) < (real_t)a->filled))
        return false;
    uint32_t back = (uint32_t)(slots + REAL_C(0.5));
    *x = a->past[(a->newest + ANALYSIS_PAST - back) % ANALYSIS_PAST];
    return true;
}

bool composition_analysis_step(struct composition_analysis *a, real_t h, real_t x,
                               const struct composition_sample *sample)
{
    real_t past, left;
    remember(a, x);
    bool is_new = sample->usable && (!a->seen || sample->age_s < a->age_s + h / REAL_C(2.0));
    if (sample->usable)
        a->age_s = sample->age_s;
    a->seen = a->seen || sample->usable;
    if (!is_new)
        return false;
    if (!recall(a, h, sample->age_s, &past))
        return true;
    left = sample->y - (past + a->correction);
    a->surprise = left;
    a->rejected = sample->most > REAL_C(0.0) && real_abs(left) > sample->most;
    a->fresh = !a->rejected && a->filtered;
    a->moved = x - past;
    if (!a->rejected && !a->filtered)
        a->correction += a->share * left;
    return false;
}

/* ---- those of a block ---- */

void composition_analyses_begin(struct composition_analyses *all, struct composition_model *model,
                                real_t reach)
{
    for (uint8_t k = 0; k < all->n; k++) {
        real_t *offset = composition_model_offset(model, k);
        composition_analysis_begin(&all->analysis[k], composition_model_h(model), reach);
        if (offset)
            *offset = REAL_C(0.0);
    }
}

void composition_analyses_set(struct composition_analyses *all, struct composition_model *model,
                              const struct block_setup *setup, bool keep)
{
    const struct composition_record *r = setup->settings;
    uint16_t before = all->n ? all->analysis[0].every : 0;
    all->n = 0;
    for (unsigned k = 0; k < setup->inputs; k++) {
        if (r->s.role[k] != IS_ANALYSIS)
            continue;
        REFLUX_ASSERT(all->n < ANALYSES_MAX);
        struct composition_analysis *a = &all->analysis[all->n++];
        a->input = (uint8_t)k;
        a->stage = (uint8_t)(r->s.place[k][AT_STAGE] - 1u);
        a->component = (uint8_t)(r->s.place[k][OF_COMPONENT] - 1u);
        a->share = r->tune[k][TUNE_LAMBDA] > 0 ? r->tune[k][TUNE_LAMBDA] : SHARE_INITIAL;
    }
    if (!keep || before != composition_analysis_every(composition_model_h(model), r->s.reach_s))
        composition_analyses_begin(all, model, r->s.reach_s);
}

bool composition_analyses_step(struct composition_analyses *all, struct composition_model *model,
                               unsigned i, const struct composition_sample *sample, bool filtered)
{
    REFLUX_ASSERT(i < all->n);
    struct composition_analysis *a = &all->analysis[i];
    real_t *offset = composition_model_offset(model, i);
    if (offset)
        a->correction = *offset;
    a->filtered = filtered;
    bool too_old = composition_analysis_step(
        a, composition_model_h(model), composition_model_fraction(model, a->stage, a->component),
        sample);
    if (offset)
        *offset = a->correction;
    return too_old || a->rejected;
}

unsigned composition_analyses_count(const struct composition_analyses *all)
{
    return all->n;
}

unsigned composition_analyses_input(const struct composition_analyses *all, unsigned i)
{
    REFLUX_ASSERT(i < all->n);
    return all->analysis[i].input;
}

real_t composition_analyses_correction(const struct composition_analyses *all, unsigned i)
{
    REFLUX_ASSERT(i < all->n);
    return all->analysis[i].correction;
}

bool composition_analyses_is_at(const struct composition_analyses *all, unsigned i, size_t stage,
                                size_t component)
{
    REFLUX_ASSERT(i < all->n);
    return all->analysis[i].stage == stage && all->analysis[i].component == component;
}

unsigned composition_analyses_find(const struct composition_analyses *all, size_t stage,
                                   size_t component)
{
    for (uint8_t i = 0; i < all->n; i++)
        if (composition_analyses_is_at(all, i, stage, component))
            return i;
    return ANALYSES_MAX;
}

bool composition_analyses_in_section(const struct composition_analyses *all, size_t feed_stage,
                                     bool above)
{
    for (uint8_t i = 0; i < all->n; i++)
        if ((all->analysis[i].stage + 1u > feed_stage) == above)
            return true;
    return false;
}

size_t composition_analyses_stage(const struct composition_analyses *all, unsigned i)
{
    REFLUX_ASSERT(i < all->n);
    return all->analysis[i].stage;
}

size_t composition_analyses_component(const struct composition_analyses *all, unsigned i)
{
    REFLUX_ASSERT(i < all->n);
    return all->analysis[i].component;
}

bool composition_analyses_take(struct composition_analyses *all, unsigned i, real_t *surprise,
                               real_t *moved)
{
    REFLUX_ASSERT(i < all->n);
    struct composition_analysis *a = &all->analysis[i];
    if (!a->fresh)
        return false;
    *surprise = a->surprise;
    *moved = a->moved;
    a->fresh = false;
    return true;
}
