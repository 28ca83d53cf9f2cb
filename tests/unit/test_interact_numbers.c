/* Guards the promise of docs/inside/proofs.md that tests notice nine in ten faults drawn from the code. Answers are compared with references
 * within bounds, and a changed threshold, weight or fall-back mostly stays within them. Here it moves a line.
 *
 * The lines are every number of the analysis of interaction on small plants, six digits each: gains as a whole, relative gains, pairings
 * with their draws, structure, ways across and cascades. Plants are dense, sparse, triangular, not square, singular or impossible, with
 * gains known well and badly, and with channels left out. test_interact.c, test_pairing.c and test_structure.c check how right the
 * numbers are.
 *
 * Kept in reference/interact_numbers.txt, which support/kept_transcript.h says how to write anew. */
#include <math.h>
#include <string.h>

#include "interact/cascade.h"
#include "interact/gains.h"
#include "interact/measure.h"
#include "interact/pairing.h"
#include "interact/rga.h"
#include "interact/structure.h"
#include "kept_transcript.h"
#include "random_source.h"
#include "unity.h"

#define SEED   20261122u
#define PLANTS 36
#define LARGE  3

static struct interact_plant plant;
static struct pairing pairing;
static struct gains gains;
static struct structure_work work;
static struct structure found;
static struct cascade cascades[INTERACT_MAX];

void setUp(void) {}
void tearDown(void) {}

static double fraction(struct random_source *r)
{
    return (double)(random_next(r) >> 40) / 16777216.0;
}

/* Kinds: 0 dense, 1 sparse, 2 triangular, 3 an output that follows another, 4 two rows alike, 5 hardly known. */
static void make_plant(unsigned number)
{
    struct random_source r = {SEED + number};
    unsigned kind = number % 6;
    memset(&plant, 0, sizeof plant);
    plant.outputs = (uint8_t)(number < PLANTS ? 2 + random_below(&r, 5) : 12);
    plant.inputs =
        (uint8_t)(number < PLANTS && number % 4 == 3 ? 2 + random_below(&r, 5) : plant.outputs);
    for (unsigned i = 0; i < plant.outputs; i++)
        for (unsigned j = 0; j < plant.inputs; j++) {
            double gain = 2.0 * fraction(&r) - 1.0, lag = 20 + 200 * fraction(&r);
            double dead = 2 + 30 * fraction(&r);
            if (i == j)
                gain += gain > 0 ? 1.0 : -1.0;
            if ((kind == 1 && i != j && fraction(&r) < 0.7) || (kind == 2 && j > i))
                gain *= 0.002;
            if (kind == 3 && i == 1) {
                gain = 0.7 * (double)plant.element[0][j].gain;
                lag = 90 + (double)plant.element[0][j].time_constant_s;
                dead = 10 + (double)plant.element[0][j].dead_time_s;
            }
            if (kind == 4 && i == 1)
                gain = (double)plant.element[0][j].gain;
            double sd = (kind == 5 ? 0.2 : 0.01) * (0.5 + fraction(&r));
            plant.element[i][j] = (struct fopdt){(real_t)gain, (real_t)dead, (real_t)lag};
            plant.gain_sd[i][j] = (real_t)sd;
        }
}

static void says(const char *what, const real_t *x, unsigned n)
{
    char text[300];
    size_t at = (size_t)snprintf(text, sizeof text, "%s", what);
    for (unsigned k = 0; k < n; k++)
        at += (size_t)snprintf(text + at, sizeof text - at, " %.6g", (double)x[k]);
    kept_line("%s", text);
}

static void says_gains(void)
{
    real_t x[INTERACT_MAX];
    enum err err = gains_begin(&gains, &plant, REAL_C(0.005));
    TEST_ASSERT_EQUAL_INT(ERR_OK, err);
    while ((err = gains_step(&gains)) == ERR_BUSY)
        ;
    unsigned n = plant.outputs < plant.inputs ? plant.outputs : plant.inputs;
    kept_line("gains %d rank %u exact %u condition %.4g scaled %.4g smallest %.6g", err, gains.rank,
              gains.rank_exact, fmin(1e6, (double)gains.condition),
              fmin(1e6, (double)gains.condition_scaled), (double)gains.smallest_in_sd);
    if (gains.rank_exact == n)
        says("singular", gains.singular, n);
    kept_line("null %d %d", gains_null_input(&gains, 0, x), gains_null_output(&gains, 0, x));
}

