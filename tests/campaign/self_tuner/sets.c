/* Sets of plants. Those of the acceptance and the named ones are given; `choose` and `confirm` are drawn from a seed. */
#include <math.h>
#include <stdio.h>

#include "self_tuner.h"

/* SIMC with the half rule; half a step of the controller is dead time. */
static void give_simc(struct tuner_case *c, unsigned i, const struct element_spec *e)
{
    double tau = e->t1 + e->t2 / 2;
    double theta = e->dead + e->t2 / 2 + e->zero + c->step_s / 2 + 2 * e->damping * e->resonance_s;
    c->pi_gain[i] = (float)(tau / (e->gain * 2 * theta));
    c->pi_ti_s[i] = (float)fmin(tau, 8 * theta);
    if (c->move_s < 10 * (fmin(tau, 8 * theta) + 2 * theta))
        c->move_s = 10 * (fmin(tau, 8 * theta) + 2 * theta);
}

static unsigned delay_of(const struct tuner_case *c, const struct element_spec *e,
                         enum delay_rule rule)
{
    double dead =
        e->dead + (rule == DELAY_DEAD ? 0 : e->zero) + (rule == DELAY_ALL ? e->t2 / 2 : 0);
    return 1u + (unsigned)ceil(dead / c->step_s - 1e-9);
}

/* One loop around its element. False: its delay is more than 8 steps. */
static bool finish(struct tuner_case *c, enum delay_rule rule, double noise)
{
    const struct element_spec *e = &c->plant.element[0][0];
    c->plant.loops = 1;
    c->plant.noise[0] = noise;
    c->size = 0.1;
    c->move_s = fmax(c->move_s, 900);
    c->delay[0][0] = delay_of(c, e, rule);
    give_simc(c, 0, e);
    return c->delay[0][0] <= GMV_DELAY_MAX;
}

static bool grid_case(unsigned n, enum delay_rule rule, double noise, struct tuner_case *c)
{
    static const double lag[] = {0, 30, 60, 120}, dead[] = {0, 15, 30, 60}, zero[] = {0, 30, 60},
                        step[] = {10, 20, 30};
    unsigned at = 0;
    for (unsigned s = 0; s < 3; s++)
        for (unsigned l = 0; l < 4; l++)
            for (unsigned d = 0; d < 4; d++)
                for (unsigned z = 0; z < (l ? 3u : 1u); z++) {
                    memset(c, 0, sizeof *c);
                    c->step_s = step[s];
                    c->plant.element[0][0] = (struct element_spec){
                        .gain = 1, .t1 = 120, .t2 = lag[l], .dead = dead[d], .zero = zero[z]};
                    c->seed = 1000u + at;
                    (void)snprintf(c->name, sizeof c->name, "lag %g dead %g zero %g step %g",
                                   lag[l], dead[d], zero[z], step[s]);
                    if (finish(c, rule, noise) && at++ == n)
                        return true;
                }
    return false;
}

static double log_uniform(struct random_source *r, double lo, double hi)
{
    return exp(random_uniform(r, log(lo), log(hi)));
}

/* Every third plant has no second lag, every other one has a zero, and half of all have loads. */
static bool drawn_case(unsigned n, uint64_t seed, enum delay_rule rule, double slowest,
                       struct tuner_case *c)
{
    if (n >= 150)
        return false;
    for (uint64_t again = 0;; again++) {
        struct random_source r = {.state = seed * 1000003u + (uint64_t)n * 101u + again};
        memset(c, 0, sizeof *c);
        struct element_spec *e = &c->plant.element[0][0];
        e->t1 = log_uniform(&r, slowest / 10, slowest);
        e->t2 = n % 3 ? e->t1 * random_uniform(&r, 0.1, 1) : 0;
        e->zero = n % 3 == 2 ? e->t1 * random_uniform(&r, 0.1, 0.6) : 0;
        e->dead = n % 4 ? floor(e->t1 * random_uniform(&r, 0.05, 0.7)) : 0;
        e->gain = log_uniform(&r, 0.3, 3) * (n & 1u ? -1 : 1);
        c->step_s = ceil((e->t1 + e->t2) / random_uniform(&r, 5, 20));
        c->schedule = n & 1u ? WEEK_LOADS : WEEK;
        c->seed = random_next(&r);
        double noise = log_uniform(&r, 0.0005, 0.005);
        (void)snprintf(
            c->name, sizeof c->name, "%s%.0f %.0f dead %.0f zero %.0f step %.0f k %.2g n %.2g",
            n & 1u ? "L " : "", e->t1, e->t2, e->dead, e->zero, c->step_s, e->gain, noise);
        if (finish(c, rule, noise))
            return true;
    }
}

