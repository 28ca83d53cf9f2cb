/* A controller of two loops: state feedback with integral action, the two loops decoupled.
 *
 * Model, in fractions of span; the states y are read as further inputs, predictions where the plant has dead time:
 *     lag_i dy_i/dt = -y_i + v_i,   v = G u        G: gains, u: the members' outputs
 * Feedback
 *     v_i = w_i r_i - f_i y_i + q_i,   dq_i/dt = c_i (r_i - PV_i),   u = G^-1 v
 *     f_i = 2 lag_i/lambda_i - 1,  c_i = lag_i/lambda_i^2,  w_i = lag_i/lambda_i
 * It puts both poles of each loop at -1/lambda_i, and w_i a zero onto one of them: a setpoint is followed like a first-order
 * lag lambda_i behind the dead time (pole placement, e.g. Astrom and Wittenmark, Computer-Controlled Systems, 1997, chapter 4).
 * The integral is of the measured error, so that a wrong model leaves none.
 *
 * Where one member alone acts, or an output came out short (a limit, a valve that hangs), each loop has v_i = G_ii u_i: the
 * one with an output of its own left is not sacrificed to the other.
 *
 * What took effect: back_calculate takes the difference into q at once; there too the error is summed up. */
#include "kinds.h"

#include <string.h>

#include "num/accumulator.h"

#define BOTH         3u
#define SHORT_FROM   0.001f /* of an output's span: less is no limit */
#define INVERSE_MOST 100.0f /* elements of G^-1: Q7.24 ends at 128 */

struct state_feedback_settings {
    float gain[2][2]; /* PV i per output j, spans */
    float lag_s[2];
    float lambda_s[2];
};

struct state_feedback {
    num_t g[2][2], inverse[2][2], alone[2]; /* alone: 1 / G_ii */
    num_t f[2], w[2];
    struct coefficient c[2]; /* per step */
    struct accumulator q[2];
    num_t setpoint[2], error[2], y[2]; /* of the last step */
    num_t out[2];                      /* what took effect of it */
    uint8_t acting;
    bool together; /* the loops are decoupled */
    bool is_short;
};

static const struct block_parameter state_feedback_parameters[] = {
    {1, BLOCK_FLOAT, offsetof(struct state_feedback_settings, gain), 2, 2, "gain", "-",
     "row: PV, column: output; span per span", -20, 20, 0},
    {2, BLOCK_FLOAT, offsetof(struct state_feedback_settings, lag_s), 1, 2, "lag", "s",
     "time constants of the PVs", 0.001f, 1e6f, 600},
    {3, BLOCK_FLOAT, offsetof(struct state_feedback_settings, lambda_s), 1, 2, "lambda", "s",
     "time constants wanted", 0.001f, 1e6f, 600},
};

/* ---- settings ---- */

static uint32_t state_feedback_bytes(const struct block_setup *setup)
{
    (void)setup;
    return sizeof(struct state_feedback);
}

static float determinant(const struct state_feedback_settings *c)
{
    return c->gain[0][0] * c->gain[1][1] - c->gain[0][1] * c->gain[1][0];
}

static enum err state_feedback_refuse(struct block_fault *fault, uint8_t member, const char *field,
                                      const char *wanted)
{
    *fault = (struct block_fault){.member = member, .field = field, .wanted = wanted};
    return ERR_RANGE;
}

static float magnitude(float x)
{
    return x < 0 ? -x : x;
}

