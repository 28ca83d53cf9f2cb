/* Compares what the console says with a kept file: words to the letter, numbers within a thousandth and 0.00001, since what
 * a start-up finds is no rounder than its plant. A test writes the file anew with `--write FILE`. */
#ifndef REFLUX_TESTS_TRANSCRIPT_H
#define REFLUX_TESTS_TRANSCRIPT_H

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

#define TRANSCRIPT_MAX 400000

static char transcript_now[TRANSCRIPT_MAX], transcript_kept[TRANSCRIPT_MAX];
static size_t transcript_n;

static inline void transcript_add(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    int n =
        vsnprintf(transcript_now + transcript_n, TRANSCRIPT_MAX - transcript_n, format, arguments);
    va_end(arguments);
    TEST_ASSERT_TRUE(n >= 0 && (size_t)n < TRANSCRIPT_MAX - transcript_n);
    transcript_n += (size_t)n;
}

static inline bool transcript_read(const char *path)
{
    FILE *file = fopen(path, "r");
    if (!file)
        return false;
    size_t n = fread(transcript_kept, 1, TRANSCRIPT_MAX - 1, file);
    transcript_kept[n] = '\0';
    (void)fclose(file);
    return n > 0;
}

static inline bool transcript_write(const char *path)
{
    FILE *file = fopen(path, "w");
    if (!file)
        return false;
    bool ok = fwrite(transcript_now, 1, transcript_n, file) == transcript_n;
    return fclose(file) == 0 && ok;
}

static inline bool transcript_same_word(const char *a, size_t n, const char *b, size_t m)
{
    if (n == m && memcmp(a, b, n) == 0)
        return true;
    char *end_a, *end_b;
    double x = strtod(a, &end_a), y = strtod(b, &end_b);
    if (end_a == a || end_b == b)
        return false;
    size_t rest_a = (size_t)(a + n - end_a), rest_b = (size_t)(b + m - end_b);
    return end_a <= a + n && end_b <= b + m && rest_a == rest_b &&
           memcmp(end_a, end_b, rest_a) == 0 && fabs(x - y) <= 1e-5 + 1e-3 * fmax(fabs(x), fabs(y));
}

/* Both begin at a line and end at its end. */
static inline bool transcript_same_line(const char *a, const char *b)
{
    for (;;) {
        size_t n = strcspn(a, " \n"), m = strcspn(b, " \n");
        if (!transcript_same_word(a, n, b, m) || a[n] != b[m])
            return false;
        if (a[n] != ' ')
            return true;
        a += n + 1;
        b += m + 1;
    }
}

/* The part of the kept file under `== title`, or NULL. */
static inline const char *transcript_part(const char *title)
{
    char head[120];
    snprintf(head, sizeof head, "== %s\n", title);
    const char *at = strstr(transcript_kept, head);
    return at ? at + strlen(head) : NULL;
}

/* The text since `from` equals what stands under that title, and nothing else does. */
static inline void transcript_compare(const char *title, size_t from)
{
    const char *kept = transcript_part(title), *now = transcript_now + from;
    TEST_ASSERT_NOT_NULL_MESSAGE(kept, title);
    for (;;) {
        bool over_now = !*now, over_kept = !*kept || strncmp(kept, "== ", 3) == 0;
        if (over_now && over_kept)
            return;
        if (over_now || over_kept || !transcript_same_line(now, kept)) {
            char message[600];
            snprintf(message, sizeof message, "%s\n  now:  %.*s\n  kept: %.*s", title,
                     (int)strcspn(now, "\n"), now, over_kept ? 0 : (int)strcspn(kept, "\n"), kept);
            TEST_FAIL_MESSAGE(message);
        }
        now += strcspn(now, "\n");
        kept += strcspn(kept, "\n");
        now += *now == '\n';
        kept += *kept == '\n';
    }
}

#endif
