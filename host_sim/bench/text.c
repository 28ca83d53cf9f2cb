#include "bench/text.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

bool sim_fail(char *err, size_t err_size, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    /* NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized): va_start stands one line above */
    (void)vsnprintf(err, err_size, format, list);
    va_end(list);
    return false;
}

void sim_append(char *buffer, size_t size, const char *format, ...)
{
    size_t used = strlen(buffer);
    if (used + 1 >= size) {
        return;
    }
    va_list list;
    va_start(list, format);
    /* NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized): va_start stands one line above */
    (void)vsnprintf(buffer + used, size - used, format, list);
    va_end(list);
}

bool sim_parse_number(const char *text, double *x)
{
    /* strtod also takes "nan", "inf", hexadecimal and leading blanks: only these characters may stand here. */
    if (text[0] == '\0' || strspn(text, "0123456789+-.eE") != strlen(text)) {
        return false;
    }
    char *end;
    double value = strtod(text, &end);
    if (*end != '\0' || end == text || !isfinite(value)) {
        return false;
    }
    *x = value;
    return true;
}

bool sim_parse_unsigned(const char *text, uint64_t *x)
{
    if (text[0] == '\0' || strspn(text, "0123456789") != strlen(text)) {
        return false;
    }
    errno = 0;
    unsigned long long value = strtoull(text, NULL, 10);
    if (errno != 0) {
        return false;
    }
    *x = value;
    return true;
}

double sim_clock_s(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Returns what is wrong with the first bytes, or NULL with the file behind a byte order mark or at its beginning. */
static const char *skip_mark(FILE *file)
{
    int first = getc(file);
    if (first == 0xFF || first == 0xFE) {
        return "is UTF-16 text; it must be UTF-8 (iconv -f UTF-16 -t UTF-8 OLD > NEW)";
    }
    if (first == 0xEF) {
        char rest[2];
        return fread(rest, 1, 2, file) == 2 && memcmp(rest, "\xBB\xBF", 2) == 0
                   ? NULL
                   : "does not begin with text";
    }
    if (first == EOF) {
        return ferror(file) != 0 ? strerror(errno) : NULL;
    }
    (void)ungetc(first, file);
    return NULL;
}

FILE *sim_open_text(const char *path, char *err, size_t err_size)
{
    FILE *file = fopen(path, "rb");
    const char *wrong = file != NULL ? skip_mark(file) : strerror(errno);
    if (wrong != NULL) {
        (void)sim_fail(err, err_size, "%s: %s", path, wrong);
        if (file != NULL) {
            (void)fclose(file);
        }
        return NULL;
    }
    return file;
}

uint64_t sim_clock_ms(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000u + (uint64_t)now.tv_nsec / 1000000u;
}
