/* Kind `gmv`: composes its parts, and answers the calls of the tick. The law and its samples: gmv.h; who computes and who learns:
 * gmv_supervise.h.
 *
 * The output is the last one applied plus the change against the applied MV, so that feedforward, a manual change, or a limit is no
 * error of the model, and each controller starts from the last output of the one before. */
#include "kinds/gmv/gmv_kind.h"

#include <string.h>

#include "base/assertion.h"
#include "base/channel.h"
#include "kinds/gmv/gmv_events.h"
#include "kinds/gmv/gmv_kind_state.h"
#include "kinds/gmv/gmv_samples.h"
#include "kinds/gmv/gmv_settings.h"
#include "kinds/gmv/gmv_values.h"

/* A PV among the inputs that differs by more from that of the loop is another measurement. */
#define SAME_PV 1e-4f

static enum gmv_state supervision_state(const struct gmv_block *s)
{
    return (enum gmv_state)gmv_supervise_status(&s->watch)->state;
}

/* ---- settings ---- */

static uint32_t gmv_block_bytes(const struct block_setup *setup)
{
    struct gmv_config c;
    gmv_config_of(setup, &c);
    return (uint32_t)((sizeof(struct gmv_block) + 7u) & ~(size_t)7u) + gmv_bytes(&c.shape);
}

static uint16_t gmv_block_history(const struct block_setup *setup)
{
    struct gmv_config c;
    gmv_config_of(setup, &c);
    return (uint16_t)gmv_history(&c.shape);
}

static void take_block_settings(struct gmv_block *s, const struct block_setup *setup,
                                const struct gmv_config *c)
{
    const struct gmv_settings *from = setup->settings;
    s->loops = c->shape.loops;
    s->disturbances = c->shape.disturbances;
    s->excite = from->excite;
    s->speed = num_from_float(from->speed);
    s->gain_least = num_from_float(from->gain_least);
    gmv_lambda_configure(&s->lambda, setup, c);
    gmv_proposals_configure(&s->proposals, c->theta);
}

static enum err gmv_configure(void *state, const struct block_setup *setup, bool retune)
{
    REFLUX_ASSERT(setup->members <= GMV_LOOPS);
    struct gmv_block *s = state;
    struct gmv_config c;
    struct gmv_supervise_config watch;
    gmv_config_of(setup, &c);
    gmv_supervise_config_of(setup, &watch);
    if (!retune)
        memset(s, 0, sizeof *s);
    take_block_settings(s, setup, &c);
    for (unsigned i = 0; i < s->loops; i++) {
        enum err err = gmv_shadow_configure(&s->shadow, setup, i, retune);
        if (err)
            return err;
    }
    if (retune && memcmp(gmv_shape(gmv_of(s)), &c.shape, sizeof c.shape) == 0) {
        gmv_retune(gmv_of(s), &c);
        gmv_supervise_retune(&s->watch, &watch);
        return ERR_OK;
    }
    gmv_init(gmv_of(s), &c);
    gmv_supervise_init(&s->watch, &watch);
    gmv_moves_init(&s->moves);
    gmv_proposals_withdraw(&s->proposals);
    gmv_lambda_reset(&s->lambda);
    s->begun = false;
    return ERR_OK;
}

/* ---- steps ---- */

static void take_signals(struct gmv_block *s, const struct block_io *io)
{
    s->acting = io->members.acting;
    gmv_shadow_take(&s->shadow, io, s->loops);
}

static void follow_with_pi(struct gmv_block *s, unsigned i, num_t out)
{
    gmv_moves_keep_applied(&s->moves, i, out);
    gmv_shadow_follow(&s->shadow, i, out);
}

/* A member goes on when another one comes or returns: its output is where it was left, or the one that a limit cut short. */
static bool goes_on(const struct gmv_block *s, const struct block_io *io)
{
    for (unsigned i = 0; i < s->loops; i++)
        if ((s->acting & io->members.acting & (1u << i)) &&
            gmv_moves_continue(&s->moves, i, io->members.out[i]))
            return true;
    return false;
}

