/* The self-tuner: its control law, an equation for each loop that acts, linear in the moves of the MVs, solved together
 * (docs/methods/self-tuning.md, Control laws; Folami 1989, 8.14 to 8.19, 8.30), over its parts, samples and learner. */
#include "kinds/gmv/gmv.h"

#include <stddef.h>
#include <string.h>

#include "base/assertion.h"
#include "kinds/gmv/gmv_predictor.h"
#include "kinds/gmv/gmv_state.h"
#include "num/real.h"

/* Bytes from the beginning of the learner to the first estimator. */
#define RLS_OFFSET (((sizeof(struct gmv) + 7u) & ~(size_t)7u) - offsetof(struct gmv, learner))

uint32_t gmv_bytes(const struct gmv_shape *shape)
{
    return (uint32_t)(offsetof(struct gmv, learner) + RLS_OFFSET) + gmv_learner_bytes(shape);
}

static void configure_law(struct gmv *g, const struct gmv_config *c)
{
    g->determinant = num_from_float(c->determinant);
    for (unsigned i = 0; i < c->shape.loops; i++)
        g->lambda[i] = num_from_float(c->lambda[i]);
}

void gmv_init(struct gmv *g, const struct gmv_config *c)
{
    REFLUX_ASSERT(c->shape.loops <= GMV_LOOPS);
    uint32_t offset = RLS_OFFSET;
    memset(g, 0, sizeof *g);
    gmv_samples_configure(&g->samples, c);
    configure_law(g, c);
    for (unsigned i = 0; i < c->shape.loops; i++) {
        for (unsigned p = 0; p < gmv_parameters(&c->shape, i); p++)
            g->used[i][p] = num_from_float(c->theta[i][p]);
        offset = gmv_learner_init(&g->learner, c, i, g->used[i], offset);
    }
}

void gmv_retune(struct gmv *g, const struct gmv_config *c)
{
    REFLUX_ASSERT(c->shape.loops <= GMV_LOOPS);
    gmv_samples_configure(&g->samples, c);
    configure_law(g, c);
    gmv_learner_retune(&g->learner, c);
}

const struct gmv_shape *gmv_shape(const struct gmv *g)
{
    return gmv_samples_shape(&g->samples);
}

/* ---- a step ---- */

void gmv_begin(struct gmv *g)
{
    gmv_samples_begin(&g->samples);
}

void gmv_take(struct gmv *g, const struct gmv_sample *s)
{
    gmv_samples_take(&g->samples, s);
}

uint8_t gmv_learn(struct gmv *g, const struct gmv_sample *s, uint8_t learn)
{
    const struct gmv_shape *shape = gmv_shape(g);
    bool complete = gmv_samples_complete(&g->samples);
    for (unsigned i = 0; i < shape->loops; i++) {
        if (shape->nc)
            gmv_learner_keep_prediction(&g->learner, &g->samples, s, i);
        if (complete)
            gmv_learner_step(&g->learner, &g->samples, s, i, g->used[i], learn & (1u << i));
    }
    return (uint8_t)(complete ? (1u << shape->loops) - 1u : 0u);
}

/* ---- parameters ---- */

num_t gmv_used(const struct gmv *g, unsigned i, unsigned p)
{
    REFLUX_ASSERT(i < GMV_LOOPS && p < GMV_PARAMETERS);
    return g->used[i][p];
}

void gmv_use(struct gmv *g, unsigned i, unsigned p, num_t value)
{
    REFLUX_ASSERT(i < GMV_LOOPS && p < GMV_PARAMETERS);
    g->used[i][p] = value;
}

void gmv_start_again(struct gmv *g, const float theta[GMV_LOOPS][GMV_PARAMETERS])
{
    for (unsigned i = 0; i < gmv_shape(g)->loops; i++) {
        for (unsigned p = 0; p < GMV_PARAMETERS; p++)
            g->used[i][p] = num_from_float(theta[i][p]);
        gmv_learner_start_again(&g->learner, i, g->used[i]);
    }
}

