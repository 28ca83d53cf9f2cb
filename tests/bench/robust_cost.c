/* Cost of the search for settings of the worst of 24 members: frequencies and instructions for so many loops.
 *
 *     valgrind --tool=callgrind --callgrind-out-file=cost.out build/host/tests/unit/robust_cost 4
 *     callgrind_annotate --inclusive=yes cost.out | grep 'robust_cost.c:one_step'
 */
#include <stdio.h>
#include <stdlib.h>

#include "design/detune.h"
#include "design/members.h"
#include "design/robust.h"
#include "num/random.h"

static struct interact_plant plant;
static struct detune detune;
static struct robust robust;
static struct time_errors errors;

static __attribute__((noinline)) enum err one_step_of_robust(void)
{
    return robust_step(&robust);
}

static void make_plant(unsigned n)
{
    struct random r = random_from(3);
    plant.outputs = plant.inputs = (uint8_t)n;
    for (unsigned i = 0; i < n; i++)
        for (unsigned j = 0; j < n; j++) {
            plant.element[i][j] = (struct fopdt){
                0.3f / (float)n * random_normal(&r) + (i == j ? 1.0f : 0.0f),
                10.0f + 5.0f * (float)((i * 7 + j * 3) % 5), 60.0f + 10.0f * (float)((i + j) % 6)};
            plant.gain_sd[i][j] = 0.02f;
            errors.time_constant_s[i][j] = 0.2f * plant.element[i][j].time_constant_s;
            errors.dead_time_s[i][j] = 0.2f * plant.element[i][j].dead_time_s;
            if ((i + j) % 3 == 0) { /* a third of the elements has two lags */
                plant.shape[i][j] = (struct interact_shape){600.0f, -5.0f};
            }
        }
}

int main(int argc, char **argv)
{
    unsigned n = argc > 1 ? (unsigned)atoi(argv[1]) : 2u;
    if (n < 1 || n > INTERACT_MAX)
        return 2;
    make_plant(n);
    struct pairs pairs = {.n = (uint8_t)n};
    for (unsigned k = 0; k < n; k++)
        pairs.output[k] = pairs.input[k] = (uint8_t)k;
    struct detune_config dc;
    struct robust_config rc;
    struct members members = {.plant = &plant, .errors = &errors, .floor = 0.005f, .seed = 1};
    detune_config_default(&dc);
    robust_config_default(&rc);
    rc.members = 24;
    rc.draw = members_draw;
    rc.context = &members;
    enum err err = detune_begin(&detune, &plant, &pairs, 1.0f, NULL, &dc, NULL);
    while (!err && (err = detune_step(&detune)) == ERR_BUSY)
        err = ERR_OK;
    if (!err || err == ERR_TIMEOUT)
        err = robust_begin(&robust, &plant, &detune.loops, &rc, NULL);
    unsigned steps = 0;
    while (!err) {
        err = one_step_of_robust();
        steps++;
        if (err != ERR_BUSY)
            break;
        err = ERR_OK;
    }
    printf("%u loops: %u steps, %u frequencies, %u passes, |S| %.2f, worst %.2f, gains times %.2f: "
           "%s\n",
           n, steps, (unsigned)robust.frequencies, robust.passes, (double)robust.s_nominal,
           (double)robust.s_worst, (double)robust.factor, err_text(err));
    return err != ERR_OK;
}
