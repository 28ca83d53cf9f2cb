/* The two lines to a firmware in this process: scheme `memory`. The bytes are those of the real lines: same encoder, decoder and CRC;
 * only the wire is missing. The clock both sides see is counted here and goes on only when nobody has anything to
 * say, so that a run is the same run every time and never waits.
 */
#ifndef REFLUX_HOST_SIM_MEMORY_TRANSPORT_H
#define REFLUX_HOST_SIM_MEMORY_TRANSPORT_H

#include "bench/transport.h"

/* Opens the link at the first call and powers the board on, opens the console at the second. One board a process. */
bool memory_transport_open(struct transport *t, const char *rest, char *err, size_t err_size);

#endif
