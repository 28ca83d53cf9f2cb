/* All kinds that only tests have, in one table: numbered, verb, exciting and stage kinds, and the worked family; and three that
 * do by chance whatever a kind may do. Included in one file of a test, it stands in for app/kinds.c. */
#ifndef REFLUX_TESTS_WALK_KINDS_H
#define REFLUX_TESTS_WALK_KINDS_H

#include <math.h>

#include "exchange/config.h"
#include "kinds/gmv/gmv_kind.h"
#include "random_source.h"
#include "unity.h"
#include "worked_family/kinds.h"

#define block_kinds      verb_table
#define block_kind_count verb_table_count
#include "verb_kinds.h"
#undef block_kinds
#undef block_kind_count
#define block_kinds      exciting_table
#define block_kind_count exciting_table_count
#define ahead_kind       adds_nothing_kind
#include "exciting_kinds.h"
#undef ahead_kind
#undef block_kinds
#undef block_kind_count
#define block_kinds      stage_table
#define block_kind_count stage_table_count
#include "stage_kinds.h"
#undef block_kinds
#undef block_kind_count
#include "numbered_kinds.h"

/* ---- imps ---- */

#define IMP_MAGIC 0x1A9u

struct imp_settings {
    float rate;
    float table[2][2];
    uint16_t size, depth;
};

struct imp {
    uint32_t magic;
    bool asked, begun, working;
    unsigned left;
    num_t rate, u[2];
    uint16_t size, excites;
    uint8_t members, inputs, points;
    struct block_excitation excite[BLOCK_EXCITES_MAX];
    uint8_t tail[];
};

static struct random_source imp_random;
static unsigned imp_mischief; /* 0: none; else one in so many steps */

static const struct block_parameter imp_parameters[] = {
    {1, BLOCK_FLOAT, offsetof(struct imp_settings, rate), 1, 1, "rate", "-", "of the integrals", 0,
     1, 0.05f},
    {2, BLOCK_FLOAT, offsetof(struct imp_settings, table), 2, 2, "table", "-", "of nothing", -10,
     10, 0},
    {3, BLOCK_U16, offsetof(struct imp_settings, size), 1, 1, "size", "-", "bytes more", 0, 900, 8},
    {4, BLOCK_U16, offsetof(struct imp_settings, depth), 1, 1, "depth", "-", "steps of the past", 0,
     200, 3},
};

static bool imp_one_in(uint32_t n)
{
    return imp_mischief && random_below(&imp_random, n * imp_mischief) == 0;
}

static struct imp *imp_of(void *state)
{
    struct imp *p = state;
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(IMP_MAGIC, p->magic, "state of another block");
    for (unsigned i = 0; i < p->size; i++)
        TEST_ASSERT_EQUAL_HEX8_MESSAGE(0x5A, p->tail[i], "state was written over");
    return p;
}

static uint32_t imp_bytes(const struct block_setup *setup)
{
    return (uint32_t)sizeof(struct imp) + ((const struct imp_settings *)setup->settings)->size;
}

static uint16_t imp_history(const struct block_setup *setup)
{
    return ((const struct imp_settings *)setup->settings)->depth;
}

static enum err imp_check(const struct block_setup *setup, struct block_fault *fault)
{
    fault->field = "rate";
    fault->wanted = "less than one";
    return ((const struct imp_settings *)setup->settings)->rate < 1 ? ERR_OK : ERR_RANGE;
}

static enum err imp_configure(void *state, const struct block_setup *setup, bool retune)
{
    struct imp *p = state;
    const struct imp_settings *c = setup->settings;
    if (retune) {
        (void)imp_of(state);
    } else {
        memset(p, 0, sizeof *p);
        p->magic = IMP_MAGIC;
        p->size = c->size;
        memset(p->tail, 0x5A, p->size);
    }
    TEST_ASSERT_EQUAL_MESSAGE(c->size, p->size, "as many bytes");
    p->rate = num_from_float(c->rate);
    p->members = setup->members;
    p->inputs = setup->inputs;
    p->points = setup->points;
    return ERR_OK;
}

static bool imp_work(void *state)
{
    struct imp *p = imp_of(state);
    TEST_ASSERT_TRUE_MESSAGE(p->asked, "work that nobody has asked for");
    p->working = p->left != 0;
    if (p->left)
        p->left--;
    return p->working;
}