void gmv_predict(const struct gmv *g, unsigned i, struct gmv_predictor *p)
{
    REFLUX_ASSERT(i < gmv_shape(g)->loops);
    gmv_predictor_fill(p, gmv_samples_shape(&g->samples), &g->samples, i, g->used[i]);
}

float gmv_own_gain(const struct gmv *g, unsigned i)
{
    struct gmv_predictor p;
    gmv_predict(g, i, &p);
    return num_to_float(p.g[i][0]);
}

num_t gmv_lambda(const struct gmv *g, unsigned i)
{
    REFLUX_ASSERT(i < gmv_shape(g)->loops);
    return g->lambda[i];
}

void gmv_set_lambda(struct gmv *g, unsigned i, num_t lambda)
{
    REFLUX_ASSERT(i < gmv_shape(g)->loops);
    g->lambda[i] = lambda;
}

num_t gmv_determinant(const struct gmv *g)
{
    return g->determinant;
}

struct gmv_filter gmv_filter(const struct gmv *g, unsigned i)
{
    return gmv_samples_filter(&g->samples, i);
}

const struct rls *gmv_rls(const struct gmv *g, unsigned i)
{
    return gmv_learner_rls(&g->learner, i);
}

struct gmv_predicted gmv_predicted(const struct gmv *g, unsigned i)
{
    return *gmv_learner_predicted(&g->learner, i);
}

/* ---- estimates ---- */

static unsigned place_of_own_gain(const struct gmv *g, unsigned i)
{
    return (unsigned)gmv_place_of_u(gmv_samples_shape(&g->samples), i, i);
}

float gmv_estimated_gain(const struct gmv *g, unsigned i)
{
    return num_to_float(rls_theta(gmv_rls(g, i), place_of_own_gain(g, i)));
}

/* The law needs to know less of other MVs and of older moves: the test of predictions and the trial judge their effect. */
bool gmv_is_excited(const struct gmv *g, unsigned i, float deviations)
{
    const struct rls *r = gmv_rls(g, i);
    float sd = rls_error_sd(r) * deviations;
    unsigned own = place_of_own_gain(g, i);
    float gain = real_abs(num_to_float(rls_theta(r, own)));
    for (unsigned p = 0; p <= own; p++)
        if (!(sd * real_sqrt(rls_covariance(r, p, p)) <= (p < own ? 1 : gain)))
            return false;
    return gain > 0;
}

void gmv_use_estimates(struct gmv *g, unsigned i)
{
    REFLUX_ASSERT(i < gmv_shape(g)->loops);
    for (unsigned p = 0; p < gmv_parameters(gmv_samples_shape(&g->samples), i); p++)
        g->used[i][p] = rls_theta(gmv_rls(g, i), p);
}

void gmv_approach_estimates(struct gmv *g, unsigned i, num_t speed, num_t least)
{
    REFLUX_ASSERT(i < gmv_shape(g)->loops);
    for (unsigned p = 0; p < gmv_parameters(gmv_samples_shape(&g->samples), i); p++) {
        num_t used = g->used[i][p], wanted = rls_theta(gmv_rls(g, i), p);
        num_t most = num_mul(speed, num_max(num_abs(used), least));
        num_t move = num_clamp(num_sub(wanted, used), num_neg(most), most);
        g->used[i][p] = num_add(used, move);
    }
}

/* ---- the law ---- */

/* m move = rhs; move_j = u_j(t) - u_j(t - 1). */
struct equations {
    num_t m[GMV_LOOPS][GMV_LOOPS], rhs[GMV_LOOPS];
};

/* Smaller coefficients than these are no gain: a division by one would ask for any move. */
#define LEAST_COEFFICIENT 1e-6f

