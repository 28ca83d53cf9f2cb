/* The banded covariance at one stage (covariance_band_inside.h), for the number of fractions that small_blocks.h is included for. */
#include "kinds/composition/covariance_band_inside.h"
#include "kinds/composition/small_blocks.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

#ifdef SMALL_BLOCKS_M
#define M_SIZE     SMALL_BLOCKS_M
#define M_OF(c)    ((size_t)SMALL_BLOCKS_M)
#define BAND_STAGE ALWAYS_INLINE
#else
#define M_SIZE  COVARIANCE_BAND_M_MAX
#define M_OF(c) ((c)->m)
#define BAND_STAGE
#endif
#define BLOCK_SIZE ((size_t)M_SIZE * M_SIZE)

_Static_assert(COVARIANCE_BAND_M_MAX >= 2 && COVARIANCE_BAND_M_MAX <= BLOCK_M_MAX,
               "more fractions a stage than blocks are made for");

/* The blocks that a sweep carries, where a compiler sees that nothing else points to them. */
struct band_along {
    real_t block[4][BLOCK_SIZE];
};

static BAND_STAGE void fetch_along(size_t m, const struct band_view *c, struct band_along *along)
{
    for (size_t k = 0; k < 4; k++)
        block_copy(m * m, c->block[k], along->block[k]);
}

static BAND_STAGE void keep_along(size_t m, const struct band_along *along, struct band_view *c)
{
    for (size_t k = 0; k < 4; k++)
        block_copy(m * m, along->block[k], c->block[k]);
}

/* Expresses a stage by the new extras in place of the old ones; the rest goes to the stage's covariances. row: numbers that each extra adds to
 * its own, of the stage above, and afterwards of this stage. */
static BAND_STAGE void renew_stage(size_t m, struct band_view *c,
                                   const struct covariance_step *step, size_t s, real_t *own,
                                   real_t *up, real_t *restrict said)
{
    real_t *restrict row = c->row;
    const real_t *restrict push = &step->push[s * m];
    size_t extras = c->extras, n = c->stages * m;

    for (size_t e = 0; e < extras; e++)
        for (size_t i = 0; i < m; i++)
            said[e * m + i] += push[e * n + i];
    for (size_t e = 0; e < extras; e++, row += m) {
        const struct covariance_band_fresh *fresh = &c->fresh[e];
        real_t mine[M_SIZE] = {ZERO}, weighed[M_SIZE];
        if (!(fresh->unknown > ZERO))
            continue;
        for (size_t i = 0; i < m; i++) {
            mine[i] = said[e * m + i];
            weighed[i] = fresh->unknown * mine[i];
        }
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < m; j++) {
                own[i * m + j] = real_fma(mine[i], weighed[j], own[i * m + j]);
                up[i * m + j] = real_fma(mine[i], row[j], up[i * m + j]);
            }
        block_copy(m, weighed, row);
        for (size_t o = 0; o < extras; o++)
            for (size_t i = 0; i < m; i++)
                said[o * m + i] = real_fma(fresh->mix[o], mine[i], said[o * m + i]);
    }
}

/* r_s = P_s (b_s + l_s r_(s+1)) */
static BAND_STAGE void carry_down(size_t m, struct band_view *c, const struct covariance_step *step,
                                  size_t s, struct band_along *along)
{
    size_t stride = covariance_band_stride(m, c->extras);
    const real_t *p_stage = &step->transition->factors[s * column_transition_stride(m)];
    real_t *stage = &c->blocks[s * stride], *restrict said = stage + 2 * m * m;
    real_t *says_r = along->block[BAND_B_SAYS_R], liquid = p_stage[3 * m * m];
    real_t p[BLOCK_SIZE], own[BLOCK_SIZE], up[BLOCK_SIZE], above[BLOCK_SIZE];
    real_t b_r[BLOCK_SIZE], mixed[BLOCK_SIZE], carried[BLOCK_SIZE];
    struct block_factors factors = {.inverse = {ZERO}};
    bool top = s + 1 == c->stages;

    block_copy(m * m, p_stage, p);
    block_copy(m * m, stage, own);
    block_copy(m * m, stage + m * m, up);
    renew_stage(m, c, step, s, own, up, said);
    block_factor(m, own, &factors);
    if (top) {
        block_copy(m * m, own, mixed);
    } else {
        block_copy(m * m, stage + stride, above);
        block_product(m, up, says_r, b_r); /* C(b_s, r_(s+1)) */
        for (size_t i = 0; i < m * m; i++) {
            mixed[i] = real_fma(liquid, b_r[i], own[i]);
            carried[i] = real_fma(liquid, above[i], b_r[i]);
        }
        block_product(m, p, carried, up);
    }
    block_product_turned(m, mixed, p, b_r); /* C(b_s, r_s) */
    block_copy(m * m, b_r, carried);
    if (!top)
        for (size_t i = 0; i < m; i++)
            for (size_t j = 0; j < m; j++)
                carried[i * m + j] = real_fma(liquid, up[j * m + i], carried[i * m + j]);
    block_product(m, p, carried, own);
    block_mirror(m, own);
    block_copy(m * m, own, stage);
    block_copy(m * m, up, stage + m * m);
    for (size_t j = 0; j < m; j++)
        block_solve(m, &factors, m, &b_r[j]);
    block_copy(m * m, b_r, says_r);
    for (size_t e = 0; e < c->extras; e++) {
        real_t *here = said + e * m, sum[M_SIZE];
        for (size_t i = 0; i < m; i++)
            sum[i] = top ? here[i] : real_fma(liquid, here[stride + i], here[i]);
        for (size_t i = 0; i < m; i++) {
            real_t out = p[i * m] * sum[0];
            for (size_t k = 1; k < m; k++)
                out = real_fma(p[i * m + k], sum[k], out);
            here[i] = out;
        }
    }
}

