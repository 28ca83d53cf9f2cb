#include "kinds/two_position/two_position.h"

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

/* ---- as a kind of block: a loop's own controller ---- */

static uint32_t two_position_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct two_position);
}

static struct two_position_config two_position_settings(const struct block_setup *setup)
{
    const struct loop_settings *l = setup->settings;
    return (struct two_position_config){
        .band = l->band / setup->member[0].pv_span,
        .out_lo = l->out_lo,
        .out_hi = l->out_hi,
        .direct = l->action == LOOP_DIRECT,
    };
}

static enum err two_position_check(const struct block_setup *setup, struct block_fault *fault)
{
    struct two_position_config config = two_position_settings(setup);
    fault->member = 0;
    return two_position_validate(&config, &fault->field, &fault->wanted);
}

static enum err two_position_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct two_position_config config = two_position_settings(setup);
    return retune ? two_position_retune(state, &config) : two_position_init(state, &config);
}

static void two_position_kind_step(void *state, struct block_io *io)
{
    io->members.out[0] = two_position_step(state, io->members.setpoint[0], io->members.in[0]);
}

/* Does nothing: no state depends on the applied output. */
static void two_position_back_calculate(void *state, struct block_io *io)
{
    (void)state;
    (void)io;
}

static void two_position_kind_follow(void *state, struct block_io *io)
{
    two_position_follow(state, io->members.out[0]);
}

static const char *two_position_describe(const void *state, size_t i, float *value)
{
    static const char *const names[] = {"output", "low", "high", "band"};
    if (i >= sizeof names / sizeof names[0])
        return NULL;
    const struct two_position *t = state;
    const num_t values[] = {t->output, t->lo, t->hi, t->band};
    *value = num_to_float(values[i]);
    return names[i];
}

const struct block_kind two_position_kind = {
    .name = "two_position",
    .stage = STAGE_CONTROL,
    .algorithms = 1u << LOOP_TWO_POSITION,
    .retunes_at_once = true,
    .positions = true,
    .uncompensated = "is not for two_position",
    .bytes = two_position_bytes,
    .check = two_position_check,
    .configure = two_position_configure,
    .step = two_position_kind_step,
    .back_calculate = two_position_back_calculate,
    .follow = two_position_kind_follow,
    .shift = two_position_kind_follow,
    .describe = two_position_describe,
};
