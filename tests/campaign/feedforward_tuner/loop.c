#include "loop.h"

#include <math.h>
#include <string.h>

#include "block_defaults.h"

#define SIZE 0.05 /* of the disturbance, fraction of span */

static double normal(struct random_source *r)
{
    double u = ((double)(random_next(r) >> 11) + 0.5) / 9007199254740992.0;
    double v = (double)(random_next(r) >> 11) / 9007199254740992.0;
    return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

static double path_tick(struct path_state *s, const struct path *p, double u)
{
    memmove(s->u + 1, s->u, (PATH_DEAD_MOST - 1u) * sizeof s->u[0]);
    s->u[0] = u;
    double in = p->gain * s->u[p->dead];
    if (p->integrates)
        return s->x[0] += in;
    s->x[0] += (1 - exp(-1 / p->lag)) * (in - s->x[0]);
    if (p->lag2 <= 0)
        return s->x[0];
    return s->x[1] += (1 - exp(-1 / p->lag2)) * (s->x[0] - s->x[1]);
}

/* ---- the disturbance ---- */

static void move_disturbance(struct loop *l)
{
    if (!l->moves)
        return;
    if (random_next(&l->random) % 200u == 0)
        l->telegraph = -l->telegraph;
    l->coloured += (normal(&l->random) * sqrt(2.0 / 100) - l->coloured / 100) * SIZE / 0.05;
    if (l->given.disturbance == SQUARE)
        l->d = l->t / 150u % 2u ? -SIZE : SIZE;
    else
        l->d = SIZE * (l->given.disturbance == TELEGRAPH ? l->telegraph : l->coloured);
}

/* ---- the block ---- */

struct tune_parts loop_block(struct loop *l)
{
    return tune_parts_of((struct tune *)(void *)l->state);
}

/* The PI that SIMC gives: with a closed loop as fast as the dead time, three ticks at least. */
static void tune_pi(struct loop *l)
{
    const struct path *p = &l->given.process;
    double second = p->integrates ? 0 : p->lag2 / 2;
    double dead = (double)p->dead + second > 3 ? (double)p->dead + second : 3;
    double slope = p->integrates ? p->gain : p->gain / (p->lag + second);
    l->gain = 1 / (slope * 2 * dead);
    l->ti = p->integrates || p->lag + second > 8 * dead ? 8 * dead : p->lag + second;
}

bool loop_begin(struct loop *l, const struct loop_case *of, uint64_t seed)
{
    struct block_fault fault;
    memset(l, 0, sizeof *l);
    l->given = *of;
    l->random.state = seed;
    l->telegraph = 1;
    l->moves = true;
    tune_pi(l);
    block_put_defaults(&l->settings, &feedforward_tune_kind);
    struct tune_settings *s = &l->settings;
    s->method = of->method;
    s->gain = (float)l->gain;
    s->ti_s = (float)l->ti;
    s->check_s = of->check_s;
    s->step = (float)of->step;
    s->step_period_s = 400;
    s->adopt = TUNE_ADOPT_AT_ONCE;
    s->lag_most_s = 60;
    s->dead_most_s = 20;
    l->setup = (struct block_setup){
        .settings = s, .interval_s = 1, .members = 1, .present = 1, .inputs = 2};
    l->setup.member[0] = (struct block_member){.drives_mv = true, .pv_span = 1, .out_reach = 1};
    l->setup.pv[0] = l->setup.input[0] = l->setup.input[1] =
        (struct block_signal){.lo = 0, .hi = 1};
    l->applied[0] = (struct applied_history *)(void *)l->history;
    applied_history_begin((struct applied_history *)(void *)l->history, 4, num_zero());
    l->io = (struct block_io){.members.setpoint = &l->setpoint,
                              .members.in = &l->in,
                              .members.out = &l->out,
                              .members.clamp = &l->clamp,
                              .members.limited = &l->limited,
                              .inputs.value = l->input,
                              .inputs.quality = l->quality,
                              .inputs.age_s = l->age_s,
                              .requests.event_value = l->event_value,
                              .members.applied = l->applied,
                              .requests.excite = l->excite,
                              .members.divisor = 1,
                              .members.acting = 1};
    return feedforward_tune_kind.check(&l->setup, &fault) == ERR_OK &&
           feedforward_tune_kind.bytes(&l->setup) <= sizeof l->state &&
           feedforward_tune_kind.configure(l->state, &l->setup, false) == ERR_OK;
}

void loop_verb(struct loop *l, const char *name)
{
    for (unsigned k = 0; k < feedforward_tune_kind.verbs; k++)
        if (strcmp(feedforward_tune_kind.verb[k].name, name) == 0)
            (void)feedforward_tune_kind.verb[k].run(l->state, NULL);
}

/* Proposals and switch-offs come into force with the next tick. Of each pair the block's own value is read. */
static void put_values(struct loop *l, const struct proposed_value *value, unsigned n)
{
    float *own[4] = {&l->settings.k, &l->settings.lead_s, &l->settings.lag_s, &l->settings.dead_s};
    for (unsigned i = 0; i < n; i++)
        for (unsigned k = 0; k < 4; k++)
            if (value[i].id == proposed_own((uint8_t)(TUNE_ID_K + k)))
                *own[k] = value[i].value;
    (void)feedforward_tune_kind.configure(l->state, &l->setup, true);
}

static void do_work(struct loop *l)
{
    if (l->io.requests.work_wanted && l->waiting && --l->waiting == 0) {
        while (feedforward_tune_kind.work(l->state)) {
        }
        l->io.requests.work_done = true;
        l->io.requests.work_wanted = false;
    }
}

static void block_tick(struct loop *l)
{
    if (l->t == 0)
        feedforward_tune_kind.follow(l->state, &l->io);
    do_work(l);
    l->proposal.n = l->off.n = 0;
    l->io.requests.proposal = &l->proposal;
    l->io.requests.switch_off = &l->off;
    l->io.requests.raised = l->io.requests.ask_work = 0;
    memset(l->excite, 0, sizeof l->excite);
    feedforward_tune_kind.step(l->state, &l->io);
    if (l->io.requests.ask_work && !l->io.requests.work_wanted) {
        l->waiting = l->io.requests.ask_work;
        l->io.requests.work_wanted = true;
    }
    l->io.requests.work_done = false;
    l->raised |= l->io.requests.raised;
    bool asked = l->excite[0].what == EXCITE_SETPOINT;
    l->excited = asked ? (double)num_to_float(l->excite[0].value) : 0;
    l->io.requests.excite_state = asked ? EXCITE_RUNS : EXCITE_OFF;
    feedforward_tune_kind.back_calculate(l->state, &l->io);
    if (l->off.n)
        put_values(l, l->off.value, l->off.n);
    else if (l->proposal.n)
        put_values(l, l->proposal.value, l->proposal.n);
}

/* ---- a tick ---- */

static double pi_tick(struct half *h, const struct loop *l, double r, double y)
{
    double e = r - y, u = l->gain * e + h->integral;
    h->integral += l->gain / l->ti * e;
    return u;
}

/* As kinds/leadlag/leadlag.h has it. */
static double element_tick(struct loop *l, double d)
{
    const struct tune_settings *s = &l->settings;
    unsigned whole = (unsigned)s->dead_s;
    double part = (double)s->dead_s - whole;
    memmove(l->delayed + 1, l->delayed, (PATH_DEAD_MOST - 1u) * sizeof l->delayed[0]);
    l->counted = fmin(fmax(l->counted, d - l->given.dead_band), d + l->given.dead_band);
    l->delayed[0] = l->counted;
    double late = l->delayed[whole] + part * (l->delayed[whole + 1u] - l->delayed[whole]);
    l->lead_lag +=
        (late - l->lead_lag + (double)s->lead_s * (late - l->before)) / ((double)s->lag_s + 1);
    l->before = late;
    return (double)s->k * l->lead_lag;
}

void loop_tick(struct loop *l)
{
    double noise = l->given.noise * normal(&l->random);
    double seen = l->d + l->given.disturbance_noise * normal(&l->random);
    double y = l->tuned.y + noise;
    double given = pi_tick(&l->tuned, l, l->excited, y);
    l->in = l->out = num_from_float((float)given);
    l->setpoint = num_from_float((float)l->excited);
    l->input[0] = num_from_float((float)y);
    l->input[1] = num_from_float((float)seen);
    block_tick(l);
    double applied = given + element_tick(l, seen);
    applied_history_append((struct applied_history *)(void *)l->history,
                           num_from_float((float)applied));
    double alone = pi_tick(&l->alone, l, 0, l->alone.y + noise);
    move_disturbance(l);
    l->tuned.y = path_tick(&l->tuned.process, &l->given.process, applied) +
                 path_tick(&l->tuned.path, &l->given.path, l->d);
    l->alone.y = path_tick(&l->alone.process, &l->given.process, alone) +
                 path_tick(&l->alone.path, &l->given.path, l->d);
    l->t++;
}
