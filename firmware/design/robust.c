#include "design/robust.h"

#include <stddef.h>
#include <string.h>

#include "base/assertion.h"
#include "design/robust_choice.h"

#define STEP_FIRST    REAL_C(0.4) /* of ln gain and ln Ti */
#define STEP_LEAST    REAL_C(0.05)
#define STEP_AGAIN    REAL_C(0.2) /* after a retreat */
#define RETREAT       REAL_C(0.2)
#define RETREATS_MOST 60
#define MARGIN_FIRST                                                                               \
    REAL_C(0.99) /* of the bounds, for what lies between the frequencies of a pass */
#define MARGIN_LESS REAL_C(0.995)
#define TRIES_MOST  5 /* of a climb that the whole curve does not confirm */
#define ROUNDS_MOST 4
#define PASSES_MOST 250
/* The same bounds for more than ROBUST_PAIRED_LOOPS loops. */
#define PASSES_MOST_OF_MANY 60
#define ACTIVE_OF_MANY      2
#define ROUND_LOOPS         8 /* of more the members are judged only with all gains to be lowered */
#define STEP_FIRST_OF_MANY  REAL_C(0.2)
#define STEP_LEAST_OF_MANY  REAL_C(0.1)
#define LOWER_BY            REAL_C(0.07)
#define LOWER_LEAST         REAL_C(0.01)
#define UNSTABLE            REAL_C(1e3)
#define WIDENED_MOST        REAL_C(2.5) /* of the logarithm of the highest frequency of a pass */
#define WIDER               REAL_C(3.0) /* frequencies beyond those at which the loops act */

enum {
    STAGE_JUDGE_DRAW,
    STAGE_JUDGE_BEGIN,
    STAGE_JUDGE,
    STAGE_PASS_DRAW,
    STAGE_PASS_BEGIN,
    STAGE_PASS,
    STAGE_OVER
};

/* Why a plant is judged. */
enum {
    GOAL_RETREAT,  /* until it is good, to begin a climb */
    GOAL_CONFIRM,  /* the nominal plant, after a climb */
    GOAL_ROUND,    /* every member */
    GOAL_TOGETHER, /* every plant with all parts, and gains lowered until it is good */
};

/* ---- settings ---- */

/* The settings under trial are good. */
static void keep_settings(struct robust *r)
{
    for (size_t k = 0; k < r->part.pairs.n; k++)
        r->loops.tuning[r->place[k]] = r->part.tuning[k];
}

static void restore_settings(struct robust *r)
{
    for (size_t k = 0; k < r->part.pairs.n; k++)
        r->part.tuning[k] = r->loops.tuning[r->place[k]];
}

/* Lowers the gain of a loop by e^-by. Its integral time rises by half as much, without which a lag-dominant loop would swing. */
static void slow_loop(struct robust *r, size_t k, real_t by)
{
    REFLUX_ASSERT(k < INTERACT_MAX);
    struct tuning *t = &r->part.tuning[k];
    t->gain = real_clamp(t->gain * real_exp(-by), ROBUST_GAIN_LEAST, r->part_gain_most[k]);
    t->ti_s = real_clamp(t->ti_s * real_exp(REAL_C(0.5) * by), ROBUST_TI_LEAST_S, ROBUST_TI_MOST_S);
}

static void retreat(struct robust *r, real_t by)
{
    for (size_t k = 0; k < r->part.pairs.n; k++)
        slow_loop(r, k, by);
}

/* ---- what comes next ---- */

static enum err judge_plant(struct robust *r, uint16_t plant, uint8_t goal)
{
    r->judged = plant;
    r->goal = goal;
    r->stage = plant ? STAGE_JUDGE_DRAW : STAGE_JUDGE_BEGIN;
    return ERR_BUSY;
}

/* Bound on |T| while the settings are searched. */
static real_t t_limit(const struct robust *r, uint16_t plant)
{
    return plant ? r->config.t_most : r->config.t_nominal;
}

