/* Many runs in parallel processes, each with one line of result in a file that a later call goes on with.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_BOARD_CAMPAIGN_RUNS_H
#define REFLUX_BOARD_CAMPAIGN_RUNS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RUN_TEXT  400
#define RUN_KINDS 24
#define JOBS_MAX  64

struct runs {
    const char *file;  /* NULL: kept nowhere */
    const char *about; /* first line of the file: what its results are of */
    unsigned jobs;

    char **done; /* keys of the file, sorted */
    size_t n_done, n_kept;
    struct worker {
        int pid, fd;
        char key[64];
    } workers[JOBS_MAX];
    unsigned n_workers;
    size_t n_new, n_bad;
    struct {
        char name[24];
        size_t n;
    } kinds[RUN_KINDS]; /* first words of the results */
    size_t n_kinds;
    double began_s, shown_s;
};

/* Reads the file, if there is one. False with the reason on stderr: it is of another campaign, or cannot be read. */
bool runs_begin(struct runs *r, const char *file, const char *about, unsigned jobs);

bool runs_are_done(const struct runs *r, const char *key);

/* Whether any of the numbers from, from + step, ... below end has no result. */
bool runs_are_left(const struct runs *r, unsigned from, unsigned end, unsigned step);

/* Runs work() in a process of its own, once one of the jobs is free: it writes its result, one line whose first word is its kind. A kind
 * in capitals is a find. */
void runs_add(struct runs *r, const char *key, void (*work)(void *context, char *result),
              void *context);

/* Waits for those that still run. */
void runs_wait(struct runs *r);

/* Prints the sums; false where a run found something. */
bool runs_end(struct runs *r);

#endif
