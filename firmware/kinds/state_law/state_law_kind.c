/* Kind `state_law`: its steps, its work between ticks, its verbs. */
#include "kinds/state_law/state_law.h"

#include <string.h>

#include "base/assertion.h"
#include "base/text.h"
#include "base/workspace.h"
#include "block/refuse.h"
#include "kinds/state_law/state_law_block.h"
#include "kinds/state_law/state_law_column.h"
#include "kinds/state_law/state_law_column_state.h"
#include "kinds/state_law/state_law_parameters.h"
#include "law/state_law_job.h"
#include "law/state_law_proposal.h"

#define HOLDER "state_law"
#define FREES  "block N stop"

/* Time that the job has, s: a board does it in a tenth of a second. */
#define JOB_S      2.0f
#define STEPS_MOST 250.0f

/* ---- settings ---- */

static uint32_t state_law_bytes(const struct block_setup *setup)
{
    (void)setup;
    return (uint32_t)((sizeof(struct state_law_block) + 7u) & ~(size_t)7u);
}

static enum err state_law_check(const struct block_setup *setup, struct block_fault *fault)
{
    if (sizeof(struct state_law_column) > WORKSPACE_BYTES)
        return block_refuse(fault, 0, "column", "needs more workspace than this board has");
    return state_law_check_settings(setup, fault);
}

static bool is_designing(const struct state_law_block *b)
{
    return b->stage == STATE_LAW_ASKED || b->stage == STATE_LAW_DESIGNS;
}

static void end_lease(struct state_law_block *b)
{
    if (b->job)
        workspace_end(workspace_shared(), b->lease);
    b->job = NULL;
}

/* Ends without a law; returns where the reason goes on. */
static struct text refusal(struct state_law_block *b, unsigned loop)
{
    struct text t = text_on(b->refused, sizeof b->refused);
    text_str(&t, "no law: ");
    b->found.loop = (uint8_t)loop;
    end_lease(b);
    b->stage = STATE_LAW_REFUSED;
    b->event = STATE_LAW_EVENT_REFUSED + 1;
    return t;
}

static void end_refused(struct state_law_block *b)
{
    (void)refusal(b, b->found.loop);
    state_law_words(&b->found, b->refused, sizeof b->refused);
}

static void end_stopped(struct state_law_block *b, const char *why)
{
    struct text t = refusal(b, 0);
    text_str(&t, why);
}

/* Compares all settings but the law, which comes by proposals of its own. */
static bool goal_differs(const struct state_law_settings *a, const struct state_law_settings *b)
{
    return memcmp(a, b, offsetof(struct state_law_settings, made_s)) != 0;
}

static enum err state_law_configure(void *state, const struct block_setup *setup, bool retune)
{
    REFLUX_ASSERT(setup->inputs <= BLOCK_INPUTS_MAX);
    struct state_law_block *b = state;
    const struct state_law_settings *s = setup->settings;
    const struct column_record *record = s->column ? setup->named : NULL;
    uint32_t checksum = record ? column_record_checksum(record) : 0;
    if (!retune) {
        memset(b, 0, sizeof *b);
    } else if (goal_differs(&b->s, s) || b->record != record || b->checksum != checksum) {
        b->proposes = false;
        if (is_designing(b))
            end_stopped(b, "settings or the table have changed while it was being found");
    }
    b->s = *s;
    b->record = record;
    b->checksum = checksum;
    b->inputs = setup->inputs;
    b->loops = (uint8_t)state_law_loops(setup->input, setup->inputs);
    b->interval_s = setup->interval_s;
    memcpy(b->input, setup->input, sizeof b->input);
    return ERR_OK;
}

/* ---- between ticks ---- */

/* The workspace, or a stage without: the next step sees which. */
static void lease_for_law(struct state_law_block *b)
{
    struct workspace *w = workspace_shared();
    void *memory = NULL;
    if (w && workspace_lease_for_now(w, HOLDER, FREES, sizeof(struct state_law_column), &b->lease,
                                     &memory) == ERR_OK)
        b->job = memory;
}

static bool state_law_work(void *state)
{
    struct state_law_block *b = state;
    struct state_law_column *job = b->job;
    if (b->stage == STATE_LAW_ASKED && !job)
        lease_for_law(b);
    return b->stage == STATE_LAW_DESIGNS && job && state_law_column_piece(job);
}

/* ---- in the tick ---- */

static uint8_t steps_of_job(const struct state_law_block *b)
{
    float steps = JOB_S / b->interval_s;
    return (uint8_t)(steps < 1 ? 1 : steps < STEPS_MOST ? steps : STEPS_MOST);
}

static void end_without_workspace(struct state_law_block *b)
{
    const struct workspace *w = workspace_shared();
    struct text t = refusal(b, 0);
    text_str(&t, "no workspace; ");
    if (w)
        workspace_refusal(w, &t);
}

static void keep_lease(struct state_law_block *b)
{
    if (!is_designing(b)) {
        end_lease(b);
    } else if (b->job && !workspace_renew(workspace_shared(), b->lease)) {
        b->job = NULL;
        end_without_workspace(b);
    }
}

static void take_law(struct state_law_block *b)
{
    b->found = *state_law_column_found(b->job);
    if (b->found.field[0]) {
        end_refused(b);
        return;
    }
    end_lease(b);
    b->stage = STATE_LAW_DONE;
    b->event = STATE_LAW_EVENT_MADE + 1;
    b->proposes = true;
    b->waits = false;
}