static void says_pairing(unsigned number)
{
    struct pairing_config c;
    pairing_config_default(&c);
    c.draws = 60;
    if (number % 5 == 4 && plant.outputs > 2)
        c.outputs_out = 2;
    if (number % 7 == 6 && plant.inputs > 2)
        c.inputs_out = 1;
    enum err err = pairing_begin(&pairing, &plant, &c, NULL);
    while (!err && (err = pairing_step(&pairing)) == ERR_BUSY)
        err = ERR_OK;
    const struct pairing *p = &pairing;
    kept_line("pairing %d verdict %d pairs %u index %.6g cost %.6g determinant %.6g", err,
              p->verdict, p->pairs.n, (double)p->niederlinski, (double)p->cost,
              (double)p->determinant);
    kept_line("negative %x %.6g probability %.6g integrity %.6g drawn %u none %u open %x %x",
              p->negative, (double)p->negative_index, (double)p->probability, (double)p->integrity,
              p->drawn, p->drawn_no_pair, p->ambiguous_outputs, p->ambiguous_inputs);
    for (unsigned k = 0; k < p->pairs.n; k++)
        kept_line("pair %u %u lambda %.6g", p->pairs.output[k], p->pairs.input[k],
                  (double)p->lambda[k]);
    for (unsigned i = 0; i < plant.outputs; i++)
        kept_line("share %u %.6g rival %u", i, (double)p->share[i], p->rival[i]);
}

static void says_structure(const struct structure_config *c)
{
    enum err err = structure_detect(&plant, &pairing.pairs, c, &work, &found);
    kept_line("structure %d parts %u blocks %u", err, found.parts, found.blocks);
    if (err)
        return;
    for (unsigned i = 0; i < plant.outputs; i++)
        kept_line("effect %x uncertain %x", found.effect[i], found.uncertain[i]);
    for (unsigned i = 0; i < found.parts; i++)
        kept_line("part %x %x", found.part_outputs[i], found.part_inputs[i]);
    for (unsigned i = 0; i < found.blocks; i++) {
        const struct block *b = &found.block[i];
        kept_line("block %x driven %x size %u part %u mimo %x worst %.6g", b->pairs, b->driven_by,
                  b->size, b->part, b->mimo, (double)b->worst_lambda);
    }
    for (uint8_t to = 0; to < pairing.pairs.n; to++)
        for (uint8_t from = 0; from < pairing.pairs.n; from++) {
            struct cross_way w;
            if (structure_cross_way(&plant, &pairing.pairs, &found, from, to, &w) == ERR_OK)
                kept_line("way %u %u gain %.6g lead %.6g lag %.6g dead %.6g late %.6g", from, to,
                          (double)w.gain, (double)w.lead_s, (double)w.lag_s, (double)w.dead_s,
                          (double)w.late_s);
        }
}

/* Bounds that are met exactly: of a group, and of a loop's own relative gain. */
static void says_bounds(void)
{
    struct structure_config c;
    structure_config_default(&c);
    c.lambda_lo = REAL_C(0.95);
    for (unsigned k = 0; k < pairing.pairs.n && found.blocks == 1; k++)
        for (unsigned l = 0; l < pairing.pairs.n; l++) {
            real_t lambda = real_abs(work.lambda.value[k][l]);
            if (k == l || !(lambda > REAL_C(0.01)) || !(lambda < REAL_C(1.0)))
                continue;
            c.grouped = lambda;
            struct structure at;
            static struct structure_work own;
            TEST_ASSERT_EQUAL_INT(ERR_OK, structure_detect(&plant, &pairing.pairs, &c, &own, &at));
            kept_line("grouped from %u %u mimo %x", k, l, at.block[0].mimo);
        }
}