static void gmv_follow(void *state, struct block_io *io)
{
    struct gmv_block *s = state;
    bool anew = !goes_on(s, io);
    take_signals(s, io);
    for (unsigned i = 0; i < s->loops; i++)
        follow_with_pi(s, i, io->members.out[i]);
    if (!anew)
        return;
    gmv_supervise_begin(&s->watch);
    gmv_proposals_withdraw(&s->proposals);
    gmv_moves_break_off(&s->moves);
    gmv_lambda_cancel(&s->lambda);
    s->begun = false;
}

/* Returns why it cannot go on, in a word, or NULL. */
static const char *lacks(const struct gmv_block *s, const struct block_io *io)
{
    for (unsigned i = 0; i < s->loops; i++) {
        if (!io->members.applied[i])
            return "no_MV";
        if (io->inputs.quality[i] == QUALITY_GOOD && (io->members.acting & (1u << i)) &&
            num_lt(num_from_float(SAME_PV),
                   num_abs(num_sub(io->members.in[i], io->inputs.value[i]))))
            return "not_the_PV";
    }
    for (unsigned m = 0; m < s->disturbances; m++)
        if (!quality_usable((enum quality)io->inputs.quality[s->loops + m]))
            return "no_input";
    return NULL;
}

static void take_sample(struct gmv_block *s, const struct block_io *io, struct gmv_sample *sample)
{
    memset(sample, 0, sizeof *sample);
    sample->divisor = io->members.divisor;
    for (unsigned i = 0; i < s->loops; i++) {
        sample->y[i] = io->members.in[i];
        sample->w[i] = io->members.setpoint[i];
        sample->applied[i] = io->members.applied[i];
    }
    for (unsigned m = 0; m < s->disturbances; m++)
        sample->disturbance[m] = io->inputs.value[s->loops + m];
}

static struct gmv_observation seen_of(const struct gmv_block *s, const struct block_io *io,
                                      const struct gmv_sample *sample)
{
    struct gmv_observation seen = {.acting = io->members.acting};
    bool good = true;
    for (unsigned m = 0; m < s->disturbances; m++)
        good = good && io->inputs.quality[s->loops + m] == QUALITY_GOOD;
    for (unsigned i = 0; i < s->loops; i++) {
        if (good && io->inputs.quality[i] == QUALITY_GOOD)
            seen.good = (uint8_t)(seen.good | (1u << i));
        seen.setpoint[i] = num_to_float(io->members.setpoint[i]);
        seen.control_error[i] = num_to_float(num_sub(io->members.setpoint[i], io->members.in[i]));
        seen.move[i] = num_to_float(num_sub(gmv_applied(sample, i, 1), gmv_applied(sample, i, 2)));
        seen.shortfall[i] = gmv_moves_lacked(&s->moves, sample, i);
    }
    return seen;
}

static struct gmv_result result_of(struct gmv_block *s, uint8_t whole, const struct block_io *io)
{
    const struct gmv *g = gmv_of_const(s);
    struct gmv_result result = {.complete = whole};
    bool asks = gmv_supervise_needs_excitation(&s->watch);
    for (unsigned i = 0; i < s->loops; i++) {
        struct gmv_predicted predicted = gmv_predicted(g, i);
        const struct rls *r = gmv_rls(g, i);
        result.error[i] = num_to_float(num_sub(predicted.measured, predicted.used));
        result.standstill[i] = num_to_float(num_sub(predicted.measured, predicted.standstill));
        result.information[i] = rls_told(r);
        result.forgetting[i] = rls_forgot(r);
        result.parameters[i] = (uint8_t)gmv_parameters(gmv_shape(g), i);
        result.gain[i] = gmv_own_gain(g, i);
        result.estimated[i] = gmv_estimated_gain(g, i);
        if (asks && gmv_is_excited(g, i, s->excite))
            result.excited = (uint8_t)(result.excited | (1u << i));
    }
    result.trial_done = gmv_lambda_take(&s->lambda, io, &result.outcome);
    return result;
}

/* Puts the estimated parameters in use, or moves those in use towards them. */
static void use_estimates(struct gmv_block *s, uint8_t learn, bool at_once)
{
    struct gmv *g = gmv_of(s);
    for (unsigned i = 0; i < s->loops; i++)
        if (at_once)
            gmv_use_estimates(g, i);
        else if ((learn & (1u << i)) &&
                 gmv_gain_allowed(gmv_supervise_settings(&s->watch), i, gmv_estimated_gain(g, i)))
            gmv_approach_estimates(g, i, s->speed, s->gain_least);
}