static const struct interact_plant *plant_of(const struct robust *r, uint16_t plant)
{
    return plant ? &r->member : r->plant;
}

static enum err next_active(struct robust *r)
{
    REFLUX_ASSERT(r->at_active < ROBUST_ACTIVE);
    r->stage = r->active[r->at_active] ? STAGE_PASS_DRAW : STAGE_PASS_BEGIN;
    return ERR_BUSY;
}

static enum err try_all_moves(struct robust *r)
{
    robust_pass_begin(&r->work.pass, &r->part, &r->limits, r->step,
                      r->moved > 1 ? r->loops.tuning : NULL, r->place);
    r->passes++;
    r->part_passes++;
    r->at_active = 0;
    return next_active(r);
}

static enum err begin_climb(struct robust *r, real_t step)
{
    keep_settings(r);
    r->step = step;
    r->moved = 0;
    r->moved_most = r->part.pairs.n > ROBUST_PAIRED_LOOPS ? r->part.pairs.n : 1;
    return try_all_moves(r);
}

static void take_part(struct robust *r, size_t first)
{
    const struct loops *all = &r->loops;
    r->part.pairs.n = 0;
    for (size_t k = first; k < all->pairs.n; k++) {
        if (!r->joint && r->config.part[k] != r->config.part[first])
            continue;
        uint8_t at = r->part.pairs.n++;
        r->place[at] = (uint8_t)k;
        r->part.pairs.output[at] = all->pairs.output[k];
        r->part.pairs.input[at] = all->pairs.input[k];
        r->part.tuning[at] = all->tuning[k];
        r->part_gain_most[at] = r->config.gain_most[k];
        r->done = (uint16_t)(r->done | 1u << k);
    }
}

static enum err begin_search(struct robust *r)
{
    size_t first = 0;
    while (((unsigned)r->done >> first & 1u) != 0u)
        first++;
    REFLUX_ASSERT(first < r->loops.pairs.n);
    take_part(r, first);
    r->active[0] = 0;
    r->actives = 1;
    r->margin = MARGIN_FIRST;
    r->step = r->part.pairs.n > ROBUST_PAIRED_LOOPS ? STEP_FIRST_OF_MANY : STEP_FIRST;
    r->retreats = r->tries = r->rounds = 0;
    r->part_passes = 0;
    return judge_plant(r, 0, GOAL_RETREAT);
}

/* All parts have their settings: every plant is judged with all loops. */
static enum err begin_together(struct robust *r)
{
    r->joint = true;
    r->done = 0;
    take_part(r, 0);
    r->rounds = 0;
    r->changed = false;
    r->s_worst = r->t_worst = REAL_C(0.0);
    return judge_plant(r, 0, GOAL_TOGETHER);
}

static enum err end_part_search(struct robust *r, bool held)
{
    if (r->done != (uint16_t)((1ul << r->loops.pairs.n) - 1u))
        return begin_search(r);
    if (held && r->part.pairs.n == r->loops.pairs.n) {
        r->stage = STAGE_OVER; /* of a single part every plant has been judged just now */
        return ERR_OK;
    }
    return begin_together(r);
}

/* ---- results of a judgement ---- */

static void note_peaks(struct robust *r, bool stable)
{
    const struct peaks *p = &r->work.nyquist.peaks;
    real_t s = REAL_C(0.0), t = REAL_C(0.0);
    for (size_t k = 0; k < p->loops; k++) {
        s = p->s[k] > s ? p->s[k] : s;
        t = p->t[k] > t ? p->t[k] : t;
    }
    if (!stable)
        s = t = INFINITY;
    if (r->judged == 0) {
        r->s_nominal = s;
        r->t_nominal = t;
        r->s_worst = r->t_worst = REAL_C(0.0);
    }
    if (r->judged == 0 || s > r->s_worst) {
        r->s_worst = s;
        r->worst_member = r->judged ? (uint16_t)(r->judged - 1u) : r->config.members;
    }
    r->t_worst = t > r->t_worst ? t : r->t_worst;
}

