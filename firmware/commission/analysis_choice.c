#include "commission/analysis_choice.h"

#include "base/assertion.h"
#include "commission/analysis_settings.h"
#include "commission/analysis_state.h"

#include <string.h>

/* ln of the factor by which loops must be faster, each, of which some run away with the others in manual. */
#define HANDICAP REAL_C(0.4)
#define DRAWS    400u
#define SEED     1u

void choice_keep_apart(const struct analysis *a, uint16_t apart[INTERACT_MAX])
{
    uint16_t inputs = 0;
    for (uint8_t j = 0; j < a->plant.outputs; j++)
        if (a->given[j])
            inputs = (uint16_t)(inputs | 1u << (a->given[j] - 1u));
    for (uint8_t j = 0; j < a->plant.outputs; j++) {
        unsigned own = a->given[j] ? 1u << (a->given[j] - 1u) : 0u;
        apart[j] = (uint16_t)(a->given[j] ? 0xffffu ^ own : inputs);
    }
}

enum err choice_begin(struct analysis *a)
{
    struct pairing_config p;
    pairing_config_default(&p);
    struct candidates_config c = {.smallest_lambda = p.smallest_lambda,
                                  .floor = a->config.floor,
                                  .draws = DRAWS,
                                  .seed = SEED};
    choice_keep_apart(a, c.apart);
    a->choice = (struct pairing_choice){0};
    return candidates_begin(&a->work.candidates, &a->plant, &a->pairs, &c, NULL);
}

/* Keeps those that would do in a large enough share of the draws. */
static void keep_sound(struct analysis *a)
{
    const struct candidates *c = &a->work.candidates;
    REFLUX_ASSERT(c->n <= CANDIDATES_MAX);
    a->probability = REAL_C(0.0);
    for (uint8_t k = 0; k < c->n; k++) {
        const struct candidate *found = &c->list[k];
        real_t sound = (real_t)found->sound / (real_t)c->drawn;
        if (sound > a->probability)
            a->probability = sound;
        if (sound < a->config.confidence)
            continue;
        struct choice_candidate *one = &a->choice.list[a->choice.n++];
        *one = (struct choice_candidate){.negative = found->negative,
                                         .negative_index = found->negative_index,
                                         .niederlinski = found->niederlinski,
                                         .sound = sound};
        memcpy(one->input, found->input, sizeof one->input);
    }
    if (a->choice.n > 0) /* else the pairs of the estimates stay */
        a->pairs = c->channels;
}

static void take_inputs_of(struct analysis *a, const struct choice_candidate *one)
{
    memcpy(a->pairs.input, one->input, sizeof a->pairs.input);
}

/* Takes the pairing of the list that is the best, with what else is known of it. */
static void take_best(struct analysis *a)
{
    const struct choice_candidate *best = NULL;
    real_t most = REAL_C(0.0);
    for (uint8_t k = 0; k < a->choice.n; k++) {
        const struct choice_candidate *one = &a->choice.list[k];
        real_t counts = one->speed;
        if (one->negative)
            counts -= HANDICAP * (real_t)a->pairs.n;
        bool better = !best || (one->has_settings && (!best->has_settings || counts > most));
        if (!better)
            continue;
        best = one;
        most = counts;
        a->choice.chosen = k;
    }
    if (!best)
        return;
    take_inputs_of(a, best);
    a->probability = best->sound;
    a->niederlinski = best->niederlinski;
    a->negative = best->negative;
    a->negative_index = best->negative_index;
    interact_gains(&a->plant, &a->pairs, &a->work.rga.gains);
    if (rga_compute(&a->work.rga.gains, &a->work.rga.work, &a->work.rga.lambda) != ERR_OK)
        return; /* the candidates come of these relative gains */
    for (uint8_t k = 0; k < a->pairs.n; k++)
        a->pair_lambda[k] = a->work.rga.lambda.value[k][k];
}

static enum err finish_choice(struct analysis *a)
{
    take_best(a);
    return ERR_OK;
}

/* Begins with the settings of the next pairing for which they can be made. */
static enum err begin_next(struct analysis *a)
{
    for (; a->choice.turn < a->choice.n; a->choice.turn++) {
        take_inputs_of(a, &a->choice.list[a->choice.turn]);
        if (settings_begin(a, false) == ERR_OK)
            return ERR_BUSY;
    }
    return finish_choice(a);
}

static real_t speed_of(const struct loops *loops)
{
    real_t sum = REAL_C(0.0);
    for (uint8_t k = 0; k < loops->pairs.n; k++)
        sum += real_log(loops->tuning[k].gain / loops->tuning[k].ti_s);
    return sum;
}

enum err choice_find(struct analysis *a)
{
    enum err err = candidates_step(&a->work.candidates);
    if (err)
        return err;
    keep_sound(a);
    if (a->choice.n < 2) {
        take_best(a);
        a->choice.turn = a->choice.n;
        return ERR_OK;
    }
    begin_next(a);
    return ERR_OK;
}

/* The settings of one are there, or there are none. */
static enum err settle(struct analysis *a, bool has_settings)
{
    REFLUX_ASSERT(a->choice.turn < CANDIDATES_MAX);
    struct choice_candidate *one = &a->choice.list[a->choice.turn++];
    one->has_settings = has_settings;
    one->speed = has_settings ? speed_of(&a->loops) : REAL_C(0.0);
    return begin_next(a);
}

enum err choice_step(struct analysis *a)
{
    if (a->choice.turn >= a->choice.n)
        return ERR_OK;
    enum err err = a->choice.searching ? settings_by_search(a) : settings_by_rule(a);
    if (err == ERR_BUSY)
        return err;
    bool more = !err && !a->choice.searching && a->pairs.n <= CANDIDATES_LOOPS;
    if (more && settings_begin_search(a, 0) == ERR_OK) {
        a->choice.searching = true;
        return ERR_BUSY;
    }
    a->choice.searching = false;
    return settle(a, !err);
}
