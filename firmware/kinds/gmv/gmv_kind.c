/* Kind `gmv`: what the tick calls. The law and its data: gmv.h; who computes and who learns: gmv_supervise.h.
 *
 * The output is what was told last and the change against what was applied last, so that feedforward, a hand, or a limit is no
 * error of the model, and whoever computes begins where the other has ended. */
#include "kinds/gmv/gmv_kind.h"

#include <string.h>

#include "base/channel.h"
#include "kinds/gmv/gmv_block.h"
#include "num/real.h"

/* Steps after which the result of a trial is taken. */
#define TRIAL_STEPS 20u
/* A PV among the inputs that is further from that of the loop is another measurement. */
#define SAME_PV 1e-4f
/* An output that is nearer to what was told is where it was left. */
#define SAME_OUTPUT 1e-5f

enum gmv_event {
    EVENT_ADOPTED,
    EVENT_REFUSED,
    EVENT_FROZEN,
    EVENT_SIGN,
    EVENT_POLES,
    EVENT_WORSE,
    EVENT_BURST,
    EVENT_SINGULAR,
    EVENT_RECORD,
    GMV_EVENTS
};

static const struct block_event gmv_events[GMV_EVENTS] = {
    [EVENT_ADOPTED] = {"adopted", BLOCK_INFO,
                       "the law computes, what is upset shrinks per step by"},
    [EVENT_REFUSED] = {"refused", BLOCK_INFO,
                       "a model was not adopted; 1 prediction, 2 gain, 3 poles, 4 by hand, 5 PI"},
    [EVENT_FROZEN] = {"frozen", BLOCK_INFO,
                      "nothing is learnt; 1 asked, 2 quiet, 3 still, 4 reading, 5 manual"},
    [EVENT_SIGN] = {"sign", BLOCK_ALARM, "the PI acts: wrong sign or size of g0, span per span"},
    [EVENT_POLES] = {"poles", BLOCK_ALARM, "the PI acts: the loop would grow per step by"},
    [EVENT_WORSE] = {"worse", BLOCK_ALARM,
                     "the PI acts: predictions fail, or an MV is stuck the wrong way; spans"},
    [EVENT_BURST] = {"burst", BLOCK_ALARM, "the PI acts: the MV or the PV swings, spans r.m.s."},
    [EVENT_SINGULAR] = {"singular", BLOCK_INFO, "loops solved one by one, of"},
    [EVENT_RECORD] = {"pi_wins", BLOCK_ALARM,
                      "the PI acts: it did better; the law's moves or errors, times its own"},
};

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

static enum err configure_pi(struct gmv_block *s, const struct block_setup *setup, unsigned i,
                             bool retune)
{
    const struct gmv_settings *from = setup->settings;
    struct pid_config c = pid_default_config();
    c.gain = real_abs(from->tune_gain[i]);
    c.action = from->tune_gain[i] < 0 ? PID_DIRECT : PID_REVERSE;
    c.ti_s = from->tune_ti_s[i];
    c.out_lo = -PID_OUTPUT_MAX; /* the loop's own limits are behind it */
    c.out_hi = PID_OUTPUT_MAX;
    return retune ? pid_retune(&s->pi[i], &c, setup->interval_s)
                  : pid_init(&s->pi[i], &c, setup->interval_s);
}

static void take_block_settings(struct gmv_block *s, const struct block_setup *setup,
                                const struct gmv_config *c)
{
    const struct gmv_settings *from = setup->settings;
    s->loops = c->shape.loops;
    s->disturbances = c->shape.disturbances;
    s->relative = from->weight == GMV_WORD_RELATIVE;
    s->margin = from->margin;
    s->detune = s->relative ? from->detune : 1;
    s->excite = from->excite;
    s->speed = num_from_float(from->speed);
    s->gain_least = num_from_float(from->gain_least);
    memcpy(s->lambda, c->lambda, sizeof s->lambda);
    memcpy(s->start, c->theta, sizeof s->start);
    for (unsigned i = 0; i < s->loops; i++)
        s->trial_pi[i] = (struct gmv_trial_pi){
            .gain = from->tune_gain[i],
            .integral = from->tune_ti_s[i] > 0
                            ? from->tune_gain[i] * setup->interval_s / from->tune_ti_s[i]
                            : 0};
}

