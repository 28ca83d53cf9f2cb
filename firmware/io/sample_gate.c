#include "io/sample_gate.h"

/* Most polls in one call. A sample takes the line milliseconds, a poll takes microseconds. */
#define POLLS 64u

static bool keep_back(struct sample_gate *g, const struct io_port *io, uint64_t now_ms,
                      struct io_sample *sample)
{
    for (unsigned n = 0; n < POLLS && io->poll(io->context, now_ms, sample); n++) {
        bool goes_on = g->holds && sample->number != g->held.number;
        struct io_sample before = g->held;
        g->held = *sample;
        g->holds = true;
        if (goes_on) {
            *sample = before;
            return true;
        }
    }
    return false;
}

bool sample_gate_poll(struct sample_gate *g, const struct io_port *io, bool wait, uint64_t now_ms,
                      struct io_sample *sample)
{
    if (wait)
        return keep_back(g, io, now_ms, sample);
    if (!g->holds)
        return io->poll(io->context, now_ms, sample);
    *sample = g->held;
    g->holds = false;
    return true;
}

void sample_gate_forget(struct sample_gate *g)
{
    g->holds = false;
}
