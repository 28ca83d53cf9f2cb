/* Rules for a feedforward element (lead s + 1)/(lag s + 1) from first-order models with dead time of both paths: which of nine cases they are, and
 * F. G. Shinskey's settings for each (Process Control Systems; as R. Siddha 2003 has them, table 1.2), to set beside a tuned element and
 * to fall back on. */
#ifndef REFLUX_DESIGN_FEEDFORWARD_RULES_H
#define REFLUX_DESIGN_FEEDFORWARD_RULES_H

#include <stdbool.h>

#include "design/double_symbols.h"
#include "lti/fopdt.h"
#include "num/cmatrix.h"

/* Which path is late: dead time of the manipulated input's path less that of the disturbance's. */
enum feedforward_late {
    LATE_NEITHER,     /* case I */
    LATE_DISTURBANCE, /* II: the element has time to wait */
    LATE_PROCESS      /* III: it would have to see the future */
};

/* Which path is slow: time constants. */
enum feedforward_slow {
    SLOW_DISTURBANCE, /* a: a lag is called for */
    SLOW_NEITHER,     /* b */
    SLOW_PROCESS      /* c: a lead */
};

struct feedforward_case {
    enum feedforward_late late;
    enum feedforward_slow slow;
};

/* Dead times are equal within `same` of the sum of the process' dead time and time constant, time constants within `same` of the
 * larger one. same: 0 to 0.5. */
struct feedforward_case feedforward_case_of(const struct fopdt *process,
                                            const struct fopdt *disturbance, real_t same);
/* "I a" and so on. */
const char *feedforward_case_name(struct feedforward_case which);

struct feedforward_rule {
    real_t gain, lead_s, lag_s, dead_s;
};

/* Shinskey's settings: gain -Kd/Kp; lead may be below 0, where it imitates a dead time; lag may not, and is then 0. dead_s is 0. Models as
 * fopdt_validate() wants them, the process' gain not 0; ERR_RANGE otherwise. */
MUST_CHECK enum err feedforward_shinskey(const struct fopdt *process,
                                         const struct fopdt *disturbance, real_t same,
                                         struct feedforward_rule *rule);

/* Finds the rule that cancels the disturbance, as far as possible: lead the process' time constant, lag the disturbance's, dead time the difference
 * where it is not below 0. */
MUST_CHECK enum err feedforward_exact(const struct fopdt *process, const struct fopdt *disturbance,
                                      struct feedforward_rule *rule);

/* (K (lead s + 1)/(lag s + 1)) e^(-dead s) at s = i omega. */
struct cplx feedforward_rule_response(const struct feedforward_rule *rule, real_t omega);

/* Distance of an element from the ideal one at a frequency: magnitudes in decibels, phases in degrees, -180 to 180, the element's less the
 * ideal one's. */
struct feedforward_miss {
    real_t db, degrees;
};
struct feedforward_miss feedforward_miss_of(struct cplx element, struct cplx ideal);

/* The largest of n misses, and the square root of the sum of squares of them: H-infinity and H2 as Siddha has them (2.5), signs left aside. */
void feedforward_misses(size_t n, const struct feedforward_miss *miss,
                        struct feedforward_miss *largest, struct feedforward_miss *together);

#endif
