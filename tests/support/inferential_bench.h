/* A block `inferential` with model plants, driven as the tick drives it. Plants in EU, hours and double:
 *
 *     dT/dt = a u + cross u_other + load,  exact while u stands still; u from the lower end of its span
 */
#ifndef REFLUX_TESTS_INFERENTIAL_BENCH_H
#define REFLUX_TESTS_INFERENTIAL_BENCH_H

#include <math.h>
#include <stdalign.h>
#include <stdio.h>
#include <string.h>

#include "kinds/inferential/inferential_settings.h"
#include "unity.h"

#define BENCH_LOOPS INFERENTIAL_LOOPS
#define BENCH_STATE 4096

struct bench_plant {
    double a[2], cross[2], load[2];
    double t[2], u, setpoint; /* u: as applied, from the lower end */
    double lo, hi, rate;      /* limits of the MV; of its movement in a step, 0: none */
};

struct infer_bench {
    struct inferential_settings settings;
    struct block_setup setup;
    struct bench_plant plant[BENCH_LOOPS];
    unsigned seconds; /* secondary temperatures among the inputs: of which loops */
    unsigned second_of[2];
    alignas(8) char state[BENCH_STATE];

    struct block_io io;
    num_t setpoint[BENCH_LOOPS], pv[BENCH_LOOPS], out[BENCH_LOOPS], input[4];
    uint8_t clamp[BENCH_LOOPS], limited[BENCH_LOOPS], quality[4];
    float age_s[4], event_value[BLOCK_EVENTS_MAX];
    struct {
        alignas(8) char bytes[sizeof(struct applied_history) + 8 * sizeof(num_t)];
    } ring[BENCH_LOOPS];
    const struct applied_history *member_applied[BENCH_LOOPS], *input_applied[4];
};

static inline double bench_width(const struct block_signal *s)
{
    return (double)s->hi - (double)s->lo;
}

static inline const struct block_signal *bench_mv(const struct infer_bench *b, unsigned k)
{
    return &b->setup.input[b->seconds + k];
}

/* As a cold configuration has them. */
static inline void bench_defaults(struct inferential_settings *s)
{
    memset(s, 0, sizeof *s);
    for (unsigned i = 0; i < inferential_kind.parameters; i++) {
        const struct block_parameter *p = &inferential_kind.parameter[i];
        for (unsigned n = 0; n < (unsigned)p->rows * p->cols; n++) {
            char *at = (char *)s + p->offset;
            if (p->type == BLOCK_FLOAT)
                memcpy(at + n * sizeof(float), &p->initial, sizeof(float));
            else if (p->type == BLOCK_U16)
                memcpy(at + n * 2, &(uint16_t){(uint16_t)p->initial}, 2);
            else
                at[n] = (char)(int)p->initial;
        }
    }
}

static inline struct applied_history *bench_ring(struct infer_bench *b, unsigned k)
{
    return (struct applied_history *)(void *)b->ring[k].bytes;
}

/* Members, secondary temperatures, then MVs. Spans are to be filled in by the caller. */
static inline void bench_wire(struct infer_bench *b, unsigned members, unsigned seconds,
                              float interval_s)
{
    b->seconds = seconds;
    b->setup.settings = &b->settings;
    b->setup.interval_s = interval_s;
    b->setup.members = (uint8_t)members;
    b->setup.present = (uint8_t)((1u << members) - 1u);
    b->setup.inputs = (uint8_t)(seconds + members);
    for (unsigned k = 0; k < members; k++) {
        b->setup.member[k] =
            (struct block_member){.loop = (uint8_t)k, .drives_mv = true, .out_reach = 1};
        b->setup.input[seconds + k].is_mv = true;
        applied_history_begin(bench_ring(b, k), 8, num_zero());
        b->member_applied[k] = b->input_applied[seconds + k] = bench_ring(b, k);
    }
    b->io = (struct block_io){.members.setpoint = b->setpoint,
                              .members.in = b->pv,
                              .members.out = b->out,
                              .members.clamp = b->clamp,
                              .members.limited = b->limited,
                              .inputs.value = b->input,
                              .inputs.quality = b->quality,
                              .inputs.age_s = b->age_s,
                              .members.applied = b->member_applied,
                              .inputs.applied = b->input_applied,
                              .members.divisor = 1,
                              .requests.event_value = b->event_value};
}

static inline enum err bench_check(struct infer_bench *b, struct block_fault *fault)
{
    *fault = (struct block_fault){.field = "", .wanted = ""};
    for (unsigned k = 0; k < b->setup.members; k++)
        b->setup.member[k].pv_span = (float)bench_width(&b->setup.pv[k]);
    return inferential_kind.check(&b->setup, fault);
}

static inline void bench_configure(struct infer_bench *b, bool retune)
{
    struct block_fault fault;
    enum err err = bench_check(b, &fault);
    TEST_ASSERT_EQUAL_MESSAGE(ERR_OK, err, fault.field);
    TEST_ASSERT_LESS_OR_EQUAL(BENCH_STATE, inferential_kind.bytes(&b->setup));
    TEST_ASSERT_EQUAL(ERR_OK, inferential_kind.configure(b->state, &b->setup, retune));
}

static inline num_t bench_fraction(double eu, const struct block_signal *s)
{
    return num_from_float((float)((eu - (double)s->lo) / bench_width(s)));
}