static void imp_looks_back(const struct applied_history *history)
{
    if (history) {
        double there = D(applied_ticks_ago(history, 1));
        TEST_ASSERT_TRUE_MESSAGE(there >= -0.001 && there <= 1.001, "what took effect");
    }
}

static void imp_says(struct imp *p, struct block_io *io)
{
    unsigned members = p->members, inputs = p->inputs;
    TEST_ASSERT_TRUE_MESSAGE(!io->requests.work_done || p->asked,
                             "a result that nobody has asked for");
    if (io->requests.work_done)
        p->asked = false;
    if (!io->requests.work_wanted && imp_one_in(5)) {
        p->asked = true;
        p->left = random_below(&imp_random, 30);
        io->requests.ask_work = (uint8_t)(1 + random_below(&imp_random, 12));
    }
    io->requests.raised = (uint16_t)(imp_mischief ? random_below(&imp_random, 4) : 0);
    io->requests.event_value[0] = io->requests.event_value[1] =
        (float)random_below(&imp_random, 100);
    if (io->requests.proposal && imp_one_in(40)) {
        static const uint32_t what[] = {PROPOSED_LOOP_GAIN,
                                        PROPOSED_LOOP_TI,
                                        PROPOSED_LOOP_TD,
                                        PROPOSED_FF_GAIN,
                                        PROPOSED_DECOUPLE_D1,
                                        0x3040,
                                        0x7100};
        io->requests.proposal->n = (uint8_t)(1 + random_below(&imp_random, PROPOSAL_MAX));
        io->requests.proposal->manner = (uint8_t)random_below(&imp_random, 2);
        for (unsigned i = 0; i < io->requests.proposal->n; i++) {
            uint32_t id = proposed_setting((enum proposed)what[random_below(&imp_random, 7)],
                                           (uint8_t)random_below(&imp_random, 4));
            io->requests.proposal->value[i] = (struct proposed_value){
                random_below(&imp_random, 3) ? id
                                             : proposed_own((uint8_t)random_below(&imp_random, 6)),
                random_below(&imp_random, 9) ? 0.01f * (float)random_below(&imp_random, 200) : NAN};
        }
    }
    io->requests.withdraws = imp_one_in(60);
    if (io->requests.switch_off && imp_one_in(60)) {
        uint8_t element =
            (uint8_t)random_below(&imp_random, SWITCH_OFF_TERMS * (CONFIG_BLOCKS + 2u));
        *io->requests.switch_off = (struct block_switch_off){
            (uint8_t)(1 + random_below(&imp_random, SWITCH_OFF_MAX)),
            element,
            {{proposed_setting(PROPOSED_FF_GAIN, element % SWITCH_OFF_TERMS), 0},
             {proposed_in_row((uint8_t)random_below(&imp_random, CONFIG_BLOCKS),
                              (uint8_t)random_below(&imp_random, 6),
                              (uint16_t)random_below(&imp_random, 2),
                              (uint8_t)random_below(&imp_random, 8)),
              0}}};
    }
    if (!p->excites && imp_one_in(30)) {
        p->excites = (uint16_t)(1 + random_below(&imp_random, 30));
        memset(p->excite, 0, sizeof p->excite);
        for (unsigned i = 0; i < 1 + random_below(&imp_random, BLOCK_EXCITES_MAX); i++) {
            bool member = members && random_below(&imp_random, 2);
            p->excite[i] = (struct block_excitation){
                (uint8_t)(member ? (random_below(&imp_random, 2) ? EXCITE_MV : EXCITE_SETPOINT)
                                 : EXCITE_INPUT),
                (uint8_t)random_below(&imp_random, member   ? members
                                                   : inputs ? inputs
                                                            : 1),
                num_from_float(0.02f),
                num_from_float(0.02f),
                num_zero(),
                num_one()};
        }
    }
    if (p->excites) {
        p->excites--;
        for (unsigned i = 0; i < BLOCK_EXCITES_MAX; i++) {
            io->requests.excite[i] = p->excite[i];
            if (random_below(&imp_random, 2))
                io->requests.excite[i].value = num_neg(io->requests.excite[i].value);
        }
    }
    if (imp_one_in(100))
        io->requests.gives_up = "mischief";
}

static num_t imp_odd(num_t was)
{
    static const float odd[] = {-127, 127, 0, 1, 2, -1, NAN, INFINITY};
    return imp_one_in(60) ? num_from_float(odd[random_below(&imp_random, BY_FORMAT(8, 6))]) : was;
}

