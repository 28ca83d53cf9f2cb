/* How many outputs a board has, and which types of them.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_OUTPUTS_OUTPUT_LIMITS_H
#define REFLUX_OUTPUTS_OUTPUT_LIMITS_H

#ifndef OUTPUTS_MAX
#define OUTPUTS_MAX 8u
#endif

/* 0: a board has only window, relay and enable. It refuses the others in these words. */
#ifndef OUTPUT_ALL_KINDS
#define OUTPUT_ALL_KINDS 1
#endif
#define OUTPUT_KINDS_HERE "this board has window, relay and enable only"

/* Rows of tables, and members, for the other types. */
#if OUTPUT_ALL_KINDS
#define OUTPUT_FURTHER(...) __VA_ARGS__
#else
#define OUTPUT_FURTHER(...)
#endif

#endif