static void take_range(struct robust *r)
{
    const struct peaks *p = &r->work.nyquist.peaks;
    r->omega_lo = p->omega_lo / WIDER;
    r->omega_hi = p->omega_hi * WIDER;
    r->widened = REAL_C(0.0);
}

static enum err end_retreat(struct robust *r, bool stable, bool good)
{
    if (r->judged == 0 && stable)
        take_range(r);
    if (good)
        return begin_climb(r, r->step);
    if (r->retreats >= RETREATS_MOST) { /* slower loops are of no use to this plant */
        restore_settings(r);
        return end_part_search(r, false);
    }
    r->retreats++;
    retreat(r, RETREAT);
    return judge_plant(r, r->judged, GOAL_RETREAT);
}

/* After a climb. Where a peak lay between the frequencies of its passes, the next climb keeps more distance. */
static enum err end_confirm(struct robust *r, bool stable, real_t excess)
{
    if (stable)
        take_range(r);
    if (excess <= REAL_C(1.0)) {
        if (r->config.members == 0)
            return end_part_search(r, true);
        if (r->part.pairs.n > ROUND_LOOPS)
            return end_part_search(r, false);
        r->worst = 0;
        r->worst_excess = REAL_C(1.0);
        return judge_plant(r, 1, GOAL_ROUND);
    }
    if (r->tries >= TRIES_MOST)
        return end_part_search(r, false);
    r->tries++;
    real_t more = excess < REAL_C(1.2) ? excess : REAL_C(1.2);
    r->margin *= MARGIN_LESS / more;
    r->retreats = 0;
    r->step = STEP_LEAST * REAL_C(2.0);
    retreat(r, REAL_C(0.5) * RETREAT);
    return judge_plant(r, 0, GOAL_RETREAT);
}

static enum err end_round(struct robust *r, real_t excess)
{
    if (excess > r->worst_excess) {
        r->worst_excess = excess;
        r->worst = r->judged;
    }
    if (r->judged < r->config.members)
        return judge_plant(r, (uint16_t)(r->judged + 1u), GOAL_ROUND);
    if (r->worst == 0)
        return end_part_search(r, true);
    unsigned most = r->part.pairs.n > ROBUST_PAIRED_LOOPS ? ACTIVE_OF_MANY : ROBUST_ACTIVE;
    if (r->actives >= most)
        return end_part_search(r, false);
    r->active[r->actives++] = r->worst;
    r->retreats = 0;
    r->step = STEP_AGAIN;
    return judge_plant(r, r->worst, GOAL_RETREAT);
}

/* Slows the part of the loop that exceeds its bounds most, or all where nothing is known: integral times go up by half as much as
 * gains go down, as in retreat(). */
static void lower_gains(struct robust *r, bool stable)
{
    uint8_t loop = 0;
    (void)peaks_excess(&r->work.nyquist.peaks, r->config.s_most, r->config.t_most, &loop);
    bool all = !stable || r->loops.decoupler != NULL;
    for (size_t k = 0; k < r->part.pairs.n; k++)
        if (all || r->config.part[k] == r->config.part[loop])
            slow_loop(r, k, LOWER_BY);
    r->factor *= real_exp(-LOWER_BY);
    r->changed = true;
}

static enum err end_together(struct robust *r, bool stable, bool good)
{
    if (!good && r->factor > LOWER_LEAST) {
        lower_gains(r, stable);
        return judge_plant(r, r->judged, GOAL_TOGETHER);
    }
    note_peaks(r, stable);
    if (!good) { /* lower gains were of no use */
        r->worst_member = r->judged ? (uint16_t)(r->judged - 1u) : r->config.members;
        r->stage = STAGE_OVER;
        return ERR_TIMEOUT;
    }
    if (r->judged < r->config.members)
        return judge_plant(r, (uint16_t)(r->judged + 1u), GOAL_TOGETHER);
    if (r->changed && ++r->rounds < ROUNDS_MOST) {
        r->changed = false;
        return judge_plant(r, 0, GOAL_TOGETHER);
    }
    keep_settings(r);
    r->stage = STAGE_OVER;
    return ERR_OK;
}

