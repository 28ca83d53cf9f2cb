/* Compares lines with a kept file. A file is kept only where it guards a promise: kept_open() is given the promise, which is the first
 * line of the file, and the head of the test explains it.
 *
 * Where a change is meant, run the test with REFLUX_KEEP=1 in the environment, in the folder tests/: a failure prints this
 * command. The test then writes the file anew. Read the difference, number by number, before you commit it. */
#ifndef REFLUX_TESTS_KEPT_TRANSCRIPT_H
#define REFLUX_TESTS_KEPT_TRANSCRIPT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#define TRANSCRIPT_LINE 400

static struct {
    FILE *file;
    const char *path;
    char section[TRANSCRIPT_LINE]; /* where a difference is */
    unsigned line;
    bool anew;
} kept;

__attribute__((format(printf, 1, 2))) static inline void kept_line(const char *format, ...);

/* promise: one sentence, what breaks for somebody when a line changes by mistake. */
static inline void kept_open(const char *path, const char *promise)
{
    const char *keep = getenv("REFLUX_KEEP");
    kept.anew = keep && keep[0] == '1';
    kept.path = path;
    kept.line = 0;
    kept.file = fopen(path, kept.anew ? "w" : "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(kept.file, path);
    kept_line("## Promise: %s", promise);
}

/* Fails with the command that makes the kept file anew: the program of tests/LABEL/.../NAME.c is tests/LABEL/NAME. */
static inline void kept_fail(const char *difference)
{
    char text[5 * TRANSCRIPT_LINE];
    const char *label = __BASE_FILE__, *name = __BASE_FILE__, *found;
    while ((found = strstr(label, "tests/")) != NULL)
        label = found + strlen("tests/");
    name = strrchr(name, '/') ? strrchr(name, '/') + 1 : name;
    snprintf(text, sizeof text,
             "%s\n  to keep it as it is now: (cd tests; REFLUX_KEEP=1 ../build/%s/tests/%.*s/%.*s)",
             difference, strstr(kept.path, "fixed") ? "host-fixed" : "host",
             (int)strcspn(label, "/"), label, (int)strcspn(name, "."), name);
    TEST_FAIL_MESSAGE(text);
}

/* The next line, without its end. */
__attribute__((format(printf, 1, 2))) static inline void kept_line(const char *format, ...)
{
    char is[TRANSCRIPT_LINE], was[TRANSCRIPT_LINE + 2], text[4 * TRANSCRIPT_LINE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(is, sizeof is, format, arguments);
    va_end(arguments);
    kept.line++;
    if (strncmp(is, "# ", 2) == 0)
        memcpy(kept.section, is, sizeof is);
    if (kept.anew) {
        fprintf(kept.file, "%s\n", is);
        return;
    }
    if (!fgets(was, sizeof was, kept.file))
        kept_fail("the kept file is shorter");
    was[strcspn(was, "\n")] = '\0';
    if (strcmp(is, was) == 0)
        return;
    snprintf(text, sizeof text, "%s:%u %s\n  kept  %s\n  now   %s", kept.path, kept.line,
             kept.section, was, is);
    fclose(kept.file);
    kept_fail(text);
}

static inline void kept_close(void)
{
    char more[4];
    bool ends = kept.anew || !fgets(more, sizeof more, kept.file);
    TEST_ASSERT_EQUAL_INT(0, fclose(kept.file));
    if (!ends)
        kept_fail("the kept file goes on");
}

#endif
