#include "kinds/state/state_feedback.h"

#include <string.h>

#include "base/assertion.h"
#include "block/refuse.h"
#include "law/state_law_settings.h"
#include "num/accumulator.h"
#include "num/solve_small.h"

#define LOOPS  STATE_FEEDBACK_LOOPS
#define INPUTS STATE_FEEDBACK_INPUTS

/* Below this part of the largest element limited loops have no G of their own to solve for. */
#define SOLVABLE 1e-4f
/* Sums of a row stay within what an accumulator of the fixed build holds, inputs and setpoints two spans away. */
#define ROW_MOST 16000.0f

struct state_feedback {
    uint8_t loops, inputs;
    const char *lacks; /* reason why it cannot act, in a word; NULL: it can */
    struct coefficient f[LOOPS][INPUTS], g[LOOPS][LOOPS];
    struct coefficient integral[LOOPS], derivative[LOOPS]; /* h/ti, td/h; negative */
    bool integrates[LOOPS];
    float steering[LOOPS][LOOPS]; /* G, by which limited loops give way */
    struct accumulator constant[LOOPS];
    struct accumulator sum[LOOPS];                    /* I */
    struct accumulator added[LOOPS];                  /* to it in the last step */
    num_t x[INPUTS], w[LOOPS], y[LOOPS], rise[LOOPS]; /* of the last step */
    num_t given[LOOPS];
    uint8_t acting;
};

#define AT(field) offsetof(struct state_feedback_settings, field)

static const struct block_parameter state_feedback_parameters[] = {
    {1, BLOCK_FLOAT, AT(f), LOOPS, INPUTS, "f", "-",
     "row: MV; column: input, a state or a disturbance", -1e4f, 1e4f, 0},
    {2, BLOCK_FLOAT, AT(g), LOOPS, LOOPS, "g", "-", "row: MV; column: setpoint of the loop", -1e4f,
     1e4f, 0},
    {3, BLOCK_FLOAT, AT(ti_s), 1, LOOPS, "ti", "s", "integral times; 0: none", 0, 1e6f, 0},
    {4, BLOCK_FLOAT, AT(td_s), 1, LOOPS, "td", "s", "derivative times, of measurements; 0: none", 0,
     1e6f, 0},
    {5, BLOCK_U16, AT(law), 1, 1, "law", "-",
     "number of the state_law block whose f, g, ti and td count; 0: those of its own", 0,
     CONFIG_BLOCKS, 0},
};

/* ---- settings ---- */

/* F, G, ti and td as they count; an interval of 0: for any. */
struct state_rows {
    const float *f, *g, *ti_s, *td_s;
    uint8_t loops; /* rows; of G columns as well */
    float made_s;
};

static struct state_rows law_rows(const struct block_setup *setup)
{
    const struct state_feedback_settings *c = setup->settings;
    const struct state_law_settings *law = c->law ? setup->named : NULL;
    return law ? (struct state_rows){law->f[0], law->g[0],       law->ti_s,
                                     law->td_s, STATE_LAW_LOOPS, law->made_s}
               : (struct state_rows){c->f[0], c->g[0], c->ti_s, c->td_s, LOOPS, 0};
}

static bool is_whole(const struct block_setup *setup)
{
    const struct state_feedback_settings *c = setup->settings;
    return !c->law || law_rows(setup).made_s > 0;
}

static uint32_t state_feedback_bytes(const struct block_setup *setup)
{
    (void)setup;
    return (uint32_t)((sizeof(struct state_feedback) + 7u) & ~(size_t)7u);
}

static bool is_empty(const float *row, unsigned from, unsigned to)
{
    for (unsigned k = from; k < to; k++)
        if (row[k] < 0 || row[k] > 0)
            return false;
    return true;
}

static float magnitudes_of(const float *row, unsigned n)
{
    float sum = 0;
    for (unsigned k = 0; k < n; k++)
        sum += row[k] < 0 ? -row[k] : row[k];
    return sum;
}

