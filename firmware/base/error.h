/* Error codes of the whole firmware, with their texts.
 *
 * Rules
 *  1. A function that can fail returns enum err: ERR_OK (0) or a negative code. Nothing else is an error.
 *  2. The result must be looked at (MUST_CHECK makes the compiler insist).
 *  3. On error nothing the caller owns has changed, unless the function says otherwise.
 */
#ifndef REFLUX_BASE_ERROR_H
#define REFLUX_BASE_ERROR_H

enum err {
    ERR_OK = 0,
    ERR_RANGE = -1,        /* a number is outside its allowed range */
    ERR_NOT_FINITE = -2,   /* NaN or infinity where a number is needed */
    ERR_PARSE = -3,        /* text that is not a number or not a known word */
    ERR_UNKNOWN = -4,      /* no such name */
    ERR_UNIT = -5,         /* unit differs from the one declared */
    ERR_READ_ONLY = -6,    /* the value cannot be changed */
    ERR_BUSY = -7,         /* the request queue or a resource is in use */
    ERR_FULL = -8,         /* a fixed-size table or buffer has no room left */
    ERR_EMPTY = -9,        /* nothing there */
    ERR_CRC = -10,         /* checksum does not match */
    ERR_FRAME = -11,       /* malformed frame */
    ERR_VERSION = -12,     /* protocol or format version not supported */
    ERR_STATE = -13,       /* not possible in the present state or mode */
    ERR_CYCLE = -14,       /* loops that feed each other in a ring */
    ERR_SINGULAR = -15,    /* matrix has no usable inverse */
    ERR_MEMORY = -16,      /* does not fit the static arena */
    ERR_IO = -17,          /* the hardware or the operating system refused */
    ERR_TIMEOUT = -18,     /* no answer in time */
    ERR_UNSUPPORTED = -19, /* this board or build cannot do it */
    ERR_CONFLICT = -20,    /* two things claim what only one may have */
    ERR_LOCKED = -21,      /* the engineer level is locked */
    ERR_LAST = -21
};

#if defined(__GNUC__)
#define MUST_CHECK __attribute__((warn_unused_result))
#else
#define MUST_CHECK
#endif

/* Short upper-case word for scripts ("RANGE"), never NULL; "?" for a value that is no error code. */
const char *err_name(enum err code);

/* One-line description for people, never NULL. */
const char *err_text(enum err code);

/* Marks a function whose frame must not become part of its caller's, because the stack below the caller is deep. */
#if defined(__GNUC__)
#define NOT_INLINE __attribute__((noinline))
#else
#define NOT_INLINE
#endif

#endif
