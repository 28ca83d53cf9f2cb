/* Where a sample waits for work that is due (base/job.h).
 *
 * A plant in lockstep stops its time meanwhile, and at most sends the same sample again, which is not answered either. One
 * that sends the next does not wait: then the sample before is looked at without the work's result. */
#ifndef REFLUX_IO_SAMPLE_GATE_H
#define REFLUX_IO_SAMPLE_GATE_H

#include "base/job.h"
#include "hal/io.h"

#if JOBS_MAX
struct sample_gate {
    struct io_sample held; /* where `holds` */
    bool holds;
};

/* Instead of io->poll(): the next sample that is to be looked at now. wait: one that comes now must wait. Called until false, in
 * the tick context. */
bool sample_gate_poll(struct sample_gate *g, const struct io_port *io, bool wait, uint64_t now_ms,
                      struct io_sample *sample);
/* The plant that sent it is gone. */
void sample_gate_forget(struct sample_gate *g);
/* A sample waits. */
static inline bool sample_gate_holds(const struct sample_gate *g)
{
    return g->holds;
}
#else
struct sample_gate {
};
static inline bool sample_gate_poll(struct sample_gate *g, const struct io_port *io, bool wait,
                                    uint64_t now_ms, struct io_sample *sample)
{
    (void)g;
    (void)wait;
    return io->poll(io->context, now_ms, sample);
}
#define sample_gate_forget(g) ((void)(g))
#define sample_gate_holds(g)  ((void)(g), false)
#endif

#endif