static void says_dynamic(void)
{
    static struct rga_at_work at;
    static struct matrix size, part;
    for (unsigned k = 0; k < 3; k++) {
        real_t omega = REAL_C(0.002) * (real_t)(1u << (2 * k));
        enum err err = rga_at(&plant, NULL, omega, &at, &size, &part);
        kept_line("dynamic %d", err);
        for (unsigned i = 0; !err && i < size.rows; i++) {
            says("size", size.value[i], size.cols);
            says("part", part.value[i], part.cols);
        }
    }
}

static void says_cascades(void)
{
    struct cascade_config c;
    uint8_t n;
    cascade_config_default(&c);
    TEST_ASSERT_EQUAL_INT(ERR_OK, cascade_detect(&plant, &c, cascades, &n));
    for (unsigned k = 0; k < n; k++) {
        const struct cascade *a = &cascades[k];
        kept_line("cascade %u in %u inputs %x gain %.6g L %.6g T %.6g misfit %.6g", a->inner,
                  a->outer, a->inputs, (double)a->between.gain, (double)a->between.dead_time_s,
                  (double)a->between.time_constant_s, (double)a->misfit_sd);
    }
}

/* Prints the distances of the relative gains of the pairs from 1, the smallest error that makes the gains singular, and the dynamic
 * measures. */
static void says_measures(void)
{
    static struct rga_work rga;
    static struct matrix values, sd, lambda;
    static struct measure_work measure_work;
    static struct measure m;
    static struct assignment best;
    uint8_t output = 99, input = 99;
    real_t sds = REAL_C(0.0);
    if (pairing.pairs.n != plant.outputs || pairing.pairs.n != plant.inputs)
        return;
    interact_gains(&plant, &pairing.pairs, &values);
    sd.rows = sd.cols = pairing.pairs.n;
    for (unsigned k = 0; k < pairing.pairs.n; k++)
        for (unsigned l = 0; l < pairing.pairs.n; l++)
            sd.value[k][l] = plant.gain_sd[pairing.pairs.output[k]][pairing.pairs.input[l]];
    struct pairs own = {.n = pairing.pairs.n};
    for (uint8_t k = 0; k < own.n; k++)
        own.output[k] = own.input[k] = k;
    enum err err = rga_compute(&values, &rga, &lambda);
    if (err) {
        kept_line("relative gains %d", err);
        return;
    }
    real_t error = rga_smallest_error(&lambda, &output, &input), index = REAL_C(0.0);
    enum err of_sds = rga_determinant_sds(&values, &sd, NULL, &rga, &sds);
    enum err of_index = niederlinski_index(&values, &own, &rga, &index);
    kept_line("number %.6g error %.6g at %u %u sds %d %.6g index %d %.6g",
              (double)rga_number(&lambda, &own), (double)error, output, input, of_sds, (double)sds,
              of_index, (double)index);
    err = measure_compute(&plant, &pairing.pairs, REAL_C(60.0), &measure_work, &m);
    kept_line("measure %d agrees %d", err, !err && measure_agrees(&m, &best));
    for (uint8_t k = 0; !err && k < own.n; k++) {
        struct fopdt e = {REAL_C(0.0), REAL_C(0.0), REAL_C(0.0)};
        err = measure_equivalent(&m, &plant, &pairing.pairs, k, &e);
        kept_line("phi %.6g gamma %.6g equivalent %d %.6g %.6g %.6g", (double)m.phi.value[k][k],
                  (double)m.gamma.value[k][k], err, (double)e.gain, (double)e.dead_time_s,
                  (double)e.time_constant_s);
        err = ERR_OK;
    }
}

