/* A design of design/state_decoupler.h with all that it takes and gives. */
#ifndef REFLUX_TESTS_STATE_DESIGN_H
#define REFLUX_TESTS_STATE_DESIGN_H

#include <string.h>

#include "design/state_decoupler.h"

static struct state_model model;
static struct state_decoupler_config config;
static struct state_decoupler_goal goal;
static struct state_decoupler_work work;
static struct state_decoupler d;
static struct state_decoupler_refusal why;

static inline enum err design(void)
{
    return state_decoupler_design(&model, &config, &goal, &work, &d, &why);
}

/* So large, and zero. */
static inline void set_size(struct matrix *a, unsigned rows, unsigned cols)
{
    memset(a, 0, sizeof *a);
    a->rows = (uint8_t)rows;
    a->cols = (uint8_t)cols;
}

#endif
