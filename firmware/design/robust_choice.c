#include "design/robust_choice.h"

#include "base/assertion.h"

/* Weight of ln gain in the sum that is climbed; that of ln Ti is -1. */
#define GAIN_WEIGHT REAL_C(1.75)
/* Steps that all the distance to the bounds is worth. */
#define NEARER REAL_C(4.0)
/* Steps by which a loop may become faster through its integral time alone. */
#define RISE_BY_TI REAL_C(0.5)

/* What a move adds to the sum, in steps. */
static real_t gain_of_move(const struct robust_move *move)
{
    real_t gain = REAL_C(0.0);
    for (int m = 0; m < 2; m++)
        gain += GAIN_WEIGHT * (real_t)move->gain[m] - (real_t)move->ti[m];
    return gain;
}

/* The best move of the loops that are not taken, or ROBUST_MOVES. */
static uint8_t best_move(const struct robust_pass *pass, uint16_t taken)
{
    uint8_t best = ROBUST_MOVES, loops = pass->loops->pairs.n;
    real_t most = REAL_C(0.0);
    for (uint8_t m = 0; m < pass->moves; m++) {
        struct robust_move move = robust_move(loops, m);
        if (((unsigned)taken >> move.loop[0] & 1u) != 0u || !(pass->excess[m] <= REAL_C(1.0)))
            continue;
        real_t worth = gain_of_move(&move) - NEARER * pass->excess[m];
        if (best != ROBUST_MOVES && worth <= most)
            continue;
        best = m;
        most = worth;
    }
    return best;
}

uint8_t robust_choose(const struct robust_pass *pass, uint8_t most, uint8_t chosen[INTERACT_MAX])
{
    uint8_t n = 0, loops = pass->loops->pairs.n;
    uint16_t taken = 0;
    while (n < (most == 1 ? 1 : loops)) {
        uint8_t best = best_move(pass, taken);
        if (best == ROBUST_MOVES)
            break;
        chosen[n++] = best;
        taken = (uint16_t)(taken | 1u << robust_move(loops, best).loop[0]);
    }
    return n;
}

real_t robust_rise(uint8_t loops, const uint8_t chosen[INTERACT_MAX], uint8_t n)
{
    int8_t most = 0;
    for (uint8_t c = 0; c < n; c++) {
        struct robust_move move = robust_move(loops, chosen[c]);
        int8_t rise = move.gain[0] > move.gain[1] ? move.gain[0] : move.gain[1];
        most = rise > most ? rise : most;
    }
    return most > 0 ? (real_t)most : RISE_BY_TI;
}
