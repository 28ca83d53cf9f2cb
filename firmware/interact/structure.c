#include "interact/structure.h"

#include <stddef.h>
#include <string.h>

#include "base/assertion.h"

void structure_config_default(struct structure_config *config)
{
    *config = (struct structure_config){.significance = REAL_C(3.0),
                                        .negligible = REAL_C(0.03),
                                        .lambda_lo = REAL_C(0.5),
                                        .lambda_hi = REAL_C(5.0),
                                        .grouped = REAL_C(0.15)};
}

static enum err check_structure(const struct structure_config *c)
{
    bool good = real_within(c->significance, REAL_C(0.0), REAL_C(20.0)) &&
                real_within(c->negligible, REAL_C(0.0), REAL_C(0.5)) &&
                real_within(c->lambda_lo, REAL_C(0.0), REAL_C(1.0)) &&
                real_within(c->lambda_hi, REAL_C(1.0), REAL_C(100.0)) &&
                real_within(c->grouped, REAL_C(0.01), REAL_C(1.0));
    return good ? ERR_OK : ERR_RANGE;
}

static bool has(uint16_t mask, size_t bit)
{
    return (mask & (1u << bit)) != 0u;
}

static uint16_t with(uint16_t mask, size_t bit)
{
    return (uint16_t)(mask | (1u << bit));
}

static void find_effects(const struct interact_plant *plant, const struct structure_config *c,
                         struct matrix *k, struct structure *s)
{
    real_t row[INTERACT_MAX], col[INTERACT_MAX];
    interact_gains(plant, NULL, k);
    for (size_t i = 0; i < k->rows; i++)
        for (size_t j = 0; j < k->cols; j++)
            if (real_abs(k->value[i][j]) <= c->significance * plant->gain_sd[i][j])
                k->value[i][j] = REAL_C(0.0);
    matrix_equilibrate(k, true, row, col);
    for (size_t i = 0; i < k->rows; i++) {
        real_t most = REAL_C(0.0);
        for (size_t j = 0; j < k->cols; j++)
            if (real_abs(plant->element[i][j].gain) > most)
                most = real_abs(plant->element[i][j].gain);
        for (size_t j = 0; j < k->cols; j++) {
            real_t size = real_abs(k->value[i][j]);
            bool seen = size > REAL_C(0.0);
            bool little = size <= c->negligible * most && size * row[i] * col[j] <= c->negligible;
            if (seen && !little)
                s->effect[i] = with(s->effect[i], j);
            if (!seen && c->significance * plant->gain_sd[i][j] > c->negligible * most)
                s->uncertain[i] = with(s->uncertain[i], j);
        }
    }
}

/* Outputs and inputs that hang together, directly or through others. */
static void find_parts(const struct interact_plant *plant, struct structure *s)
{
    uint16_t done = 0;
    for (size_t first = 0; first < plant->outputs; first++) {
        if (has(done, first) || s->effect[first] == 0)
            continue;
        uint16_t outputs = with(0, first), inputs = s->effect[first];
        for (size_t round = 0; round < plant->outputs; round++)
            for (size_t i = 0; i < plant->outputs; i++)
                if ((s->effect[i] & inputs) != 0) {
                    outputs = with(outputs, i);
                    inputs = (uint16_t)(inputs | s->effect[i]);
                }
        REFLUX_ASSERT(s->parts < INTERACT_MAX);
        s->part_outputs[s->parts] = outputs;
        s->part_inputs[s->parts] = inputs;
        s->parts++;
        done = (uint16_t)(done | outputs);
    }
}

/* reach[l]: the pairs whose inputs get to pair l's output, through any number of loops; l itself always. */
static void find_reach(const struct pairs *pairs, const struct structure *s, uint16_t *reach)
{
    for (size_t l = 0; l < pairs->n; l++) {
        reach[l] = with(0, l);
        for (size_t k = 0; k < pairs->n; k++)
            if (has(s->effect[pairs->output[l]], pairs->input[k]))
                reach[l] = with(reach[l], k);
    }
    for (size_t through = 0; through < pairs->n; through++) /* Warshall */
        for (size_t l = 0; l < pairs->n; l++)
            if (has(reach[l], through))
                reach[l] = (uint16_t)(reach[l] | reach[through]);
}

/* Pairs that reach each other are one block; a block comes after those that reach it. */
static void find_blocks(const struct pairs *pairs, const uint16_t *reach, struct structure *s)
{
    uint16_t placed = 0;
    for (size_t round = 0; round < pairs->n; round++)
        for (size_t k = 0; k < pairs->n; k++) {
            if (has(placed, k))
                continue;
            uint16_t members = 0;
            for (size_t l = 0; l < pairs->n; l++)
                if (has(reach[k], l) && has(reach[l], k))
                    members = with(members, l);
            if ((reach[k] & ~members & ~placed) != 0)
                continue; /* something before it is still to come */
            REFLUX_ASSERT(s->blocks < INTERACT_MAX);
            struct block *b = &s->block[s->blocks];
            b->pairs = members;
            for (size_t l = 0; l < pairs->n; l++)
                if (has(members, l)) {
                    b->size++;
                    s->pair_block[l] = s->blocks;
                }
            placed = (uint16_t)(placed | members);
            s->blocks++;
        }
}

