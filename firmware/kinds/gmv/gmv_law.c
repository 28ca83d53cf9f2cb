/* The control law: an equation for each loop that acts, linear in the moves of the MVs, solved together (docs/self-tuning.md,
 * Control laws; Folami 1989, 8.14 to 8.19, 8.30). */
#include "kinds/gmv/gmv_inside.h"

/* m move = rhs; move_j = u_j(t) - u_j(t - 1). */
struct equations {
    num_t m[GMV_LOOPS][GMV_LOOPS], rhs[GMV_LOOPS];
};

/* Smaller coefficients than these are no gain: a division by one would ask for any move. */
#define LEAST_COEFFICIENT 1e-6f

/* u_j(t - steps) as the form takes it; u_j(t) as if it did not move. */
static num_t known_input(const struct gmv *g, const struct gmv_sample *s, unsigned j,
                         unsigned steps, unsigned k)
{
    if (steps)
        return gmv_applied_taken(g, s, j, steps, k);
    num_t stays = gmv_applied(s, j, 1);
    return g->shape.form == GMV_INCREMENTAL ? num_sub(stays, gmv_applied(s, j, k)) : stays;
}

/* What the prediction has besides the moves of this step. */
static num_t known_part(const struct gmv *g, const struct gmv_sample *s, unsigned i,
                        const struct gmv_predictor *p)
{
    unsigned k = g->shape.delay[i][i];
    num_wide_t sum = num_wide_add(num_wide_zero(), p->rest, num_one());
    for (unsigned a = 0; a < p->nf; a++)
        sum = num_wide_add(sum, p->f[a], gmv_taken(g, &g->y[i], a, k));
    for (unsigned j = 0; j < g->shape.loops; j++)
        for (unsigned b = 0; b < p->ng && g->shape.delay[i][j]; b++)
            sum = num_wide_add(sum, p->g[j][b], known_input(g, s, j, p->behind[j] + b, k));
    return num_from_wide(sum);
}

static void build(const struct gmv *g, const struct gmv_sample *s, unsigned i, struct equations *q)
{
    struct gmv_predictor p;
    gmv_predict(g, i, &p);
    num_t rhs = num_sub(gmv_setpoint(g, i), known_part(g, s, i, &p));
    if (g->shape.form == GMV_INCREMENTAL)
        rhs = num_sub(rhs, gmv_auxiliary(g, i));
    if (g->shape.bias == GMV_BIAS_ERROR) /* P y as it was predicted in place of P y (8.18) */
        rhs = num_add(rhs, num_sub(g->predicted[i].measured, g->predicted[i].used));
    for (unsigned j = 0; j < g->shape.loops; j++)
        q->m[i][j] = p.behind[j] == 0 && g->shape.delay[i][j] ? p.g[j][0] : num_zero();
    q->m[i][i] = num_add(q->m[i][i], g->lambda[i]);
    if (g->shape.weight == GMV_WEIGHT_SCALAR) {
        num_t u = gmv_applied(s, i, 1);
        if (g->shape.form == GMV_INCREMENTAL)
            u = num_sub(u, gmv_applied(s, i, g->shape.delay[i][i]));
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
static bool solve_together(const struct gmv *g, const struct equations *q, uint8_t acting,
                           num_t *move)
{
    if (acting != 3u) {
        unsigned i = acting == 2u;
        if (num_lt(num_abs(q->m[i][i]), g->determinant))
            return false;
        move[i] = num_div(q->rhs[i], q->m[i][i]);
        return true;
    }
    num_t determinant = num_sub(num_mul(q->m[0][0], q->m[1][1]), num_mul(q->m[0][1], q->m[1][0]));
    if (num_lt(num_abs(determinant), g->determinant))
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
    struct equations left = *q;
    for (unsigned i = 0; i < g->shape.loops; i++)
        for (unsigned j = 0; j < g->shape.loops; j++)
            if (!(free & (1u << j)))
                left.rhs[i] = num_sub(left.rhs[i], num_mul(left.m[i][j], move[j]));
    if (!scale_equations(&left, g->shape.loops, free))
        return GMV_NO_NUMBER;
    if (solve_together(g, &left, free, move))
        return GMV_SOLVED;
    for (unsigned i = 0; i < g->shape.loops; i++) {
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
static unsigned farthest_out(const struct gmv *g, const struct gmv_range *range, uint8_t free,
                             const num_t *u)
{
    unsigned worst = g->shape.loops;
    num_t most = num_zero();
    for (unsigned i = 0; i < g->shape.loops; i++) {
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
    struct equations q;
    num_t move[GMV_LOOPS], before[GMV_LOOPS], now[GMV_LOOPS];
    enum gmv_solved solved = GMV_SOLVED;
    uint8_t free = acting;
    for (unsigned i = 0; i < g->shape.loops; i++) {
        build(g, s, i, &q);
        before[i] = gmv_applied(s, i, 1);
        now[i] = acting & (1u << i) ? before[i] : range->fixed[i];
        move[i] = num_sub(now[i], before[i]);
    }
    /* One more is put to its limit in each round. */
    for (unsigned round = 0; round <= g->shape.loops && free; round++) {
        enum gmv_solved how = solve_moves(g, &q, free, move);
        if (how == GMV_NO_NUMBER)
            return how;
        solved = how > solved ? how : solved;
        for (unsigned i = 0; i < g->shape.loops; i++)
            if (free & (1u << i))
                now[i] = num_add(before[i], move[i]);
        unsigned out = farthest_out(g, range, free, now);
        if (out == g->shape.loops)
            break;
        now[out] = num_clamp(now[out], range->lo[out], range->hi[out]);
        move[out] = num_sub(now[out], before[out]);
        free &= (uint8_t) ~(1u << out);
    }
    for (unsigned i = 0; i < g->shape.loops; i++)
        u[i] = now[i];
    return solved;
}
