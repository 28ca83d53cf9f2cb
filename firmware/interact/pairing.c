#include "interact/pairing.h"

#include <stddef.h>
#include <string.h>

#include "base/assertion.h"
#include "interact/direction.h"

/* Relative errors drawn where the gains themselves give no relative gains. */
#define TO_REVEAL REAL_C(1e-3)

/* The next thing to do: relative gains of a matrix (the estimates, or a draw about them), then pairs by pairs until
 * the Niederlinski index of every subset is positive. */
enum {
    STAGE_CHOOSE,
    STAGE_SQUARE,
    STAGE_BRANCH,
    STAGE_RESULT,
    STAGE_SUBSETS,
    STAGE_DETERMINANT,
    STAGE_DONE
};

void pairing_config_default(struct pairing_config *config)
{
    *config = (struct pairing_config){.smallest_lambda = REAL_C(0.02),
                                      .floor = REAL_C(0.005),
                                      .confidence = REAL_C(0.95),
                                      .determinant_sds = REAL_C(2.0),
                                      .integrity = REAL_C(0.9),
                                      .draws = 400,
                                      .seed = 1};
}

static enum err check_field(real_t value, real_t lo, real_t hi, const char *field,
                            const char *wanted, struct interact_refusal *reason)
{
    *reason = (struct interact_refusal){field, wanted, INTERACT_NONE, INTERACT_NONE};
    if (!real_is_finite(value))
        return ERR_NOT_FINITE;
    return value < lo || value > hi ? ERR_RANGE : ERR_OK;
}

static enum err check_pairing(const struct pairing_config *c, struct interact_refusal *reason)
{
    enum err err = check_field(c->smallest_lambda, REAL_C(0.001), REAL_C(1.0), "smallest_lambda",
                               "0.001 to 1", reason);
    if (!err)
        err = check_field(c->floor, REAL_C(1e-4), REAL_C(0.5), "floor", "0.0001 to 0.5", reason);
    if (!err)
        err = check_field(c->confidence, REAL_C(0.5), REAL_C(0.9999), "confidence", "0.5 to 0.9999",
                          reason);
    if (!err)
        err = check_field(c->determinant_sds, REAL_C(0.0), REAL_C(20.0), "determinant_sds",
                          "0 to 20", reason);
    if (!err)
        err = check_field(c->integrity, REAL_C(0.0), REAL_C(0.9999), "integrity", "0 to 0.9999",
                          reason);
    if (!err)
        err = check_field((real_t)c->draws, REAL_C(20.0), REAL_C(10000.0), "draws", "20 to 10000",
                          reason);
    return err;
}

/* The gains to look at: the estimates before the first draw, then draws about them. Channels left out become 0. */
static void take_gains(struct pairing *p)
{
    interact_gains(p->plant, NULL, &p->gains);
    for (size_t i = 0; p->drawing && i < p->plant->outputs; i++)
        direction_draw(p->plant, i, p->floor, &p->random, p->gains.value[i]);
    p->stage = STAGE_CHOOSE;
}

/* Rows and columns of p->gains that may be used, into p->square; p->kept remembers which they were. */
static void take_allowed(struct pairing *p)
{
    uint8_t rows = 0, cols = 0;
    for (uint8_t i = 0; i < p->gains.rows; i++)
        if ((p->config.outputs_out & (1u << i)) == 0u)
            p->kept.output[rows++] = i;
    for (uint8_t j = 0; j < p->gains.cols; j++)
        if ((p->config.inputs_out & (1u << j)) == 0u)
            p->kept.input[cols++] = j;
    p->square.rows = rows;
    p->square.cols = cols;
    for (size_t i = 0; i < rows; i++)
        for (size_t j = 0; j < cols; j++)
            p->square.value[i][j] = p->gains.value[p->kept.output[i]][p->kept.input[j]];
}

