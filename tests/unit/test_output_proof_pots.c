/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
/* Pots drawn at random, of which only the settings of the proof are known: thousands of hours without a false word, and faults within their
 * bounds (io/output_proof.h). The worst of each fault is printed. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/output_proof.h"
#include "random_source.h"
#include "unity.h"

#define SEED       38u
#define POTS       60u
#define HOURS      20.0 /* of use of each pot, without days of rest */
#define FAULTS     400u
#define DAY_S      86400.0
#define AMBIENT    20.0
#define SWING      8.0 /* K, from day to night */
#define LIMIT_GAP  8.0 /* K that the limit is below the boil */
#define TAKES_MORE 1.5 /* times what the settings allow for over what the pot needs */

static struct random_source random_of_test;

struct pot {
    double full;       /* K/s of the full heater */
    double loss_s;     /* time constant of its losses */
    double lag_s;      /* of the metal of its heater */
    double boil;       /* degC */
    double noise;      /* K */
    double tick_s;     /* s between samples */
    bool loses;        /* some readings; all times begin anew then */
    double t, heat, s; /* degC; part of the power that comes out; s since the beginning */
    struct proof_config c;
    struct output_proof proof;
};

static double between(double lo, double hi)
{
    return lo + (hi - lo) * (double)(random_next(&random_of_test) >> 11) / 9007199254740992.0;
}

static double log_between(double lo, double hi)
{
    return exp(between(log(lo), log(hi)));
}

static double noise_of(const struct pot *p)
{
    double sum = -6.0;
    for (unsigned i = 0; i < 12; i++)
        sum += between(0.0, 1.0);
    return round((p->t + sum * p->noise) / 0.03125) * 0.03125;
}

/* The settings that somebody finds who knows how slowly the pot warms just below the limit, and cools there. */
static bool find_settings(struct pot *p)
{
    double limit = floor(p->boil - LIMIT_GAP), change = fmax(2.0, 14.0 * p->noise);
    double hot = limit - (AMBIENT - SWING), warm = limit - change - (AMBIENT + SWING);
    double warms = (0.75 * p->full - hot / p->loss_s), drift = SWING * 2.0 * M_PI / DAY_S;
    if (warm <= 5.0 || warms <= 0.2 * p->full)
        return false;
    for (unsigned i = 0; i < 20; i++) {
        double on = TAKES_MORE * ((change + 8.0 * p->noise) / warms + 4.0 * p->lag_s + p->tick_s);
        double off = TAKES_MORE * ((change + 8.0 * p->noise) * p->loss_s / warm + 4.0 * p->lag_s);
        if (on > 60000.0 || off > 60000.0)
            return false;
        p->c = (struct proof_config){.change = (float)change,
                                     .on_s = (uint16_t)ceil(on),
                                     .off_s = (uint16_t)ceil(off),
                                     .limit = (uint16_t)limit,
                                     .kind = PROOF_KIND_WARMS,
                                     .device = 1};
        if (change >= 2.0 * drift * on + 10.0 * p->noise)
            return true;
        change *= 1.3; /* what days do in this time must not count */
        warm = limit - change - (AMBIENT + SWING);
        if (warm <= 5.0)
            return false;
    }
    return false;
}

static struct pot draw(void)
{
    struct pot p;
    do {
        p = (struct pot){.full = log_between(0.02, 0.3),
                         .lag_s = log_between(3.0, 60.0),
                         .boil = between(60.0, 115.0),
                         .noise = log_between(0.01, 0.3),
                         .tick_s = round(between(1.0, 5.0))};
        p.loss_s = (p.boil - AMBIENT + SWING) / (0.75 * p.full) * between(1.3, 8.0);
        p.t = AMBIENT;
    } while (!find_settings(&p));
    return p;
}

/* A sample later; the heater really gives `power`, and is said to be at `part`. */
static enum output_proof_fault sample_later(struct pot *p, double power, double part)
{
    double step = 1.0;
    for (double passed = 0.0; passed < p->tick_s; passed += step) {
        double ambient = AMBIENT + SWING * sin(2.0 * M_PI * p->s / DAY_S);
        p->heat += (power - p->heat) * (1.0 - exp(-step / p->lag_s));
        p->t += step * (p->full * p->heat - (p->t - ambient) / p->loss_s);
        p->t = fmin(p->t, p->boil);
        p->s += step;
    }
    struct output_proof_look look = {.part = (float)part,
                                     .reading = (float)noise_of(p),
                                     .usable =
                                         !p->loses || random_below(&random_of_test, 2000) != 0,
                                     .since_ms = (uint32_t)(p->tick_s * 1000.0)};
    return output_proof_step(&p->proof, &p->c, &look);
}

