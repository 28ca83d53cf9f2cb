/* Declarations that the parts of the image share. */
#ifndef REFLUX_BENCH_COST_H
#define REFLUX_BENCH_COST_H

#include <stddef.h>
#include <stdint.h>

/* Instructions since the start: the emulator's timer TIM2 counts one for each (-icount shift=0). Here, so that no call is counted. */
#define TIM2_CNT (*(volatile uint32_t *)0x40000024u)
static inline uint32_t cost_now(void)
{
    return TIM2_CNT;
}
/* "what n mean most bytes\n" */
void cost_say(const char *what, unsigned n, uint32_t mean, uint32_t most, uint32_t bytes);
/* -1 to 1, the same from the same beginning. */
float cost_random(void);
void cost_seed(uint32_t begin);

struct cost {
    uint32_t sum, most, count, stack;
};
/* Paints the free stack. */
void cost_paint_stack(void);
/* Counts the stack used since; the largest use counts. */
void cost_stack(struct cost *c);
/* Cost of two calls of cost_now() with nothing in between; it is taken off. */
void cost_add(struct cost *c, uint32_t from, uint32_t to);
/* Adds a cost that has been summed already. */
void cost_sum(struct cost *c, uint32_t spent);
/* Mean and most, then a line of the stack. */
void cost_tell(const char *what, unsigned n, const struct cost *c, uint32_t bytes);

#ifndef REFLUX_FIXED_POINT
/* Other forms of the same measurement update: P is n x n, row by row, and symmetric; gain: [n]. They return alpha. */
float covariance_form(float *p, size_t n, const float *phi, float v, float *gain);
float joseph_form(float *p, size_t n, const float *phi, float v, float *gain);
float dense_form(float *p, size_t n, const float *phi, float v, float *gain);
#endif

void cost_of_tuners(void);
void cost_of_trays(void);

#endif
