#include "interact/candidates.h"

#include <stddef.h>
#include <string.h>

#include "base/assertion.h"
#include "interact/direction.h"

enum { STAGE_GAINS, STAGE_NEXT, STAGE_SUBSETS, STAGE_BRANCH, STAGE_DRAWS, STAGE_DONE };

static enum err check_candidates(const struct candidates_config *c, struct interact_refusal *reason)
{
    const struct interact_range ranges[] = {
        {c->smallest_lambda, REAL_C(0.001), REAL_C(1.0), "smallest_lambda", "0.001 to 1"},
        {c->floor, REAL_C(0.0), REAL_C(0.5), "floor", "0 to 0.5"},
        {(real_t)c->draws, REAL_C(20.0), REAL_C(10000.0), "draws", "20 to 10000"}};
    return interact_check_ranges(ranges, sizeof ranges / sizeof ranges[0], reason);
}

static void sort_channels(uint8_t *channel, uint8_t n)
{
    REFLUX_ASSERT(n <= INTERACT_MAX);
    for (uint8_t k = 1; k < n; k++)
        for (uint8_t l = k; l > 0 && channel[l] < channel[l - 1u]; l--) {
            uint8_t lower = channel[l];
            channel[l] = channel[l - 1u];
            channel[l - 1u] = lower;
        }
}

enum err candidates_begin(struct candidates *c, const struct interact_plant *plant,
                          const struct pairs *channels, const struct candidates_config *config,
                          struct interact_refusal *reason)
{
    struct interact_refusal unused;
    reason = reason ? reason : &unused;
    enum err err = interact_check(plant, reason);
    if (!err)
        err = pairs_check(plant, channels, reason);
    if (!err)
        err = check_candidates(config, reason);
    if (err)
        return err;
    *reason = (struct interact_refusal){"channels", "at least one", INTERACT_NONE, INTERACT_NONE};
    if (channels->n < 1)
        return ERR_RANGE;
    memset(c, 0, sizeof *c);
    c->plant = plant;
    c->config = *config;
    c->channels = *channels;
    sort_channels(c->channels.output, channels->n);
    sort_channels(c->channels.input, channels->n);
    c->random = random_from(config->seed);
    c->stage = STAGE_GAINS;
    return ERR_OK;
}

void candidates_pairs(const struct candidates *c, uint8_t k, struct pairs *pairs)
{
    REFLUX_ASSERT(k < c->n && c->channels.n <= INTERACT_MAX);
    *pairs = c->channels;
    memcpy(pairs->input, c->list[k].input, c->channels.n);
}

static enum err relative_gains(struct candidates *c)
{
    interact_gains(c->plant, &c->channels, &c->gains);
    enum err err = rga_compute(&c->gains, &c->work.rga, &c->lambda);
    if (err)
        return err;
    assignment_by_relative_gains(&c->lambda, &c->channels, c->config.apart,
                                 c->config.smallest_lambda, &c->ranked.costs);
    ranked_begin(&c->ranked);
    c->stage = STAGE_NEXT;
    return ERR_BUSY;
}

/* Pairs by rows and columns of the gains. */
static void pairs_of_gains(const struct candidates *c, const uint8_t *partner, struct pairs *pairs)
{
    pairs->n = c->channels.n;
    for (uint8_t i = 0; i < pairs->n; i++) {
        pairs->output[i] = i;
        pairs->input[i] = partner[i];
    }
}

static bool has_positive_index(struct candidates *c, const uint8_t *partner)
{
    struct pairs pairs;
    pairs_of_gains(c, partner, &pairs);
    return !niederlinski_index(&c->gains, &pairs, &c->work.rga, &c->index) &&
           c->index > REAL_C(0.0);
}

static bool is_full(const struct candidates *c)
{
    return c->n >= (c->channels.n <= CANDIDATES_LOOPS ? CANDIDATES_MAX : CANDIDATES_OF_MANY) ||
           c->tries >= CANDIDATES_TRIES;
}

/* Looks at the next assignment: its subsets follow if its index is positive. */
static void look_at_next(struct candidates *c)
{
    if (is_full(c) || !ranked_next(&c->ranked)) {
        c->stage = c->n > 0 ? STAGE_DRAWS : STAGE_DONE;
        return;
    }
    c->tries++;
    c->stage = STAGE_BRANCH;
    if (!has_positive_index(c, c->ranked.best.partner))
        return;
    struct pairs pairs;
    pairs_of_gains(c, c->ranked.best.partner, &pairs);
    if (integrity_begin(&c->work.integrity, &c->gains, &pairs) == ERR_OK)
        c->stage = STAGE_SUBSETS;
}

static void look_at_candidate(struct candidates *c)
{
    REFLUX_ASSERT(c->n < CANDIDATES_MAX);
    if (integrity_step(&c->work.integrity) == ERR_BUSY)
        return;
    struct candidate *found = &c->list[c->n++];
    *found = (struct candidate){.cost = (real_t)c->ranked.best.total / ASSIGNMENT_COST_UNIT,
                                .niederlinski = c->index,
                                .negative = c->work.integrity.negative,
                                .negative_index = c->work.integrity.index};
    for (uint8_t i = 0; i < c->channels.n; i++)
        found->input[i] = c->channels.input[c->ranked.best.partner[i]];
    c->stage = STAGE_BRANCH;
}

static void draw_gains(struct candidates *c)
{
    for (size_t i = 0; i < c->channels.n; i++) {
        real_t row[INTERACT_MAX];
        direction_draw(c->plant, c->channels.output[i], c->config.floor, &c->random, row);
        for (size_t j = 0; j < c->channels.n; j++)
            c->gains.value[i][j] = row[c->channels.input[j]];
    }
}

/* The pairs of a candidate would do if the gains were those of the draw. */
static bool would_do(struct candidates *c, const struct candidate *one)
{
    uint8_t partner[INTERACT_MAX] = {0};
    for (uint8_t i = 0; i < c->channels.n; i++) {
        while (c->channels.input[partner[i]] != one->input[i])
            partner[i]++;
        real_t gain = c->plant->element[c->channels.output[i]][one->input[i]].gain;
        if (!(gain * c->gains.value[i][partner[i]] > REAL_C(0.0)))
            return false;
    }
    return has_positive_index(c, partner);
}

static void look_at_draw(struct candidates *c)
{
    REFLUX_ASSERT(c->n <= CANDIDATES_MAX);
    draw_gains(c);
    for (uint8_t k = 0; k < c->n; k++)
        if (would_do(c, &c->list[k]))
            c->list[k].sound++;
    if (++c->drawn >= c->config.draws)
        c->stage = STAGE_DONE;
}

enum err candidates_step(struct candidates *c)
{
    enum err err;
    switch (c->stage) {
    case STAGE_GAINS:
        err = relative_gains(c);
        if (err != ERR_BUSY) {
            c->stage = STAGE_DONE;
            return err;
        }
        break;
    case STAGE_NEXT:
        look_at_next(c);
        break;
    case STAGE_SUBSETS:
        look_at_candidate(c);
        break;
    case STAGE_BRANCH:
        if (!ranked_branch(&c->ranked))
            c->stage = STAGE_NEXT;
        break;
    case STAGE_DRAWS:
        look_at_draw(c);
        break;
    default:
        return ERR_STATE;
    }
    return c->stage == STAGE_DONE ? ERR_OK : ERR_BUSY;
}
