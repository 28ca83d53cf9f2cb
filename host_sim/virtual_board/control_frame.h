/* Both ends of the control protocol (control.h): sizes, numbers, whole blocks over a socket.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_CONTROL_FRAME_H
#define REFLUX_VIRTUAL_BOARD_CONTROL_FRAME_H

#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>

#define REQUEST_BYTES 14u
#define REPLY_BYTES   22u
#define LOAD_BYTES    8u
#define FRAME_MOST    16384u /* bytes of a line, or of faults, in one step */

static inline uint64_t frame_number(const uint8_t *at, unsigned bytes)
{
    uint64_t n = 0;
    for (unsigned i = 0; i < bytes; i++)
        n |= (uint64_t)at[i] << 8 * i;
    return n;
}

static inline void frame_put(uint8_t *at, uint64_t n, unsigned bytes)
{
    for (unsigned i = 0; i < bytes; i++)
        at[i] = (uint8_t)(n >> 8 * i);
}

/* Sends or receives all n bytes. False: the other end has gone. */
static inline bool frame_whole(int fd, void *bytes, size_t n, bool out)
{
    uint8_t *at = bytes;
    while (n > 0) {
        ssize_t k = out ? send(fd, at, n, MSG_NOSIGNAL) : recv(fd, at, n, 0);
        if (k < 0 && errno == EINTR)
            continue;
        if (k <= 0)
            return false;
        at += k;
        n -= (size_t)k;
    }
    return true;
}

#endif
