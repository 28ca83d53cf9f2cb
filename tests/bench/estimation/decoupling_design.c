/* Designs of decouplers and of a controller from a model of differences, whole: the column of Kotyk and Machacek (1995), and plants of
 * three and four loops like it; and a round of the search of a constant compensator. */
#include <string.h>

#include "cost.h"
#include "decoupling.h"
#include "design/pole_placement.h"
#include "design/polynomial_decoupler.h"
#include "interact/difference_response.h"
#include "interact/ina_search.h"
#include "kotyk_model.h"

#define POINTS 50

static struct difference_model model;
static struct cplx table[POINTS * DIFFERENCE_MOST * DIFFERENCE_MOST];

/* The column's first element on the diagonal, less of it off it. */
static void plant_of(unsigned loops)
{
    struct difference_model column;
    kotyk_model(&column);
    model = column;
    model.outputs = model.inputs = (uint8_t)loops;
    if (loops == 2)
        return;
    for (unsigned i = 0; i < loops; i++) {
        memcpy(model.a[i], column.a[i % 2], sizeof model.a[i]);
        for (unsigned j = 0; j < loops; j++)
            for (unsigned k = 0; k < 2; k++)
                model.b[i][j][k] =
                    column.b[0][0][k] * (i == j ? 1 : REAL_C(0.2) / (real_t)(1 + i + j));
    }
}

static void cost_of_decoupler(unsigned loops)
{
    static struct polynomial_decoupler_work work;
    static struct polynomial_decoupler result;
    struct polynomial_decoupler_config config;
    struct cost cost = {0};
    plant_of(loops);
    polynomial_decoupler_config_default(&config);
    cost_paint_stack();
    uint32_t from = cost_now();
    enum err err = polynomial_decoupler_design(&model, &config, &work, &result, NULL);
    uint32_t to = cost_now();
    cost_stack(&cost);
    if (err != ERR_OK)
        return; /* a row is missing */
    cost_add(&cost, from, to);
    cost_tell("decoupler", loops, &cost, sizeof work + sizeof result);
}

static void cost_of_placement(void)
{
    static struct pole_placement_work work;
    static struct pole_placement result;
    struct pole_placement_goal goal;
    struct cost cost = {0};
    struct polynomial a, b;
    plant_of(2);
    memset(&a, 0, sizeof a);
    memset(&b, 0, sizeof b);
    a.n = b.n = 3;
    a.value[0] = 1;
    for (unsigned k = 0; k < 2; k++) {
        a.value[k + 1] = model.a[0][k];
        b.value[k + 1] = model.b[0][0][k];
    }
    pole_placement_goal_default(&goal);
    goal.settling_s = 3600;
    cost_paint_stack();
    uint32_t from = cost_now();
    enum err err = pole_placement_design(&a, &b, KOTYK_PERIOD, &goal, &work, &result, NULL);
    uint32_t to = cost_now();
    cost_stack(&cost);
    if (err != ERR_OK)
        return;
    cost_add(&cost, from, to);
    cost_tell("placement", 1, &cost, sizeof work + sizeof result);
}

/* mean: a round; most: all of them. */
static void cost_of_search(unsigned loops)
{
    static struct ina_search search;
    static struct cmatrix f, inverse;
    static struct ina_work work;
    struct ina_search_config config;
    struct matrix one;
    struct cost cost = {0};
    plant_of(loops);
    if (ina_identity((uint8_t)loops, &one) != ERR_OK)
        return;
    for (unsigned k = 0; k < POINTS; k++) {
        real_t omega = (REAL_C(0.001) + REAL_C(3.14) * (real_t)k / POINTS) / KOTYK_PERIOD;
        if (difference_response(&model, omega, &f) != ERR_OK ||
            ina_inverse(&f, &one, &work, &inverse) != ERR_OK)
            return;
        for (unsigned m = 0; m < loops * loops; m++)
            table[k * loops * loops + m] = inverse.value[m / loops][m % loops];
    }
    ina_search_config_default(&config);
    if (ina_search_begin(&search, table, POINTS, &one, &config) != ERR_OK)
        return;
    enum err err;
    cost_paint_stack();
    do {
        uint32_t from = cost_now();
        err = ina_search_step(&search);
        uint32_t to = cost_now();
        cost_add(&cost, from, to);
    } while (err == ERR_BUSY);
    cost_stack(&cost);
    if (err != ERR_OK)
        return;
    cost_say("search", loops, cost.sum, cost.most, sizeof search + sizeof table);
    cost_say("stack", loops, cost.stack, cost.stack, 0);
}

void cost_of_decoupling_designs(void)
{
    for (unsigned loops = 2; loops <= DIFFERENCE_MOST; loops++)
        cost_of_decoupler(loops);
    cost_of_placement();
    for (unsigned loops = 2; loops <= DIFFERENCE_MOST; loops++)
        cost_of_search(loops);
}