static enum err gmv_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct gmv_block *s = state;
    struct gmv_config c;
    struct gmv_supervise_config watch;
    gmv_config_of(setup, &c);
    gmv_supervise_config_of(setup, &watch);
    if (!retune)
        memset(s, 0, sizeof *s);
    take_block_settings(s, setup, &c);
    for (unsigned i = 0; i < s->loops; i++) {
        enum err err = configure_pi(s, setup, i, retune);
        if (err)
            return err;
    }
    if (retune && memcmp(&gmv_of(s)->shape, &c.shape, sizeof c.shape) == 0) {
        gmv_retune(gmv_of(s), &c);
        gmv_supervise_retune(&s->watch, &watch);
        return ERR_OK;
    }
    gmv_init(gmv_of(s), &c);
    gmv_supervise_init(&s->watch, &watch);
    gmv_forget_limits(s);
    s->begun = s->proposes = s->on_trial = s->trial_wanted = false;
    s->times = 1;
    return ERR_OK;
}

void gmv_start_again(struct gmv_block *s)
{
    struct gmv *g = gmv_of(s);
    num_t theta[GMV_PARAMETERS];
    for (unsigned i = 0; i < s->loops; i++) {
        for (unsigned p = 0; p < GMV_PARAMETERS; p++) {
            theta[p] = num_from_float(s->start[i][p]);
            gmv_use(g, i, p, theta[p]);
        }
        rls_set(gmv_rls_of(g, i), theta);
        rls_reset(gmv_rls_of(g, i));
    }
}

/* ---- steps ---- */

static void take_signals(struct gmv_block *s, const struct block_io *io)
{
    s->acting = io->acting;
    for (unsigned i = 0; i < s->loops; i++) {
        s->in[i] = io->in[i];
        s->setpoint[i] = io->setpoint[i];
    }
}

static void follow_with_pi(struct gmv_block *s, unsigned i, num_t out)
{
    s->told[i] = out;
    pid_follow(&s->pi[i], s->setpoint[i], s->in[i], out);
}

static bool is_near(num_t a, num_t b)
{
    return num_lt(num_abs(num_sub(a, b)), num_from_float(SAME_OUTPUT));
}

/* A member goes on as it was when another one comes, or returns: the output is where it was left, or what
 * was asked of it and a limit cut short. */
static bool goes_on(const struct gmv_block *s, const struct block_io *io)
{
    for (unsigned i = 0; i < s->loops; i++)
        if ((s->acting & io->acting & (1u << i)) &&
            (is_near(io->out[i], s->told[i]) || is_near(io->out[i], s->given[i])))
            return true;
    return false;
}

static void gmv_follow(void *state, struct block_io *io)
{
    struct gmv_block *s = state;
    bool anew = !goes_on(s, io);
    take_signals(s, io);
    for (unsigned i = 0; i < s->loops; i++)
        follow_with_pi(s, i, io->out[i]);
    if (!anew)
        return;
    gmv_supervise_begin(&s->watch);
    s->begun = s->proposes = s->has_asked = s->on_trial = s->trial_wanted = false;
}

/* Why it cannot go on, in a word, or NULL. */
static const char *lacks(const struct gmv_block *s, const struct block_io *io)
{
    for (unsigned i = 0; i < s->loops; i++) {
        if (!io->member_applied[i])
            return "no_MV";
        if (io->quality[i] == QUALITY_GOOD && (io->acting & (1u << i)) &&
            num_lt(num_from_float(SAME_PV), num_abs(num_sub(io->in[i], io->input[i]))))
            return "not_the_PV";
    }
    for (unsigned m = 0; m < s->disturbances; m++)
        if (!quality_usable((enum quality)io->quality[s->loops + m]))
            return "no_input";
    return NULL;
}

