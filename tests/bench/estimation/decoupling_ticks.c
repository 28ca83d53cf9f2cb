/* A base tick of what decouples: the kind `polynomial` (step and back-calculation) with all MVs free and with the first one at its
 * limit, the regulatory static decoupler, and the sums alone, which anything that does the same has to make; and a step of
 * the kind `rst` beside the loops' own PID. */
#include <stdalign.h>
#include <string.h>

#include "cost.h"
#include "decoupling.h"
#include "kinds/decoupler/decoupler.h"
#include "kinds/pid/pid.h"
#include "kinds/polynomial/polynomial.h"
#include "kinds/rst/rst.h"
#include "kinds/state/state_feedback.h"

#define SAMPLES 300u
#define FIRST   20u

static alignas(8) char state[4000];
static struct block_setup setup;
static struct block_fault fault;
static struct polynomial_settings polynomial;
static float matrix[DECOUPLER_MAX][DECOUPLER_MAX];
static num_t in[DECOUPLER_MAX], out[DECOUPLER_MAX];

static struct block_setup setup_of(const void *settings, unsigned loops)
{
    struct block_setup s;
    memset(&s, 0, sizeof s);
    s.settings = settings;
    s.interval_s = 120;
    s.members = (uint8_t)loops;
    s.present = (uint8_t)((1u << loops) - 1u);
    for (unsigned k = 0; k < loops; k++)
        s.member[k] = (struct block_member){
            .loop = (uint8_t)k, .drives_mv = true, .pv_span = 1, .out_reach = 2};
    return s;
}

static void next_inputs(unsigned loops)
{
    for (unsigned k = 0; k < loops; k++)
        in[k] = num_from_float(0.3f + 0.1f * cost_random());
}

/* Diagonals of 1 with a past that dies away. */
static void take_polynomial(unsigned loops, unsigned taps)
{
    memset(&polynomial, 0, sizeof polynomial);
    for (unsigned i = 0; i < loops; i++)
        for (unsigned j = 0; j < loops; j++)
            for (unsigned k = 0; k < taps; k++)
                polynomial.g[i * loops + j][k] = (i == j ? 1.0f : 0.2f) / (float)(1u << (2 * k));
}

static void cost_of_polynomial(const char *what, unsigned loops, unsigned taps, bool limited)
{
    struct cost cost = {0};
    take_polynomial(loops, taps);
    setup = setup_of(&polynomial, loops);
    if (polynomial_kind.check(&setup, &fault) != ERR_OK ||
        polynomial_kind.bytes(&setup) > sizeof state ||
        polynomial_kind.configure(state, &setup, false) != ERR_OK)
        return; /* a row is missing */
    struct block_io io = {.members.acting = setup.present, .members.in = in, .members.out = out};
    next_inputs(loops);
    polynomial_kind.follow(state, &io);
    io.members.going_on = setup.present;
    for (unsigned t = 0; t < SAMPLES; t++) {
        next_inputs(loops);
        cost_paint_stack();
        uint32_t from = cost_now();
        polynomial_kind.step(state, &io);
        uint32_t between = cost_now();
        for (unsigned k = 0; k < loops; k++)
            in[k] = limited && k == 0 ? num_from_float(-0.01f) : num_zero();
        uint32_t again = cost_now();
        polynomial_kind.back_calculate(state, &io);
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&cost, from, to - (again - between));
        cost_stack(&cost);
    }
    cost_tell(what, loops * 10 + taps, &cost, polynomial_kind.bytes(&setup));
}

