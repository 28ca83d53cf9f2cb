/* Assignments of rows to columns in ascending order of their total cost: K. G. Murty, Operations Research 16 (1968) 682. What
 * differs from an assignment differs from it first in some row, so all others lie in as many sets as there are rows, and the
 * best of each is solved for. RANKED_NODES of these wait; the dearest goes where there is no room. */
#ifndef REFLUX_INTERACT_RANKED_ASSIGNMENT_H
#define REFLUX_INTERACT_RANKED_ASSIGNMENT_H

#include <stdbool.h>
#include <stdint.h>

#include "interact/assignment.h"

#define RANKED_NODES 40

struct ranked_node {
    int32_t total;
    uint16_t forbidden; /* columns, in row `fixed` */
    uint8_t fixed;      /* rows before it are as in partner */
    uint8_t partner[INTERACT_MAX];
};

struct ranked_assignment {
    struct assignment costs; /* square; the caller's to fill before ranked_begin() */
    struct ranked_node best; /* the latest that ranked_next() has given */
    struct assignment rest;
    struct ranked_node node[RANKED_NODES];
    uint8_t nodes, row;
};

/* Solves for the first. */
void ranked_begin(struct ranked_assignment *r);
/* The next one goes into r->best: false where there is none. Before the one after it come ranked_branch() calls. */
bool ranked_next(struct ranked_assignment *r);
/* Solves for the best of one of the sets of others, one row a call, at most 1.2e5 instructions: true while there is more to do. */
bool ranked_branch(struct ranked_assignment *r);

#endif
