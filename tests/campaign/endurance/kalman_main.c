/* Endurance of a Kalman filter's covariance in float: ours as U D U', and as a matrix in four ways, beside one in double. Prints a line
 * for each course and form:
 *
 *     course, states, form, updates, the update after which a variance was not above 0 (0: none), the same for an
 *     eigenvalue (seen at the updates that are compared), the one that gave no number, the smallest D of U D U' or the smallest eigenvalue
 *     over the sum of all variances (0: above 0), largest relative error of a standard deviation, the same in
 *     the last tenth, largest error of a gain over sd/sqrt(alpha), the same in the last tenth
 *
 *     endurance_kalman [UPDATES [SEED]]      1,000,000 with 12 stages, a hundredth of it with 37; 1
 *
 * Exit status 1 where the U D U' did not hold. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kalman.h"
#include "num/ud.h"

#define FORMS (DENSE_FORMS + 1)
#define OURS  DENSE_FORMS

static const char *const kind_name[KALMAN_KINDS] = {"plain", "stiff", "quiet"};
static const char *const form_name[FORMS] = {"P as printed", "P symmetrised", "Joseph as printed",
                                             "Joseph symmetrised", "UDU'"};

struct result {
    uint64_t negative, indefinite, broke;
    double least, sd, sd_last, gain, gain_last;
};

static struct kalman_course course;
static struct covariance_ud ud;
static real_t memory[4500];
static struct dense_float dense[DENSE_FORMS];
static struct dense_double reference, seen;
static struct result result[FORMS];

static void begin_forms(void)
{
    memset(dense, 0, sizeof dense);
    memset(&reference, 0, sizeof reference);
    memset(result, 0, sizeof result);
    for (size_t i = 0; i < course.all; i++) {
        reference.p[i][i] = (double)course.begin[i];
        for (unsigned f = 0; f < DENSE_FORMS; f++)
            dense[f].p[i][i] = course.begin[i];
    }
    for (unsigned f = 0; f < FORMS; f++)
        result[f].least = INFINITY;
}

/* Copies the covariance of a form into double; of an unsymmetric one the mean of both halves. */
static void look_at(unsigned form)
{
    for (size_t i = 0; i < course.all; i++)
        for (size_t j = 0; j <= i; j++) {
            double sum = 0;
            if (form < DENSE_FORMS)
                sum = 0.5 * ((double)dense[form].p[i][j] + (double)dense[form].p[j][i]);
            for (size_t k = i; k < course.all && form == OURS; k++) {
                const real_t *column = ud.ud + ud_count(k);
                sum += (i == k ? 1 : (double)column[i]) * (j == k ? 1 : (double)column[j]) *
                       (double)column[k];
            }
            seen.p[i][j] = seen.p[j][i] = sum;
        }
}

static double least_of_ours(void)
{
    real_t least, most;
    ud_extremes(ud.ud, course.all, &least, &most);
    return isfinite(most) ? (double)least : NAN;
}

static void compare(unsigned form, bool last)
{
    struct result *r = &result[form];
    look_at(form);
    double least = form == OURS ? least_of_ours() : negative_of(&seen, course.all), trace = 0;
    for (size_t i = 0; i < course.all; i++)
        trace += reference.p[i][i];
    if (form != OURS) /* a part of all that is not known */
        least /= trace;
    r->least = fmin(r->least, least);
    if (form == OURS ? !(least > 0) : least < 0)
        r->indefinite = r->indefinite ? r->indefinite : course.t;
    for (size_t i = 0; i < course.all; i++) {
        double error = fabs(sqrt(fmax(seen.p[i][i], 0) / reference.p[i][i]) - 1);
        r->sd = fmax(r->sd, error);
        if (last)
            r->sd_last = fmax(r->sd_last, error);
    }
}