/* Leaves as many of the n channels as there are on the other side, those with the largest sums; of equals the first. */
static void keep_largest(const real_t *sum, uint8_t *channel, uint8_t n, uint8_t wanted)
{
    REFLUX_ASSERT(n <= INTERACT_MAX && wanted <= n);
    uint16_t keep = 0;
    for (uint8_t k = 0; k < wanted; k++) {
        uint8_t best = n;
        for (uint8_t l = 0; l < n; l++)
            if ((keep & (1u << l)) == 0u && (best == n || sum[l] > sum[best]))
                best = l;
        keep = (uint16_t)(keep | (1u << best));
    }
    uint8_t at = 0;
    for (uint8_t l = 0; l < n; l++)
        if ((keep & (1u << l)) != 0u)
            channel[at++] = channel[l];
}

static enum err choose_square(struct pairing *p)
{
    take_allowed(p);
    uint8_t rows = p->square.rows, cols = p->square.cols;
    if (rows != cols) {
        enum err err = rga_compute(&p->square, &p->work.rga, &p->lambda_all);
        if (err)
            return err;
        real_t sum[INTERACT_MAX];
        uint8_t n = rows > cols ? rows : cols, wanted = rows > cols ? cols : rows;
        for (uint8_t k = 0; k < n; k++) {
            sum[k] = REAL_C(0.0);
            for (uint8_t l = 0; l < wanted; l++)
                sum[k] += rows > cols ? p->lambda_all.value[k][l] : p->lambda_all.value[l][k];
        }
        keep_largest(sum, rows > cols ? p->kept.output : p->kept.input, n, wanted);
        p->kept.n = wanted;
    } else {
        p->kept.n = rows;
    }
    return ERR_OK;
}

static enum err relative_gains_of_square(struct pairing *p)
{
    size_t n = p->kept.n;
    p->square.rows = p->square.cols = p->kept.n;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            p->square.value[i][j] = p->gains.value[p->kept.output[i]][p->kept.input[j]];
    enum err err = rga_compute(&p->square, &p->work.rga, &p->lambda_all);
    if (!err)
        assignment_by_relative_gains(&p->lambda_all, &p->kept, p->config.apart,
                                     p->config.smallest_lambda, &p->ranked.costs);
    return err;
}

/* The node's pairs, by rows and columns of p->square. */
static void pairs_of_node(const struct pairing *p, struct pairs *pairs)
{
    pairs->n = p->kept.n;
    for (uint8_t i = 0; i < pairs->n; i++) {
        pairs->output[i] = i;
        pairs->input[i] = p->ranked.best.partner[i];
    }
}

static bool index_is_positive(struct pairing *p)
{
    struct pairs pairs;
    pairs_of_node(p, &pairs);
    return !niederlinski_index(&p->square, &pairs, &p->work.rga, &p->index) &&
           p->index > REAL_C(0.0);
}

/* Takes the place of p->work.rga. */
static bool begin_subsets(struct pairing *p)
{
    struct pairs pairs;
    pairs_of_node(p, &pairs);
    p->stage = STAGE_SUBSETS;
    return !integrity_begin(&p->work.integrity, &p->square, &pairs);
}

/* The node's pairs, beside the estimates' own. */
static bool is_as_estimated(const struct pairing *p)
{
    bool same = p->pairs.n == p->kept.n;
    for (uint8_t k = 0; same && k < p->pairs.n; k++)
        same = p->kept.output[k] == p->pairs.output[k] &&
               p->kept.input[p->ranked.best.partner[k]] == p->pairs.input[k];
    return same;
}

/* The draw keeps the channels that the estimates keep. */
static bool keeps_the_same(const struct pairing *p)
{
    bool same = p->pairs.n == p->kept.n;
    uint16_t inputs = 0, own = 0;
    for (uint8_t k = 0; same && k < p->pairs.n; k++) {
        same = p->kept.output[k] == p->pairs.output[k];
        inputs = (uint16_t)(inputs | 1u << p->kept.input[k]);
        own = (uint16_t)(own | 1u << p->pairs.input[k]);
    }
    return same && inputs == own;
}

static void count_draw(struct pairing *p, bool found)
{
    uint8_t input_of[INTERACT_MAX];
    for (size_t i = 0; i < p->gains.rows; i++)
        input_of[i] = INTERACT_MAX; /* none */
    for (uint8_t k = 0; found && k < p->kept.n; k++)
        input_of[p->kept.output[k]] = p->kept.input[p->ranked.best.partner[k]];
    p->drawn++;
    if (!found)
        p->drawn_no_pair++;
    for (size_t i = 0; i < p->gains.rows; i++)
        p->count[i][input_of[i]]++;
    if (found && is_as_estimated(p))
        p->agreed++;
    if (keeps_the_same(p))
        p->same_channels++;
}

