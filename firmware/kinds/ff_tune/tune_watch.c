#include "kinds/ff_tune/tune_watch.h"

#include "kinds/ff_tune/tune_watch_state.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* The loop is worse with more than so many times the squares without the element. */
#define WORSE_THAN REAL_C(1.1)
/* An element need do nothing where there is less than this part of the squares that were tested. */
#define LITTLE REAL_C(0.25)
/* Memory of the watch, part of `check`. */
#define WATCH_PART REAL_C(0.25)
/* An element may do less than half of what was tested for this part of `check`. */
#define CHANGED_PART 0.5f
/* After so many changes in a row, none of which has brought what was promised, it stays as it is. */
#define CHANGES_MOST 3u

void tune_watch_begin(struct tune_watch *w)
{
    w->actual = w->no_feedforward = w->d = w->weight = ZERO;
    w->since_change = w->worse_for = 0;
    w->as_alone = false;
}

static real_t memory_of_watch(const struct tune_context *c)
{
    return WATCH_PART * c->s.check_s / c->h_s;
}

float tune_improvement(const struct tune_watch *w, const struct tune_context *c)
{
    bool whole = w->weight > REAL_C(0.1) * memory_of_watch(c);
    return whole && w->no_feedforward > ZERO ? 100 * (float)(ONE - w->actual / w->no_feedforward)
                                             : 0;
}

enum tune_verdict tune_watch_step(struct tune_watch *w, const struct tune_context *c,
                                  const struct tune_shadows *s, const struct tune_test *test,
                                  real_t d, bool rests)
{
    const struct tune_errors *e = tune_shadows_errors(s);
    real_t memory = memory_of_watch(c), keep = ONE - ONE / memory;
    real_t alone = tune_test_alone(test);
    if (!e->count)
        return TUNE_NONE;
    w->actual = keep * w->actual + e->actual * e->actual;
    w->no_feedforward = keep * w->no_feedforward + e->no_feedforward * e->no_feedforward;
    w->d = keep * w->d + d * d;
    w->weight = keep * w->weight + ONE;
    bool whole = w->weight > REAL_C(0.5) * memory;
    /* The shadow has the model of the test. If the process has changed since, it may find good what is no better than feedback alone was. */
    w->as_alone = alone > ZERO && w->actual > alone * w->d;
    real_t most = (ONE - REAL_C(0.5) * tune_test_promised(test)) * w->no_feedforward;
    bool less = whole && (w->as_alone || w->actual > most);
    /* While the disturbance rests, or does little, the element has nothing to do. */
    real_t little = LITTLE * tune_test_square(test) * w->weight;
    bool needed = !rests && (w->actual > little || w->no_feedforward > little);
    w->since_change = less && needed ? w->since_change + 1u : 0;
    w->changes = whole && !less && needed ? 0 : w->changes;
    /* It has to be worse for as long as the loop takes to forget: a feedforward may act before the disturbance does, and loses for that while. */
    bool worse = whole && w->actual > WORSE_THAN * w->no_feedforward;
    w->worse_for = worse ? w->worse_for + 1u : 0;
    return w->worse_for > tune_forgets_in(s, c) ? TUNE_WORSE : TUNE_NONE;
}

bool tune_is_as_alone(const struct tune_watch *w)
{
    return w->as_alone;
}

bool tune_does_too_little(const struct tune_watch *w, const struct tune_context *c)
{
    return w->since_change > tune_samples_in(c, CHANGED_PART * c->s.check_s);
}

bool tune_watch_change(struct tune_watch *w)
{
    bool allowed = w->changes < CHANGES_MOST;
    w->since_change = 0;
    w->changes = (uint8_t)(w->changes + allowed);
    return allowed;
}

void tune_watch_forget_changes(struct tune_watch *w)
{
    w->changes = 0;
}