static enum err check_row(const struct state_rows *rows, const struct block_setup *setup,
                          unsigned i, struct block_fault *fault)
{
    const float *f = rows->f + (size_t)i * INPUTS, *g = rows->g + (size_t)i * rows->loops;
    unsigned n = setup->members, inputs = setup->inputs;
    if (!is_empty(f, inputs, INPUTS))
        return block_refuse(fault, i, "f", "has no more columns than there are inputs");
    if (!is_empty(g, n, rows->loops))
        return block_refuse(fault, i, "g", "has no more columns than there are loops");
    if (!(magnitudes_of(f, inputs) + magnitudes_of(g, n) <= ROW_MOST))
        return block_refuse(
            fault, i, "f",
            "needs rows that add up to 16000 at most with those of G, signs left aside");
    if (is_empty(g, 0, n))
        return block_refuse(fault, i, "g",
                            "needs an element in every row: each MV follows a setpoint");
    return ERR_OK;
}

static enum err check_rows(const struct state_rows *rows, const struct block_setup *setup,
                           struct block_fault *fault)
{
    enum err err = ERR_OK;
    unsigned n = setup->members;
    for (unsigned i = 0; i < n && !err; i++)
        err = check_row(rows, setup, i, fault);
    for (unsigned i = n; i < rows->loops && !err; i++)
        if (!is_empty(rows->f + (size_t)i * INPUTS, 0, INPUTS) ||
            !is_empty(rows->g + (size_t)i * rows->loops, 0, rows->loops))
            err = block_refuse(fault, 0, "loops", "needs as many as there are rows");
    return err;
}

static enum err state_feedback_check(const struct block_setup *setup, struct block_fault *fault)
{
    const struct state_feedback_settings *c = setup->settings;
    struct state_rows rows = law_rows(setup);
    unsigned n = setup->members;
    if (n < 1 || n > LOOPS)
        return block_refuse(fault, 0, "loops", "needs one to four");
    if (setup->inputs < 1)
        return block_refuse(fault, 0, "inputs", "needs the states that F is for");
    if (!c->law)
        return check_rows(&rows, setup, fault);
    if (!is_empty(c->f[0], 0, LOOPS * INPUTS) || !is_empty(c->g[0], 0, LOOPS * LOOPS) ||
        !is_empty(c->ti_s, 0, LOOPS) || !is_empty(c->td_s, 0, LOOPS))
        return block_refuse(fault, 0, "law", "must be 0, or f, g, ti and td: those of one count");
    if (n > rows.loops)
        return block_refuse(fault, 0, "loops", "needs one or two where law is set");
    return is_whole(setup) ? check_rows(&rows, setup, fault) : ERR_OK;
}

/* ---- the law ---- */

/* G (w + I - D) and F x, of MV i. */
static struct accumulator asked_of(const struct state_feedback *s, unsigned i)
{
    REFLUX_ASSERT(i < LOOPS && s->loops <= LOOPS && s->inputs <= INPUTS);
    struct accumulator sum;
    accumulator_set(&sum, num_zero());
    for (unsigned k = 0; k < s->inputs; k++)
        accumulator_add_product(&sum, s->f[i][k], s->x[k]);
    for (unsigned j = 0; j < s->loops; j++) {
        struct accumulator w;
        accumulator_set(&w, s->w[j]);
        if (s->integrates[j])
            accumulator_add_sum(&w, &s->sum[j]);
        accumulator_add_product(&w, s->derivative[j], s->rise[j]);
        accumulator_add_scaled(&sum, s->g[i][j], &w);
    }
    return sum;
}

static void take_states(struct state_feedback *s, const struct block_io *io)
{
    for (unsigned k = 0; k < s->inputs; k++)
        s->x[k] = io->inputs.value[k];
    for (unsigned j = 0; j < s->loops; j++) {
        s->rise[j] = num_sub(io->members.in[j], s->y[j]);
        s->y[j] = io->members.in[j];
        s->w[j] = io->members.acting & (1u << j) ? io->members.setpoint[j] : io->members.in[j];
    }
}

