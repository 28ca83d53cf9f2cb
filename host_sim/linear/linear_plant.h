/* Linear plants: any number of blocks x' = A x + B u(t - L), y += C x + D u(t - L) around a nominal point,
 * or the same in discrete time. A transfer function matrix is a block an element; a state-space plant is one block.
 *
 * Rules
 *  1. Inputs are constant between calls, so every step is a zero-order hold and exact to rounding: an interval is
 *     split where a delayed input changes. Dead times and times are whole nanoseconds.
 *  2. Values are deviations inside and engineering units outside: y = nominal + G (u - nominal).
 *  3. A block may have several variants (other matrices of the same order, another dead time); a parameter
 *     channel, 1 to n, says which one is in force. States and past inputs are kept when it changes.
 *  4. Direct feedthrough follows the input at once: after set_input() value() shows it. */
#ifndef REFLUX_HOST_SIM_LINEAR_PLANT_H
#define REFLUX_HOST_SIM_LINEAR_PLANT_H

#include "plants/plant.h"

#include <stdint.h>

struct linear_variant {
    double *a, *b, *c, *d; /* per second when continuous; n x n, n x m, p x n, p x m */
    int64_t dead_ns;
};

struct linear_block {
    size_t n, m, p;
    size_t input, output; /* first input and first output it is about */
    size_t n_variants;
    struct linear_variant *variant;
    size_t parameter; /* when n_variants > 1: which parameter chooses, counted from 0 */
};

/* Channels stand in this order: manipulated (n_mvs), disturbances, parameters, measurements. Inputs of the
 * blocks are the first two. */
struct linear_model {
    const char *name;
    int64_t period_ns; /* discrete: its period; 0 = continuous */
    const struct plant_channel *channels;
    size_t n_mvs, n_inputs, n_parameters, n_outputs;
    struct linear_block *block;
    size_t n_blocks;
};

struct plant *linear_create(const struct linear_model *model, char *err, size_t err_size);
void linear_destroy(struct plant *p);
bool linear_set_input(struct plant *p, size_t channel, double value, char *err, size_t err_size);
bool linear_advance(struct plant *p, double t_s, char *err, size_t err_size);
double linear_value(const struct plant *p, size_t channel);
bool linear_settle(struct plant *p, char *err, size_t err_size);

/* The variant of a block that is in force. */
const struct linear_variant *linear_variant_of(const struct plant *p, const struct linear_block *b);

#endif
