#include "interact/ranked_assignment.h"

#include "base/assertion.h"

/* Keeps an assignment as an open node. */
static void keep_node(struct ranked_assignment *r, const struct ranked_node *node)
{
    REFLUX_ASSERT(r->nodes <= RANKED_NODES);
    uint8_t place = r->nodes;
    if (r->nodes == RANKED_NODES) {
        place = 0;
        for (uint8_t k = 1; k < RANKED_NODES; k++)
            if (r->node[k].total > r->node[place].total)
                place = k;
        if (r->node[place].total <= node->total)
            return;
    } else {
        r->nodes++;
    }
    r->node[place] = *node;
}

/* Solves with the first `fixed` rows as in the best so far and some columns of the next forbidden. */
static void solve_node(struct ranked_assignment *r, uint8_t fixed, uint16_t forbidden)
{
    const struct assignment *costs = &r->costs;
    REFLUX_ASSERT(fixed < costs->rows && costs->rows <= INTERACT_MAX);
    struct assignment *rest = &r->rest;
    struct ranked_node node = {.forbidden = forbidden, .fixed = fixed};
    uint8_t column[INTERACT_MAX], partner[INTERACT_MAX], left = 0;
    uint16_t taken = 0;
    for (uint8_t i = 0; i < fixed; i++)
        taken = (uint16_t)(taken | (1u << r->best.partner[i]));
    for (uint8_t j = 0; j < costs->cols; j++)
        if ((taken & (1u << j)) == 0u)
            column[left++] = j;
    rest->rows = rest->cols = left;
    for (uint8_t i = 0; i < left; i++)
        for (uint8_t j = 0; j < left; j++) {
            bool out = i == 0 && (forbidden & (1u << column[j])) != 0u;
            rest->cost[i][j] = out ? ASSIGNMENT_FORBIDDEN : costs->cost[fixed + i][column[j]];
        }

    int32_t total;
    if (assignment_solve(rest, partner, &total))
        return;
    for (uint8_t i = 0; i < fixed; i++) {
        node.partner[i] = r->best.partner[i];
        total += costs->cost[i][node.partner[i]];
    }
    for (uint8_t i = 0; i < left; i++)
        node.partner[fixed + i] = column[partner[i]];
    node.total = total;
    keep_node(r, &node);
}

void ranked_begin(struct ranked_assignment *r)
{
    r->nodes = 0;
    r->row = r->costs.rows;
    solve_node(r, 0, 0);
}

bool ranked_next(struct ranked_assignment *r)
{
    if (r->nodes == 0)
        return false;
    uint8_t first = 0; /* the cheapest; of equals the oldest */
    for (uint8_t k = 1; k < r->nodes; k++)
        if (r->node[k].total < r->node[first].total)
            first = k;
    r->best = r->node[first];
    r->nodes--;
    for (uint8_t k = first; k < r->nodes; k++)
        r->node[k] = r->node[k + 1];
    r->row = r->best.fixed;
    return true;
}

bool ranked_branch(struct ranked_assignment *r)
{
    if (r->row + 1u >= r->costs.rows)
        return false;
    uint16_t own = (uint16_t)(1u << r->best.partner[r->row]);
    uint16_t before = r->row == r->best.fixed ? r->best.forbidden : 0u;
    solve_node(r, r->row, (uint16_t)(before | own));
    r->row++;
    return true;
}
