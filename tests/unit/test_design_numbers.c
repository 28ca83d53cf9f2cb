/* Every number of the design of loops on small plants, five digits each: settings and how far they had to be slowed, with and
 * without a decoupler, noise, parts and models of a beginning; the stability curve for other gains and limits; predicted
 * steps; and decouplers whose elements, relative gains or errors come near their bounds.
 *
 * Kept in reference/design_numbers.txt; how it is made anew: support/kept_transcript.h. How right the numbers have to be say
 * test_loops.c, test_detune.c and test_tuning.c.
 */
#include <math.h>
#include <string.h>

#include "design/detune.h"
#include "design/static_decoupler.h"
#include "design/trial.h"
#include "kept_transcript.h"
#include "random_source.h"
#include "unity.h"

#define SEED   20261122u
#define PLANTS 24

static struct interact_plant plant;
static struct pairs pairs;
static real_t interval;
static struct detune detune;
static struct nyquist nyquist;
static struct trial trial;
static struct static_decoupler_work work;
static struct static_decoupler_result decoupler;
static struct interact_refusal reason;

void setUp(void) {}
void tearDown(void) {}

static double fraction(struct random_source *r)
{
    return (double)(random_next(r) >> 40) / 16777216.0;
}

/* Two to four outputs; gains of either sign, strong or weak beside the diagonal, lags and dead times near and far apart. */
static void make_plant(unsigned number)
{
    struct random_source r = {SEED + number};
    double beside = number % 4 == 0 ? 0.1 : number % 4 == 1 ? 0.5 : number % 4 == 2 ? 1.0 : 1.6;
    double spread = number % 3 == 0 ? 1.0 : number % 3 == 1 ? 5.0 : 40.0;
    memset(&plant, 0, sizeof plant);
    plant.outputs = plant.inputs = (uint8_t)(2 + number % 3);
    pairs.n = plant.outputs;
    for (uint8_t i = 0; i < plant.outputs; i++) {
        pairs.output[i] = i;
        pairs.input[i] = (uint8_t)((i + number / 2) % plant.outputs);
        for (uint8_t j = 0; j < plant.inputs; j++) {
            bool own = j == (i + number / 2) % plant.outputs;
            double gain = (2.0 * fraction(&r) - 1.0) * (own ? 1.0 : beside);
            if (own)
                gain += gain > 0 ? 0.8 : -0.8;
            double lag = 30.0 * pow(spread, fraction(&r)), dead = (2.0 + 10.0 * fraction(&r));
            if (number % 5 == 4)
                dead *= 5.0;
            if (number % 7 == 6 && i == 0)
                lag = 0.0;
            plant.element[i][j] = (struct fopdt){(real_t)gain, (real_t)dead, (real_t)lag};
            plant.gain_sd[i][j] = (real_t)(0.03 * fraction(&r));
        }
    }
    interval = (real_t)(number % 2 ? 1.0 : 4.0);
}

static void says_settings(const char *what, enum err err)
{
    kept_line("%s %d factor %.5g %.5g db %.5g at %.5g tried %u", what, err, (double)detune.factor,
              (double)detune.factor_least, (double)detune.log_modulus_db, (double)detune.omega,
              detune.tried);
    for (unsigned k = 0; k < pairs.n; k++) {
        const struct tuning *t = &detune.loops.tuning[k];
        kept_line("K %.5g Ti %.5g action %d model %.5g %.5g %.5g", (double)t->gain, (double)t->ti_s,
                  t->action, (double)detune.model[k].gain, (double)detune.model[k].dead_time_s,
                  (double)detune.model[k].time_constant_s);
    }
}

static enum err design(const struct detune_config *c, const struct matrix *d)
{
    enum err err = detune_begin(&detune, &plant, &pairs, interval, d, c, &reason);
    while (!err && (err = detune_step(&detune)) == ERR_BUSY)
        err = ERR_OK;
    return err;
}

static void says_curve(double times, double limit)
{
    enum err err = nyquist_begin(&nyquist, &plant, &detune.loops, (real_t)times, (real_t)limit);
    while (!err && (err = nyquist_step(&nyquist)) == ERR_BUSY)
        err = ERR_OK;
    kept_line("curve %.3g %.3g: %d stable %d db %.5g at %.5g points %u turns %d", times, limit, err,
              nyquist.stable, (double)nyquist.log_modulus_db, (double)nyquist.omega, nyquist.points,
              nyquist.turns);
}

static void says_trial(const struct trial_config *c)
{
    enum err err = trial_begin(&trial, &plant, &detune.loops, c);
    while (!err && (err = trial_step(&trial)) == ERR_BUSY)
        err = ERR_OK;
    kept_line("trial %d bounded %d coarse %d time %.5g step %.5g duration %.5g left %.4g iae %.5g",
              err, trial.bounded, trial.coarse, (double)trial.time_s, (double)trial.step_s,
              (double)trial.duration_s, (double)trial.mark.left, (double)trial.mark.iae);
    for (unsigned k = 0; k < pairs.n; k++)
        kept_line("iae %.5g peak %.4g settled %.5g moved %.5g by then %.5g %.5g",
                  (double)trial.loop[k].iae, (double)trial.loop[k].peak,
                  (double)trial.loop[k].settled_s, (double)trial.loop[k].moved,
                  (double)trial.mark.moved[k], (double)trial.mark.input[k]);
}

