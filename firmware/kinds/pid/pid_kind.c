/* PID as a kind of block: a loop's own controller. */
#include "kinds/pid/pid.h"

#include <string.h>

static struct pid_config pid_settings(const struct block_setup *setup)
{
    const struct loop_settings *l = setup->settings;
    bool drives_mv = setup->member[0].drives_mv;
    return (struct pid_config){
        .gain = l->gain,
        .ti_s = l->ti_s,
        .td_s = l->td_s,
        .n = l->n,
        .b = l->b,
        .c = l->c,
        .tt_s = l->tt_s,
        /* The MV has its own limits, with decoupler and feedforward included: the controller's output alone may lie far outside the
         * span. These limits only keep it within num_t. */
        .out_lo = drives_mv ? -PID_OUTPUT_MAX : l->out_lo,
        .out_hi = drives_mv ? PID_OUTPUT_MAX : l->out_hi,
        .rate_per_s = l->out_rate_per_s,
        .inhibit_s = l->inhibit_s,
        .action = l->action == LOOP_DIRECT ? PID_DIRECT : PID_REVERSE,
        .form = l->algorithm == LOOP_VELOCITY ? PID_VELOCITY : PID_POSITIONAL,
    };
}

/* Returns the parameter's name for a field, because people know the parameters. */
static const char *pid_parameter(const char *field)
{
    static const struct {
        const char *field, *parameter;
    } names[] = {
        {"ti_s", "ti"},           {"td_s", "td"},        {"tt_s", "tt"}, {"rate_per_s", "out_rate"},
        {"inhibit_s", "inhibit"}, {"form", "algorithm"},
    };
    for (unsigned i = 0; i < sizeof names / sizeof names[0]; i++)
        if (strcmp(field, names[i].field) == 0)
            return names[i].parameter;
    return field;
}

static uint32_t pid_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct pid);
}

static enum err pid_check(const struct block_setup *setup, struct block_fault *fault)
{
    struct pid_config config = pid_settings(setup);
    const struct loop_settings *l = setup->settings;
    enum err err = pid_validate(&config, &fault->field, &fault->wanted);
    if (!err && !(l->out_lo < l->out_hi)) { /* drives_mv replaced them above */
        err = ERR_RANGE;
        fault->field = "out_lo";
        fault->wanted = "below out_hi";
    }
    fault->member = 0;
    fault->field = pid_parameter(fault->field);
    return err;
}

static enum err pid_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct pid_config config = pid_settings(setup);
    return retune ? pid_retune(state, &config, setup->interval_s)
                  : pid_init(state, &config, setup->interval_s);
}

static bool pid_same(const struct block_setup *before, const struct block_setup *now)
{
    const struct loop_settings *x = before->settings, *y = now->settings;
    bool limits = now->member[0].drives_mv || (x->out_lo == y->out_lo && x->out_hi == y->out_hi);
    return limits && x->gain == y->gain && x->ti_s == y->ti_s && x->td_s == y->td_s &&
           x->n == y->n && x->b == y->b && x->c == y->c && x->tt_s == y->tt_s &&
           x->inhibit_s == y->inhibit_s && x->out_rate_per_s == y->out_rate_per_s &&
           x->action == y->action && x->algorithm == y->algorithm;
}

static void pid_tell_limits(const struct pid *pid, struct block_io *io)
{
    io->members.limited[0] = num_lt(pid->output, pid->raw)   ? INTEGRAL_CLAMP_UP
                             : num_lt(pid->raw, pid->output) ? INTEGRAL_CLAMP_DOWN
                                                             : INTEGRAL_FREE;
}

static void pid_kind_step(void *state, struct block_io *io)
{
    io->members.out[0] = pid_step(state, io->members.setpoint[0], io->members.in[0]);
    pid_tell_limits(state, io);
}

static void pid_kind_back_calculate(void *state, struct block_io *io)
{
    pid_back_calculate(state, io->members.out[0], io->members.clamp[0]);
    pid_tell_limits(state, io);
}

static void pid_kind_follow(void *state, struct block_io *io)
{
    pid_follow(state, io->members.setpoint[0], io->members.in[0], io->members.out[0]);
    io->members.limited[0] = INTEGRAL_FREE;
}

static void pid_kind_shift(void *state, struct block_io *io)
{
    pid_shift(state, io->members.out[0]);
    io->members.limited[0] = INTEGRAL_FREE;
}

static const char *pid_describe(const void *state, size_t i, float *value)
{
    static const char *const names[] = {"error",    "proportional", "integral", "derivative",
                                        "computed", "output",       "inhibited"};
    if (i >= sizeof(names) / sizeof(names[0]))
        return NULL;
    const struct pid *pid = state;
    struct accumulator p = {0};
    accumulator_add_product(&p, pid->gain, pid->proportional_in);
    struct accumulator rest = pid->sum;
    if (pid->form == PID_VELOCITY) { /* sum is the whole output: what the other parts leave */
        accumulator_add(&rest, num_neg(washout_value(&pid->derivative)));
        accumulator_add_product(&rest, pid->gain, num_neg(pid->proportional_in));
    }
    const float values[] = {
        num_to_float(pid->error),
        num_to_float(accumulator_get(&p)),
        num_to_float(accumulator_get(&rest)),
        num_to_float(washout_value(&pid->derivative)),
        num_to_float(pid->raw),
        num_to_float(pid->output),
        pid->inhibited ? 1.0f : 0.0f,
    };
    *value = values[i];
    return names[i];
}

const struct block_kind pid_kind = {
    .name = "pid",
    .stage = STAGE_CONTROL,
    .algorithms = 1u << LOOP_POSITIONAL | 1u << LOOP_VELOCITY,
    .bytes = pid_bytes,
    .check = pid_check,
    .configure = pid_configure,
    .same = pid_same,
    .step = pid_kind_step,
    .back_calculate = pid_kind_back_calculate,
    .follow = pid_kind_follow,
    .shift = pid_kind_shift,
    .describe = pid_describe,
};
