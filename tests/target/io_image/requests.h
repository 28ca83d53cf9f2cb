/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#ifndef IO_IMAGE_REQUESTS_H
#define IO_IMAGE_REQUESTS_H

/* From the board clock, once a millisecond: goes on with the request of the mailbox. */
void requests_clock(void);
void requests_start(void);

#endif