static void take_sample(struct gmv_block *s, const struct block_io *io, struct gmv_sample *sample)
{
    memset(sample, 0, sizeof *sample);
    sample->divisor = io->divisor;
    for (unsigned i = 0; i < s->loops; i++) {
        sample->y[i] = io->in[i];
        sample->w[i] = io->setpoint[i];
        sample->applied[i] = io->member_applied[i];
    }
    for (unsigned m = 0; m < s->disturbances; m++)
        sample->disturbance[m] = io->input[s->loops + m];
}

static struct gmv_seen seen_of(const struct gmv_block *s, const struct block_io *io,
                               const struct gmv_sample *sample)
{
    struct gmv_seen seen = {.acting = io->acting};
    bool good = true;
    for (unsigned m = 0; m < s->disturbances; m++)
        good = good && io->quality[s->loops + m] == QUALITY_GOOD;
    for (unsigned i = 0; i < s->loops; i++) {
        if (good && io->quality[i] == QUALITY_GOOD)
            seen.good = (uint8_t)(seen.good | (1u << i));
        seen.setpoint[i] = num_to_float(io->setpoint[i]);
        seen.away[i] = num_to_float(num_sub(io->setpoint[i], io->in[i]));
        seen.moved[i] = num_to_float(num_sub(gmv_applied(sample, i, 1), gmv_applied(sample, i, 2)));
        if (s->has_asked)
            seen.lacked[i] = num_to_float(num_sub(s->asked[i], gmv_applied(sample, i, 1)));
    }
    return seen;
}

static float estimated_gain(const struct gmv *g, unsigned i)
{
    return num_to_float(rls_theta(gmv_rls(g, i), (unsigned)gmv_place_of_u(&g->shape, i, i)));
}

/* Whether g_ii,0 differs from 0 by so many deviations, and what multiplies the PV is as far within 1. Of other MVs and of older
 * moves the law needs to know less: the test of predictions and the trial look at what they come to. */
static bool is_excited(const struct gmv_block *s, unsigned i)
{
    const struct gmv *g = gmv_of_const(s);
    const struct rls *r = gmv_rls(g, i);
    float sd = rls_error_sd(r) * s->excite;
    unsigned own = (unsigned)gmv_place_of_u(&g->shape, i, i);
    float gain = real_abs(num_to_float(rls_theta(r, own)));
    for (unsigned p = 0; p <= own; p++)
        if (!(sd * real_sqrt(rls_covariance(r, p, p)) <= (p < own ? 1 : gain)))
            return false;
    return gain > 0;
}

static struct gmv_came came_of(struct gmv_block *s, uint8_t whole, const struct block_io *io)
{
    const struct gmv *g = gmv_of_const(s);
    struct gmv_came came = {.whole = whole};
    bool asks = s->watch.state == GMV_TUNING && !s->watch.testing &&
                s->watch.elapsed + 1u >= s->watch.config.tune_steps;
    for (unsigned i = 0; i < s->loops; i++) {
        struct gmv_predicted of = gmv_predicted(g, i);
        came.error[i] = num_to_float(num_sub(of.measured, of.used));
        came.standstill[i] = num_to_float(num_sub(of.measured, of.standstill));
        came.told[i] = rls_told(gmv_rls(g, i));
        came.forgot[i] = rls_forgot(gmv_rls(g, i));
        came.parameters[i] = (uint8_t)gmv_parameters(&g->shape, i);
        came.gain[i] = gmv_own_gain(g, i);
        came.estimated[i] = estimated_gain(g, i);
        if (asks && is_excited(s, i))
            came.excited = (uint8_t)(came.excited | (1u << i));
    }
    came.tried = s->on_trial && io->work_done;
    if (came.tried) {
        came.outcome = s->search.best;
        s->times = came.outcome.times;
        s->on_trial = false;
    }
    return came;
}

