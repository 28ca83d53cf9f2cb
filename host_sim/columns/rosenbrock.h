/* One-step integration of stiff equations dy/dt = f(y), for stretches that are too short for a multistep method:
 * after a jump of the inputs it begins with the step and at the order it ended with before.
 *
 * Method: ROS34PW2 of J. Rang and L. Angermann (BIT 45, 2005), four stages, linearly implicit, order 3 with an
 * embedded order 2 whatever the Jacobian is, L-stable with a good one, stiffly accurate. */
#ifndef REFLUX_HOST_SIM_ROSENBROCK_H
#define REFLUX_HOST_SIM_ROSENBROCK_H

#include <stdbool.h>
#include <stddef.h>

#define ROSENBROCK_STAGES 4

/* The system that is integrated. */
struct rosenbrock_problem {
    size_t n;
    void *context;
    /* f(y); false where there is none: a shorter step is tried */
    bool (*rates)(void *context, const double *y, double *f);
    /* Jacobian at y, about; called after rates() of the same y and before any other */
    void (*linearise)(void *context, const double *y);
    /* factors of I - g J; false where it is singular: a shorter step is tried */
    bool (*factor)(void *context, double g);
    /* b to (I - g J)^-1 b */
    void (*solve)(void *context, double *b);
};

/* Work space and what is remembered. Fields are the module's own unless named otherwise. */
struct rosenbrock {
    struct rosenbrock_problem problem;
    /* tolerances: root mean square of error / (relative |y| + absolute) below 1 */
    double relative, absolute;
    double shortest;      /* of the stretch: below that a step counts as failed; 1e-9 */
    long steps, rejected; /* for reading */
    double next;          /* step that the error allows next, s; 0: not known */
    double first;         /* the same after the first step from a jump */
    bool jumped;
    double *work;
};

/* False when there is no memory. */
bool rosenbrock_init(struct rosenbrock *r, const struct rosenbrock_problem *problem,
                     double relative, double absolute);
void rosenbrock_free(struct rosenbrock *r);

/* The right-hand side or the state has jumped. */
void rosenbrock_jump(struct rosenbrock *r);

/* Integrates y from t towards end (above t) in at most steps_max accepted steps and returns the time reached:
 * end itself, or less when the steps were used up or no step, however short, succeeded. f: rates at y, on
 * entry alone. */
double rosenbrock_run(struct rosenbrock *r, double t, double end, double *y, const double *f,
                      int steps_max);

#endif