static enum err end_judgement(struct robust *r, bool stable)
{
    real_t excess = UNSTABLE;
    real_t t_most = r->goal == GOAL_TOGETHER ? r->config.t_most : t_limit(r, r->judged);
    if (stable)
        excess = peaks_excess(&r->work.nyquist.peaks, r->config.s_most, t_most, NULL);
    if (r->goal == GOAL_CONFIRM || r->goal == GOAL_ROUND)
        note_peaks(r, stable);
    switch (r->goal) {
    case GOAL_RETREAT:
        return end_retreat(r, stable, excess <= REAL_C(1.0));
    case GOAL_CONFIRM:
        return end_confirm(r, stable, excess);
    case GOAL_ROUND:
        return end_round(r, excess);
    default:
        return end_together(r, stable, excess <= REAL_C(1.0));
    }
}

/* ---- results of a pass ---- */

/* The moves just made may have made loops faster than they were when the frequencies were chosen. */
static void widen_range(struct robust *r)
{
    if (r->moved == 0)
        return;
    real_t by = r->step * robust_rise(r->part.pairs.n, r->chosen, r->moved);
    r->omega_hi *= real_exp(by);
    r->widened += by;
}

/* Makes the best of the chosen moves, as many as may be made at once. */
static enum err make_moves(struct robust *r)
{
    uint8_t n = r->choices < r->moved_most ? r->choices : r->moved_most;
    r->moved = 0;
    for (uint8_t c = 0; c < n; c++) {
        struct robust_move move = robust_move(r->part.pairs.n, r->chosen[c]);
        if (robust_make_move(&r->part, &move, r->step, &r->limits))
            r->moved = (uint8_t)(r->moved + 1u);
    }
    return try_all_moves(r);
}

static enum err end_climb(struct robust *r)
{
    restore_settings(r);
    return judge_plant(r, 0, GOAL_CONFIRM);
}

static enum err end_pass(struct robust *r)
{
    bool many = r->part.pairs.n > ROBUST_PAIRED_LOOPS;
    bool last = r->part_passes >= (many ? PASSES_MOST_OF_MANY : PASSES_MOST);
    bool unsure = r->moved > 1 && !(r->work.pass.away < REAL_C(1.0));
    if (unsure || (r->work.pass.present > REAL_C(1.0) && r->moved > 1)) { /* too many at once */
        restore_settings(r);
        r->moved_most = (uint8_t)(r->moved / 2u);
        return last ? end_climb(r) : make_moves(r);
    }
    if (r->work.pass.present > REAL_C(1.0) && r->moved == 0 && r->retreats < RETREATS_MOST) {
        r->retreats++; /* between the frequencies of the judgement, or with less margin */
        retreat(r, REAL_C(0.5) * RETREAT);
        keep_settings(r);
        return last ? end_climb(r) : try_all_moves(r);
    }
    if (r->work.pass.present > REAL_C(1.0)) {
        restore_settings(r); /* by rounding only */
        r->choices = 0;
    } else {
        keep_settings(r);
        widen_range(r);
        if (r->widened > WIDENED_MOST && !last)
            return judge_plant(r, 0, GOAL_RETREAT); /* chooses the frequencies anew */
        if (many && r->moved == r->moved_most && r->moved_most < r->part.pairs.n)
            r->moved_most = (uint8_t)(2u * r->moved_most);
        r->choices = robust_choose(&r->work.pass, r->moved_most, r->chosen);
    }
    if (last)
        return end_climb(r);
    if (r->choices > 0)
        return make_moves(r);
    r->moved = 0;
    r->step *= REAL_C(0.5);
    real_t least = many ? STEP_LEAST_OF_MANY : STEP_LEAST;
    return r->step < REAL_C(0.99) * least ? end_climb(r) : try_all_moves(r);
}

