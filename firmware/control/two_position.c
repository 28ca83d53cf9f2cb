#include "control/two_position.h"

#include "base/channel.h"

static enum err refuse(enum err code, const char *name, const char *range, const char **field,
                       const char **wanted)
{
    if (field)
        *field = name;
    if (wanted)
        *wanted = range;
    return code;
}

enum err two_position_validate(const struct two_position_config *c, const char **field,
                               const char **wanted)
{
    const struct {
        const char *name;
        float value;
    } numbers[] = {{"band", c->band}, {"out_lo", c->out_lo}, {"out_hi", c->out_hi}};
    for (unsigned i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        if (!float_is_finite(numbers[i].value))
            return refuse(ERR_NOT_FINITE, numbers[i].name, "must be a number", field, wanted);
    if (!(c->band >= 1e-6f && c->band <= 10.0f))
        return refuse(ERR_RANGE, "band", "must be a millionth of the span to 10 spans", field,
                      wanted);
    if (!(c->out_lo >= -100.0f && c->out_lo < c->out_hi))
        return refuse(ERR_RANGE, "out_lo", "must be -100 or more, and below out_hi", field, wanted);
    if (!(c->out_hi <= 100.0f))
        return refuse(ERR_RANGE, "out_hi", "must be 100 or less", field, wanted);
    return ERR_OK;
}

enum err two_position_init(struct two_position *t, const struct two_position_config *c)
{
    enum err err = two_position_validate(c, NULL, NULL);
    if (err)
        return err;
    t->band = num_from_float(c->band);
    t->lo = t->output = num_from_float(c->out_lo);
    t->hi = num_from_float(c->out_hi);
    t->direct = c->direct;
    return ERR_OK;
}

enum err two_position_retune(struct two_position *t, const struct two_position_config *c)
{
    struct two_position old = *t;
    enum err err = two_position_init(t, c);
    if (err)
        return err;
    if (num_eq(old.output, old.hi))
        t->output = t->hi;
    else if (!num_eq(old.output, old.lo))
        t->output = old.output;
    return ERR_OK;
}

num_t two_position_step(struct two_position *t, num_t setpoint, num_t measurement)
{
    if (num_lt(num_add(setpoint, t->band), measurement))
        t->output = t->direct ? t->hi : t->lo;
    else if (num_lt(measurement, num_sub(setpoint, t->band)))
        t->output = t->direct ? t->lo : t->hi;
    return t->output;
}

void two_position_follow(struct two_position *t, num_t applied)
{
    t->output = applied;
}

static void two_step(void *state, const num_t *setpoint, const num_t *measurement, num_t *output)
{
    output[0] = two_position_step(state, setpoint[0], measurement[0]);
}

static void two_back(void *state, const num_t *applied, const uint8_t *hold)
{
    (void)state;
    (void)applied;
    (void)hold;
}

static void two_follow(void *state, const num_t *setpoint, const num_t *measurement,
                       const num_t *applied)
{
    (void)setpoint;
    (void)measurement;
    two_position_follow(state, applied[0]);
}

static const char *two_describe(const void *state, size_t i, float *value)
{
    static const char *const names[] = {"output", "low", "high", "band"};
    if (i >= sizeof names / sizeof names[0])
        return NULL;
    const struct two_position *t = state;
    const num_t values[] = {t->output, t->lo, t->hi, t->band};
    *value = num_to_float(values[i]);
    return names[i];
}

const struct block_ops two_position_block = {
    .kind = "two_position",
    .step = two_step,
    .back = two_back,
    .follow = two_follow,
    .describe = two_describe,
};