/* n x n rows of coefficients times what has been, and nothing else. */
static void cost_of_sums(unsigned loops, unsigned taps)
{
    static num_t g[POLYNOMIAL_LOOPS][POLYNOMIAL_LOOPS * POLYNOMIAL_TAPS];
    static num_t past[POLYNOMIAL_LOOPS * POLYNOMIAL_TAPS];
    struct cost cost = {0};
    take_polynomial(loops, taps);
    for (unsigned i = 0; i < loops; i++)
        for (unsigned k = 0; k < taps; k++)
            for (unsigned j = 0; j < loops; j++)
                g[i][k * loops + j] = num_from_float(polynomial.g[i * loops + j][k]);
    memset(past, 0, sizeof past);
    for (unsigned t = 0; t < SAMPLES; t++) {
        next_inputs(loops);
        cost_paint_stack();
        uint32_t from = cost_now();
        memmove(past + loops, past, (size_t)loops * (taps - 1u) * sizeof *past);
        memcpy(past, in, loops * sizeof *past);
        for (unsigned i = 0; i < loops; i++) {
            num_wide_t sum = num_wide_zero();
            for (unsigned k = 0; k < loops * taps; k++)
                sum = num_wide_add(sum, g[i][k], past[k]);
            out[i] = num_from_wide(sum);
        }
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&cost, from, to);
        cost_stack(&cost);
    }
    cost_tell("sums", loops * 10 + taps, &cost,
              (uint32_t)((loops + 1u) * loops * taps * sizeof(num_t)));
}

static void cost_of_static(const char *what, unsigned loops, bool limited)
{
    struct decoupler *d = (struct decoupler *)(void *)state;
    struct cost cost = {0};
    num_t dv[DECOUPLER_MAX];
    for (unsigned i = 0; i < DECOUPLER_MAX; i++)
        for (unsigned j = 0; j < DECOUPLER_MAX; j++)
            matrix[i][j] = i == j ? 1.0f : 0.2f;
    if (decoupler_select(d, (const float(*)[DECOUPLER_MAX])matrix, (uint8_t)((1u << loops) - 1u)) !=
        ERR_OK)
        return;
    for (unsigned t = 0; t < SAMPLES; t++) {
        next_inputs(loops);
        cost_paint_stack();
        uint32_t from = cost_now();
        decoupler_forward(d, in, out);
        uint32_t between = cost_now();
        for (unsigned k = 0; k < loops; k++)
            in[k] = limited && k == 0 ? num_from_float(-0.01f) : num_zero();
        uint32_t again = cost_now();
        decoupler_give_way(d, in, dv);
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&cost, from, to - (again - between));
        cost_stack(&cost);
    }
    cost_tell(what, loops * 10 + 1, &cost, sizeof *d);
}

/* Each with so many coefficients: a model of second order needs three. */
static void cost_of_rst(unsigned coefficients)
{
    static struct rst_settings settings;
    struct cost cost = {0};
    num_t setpoint[1] = {num_from_float(0.5f)};
    uint8_t clamp[1] = {0}, limits[1] = {0};
    memset(&settings, 0, sizeof settings);
    settings.period_s = 120;
    for (unsigned k = 0; k < coefficients; k++) {
        settings.p[k] = 0.1f;
        settings.q[k] = settings.r[k] = k == 0 ? 5.0f : -0.5f;
    }
    setup = setup_of(&settings, 1);
    if (rst_kind.check(&setup, &fault) != ERR_OK || rst_kind.bytes(&setup) > sizeof state ||
        rst_kind.configure(state, &setup, false) != ERR_OK)
        return;
    struct block_io io = {.members.acting = 1,
                          .members.setpoint = setpoint,
                          .members.in = in,
                          .members.out = out,
                          .members.clamp = clamp,
                          .members.limited = limits,
                          .members.divisor = 1};
    in[0] = out[0] = num_from_float(0.5f);
    rst_kind.follow(state, &io);
    for (unsigned t = 0; t < SAMPLES; t++) {
        in[0] = num_from_float(0.5f + 0.01f * cost_random());
        cost_paint_stack();
        uint32_t from = cost_now();
        rst_kind.step(state, &io);
        rst_kind.back_calculate(state, &io);
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&cost, from, to);
        cost_stack(&cost);
    }
    cost_tell("rst", 10 + coefficients, &cost, rst_kind.bytes(&setup));
}

