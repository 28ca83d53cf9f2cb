#include "kinds/decoupler/decoupler.h"

#include <stdbool.h>

#include "base/assertion.h"

struct work {
    /* [D | I], turned into [I | D^-1]. */
    float a[DECOUPLER_MAX][2 * DECOUPLER_MAX];
};

static float magnitude(float x)
{
    return x < 0.0f ? -x : x;
}

/* Gauss and Jordan with partial pivoting: n rows of n + right numbers. */
static bool eliminate(struct work *w, uint8_t n, uint8_t right)
{
    REFLUX_ASSERT(n <= DECOUPLER_MAX && right <= DECOUPLER_MAX);
    const uint8_t columns = (uint8_t)(n + right);
    for (uint8_t k = 0; k < n; k++) {
        uint8_t pivot = k;
        for (uint8_t i = (uint8_t)(k + 1u); i < n; i++)
            if (magnitude(w->a[i][k]) > magnitude(w->a[pivot][k]))
                pivot = i;
        if (magnitude(w->a[pivot][k]) < 1e-6f)
            return false;
        for (uint8_t j = 0; j < columns; j++) {
            float swap = w->a[k][j];
            w->a[k][j] = w->a[pivot][j];
            w->a[pivot][j] = swap;
        }
        float scale = w->a[k][k];
        for (uint8_t j = 0; j < columns; j++)
            w->a[k][j] = w->a[k][j] / scale;
        for (uint8_t i = 0; i < n; i++) {
            float factor = w->a[i][k];
            if (i == k || factor == 0.0f)
                continue;
            for (uint8_t j = 0; j < columns; j++)
                w->a[i][j] = w->a[i][j] - factor * w->a[k][j];
        }
    }
    return true;
}

static bool invert(struct work *w, uint8_t n)
{
    if (!eliminate(w, n, n))
        return false;
    for (uint8_t i = 0; i < n; i++)
        for (uint8_t j = n; j < 2u * n; j++)
            if (!(magnitude(w->a[i][j]) <= NUM_MAX_MAGNITUDE))
                return false;
    return true;
}

enum err decoupler_select(struct decoupler *decoupler,
                          const float matrix[DECOUPLER_MAX][DECOUPLER_MAX], uint8_t mask)
{
    struct work w;
    uint8_t member[DECOUPLER_MAX];
    uint8_t n = 0;
    for (uint8_t i = 0; i < DECOUPLER_MAX; i++)
        if (mask & (1u << i))
            member[n++] = i;
    for (uint8_t i = 0; i < n; i++)
        for (uint8_t j = 0; j < n; j++) {
            w.a[i][j] = matrix[member[i]][member[j]];
            w.a[i][n + j] = i == j ? 1.0f : 0.0f;
        }
    if (!invert(&w, n))
        return ERR_SINGULAR;
    decoupler->n = n;
    for (uint8_t i = 0; i < n; i++) {
        decoupler->member[i] = member[i];
        for (uint8_t j = 0; j < n; j++) {
            decoupler->d[i][j] = num_from_float(matrix[member[i]][member[j]]);
            decoupler->inverse[i][j] = num_from_float(w.a[i][n + j]);
        }
    }
    return ERR_OK;
}

/* Returns whether v = D^-1 u is a number for all outputs within their reach. */
static bool reaches(const struct decoupler *k, const struct block_member *member)
{
    for (uint8_t i = 0; i < k->n; i++) {
        float sum = 0.0f;
        for (uint8_t j = 0; j < k->n; j++)
            sum += magnitude(num_to_float(k->inverse[i][j])) * member[k->member[j]].out_reach;
        if (sum > NUM_MAX_MAGNITUDE)
            return false;
    }
    return true;
}

enum err decoupler_check(const struct block_setup *setup, uint8_t *worst)
{
    const struct matrix_settings *matrix = setup->settings;
    struct decoupler trial;
    for (unsigned selection = 1; selection < (1u << DECOUPLER_MAX); selection++) {
        if ((selection & ~(unsigned)setup->present) != 0u)
            continue;
        if (decoupler_select(&trial, matrix->d, (uint8_t)selection) != ERR_OK ||
            !reaches(&trial, setup->member)) {
            *worst = (uint8_t)selection;
            return ERR_SINGULAR;
        }
    }
    return ERR_OK;
}

/* Sets y = m x. Skips columns whose x is zero: in a back-calculation those of all outputs that nothing limits. */
static void multiply(const struct decoupler *k, const num_t m[DECOUPLER_MAX][DECOUPLER_MAX],
                     const num_t *x, num_t *y)
{
    REFLUX_ASSERT(k->n <= DECOUPLER_MAX);
    num_t factor[DECOUPLER_MAX];
    uint8_t column[DECOUPLER_MAX];
    unsigned n = k->n, columns = 0;
    for (unsigned j = 0; j < n; j++) {
        factor[columns] = x[k->member[j]];
        column[columns] = (uint8_t)j;
        if (!num_eq(factor[columns], num_zero()))
            columns++;
    }
    for (unsigned i = 0; i < n; i++) {
        num_wide_t sum = num_wide_zero();
        for (unsigned c = 0; c < columns; c++)
            sum = num_wide_add(sum, m[i][column[c]], factor[c]);
        y[k->member[i]] = num_from_wide(sum);
    }
}

void decoupler_forward(const struct decoupler *decoupler, const num_t *v, num_t *u)
{
    multiply(decoupler, decoupler->d, v, u);
}

void decoupler_back(const struct decoupler *decoupler, const num_t *du, num_t *dv)
{
    multiply(decoupler, decoupler->inverse, du, dv);
}

void decoupler_give_way(const struct decoupler *decoupler, const num_t *du, num_t *dv)
{
    REFLUX_ASSERT(decoupler->n <= DECOUPLER_MAX);
    struct work w;
    uint8_t limited[DECOUPLER_MAX];
    uint8_t n = 0;
    for (uint8_t i = 0; i < decoupler->n; i++) {
        dv[decoupler->member[i]] = num_zero();
        if (!num_eq(du[decoupler->member[i]], num_zero()))
            limited[n++] = i;
    }
    for (uint8_t i = 0; i < n; i++) {
        for (uint8_t j = 0; j < n; j++)
            w.a[i][j] = num_to_float(decoupler->d[limited[i]][limited[j]]);
        w.a[i][n] = num_to_float(du[decoupler->member[limited[i]]]);
    }
    if (!eliminate(&w, n, 1))
        return; /* decoupler_check looked at every part */
    for (uint8_t i = 0; i < n; i++)
        dv[decoupler->member[limited[i]]] = num_from_float(w.a[i][n]);
}