/* ---- steps ---- */

enum err robust_begin(struct robust *r, const struct interact_plant *plant,
                      const struct loops *start, const struct robust_config *config,
                      struct interact_refusal *reason)
{
    struct interact_refusal unused;
    reason = reason ? reason : &unused;
    enum err err = interact_check(plant, reason);
    if (!err)
        err = loops_check(plant, start, reason);
    if (!err)
        err = robust_config_check(config, start, reason);
    if (err)
        return err;
    memset(r, 0, sizeof *r);
    r->plant = plant;
    r->config = *config;
    r->loops = r->part = *start;
    r->joint = start->decoupler != NULL;
    r->limits.gain_least = ROBUST_GAIN_LEAST;
    r->limits.ti_least_s = ROBUST_TI_LEAST_S;
    r->limits.ti_most_s = ROBUST_TI_MOST_S;
    r->limits.gain_most = r->part_gain_most;
    r->factor = REAL_C(1.0);
    for (size_t k = 0; k < start->pairs.n; k++)
        r->loops.tuning[k].gain =
            real_clamp(start->tuning[k].gain, ROBUST_GAIN_LEAST, config->gain_most[k]);
    return begin_search(r) == ERR_BUSY ? ERR_OK : ERR_STATE;
}

/* A row a call: a plant of 16 by 16 is a long piece of work. */
static enum err draw_member(struct robust *r, uint16_t plant, uint8_t next)
{
    r->config.draw(r->config.context, (uint16_t)(plant - 1u), r->drawn, &r->member);
    if (++r->drawn < r->plant->outputs)
        return ERR_BUSY;
    r->drawn = 0;
    r->stage = next;
    return ERR_BUSY;
}

/* A member that makes no sense counts as unstable. */
static enum err begin_judgement(struct robust *r)
{
    if (nyquist_begin_peaks(&r->work.nyquist, plant_of(r, r->judged), &r->part) != ERR_OK)
        return end_judgement(r, false);
    r->stage = STAGE_JUDGE;
    return ERR_BUSY;
}

static enum err step_judgement(struct robust *r)
{
    enum err err = nyquist_step(&r->work.nyquist);
    r->frequencies++;
    if (err == ERR_BUSY)
        return err;
    return end_judgement(r, err == ERR_OK && r->work.nyquist.stable);
}

static enum err begin_plant(struct robust *r)
{
    REFLUX_ASSERT(r->at_active < ROBUST_ACTIVE);
    uint16_t plant = r->active[r->at_active];
    r->limits.s_most = r->config.s_most * r->margin;
    r->limits.t_most = t_limit(r, plant) * r->margin;
    robust_pass_plant(&r->work.pass, plant_of(r, plant), r->omega_lo, r->omega_hi);
    r->stage = STAGE_PASS;
    return ERR_BUSY;
}

static enum err step_pass(struct robust *r)
{
    enum err err = robust_pass_step(&r->work.pass);
    r->frequencies += r->work.pass.opened ? 1u : 0u;
    if (err == ERR_BUSY)
        return err;
    return ++r->at_active < r->actives ? next_active(r) : end_pass(r);
}

enum err robust_step(struct robust *r)
{
    switch (r->stage) {
    case STAGE_JUDGE_DRAW:
        return draw_member(r, r->judged, STAGE_JUDGE_BEGIN);
    case STAGE_JUDGE_BEGIN:
        return begin_judgement(r);
    case STAGE_JUDGE:
        return step_judgement(r);
    case STAGE_PASS_DRAW:
        return draw_member(r, r->active[r->at_active], STAGE_PASS_BEGIN);
    case STAGE_PASS_BEGIN:
        return begin_plant(r);
    case STAGE_PASS:
        return step_pass(r);
    default:
        return ERR_STATE;
    }
}
