/* Kind `inferential`: the loops of a block. The law: inferential.h. */
#include <string.h>

#include "base/assertion.h"
#include "base/channel.h"
#include "kinds/inferential/inferential.h"
#include "kinds/inferential/inferential_parameters.h"
#include "kinds/inferential/inferential_state.h"
#include "kinds/inferential/inferential_values.h"
#include "num/real.h"

/* So many equal readings in a row of two temperatures are one thermometer; equal: within this part of the span. */
#define EQUAL_STEPS 20u
#define EQUAL       1e-5f
/* So many consecutive steps without the secondary raise the event; a single missing reading does not. */
#define ALONE_STEPS 10u

struct inferential_block {
    uint8_t loops, seconds;            /* secondary temperatures among the inputs, the first ones */
    uint8_t second[INFERENTIAL_LOOPS]; /* which of them, INFERENTIAL_NONE: none */
    uint8_t acted;                     /* bit k: loop k acted in the last step */
    uint8_t alone[INFERENTIAL_LOOPS];  /* steps in a row without the secondary that its law has */
    uint8_t equal[INFERENTIAL_LOOPS];  /* steps in a row in which both temperatures were equal */
    uint8_t begun;                     /* bit k: loop k has followed */
    float lo[INFERENTIAL_LOOPS][2];    /* of the temperatures, EU */
    struct inferential loop[INFERENTIAL_LOOPS];
};

enum inferential_event { EVENT_NO_SECOND, EVENT_SAME, INFERENTIAL_EVENTS };

static const struct block_event inferential_events[INFERENTIAL_EVENTS] = {
    [EVENT_NO_SECOND] = {"no_2nd", BLOCK_ALARM,
                         "conventional without its secondary temperature, loop"},
    [EVENT_SAME] = {"same", BLOCK_ALARM, "both temperatures are one thermometer, loop"},
};

/* ---- settings ---- */

static uint32_t inferential_bytes(const struct block_setup *setup)
{
    (void)setup;
    return (uint32_t)((sizeof(struct inferential_block) + 7u) & ~(size_t)7u);
}

/* One step: by it a loop's own MV is known from another. */
static uint16_t inferential_history(const struct block_setup *setup)
{
    (void)setup;
    return 1;
}

static enum err inferential_configure(void *state, const struct block_setup *setup, bool retune)
{
    REFLUX_ASSERT(setup->members <= INFERENTIAL_LOOPS && setup->inputs >= setup->members);
    struct inferential_block *s = state;
    struct inferential_config c;
    if (!retune)
        memset(s, 0, sizeof *s);
    s->loops = setup->members;
    s->seconds = (uint8_t)(setup->inputs - setup->members);
    for (unsigned k = 0; k < s->loops; k++) {
        unsigned second = inferential_second(setup, k);
        bool same_second = s->second[k] == second;
        s->second[k] = (uint8_t)second;
        s->lo[k][PRIMARY] = setup->pv[k].lo;
        s->lo[k][SECONDARY] = second == INFERENTIAL_NONE ? 0 : setup->input[second].lo;
        inferential_config_of(setup, k, &c);
        if (retune && (s->begun & (1u << k)))
            inferential_retune(&s->loop[k], &c, same_second);
        else
            inferential_init(&s->loop[k], &c);
    }
    return ERR_OK;
}

/* ---- steps ---- */

static float temperature(const struct inferential_block *s, unsigned k, unsigned i, num_t value)
{
    REFLUX_ASSERT(k < s->loops);
    return s->lo[k][i] + num_to_float(value) * inferential_config(&s->loop[k])->span[i];
}

static num_t second_of(const struct inferential_block *s, unsigned k, const struct block_io *io)
{
    REFLUX_ASSERT(k < s->loops && (s->second[k] == INFERENTIAL_NONE || s->second[k] < s->seconds));
    return s->second[k] == INFERENTIAL_NONE ? num_zero() : io->inputs.value[s->second[k]];
}

/* A secondary that is held or doubtful does not count: without it the loop goes on as well, and a held value jumps when it is believed
 * again. */
static bool second_is_good(const struct inferential_block *s, unsigned k, const struct block_io *io)
{
    return s->second[k] != INFERENTIAL_NONE && io->inputs.quality[s->second[k]] == QUALITY_GOOD &&
           s->equal[k] < EQUAL_STEPS;
}