/* Output 2 follows outputs 0 and 1, but for an error; each is sooner with some of the inputs. */
static void says_followers(unsigned number, double error, double later, double sd)
{
    struct random_source r = {SEED + 7000 + number};
    memset(&plant, 0, sizeof plant);
    plant.outputs = 3;
    plant.inputs = (uint8_t)(2 + number % 3);
    for (unsigned j = 0; j < plant.inputs; j++) {
        double gain = 0.5 + fraction(&r), sooner = 10 + 50 * fraction(&r);
        double sooner_too = 10 + 50 * fraction(&r), off = 1.0 + error * (2.0 * fraction(&r) - 1.0);
        if (number % 5 == 4 && j == 1)
            gain = 0.01;
        plant.element[0][j] = (struct fopdt){(real_t)gain, REAL_C(3.0), (real_t)sooner};
        plant.element[1][j] =
            (struct fopdt){(real_t)(-0.6 * gain), REAL_C(4.0), (real_t)sooner_too};
        plant.element[2][j] = (struct fopdt){(real_t)(0.8 * gain * off),
                                             (real_t)(number % 4 == 3 ? 4.1 : 9.0), (real_t)later};
        for (unsigned i = 0; i < 3; i++)
            plant.gain_sd[i][j] = (real_t)(sd * (1 + i));
    }
    kept_line("followers %u error %.4g later %.4g sd %.4g", number, error, later, sd);
    says_cascades();
}

static void says_all_followers(void)
{
    kept_line("# followers");
    for (unsigned k = 0; k < 12; k++)
        says_followers(k, 0.005, 150.0, 0.01);
    for (unsigned k = 0; k < 10; k++)
        says_followers(2, 0.02 * pow(1.35, k), 150.0, 0.001);
    for (unsigned k = 0; k < 8; k++)
        says_followers(1, 0.03, 150.0, 2e-3 * pow(2.0, k));
    for (unsigned k = 0; k < 10; k++)
        says_followers(0, 0.005, 40.0 + 10.0 * k, 0.01);
}

/* Every output feels its own input and that of the one `step` on: all hang together, but only the whole way round; or, where
 * it does not close, one after the other; or one outside the ring drives the first of it. */
static void says_rings(void)
{
    for (unsigned number = 0; number < 18; number++) {
        unsigned n = 3 + number % 3, step = number / 3 % 2 ? n - 1 : 1;
        bool closed = number < 6, driven = number >= 12;
        unsigned ring = driven ? n - 1 : n;
        struct structure_config c;
        structure_config_default(&c);
        memset(&plant, 0, sizeof plant);
        plant.outputs = plant.inputs = (uint8_t)n;
        for (unsigned i = 0; i < n; i++)
            for (unsigned j = 0; j < n; j++) {
                bool next = i < ring && j == (i + (step == 1 ? 1 : ring - 1)) % ring &&
                            (closed || driven || i + 1 < n);
                next = next || (driven && i == 0 && j == ring);
                double gain = i == j ? 1.0 : next ? 0.7 + 0.1 * i : 0.0;
                plant.element[i][j] =
                    (struct fopdt){(real_t)gain, REAL_C(3.0), (real_t)(30 + 7 * i + 3 * j)};
                plant.gain_sd[i][j] = REAL_C(1e-3);
            }
        kept_line("# ring of %u, step %u, closed %d driven %d", n, step, closed, driven);
        says_pairing(0);
        says_structure(&c);
    }
}

static void the_numbers_of_interaction_are_the_ones_kept(void)
{
    kept_open("reference/interact_numbers.txt", "a threshold, a weight or a fall-back of the "
                                                "analysis that changes by mistake moves a line");
    for (unsigned number = 0; number < PLANTS + LARGE; number++) {
        struct structure_config c;
        structure_config_default(&c);
        make_plant(number);
        kept_line("# plant %u, %u by %u", number, plant.outputs, plant.inputs);
        says_gains();
        says_pairing(number);
        says_structure(&c);
        says_bounds();
        says_cascades();
        if (gains.rank_exact == plant.outputs)
            says_dynamic();
        says_measures();
    }
    says_all_followers();
    says_rings();
    kept_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_numbers_of_interaction_are_the_ones_kept);
    return UNITY_END();
}