static void fails(const struct pot *p, const char *what, enum output_proof_fault fault)
{
    char text[320];
    snprintf(text, sizeof text,
             "seed %u, %s: %s; at %.0f s %.2f degC; full %g K/s, losses %g s, lag %g s, boil %g, "
             "noise %g, change %g, on %u, off %u, limit %u",
             SEED, what, output_proof_text((uint8_t)fault), p->s, p->t, p->full, p->loss_s,
             p->lag_s, p->boil, p->noise, (double)p->c.change, p->c.on_s, p->c.off_s, p->c.limit);
    TEST_FAIL_MESSAGE(text);
}

void setUp(void)
{
    random_of_test = (struct random_source){SEED};
}

void tearDown(void) {}

/* ---- no false word ---- */

enum use { FULL_ON, PARTLY_ON, OFF, OFF_FOR_DAYS, HELD, SWITCHED, CHARGED, POURED, USES };

/* Uses the pot like this for a while. */
static void use(struct pot *p, enum use how)
{
    double until = p->s + log_between(20.0, 20000.0), set = between(AMBIENT, p->boil + 5.0);
    double part = how == PARTLY_ON ? between(0.02, 0.74) : between(0.75, 1.0), sum = 0.0;
    if (how == OFF_FOR_DAYS)
        until = p->s + between(0.3, 3.0) * DAY_S;
    if (how == CHARGED) /* something cold comes in for a fifth of the time that the heater has */
        until = p->s + 0.2 * p->c.on_s;
    if (how == POURED) /* something warm, within half of that time */
        until = p->s + between(0.0, 0.5) * p->c.on_s - 2.0 * p->tick_s;
    double pour = (set - p->t) * p->tick_s / (until - p->s);
    while (p->s < until) {
        double u = how == OFF || how == OFF_FOR_DAYS || how == POURED ? 0.0 : part;
        if (how == HELD) {
            sum = fmin(fmax(sum + (set - p->t) * p->tick_s * 1e-4, 0.0), 1.0);
            u = fmin(fmax((set - p->t) * 0.1 + sum, 0.0), 1.0);
        }
        if (how == SWITCHED)
            u = p->t < set ? 1.0 : 0.0;
        if (how == CHARGED)
            p->t = fmax(p->t - p->tick_s * 30.0 / (0.2 * p->c.on_s), 10.0);
        if (how == POURED)
            p->t = fmin(p->t + pour, p->boil);
        enum output_proof_fault fault = sample_later(p, u, u);
        if (fault != PROOF_FINE)
            fails(p, "false alarm", fault);
    }
}

static void pots_that_are_well_are_never_accused(void)
{
    double hours = 0.0, rest = 0.0;
    for (unsigned i = 0; i < POTS; i++) {
        struct pot p = draw();
        double rest_s = 0.0;
        p.loses = true;
        while (p.s - rest_s < HOURS * 3600.0) {
            enum use how = (enum use)random_below(&random_of_test, USES);
            double before_s = p.s;
            use(&p, how);
            rest_s += how == OFF_FOR_DAYS ? p.s - before_s : 0.0;
            if (how == CHARGED)
                use(&p, FULL_ON);
            if (how == POURED)
                use(&p, OFF);
        }
        hours += p.s / 3600.0;
        rest += rest_s / 3600.0;
    }
    printf("no false alarm in %.0f h of %u pots in use and %.0f h of them at rest\n", hours - rest,
           POTS, rest);
}

/* ---- faults ---- */

static struct {
    unsigned n;
    double worst; /* part of the bound */
    double longest_s;
} found[PROOF_FAULTS];

static void note(const struct pot *p, enum output_proof_fault fault, double took_s, double bound_s)
{
    took_s -= 2.0 * p->tick_s;
    if (took_s > bound_s)
        fails(p, "later than its bound", fault);
    found[fault].n++;
    found[fault].worst = fmax(found[fault].worst, took_s / bound_s);
    found[fault].longest_s = fmax(found[fault].longest_s, took_s);
}