/* The same for the dependence on the extras, and for the vapour. */
static BAND_STAGE void carry_extras_up(size_t m, size_t extras, const real_t *t, const real_t *g,
                                       real_t keep, real_t *restrict said, real_t *restrict vapour)
{
    for (size_t e = 0; e < extras; e++, said += m, vapour += m) {
        real_t w[M_SIZE], d[M_SIZE];
        for (size_t i = 0; i < m; i++) {
            w[i] = vapour[i];
            d[i] = said[i];
        }
        for (size_t i = 0; i < m; i++)
            for (size_t k = 0; k < m; k++)
                d[i] = real_fma(t[i * m + k], w[k], d[i]);
        for (size_t i = 0; i < m; i++) {
            real_t sum = keep * w[i];
            for (size_t k = 0; k < m; k++)
                sum = real_fma(g[i * m + k], d[k], sum);
            vapour[i] = sum;
        }
        block_copy(m, d, said);
    }
}

/* d_s = r_s + T_s w_(s-1), w_s = keep_s w_(s-1) + G_s d_s */
static BAND_STAGE void carry_up(size_t m, struct band_view *c, const struct covariance_step *step,
                                size_t s, struct band_along *along)
{
    size_t stride = covariance_band_stride(m, c->extras);
    const real_t *p = &step->transition->factors[s * column_transition_stride(m)];
    real_t keep = p[3 * m * m + 1], *stage = &c->blocks[s * stride];
    real_t *w_r = along->block[BAND_W_R], *d_r = along->block[BAND_D_R];
    real_t *d_w = along->block[BAND_D_W], *w_w = along->block[BAND_W_W];
    real_t t[BLOCK_SIZE], g[BLOCK_SIZE], own[BLOCK_SIZE], next[BLOCK_SIZE];
    real_t w_d[BLOCK_SIZE], own_r[BLOCK_SIZE], part[BLOCK_SIZE], new_w_r[BLOCK_SIZE];
    struct block_factors factors = {.inverse = {ZERO}};

    block_copy(m * m, p + m * m, t);
    block_copy(m * m, p + 2 * m * m, g);
    block_copy(m * m, stage, own);
    block_copy(m * m, stage + m * m, next); /* S_s^-1 S_(s,s+1), of r */
    block_factor(m, own, &factors);
    for (size_t j = 0; j < m; j++)
        block_solve(m, &factors, m, &next[j]);
    block_times_turned(m, ONE, d_r, d_w, t, part); /* C(d_(s-1), d_s) */
    if (s > 0)
        block_copy(m * m, part, stage - stride + m * m);
    block_times_turned(m, ONE, w_r, w_w, t, w_d); /* C(w_(s-1), d_s) */
    block_times(m, ONE, own, t, w_r, own_r);      /* C(d_s, r_s) */
    block_product(m, t, w_d, part);
    for (size_t i = 0; i < m; i++)
        for (size_t j = i; j < m; j++)
            own[i * m + j] = own_r[i * m + j] + part[j * m + i];
    block_mirror(m, own);
    block_times(m, keep, w_r, g, own_r, new_w_r);   /* C(w_s, r_s) */
    block_times_turned(m, keep, w_w, w_d, g, part); /* C(w_(s-1), w_s) */
    block_product_turned(m, own, g, d_w);           /* C(d_s, w_s) */
    for (size_t i = 0; i < m; i++)
        for (size_t j = 0; j < m; j++)
            d_w[i * m + j] = real_fma(keep, w_d[j * m + i], d_w[i * m + j]);
    block_times(m, keep, part, g, d_w, w_w);
    block_product(m, new_w_r, next, w_r); /* the stage above is bound by this one alone */
    block_product(m, own_r, next, d_r);
    for (size_t i = 0; i < m; i++)
        own[i * (m + 1)] = band_at_least(own[i * (m + 1)] * COVARIANCE_BAND_GROWTH);
    block_copy(m * m, own, stage);
    carry_extras_up(m, c->extras, t, g, keep, stage + 2 * m * m, c->row);
}