/* The parameters in use are those estimated, or come nearer to them. */
static void use_estimates(struct gmv_block *s, uint8_t learn, bool at_once)
{
    struct gmv *g = gmv_of(s);
    for (unsigned i = 0; i < s->loops; i++) {
        bool follows =
            (learn & (1u << i)) && gmv_supervise_gain(&s->watch, i, estimated_gain(g, i));
        for (unsigned p = 0; p < gmv_parameters(&g->shape, i) && (at_once || follows); p++) {
            num_t used = gmv_used(g, i, p), wanted = rls_theta(gmv_rls(g, i), p);
            num_t most = num_mul(s->speed, num_max(num_abs(used), s->gain_least));
            num_t move = num_clamp(num_sub(wanted, used), num_neg(most), most);
            gmv_use(g, i, p, at_once ? wanted : num_add(used, move));
        }
    }
}

/* While tuning it finds its lambda anew; a law that acts is tried as it is, and so is one without lambda. */
static void begin_law_trial(struct gmv_block *s, uint8_t acting)
{
    bool searches = s->watch.state == GMV_TUNING;
    if (searches)
        s->times = 1;
    gmv_set_weights(s);
    searches = searches && (s->lambda[0] > 0 || s->lambda[1] > 0);
    gmv_detune_begin(&s->search, s->times, searches ? s->detune : s->times, s->watch.config.better,
                     s->watch.record);
    gmv_trial_take(&s->trial, gmv_of_const(s), acting, s->margin, s->trial_pi);
}

/* While a trial of something else is still under way, that one is waited for and not looked at. */
static void ask_for_trial(struct gmv_block *s, struct block_io *io, bool wanted)
{
    if (wanted) {
        s->trial_wanted = true;
        s->on_trial = false;
    }
    if (!s->trial_wanted || io->work_wanted)
        return;
    begin_law_trial(s, io->acting);
    io->ask_work = TRIAL_STEPS;
    s->on_trial = true;
    s->trial_wanted = false;
}

static void begin_pi(struct gmv_block *s)
{
    for (unsigned i = 0; i < s->loops; i++)
        follow_with_pi(s, i, s->told[i]);
}

/* What supervision wishes. */
static void grant(struct gmv_block *s, struct block_io *io, uint8_t wish)
{
    if (wish & GMV_WISH_CANDIDATE)
        use_estimates(s, 0, true);
    gmv_set_weights(s);
    ask_for_trial(s, io, wish & GMV_WISH_TRIAL);
    if (wish & GMV_WISH_PROPOSE)
        gmv_propose(s);
    if (wish & GMV_WISH_LAW)
        gmv_begin_law(s);
    if (wish & GMV_WISH_PI) {
        s->proposes = false;
        begin_pi(s);
    }
    if (wish & GMV_WISH_FORGET)
        gmv_start_again(s);
    if (wish & GMV_WISH_GIVE_UP)
        io->gives_up = "too_often";
}

/* Whoever computes. */
static void compute(struct gmv_block *s, const struct gmv_sample *sample, struct block_io *io)
{
    if (s->watch.state == GMV_SELF_TUNING) {
        if (!gmv_step_law(s, sample, io))
            io->gives_up = "not_a_number";
        return;
    }
    for (unsigned i = 0; i < s->loops; i++)
        if (io->acting & (1u << i))
            io->out[i] = pid_step(&s->pi[i], s->setpoint[i], s->in[i]);
}

static float value_of_event(const struct gmv_block *s, enum gmv_event event, uint8_t rest)
{
    switch (event) {
    case EVENT_ADOPTED:
        return s->watch.outcome.decay;
    case EVENT_REFUSED:
        return s->watch.refusal;
    case EVENT_FROZEN:
        return rest;
    case EVENT_SINGULAR:
        return s->loops;
    default:
        return s->watch.alarm_value;
    }
}