/* All columns of F used, integrals and derivatives of all loops. */
static void cost_of_state_feedback(unsigned loops, unsigned inputs)
{
    static struct state_feedback_settings settings;
    struct cost cost = {0};
    num_t setpoint[STATE_FEEDBACK_LOOPS], input[STATE_FEEDBACK_INPUTS];
    uint8_t clamp[STATE_FEEDBACK_LOOPS] = {0}, limits[STATE_FEEDBACK_LOOPS] = {0};
    memset(&settings, 0, sizeof settings);
    for (unsigned i = 0; i < loops; i++) {
        for (unsigned k = 0; k < inputs; k++)
            settings.f[i][k] = -0.5f;
        for (unsigned j = 0; j < loops; j++)
            settings.g[i][j] = i == j ? 1.5f : -0.3f;
        settings.ti_s[i] = 1800;
        settings.td_s[i] = 60;
        setpoint[i] = in[i] = out[i] = num_from_float(0.5f);
    }
    setup = setup_of(&settings, loops);
    setup.inputs = (uint8_t)inputs;
    if (state_feedback_kind.check(&setup, &fault) != ERR_OK ||
        state_feedback_kind.bytes(&setup) > sizeof state ||
        state_feedback_kind.configure(state, &setup, false) != ERR_OK)
        return;
    struct block_io io = {.members.acting = setup.present,
                          .members.setpoint = setpoint,
                          .members.in = in,
                          .members.out = out,
                          .members.clamp = clamp,
                          .members.limited = limits,
                          .inputs.value = input,
                          .members.divisor = 1};
    for (unsigned t = 0; t < SAMPLES; t++) {
        for (unsigned k = 0; k < inputs; k++)
            input[k] = num_from_float(0.5f + 0.01f * cost_random());
        for (unsigned i = 0; i < loops; i++)
            in[i] = input[i];
        if (t == 0)
            state_feedback_kind.follow(state, &io);
        cost_paint_stack();
        uint32_t from = cost_now();
        state_feedback_kind.step(state, &io);
        state_feedback_kind.back_calculate(state, &io);
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&cost, from, to);
        cost_stack(&cost);
    }
    cost_tell("state", loops * 10 + inputs, &cost, state_feedback_kind.bytes(&setup));
}

static void cost_of_pid_beside(void)
{
    struct pid *pid = (struct pid *)(void *)state;
    struct pid_config c = pid_default_config();
    struct cost cost = {0};
    c.ti_s = 740;
    c.td_s = 100;
    if (pid_init(pid, &c, 30) != ERR_OK)
        return;
    pid_follow(pid, num_from_float(0.5f), num_from_float(0.5f), num_from_float(0.5f));
    for (unsigned t = 0; t < SAMPLES; t++) {
        num_t y = num_from_float(0.5f + 0.01f * cost_random());
        cost_paint_stack();
        uint32_t from = cost_now();
        num_t u = pid_step(pid, num_from_float(0.5f), y);
        pid_back_calculate(pid, u, INTEGRAL_FREE);
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&cost, from, to);
        cost_stack(&cost);
    }
    cost_tell("pid", 10, &cost, sizeof *pid);
}

void cost_of_decoupling_ticks(void)
{
    static const struct {
        unsigned loops, taps;
    } sizes[] = {{2, 1}, {2, 2}, {2, 8}, {4, 2}, {4, 8}};
    for (unsigned k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        unsigned loops = sizes[k].loops, taps = sizes[k].taps;
        cost_of_polynomial("polynomial", loops, taps, false);
        cost_of_polynomial("limited", loops, taps, true);
        cost_of_sums(loops, taps);
        if (taps == 1) {
            cost_of_static("static", loops, false);
            cost_of_static("static_limited", loops, true);
        }
    }
    cost_of_static("static", 4, false);
    cost_of_static("static_limited", 4, true);
    cost_of_rst(3);
    cost_of_rst(RST_COEFFICIENTS);
    cost_of_state_feedback(2, 4);
    cost_of_state_feedback(2, 8);
    cost_of_state_feedback(4, 8);
    cost_of_pid_beside();
}