static void law_goes_on(struct state_law_block *b, struct block_io *io)
{
    REFLUX_ASSERT(b->stage != STATE_LAW_DESIGNS || b->job);
    if (io->requests.work_wanted)
        return;
    if (b->stage == STATE_LAW_ASKED && b->job) {
        state_law_column_begin(b->job, &b->s, b->input, b->inputs, b->record);
        b->stage = STATE_LAW_DESIGNS;
        io->requests.ask_work = steps_of_job(b);
    } else if (b->stage == STATE_LAW_ASKED && io->requests.work_done) {
        end_without_workspace(b);
    } else if (b->stage == STATE_LAW_ASKED) {
        io->requests.ask_work = 1;
    } else if (state_law_column_is_over(b->job)) {
        take_law(b);
    } else { /* given up, as by an apply */
        io->requests.ask_work = steps_of_job(b);
    }
}

static void propose_law_of_column(struct state_law_block *b, struct block_proposal *room)
{
    if (!b->proposes || !room)
        return;
    if (!b->waits)
        state_law_put_values(&b->s, &b->found, b->s.period_s, b->loops, PROPOSED_SELF, room);
    b->proposes = b->waits = room->n > 0; /* else it is in force, or refused, or rejected */
    room->manner = b->s.adopt == STATE_LAW_AT_ONCE ? PROPOSAL_AT_ONCE : PROPOSAL_WHEN_ACCEPTED;
}

static void state_law_step(void *state, struct block_io *io)
{
    struct state_law_block *b = state;
    keep_lease(b);
    if (is_designing(b))
        law_goes_on(b, io);
    propose_law_of_column(b, io->requests.proposal);
    io->requests.withdraws = !b->proposes;
    REFLUX_ASSERT(b->event <= STATE_LAW_EVENTS);
    io->requests.raised = 0;
    if (b->event) {
        io->requests.raised = (uint16_t)(1u << (b->event - 1u));
        io->requests.event_value[b->event - 1u] =
            b->event == STATE_LAW_EVENT_MADE + 1 ? b->found.radius : (float)b->found.loop;
        b->event = 0;
    }
}

/* ---- for the console ---- */

static const char *state_law_describe(const void *state, size_t i, float *value)
{
    const struct state_law_block *b = state;
    const struct state_law_found *f = &b->found;
    const char *const names[] = {"stage",    "index_1",          "K_star_1", "index_2",
                                 "K_star_2", "condition",        "zeros",    "outermost_zero",
                                 "radius",   "radius_by_inputs", "left_of_F"};
    const float values[] = {b->stage,     f->index[0],      f->k_star[0], f->index[1],
                            f->k_star[1], f->condition,     f->zeros,     f->zero,
                            f->radius,    f->inputs_radius, f->left};
    size_t all = sizeof values / sizeof values[0];
    if (b->stage == STATE_LAW_REFUSED && i == 0) {
        *value = f->loop;
        return b->refused;
    }
    i -= b->stage == STATE_LAW_REFUSED ? 1u : 0u;
    if (i >= all)
        return NULL;
    *value = values[i];
    return names[i];
}

/* ---- verbs ---- */

static const char *law_design(void *state, const float *number)
{
    struct state_law_block *b = state;
    (void)number;
    if (is_designing(b))
        return "runs";
    if (!b->record)
        return "column"; /* there is none */
    memset(&b->found, 0, sizeof b->found);
    b->refused[0] = '\0';
    b->proposes = false;
    b->stage = STATE_LAW_ASKED;
    return NULL;
}

static const char *law_stop(void *state, const float *number)
{
    struct state_law_block *b = state;
    (void)number;
    if (is_designing(b))
        end_stopped(b, "stopped");
    else if (!b->proposes)
        return "runs not";
    b->proposes = false;
    return NULL;
}

static const struct block_verb state_law_verbs[] = {
    {"design", NULL, "the law, from the column's table around its profile", 0, 0, false,
     ACCESS_ENGINEER, law_design},
    {"stop", NULL, "what it has begun", 0, 0, false, ACCESS_OPERATOR, law_stop},
};

static const struct block_event state_law_events[STATE_LAW_EVENTS] = {
    [STATE_LAW_EVENT_MADE] = {"made", BLOCK_INFO,
                              "a law, which is proposed; the sampled loop's largest pole, -"},
    [STATE_LAW_EVENT_REFUSED] = {"refused", BLOCK_INFO,
                                 "no law, `block N` says why; of which loop"},
};

const struct block_kind state_law_kind = {
    .name = "state_law",
    .stage = STAGE_ESTIMATE,
    .parameter = state_law_parameters,
    .parameters = STATE_LAW_PARAMETERS,
    .settings_bytes = sizeof(struct state_law_settings),
    .names = 1,
    .named_kind = "column",
    .inputs_most = STATE_FEEDBACK_INPUTS + STATE_LAW_LOOPS,
    .bad_input = BAD_INPUT_IS_TOLD,
    .work = state_law_work,
    .verb = state_law_verbs,
    .verbs = sizeof state_law_verbs / sizeof state_law_verbs[0],
    .event = state_law_events,
    .events = STATE_LAW_EVENTS,
    .bytes = state_law_bytes,
    .check = state_law_check,
    .configure = state_law_configure,
    .step = state_law_step,
    .describe = state_law_describe,
};