static enum err state_feedback_check(const struct block_setup *setup, struct block_fault *fault)
{
    const struct state_feedback_settings *c = setup->settings;
    if (setup->members != 2)
        return state_feedback_refuse(fault, 0, "loops", "needs two");
    if (setup->inputs != 2)
        return state_feedback_refuse(fault, 0, "inputs", "needs a point for each loop");
    for (uint8_t i = 0; i < 2; i++)
        if (setup->input[i].lo != setup->pv[i].lo || setup->input[i].hi != setup->pv[i].hi)
            return state_feedback_refuse(fault, i, "inputs", "needs the spans of the PVs");
    for (uint8_t i = 0; i < 2; i++) {
        float lambda = c->lambda_s[i], lag = c->lag_s[i];
        if (!(magnitude(c->gain[i][i]) >= 0.01f))
            return state_feedback_refuse(fault, i, "gain", "needs a diagonal of 0.01 or more");
        if (!(lambda <= 1.8f * lag && lambda >= lag / 20.0f))
            return state_feedback_refuse(fault, i, "lambda",
                                         "must be a twentieth of lag to 1.8 times lag");
        if (!(lambda >= 2.0f * setup->interval_s))
            return state_feedback_refuse(fault, i, "lambda", "must be two steps or more");
    }
    float diagonal = magnitude(c->gain[0][0] * c->gain[1][1]), det = magnitude(determinant(c));
    if (!(det >= 0.05f * diagonal))
        return state_feedback_refuse(fault, 0, "gain", "has rows too much alike to be decoupled");
    for (unsigned k = 0; k < 4; k++)
        if (!(magnitude(c->gain[k / 2][k % 2]) <= INVERSE_MOST * det))
            return state_feedback_refuse(fault, 0, "gain", "needs an inverse of 100 or less");
    return ERR_OK;
}

/* The part of v_i that follows setpoint and state at once. */
static num_t proportional(const struct state_feedback *s, unsigned i)
{
    return num_sub(num_mul(s->w[i], s->setpoint[i]), num_mul(s->f[i], s->y[i]));
}

/* Row i of G u, or of its diagonal alone. */
static num_t towards(const struct state_feedback *s, unsigned i, const num_t *u)
{
    num_wide_t sum = num_wide_add(num_wide_zero(), s->g[i][i], u[i]);
    if (s->together)
        sum = num_wide_add(sum, s->g[i][1 - i], u[1 - i]);
    return num_from_wide(sum);
}

/* With the setpoints and states it has, the outputs are those that took effect. */
static void meet_outputs(struct state_feedback *s)
{
    for (unsigned i = 0; i < 2; i++)
        accumulator_set(&s->q[i], num_sub(towards(s, i, s->out), proportional(s, i)));
}

static enum err state_feedback_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct state_feedback *s = state;
    const struct state_feedback_settings *c = setup->settings;
    float det = determinant(c);
    if (!retune)
        memset(s, 0, sizeof *s);
    for (unsigned i = 0; i < 2; i++) {
        float ratio = c->lag_s[i] / c->lambda_s[i];
        s->g[i][i] = num_from_float(c->gain[i][i]);
        s->g[i][1 - i] = num_from_float(c->gain[i][1 - i]);
        s->inverse[i][i] = num_from_float(c->gain[1 - i][1 - i] / det);
        s->inverse[i][1 - i] = num_from_float(-c->gain[i][1 - i] / det);
        s->alone[i] = num_from_float(1.0f / c->gain[i][i]);
        s->w[i] = num_from_float(ratio);
        s->f[i] = num_from_float(2.0f * ratio - 1.0f);
        s->c[i] = coefficient_from_float(ratio / c->lambda_s[i] * setup->interval_s);
    }
    if (retune)
        meet_outputs(s);
    return ERR_OK;
}

/* ---- steps ---- */

static void take_signals(struct state_feedback *s, const struct block_io *io)
{
    for (unsigned i = 0; i < 2; i++) {
        s->setpoint[i] = io->members.setpoint[i];
        s->error[i] = num_sub(io->members.setpoint[i], io->members.in[i]);
        s->y[i] = io->inputs.value[i];
    }
}

static void state_feedback_follow(void *state, struct block_io *io)
{
    struct state_feedback *s = state;
    take_signals(s, io);
    memcpy(s->out, io->members.out, sizeof s->out);
    s->acting = io->members.acting;
    s->is_short = false;
    s->together = io->members.acting == BOTH;
    meet_outputs(s);
}