/* The estimates' own pairs; what the draws are compared with. */
static void keep_pairs(struct pairing *p)
{
    p->pairs.n = p->kept.n;
    p->niederlinski = p->index;
    p->cost = (real_t)p->ranked.best.total / ASSIGNMENT_COST_UNIT;
    for (uint8_t k = 0; k < p->kept.n; k++) {
        p->pairs.output[k] = p->kept.output[k];
        p->pairs.input[k] = p->kept.input[p->ranked.best.partner[k]];
        p->lambda[k] = p->lambda_all.value[k][p->ranked.best.partner[k]];
    }
}

static void conclude_pairing(struct pairing *p)
{
    uint8_t partner[INTERACT_MAX];
    memset(partner, INTERACT_MAX, sizeof partner);
    for (uint8_t k = 0; k < p->pairs.n; k++)
        partner[p->pairs.output[k]] = p->pairs.input[k];
    p->probability = (real_t)p->agreed / (real_t)p->drawn;
    p->channels = (real_t)p->same_channels / (real_t)p->drawn;
    if (p->agreed > 0)
        p->integrity = (real_t)(p->agreed - p->fragile) / (real_t)p->agreed;
    for (uint8_t i = 0; i < p->gains.rows; i++) {
        uint8_t usual = partner[i], rival = INTERACT_NONE;
        for (uint8_t j = 0; j <= INTERACT_MAX && p->pairs.n == 0; j++)
            if (p->count[i][j] > p->count[i][usual])
                usual = j; /* no pairs of its own: the most frequent ones stand in */
        for (uint8_t j = 0; j <= INTERACT_MAX; j++)
            if (j != usual && p->count[i][j] > 0 &&
                (rival == INTERACT_NONE || p->count[i][j] > p->count[i][rival]))
                rival = j;
        p->share[i] = (real_t)p->count[i][usual] / (real_t)p->drawn;
        p->rival[i] = rival;
        if (p->share[i] >= p->config.confidence)
            continue;
        p->ambiguous_outputs = (uint16_t)(p->ambiguous_outputs | (1u << i));
        if (usual < INTERACT_MAX)
            p->ambiguous_inputs = (uint16_t)(p->ambiguous_inputs | (1u << usual));
        if (rival < INTERACT_MAX)
            p->ambiguous_inputs = (uint16_t)(p->ambiguous_inputs | (1u << rival));
    }
    bool sure = p->probability >= p->config.confidence && p->integrity >= p->config.integrity &&
                p->determinant >= p->config.determinant_sds;
    if (p->verdict == PAIRING_DETERMINED && !sure)
        p->verdict = PAIRING_UNDETERMINED;
    p->stage = STAGE_DONE;
}

static void next_matrix(struct pairing *p)
{
    if (p->drawn >= p->config.draws)
        conclude_pairing(p);
    else
        take_gains(p);
}

/* Judges the estimates, once their pairs are known. */
static void judge_determinant(struct pairing *p)
{
    struct matrix *sds = &p->lambda_all, *common = &p->gains; /* drawn anew afterwards */
    *common = *sds;
    for (uint8_t i = 0; i < p->kept.n; i++) {
        real_t q[INTERACT_MAX];
        (void)direction_common(p->plant, p->kept.output[i], p->floor, q);
        for (uint8_t j = 0; j < p->kept.n; j++) {
            uint8_t input = p->kept.input[j];
            sds->value[i][j] = direction_sd(p->plant, p->kept.output[i], input, p->floor);
            common->value[i][j] = q[input];
        }
    }
    if (rga_determinant_sds(&p->square, sds, common, &p->work.rga, &p->determinant))
        p->determinant = REAL_C(0.0);
}

/* A matrix is dealt with: found pairs or not. */
static void finish_matrix(struct pairing *p, bool found, bool singular)
{
    if (p->drawing) {
        count_draw(p, found);
    } else {
        p->drawing = true;
        if (found) {
            keep_pairs(p);
            p->negative = 0; /* of better ones that were refused */
            p->stage = STAGE_DETERMINANT;
            return;
        }
        p->verdict = singular ? PAIRING_SINGULAR : PAIRING_IMPOSSIBLE;
        if (p->negative) {
            p->stage = STAGE_DETERMINANT;
            return;
        }
        if (singular && p->floor < TO_REVEAL)
            p->floor = TO_REVEAL;
    }
    next_matrix(p);
}