static enum err says_decoupler(const char *what, const struct static_decoupler_config *c)
{
    enum err err = static_decoupler(&plant, &pairs, c, &work, &decoupler, &reason);
    if (err) {
        kept_line("%s %d %s %d %d", what, err, reason.field, reason.output, reason.input);
        return err;
    }
    kept_line("%s left %.4g gains %.5g %.5g sd %.4g %.4g elements %.5g %.5g", what,
              (double)decoupler.left_sd, (double)decoupler.gain[0], (double)decoupler.gain[1],
              (double)decoupler.gain_sd[0], (double)decoupler.gain_sd[1],
              (double)decoupler.d.value[0][1], (double)decoupler.d.value[1][0]);
    return ERR_OK;
}

static void of_one_plant(unsigned number)
{
    struct detune_config c;
    struct static_decoupler_config s;
    detune_config_default(&c);
    static_decoupler_config_default(&s);
    make_plant(number);
    kept_line("# plant %u, %u loops", number, pairs.n);
    enum err err = design(&c, NULL);
    says_settings("plain", err);
    if (err && err != ERR_TIMEOUT)
        return;
    says_curve(1, INFINITY);
    says_curve(number % 2 ? 3 : 20, INFINITY);
    if (number % 3 == 0)
        says_curve(2, 4);
    struct trial_config t = {.loop = (uint8_t)(number % pairs.n),
                             .load = number % 4 == 1,
                             .size = (real_t)(number % 5 == 2 ? -0.1 : 0.05),
                             .duration_s = (real_t)(number % 3 == 1 ? 700 : 0),
                             .setpoint_weight = (real_t)(number % 2 ? 1.0 : 0.4),
                             .mark_s = (real_t)(number % 6 == 0 ? 0 : 150)};
    says_trial(&t);
    if (number % 2 == 0) {
        real_t noise[INTERACT_MAX];
        for (unsigned k = 0; k < pairs.n; k++)
            noise[k] = (real_t)(1e-3 * (1 + k));
        c.noise_sd = noise;
        c.noise_times = (real_t)(number % 4 ? 0.5 : 0.15);
        c.noise_least = REAL_C(1.5e-3);
        c.gain_hi = REAL_C(3.0);
        says_settings("noise", design(&c, NULL));
        detune_config_default(&c);
    } else {
        for (uint8_t k = 0; k < pairs.n; k++)
            c.part[k] = k;
        c.begins = 2;
        says_settings("parts", design(&c, NULL));
        detune_config_default(&c);
    }
    if (says_decoupler("decoupler", &s) == ERR_OK) {
        says_settings("decoupled", design(&c, &decoupler.d));
        says_curve(1.5, INFINITY);
    }
    for (unsigned k = 0; k < 5; k++) {
        static_decoupler_config_default(&s);
        s.element_hi = (real_t)(k == 0 ? 1.0 : 100.0);
        s.lambda_hi = (real_t)(k == 1 ? 1.2 : 10.0);
        s.significance = (real_t)(k == 2 ? 20.0 : 3.0);
        s.left_hi = (real_t)(k == 3 ? 0.02 : 0.3);
        s.floor = (real_t)(k == 4 ? 0.1 : 0.005);
        (void)says_decoupler("bounds", &s);
    }
}

/* A limit, a margin or a slowest factor that matters. */
static void of_other_wishes(void)
{
    struct detune_config c;
    for (unsigned k = 0; k < 12; k++) {
        detune_config_default(&c);
        make_plant(2 + k % 4);
        if (k < 3)
            c.db_per_loop = (real_t)(0.3 + 0.5 * k);
        else if (k < 6)
            c.db_most = (real_t)(0.5 * k);
        else if (k < 9)
            c.gain_margin = (real_t)(k - 4);
        else
            c.factor_hi = (real_t)(1.0 + 0.3 * (k - 9));
        kept_line("# wish %u", k);
        says_settings("wish", design(&c, NULL));
    }
    for (unsigned k = 0; k < 6;
         k++) { /* settings that are too fast, and dead times that are long */
        struct trial_config t = {.size = REAL_C(0.1), .setpoint_weight = REAL_C(1.0)};
        detune_config_default(&c);
        make_plant(3);
        says_settings("again", design(&c, NULL));
        detune.loops.tuning[0].gain *= (real_t)(1u << k);
        if (k > 3)
            plant.element[0][pairs.input[0]].dead_time_s = (real_t)(k == 4 ? 300.0 : 3e4);
        t.duration_s = (real_t)(k == 2 ? 2e4 : 0.0);
        says_curve(1, INFINITY);
        says_trial(&t);
    }
}

static void the_numbers_of_design_are_the_ones_kept(void)
{
    kept_open("reference/design_numbers.txt");
    for (unsigned number = 0; number < PLANTS; number++)
        of_one_plant(number);
    of_other_wishes();
    kept_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_numbers_of_design_are_the_ones_kept);
    return UNITY_END();
}