/* u_j(t - steps) as the form takes it; u_j(t) as if it did not move. */
static num_t known_input(const struct gmv_samples *m, const struct gmv_sample *s, unsigned j,
                         unsigned steps, unsigned k)
{
    if (steps)
        return gmv_applied_term(m, s, j, steps, k);
    num_t stays = gmv_applied(s, j, 1);
    bool change = gmv_samples_shape(m)->form == GMV_INCREMENTAL;
    return change ? num_sub(stays, gmv_applied(s, j, k)) : stays;
}

/* The prediction without the moves of this step. */
static num_t known_part(const struct gmv_samples *m, const struct gmv_sample *s, unsigned i,
                        const struct gmv_predictor *p)
{
    const struct gmv_shape *shape = gmv_samples_shape(m);
    unsigned k = shape->delay[i][i];
    num_wide_t sum = num_wide_add(num_wide_zero(), p->rest, num_one());
    for (unsigned a = 0; a < p->nf; a++)
        sum = num_wide_add(sum, p->f[a], gmv_pv_term(m, i, a, k));
    for (unsigned j = 0; j < shape->loops; j++)
        for (unsigned b = 0; b < p->ng && shape->delay[i][j]; b++)
            sum = num_wide_add(sum, p->g[j][b], known_input(m, s, j, p->behind[j] + b, k));
    return num_from_wide(sum);
}

static void build(const struct gmv *g, const struct gmv_sample *s, unsigned i, struct equations *q)
{
    const struct gmv_samples *m = &g->samples;
    const struct gmv_shape *shape = gmv_samples_shape(m);
    struct gmv_predictor p;
    gmv_predict(g, i, &p);
    num_t rhs = num_sub(gmv_weighed_setpoint(m, i), known_part(m, s, i, &p));
    if (shape->form == GMV_INCREMENTAL)
        rhs = num_sub(rhs, gmv_weighed_pv(m, i));
    if (shape->bias == GMV_BIAS_ERROR) { /* P y as it was predicted in place of P y (8.18) */
        struct gmv_predicted predicted = gmv_predicted(g, i);
        rhs = num_add(rhs, num_sub(predicted.measured, predicted.used));
    }
    for (unsigned j = 0; j < shape->loops; j++)
        q->m[i][j] = p.behind[j] == 0 && shape->delay[i][j] ? p.g[j][0] : num_zero();
    q->m[i][i] = num_add(q->m[i][i], g->lambda[i]);
    if (shape->weight == GMV_WEIGHT_SCALAR) {
        num_t u = gmv_applied(s, i, 1);
        if (shape->form == GMV_INCREMENTAL)
            u = num_sub(u, gmv_applied(s, i, shape->delay[i][i]));
        rhs = num_sub(rhs, num_mul(g->lambda[i], u));
    }
    q->rhs[i] = rhs;
}

/* Each equation divided by its largest coefficient. False: it has none. */
static bool scale_equations(struct equations *q, unsigned loops, uint8_t acting)
{
    for (unsigned i = 0; i < loops; i++) {
        num_t largest = num_zero();
        if (!(acting & (1u << i)))
            continue;
        for (unsigned j = 0; j < loops; j++)
            if (acting & (1u << j))
                largest = num_max(largest, num_abs(q->m[i][j]));
        if (num_lt(largest, num_from_float(LEAST_COEFFICIENT)))
            return false;
        for (unsigned j = 0; j < loops; j++)
            q->m[i][j] = num_div(q->m[i][j], largest);
        q->rhs[i] = num_div(q->rhs[i], largest);
    }
    return true;
}

