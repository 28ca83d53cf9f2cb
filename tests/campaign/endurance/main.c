/* Endurance of estimators: courses, each under every bare rule of forgetting, under the covariance as it is printed, and
 * under the supervised block. Prints a line for each:
 *
 *     course, estimator, number format, samples, the sample at which it failed (0: it did not), what happened, sum of |error| over the
 *     last tenth
 *
 *     endurance [SAMPLES [SEED]]      1,000,000 and 1 without
 *
 * Exit status 1 where the supervised block did not hold. */
#include <stdio.h>
#include <stdlib.h>

#include "endurance.h"

static const char *const course_name[COURSES] = {"rest", "stiff", "drift", "noise"};

static void say(enum course course, const char *estimator, uint64_t samples, struct verdict v)
{
    printf("%s,%s,%s,%llu,%llu,%s,%.6g\n", course_name[course], estimator, NUM_FORMAT,
           (unsigned long long)samples, (unsigned long long)v.sample, v.sample ? v.what : "held",
           v.error);
}

int main(int n, char **word)
{
    static const char *const rule[] = {"constant",   "fortescue", "ydstie",      "ydstie_trace",
                                       "held_trace", "reset",     "directional", "bounded"};
    uint64_t samples = n > 1 ? strtoull(word[1], NULL, 10) : 1000000;
    uint64_t seed = n > 2 ? strtoull(word[2], NULL, 10) : 1;
    int failed = 0;
    if (samples < 5000) {
        fputs("endurance [SAMPLES [SEED]], 5000 samples or more\n", stderr);
        return 2;
    }
    printf("course,estimator,format,samples,failed_at,what,last_tenth_error\n");
    for (enum course course = 0; course < COURSES; course++) {
        for (unsigned k = 0; k < sizeof rule / sizeof *rule; k++)
            say(course, rule[k], samples, run_rule(course, k, samples, seed));
        say(course, "covariance form", samples,
            run_covariance(course, false, false, samples, seed));
        say(course, "double dense constant", samples,
            run_covariance(course, true, false, samples, seed));
        say(course, "double dense bounded", samples,
            run_covariance(course, true, true, samples, seed));
        struct verdict v = run_supervised(course, samples, seed);
        say(course, "supervised", samples, v);
        failed += v.sample != 0;
    }
    return failed != 0;
}