static void imp_control(void *state, struct block_io *io)
{
    struct imp *p = imp_of(state);
    for (unsigned k = 0; k < p->members; k++) {
        p->u[k] =
            num_add(p->u[k], num_mul(p->rate, num_sub(io->members.setpoint[k], io->members.in[k])));
        io->members.out[k] = imp_odd(p->u[k]);
        imp_looks_back(io->members.applied[k]);
    }
    imp_says(p, io);
}

static void imp_told(void *state, struct block_io *io)
{
    struct imp *p = imp_of(state);
    for (unsigned k = 0; k < p->members; k++)
        p->u[k] = io->members.out[k];
    if (imp_one_in(400))
        io->requests.gives_up = "told";
}

static void imp_estimate(void *state, struct block_io *io)
{
    struct imp *p = imp_of(state);
    for (unsigned k = 0; k < p->points && k < p->inputs; k++) {
        io->points.value[k] = imp_odd(io->inputs.value[k]);
        io->points.quality[k] =
            imp_one_in(50) ? (uint8_t)random_below(&imp_random, 4) : io->inputs.quality[k];
        imp_looks_back(io->inputs.applied[k]);
    }
    imp_says(p, io);
}

static void imp_nothing(void *state, struct block_io *io)
{
    (void)imp_of(state);
    (void)io;
}

static void imp_passes(void *state, struct block_io *io)
{
    const struct imp *p = imp_of(state);
    for (unsigned k = 0; k < p->members; k++)
        if (io->members.acting & (1u << k))
            io->members.out[k] = imp_odd(io->members.in[k]);
    if (imp_one_in(300))
        io->requests.gives_up = "passes";
}

static void imp_passes_back(void *state, struct block_io *io)
{
    const struct imp *p = imp_of(state);
    for (unsigned k = 0; k < p->members; k++)
        if (io->members.acting & (1u << k))
            io->members.out[k] = io->members.in[k];
}

static const char *imp_verb(void *state, const float *number)
{
    (void)imp_of(state);
    return number && *number > 50 ? "no" : NULL;
}

static const char *imp_describe(const void *state, size_t i, float *value)
{
    *value = (float)((const struct imp *)state)->left;
    return i ? NULL : "left";
}

static const struct block_verb imp_verbs[] = {{.name = "poke",
                                               .number = "-",
                                               .help = "it",
                                               .lo = 0,
                                               .hi = 100,
                                               .may_lack_number = true,
                                               .run = imp_verb}};
static const struct block_event imp_events[] = {{"one", BLOCK_INFO, "a moment, -"},
                                                {"two", BLOCK_ALARM, "a state, -"}};

#define IMP(title, at, ...)                                                                        \
    {                                                                                              \
        .name = title, .stage = at, .parameter = imp_parameters, .parameters = 4,                  \
        .settings_bytes = sizeof(struct imp_settings), .bytes = imp_bytes, .check = imp_check,     \
        .configure = imp_configure, .history = imp_history, .work = imp_work, .verb = imp_verbs,   \
        .verbs = 1, .event = imp_events, .events = 2, .describe = imp_describe, __VA_ARGS__        \
    }

static const struct block_kind imp_control_kind =
    IMP("imp", STAGE_CONTROL, .members_most = 2, .inputs_most = 1, .step = imp_control,
        .bad_input = BAD_INPUT_MANUAL, .back_calculate = imp_told, .follow = imp_told);
static const struct block_kind imp_estimate_kind =
    IMP("imp_est", STAGE_ESTIMATE, .inputs_most = 2, .points_most = 2, .step = imp_estimate,
        .follow = imp_nothing);
static const struct block_kind imp_compensate_kind =
    IMP("imp_comp", STAGE_COMPENSATE, .members_most = 2, .inputs_most = 1, .step = imp_passes,
        .back_calculate = imp_passes_back);

const struct block_kind *const block_kinds[] = {
    &pid_kind,          &two_position_kind,   &decoupler_kind, &feedforward_kind,
    &observer_kind,     &state_feedback_kind, &watch_kind,     &pair_kind,
    &held_kind,         &shake_kind,          &pass_kind,      &cross_kind,
    &twice_kind,        &ahead_kind,          &wary_kind,      &keen_kind,
    &duet_kind,         &mean_kind,           &both_kind,      &imp_control_kind,
    &imp_estimate_kind, &imp_compensate_kind, &gmv_kind};
const uint8_t block_kind_count = sizeof block_kinds / sizeof block_kinds[0];

#endif
