/* The two lines of a virtual board (reflux-board --control PATH): scheme `board:PATH`. Time is the board's own and goes on only while this side
 * waits, so that a run is the same run every time.
 */
#ifndef REFLUX_HOST_SIM_TRANSPORT_BOARD_H
#define REFLUX_HOST_SIM_TRANSPORT_BOARD_H

#include "bench/transport.h"

/* Opens the link at the first call and the console at the second, both over one socket. One board a process. */
bool transport_open_board(struct transport *t, const char *path, uint64_t patience_ms, char *err,
                          size_t err_size);

#endif
