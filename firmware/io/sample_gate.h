/* Sample gate: a sample waits here for a job that is due (base/job.h).
 *
 * A plant in lockstep stops its time meanwhile. At most it sends the same sample again, which gets no answer either. A plant that
 * sends the next sample does not wait. The tick then takes the sample before, without the result of the job. */
#ifndef REFLUX_IO_SAMPLE_GATE_H
#define REFLUX_IO_SAMPLE_GATE_H

#include "base/job.h"
#include "hal/io.h"

#if JOBS_MAX
struct sample_gate {
    struct io_sample held; /* valid while `holds` */
    bool holds;
};

/* Gets the next sample for the tick, in place of io->poll(). wait: a sample that comes now must wait. Call in the tick context until
 * it returns false. */
bool sample_gate_poll(struct sample_gate *g, const struct io_port *io, bool wait, uint64_t now_ms,
                      struct io_sample *sample);
/* Forgets the waiting sample, because the plant that sent it is gone. */
void sample_gate_forget(struct sample_gate *g);
/* Returns whether a sample waits. */
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