static void take_rows(struct state_feedback *s, const struct state_rows *rows, float interval_s)
{
    REFLUX_ASSERT(rows->loops <= LOOPS);
    for (unsigned i = 0; i < rows->loops; i++) {
        float ti = rows->ti_s[i];
        for (unsigned k = 0; k < INPUTS; k++)
            s->f[i][k] = coefficient_from_float(rows->f[i * INPUTS + k]);
        for (unsigned j = 0; j < rows->loops; j++) {
            s->steering[i][j] = rows->g[i * rows->loops + j];
            s->g[i][j] = coefficient_from_float(s->steering[i][j]);
        }
        s->integrates[i] = ti > 0;
        s->integral[i] = coefficient_from_float(ti > 0 ? interval_s / ti : 0);
        s->derivative[i] = coefficient_from_float(-rows->td_s[i] / interval_s);
        if (!s->integrates[i])
            accumulator_set(&s->sum[i], num_zero());
    }
}

/* True: both intervals are equal within a hundredth. */
static bool is_for(const struct state_rows *rows, float interval_s)
{
    float off = rows->made_s - interval_s, most = 0.01f * interval_s;
    return !(rows->made_s > 0) || (off <= most && off >= -most);
}

static enum err state_feedback_configure(void *state, const struct block_setup *setup, bool retune)
{
    REFLUX_ASSERT(setup->members <= LOOPS && setup->inputs <= INPUTS);
    struct state_feedback *s = state;
    struct state_rows rows = law_rows(setup);
    struct accumulator before[LOOPS];
    if (!retune)
        memset(s, 0, sizeof *s);
    for (unsigned i = 0; i < LOOPS && retune; i++)
        before[i] = asked_of(s, i);
    s->loops = setup->members;
    s->inputs = setup->inputs;
    if (!is_whole(setup)) {
        if (!retune)
            s->lacks = "no_law";
        return ERR_OK;
    }
    s->lacks = is_for(&rows, setup->interval_s) ? NULL : "interval";
    take_rows(s, &rows, setup->interval_s);
    for (unsigned i = 0; i < s->loops && retune; i++) { /* the same output, by the constant */
        struct accumulator present = asked_of(s, i);
        accumulator_add_sum(&s->constant[i], &before[i]);
        accumulator_take_sum(&s->constant[i], &present);
    }
    return ERR_OK;
}

/* ---- steps ---- */

/* Returns what the present error adds to I. */
static struct accumulator added_now(const struct state_feedback *s, unsigned j)
{
    struct accumulator sum;
    accumulator_set(&sum, num_zero());
    if (s->integrates[j])
        accumulator_add_product(&sum, s->integral[j], num_sub(s->w[j], s->y[j]));
    return sum;
}

static void state_feedback_step(void *state, struct block_io *io)
{
    struct state_feedback *s = state;
    io->requests.gives_up = s->lacks;
    take_states(s, io);
    s->acting = io->members.acting;
    for (unsigned j = 0; j < s->loops; j++) {
        s->added[j] = added_now(s, j);
        accumulator_add_sum(&s->sum[j], &s->added[j]);
    }
    for (unsigned i = 0; i < s->loops; i++) {
        struct accumulator u = asked_of(s, i);
        accumulator_add_sum(&u, &s->constant[i]);
        s->given[i] = accumulator_get(&u);
        if (io->members.acting & (1u << i))
            io->members.out[i] = s->given[i];
    }
}

/* The integrals of limited loops such that the law gives what took effect; those of this step are taken back where there are none
 * such. */