/* Brings the pot to t with its heater well, and leaves it there for a while with part of its power or none. */
static void bring_to(struct pot *p, double t, bool off)
{
    while (p->t < t)
        (void)sample_later(p, 1.0, 1.0);
    double until = p->s + between(0.0, 2.0) * p->c.on_s;
    while (p->s < until)
        (void)sample_later(p, off ? 0.0 : 1.0, off ? 0.0 : 1.0);
}

static void dead_heaters_are_told_within_their_bound(void)
{
    for (unsigned i = 0; i < FAULTS; i++) {
        struct pot p = draw();
        bring_to(&p, between(AMBIENT, p.boil - 0.5), false);
        enum output_proof_fault fault = PROOF_FINE;
        double from = p.s;
        while (fault == PROOF_FINE) {
            fault = sample_later(&p, 0.0, 1.0);
            if (p.t >= p.c.limit - 6.0 * p.noise)
                from = p.s; /* liquid might boil */
            if ((p.t - AMBIENT + SWING) / p.loss_s * p.c.on_s > p.c.change - 10.0 * p.noise)
                from = p.s; /* it cools as fast as if something cold came in */
            if (p.s - from > 10.0 * p.c.on_s)
                fails(&p, "never told", PROOF_NO_HEAT);
        }
        TEST_ASSERT_EQUAL_INT(PROOF_NO_HEAT, fault);
        note(&p, fault, p.s - from, 2.0 * p.c.on_s);
    }
}

static void heaters_stuck_on_are_told_within_their_bound(void)
{
    for (unsigned i = 0; i < FAULTS; i++) {
        struct pot p = draw();
        bool off = random_below(&random_of_test, 2) != 0;
        double rest = off ? between(1.0, 4.0) * p.c.on_s : 0.0;
        bring_to(&p, between(AMBIENT, p.boil - 0.5), off);
        while (rest > 0.0 && p.t < p.boil) {
            TEST_ASSERT_EQUAL_INT(PROOF_FINE, sample_later(&p, 0.0, 0.0));
            rest -= p.tick_s;
        }
        bool cold = p.t < p.c.limit;
        enum output_proof_fault fault = PROOF_FINE;
        double from = p.s, limit_at = p.s;
        while (fault == PROOF_FINE) {
            fault = sample_later(&p, 1.0, 0.0);
            if (p.t < p.c.limit + 6.0 * p.noise)
                limit_at = p.s;
            if (p.s - from > 10.0 * (p.c.on_s + p.c.off_s))
                fails(&p, "never told", PROOF_WARMS);
        }
        if (fault == PROOF_WARMS) {
            TEST_ASSERT_TRUE(cold);
            note(&p, fault, p.s - from, 3.0 * p.c.on_s);
        } else {
            TEST_ASSERT_EQUAL_INT(PROOF_NOT_COOLING, fault);
            note(&p, fault, p.s - limit_at, p.c.off_s);
        }
        /* The contactor opens; or it does not. */
        bool welded = random_below(&random_of_test, 2) != 0;
        from = p.s;
        double bound = welded && p.t >= p.c.limit ? p.c.off_s : 3.0 * p.c.on_s + p.c.off_s;
        while (fault != PROOF_STILL_HOT && p.s - from < 3.0 * bound)
            fault = sample_later(&p, welded ? 1.0 : 0.0, 0.0);
        TEST_ASSERT_EQUAL_INT(welded, fault == PROOF_STILL_HOT);
        if (welded)
            note(&p, fault, p.s - from, bound);
    }
}

static void print_found(void)
{
    for (unsigned i = 0; i < PROOF_FAULTS; i++)
        if (found[i].n != 0)
            printf("%4u x %-60.60s latest at %3.0f %% of its bound, %.0f s\n", found[i].n,
                   output_proof_text((uint8_t)i), 100.0 * found[i].worst, found[i].longest_s);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(pots_that_are_well_are_never_accused);
    RUN_TEST(dead_heaters_are_told_within_their_bound);
    RUN_TEST(heaters_stuck_on_are_told_within_their_bound);
    print_found();
    return UNITY_END();
}
