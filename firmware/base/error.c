#include "base/error.h"

static const struct {
    const char *name;
    const char *text;
} table[] = {
    {"OK", "no error"},
    {"RANGE", "number outside its allowed range"},
    {"NOT_FINITE", "not a finite number"},
    {"PARSE", "cannot be read"},
    {"UNKNOWN", "no such name"},
    {"UNIT", "unit differs from the one declared"},
    {"READ_ONLY", "cannot be changed"},
    {"BUSY", "busy, try again"},
    {"FULL", "no room left"},
    {"EMPTY", "nothing there"},
    {"CRC", "checksum does not match"},
    {"FRAME", "malformed frame"},
    {"VERSION", "version not supported"},
    {"STATE", "not possible in the present state"},
    {"CYCLE", "loops feed each other in a ring"},
    {"SINGULAR", "matrix has no usable inverse"},
    {"MEMORY", "does not fit the memory of this board"},
    {"IO", "input or output failed"},
    {"TIMEOUT", "no answer in time"},
    {"UNSUPPORTED", "not available on this board"},
    {"CONFLICT", "claimed by something else already"},
    {"LOCKED", "needs the engineer level, which is locked; `unlock KEY` opens it"},
};

_Static_assert(sizeof(table) / sizeof(table[0]) == (unsigned)(-ERR_LAST) + 1u,
               "every error code has a text");

/* Compared before negated: the negative of the smallest int does not exist. */
static int known(enum err code)
{
    return code <= ERR_OK && code >= ERR_LAST;
}

const char *err_name(enum err code)
{
    return known(code) ? table[-(int)code].name : "?";
}

const char *err_text(enum err code)
{
    return known(code) ? table[-(int)code].text : "unknown error code";
}