static bool named_case(unsigned n, uint64_t seed, struct tuner_case *c)
{
    struct element_spec *e = &c->plant.element[0][0];
    memset(c, 0, sizeof *c);
    *e = (struct element_spec){.gain = 1, .t1 = 120};
    c->step_s = 30;
    c->seed = seed * 77u + n;
    double noise = 0.002;
    const char *name = "";
    switch (n) {
    case 0:
        name = "first order noise 0.5 %";
        noise = 0.005;
        break;
    case 1:
        name = "inverse response";
        e->t2 = e->zero = 60;
        c->step_s = 10;
        break;
    case 2:
        name = "positional dead time 30 to 90 s";
        e->dead = 30;
        c->positional = true;
        c->plant.late_from_s = 1.5 * 86400;
        c->plant.late_s = 90;
        break;
    case 3:
        name = "incremental dead time 30 to 90 s";
        e->dead = 30;
        c->plant.late_from_s = 1.5 * 86400;
        c->plant.late_s = 90;
        break;
    case 4:
        name = "dead band 3 %";
        e->dead = 30;
        c->plant.stuck = 0.03;
        break;
    case 5:
        name = "resonance";
        e->resonance_s = 15;
        e->damping = 0.15;
        c->step_s = 10;
        break;
    case 6:
    case 7:
        name = n == 6 ? "gain times 2.5" : "gain times 0.4";
        e->dead = 30;
        c->plant.gain_from_s = 1.5 * 86400;
        c->plant.gain_times = n == 6 ? 2.5 : 0.4;
        break;
    case 8:
        name = "first order noise 0.5 % a third of the PI's gain";
        noise = 0.005;
        break;
    default:
        return false;
    }
    (void)snprintf(c->name, sizeof c->name, "%s", name);
    (void)finish(c, DELAY_DEAD, noise);
    if (n == 8)
        c->pi_gain[0] /= 3;
    if (n == 1)
        c->delay[0][0] = 6;
    return true;
}

/* Wood and Berry's column, and two loops drawn. */
static bool pair_case(unsigned n, uint64_t seed, struct tuner_case *c)
{
    if (n >= 20)
        return false;
    memset(c, 0, sizeof *c);
    struct random_source r = {.state = seed * 31u + n};
    c->plant.loops = 2;
    c->seed = random_next(&r);
    c->size = 0.05;
    if (n == 0) {
        static const double k[2][2] = {{12.8, -18.9}, {6.6, -19.4}},
                            t[2][2] = {{16.7, 21}, {10.9, 14.4}}, d[2][2] = {{1, 3}, {7, 3}},
                            span[2] = {32, 40};
        c->step_s = 60;
        for (unsigned i = 0; i < 2; i++)
            for (unsigned j = 0; j < 2; j++) {
                c->plant.element[i][j] = (struct element_spec){
                    .gain = k[i][j] * 4 / span[i], .t1 = 60 * t[i][j], .dead = 60 * d[i][j]};
                c->delay[i][j] = 1u + (unsigned)d[i][j];
            }
        c->pi_gain[0] = 3;
        c->pi_gain[1] = -0.75f;
        c->pi_ti_s[0] = 498;
        c->pi_ti_s[1] = 1416;
        c->plant.noise[0] = c->plant.noise[1] = 0.003;
        c->move_s = 14400;
        (void)snprintf(c->name, sizeof c->name, "Wood and Berry");
        return true;
    }
    c->step_s = floor(random_uniform(&r, 20, 60));
    for (unsigned i = 0; i < 2; i++)
        for (unsigned j = 0; j < 2; j++)
            c->plant.element[i][j] = (struct element_spec){
                .gain = log_uniform(&r, 0.5, 2) * (i == j ? 1 : random_uniform(&r, -0.6, 0.6)),
                .t1 = c->step_s * random_uniform(&r, 5, 20),
                .dead = floor(c->step_s * random_uniform(&r, 0, 3))};
    for (unsigned i = 0; i < 2; i++) {
        give_simc(c, i, &c->plant.element[i][i]);
        c->pi_gain[i] /= 1.5f; /* detuned for each other */
        c->plant.noise[i] = log_uniform(&r, 0.0005, 0.004);
        for (unsigned j = 0; j < 2; j++) {
            unsigned own = delay_of(c, &c->plant.element[i][i], DELAY_DEAD);
            c->delay[i][j] = delay_of(c, &c->plant.element[i][j], DELAY_DEAD);
            c->delay[i][j] = c->delay[i][j] < own ? own : c->delay[i][j];
        }
    }
    (void)snprintf(c->name, sizeof c->name, "pair %u", n);
    return true;
}

bool case_of(const char *set, unsigned n, uint64_t seed, enum delay_rule rule, struct tuner_case *c)
{
    size_t length = strcspn(set, "-");
    bool there = false;
    if (strncmp(set, "grid", length) == 0)
        there = grid_case(n, rule, 0.0005, c);
    else if (strncmp(set, "noisy", length) == 0)
        there = grid_case(n, rule, 0.002, c);
    else if (strncmp(set, "choose", length) == 0)
        there = drawn_case(n, seed, rule, 600, c);
    else if (strncmp(set, "confirm", length) == 0)
        there = drawn_case(n, seed + 99u, rule, 3000, c);
    else if (strncmp(set, "named", length) == 0)
        there = named_case(n, seed, c);
    else if (strncmp(set, "pairs", length) == 0)
        there = pair_case(n, seed, c);
    if (strcmp(set + length, "-rest") == 0)
        c->schedule = WEEK_REST;
    return there;
}