/* Finds which blocks disturb which directly, and numbers the independent parts to which they belong. */
static void join_blocks(const struct pairs *pairs, struct structure *s)
{
    for (size_t l = 0; l < pairs->n; l++)
        for (size_t k = 0; k < pairs->n; k++) {
            uint8_t from = s->pair_block[k], to = s->pair_block[l];
            if (from != to && has(s->effect[pairs->output[l]], pairs->input[k]))
                s->block[to].driven_by = with(s->block[to].driven_by, from);
        }
    for (size_t b = 0; b < s->blocks; b++)
        s->block[b].part = (uint8_t)b;
    for (size_t round = 0; round < s->blocks; round++)
        for (size_t b = 0; b < s->blocks; b++)
            for (size_t a = 0; a < b; a++)
                if (has(s->block[b].driven_by, a)) {
                    uint8_t least =
                        s->block[a].part < s->block[b].part ? s->block[a].part : s->block[b].part;
                    s->block[a].part = s->block[b].part = least;
                }
}

/* Distance of a relative gain from 1, the same for its inverse; the largest for what cannot be paired at all. */
static real_t distance(real_t lambda)
{
    return lambda > REAL_C(1e-9) ? real_abs(real_log(lambda)) : REAL_C(1e9);
}

/* RGA block structure within a block: pairs whose relative gains off the diagonal are large belong together; a group is
 * left to single loops only when every pair's own relative gain is near enough to 1. */
static void judge_block(const struct pairs *pairs, const struct structure_config *c,
                        const struct interact_plant *plant, struct structure_work *work,
                        struct block *b)
{
    struct pairs own = {.n = 0};
    uint8_t which[INTERACT_MAX];
    for (uint8_t k = 0; k < pairs->n; k++)
        if (has(b->pairs, k)) {
            own.output[own.n] = pairs->output[k];
            own.input[own.n] = pairs->input[k];
            which[own.n++] = k;
        }
    b->worst_lambda = REAL_C(1.0);
    if (own.n < 2)
        return;
    interact_gains(plant, &own, &work->gains);
    if (rga_compute(&work->gains, &work->rga, &work->lambda)) {
        b->mimo = b->pairs;
        b->worst_lambda = REAL_C(0.0);
        return;
    }
    uint16_t group[INTERACT_MAX];
    for (size_t k = 0; k < own.n; k++) {
        real_t lambda = work->lambda.value[k][k];
        if (distance(lambda) > distance(b->worst_lambda))
            b->worst_lambda = lambda;
        group[k] = with(0, k);
        for (size_t l = 0; l < own.n; l++)
            if (l != k && (real_abs(work->lambda.value[k][l]) >= c->grouped ||
                           real_abs(work->lambda.value[l][k]) >= c->grouped))
                group[k] = with(group[k], l);
    }
    for (size_t through = 0; through < own.n; through++)
        for (size_t k = 0; k < own.n; k++)
            if (has(group[k], through))
                group[k] = (uint16_t)(group[k] | group[through]);
    for (size_t k = 0; k < own.n; k++)
        for (size_t l = 0; l < own.n && group[k] != with(0, k); l++)
            if (has(group[k], l) &&
                !real_within(work->lambda.value[l][l], c->lambda_lo, c->lambda_hi))
                b->mimo = with(b->mimo, which[k]);
}

enum err structure_detect(const struct interact_plant *plant, const struct pairs *pairs,
                          const struct structure_config *config, struct structure_work *work,
                          struct structure *result)
{
    enum err err = interact_check(plant, NULL);
    if (!err)
        err = pairs_check(plant, pairs, NULL);
    if (!err)
        err = check_structure(config);
    if (err)
        return err;
    memset(result, 0, sizeof *result);
    find_effects(plant, config, &work->gains, result);
    find_parts(plant, result);
    uint16_t reach[INTERACT_MAX];
    find_reach(pairs, result, reach);
    find_blocks(pairs, reach, result);
    join_blocks(pairs, result);
    for (size_t b = 0; b < result->blocks; b++)
        judge_block(pairs, config, plant, work, &result->block[b]);
    return ERR_OK;
}

enum err structure_cross_way(const struct interact_plant *plant, const struct pairs *pairs,
                             const struct structure *s, uint8_t from, uint8_t to,
                             struct cross_way *way)
{
    if (from >= pairs->n || to >= pairs->n)
        return ERR_RANGE;
    uint8_t output = pairs->output[to];
    if (s->pair_block[from] == s->pair_block[to] || !has(s->effect[output], pairs->input[from]))
        return ERR_EMPTY;
    const struct fopdt *disturbs = &plant->element[output][pairs->input[from]];
    const struct fopdt *corrects = &plant->element[output][pairs->input[to]];
    real_t gain = -disturbs->gain / corrects->gain;
    if (!real_is_finite(gain))
        return ERR_RANGE;
    real_t dead = disturbs->dead_time_s - corrects->dead_time_s;
    *way = (struct cross_way){.from = from,
                              .to = to,
                              .gain = gain,
                              .lead_s = corrects->time_constant_s,
                              .lag_s = disturbs->time_constant_s,
                              .dead_s = dead > REAL_C(0.0) ? dead : REAL_C(0.0),
                              .late_s = dead < REAL_C(0.0) ? -dead : REAL_C(0.0)};
    return ERR_OK;
}