static BAND_STAGE void sweep_stages(size_t m, struct band_view *c,
                                    const struct covariance_step *step, size_t count)
{
    struct band_along along;

    fetch_along(m, c, &along);
    if (c->down)
        for (; count > 0; count--)
            carry_down(m, c, step, --c->next, &along);
    else
        for (; count > 0; count--)
            carry_up(m, c, step, c->next++, &along);
    keep_along(m, &along, c);
}

/* ---- a measurement ---- */

/* No number has more in common with a measurement than its own variance and that of the measurement allow. */
static BAND_STAGE real_t within_covariance(real_t g, real_t variance, real_t spread)
{
    real_t most = variance * spread;
    if (g * g <= most)
        return g;
    most = real_sqrt(most);
    return g < ZERO ? -most : most;
}

/* Takes a measurement at one stage. g: S h' of the stage; own: its S. */
static BAND_STAGE void take_stage(size_t m, size_t extras, const struct band_seen *seen,
                                  const real_t *g, const real_t *part, real_t *restrict own,
                                  real_t *restrict said, real_t *restrict gain)
{
    real_t sum[M_SIZE];

    for (size_t i = 0; i < m; i++)
        for (size_t j = i; j < m; j++) {
            real_t old = own[i * m + j], updated = real_fma(part[i], g[j], old);
            real_t least = real_fma(seen->left, old, COVARIANCE_LEAST);
            if (i == j && !(updated > least))
                updated = least;
            own[i * m + j] = updated;
        }
    block_mirror(m, own);
    block_copy(m, g, sum);
    for (size_t e = 0; e < extras; e++, said += m) {
        real_t of_extra = seen->extra_gain[e], by_extra = seen->by_extra[e];
        for (size_t i = 0; i < m; i++) {
            real_t old = said[i];
            sum[i] = real_fma(old, of_extra, sum[i]);
            said[i] = real_fma(part[i], by_extra, old);
        }
    }
    for (size_t i = 0; i < m; i++)
        gain[i] = sum[i] * seen->per_alpha;
}

/* From the stage of the measurement on, upwards or down, in steps of `stride` numbers. */
static BAND_STAGE void spread_on(size_t m, const struct band_view *c, const struct band_seen *seen,
                                 bool upwards, const real_t *first, real_t *gain)
{
    size_t stride = covariance_band_stride(m, c->extras), extras = c->extras;
    size_t count = upwards ? c->stages - 1 - seen->stage : seen->stage;
    real_t *own = &c->blocks[seen->stage * stride];
    real_t behind[M_SIZE], from[M_SIZE], g[M_SIZE] = {ZERO}, part[M_SIZE] = {ZERO};
    real_t spread = seen->spread, per_bound = -seen->per_bound;
    struct block_factors factors = {.inverse = {ZERO}};

    block_copy(m, seen->slope, behind); /* S^-1 S h' */
    block_copy(m, first, from);
    gain += seen->stage * m;
    for (; count > 0; count--) {
        real_t *through = upwards ? own + m * m : own - stride + m * m;
        own = upwards ? own + stride : own - stride;
        gain = upwards ? gain + m : gain - m;
        for (size_t i = 0; i < m; i++) {
            real_t sum = ZERO;
            for (size_t k = 0; k < m; k++)
                sum = real_fma(through[upwards ? k * m + i : i * m + k], behind[k], sum);
            g[i] = within_covariance(sum, own[i * (m + 1)], spread);
            part[i] = g[i] * per_bound;
        }
        for (size_t i = 0; i < m; i++)
            for (size_t k = 0; k < m; k++) {
                real_t *between = &through[upwards ? k * m + i : i * m + k];
                *between = real_fma(part[i], from[k], *between);
            }
        block_factor(m, own, &factors);
        block_copy(m, g, behind);
        block_copy(m, g, from);
        block_solve(m, &factors, 1, behind);
        take_stage(m, extras, seen, g, part, own, own + 2 * m * m, gain);
    }
}

static BAND_STAGE void spread_stages(size_t m, const struct band_view *c,
                                     const struct band_seen *seen, real_t *gain)
{
    real_t *own = &c->blocks[seen->stage * covariance_band_stride(m, c->extras)];
    real_t g[M_SIZE] = {ZERO}, part[M_SIZE] = {ZERO};

    for (size_t i = 0; i < m; i++) {
        real_t sum = ZERO;
        for (size_t k = 0; k < m; k++)
            sum = real_fma(own[i * m + k], seen->slope[k], sum);
        g[i] = within_covariance(sum, own[i * (m + 1)], seen->spread);
        part[i] = g[i] * -seen->per_bound;
    }
    take_stage(m, c->extras, seen, g, part, own, own + 2 * m * m, &gain[seen->stage * m]);
    spread_on(m, c, seen, true, g, gain);
    spread_on(m, c, seen, false, g, gain);
}
