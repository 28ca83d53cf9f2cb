/* The whole block with its supervision. Settings are the defaults but for what every user has to say: the PI of the tune-in, and how
 * many terms and inputs there are. */
#include <math.h>

#include "endurance.h"
#include "gmv_block_bench.h"

#define PARAMETER   50.0f
#define AT_REST     0.5f /* where the MV stands that gives the plants their u = 0 */
#define DRIFT_MOST  0.3f /* of g0 while no setpoint moves, a part of it */
#define MODELS_MOST 100u /* more self-tunings than these in a run, and something is wrong */

static struct gmv_block_bench bench;

static bool bench_begin(enum course course)
{
    bool stiff = course == COURSE_STIFF;
    block_put_defaults(&bench.settings, &gmv_kind);
    bench.settings.tune_gain[0] = 1;
    if (stiff) {
        bench.settings.form = GMV_POSITIONAL;
        bench.settings.na = bench.settings.nb = 2;
    }
    return gmv_block_begin(&bench, 30, 1, stiff ? 1 : 0, AT_REST);
}

static void check_estimator(struct verdict *v, const struct course_plant *p,
                            const struct gmv_block *block)
{
    const struct gmv *g = gmv_of_const(block);
    const struct rls *r = gmv_rls(g, 0);
    float least, most;
    rls_d_extremes(r, &least, &most);
    verdict_of(v, p, !(least > 0 && isfinite(most)), "D not positive");
    for (unsigned k = 0; k < gmv_parameters(gmv_shape(g), 0); k++) {
        verdict_of(v, p, !(fabsf(num_to_float(gmv_used(g, 0, k))) < PARAMETER), "parameter in use");
        verdict_of(v, p, !(fabsf(num_to_float(rls_theta(r, k))) < PARAMETER), "parameter");
    }
}

/* Noise of the sensor alone must not change the model. */
static void check_rest(struct verdict *v, const struct course_plant *p,
                       const struct gmv_block *block, float *begun)
{
    float gain = gmv_own_gain(gmv_of_const(block), 0);
    if (p->t == COURSE_MOVES || block->watch.status.state != GMV_SELF_TUNING)
        *begun = gain;
    verdict_of(v, p,
               p->course == COURSE_NOISE && p->t > COURSE_MOVES &&
                   p->t + COURSE_LAST < p->samples &&
                   fabsf(gain - *begun) > DRIFT_MOST * fabsf(*begun),
               "g0 drifted");
}

struct verdict run_supervised(enum course course, uint64_t samples, uint64_t seed)
{
    struct verdict v = {0};
    struct course_plant plant;
    const struct gmv_block *block = gmv_bench_block(&bench);
    uint64_t lawful = 0, begun = 0;
    float gain = 0;
    course_begin(&plant, course, samples, seed);
    verdict_of(&v, &plant, !bench_begin(course), "settings");
    for (uint64_t t = 0; t < samples && !v.sample; t++) {
        course_prepare(&plant);
        gmv_block_signals(&bench, 0, plant.w, course_reading(&plant));
        bench.input[1] = num_from_float((float)plant.load);
        num_t before = bench.out[0];
        bool law = block->watch.status.state == GMV_SELF_TUNING;
        verdict_of(&v, &plant, !gmv_block_step(&bench), "gave up");
        course_step(&plant, (double)(num_to_float(bench.out[0]) - AT_REST));
        verdict_of_control(&v, &plant, (double)num_to_float(num_sub(bench.out[0], before)));
        check_estimator(&v, &plant, block);
        check_rest(&v, &plant, block, &gain);
        lawful += block->watch.status.state == GMV_SELF_TUNING;
        begun += !law && block->watch.status.state == GMV_SELF_TUNING;
        verdict_of(&v, &plant, begun > MODELS_MOST, "back to the PI too often");
    }
    /* A block that never adopts a model holds as well, but it is no self-tuner. */
    verdict_of(&v, &plant, 2 * lawful < samples, "PI more than half of the time");
    return v;
}