static void let_go(struct state_feedback *s, uint8_t limited, const num_t *out)
{
    uint8_t member[LOOPS];
    real_t rows[LOOPS * (LOOPS + 1)];
    size_t n = 0;
    for (unsigned j = 0; j < s->loops; j++)
        if ((limited & (1u << j)) && s->integrates[j])
            member[n++] = (uint8_t)j;
    for (size_t i = 0; i < n; i++) {
        real_t *row = &rows[i * (LOOPS + 1)];
        for (size_t j = 0; j < n; j++)
            row[j] = s->steering[member[i]][member[j]];
        row[n] = num_to_float(num_sub(out[member[i]], s->given[member[i]]));
    }
    bool solved = n > 0 && solve_small_scaled(SOLVABLE, n, n + 1, LOOPS + 1, rows);
    for (size_t i = 0; i < n; i++) {
        if (solved)
            accumulator_add(&s->sum[member[i]], num_from_float(rows[i * (LOOPS + 1) + n]));
        else
            accumulator_take_sum(&s->sum[member[i]], &s->added[member[i]]);
    }
}

static void state_feedback_back_calculate(void *state, struct block_io *io)
{
    struct state_feedback *s = state;
    uint8_t limited = 0;
    for (unsigned i = 0; i < s->loops; i++) {
        bool acts = io->members.acting & (1u << i);
        bool up = (s->steering[i][i] > 0) == num_lt(s->y[i], s->w[i]);
        if (acts && !num_eq(io->members.out[i], s->given[i]))
            limited |= (uint8_t)(1u << i);
        else if (acts && s->integrates[i] &&
                 (io->members.clamp[i] & (up ? INTEGRAL_CLAMP_UP : INTEGRAL_CLAMP_DOWN)))
            accumulator_take_sum(&s->sum[i], &s->added[i]);
    }
    if (limited)
        let_go(s, limited, io->members.out);
}

/* The next step with these inputs gives the outputs in effect. A loop that comes or goes is no reason for the others to forget
 * their integrals. */
static void state_feedback_follow(void *state, struct block_io *io)
{
    struct state_feedback *s = state;
    for (unsigned j = 0; j < s->loops; j++)
        s->y[j] = io->members.in[j];
    take_states(s, io);
    s->acting = io->members.acting;
    for (unsigned i = 0; i < s->loops; i++)
        if (!(io->members.acting & (1u << i)))
            accumulator_set(&s->sum[i], num_zero());
    for (unsigned i = 0; i < s->loops; i++) {
        struct accumulator present = asked_of(s, i);
        s->given[i] = io->members.out[i];
        accumulator_set(&s->constant[i], io->members.out[i]);
        accumulator_take_sum(&s->constant[i], &present);
    }
    for (unsigned j = 0; j < s->loops; j++) { /* the next step adds it */
        struct accumulator next = added_now(s, j);
        accumulator_take_sum(&s->sum[j], &next);
    }
}

static const char *state_feedback_describe(const void *state, size_t i, float *value)
{
    static const char *const names[2 * LOOPS] = {"given_1",    "given_2",    "given_3",
                                                 "given_4",    "integral_1", "integral_2",
                                                 "integral_3", "integral_4"};
    const struct state_feedback *s = state;
    REFLUX_ASSERT(s->loops >= 1 && s->loops <= LOOPS);
    size_t which = i / s->loops, k = i % s->loops;
    if (which > 1)
        return NULL;
    *value = num_to_float(which == 0 ? s->given[k] : accumulator_get(&s->sum[k]));
    return names[which * LOOPS + k];
}

const struct block_kind state_feedback_kind = {
    .name = "state",
    .stage = STAGE_CONTROL,
    .parameter = state_feedback_parameters,
    .parameters = sizeof state_feedback_parameters / sizeof state_feedback_parameters[0],
    .settings_bytes = sizeof(struct state_feedback_settings),
    .names = 5,
    .named_kind = "state_law",
    .members_most = LOOPS,
    .inputs_most = INPUTS,
    .bad_input = BAD_INPUT_GIVES_UP,
    .bytes = state_feedback_bytes,
    .check = state_feedback_check,
    .configure = state_feedback_configure,
    .step = state_feedback_step,
    .back_calculate = state_feedback_back_calculate,
    .follow = state_feedback_follow,
    .describe = state_feedback_describe,
};