static void watch(unsigned form)
{
    struct result *r = &result[form];
    bool positive = true, finite = true;
    for (size_t i = 0; i < course.all; i++) {
        float own = form == OURS ? ud.ud[ud_count(i) + i] : dense[form].p[i][i];
        positive = positive && own > 0;
        finite = finite && isfinite(own);
    }
    if (!positive && !r->negative)
        r->negative = course.t;
    if (!finite)
        r->broke = course.t;
}

static void take_all(bool compared, bool last)
{
    static float gain[KALMAN_STATES];
    static double exact[KALMAN_STATES], sd[KALMAN_STATES];
    for (size_t k = 0; k < course.measurements; k++) {
        const struct covariance_measurement *z = &course.taken[k];
        for (size_t i = 0; i < course.all; i++)
            sd[i] = sqrt(reference.p[i][i]);
        double alpha = reference_take(&reference, &course, z, exact);
        for (unsigned f = 0; f < FORMS; f++) {
            struct result *r = &result[f];
            if (r->broke)
                continue;
            float own = f == OURS ? covariance_ud_take(&ud, z, gain)
                                  : dense_take(&dense[f], (enum kalman_form)f, &course, z, gain);
            if (!(own > 0))
                r->broke = course.t;
            for (size_t i = 0; i < course.all && compared; i++) {
                double error = fabs((double)gain[i] - exact[i]) * sqrt(alpha) / sd[i];
                r->gain = fmax(r->gain, error);
                if (last)
                    r->gain_last = fmax(r->gain_last, error);
            }
        }
    }
}

static void run(uint64_t updates, unsigned every)
{
    for (uint64_t t = 0; t < updates; t++) {
        bool compared = t < 50 || t % every == 0 || t + 1 == updates, last = 10 * t >= 9 * updates;
        kalman_next(&course);
        reference_carry(&reference, &course);
        for (unsigned f = 0; f < DENSE_FORMS; f++)
            if (!result[f].broke)
                dense_carry(&dense[f], (enum kalman_form)f, &course);
        while (covariance_ud_carry_piece(&ud, &course.step, COVARIANCE_UD_EFFORT)) {
        }
        take_all(compared, last);
        for (unsigned f = 0; f < FORMS; f++) {
            if (result[f].broke)
                continue;
            watch(f);
            if (compared)
                compare(f, last);
        }
    }
}

static bool say(uint64_t updates)
{
    for (unsigned f = 0; f < FORMS; f++) {
        const struct result *r = &result[f];
        printf("%s,%zu,%s,%llu,%llu,%llu,%llu,%.3g,%.3g,%.3g,%.3g,%.3g\n", kind_name[course.kind],
               course.all, form_name[f], (unsigned long long)updates,
               (unsigned long long)r->negative, (unsigned long long)r->indefinite,
               (unsigned long long)r->broke, r->least, r->sd, r->sd_last, r->gain, r->gain_last);
    }
    const struct result *ours = &result[OURS];
    return !ours->negative && !ours->indefinite && !ours->broke;
}

int main(int n, char **word)
{
    static const struct {
        size_t stages;
        unsigned share, every;
    } sizes[] = {{12, 1, 100}, {37, 100, 10}};
    uint64_t updates = n > 1 ? strtoull(word[1], NULL, 10) : 1000000;
    uint64_t seed = n > 2 ? strtoull(word[2], NULL, 10) : 1;
    bool held = true;
    if (updates < 10000) {
        fputs("endurance_kalman [UPDATES [SEED]], 10000 updates or more\n", stderr);
        return 2;
    }
    printf("course,states,form,updates,negative_at,indefinite_at,broke_at,least,sd_error,"
           "sd_error_last,gain_error,gain_error_last\n");
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
        for (unsigned kind = 0; kind < KALMAN_KINDS; kind++) {
            if (!kalman_begin(&course, (enum kalman_kind)kind, sizes[k].stages, seed) ||
                covariance_ud_begin(&ud, course.stages, 2, KALMAN_EXTRAS, course.begin, memory) !=
                    ERR_OK)
                return 3;
            begin_forms();
            run(updates / sizes[k].share, sizes[k].every);
            held = say(updates / sizes[k].share) && held;
        }
    return !held;
}
