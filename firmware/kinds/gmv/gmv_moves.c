#include "kinds/gmv/gmv_moves.h"

#include "base/assertion.h"
#include "base/channel.h"
#include "kinds/gmv/gmv_moves_state.h"
#include "kinds/gmv/gmv_record.h"
#include "kinds/gmv/gmv_samples.h"

/* Steps in which the law's moves fade in, an eighth more in each; the first moves nothing. */
#define FADE_STEPS 8u
/* Request beyond a limit that has shown, to find out when it ends; half of it tells. */
#define PROBE 0.001f
/* An output nearer to the last one is where it was left. */
#define SAME_OUTPUT 1e-5f

void gmv_moves_init(struct gmv_moves *m)
{
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        m->lo[i] = num_zero();
        m->hi[i] = num_one();
    }
    m->has_asked = false;
}

static bool is_near(num_t a, num_t b)
{
    return num_lt(num_abs(num_sub(a, b)), num_from_float(SAME_OUTPUT));
}

bool gmv_moves_continue(const struct gmv_moves *m, unsigned i, num_t out)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return is_near(out, m->applied[i]) || is_near(out, m->given[i]);
}

float gmv_moves_lacked(const struct gmv_moves *m, const struct gmv_sample *sample, unsigned i)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    return m->has_asked ? num_to_float(num_sub(m->asked[i], gmv_applied(sample, i, 1))) : 0;
}

void gmv_moves_learn_limits(struct gmv_moves *m, const struct gmv_sample *sample, unsigned loops)
{
    num_t half = num_from_float(PROBE / 2), none = num_from_float(GMV_STANDS_STILL);
    for (unsigned i = 0; i < loops && m->has_asked; i++) {
        num_t took = gmv_applied(sample, i, 1);
        bool stands = num_lt(num_abs(num_sub(took, gmv_applied(sample, i, 2))), none);
        if (num_lt(num_add(m->hi[i], half), took))
            m->hi[i] = num_one();
        if (num_lt(took, num_sub(m->lo[i], half)))
            m->lo[i] = num_zero();
        if (stands && num_lt(num_add(took, half), m->asked[i]))
            m->hi[i] = took;
        if (stands && num_lt(m->asked[i], num_sub(took, half)))
            m->lo[i] = took;
    }
}

static struct gmv_range range_of_mvs(const struct gmv_moves *m, const struct gmv_sample *sample,
                                     unsigned loops)
{
    struct gmv_range range;
    num_t probe = num_from_float(PROBE);
    for (unsigned i = 0; i < GMV_LOOPS; i++) {
        range.lo[i] = num_sub(m->lo[i], probe);
        range.hi[i] = num_add(m->hi[i], probe);
        range.fixed[i] = i < loops ? gmv_applied(sample, i, 1) : num_zero();
    }
    return range;
}

static bool is_number(num_t x)
{
    return float_is_finite(num_to_float(x));
}

bool gmv_moves_step_law(struct gmv_moves *m, struct gmv *g, const struct gmv_sample *sample,
                        struct block_io *io)
{
    num_t u[GMV_LOOPS];
    unsigned loops = gmv_shape(g)->loops;
    struct gmv_range range = range_of_mvs(m, sample, loops);
    enum gmv_solved solved = gmv_solve(g, sample, io->members.acting, &range, u);
    num_t share = num_from_float((float)m->fading_in / FADE_STEPS);
    m->singular = solved == GMV_ONE_BY_ONE;
    if (solved == GMV_NO_NUMBER)
        return false;
    for (unsigned i = 0; i < loops; i++) {
        if (!(io->members.acting & (1u << i)))
            continue;
        num_t applied = gmv_applied(sample, i, 1);
        num_t move = num_mul(share, num_sub(u[i], applied));
        if (!is_number(move))
            return false;
        m->asked[i] = num_add(applied, move);
        io->members.out[i] = num_add(m->applied[i], move);
    }
    m->has_asked = true;
    m->fading_in = (uint8_t)(m->fading_in + (m->fading_in < FADE_STEPS));
    return true;
}