static void tell(const struct gmv_block *s, struct block_io *io, uint8_t wish)
{
    uint8_t rest = GMV_LEARNS;
    bool law = s->watch.state == GMV_SELF_TUNING, learns = false;
    unsigned raised = 0;
    for (unsigned i = 0; i < s->loops; i++) {
        learns = learns || s->watch.rest[i] == GMV_LEARNS;
        if ((io->acting & (1u << i)) && s->watch.rest[i] > rest)
            rest = s->watch.rest[i];
    }
    raised |= law ? 1u << EVENT_ADOPTED : 0;
    raised |= !learns ? 1u << EVENT_FROZEN : 0;
    raised |= wish & GMV_WISH_REFUSED ? 1u << EVENT_REFUSED : 0;
    raised |= law && s->singular ? 1u << EVENT_SINGULAR : 0;
    raised |= (s->watch.alarms & (GMV_ALARM_RECORD - 1u)) << EVENT_SIGN;
    raised |= s->watch.alarms & GMV_ALARM_RECORD ? 1u << EVENT_RECORD : 0;
    io->raised = (uint16_t)raised;
    for (unsigned k = 0; k < GMV_EVENTS; k++)
        io->event_value[k] = value_of_event(s, (enum gmv_event)k, rest);
}

static void gmv_step(void *state, struct block_io *io)
{
    struct gmv_block *s = state;
    struct gmv *g = gmv_of(s);
    struct gmv_sample sample;
    take_signals(s, io);
    io->gives_up = lacks(s, io);
    if (io->gives_up) {
        s->acting = 0; /* nothing goes on from here */
        return;
    }
    take_sample(s, io, &sample);
    if (!s->begun)
        gmv_begin(g);
    s->begun = true;
    for (unsigned i = 0; i < s->loops; i++)
        if (!(io->acting & (1u << i)))
            follow_with_pi(s, i, io->out[i]);
    gmv_learn_limits(s, &sample);
    gmv_take(g, &sample);
    struct gmv_seen seen = seen_of(s, io, &sample);
    uint8_t learn = gmv_supervise_look(&s->watch, &seen);
    uint8_t whole = gmv_learn(g, &sample, learn);
    if (s->watch.state == GMV_SELF_TUNING)
        use_estimates(s, learn, !s->watch.config.on);
    struct gmv_came came = came_of(s, whole, io);
    uint8_t wish = gmv_supervise_judge(&s->watch, &seen, &came);
    wish = (uint8_t)(wish | gmv_proposals_step(s, io->proposal));
    grant(s, io, wish);
    io->withdraws = !s->proposes;
    if (!io->gives_up)
        compute(s, &sample, io);
    if (io->gives_up)
        s->acting = 0;
    memcpy(s->given, io->out, s->loops * sizeof s->given[0]);
    tell(s, io, wish);
}

static void gmv_back_calculate(void *state, struct block_io *io)
{
    struct gmv_block *s = state;
    for (unsigned i = 0; i < s->loops; i++) {
        if (!(io->acting & (1u << i)))
            continue;
        if (s->watch.state == GMV_SELF_TUNING) {
            follow_with_pi(s, i, io->out[i]);
        } else {
            s->told[i] = io->out[i];
            pid_back_calculate(&s->pi[i], io->out[i], io->clamp[i]);
        }
    }
}

static bool gmv_work(void *state)
{
    struct gmv_block *s = state;
    return gmv_detune_piece(&s->search, &s->trial);
}

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
    .event = gmv_events,
    .events = GMV_EVENTS,
    .bytes = gmv_block_bytes,
    .check = gmv_settings_check,
    .configure = gmv_configure,
    .step = gmv_step,
    .back_calculate = gmv_back_calculate,
    .follow = gmv_follow,
    .describe = gmv_describe,
};