static inline void bench_measure(struct infer_bench *b)
{
    for (unsigned k = 0; k < b->setup.members; k++) {
        b->pv[k] = bench_fraction(b->plant[k].t[0], &b->setup.pv[k]);
        b->setpoint[k] = bench_fraction(b->plant[k].setpoint, &b->setup.pv[k]);
        b->input[b->seconds + k] =
            num_from_float((float)(b->plant[k].u / bench_width(bench_mv(b, k))));
    }
    for (unsigned j = 0; j < b->seconds; j++)
        b->input[j] = bench_fraction(b->plant[b->second_of[j]].t[1], &b->setup.input[j]);
    b->io.requests.raised = 0;
    b->io.requests.gives_up = NULL;
}

/* None acts: the outputs are where the MVs are. */
static inline void bench_follow(struct infer_bench *b)
{
    bench_measure(b);
    b->io.members.acting = 0;
    for (unsigned k = 0; k < b->setup.members; k++)
        b->out[k] = b->input[b->seconds + k];
    inferential_kind.follow(b->state, &b->io);
}

static inline void bench_step(struct infer_bench *b)
{
    bench_measure(b);
    inferential_kind.step(b->state, &b->io);
}

/* The MVs move within their limits, the block is told. */
static inline void bench_apply(struct infer_bench *b)
{
    for (unsigned k = 0; k < b->setup.members; k++) {
        struct bench_plant *p = &b->plant[k];
        double width = bench_width(bench_mv(b, k));
        num_t u = b->out[k], was = num_from_float((float)(p->u / width));
        u = num_clamp(u, num_from_float((float)(p->lo / width)),
                      num_from_float((float)(p->hi / width)));
        if (p->rate > 0) {
            num_t most = num_from_float((float)(p->rate / width));
            u = num_clamp(u, num_sub(was, most), num_add(was, most));
        }
        if (!num_eq(u, was))
            p->u = (double)num_to_float(u) * width;
        b->out[k] = u;
        applied_history_append(bench_ring(b, k), u);
    }
    inferential_kind.back_calculate(b->state, &b->io);
}

/* The plants go on to the next sample. */
static inline void bench_go_on(struct infer_bench *b)
{
    double h = (double)b->setup.interval_s / 3600;
    for (unsigned k = 0; k < b->setup.members; k++) {
        struct bench_plant *p = &b->plant[k];
        double other = b->setup.members > 1 ? b->plant[1 - k].u : 0;
        for (unsigned i = 0; i < 2; i++)
            p->t[i] += h * (p->a[i] * p->u + p->cross[i] * other + p->load[i]);
    }
}

static inline double bench_value(const struct infer_bench *b, const char *name)
{
    float value = NAN;
    const char *is;
    for (size_t i = 0; (is = inferential_kind.describe(b->state, i, &value)) != NULL; i++)
        if (strcmp(is, name) == 0)
            return (double)value;
    TEST_FAIL_MESSAGE(name);
    return 0;
}

static inline double bench_loop_value(const struct infer_bench *b, const char *name, unsigned k)
{
    char whole[24];
    (void)snprintf(whole, sizeof whole, "%s_%u", name, k + 1u);
    return bench_value(b, whole);
}

/* A loop k whose spans, slopes and gains are simple: T1 and T2 -4..4, u -2..2, all at rest at 0. */
static inline void bench_plain_loop(struct infer_bench *b, unsigned k, enum inferential_law law,
                                    double a1, double a2)
{
    struct inferential_settings *c = &b->settings;
    c->law[k] = (uint8_t)law;
    c->a[k][PRIMARY] = (float)a1;
    c->a[k][SECONDARY] = (float)a2;
    c->kc[k] = 2;
    c->kc2[k] = 4;
    c->ko[k] = 20;
    b->setup.pv[k] = (struct block_signal){.lo = -4, .hi = 4};
    b->setup.input[b->seconds + k].lo = -2;
    b->setup.input[b->seconds + k].hi = 2;
    if (k < b->seconds) {
        b->setup.input[k] = (struct block_signal){.lo = -4, .hi = 4};
        b->second_of[k] = k;
    }
    b->plant[k] = (struct bench_plant){.a = {a1, a2}, .u = 2, .hi = 4, .load = {-2 * a1, -2 * a2}};
    /* Else both temperatures would be one thermometer. */
    b->plant[k].t[1] = 0.5;
}

/* One such loop, in steps of so many seconds. */
static inline void bench_plain(struct infer_bench *b, enum inferential_law law,
                               enum inferential_form form, double step_s)
{
    memset(b, 0, sizeof *b);
    bench_defaults(&b->settings);
    bench_wire(b, 1, law >= LAW_CASCADE, (float)step_s);
    bench_plain_loop(b, 0, law, 1, 2);
    b->settings.form = (uint8_t)form;
}

/* At rest, then it acts. */
static inline void bench_begin(struct infer_bench *b)
{
    bench_configure(b, false);
    bench_follow(b);
    b->io.members.acting = b->setup.present;
}

static inline void bench_cycle(struct infer_bench *b)
{
    bench_step(b);
    bench_apply(b);
    bench_go_on(b);
}

static inline void bench_cycles(struct infer_bench *b, unsigned n)
{
    while (n--)
        bench_cycle(b);
}

#endif
