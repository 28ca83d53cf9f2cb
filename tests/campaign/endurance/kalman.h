/* A Kalman filter's covariance over a million updates in several forms: what the parts of the program share. */
#ifndef REFLUX_CAMPAIGN_KALMAN_H
#define REFLUX_CAMPAIGN_KALMAN_H

#include <stdbool.h>
#include <stdint.h>

#include "kinds/composition/covariance_ud.h"
#include "random_source.h"

#define KALMAN_EXTRAS   4 /* feed fractions, feed flow, offset of the analysed place */
#define KALMAN_STATES   (2 * 37 + KALMAN_EXTRAS)
#define KALMAN_VARIANTS 4 /* working points that the column is at in turn */
#define KALMAN_SENSORS  4
#define KALMAN_MOST     (KALMAN_SENSORS + 1) /* measurements of a step */

enum kalman_kind { KALMAN_PLAIN, KALMAN_STIFF, KALMAN_QUIET, KALMAN_KINDS };

struct kalman_variant {
    struct column_transition transition;
    real_t numbers[37 * 14], push[KALMAN_EXTRAS * 2 * 37], slope[KALMAN_SENSORS][2];
    float a[KALMAN_STATES][KALMAN_STATES]; /* the whole transition, transposed */
};

/* A course: the splitter with so many stages, and what is measured there. */
struct kalman_course {
    enum kalman_kind kind;
    size_t stages, n, all;
    struct kalman_variant variant[KALMAN_VARIANTS];
    real_t keep[KALMAN_EXTRAS], grown[KALMAN_EXTRAS], noise[2 * 37], begin[KALMAN_STATES];
    struct random_source random;
    uint64_t t;
    /* of the step that comes now */
    const struct kalman_variant *actual;
    struct covariance_step step;
    struct covariance_measurement taken[KALMAN_MOST];
    real_t slopes[KALMAN_MOST][2];
    size_t measurements;
};

bool kalman_begin(struct kalman_course *c, enum kalman_kind kind, size_t stages, uint64_t seed);
void kalman_next(struct kalman_course *c);

/* ---- forms ---- */

enum kalman_form { DENSE_PRINTED, DENSE_SYMMETRIC, JOSEPH_PRINTED, JOSEPH_SYMMETRIC, DENSE_FORMS };

struct dense_float {
    float p[KALMAN_STATES][KALMAN_STATES];
};
struct dense_double {
    double p[KALMAN_STATES][KALMAN_STATES];
};

void dense_carry(struct dense_float *d, enum kalman_form form, const struct kalman_course *c);
/* gain[all]; returns alpha. */
float dense_take(struct dense_float *d, enum kalman_form form, const struct kalman_course *c,
                 const struct covariance_measurement *z, float *gain);
void reference_carry(struct dense_double *d, const struct kalman_course *c);
double reference_take(struct dense_double *d, const struct kalman_course *c,
                      const struct covariance_measurement *z, double *gain);
/* The smallest eigenvalue where that is below 0, within a tenth; else 0. */
double negative_of(const struct dense_double *d, size_t n);

#endif
