/* Cost of the analysis and design of a 16 x 16 plant: how many steps each takes. For instructions a step:
 *
 *     valgrind --tool=callgrind --callgrind-out-file=cost.out build/host/tests/unit/interact_cost
 *     callgrind_annotate --inclusive=yes cost.out | grep 'interact_cost.c:one_step'
 */
#include <stdio.h>

#include "design/detune.h"
#include "design/trial.h"
#include "interact/gains.h"
#include "interact/pairing.h"
#include "num/random.h"

static struct interact_plant plant;
static struct gains gains;
static struct pairing pairing;
static struct detune detune;
static struct trial trial;
static struct rga_at_work work;
static struct matrix modulus, real_part;

static __attribute__((noinline)) enum err one_step_of_gains(void)
{
    return gains_step(&gains);
}
static __attribute__((noinline)) enum err one_step_of_pairing(void)
{
    return pairing_step(&pairing);
}
static __attribute__((noinline)) enum err one_step_of_detuning(void)
{
    return detune_step(&detune);
}
static __attribute__((noinline)) enum err one_step_of_a_trial(void)
{
    return trial_step(&trial);
}
static __attribute__((noinline)) enum err one_step_of_the_dynamic_array(void)
{
    return rga_at(&plant, NULL, 0.01f, &work, &modulus, &real_part);
}

static int run(const char *name, enum err begun, enum err (*step)(void))
{
    if (begun) {
        printf("%s: %s\n", name, err_text(begun));
        return 1;
    }
    unsigned steps = 0;
    enum err err;
    do {
        err = step();
        steps++;
    } while (err == ERR_BUSY);
    printf("%s: %u steps, %s\n", name, steps, err_text(err));
    return err != ERR_OK;
}

int main(void)
{
    struct random r = random_from(3);
    plant.outputs = plant.inputs = INTERACT_MAX;
    for (unsigned i = 0; i < INTERACT_MAX; i++)
        for (unsigned j = 0; j < INTERACT_MAX; j++) {
            plant.element[i][j] = (struct fopdt){0.25f * random_normal(&r) + (i == j ? 1.5f : 0.0f),
                                                 10.0f + 5.0f * (float)((i * 7 + j * 3) % 5),
                                                 60.0f + 10.0f * (float)((i + j) % 6)};
            plant.gain_sd[i][j] = 0.01f;
        }
    struct pairing_config pc;
    struct detune_config dc;
    struct trial_config tc = {.size = 0.01f, .setpoint_weight = 1.0f};
    pairing_config_default(&pc);
    detune_config_default(&dc);
    int failed = run("gains", gains_begin(&gains, &plant, 0.0f), one_step_of_gains);
    failed |= run("pairing", pairing_begin(&pairing, &plant, &pc, NULL), one_step_of_pairing);
    failed |= run("dynamic array", ERR_OK, one_step_of_the_dynamic_array);
    failed |= run("detuning", detune_begin(&detune, &plant, &pairing.pairs, 1.0f, NULL, &dc, NULL),
                  one_step_of_detuning);
    failed |= run("trial", trial_begin(&trial, &plant, &detune.loops, &tc), one_step_of_a_trial);
    return failed;
}
