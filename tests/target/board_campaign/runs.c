/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "runs.h"

#include <ctype.h>
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define LINE   1024
#define SHOW_S 2.0

static double now_s(void)
{
    struct timespec t;
    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static void count(struct runs *r, const char *result)
{
    size_t n = strcspn(result, " "), k = 0;
    n = n < sizeof(r->kinds[0].name) - 1u ? n : sizeof(r->kinds[0].name) - 1u;
    while (k < r->n_kinds &&
           (strncmp(r->kinds[k].name, result, n) != 0 || r->kinds[k].name[n] != '\0'))
        k++;
    if (k == RUN_KINDS)
        return;
    if (k == r->n_kinds) {
        (void)memcpy(r->kinds[k].name, result, n);
        r->kinds[k].name[n] = '\0';
        r->n_kinds++;
    }
    r->kinds[k].n++;
    r->n_bad += isupper((unsigned char)result[0]) != 0;
}

static bool keep_key(struct runs *r, char *line)
{
    char *tab = strchr(line, '\t');
    if (tab == NULL)
        return false;
    *tab = '\0';
    char **more = realloc(r->done, (r->n_done + 1u) * sizeof(*more));
    if (more == NULL)
        abort();
    r->done = more;
    r->done[r->n_done++] = strdup(line);
    count(r, tab + 1);
    return true;
}

static bool read_file(struct runs *r)
{
    char line[LINE];
    FILE *f = fopen(r->file, "r");
    if (f == NULL) {
        f = errno == ENOENT ? fopen(r->file, "w") : NULL;
        if (f == NULL || fprintf(f, "# %s\n", r->about) < 0 || fclose(f) != 0) {
            (void)fprintf(stderr, "board-campaign: %s: %s\n", r->file, strerror(errno));
            return false;
        }
        return true;
    }
    bool same = fgets(line, sizeof(line), f) != NULL && strncmp(line, "# ", 2) == 0;
    line[strcspn(line, "\n")] = '\0';
    same = same && strcmp(line + 2, r->about) == 0;
    while (same && fgets(line, sizeof(line), f) != NULL && strchr(line, '\n') != NULL) {
        line[strcspn(line, "\n")] = '\0';
        if (line[0] != '#' && !keep_key(r, line))
            same = false;
    }
    (void)fclose(f);
    if (!same)
        (void)fprintf(stderr, "board-campaign: %s has no results of: %s\n", r->file, r->about);
    qsort(r->done, r->n_done, sizeof(*r->done), compare);
    r->n_kept = r->n_done;
    return same;
}

bool runs_begin(struct runs *r, const char *file, const char *about, unsigned jobs)
{
    *r = (struct runs){.file = file,
                       .about = about,
                       .jobs = jobs < JOBS_MAX ? jobs : JOBS_MAX,
                       .began_s = now_s()};
    (void)printf("%s\n", about);
    return file == NULL || read_file(r);
}

bool runs_are_done(const struct runs *r, const char *key)
{
    return r->n_done > 0 && bsearch(&key, r->done, r->n_done, sizeof(*r->done), compare) != NULL;
}

bool runs_are_left(const struct runs *r, unsigned from, unsigned end, unsigned step)
{
    for (unsigned n = from; n < end; n += step) {
        char key[64];
        (void)snprintf(key, sizeof(key), "%u", n);
        if (!runs_are_done(r, key))
            return true;
    }
    return false;
}

static void note(struct runs *r, const char *key, const char *result)
{
    FILE *f = r->file == NULL ? NULL : fopen(r->file, "a");
    if (f != NULL) {
        (void)fprintf(f, "%s\t%s\n", key, result);
        (void)fclose(f);
    }
    r->n_new++;
    count(r, result);
    if (isupper((unsigned char)result[0]))
        (void)printf("\n%s: %s\n", key, result);
    double now = now_s();
    if (now - r->shown_s < SHOW_S)
        return;
    r->shown_s = now;
    if (isatty(STDOUT_FILENO))
        (void)printf("\r%zu runs, %zu finds, %.2f runs/s ", r->n_kept + r->n_new, r->n_bad,
                     (double)r->n_new / (now - r->began_s));
    (void)fflush(stdout);
}

static void take_one(struct runs *r)
{
    struct pollfd list[JOBS_MAX];
    for (unsigned i = 0; i < r->n_workers; i++)
        list[i] = (struct pollfd){.fd = r->workers[i].fd, .events = POLLIN};
    if (poll(list, r->n_workers, -1) <= 0)
        return;
    unsigned i = 0;
    while (i + 1u < r->n_workers && list[i].revents == 0)
        i++;
    struct worker w = r->workers[i];
    r->workers[i] = r->workers[--r->n_workers];
    char result[RUN_TEXT] = "";
    size_t n = 0;
    ssize_t k;
    while ((k = read(w.fd, result + n, sizeof(result) - 1u - n)) > 0 || (k < 0 && errno == EINTR))
        n += k > 0 ? (size_t)k : 0;
    (void)close(w.fd);
    int status = 0;
    (void)waitpid(w.pid, &status, 0);
    result[n] = '\0';
    if (n == 0 || status != 0)
        (void)snprintf(result, sizeof(result), "CRASHED status 0x%x", (unsigned)status);
    note(r, w.key, result);
}

void runs_add(struct runs *r, const char *key, void (*work)(void *context, char *result),
              void *context)
{
    while (r->n_workers >= r->jobs)
        take_one(r);
    int ends[2];
    (void)fflush(stdout);
    if (pipe(ends) != 0)
        abort();
    int pid = fork();
    if (pid < 0)
        abort();
    if (pid == 0) {
        char result[RUN_TEXT] = "";
        (void)close(ends[0]);
        work(context, result);
        size_t n = strlen(result);
        _exit(write(ends[1], result, n) == (ssize_t)n ? 0 : 1);
    }
    (void)close(ends[1]);
    struct worker *w = &r->workers[r->n_workers++];
    *w = (struct worker){.pid = pid, .fd = ends[0]};
    (void)snprintf(w->key, sizeof(w->key), "%s", key);
}

void runs_wait(struct runs *r)
{
    while (r->n_workers > 0)
        take_one(r);
}

bool runs_end(struct runs *r)
{
    runs_wait(r);
    double spent = now_s() - r->began_s;
    struct rusage used;
    (void)getrusage(RUSAGE_CHILDREN, &used);
    double processor = (double)used.ru_utime.tv_sec + (double)used.ru_stime.tv_sec +
                       1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
    (void)printf("%s%zu runs, %zu of them now in %.0f s, %.3f s of processor time each, %u at a "
                 "time; ",
                 isatty(STDOUT_FILENO) ? "\n" : "", r->n_kept + r->n_new, r->n_new, spent,
                 r->n_new > 0 ? processor / (double)r->n_new : 0.0, r->jobs);
    for (size_t k = 0; k < r->n_kinds; k++)
        (void)printf("%s %zu, ", r->kinds[k].name, r->kinds[k].n);
    (void)printf("%zu finds\n", r->n_bad);
    for (size_t k = 0; k < r->n_kept; k++)
        free(r->done[k]);
    free(r->done);
    return r->n_bad == 0;
}
