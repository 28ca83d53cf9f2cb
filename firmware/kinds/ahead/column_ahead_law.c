#include "kinds/ahead/column_ahead_law.h"

#include "base/assertion.h"
#include "kinds/ahead/column_ahead_law_state.h"
#include "num/solve_small.h"

#define ZERO REAL_C(0.0)
#define ONE  REAL_C(1.0)

/* Damping, part of the largest element, of the sum of squares of what is left and of the moves: inputs that do nearly the same, or nothing at all,
 * move little. 1e-3 of that element changes the answer by as much where b has a condition number of 30. */
#define DAMPING REAL_C(1e-3)
#define WIDTH   (AHEAD_LOOPS + 1)

void ahead_law_set(struct ahead_law *law, uint8_t n)
{
    law->n = n;
}

void ahead_law_act(struct ahead_law *law, uint8_t acting)
{
    law->acting = acting;
}

void ahead_law_free(struct ahead_law *law, unsigned j)
{
    REFLUX_ASSERT(j < law->n);
    law->lo[j] = ZERO;
    law->hi[j] = ONE;
}

void ahead_law_limit(struct ahead_law *law, unsigned j, real_t applied, bool held_below,
                     bool held_above)
{
    REFLUX_ASSERT(j < law->n);
    if (applied > law->hi[j])
        law->hi[j] = ONE;
    if (applied < law->lo[j])
        law->lo[j] = ZERO;
    if (held_below)
        law->hi[j] = applied;
    if (held_above)
        law->lo[j] = applied;
}

const real_t *ahead_law_u(const struct ahead_law *law)
{
    return law->u;
}

void ahead_law_put_u(struct ahead_law *law, unsigned j, real_t u)
{
    REFLUX_ASSERT(j < law->n);
    law->u[j] = u;
}

real_t ahead_law_b(const struct ahead_law *law, unsigned i, unsigned j)
{
    REFLUX_ASSERT(i < law->n && j < law->n);
    return law->b[i][j];
}

void ahead_law_put_b(struct ahead_law *law, unsigned i, unsigned j, real_t b)
{
    REFLUX_ASSERT(i < law->n && j < law->n);
    law->b[i][j] = b;
}

real_t ahead_law_asked(const struct ahead_law *law, unsigned j)
{
    REFLUX_ASSERT(j < law->n);
    return law->asked[j];
}

/* ---- solution ---- */

static bool is_in(uint8_t set, unsigned k)
{
    return (set & (1u << k)) != 0;
}

/* Members of a set, ascending. */
static size_t members_of(uint8_t set, uint8_t n, uint8_t *member)
{
    size_t count = 0;
    for (uint8_t k = 0; k < n; k++)
        if (is_in(set, k))
            member[count++] = k;
    return count;
}

static real_t square_of_largest(const struct ahead_law *law)
{
    real_t most = ZERO;
    for (unsigned i = 0; i < law->n; i++)
        for (unsigned j = 0; j < law->n; j++)
            if (real_abs(law->b[i][j]) > most)
                most = real_abs(law->b[i][j]);
    return most * most;
}

/* move[] of the inputs in `moving` for as many outputs, by normal equations. */
static bool move_by(const struct ahead_law *law, uint8_t moving, const real_t *e, real_t *move)
{
    uint8_t member[AHEAD_LOOPS];
    real_t rows[AHEAD_LOOPS * WIDTH];
    size_t n = members_of(moving, law->n, member);
    real_t damping = DAMPING * DAMPING * square_of_largest(law);
    for (size_t i = 0; i < n; i++) {
        real_t *here = &rows[i * WIDTH];
        for (size_t j = 0; j <= n; j++)
            here[j] = j == i ? damping : ZERO;
        for (size_t k = 0; k < n; k++) {
            const real_t *b = law->b[member[k]];
            for (size_t j = 0; j < n; j++)
                here[j] += b[member[i]] * b[member[j]];
            here[n] += b[member[i]] * e[member[k]];
        }
    }
    if (!solve_small(n, n + 1, WIDTH, rows))
        return false;
    for (size_t i = 0; i < n; i++)
        move[member[i]] = rows[i * WIDTH + n];
    return true;
}

/* The input of the set that is farthest beyond a limit; n: none is. */
static uint8_t farthest_beyond(const struct ahead_law *law, uint8_t moving, const real_t *move,
                               real_t *limit)
{
    uint8_t found = law->n;
    real_t most = ZERO;
    for (uint8_t j = 0; j < law->n; j++) {
        if (!is_in(moving, j))
            continue;
        real_t to = law->u[j] + move[j];
        real_t kept = to < law->lo[j] ? law->lo[j] : to > law->hi[j] ? law->hi[j] : to;
        if (real_abs(to - kept) > most) {
            most = real_abs(to - kept);
            *limit = kept;
            found = j;
        }
    }
    return found;
}

bool ahead_law_solve(struct ahead_law *law, const real_t *e)
{
    REFLUX_ASSERT(law->n <= AHEAD_LOOPS);
    real_t left[AHEAD_LOOPS], move[AHEAD_LOOPS] = {ZERO}, limit = ZERO;
    uint8_t moving = law->acting;
    for (unsigned i = 0; i < law->n; i++)
        left[i] = e[i];
    while (moving) { /* one input less in each turn */
        if (!move_by(law, moving, left, move))
            return false;
        uint8_t j = farthest_beyond(law, moving, move, &limit);
        if (j == law->n)
            break;
        law->asked[j] = law->u[j] + move[j];
        moving = (uint8_t)(moving & ~(1u << j));
        for (unsigned i = 0; i < law->n; i++)
            left[i] -= law->b[i][j] * (limit - law->u[j]);
        law->u[j] = limit;
    }
    for (unsigned j = 0; j < law->n; j++)
        if (is_in(moving, j)) {
            law->u[j] += move[j];
            law->asked[j] = law->u[j];
        }
    return true;
}
