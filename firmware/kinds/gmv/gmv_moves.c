/* A block's moves: what the law wants, as changes of the output, within limits that have shown; the first of them come in little
 * by little. */
#include "kinds/gmv/gmv_block.h"

#include "base/channel.h"

/* Steps in which the law's moves come in, an eighth more in each; the first moves nothing. */
#define FADE_STEPS 8u
/* How far beyond a limit that has shown the law asks, to find out when it is there no longer; half of it tells. */
#define PROBE 0.001f

float gmv_own_gain(const struct gmv *g, unsigned i)
{
    struct gmv_predictor p;
    gmv_predict(g, i, &p);
    return num_to_float(p.g[i][0]);
}

void gmv_set_weights(struct gmv_block *s)
{
    struct gmv *g = gmv_of(s);
    for (unsigned i = 0; i < s->loops && s->relative; i++)
        g->lambda[i] = num_from_float(s->lambda[i] * s->times * gmv_own_gain(g, i));
}

void gmv_learn_limits(struct gmv_block *s, const struct gmv_sample *sample)
{
    num_t half = num_from_float(PROBE / 2), none = num_from_float(GMV_STANDS_STILL);
    for (unsigned i = 0; i < s->loops && s->has_asked; i++) {
        num_t took = gmv_applied(sample, i, 1);
        bool stands = num_lt(num_abs(num_sub(took, gmv_applied(sample, i, 2))), none);
        if (num_lt(num_add(s->hi[i], half), took))
            s->hi[i] = num_one();
        if (num_lt(took, num_sub(s->lo[i], half)))
            s->lo[i] = num_zero();
        if (stands && num_lt(num_add(took, half), s->asked[i]))
            s->hi[i] = took;
        if (stands && num_lt(s->asked[i], num_sub(took, half)))
            s->lo[i] = took;
    }
}

static struct gmv_range range_of_mvs(const struct gmv_block *s, const struct gmv_sample *sample)
{
    struct gmv_range range;
    num_t probe = num_from_float(PROBE);
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        range.lo[i] = num_sub(s->lo[i], probe);
        range.hi[i] = num_add(s->hi[i], probe);
        range.fixed[i] = i < s->loops ? gmv_applied(sample, i, 1) : num_zero();
    }
    return range;
}

static bool is_number(num_t x)
{
    return float_is_finite(num_to_float(x));
}

bool gmv_step_law(struct gmv_block *s, const struct gmv_sample *sample, struct block_io *io)
{
    num_t u[GMV_LOOPS];
    struct gmv_range range = range_of_mvs(s, sample);
    enum gmv_solved solved = gmv_solve(gmv_of(s), sample, io->acting, &range, u);
    num_t share = num_from_float((float)s->fading_in / FADE_STEPS);
    s->singular = solved == GMV_ONE_BY_ONE;
    if (solved == GMV_NO_NUMBER)
        return false;
    for (unsigned i = 0; i < s->loops; i++) {
        if (!(io->acting & (1u << i)))
            continue;
        num_t applied = gmv_applied(sample, i, 1);
        num_t move = num_mul(share, num_sub(u[i], applied));
        if (!is_number(move))
            return false;
        s->asked[i] = num_add(applied, move);
        io->out[i] = num_add(s->told[i], move);
    }
    s->has_asked = true;
    s->fading_in = (uint8_t)(s->fading_in + (s->fading_in < FADE_STEPS));
    return true;
}

void gmv_forget_limits(struct gmv_block *s)
{
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        s->lo[i] = num_zero();
        s->hi[i] = num_one();
    }
    s->has_asked = false;
}

void gmv_begin_law(struct gmv_block *s)
{
    s->fading_in = 0;
    s->has_asked = false;
}