/* The acting loops have changed, or outputs now come out short: the law goes on from the outputs that are there. */
static void regroup(struct state_feedback *s, uint8_t acting)
{
    bool together = acting == BOTH && !s->is_short;
    if (acting == s->acting && together == s->together)
        return;
    s->acting = acting;
    s->together = together;
    meet_outputs(s);
}

static void state_feedback_step(void *state, struct block_io *io)
{
    struct state_feedback *s = state;
    num_t v[2];
    regroup(s, io->members.acting);
    take_signals(s, io);
    for (unsigned i = 0; i < 2; i++)
        v[i] = num_add(proportional(s, i), accumulator_get(&s->q[i]));
    for (unsigned i = 0; i < 2; i++) {
        if (!(io->members.acting & (1u << i)))
            s->out[i] = io->members.out[i]; /* where somebody else has put it */
        else if (s->together)
            s->out[i] = io->members.out[i] = num_from_wide(num_wide_add(
                num_wide_add(num_wide_zero(), s->inverse[i][0], v[0]), s->inverse[i][1], v[1]));
        else
            s->out[i] = io->members.out[i] = num_mul(s->alone[i], v[i]);
    }
}

/* Would the error move output i further in a direction it may not go? */
static bool is_clamped(const struct state_feedback *s, unsigned i, uint8_t clamp)
{
    bool up = num_lt(num_zero(), num_mul(s->alone[i], s->error[i]));
    return clamp & (up ? INTEGRAL_CLAMP_UP : INTEGRAL_CLAMP_DOWN);
}

static void state_feedback_back_calculate(void *state, struct block_io *io)
{
    struct state_feedback *s = state;
    num_t short_of[2];
    s->is_short = false;
    for (unsigned i = 0; i < 2; i++) {
        short_of[i] = num_sub(io->members.out[i], s->out[i]);
        s->is_short = s->is_short || io->members.clamp[i] != INTEGRAL_FREE ||
                      num_lt(num_from_float(SHORT_FROM), num_abs(short_of[i]));
    }
    for (unsigned i = 0; i < 2; i++) {
        accumulator_add(&s->q[i], towards(s, i, short_of));
        if ((io->members.acting & (1u << i)) && !is_clamped(s, i, io->members.clamp[i]))
            accumulator_add_product(&s->q[i], s->c[i], s->error[i]);
        s->out[i] = io->members.out[i];
    }
}

static const char *state_feedback_describe(const void *state, size_t i, float *value)
{
    const struct state_feedback *s = state;
    const struct {
        const char *name;
        float value;
    } inner[] = {
        {"error_1", num_to_float(s->error[0])},
        {"error_2", num_to_float(s->error[1])},
        {"integral_1", num_to_float(accumulator_get(&s->q[0]))},
        {"integral_2", num_to_float(accumulator_get(&s->q[1]))},
        {"together", s->together},
    };
    if (i >= sizeof inner / sizeof inner[0])
        return NULL;
    *value = inner[i].value;
    return inner[i].name;
}

const struct block_kind state_feedback_kind = {
    .name = "state_feedback",
    .stage = STAGE_CONTROL,
    .parameter = state_feedback_parameters,
    .parameters = sizeof state_feedback_parameters / sizeof state_feedback_parameters[0],
    .settings_bytes = sizeof(struct state_feedback_settings),
    .members_most = 2,
    .inputs_most = 2,
    .bad_input = BAD_INPUT_GIVES_UP,
    .bytes = state_feedback_bytes,
    .check = state_feedback_check,
    .configure = state_feedback_configure,
    .step = state_feedback_step,
    .back_calculate = state_feedback_back_calculate,
    .follow = state_feedback_follow,
    .describe = state_feedback_describe,
};
