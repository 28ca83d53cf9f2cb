/* A world made of the text of a wiring file, with pins that are driven and faults by name, for tests of what stands there.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_TESTS_WIRED_BENCH_H
#define REFLUX_TESTS_WIRED_BENCH_H

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "chips/wired.h"
#include "unity.h"

#define MS    UINT64_C(1000000)
#define S     UINT64_C(1000000000)
#define EXACT 1e-3 /* ns */

static char path[64];
static char err[512];
static struct wired *w;
static const struct world *world;

/* w is NULL, with the reason in err, where the text is refused. */
static inline void open_text(const char *text)
{
    FILE *f = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(f);
    (void)fputs(text, f);
    (void)fclose(f);
    wired_close(w);
    w = wired_open(path, 1, err, sizeof(err));
    world = w != NULL ? wired_world(w) : NULL;
}

static inline void begin_wired(void)
{
    (void)snprintf(path, sizeof(path), "/tmp/wired_test_XXXXXX");
    int file = mkstemp(path);
    TEST_ASSERT_TRUE(file >= 0);
    (void)close(file);
    w = NULL;
}

static inline void end_wired(void)
{
    wired_close(w);
    w = NULL;
    (void)remove(path);
}

static inline void drive(uint64_t now_ns, char port, int number, enum pin_drive as)
{
    world->pin_driven(world->context, now_ns, HAL_PIN(port, number), as);
}

static inline bool fault(uint64_t now_ns, const char *name, const char *what, double value)
{
    return wired_fault(w, now_ns, name, what, value, err, sizeof(err));
}

#endif