/* Two unknowns at most, so elimination is written out. False: the determinant is too small. */
static bool solve_together(num_t least, const struct equations *q, uint8_t acting, num_t *move)
{
    if (acting != 3u) {
        unsigned i = acting == 2u;
        if (num_lt(num_abs(q->m[i][i]), least))
            return false;
        move[i] = num_div(q->rhs[i], q->m[i][i]);
        return true;
    }
    num_t determinant = num_sub(num_mul(q->m[0][0], q->m[1][1]), num_mul(q->m[0][1], q->m[1][0]));
    if (num_lt(num_abs(determinant), least))
        return false;
    num_wide_t first = num_wide_add(num_wide_zero(), q->rhs[0], q->m[1][1]);
    num_wide_t second = num_wide_add(num_wide_zero(), q->rhs[1], q->m[0][0]);
    move[0] =
        num_div(num_from_wide(num_wide_add(first, num_neg(q->rhs[1]), q->m[0][1])), determinant);
    move[1] =
        num_div(num_from_wide(num_wide_add(second, num_neg(q->rhs[0]), q->m[1][0])), determinant);
    return true;
}

/* The moves of those in `free`, with those of the others as they are. */
static enum gmv_solved solve_moves(const struct gmv *g, const struct equations *q, uint8_t free,
                                   num_t *move)
{
    unsigned loops = gmv_samples_shape(&g->samples)->loops;
    struct equations left = *q;
    for (unsigned i = 0; i < loops; i++)
        for (unsigned j = 0; j < loops; j++)
            if (!(free & (1u << j)))
                left.rhs[i] = num_sub(left.rhs[i], num_mul(left.m[i][j], move[j]));
    if (!scale_equations(&left, loops, free))
        return GMV_NO_NUMBER;
    if (solve_together(g->determinant, &left, free, move))
        return GMV_SOLVED;
    for (unsigned i = 0; i < loops; i++) {
        num_t own = q->m[i][i];
        if (!(free & (1u << i)))
            continue;
        if (num_lt(num_abs(own), num_from_float(LEAST_COEFFICIENT)))
            return GMV_NO_NUMBER;
        move[i] = num_div(q->rhs[i], own);
    }
    return GMV_ONE_BY_ONE;
}

/* The member of `free` that is farthest beyond its limits, or loops: none is. */
static unsigned farthest_out(unsigned loops, const struct gmv_range *range, uint8_t free,
                             const num_t *u)
{
    unsigned worst = loops;
    num_t most = num_zero();
    for (unsigned i = 0; i < loops; i++) {
        num_t beyond = num_max(num_sub(u[i], range->hi[i]), num_sub(range->lo[i], u[i]));
        if ((free & (1u << i)) && num_lt(most, beyond)) {
            most = beyond;
            worst = i;
        }
    }
    return worst;
}

enum gmv_solved gmv_solve(struct gmv *g, const struct gmv_sample *s, uint8_t acting,
                          const struct gmv_range *range, num_t *u)
{
    REFLUX_ASSERT(gmv_shape(g)->loops <= GMV_LOOPS);
    unsigned loops = gmv_samples_shape(&g->samples)->loops;
    struct equations q;
    num_t move[GMV_LOOPS], before[GMV_LOOPS], next[GMV_LOOPS];
    enum gmv_solved solved = GMV_SOLVED;
    uint8_t free = acting;
    for (unsigned i = 0; i < loops; i++) {
        build(g, s, i, &q);
        before[i] = gmv_applied(s, i, 1);
        next[i] = acting & (1u << i) ? before[i] : range->fixed[i];
        move[i] = num_sub(next[i], before[i]);
    }
    /* One more is put to its limit in each round. */
    for (unsigned round = 0; round <= loops && free; round++) {
        enum gmv_solved how = solve_moves(g, &q, free, move);
        if (how == GMV_NO_NUMBER)
            return how;
        solved = how > solved ? how : solved;
        for (unsigned i = 0; i < loops; i++)
            if (free & (1u << i))
                next[i] = num_add(before[i], move[i]);
        unsigned out = farthest_out(loops, range, free, next);
        if (out == loops)
            break;
        next[out] = num_clamp(next[out], range->lo[out], range->hi[out]);
        move[out] = num_sub(next[out], before[out]);
        free &= (uint8_t) ~(1u << out);
    }
    for (unsigned i = 0; i < loops; i++)
        u[i] = next[i];
    return solved;
}
