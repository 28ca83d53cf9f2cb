/* Weeks of the self-tuner on a set of plants, a line for each:
 *
 *     self_tuner SET [SEED [FROM STRIDE]] [delay=zero|dead] [days=D] [limits] [NAME=VALUE ...]
 *
 * SET: grid (noise 0.05 %), noisy (the same, 0.2 %), choose, confirm, named, pairs; with -rest behind it nothing moves from the
 * second day to the last hours. delay=zero: without half the second lag, delay=dead: of the dead time alone. NAME: a setting of the
 * block, for all loops. limits: exit
 * status 1 where a run was beyond the limits of the PI's record for longer than four windows, or g0 moved by more than 30 % at rest. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "self_tuner.h"

#define SETS_MOST 16u

struct options {
    const char *set[SETS_MOST];
    unsigned sets, from, stride;
    bool limits;
    enum delay_rule rule;
    double days;
    uint64_t seed;
};

static void read_options(struct options *o, int n, char **word)
{
    uint64_t number[3] = {1, 0, 1};
    unsigned numbers = 0;
    *o = (struct options){.days = 7};
    for (int k = 2; k < n; k++) {
        if (strcmp(word[k], "delay=dead") == 0)
            o->rule = DELAY_DEAD;
        else if (strcmp(word[k], "delay=zero") == 0)
            o->rule = DELAY_ZERO;
        else if (strcmp(word[k], "limits") == 0)
            o->limits = true;
        else if (strncmp(word[k], "days=", 5) == 0)
            o->days = strtod(word[k] + 5, NULL);
        else if (strchr(word[k], '=') && o->sets < SETS_MOST)
            o->set[o->sets++] = word[k];
        else if (numbers < 3)
            number[numbers++] = strtoull(word[k], NULL, 10);
    }
    o->seed = number[0];
    o->from = (unsigned)number[1];
    o->stride = number[2] ? (unsigned)number[2] : 1;
}

static void print(const char *set, const struct tuner_case *c, const struct tuner_result *r)
{
    printf("%s,%s,%s,%u,%.4f,%.4f,%.4f,%.4f,%.0f,%.0f,%.3f,%.4g,%.4g,%u,%u,%u,%u", set, c->name,
           NUM_FORMAT, c->delay[0][0], r->ratio, r->measured_ratio, r->first_ratio, r->last_ratio,
           r->adopted_s, r->ended_s, r->lawful, r->g0_begun, r->g0_rest, r->adoptions, r->returns,
           r->beyond_most, r->beyond_moves_most);
    for (unsigned k = 0; k < 5; k++)
        printf(",%u", r->by[k]);
    printf("\n");
}

#define BEYOND_MOST 4u /* windows */
#define DRIFT_MOST  0.3

static bool within_limits(const struct tuner_case *c, const struct tuner_result *r)
{
    bool drifts = c->schedule == WEEK_REST && r->returns == 0 && r->g0_begun != 0 &&
                  fabs(r->g0_rest - r->g0_begun) > DRIFT_MOST * fabs(r->g0_begun);
    if (r->beyond_most > BEYOND_MOST)
        fprintf(stderr, "%s: beyond the PI's record for %u windows\n", c->name, r->beyond_most);
    if (drifts)
        fprintf(stderr, "%s: g0 moved from %g to %g\n", c->name, r->g0_begun, r->g0_rest);
    return r->beyond_most <= BEYOND_MOST && !drifts;
}

int main(int n, char **word)
{
    struct options o;
    struct tuner_case c;
    struct tuner_result r;
    bool good = true;
    if (n < 2) {
        fputs("self_tuner SET [SEED [FROM STRIDE]] [delay=zero|dead] [days=D] [limits] [NAME=VALUE "
              "...]\n",
              stderr);
        return 2;
    }
    read_options(&o, n, word);
    printf("set,case,format,delay,ratio,measured,first,last,adopted_s,ended_s,lawful,g0_begun,"
           "g0_rest,adoptions,returns,beyond,beyond_moves,sign,poles,worse,burst,record\n");
    for (unsigned k = o.from; case_of(word[1], k, o.seed, o.rule, &c); k += o.stride) {
        if (!run_case(&c, o.set, o.sets, o.days, &r)) {
            fprintf(stderr, "%s: the block refuses its settings\n", c.name);
            return 2;
        }
        print(word[1], &c, &r);
        good = within_limits(&c, &r) && good;
    }
    return o.limits && !good;
}
