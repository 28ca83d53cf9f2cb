#include "kinds/ff_tune/tune_learner.h"

#include "base/assertion.h"
#include "kinds/ff_tune/tune_learner_state.h"

static const struct high_order_shape *shape_of(const struct tune_context *c, bool of_loop)
{
    return &c->shape[of_loop ? 0 : 1];
}

void tune_learner_begin(struct tune_learner *l, const struct tune_context *c,
                        struct high_order *estimator, bool of_loop)
{
    struct high_order_settings rules = tune_rules(&c->s);
    high_order_init(estimator, shape_of(c, of_loop), &rules);
    l->since_look = 0;
    l->move_square = l->loop_square = REAL_C(0.0);
    l->squared = 0;
}

static unsigned reach_of_shape(const struct high_order_shape *s)
{
    REFLUX_ASSERT(s->inputs <= HIGH_ORDER_INPUTS);
    unsigned most = s->na;
    for (unsigned j = 0; j < s->inputs; j++)
        most =
            (unsigned)(s->delay[j] + s->nb[j]) > most ? (unsigned)(s->delay[j] + s->nb[j]) : most;
    return most;
}

/* A held reading stays in the past of the model for as long as the model looks back. */
static bool may_learn(const struct tune_context *c, const struct tune_samples *s, bool of_loop)
{
    unsigned reach = reach_of_shape(shape_of(c, of_loop));
    if (tune_since_bad(s) <= reach + 4u * c->s.smooth)
        return false;
    /* A setpoint that moves is noise where y or u is explained by d alone. */
    return !tune_is_staged(c) || of_loop || tune_since_setpoint(s) > 4u * reach;
}

/* The mean since the stage began, then over as many samples as a stage takes. */
static real_t onto_square(const struct tune_learner *l, real_t square, real_t value)
{
    return square + (value * value - square) / (real_t)l->squared;
}

void tune_learner_step(struct tune_learner *l, const struct tune_context *c,
                       const struct tune_samples *s, struct high_order *estimator, bool of_loop,
                       bool locked)
{
    bool by_u = c->s.method == TUNE_JOINT || c->s.method == TUNE_SENSITIVITY;
    enum tune_signal mover = by_u ? SIGNAL_U : SIGNAL_R;
    num_t u[HIGH_ORDER_INPUTS] = {tune_sample_smooth(s, mover), tune_sample_smooth(s, SIGNAL_D)};
    num_t y = tune_sample_smooth(s, SIGNAL_Y);
    if (tune_is_staged(c) && !of_loop) {
        u[0] = u[1];
        /* D: what the controller gives. */
        if (c->s.method == TUNE_INPUT)
            y = num_sub(tune_sample_smooth(s, SIGNAL_U), tune_sample_smooth(s, SIGNAL_ADDED));
    }
    l->learns = !locked && may_learn(c, s, of_loop);
    l->squared += l->squared < tune_samples_in(c, c->s.learn_s) ? 1u : 0u;
    l->move_square = onto_square(l, l->move_square, tune_sample(s, SIGNAL_D));
    l->loop_square = onto_square(l, l->loop_square, tune_sample(s, mover));
    (void)high_order_step(estimator, y, u, l->learns);
    l->since_look++;
}

bool tune_learner_learns(const struct tune_learner *l)
{
    return l->learns;
}

real_t tune_learner_move_square(const struct tune_learner *l)
{
    return l->move_square;
}

real_t tune_learner_loop_square(const struct tune_learner *l)
{
    return l->loop_square;
}

uint32_t tune_learner_since_look(const struct tune_learner *l)
{
    return l->since_look;
}

void tune_learner_looked(struct tune_learner *l)
{
    l->since_look = 0;
}
