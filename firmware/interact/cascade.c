#include "interact/cascade.h"

#include <stdbool.h>
#include <stddef.h>

#include "base/assertion.h"

#define ROUNDS 8 /* of the straight line through 0 with errors both ways: it settles in three */

void cascade_config_default(struct cascade_config *config)
{
    *config = (struct cascade_config){
        .significance = REAL_C(3.0), .floor = REAL_C(0.02), .faster = REAL_C(0.6)};
}

static bool moves(const struct interact_plant *plant, const struct cascade_config *c, size_t i,
                  size_t j)
{
    REFLUX_ASSERT(i < plant->outputs && j < plant->inputs);
    return real_abs(plant->element[i][j].gain) > c->significance * plant->gain_sd[i][j];
}

static real_t effect_variance(const struct interact_plant *plant, const struct cascade_config *c,
                              size_t i, size_t j)
{
    real_t part = c->floor * plant->element[i][j].gain, sd = plant->gain_sd[i][j];
    return sd * sd + part * part;
}

/* The gain g of K_outer = g K_inner over the inputs that move the inner output, and the weighted squares of the residual. */
static real_t fit_gain(const struct interact_plant *plant, const struct cascade_config *c,
                       size_t inner, size_t outer, uint16_t inputs, real_t *squares)
{
    real_t g = REAL_C(0.0);
    for (int round = 0; round < ROUNDS; round++) {
        real_t xy = REAL_C(0.0), xx = REAL_C(0.0);
        *squares = REAL_C(0.0);
        for (size_t j = 0; j < plant->inputs; j++) {
            if ((inputs & (1u << j)) == 0u)
                continue;
            real_t x = plant->element[inner][j].gain, y = plant->element[outer][j].gain;
            real_t v =
                effect_variance(plant, c, outer, j) + g * g * effect_variance(plant, c, inner, j);
            /* an outer gain of 0 without error must not divide by 0: a hundredth of the inner's says enough */
            real_t least = REAL_C(0.01) * x * c->floor;
            v += least * least;
            xy += x * y / v;
            xx += x * x / v;
            *squares += (y - g * x) * (y - g * x) / v;
        }
        if (round + 1 < ROUNDS)
            g = xy / xx;
    }
    return g;
}

/* Both in one: whether the outer follows the inner with every input, and by how much later. */
static bool follows(const struct interact_plant *plant, const struct cascade_config *c,
                    struct cascade *found)
{
    size_t n = 0;
    real_t dead = REAL_C(0.0), later = REAL_C(0.0);
    found->inputs = 0;
    for (size_t j = 0; j < plant->inputs; j++) {
        const struct fopdt *in = &plant->element[found->inner][j];
        const struct fopdt *out = &plant->element[found->outer][j];
        real_t in_s = interact_residence(plant, found->inner, j);
        real_t out_s = interact_residence(plant, found->outer, j);
        bool inner_moves = moves(plant, c, found->inner, j);
        bool outer_moves = moves(plant, c, found->outer, j);
        if (!inner_moves && outer_moves)
            return false;
        if (!inner_moves)
            continue;
        found->inputs = (uint16_t)(found->inputs | (1u << j));
        if (!outer_moves)
            continue; /* the fit of gains will tell */
        if (in_s > c->faster * out_s || in->dead_time_s > out->dead_time_s)
            return false;
        n++;
        dead += out->dead_time_s - in->dead_time_s;
        later += out_s - in_s;
    }
    if (n == 0)
        return false;
    found->between.dead_time_s = dead / (real_t)n;
    found->between.time_constant_s = later / (real_t)n - found->between.dead_time_s;
    real_t least = REAL_C(0.01) * later / (real_t)n;
    if (found->between.time_constant_s < least) /* a lag that is all dead time is still a model */
        found->between.time_constant_s = least;
    return true;
}

static bool fits(const struct interact_plant *plant, const struct cascade_config *c,
                 struct cascade *found)
{
    real_t squares, freedom = REAL_C(-1.0);
    found->between.gain = fit_gain(plant, c, found->inner, found->outer, found->inputs, &squares);
    for (size_t j = 0; j < plant->inputs; j++)
        if ((found->inputs & (1u << j)) != 0u)
            freedom += REAL_C(1.0);
    found->misfit_sd = REAL_C(0.0);
    if (freedom < REAL_C(1.0))
        return true;
    found->misfit_sd = real_sqrt(squares / freedom);
    return squares <= freedom + c->significance * real_sqrt(REAL_C(2.0) * freedom);
}

/* Returns the mean delay with which an output answers to the inputs given. */
static real_t lateness(const struct interact_plant *plant, size_t output, uint16_t inputs)
{
    REFLUX_ASSERT(output < plant->outputs);
    real_t sum = REAL_C(0.0);
    for (size_t j = 0; j < plant->inputs; j++)
        if ((inputs & (1u << j)) != 0u)
            sum += interact_residence(plant, output, j);
    return sum;
}

enum err cascade_detect(const struct interact_plant *plant, const struct cascade_config *config,
                        struct cascade cascades[INTERACT_MAX], uint8_t *found)
{
    enum err err = interact_check(plant, NULL);
    if (err)
        return err;
    if (!real_within(config->significance, REAL_C(0.0), REAL_C(20.0)) ||
        !real_within(config->floor, REAL_C(1e-4), REAL_C(0.5)) ||
        !real_within(config->faster, REAL_C(0.05), REAL_C(1.0)))
        return ERR_RANGE;
    *found = 0;
    for (uint8_t outer = 0; outer < plant->outputs; outer++) {
        bool any = false;
        for (uint8_t inner = 0; inner < plant->outputs; inner++) {
            struct cascade c = {.inner = inner, .outer = outer};
            if (inner == outer || !follows(plant, config, &c) || !fits(plant, config, &c))
                continue;
            if (any && lateness(plant, inner, c.inputs) <=
                           lateness(plant, cascades[*found].inner, c.inputs))
                continue;
            cascades[*found] = c;
            any = true;
        }
        if (any)
            (*found)++;
    }
    return ERR_OK;
}
