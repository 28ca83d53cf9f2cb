#include "base/error.h"

#include <string.h>

/* Name, zero, text: one pointer for each code. */
#define E(name, text) name "\0" text
static const char *const table[] = {
    E("OK", "no error"),
    E("RANGE", "number outside its allowed range"),
    E("NOT_FINITE", "not a finite number"),
    E("PARSE", "cannot be read"),
    E("UNKNOWN", "no such name"),
    E("UNIT", "unit differs from the one declared"),
    E("READ_ONLY", "cannot be changed"),
    E("BUSY", "busy, try again"),
    E("FULL", "no room left"),
    E("EMPTY", "nothing there"),
    E("CRC", "checksum does not match"),
    E("FRAME", "malformed frame"),
    E("VERSION", "version not supported"),
    E("STATE", "not possible in the present state"),
    E("CYCLE", "loops feed each other in a ring"),
    E("SINGULAR", "matrix has no usable inverse"),
    E("MEMORY", "does not fit the memory of this board"),
    E("IO", "input or output failed"),
    E("TIMEOUT", "no answer in time"),
    E("UNSUPPORTED", "not available on this board"),
    E("CONFLICT", "claimed by something else already"),
    E("LOCKED", "needs the engineer level, which is locked; `unlock KEY` opens it"),
};

_Static_assert(sizeof(table) / sizeof(table[0]) == (unsigned)(-ERR_LAST) + 1u,
               "every error code has a text");

/* Returns whether the code has a row. It compares before anything negates, because the smallest int has no negative. */
static int known(enum err code)
{
    return code <= ERR_OK && code >= ERR_LAST;
}

const char *err_name(enum err code)
{
    return known(code) ? table[-(int)code] : "?";
}

const char *err_text(enum err code)
{
    return known(code) ? strchr(table[-(int)code], 0) + 1 : "unknown error code";
}