static void compare_temperatures(struct inferential_block *s, unsigned k, const struct block_io *io)
{
    float apart = temperature(s, k, PRIMARY, io->members.in[k]) -
                  temperature(s, k, SECONDARY, second_of(s, k, io));
    if (s->second[k] == INFERENTIAL_NONE ||
        !(real_abs(apart) <= EQUAL * inferential_config(&s->loop[k])->span[PRIMARY]))
        s->equal[k] = 0;
    else if (s->equal[k] < EQUAL_STEPS)
        s->equal[k]++;
}

static void follow_loop(struct inferential_block *s, unsigned k, const struct block_io *io)
{
    REFLUX_ASSERT(k < s->loops);
    inferential_follow(&s->loop[k], io->members.setpoint[k], io->members.in[k], second_of(s, k, io),
                       second_is_good(s, k, io), io->members.out[k]);
    s->begun = (uint8_t)(s->begun | (1u << k));
}

/* A loop that has acted all the time goes on when another comes or goes. */
static void inferential_block_follow(void *state, struct block_io *io)
{
    struct inferential_block *s = state;
    for (unsigned k = 0; k < s->loops; k++)
        if (!(s->acted & io->members.acting & (1u << k)) ||
            !num_eq(io->members.out[k], inferential_applied(&s->loop[k])))
            follow_loop(s, k, io);
    s->acted &= io->members.acting;
}

/* True: the MVs among the inputs are those that its loops drive. What is applied is kept once for each. */
static bool has_own_mvs(const struct inferential_block *s, const struct block_io *io)
{
    for (unsigned k = 0; k < s->loops; k++)
        if (io->members.applied[k] != io->inputs.applied[s->seconds + k])
            return false;
    return true;
}

static void tell_events(struct inferential_block *s, struct block_io *io)
{
    unsigned raised = 0;
    for (unsigned k = s->loops; k-- > 0;) {
        const struct inferential *l = &s->loop[k];
        bool same = s->equal[k] >= EQUAL_STEPS;
        if (!(io->members.acting & (1u << k)) || inferential_acts(l) == inferential_config(l)->law)
            s->alone[k] = 0;
        else if (s->alone[k] < ALONE_STEPS)
            s->alone[k]++;
        if (s->alone[k] < (same ? 1u : ALONE_STEPS))
            continue;
        unsigned event = same ? EVENT_SAME : EVENT_NO_SECOND;
        raised |= 1u << event;
        io->requests.event_value[event] = (float)(k + 1u);
    }
    io->requests.raised = (uint16_t)raised;
}

static void inferential_block_step(void *state, struct block_io *io)
{
    struct inferential_block *s = state;
    REFLUX_ASSERT(s->loops <= INFERENTIAL_LOOPS);
    if (!has_own_mvs(s, io)) {
        io->requests.gives_up = "not_the_MV";
        s->acted = 0;
        return;
    }
    for (unsigned k = 0; k < s->loops; k++) {
        compare_temperatures(s, k, io);
        if (!(io->members.acting & (1u << k)))
            follow_loop(s, k, io);
        else
            io->members.out[k] =
                inferential_step(&s->loop[k], io->members.setpoint[k], io->members.in[k],
                                 second_of(s, k, io), second_is_good(s, k, io));
    }
    s->acted = io->members.acting;
    tell_events(s, io);
}

static void inferential_block_back_calculate(void *state, struct block_io *io)
{
    struct inferential_block *s = state;
    for (unsigned k = 0; k < s->loops; k++)
        if (io->members.acting & (1u << k))
            inferential_back_calculate(&s->loop[k], io->members.out[k], io->members.clamp[k]);
}

/* ---- for the console ---- */

static const char *inferential_describe(const void *state, size_t i, float *value)
{
    const struct inferential_block *s = state;
    unsigned k = (unsigned)(i / INFERENTIAL_VALUES);
    return k < s->loops ? inferential_value(&s->loop[k], k, i % INFERENTIAL_VALUES, value) : NULL;
}

const struct block_kind inferential_kind = {
    .name = "inferential",
    .stage = STAGE_CONTROL,
    .parameter = inferential_parameter_rows,
    .parameters = INFERENTIAL_PARAMETER_ROWS,
    .settings_bytes = sizeof(struct inferential_settings),
    .members_most = INFERENTIAL_LOOPS,
    .inputs_most = 2 * INFERENTIAL_LOOPS,
    .bad_input = BAD_INPUT_IS_TOLD,
    .history = inferential_history,
    .event = inferential_events,
    .events = INFERENTIAL_EVENTS,
    .bytes = inferential_bytes,
    .check = inferential_check,
    .configure = inferential_configure,
    .step = inferential_block_step,
    .back_calculate = inferential_block_back_calculate,
    .follow = inferential_block_follow,
    .describe = inferential_describe,
};