static void begin_pi(struct gmv_block *s)
{
    for (unsigned i = 0; i < s->loops; i++)
        follow_with_pi(s, i, gmv_moves_applied(&s->moves, i));
}

/* Does as supervision wishes. */
static void grant(struct gmv_block *s, struct block_io *io, uint8_t wish)
{
    struct gmv *g = gmv_of(s);
    if (wish & GMV_WISH_CANDIDATE)
        use_estimates(s, 0, true);
    gmv_lambda_apply(&s->lambda, g);
    gmv_lambda_ask(&s->lambda, g, io, wish & GMV_WISH_TRIAL, supervision_state(s) == GMV_TUNING,
                   gmv_supervise_settings(&s->watch)->better, gmv_supervise_records(&s->watch));
    if (wish & GMV_WISH_PROPOSE)
        gmv_proposals_begin(&s->proposals, g);
    if (wish & GMV_WISH_LAW)
        gmv_moves_begin_law(&s->moves);
    if (wish & GMV_WISH_PI) {
        gmv_proposals_withdraw(&s->proposals);
        begin_pi(s);
    }
    if (wish & GMV_WISH_FORGET)
        gmv_proposals_restore(&s->proposals, g);
    if (wish & GMV_WISH_GIVE_UP)
        io->requests.gives_up = "too_often";
}

/* The law or the PIs give the outputs. */
static void compute(struct gmv_block *s, const struct gmv_sample *sample, struct block_io *io)
{
    if (supervision_state(s) == GMV_SELF_TUNING) {
        if (!gmv_moves_step_law(&s->moves, gmv_of(s), sample, io))
            io->requests.gives_up = "not_a_number";
        return;
    }
    for (unsigned i = 0; i < s->loops; i++)
        if (io->members.acting & (1u << i))
            io->members.out[i] = gmv_shadow_step(&s->shadow, i);
}

/* Asks for the settings of an open proposal, and tells supervision the answer. Returns enum gmv_wish. */
static uint8_t offer_settings(struct gmv_block *s, struct block_io *io)
{
    enum gmv_answer answer =
        gmv_proposals_step(&s->proposals, gmv_of_const(s), io->requests.proposal,
                           gmv_supervise_settings(&s->watch)->ask);
    return answer == GMV_NO_ANSWER ? 0 : gmv_supervise_accepted(&s->watch, answer == GMV_ACCEPTED);
}

static void gmv_step(void *state, struct block_io *io)
{
    struct gmv_block *s = state;
    struct gmv *g = gmv_of(s);
    struct gmv_sample sample;
    take_signals(s, io);
    io->requests.gives_up = lacks(s, io);
    if (io->requests.gives_up) {
        s->acting = 0; /* no member continues from here */
        return;
    }
    take_sample(s, io, &sample);
    if (!s->begun)
        gmv_begin(g);
    s->begun = true;
    for (unsigned i = 0; i < s->loops; i++)
        if (!(io->members.acting & (1u << i)))
            follow_with_pi(s, i, io->members.out[i]);
    gmv_moves_learn_limits(&s->moves, &sample, s->loops);
    gmv_take(g, &sample);
    struct gmv_observation seen = seen_of(s, io, &sample);
    uint8_t learn = gmv_supervise_look(&s->watch, &seen);
    uint8_t whole = gmv_learn(g, &sample, learn);
    if (supervision_state(s) == GMV_SELF_TUNING)
        use_estimates(s, learn, !gmv_supervise_settings(&s->watch)->on);
    struct gmv_result result = result_of(s, whole, io);
    uint8_t wish = gmv_supervise_judge(&s->watch, &seen, &result);
    wish = (uint8_t)(wish | offer_settings(s, io));
    grant(s, io, wish);
    io->requests.withdraws = !gmv_proposals_open(&s->proposals);
    if (!io->requests.gives_up)
        compute(s, &sample, io);
    if (io->requests.gives_up)
        s->acting = 0;
    gmv_moves_keep_given(&s->moves, io->members.out, s->loops);
    gmv_events_raise(gmv_supervise_status(&s->watch), io, s->loops, wish,
                     gmv_moves_singular(&s->moves));
}

