/* Counts the instructions of recursive least squares in several forms, of the self-tuner and of tray temperature control, on
 * the emulated STM32F405, whose timer counts one for each instruction (machine.c). Every figure is over 200 samples after the first 20; reading the counter
 * is taken off. */
#include <stdalign.h>
#include <stdbool.h>
#include <string.h>

#include "cost.h"
#include "identify/rls.h"
#include "num/ud_num.h"

#define SAMPLES 220u
#define FIRST   20u

static num_t phi[RLS_MAX];

static void next_sample(unsigned n)
{
    for (unsigned i = 0; i + 1 < n; i++)
        phi[i] = num_from_float(cost_random());
    phi[n - 1] = num_one();
}

static void cost_of_rls(unsigned n)
{
    static alignas(8) char memory[3000];
    static float p0[RLS_MAX];
    static num_t theta[RLS_MAX];
    struct rls *r = (struct rls *)(void *)memory;
    struct rls_settings s;
    struct cost cost = {0};
    memset(&s, 0, sizeof s);
    for (unsigned i = 0; i < n; i++)
        p0[i] = 100;
    s.n = (uint8_t)n;
    s.p0 = p0;
    s.forget = 0.98f;
    s.forget_least = 0.2f;
    s.sigma0 = s.memory = s.trace = 1;
    rls_init(r, &s, theta);
    for (unsigned t = 0; t < SAMPLES; t++) {
        next_sample(n);
        num_t y = num_from_float(cost_random());
        uint32_t from = cost_now();
        (void)rls_step(r, phi, y, true);
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&cost, from, to);
    }
    cost_say("step", n, cost.sum / cost.count, cost.most, rls_bytes(n));
}

static void cost_of_update(unsigned n)
{
    static ud_cell_t ud[RLS_MAX * (RLS_MAX + 1) / 2 + 2 * RLS_MAX];
    static scaled_t f[RLS_MAX], g[RLS_MAX];
    struct cost cost = {0};
    scaled_t v = scaled_from_float(0.98f), growth = scaled_from_float(1 / 0.98f);
    for (unsigned i = 0; i < n; i++)
        f[i] = scaled_from_float(100);
    ud_num_set_diagonal(ud, n, f);
    for (unsigned t = 0; t < SAMPLES; t++) {
        next_sample(n);
        uint32_t from = cost_now();
        ud_num_project(ud, n, phi, f, g);
        (void)ud_num_correct(ud, n, f, g, v, growth);
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&cost, from, to);
    }
    cost_say("update", n, cost.sum / cost.count, cost.most,
             (uint32_t)(ud_num_cells(n) * sizeof(ud_cell_t)));
}

#ifndef REFLUX_FIXED_POINT
static void cost_of_form(const char *what, unsigned n,
                         float (*form)(float *, size_t, const float *, float, float *))
{
    static float p[RLS_MAX * RLS_MAX], gain[RLS_MAX];
    struct cost cost = {0};
    memset(p, 0, sizeof p);
    for (unsigned i = 0; i < n; i++)
        p[i * n + i] = 100;
    for (unsigned t = 0; t < SAMPLES; t++) {
        next_sample(n);
        uint32_t from = cost_now();
        (void)form(p, n, phi, 0.98f, gain);
        uint32_t to = cost_now();
        if (t >= FIRST)
            cost_add(&cost, from, to);
    }
    cost_say(what, n, cost.sum / cost.count, cost.most, (uint32_t)(n * n * sizeof(float)));
}
#endif

int main(void)
{
    static const unsigned sizes[] = {6, 9, 12, 24};
    for (unsigned k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        cost_seed(1);
        cost_of_update(sizes[k]);
        cost_seed(1);
        cost_of_rls(sizes[k]);
#ifndef REFLUX_FIXED_POINT
        cost_seed(1);
        cost_of_form("covariance", sizes[k], covariance_form);
        cost_seed(1);
        cost_of_form("joseph", sizes[k], joseph_form);
        cost_seed(1);
        cost_of_form("dense", sizes[k], dense_form);
#endif
    }
    cost_of_tuners();
    cost_of_trays();
    cost_say("done", 0, 0, 0, 0);
    for (;;) {
    }
}
