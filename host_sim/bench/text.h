/* Small tools for everything the bench reads from people: strict numbers, one-line errors. */
#ifndef REFLUX_HOST_SIM_TEXT_H
#define REFLUX_HOST_SIM_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define SIM_ERROR_SIZE 1024 /* room for one line of error text */

/* Writes the reason, printf style, and returns false, so that a check can end in `return sim_fail(...)`. */
bool sim_fail(char *err, size_t err_size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Appends to a zero-terminated buffer; what does not fit is cut. */
void sim_append(char *buffer, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The whole text is one finite decimal number: no hexadecimal, no NaN, no blanks, nothing behind it. */
bool sim_parse_number(const char *text, double *x);

/* The whole text is one unsigned decimal integer that fits 64 bits. */
bool sim_parse_unsigned(const char *text, uint64_t *x);

/* Opens a text file that a person wrote, behind its UTF-8 byte order mark if it has one. UTF-16 is refused. NULL: err says why. */
FILE *sim_open_text(const char *path, char *err, size_t err_size);

/* Monotonic milliseconds and seconds of this machine. */
uint64_t sim_clock_ms(void);
double sim_clock_s(void);

#endif