static void gmv_back_calculate(void *state, struct block_io *io)
{
    struct gmv_block *s = state;
    for (unsigned i = 0; i < s->loops; i++) {
        if (!(io->members.acting & (1u << i)))
            continue;
        if (supervision_state(s) == GMV_SELF_TUNING) {
            follow_with_pi(s, i, io->members.out[i]);
        } else {
            gmv_moves_keep_applied(&s->moves, i, io->members.out[i]);
            gmv_shadow_back_calculate(&s->shadow, i, io->members.out[i], io->members.clamp[i]);
        }
    }
}

static bool gmv_work(void *state)
{
    struct gmv_block *s = state;
    return gmv_lambda_work(&s->lambda);
}

static const char *gmv_describe(const void *state, size_t i, float *value)
{
    const struct gmv_block *s = state;
    const struct gmv_view view = {.gmv = gmv_of_const(s),
                                  .status = gmv_supervise_status(&s->watch),
                                  .information = gmv_supervise_information(&s->watch),
                                  .stored = gmv_proposals_stored(&s->proposals),
                                  .lambda_times = gmv_lambda_times(&s->lambda)};
    return gmv_value(&view, i, value);
}

/* ---- verbs ---- */

static const char *run_freeze(void *state, const float *number)
{
    struct gmv_block *s = state;
    (void)number;
    gmv_supervise_freeze(&s->watch);
    return NULL;
}

static const char *run_thaw(void *state, const float *number)
{
    struct gmv_block *s = state;
    (void)number;
    gmv_supervise_thaw(&s->watch);
    return NULL;
}

static const char *run_tune(void *state, const float *number)
{
    struct gmv_block *s = state;
    (void)number;
    gmv_supervise_begin(&s->watch);
    gmv_proposals_withdraw(&s->proposals);
    gmv_lambda_drop(&s->lambda);
    return NULL;
}

static const char *run_reset(void *state, const float *number)
{
    struct gmv_block *s = state;
    gmv_proposals_restore(&s->proposals, gmv_of(s));
    return run_tune(state, number);
}

static const char *run_adopt(void *state, const float *number)
{
    struct gmv_block *s = state;
    const struct gmv *g = gmv_of_const(s);
    (void)number;
    if (supervision_state(s) == GMV_SELF_TUNING)
        return "adopted already";
    for (unsigned i = 0; i < s->loops; i++)
        if ((s->acting & (1u << i)) &&
            !gmv_gain_allowed(gmv_supervise_settings(&s->watch), i, gmv_estimated_gain(g, i)))
            return "sign or size of a gain";
    gmv_supervise_adopt(&s->watch);
    return NULL;
}

#define GMV_VERBS 5
static const struct block_verb gmv_verb_rows[GMV_VERBS] = {
    {"freeze", NULL, "stop learning until `thaw`", 0, 0, false, ACCESS_OPERATOR, run_freeze},
    {"thaw", NULL, "learn again", 0, 0, false, ACCESS_OPERATOR, run_thaw},
    {"tune", NULL, "back to the PI; test a model anew", 0, 0, false, ACCESS_OPERATOR, run_tune},
    {"reset", NULL, "the same, from the start values", 0, 0, false, ACCESS_ENGINEER, run_reset},
    {"adopt", NULL, "adopt the estimated law, untested", 0, 0, false, ACCESS_ENGINEER, run_adopt},
};

const struct block_kind gmv_kind = {
    .name = "gmv",
    .stage = STAGE_CONTROL,
    .parameter = gmv_parameter_rows,
    .parameters = GMV_PARAMETER_ROWS,
    .settings_bytes = sizeof(struct gmv_settings),
    .members_most = GMV_LOOPS,
    .inputs_most = GMV_LOOPS + GMV_DISTURBANCES,
    .bad_input = BAD_INPUT_IS_TOLD,
    .history = gmv_block_history,
    .work = gmv_work,
    .verb = gmv_verb_rows,
    .verbs = GMV_VERBS,
    .event = gmv_event_rows,
    .events = GMV_EVENTS,
    .bytes = gmv_block_bytes,
    .check = gmv_settings_check,
    .configure = gmv_configure,
    .step = gmv_step,
    .back_calculate = gmv_back_calculate,
    .follow = gmv_follow,
    .describe = gmv_describe,
};
