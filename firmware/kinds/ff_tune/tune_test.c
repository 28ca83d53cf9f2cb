#include "kinds/ff_tune/tune_test.h"

#include "kinds/ff_tune/tune_test_state.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* Least number of parts, of TUNE_PARTS, in which the candidate has to be better. */
#define PARTS_BETTER 6u
/* A part in which d has less than this part of the mean square of when it was learnt tells nothing. */
#define QUIET_PART REAL_C(0.1)
/* After this many times `check` a candidate is untested. */
#define TEST_MOST 4u

void tune_test_begin(struct tune_test *t, const struct tune_context *c)
{
    t->part_samples = tune_samples_in(c, c->s.check_s / (float)TUNE_PARTS);
    t->parts = t->better_parts = 0;
    t->all = t->part = (struct tune_squares){0};
    t->part_at = 0;
}

static enum tune_verdict judge_candidate(struct tune_test *t, const struct tune_context *c,
                                         const struct tune_model *model)
{
    real_t most = ONE - c->s.better / 100;
    /* The candidate cancels the disturbance; the rest is model error. */
    real_t rest = t->all.with_candidate + model->misfit * model->misfit * t->all.no_feedforward;
    bool better = t->better_parts >= PARTS_BETTER && rest <= most * t->all.actual &&
                  rest <= most * t->all.no_feedforward;
    t->promised = t->all.no_feedforward > ZERO ? ONE - rest / t->all.no_feedforward : ZERO;
    t->alone = t->all.d > ZERO ? t->all.no_feedforward / t->all.d : ZERO;
    t->square = t->all.no_feedforward / (real_t)(t->parts * t->part_samples);
    return better ? TUNE_ADOPTED : TUNE_NO_BETTER;
}

static void count_in_test(struct tune_test *t, const struct tune_errors *e, real_t d,
                          real_t move_square)
{
    t->part.actual += e->actual * e->actual;
    t->part.with_candidate += e->with_candidate * e->with_candidate;
    t->part.no_feedforward += e->no_feedforward * e->no_feedforward;
    t->part.d += d * d;
    if (++t->part_at < t->part_samples)
        return;
    if (t->part.d > QUIET_PART * move_square * (real_t)t->part_at) {
        bool better = t->part.with_candidate < t->part.actual;
        t->parts++;
        t->better_parts = (uint8_t)(t->better_parts + (better ? 1u : 0u));
        t->all.actual += t->part.actual;
        t->all.with_candidate += t->part.with_candidate;
        t->all.no_feedforward += t->part.no_feedforward;
        t->all.d += t->part.d;
    }
    t->part = (struct tune_squares){0};
    t->part_at = 0;
}

enum tune_verdict tune_test_step(struct tune_test *t, const struct tune_context *c,
                                 const struct tune_shadows *s, real_t d, real_t move_square,
                                 uint32_t samples)
{
    const struct tune_errors *e = tune_shadows_errors(s);
    if (tune_shadow_is_lost(s) || tune_candidate_is_lost(s))
        return TUNE_NO_MODEL;
    if (e->count && tune_candidate_is_warm(s, c))
        count_in_test(t, e, d, move_square);
    if (t->parts >= TUNE_PARTS)
        return judge_candidate(t, c, tune_shadows_model(s));
    uint32_t most = TEST_MOST * (TUNE_PARTS * t->part_samples) + 4u * tune_forgets_in(s, c);
    return samples > most ? TUNE_UNTESTED : TUNE_NONE;
}

unsigned tune_test_parts(const struct tune_test *t)
{
    return t->parts;
}

void tune_test_forget(struct tune_test *t)
{
    t->promised = 0;
}

real_t tune_test_promised(const struct tune_test *t)
{
    return t->promised;
}

real_t tune_test_square(const struct tune_test *t)
{
    return t->square;
}

real_t tune_test_alone(const struct tune_test *t)
{
    return t->alone;
}
