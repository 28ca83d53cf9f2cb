/* The parts of decoupling-cost. */
#ifndef REFLUX_BENCH_DECOUPLING_H
#define REFLUX_BENCH_DECOUPLING_H

void cost_of_decoupling_ticks(void);
void cost_of_decoupling_designs(void);
void cost_of_experiments(void);

#endif
