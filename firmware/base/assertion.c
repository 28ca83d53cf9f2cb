#include "base/assertion.h"

#include <stddef.h>

void (*assertion_report)(const char *text, const char *file, unsigned line) = NULL;

void assertion_failed(const char *text, const char *file, unsigned line)
{
    if (assertion_report)
        assertion_report(text, file, line);
    __builtin_trap();
}