/* Refuses pairs that would be the best of the estimates, but for a subset of their loops. */
static void refuse_subset(struct pairing *p)
{
    if (p->negative)
        return;
    keep_pairs(p);
    p->negative = p->work.integrity.negative;
    p->negative_index = p->work.integrity.index;
}

static void look_at_subsets(struct pairing *p)
{
    bool every = !p->drawing || p->kept.n <= PAIRING_SUBSETS, negative;
    if (every) {
        if (integrity_step(&p->work.integrity) == ERR_BUSY)
            return;
        negative = p->work.integrity.negative != 0u;
    } else {
        struct pairs pairs;
        pairs_of_node(p, &pairs);
        negative = !integrity_of_two(&p->square, &pairs);
    }
    if (!p->drawing && negative) {
        refuse_subset(p);
        p->stage = STAGE_BRANCH;
        return;
    }
    if (negative)
        p->fragile++;
    finish_matrix(p, true, false);
}

/* Pairs with a positive index: all of their subsets next, unless it is a draw that gives others. */
static void take_node(struct pairing *p)
{
    if (p->drawing && !is_as_estimated(p))
        finish_matrix(p, true, false);
    else if (!begin_subsets(p))
        p->stage = STAGE_BRANCH;
}

enum err pairing_begin(struct pairing *p, const struct interact_plant *plant,
                       const struct pairing_config *config, struct interact_refusal *reason)
{
    struct interact_refusal unused;
    reason = reason ? reason : &unused;
    enum err err = interact_check(plant, reason);
    if (!err)
        err = check_pairing(config, reason);
    if (err)
        return err;
    *reason = (struct interact_refusal){"outputs_out, inputs_out", "an output and an input left",
                                        INTERACT_NONE, INTERACT_NONE};
    uint32_t outputs = (1u << plant->outputs) - 1u, inputs = (1u << plant->inputs) - 1u;
    if ((outputs & ~(uint32_t)config->outputs_out) == 0u ||
        (inputs & ~(uint32_t)config->inputs_out) == 0u)
        return ERR_EMPTY;
    *reason = (struct interact_refusal){"", "", INTERACT_NONE, INTERACT_NONE};
    memset(p, 0, sizeof *p);
    p->config = *config;
    p->plant = plant;
    p->floor = config->floor;
    p->random = random_from(config->seed);
    p->verdict = PAIRING_DETERMINED;
    take_gains(p);
    return ERR_OK;
}

enum err pairing_step(struct pairing *p)
{
    REFLUX_ASSERT(p->gains.rows <= INTERACT_MAX && p->kept.n <= INTERACT_MAX);
    switch (p->stage) {
    case STAGE_CHOOSE:
        p->stage = STAGE_SQUARE;
        if (choose_square(p))
            finish_matrix(p, false, true);
        break;
    case STAGE_SQUARE:
        p->tries = 0;
        if (relative_gains_of_square(p)) {
            finish_matrix(p, false, true);
            break;
        }
        ranked_begin(&p->ranked);
        p->stage = STAGE_RESULT;
        break;
    case STAGE_RESULT:
        if (p->tries >= PAIRING_TRIES || !ranked_next(&p->ranked)) {
            finish_matrix(p, false, false);
            break;
        }
        p->tries++;
        if (index_is_positive(p))
            take_node(p);
        else
            p->stage = STAGE_BRANCH;
        break;
    case STAGE_SUBSETS:
        look_at_subsets(p);
        break;
    case STAGE_DETERMINANT:
        judge_determinant(p);
        next_matrix(p);
        break;
    case STAGE_BRANCH: /* the latest pairs are out, and what differs from them is looked at next */
        if (!ranked_branch(&p->ranked))
            p->stage = STAGE_RESULT;
        break;
    default:
        return ERR_STATE;
    }
    return p->stage == STAGE_DONE ? ERR_OK : ERR_BUSY;
}
